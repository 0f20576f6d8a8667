//! Whether a scribble goes along a line of the sketch, back and forth.

use super::trace::Trace;
use crate::stroke::Sketch;
use glam::Vec2;

/// Stretches into which the scribble is divided along its passes: enough to tell half of it, few enough that every
/// pass has places in each.
const STRETCHES: usize = 16;

/// The least part of the stretches in which a line lies under the scribble. Rubbing along a line has 0.8; lines
/// that only end in a scribble, or leave it slantwise, have up to 0.5.
const COVERED: f32 = 0.65;

/// How far inside the scribble's edges the line must lie, as a part of the scribble's width there: hatching that
/// goes along an outline has that outline at its edge.
const INSIDE: f32 = 0.15;

/// How far a line may lie beside a scribble, as a part of its extent along its passes: the slip of a hand that rubs
/// just along the line.
const SLIP: f32 = 0.03;

/// Whether one line or another lies under most of a scribble whose passes have this direction.
/// **Cost:** linear in the scribble and in the part of the sketch below it.
pub(super) fn lies_along(trace: &Trace, axis: Vec2, sketch: &Sketch) -> bool {
    let Some(band) = Band::of(trace, axis) else { return false };
    let mut covered = [false; STRETCHES];
    for stroke in &sketch.strokes {
        for pair in stroke.samples.windows(2) {
            band.cover(&mut covered, [pair[0].pen.place(), pair[1].pen.place()].map(|p| band.local(p)));
        }
    }
    covered.iter().filter(|covered| **covered).count() as f32 >= COVERED * STRETCHES as f32
}

/// Where a line counts as lying under a scribble, stretch by stretch.
struct Band {
    axis: Vec2,
    /// Where the scribble begins along its passes.
    start: f32,
    /// The length of a stretch.
    step: f32,
    /// The least and greatest place across, for each stretch.
    across: [[f32; 2]; STRETCHES],
}

impl Band {
    /// `None` for a scribble without extent along its passes.
    fn of(trace: &Trace, axis: Vec2) -> Option<Self> {
        let along = || trace.points.iter().map(|p| p.dot(axis));
        let (start, end) = (along().fold(f32::MAX, f32::min), along().fold(f32::MIN, f32::max));
        let step = (end - start) / STRETCHES as f32;
        let mut band = Self { axis, start, step, across: [[f32::MAX, f32::MIN]; STRETCHES] };
        if step <= 0.0 {
            return None;
        }
        for p in &trace.points {
            let p = band.local(*p);
            let [lo, hi] = &mut band.across[(p.x as usize).min(STRETCHES - 1)];
            (*lo, *hi) = (lo.min(p.y), hi.max(p.y));
        }
        for [lo, hi] in &mut band.across {
            let margin = INSIDE * (*hi - *lo) - SLIP * (end - start);
            (*lo, *hi) = (*lo + margin, *hi - margin);
        }
        Some(band)
    }

    /// Stretches along the passes, and pixels across.
    fn local(&self, p: Vec2) -> Vec2 {
        Vec2::new((p.dot(self.axis) - self.start) / self.step, p.dot(self.axis.perp()))
    }

    /// Marks the stretches in whose middle the line between two local places lies under the scribble.
    fn cover(&self, covered: &mut [bool; STRETCHES], [a, b]: [Vec2; 2]) {
        let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
        for (i, (covered, [lo, hi])) in covered.iter_mut().zip(self.across).enumerate() {
            let middle = i as f32 + 0.5;
            if left.x <= middle && middle < right.x {
                let y = left.y + (right.y - left.y) * (middle - left.x) / (right.x - left.x);
                *covered |= (lo..=hi).contains(&y);
            }
        }
    }
}
