//! How high an inflation stands over each place of a drawing.
//!
//! Inside the curve the square of the height solves `∇²h = −4` with 0 on the curve, and is scaled such that the
//! highest place is as high as the drawing is deep. A disc of radius R gets R² − r², which is a ball; a strip of
//! half-width w gets w² − x², which is a round bar. No ridges: the solution is smooth wherever the curve is.
//! Outside it goes on below 0, with the same slope across the curve, to where it follows from the distance alone.

mod extend;
mod poisson;

use super::blend::{rise, sharpened};
use blobtree::{FieldImage, ParameterError};
use extend::Slopes;
use poisson::Poisson;
use rayon::prelude::*;

/// Up to how many pixels outside the true distance holds, and where it has given way to the smoothed one.
const NEAR: [f32; 2] = [2.0, 10.0];

/// How far outside the slope on the curve is felt, as a share of the falloff.
const FELT: f32 = 0.9;

/// The bulge of a template, as fine as the image of its distance.
///
/// - **In:** the smoothed signed distance, right to about `falloff` outside; the true one at its samples; the
///   largest distance inside; mm.
/// - **Out:** as [`blobtree::Template::bulge`] says, mm².
/// - **Promises:** any number of threads gives the same bytes.
/// - **Cost:** some 20 passes over the samples inside, 10 over all.
pub(super) fn bulge(
    distance: &FieldImage,
    exact: &[f64],
    depth: f32,
    falloff: f32,
) -> Result<FieldImage, ParameterError> {
    let [width, height] = distance.size();
    // In pixels.
    let read = nodes(distance, exact);
    let inside = Poisson::new(&read, [width, height]).solve();
    let highest = inside.iter().copied().fold(0.0, f32::max);
    if highest <= 0.0 {
        // Too thin for the image.
        return Ok(distance.bulge(depth));
    }
    let scale = (depth / distance.pixel()).powi(2) / highest;
    let slopes = Slopes::new(&inside, &read, width).spread();
    let unit = distance.pixel();
    let felt = FELT * falloff;
    let mut samples = inside;
    let rows = samples.par_chunks_mut(width).zip(read.par_chunks(width)).zip(slopes.par_chunks(width));
    rows.for_each(|((samples, read), slopes)| {
        for ((sample, read), slope) in samples.iter_mut().zip(read).zip(slopes) {
            let s = unit * read;
            *sample = if s < 0.0 {
                *sample * scale * unit * unit
            } else {
                below(s, (slope * scale * unit).min(6.0 * depth), depth, felt)
            };
        }
    });
    FieldImage::new(distance.origin(), distance.pixel(), distance.size(), sharpened(&samples, width))
}

/// The bulge at the distance `s` outside, near a place on the curve with this slope; far out, beyond `felt`,
/// `depth² − (depth + s)²`.
///
/// It falls with `s` as long as the slope is less than ten times the depth.
fn below(s: f32, slope: f32, depth: f32, felt: f32) -> f32 {
    let near = (1.0 - s / felt).max(0.0).powi(3);
    let far = 2.0 * depth;
    -s * (s + far + near * (slope - far))
}

/// The distance at the samples, in pixels: the true one inside and close to the curve, which thus stays where it was
/// drawn, and what the image reads farther out, where the true one has kinks.
fn nodes(image: &FieldImage, exact: &[f64]) -> Vec<f32> {
    let [width, height] = image.size();
    let (samples, inverse) = (image.samples(), image.pixel().recip());
    let row = |row: usize| &samples[row * width..][..width];
    let mut nodes = vec![0.0; samples.len()];
    nodes.par_chunks_mut(width).zip(exact.par_chunks(width)).enumerate().for_each(|(y, (line, exact))| {
        let rows = [row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1))];
        let across = |x: usize| rows[0][x] + 6.0 * rows[1][x] + rows[2][x];
        for (x, (out, exact)) in line.iter_mut().zip(exact).enumerate() {
            let exact = *exact as f32 * inverse;
            let smooth = rise(f64::from((exact - NEAR[0]) / (NEAR[1] - NEAR[0]))) as f32;
            *out = exact;
            if smooth > 0.0 {
                let sum = across(x.saturating_sub(1)) + 6.0 * across(x) + across((x + 1).min(width - 1));
                *out += smooth * (inverse / 64.0 * sum - exact);
            }
        }
    });
    nodes
}

#[cfg(test)]
mod tests;
