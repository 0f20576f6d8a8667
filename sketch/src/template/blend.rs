//! From the spline and the true distance to the samples of the field image.

use super::constraints::{Fitted, ridges_at};
use super::exact::Exact;
use super::levels::Levels;
use crate::thin_plate::CornerRidge;
use rayon::prelude::*;

/// How far the spline may leave the true distance, as a share of the drawing's size, before it is drawn back.
/// The curve moves by at most 1.7 times this.
const TOLERANCE: f64 = 1.5e-3;

/// How far it may, as a share of the distance.
const SHARE: f64 = 0.4;

/// From where to where, as shares of the falloff, the true distance takes over outside.
const TAKE_OVER: [f64; 2] = [0.4, 1.0];

/// Where the margin for the reading begins to grow; it is whole at the falloff.
const MARGIN_FROM: f64 = 0.1;

/// Up to how many pixels from a corner the true distance holds, and where it has given way to the spline.
const AT_CORNERS: [f64; 2] = [3.0, 9.0];

/// The smoothed signed distance on a grid: the spline and its ridges, drawn smoothly towards the true distance
/// where they are far from it, and equal to it at corners and where the field ends.
///
/// There it is three quarters of a pixel more, since reading the image rounds the ridges of the distance: so the
/// read distance is never below the falloff beyond it.
pub(super) fn samples(fitted: &Fitted, exact: &Exact, levels: &Levels, size: f64) -> Vec<f32> {
    let Exact { grid, samples: exact } = exact;
    let width = grid.size[0];
    // Where the field has ended, only the true distance counts.
    let mut samples = fitted.spline.sample_grid_where(grid, |[x, y], [right, above]| {
        let middle = [(x + right) / 2, (y + above) / 2];
        let reach = grid.at(x, y).distance(grid.at(right, above)) * 0.5 + grid.pixel;
        exact[middle[1] * width + middle[0]] - reach < levels.falloff
    });
    let reach = AT_CORNERS.map(|pixels| pixels * grid.pixel);
    let beyond = levels.falloff + 0.75 * grid.pixel;
    samples.par_chunks_mut(width).zip(exact.par_chunks(width)).enumerate().for_each(
        |(row, (samples, exact))| {
            let y = grid.at(0, row).y;
            let reaches = |ridge: &&CornerRidge| (ridge.at.y - y).abs() < ridge.radius.max(reach[1]);
            let ridges: Vec<CornerRidge> = fitted.ridges.iter().filter(reaches).copied().collect();
            for (column, (sample, &exact)) in samples.iter_mut().zip(exact).enumerate() {
                let p = grid.at(column, row);
                let smooth = f64::from(*sample) + ridges_at(&ridges, p);
                let corner = ridges.iter().map(|r| r.at.distance_squared(p)).fold(f64::INFINITY, f64::min);
                let cornered = rise((reach[1] - corner.sqrt()) / (reach[1] - reach[0]));
                let off = (smooth - exact).abs() / (SHARE * exact.abs() + TOLERANCE * size);
                let near = smooth + rise(2.0 * off - 1.0).max(cornered) * (exact - smooth);
                let share = exact / levels.falloff;
                let outer = rise((share - TAKE_OVER[0]) / (TAKE_OVER[1] - TAKE_OVER[0]));
                let margin = 0.75 * grid.pixel * rise((share - MARGIN_FROM) / (1.0 - MARGIN_FROM));
                let value = near + outer * (exact - near) + margin;
                // Only rounding to f32 is left to fear.
                *sample = if exact >= levels.falloff { value.max(beyond) as f32 } else { value as f32 };
            }
        },
    );
    sharpened(&samples, width)
}

/// Samples that give the same values when the image is read as these as samples would if it did not smooth: nearly
/// the control points of the interpolating spline. It makes corners four times as sharp.
///
/// To each sample is added what reading takes off there; the border stays as it is.
pub(super) fn sharpened(samples: &[f32], width: usize) -> Vec<f32> {
    let height = samples.len() / width;
    let mut out = samples.to_vec();
    out.par_chunks_mut(width).enumerate().filter(|(row, _)| (1..height - 1).contains(row)).for_each(
        |(row, line)| {
            let at = |column: usize, row: usize| f64::from(samples[row * width + column]);
            for (column, sample) in line.iter_mut().enumerate().take(width - 1).skip(1) {
                let across = |row: usize| at(column - 1, row) + 6.0 * at(column, row) + at(column + 1, row);
                let read = (across(row - 1) + 6.0 * across(row) + across(row + 1)) / 64.0;
                *sample = (2.0 * at(column, row) - read) as f32;
            }
        },
    );
    out
}

/// From 0 at 0 to 1 at 1, flat at both, C².
pub(super) fn rise(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}
