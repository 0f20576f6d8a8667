//! The exact signed distance on a grid, read as the fit and the search for the depth need it.

use super::outline::Outline;
use crate::thin_plate::Grid;
use glam::DVec2;
use std::f64::consts::FRAC_PI_4;

/// The signed distance to a curve on a grid.
pub(super) struct Exact {
    pub grid: Grid,
    /// Row by row, below 0 inside.
    pub samples: Vec<f64>,
}

impl Exact {
    /// Exact up to the distance `reach`; beyond it, up to a fifth more.
    pub fn new(outline: &Outline, grid: Grid, reach: f64) -> Self {
        Self { samples: outline.image(&grid, reach), grid }
    }

    /// The distance at a place, interpolated between four samples; right to a pixel's share where it has kinks.
    pub fn near(&self, p: DVec2) -> f64 {
        let [width, height] = self.grid.size;
        let last = DVec2::new((width - 1) as f64, (height - 1) as f64);
        let at = ((p - self.grid.origin) / self.grid.pixel).clamp(DVec2::ZERO, last);
        let (x, y) = ((at.x as usize).min(width - 2), (at.y as usize).min(height - 2));
        let t = at - DVec2::new(x as f64, y as f64);
        let along = |row: usize| {
            let pair = &self.samples[row * width + x..][..2];
            pair[0] + t.x * (pair[1] - pair[0])
        };
        along(y) + t.y * (along(y + 1) - along(y))
    }

    /// Every `stride`th sample along x and y.
    pub fn coarser(&self, stride: usize) -> Self {
        let [width, height] = self.grid.size;
        let size = [width.div_ceil(stride), height.div_ceil(stride)];
        let rows = self.samples.chunks(width).step_by(stride);
        let samples = rows.flat_map(|row| row.iter().copied().step_by(stride)).collect();
        Self { grid: Grid { pixel: self.grid.pixel * stride as f64, size, ..self.grid }, samples }
    }

    /// The least samples and whatever of `others` is as low, the lowest first, no two within three pixels: places
    /// from which the deepest may be found.
    fn low_places(&self, others: impl Iterator<Item = (DVec2, f64)>) -> Vec<(DVec2, f64)> {
        const MOST: usize = 8;
        let width = self.grid.size[0];
        let all = self.samples.iter().enumerate();
        let places = all.map(|(i, &distance)| (self.grid.at(i % width, i / width), distance));
        let mut places: Vec<(DVec2, f64)> = places.chain(others).collect();
        let least = places.iter().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min);
        // Between samples the distance is at most this much less than at the nearest.
        places.retain(|(_, distance)| *distance <= least + 0.75 * self.grid.pixel);
        places.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut kept: Vec<(DVec2, f64)> = Vec::new();
        for place in places {
            if kept.len() < MOST && kept.iter().all(|k| k.0.distance(place.0) > 3.0 * self.grid.pixel) {
                kept.push(place);
            }
        }
        kept
    }

    /// The largest distance inside: from low places, uphill in ever smaller steps.
    pub fn deepest(&self, outline: &Outline, others: impl Iterator<Item = DVec2>) -> f64 {
        let others = others.filter(|p| p.is_finite()).map(|p| (p, self.near(p)));
        let deepest_from = |(place, _): &(DVec2, f64)| {
            let mut best = (*place, outline.distance(*place));
            let mut step = self.grid.pixel;
            for _ in 0..14 {
                let around = (0..8).map(|k| best.0 + step * DVec2::from_angle(f64::from(k) * FRAC_PI_4));
                match around.map(|p| (p, outline.distance(p))).min_by(|a, b| a.1.total_cmp(&b.1)) {
                    Some(next) if next.1 < best.1 => best = next,
                    _ => step *= 0.5,
                }
            }
            best.1
        };
        -self.low_places(others).iter().map(deepest_from).fold(f64::INFINITY, f64::min)
    }
}
