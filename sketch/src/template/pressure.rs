//! How hard the pen pressed, spread from the strokes over the plane.

use crate::thin_plate::Grid;
use glam::DVec2;
use rayon::prelude::*;

/// Pressures nearer to each other than this are alike.
const ALIKE: f32 = 0.02;

/// Most places that are used; more are thinned evenly.
const MOST: usize = 400;

/// Samples along the longer side: pressure varies slowly.
const PIXELS: f64 = 64.0;

/// The pressure on a coarse grid over the same area, a mean weighed by nearness; none if it is the same
/// everywhere.
///
/// The weights `1/(d² + s²)²` give nearly the pressure of the pen on the strokes and fade between them; `s` is a
/// fortieth of the longer side of the grid.
pub(super) fn image(pressure: &[(DVec2, f32)], over: &Grid) -> Option<(Grid, Vec<f32>)> {
    let mut known: Vec<(DVec2, f32)> =
        pressure.iter().copied().filter(|(at, p)| at.is_finite() && p.is_finite()).collect();
    known.iter_mut().for_each(|(_, p)| *p = p.clamp(0.0, 1.0));
    let least = known.iter().map(|(_, p)| *p).fold(f32::INFINITY, f32::min);
    let largest = known.iter().map(|(_, p)| *p).fold(f32::NEG_INFINITY, f32::max);
    // Also false where nothing is known.
    let varies = largest - least > ALIKE;
    if !varies {
        return None;
    }
    let known: Vec<(DVec2, f32)> = known.iter().copied().step_by(known.len().div_ceil(MOST)).collect();
    let extent = over.size.map(|n| over.pixel * (n - 1) as f64);
    let longer = extent[0].max(extent[1]);
    let pixel = longer / PIXELS;
    let grid = Grid {
        origin: over.origin,
        pixel,
        size: extent.map(|e| (e / pixel).ceil() as usize + 1).map(|n| n.max(3)),
    };
    let blur = (longer / 40.0).powi(2);
    let width = grid.size[0];
    let sample = |i: usize| {
        let p = grid.at(i % width, i / width);
        let (mut sum, mut weights) = (0.0, 0.0);
        for (at, pressure) in &known {
            let weight = (blur / (at.distance_squared(p) + blur)).powi(2);
            weights += weight;
            sum += weight * f64::from(*pressure);
        }
        (sum / weights) as f32
    };
    Some((grid, (0..width * grid.size[1]).into_par_iter().map(sample).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_is_kept_on_the_strokes_and_lies_between_them_elsewhere() {
        let over = Grid { origin: DVec2::ZERO, pixel: 1.0, size: [101, 51] };
        let line = |y: f64, p: f32| (0..=50).map(move |i| (DVec2::new(2.0 * f64::from(i), y), p));
        let strokes: Vec<_> = line(0.0, 0.2).chain(line(50.0, 0.9)).collect();
        let (grid, samples) = image(&strokes, &over).expect("the pressure varies");
        let at = |y: f64| samples[(y / grid.pixel).round() as usize * grid.size[0] + grid.size[0] / 2];
        assert!((at(0.0) - 0.2).abs() < 0.02 && (at(50.0) - 0.9).abs() < 0.02);
        assert!((at(25.0) - 0.55).abs() < 0.02);
        assert!(samples.iter().all(|p| (0.2..=0.9).contains(p)));
    }

    #[test]
    fn a_pressure_that_never_varies_or_is_unknown_gives_no_image() {
        let over = Grid { origin: DVec2::ZERO, pixel: 1.0, size: [10, 10] };
        assert!(image(&[(DVec2::ZERO, 0.5), (DVec2::ONE, 0.51)], &over).is_none());
        assert!(image(&[(DVec2::ZERO, f32::NAN), (DVec2::NAN, 0.1)], &over).is_none());
        assert!(image(&[], &over).is_none());
    }
}
