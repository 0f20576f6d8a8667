//! What the pen's eraser end rubs out.

use super::sketch::{SketchSample, SketchStroke, mixed};
use super::{Stroke, bounds, resample};
use glam::{IVec2, Vec2};

/// How wide the pen's eraser end rubs, as a part of the sketch's larger side: narrower than the gaps between
/// neighbouring lines of common drawings, wider than a hand misses a line by.
pub const ERASER_WIDTH: f32 = 0.04;

/// Cells along the sketch's larger side in which is noted what was rubbed: ten across the eraser.
const CELLS: i32 = 256;

/// A map of where erasers went, so that any number of them costs no more than their length.
pub(super) struct Rubbed {
    corner: Vec2,
    cell: f32,
    size: IVec2,
    /// For each cell how many strokes were there when it was last rubbed.
    latest: Vec<u32>,
}

impl Rubbed {
    /// Erasers over a sketch, each with the number of the next stroke at its time; `None` for a sketch without
    /// samples.
    pub fn by(erasers: &[(u32, Stroke)], sketch: &[SketchStroke]) -> Option<Self> {
        let places = sketch.iter().flat_map(|stroke| &stroke.samples).map(|sample| sample.pen.place());
        let [lo, hi] = bounds(places)?;
        let extent = (hi - lo).max_element();
        let cell = if extent > 0.0 { extent / CELLS as f32 } else { 1.0 };
        let size = ((hi - lo) / cell).as_ivec2() + 1;
        let latest = vec![0; (size.x * size.y) as usize];
        let mut rubbed = Self { corner: lo, cell, size, latest };
        let reach = (0.5 * ERASER_WIDTH * CELLS as f32).round() as i32;
        // Erasers may start beside the sketch, so the map of their lines is wider by their reach.
        let mut lines = Self { corner: lo - cell * reach as f32, size: size + 2 * reach, ..rubbed };
        lines.latest = vec![0; (lines.size.x * lines.size.y) as usize];
        for (order, eraser) in erasers {
            for place in resample(eraser, cell).places() {
                if let Some(at) = lines.index(place) {
                    lines.latest[at] = lines.latest[at].max(*order);
                }
            }
        }
        rubbed.latest = lines.widened(size, reach);
        Some(rubbed)
    }

    fn index(&self, place: Vec2) -> Option<usize> {
        let at = ((place - self.corner) / self.cell).floor().as_ivec2();
        (at.cmpge(IVec2::ZERO).all() && at.cmplt(self.size).all())
            .then(|| (at.y * self.size.x + at.x) as usize)
    }

    /// The latest order within a disc of this radius in cells, for the cells of the inner map.
    fn widened(&self, inner: IVec2, reach: i32) -> Vec<u32> {
        let mut wide = vec![0; (inner.x * inner.y) as usize];
        for (i, order) in self.latest.iter().enumerate().filter(|(_, order)| **order > 0) {
            let at = IVec2::new(i as i32 % self.size.x, i as i32 / self.size.x) - reach;
            for y in (at.y - reach).max(0)..=(at.y + reach).min(inner.y - 1) {
                let half = ((reach * reach - (y - at.y) * (y - at.y)) as f32).sqrt() as i32;
                for x in (at.x - half).max(0)..=(at.x + half).min(inner.x - 1) {
                    let cell: &mut u32 = &mut wide[(y * inner.x + x) as usize];
                    *cell = (*cell).max(*order);
                }
            }
        }
        wide
    }

    /// Whether a place of a stroke is gone.
    fn is_gone(&self, place: Vec2, drawn: usize) -> bool {
        self.index(place).is_some_and(|at| self.latest[at] as usize > drawn)
    }

    /// What is left of a stroke: pieces that end within a cell of the eraser's edge.
    pub fn left_of(&self, stroke: SketchStroke) -> Vec<SketchStroke> {
        let drawn = stroke.drawn;
        let mut pieces: Vec<Vec<SketchSample>> = Vec::new();
        let mut was_gone = true;
        for (i, sample) in stroke.samples.iter().enumerate() {
            if i > 0 {
                let before = &stroke.samples[i - 1];
                let (from, to) = (before.pen.place(), sample.pen.place());
                let steps = (from.distance(to) / self.cell).ceil().clamp(1.0, 2.0 * CELLS as f32);
                for step in 1..steps as usize {
                    let part = step as f32 / steps;
                    let gone = self.is_gone(from.lerp(to, part), drawn);
                    if gone != was_gone {
                        extend(&mut pieces, was_gone, mixed(before, sample, part));
                        was_gone = gone;
                    }
                }
            }
            let gone = self.is_gone(sample.pen.place(), drawn);
            if !gone {
                extend(&mut pieces, was_gone, *sample);
            }
            was_gone = gone;
        }
        pieces.into_iter().map(|samples| SketchStroke { samples, drawn }).collect()
    }
}

/// Adds a sample to the last piece, or to a new one.
fn extend(pieces: &mut Vec<Vec<SketchSample>>, new: bool, sample: SketchSample) {
    match pieces.last_mut() {
        Some(piece) if !new => piece.push(sample),
        _ => pieces.push(vec![sample]),
    }
}
