//! Scribbling over something: erase it.

use super::along::lies_along;
use super::trace::Trace;
use super::{Context, Gesture};
use crate::stroke::{OrientedBox, bounds, is_inside};
use glam::Vec2;

/// Fewest passes of the pen, forth and back counted singly. Letters such as M, W and lightning have up to five;
/// people who rub something out make seven and more.
const PASSES: usize = 6;

/// The least length of a pass, as a part of the scribble's extent along its passes. Below 0.3, wiggles at the
/// end of a pass count as passes; tired hands let passes shrink to half.
const PASS: f32 = 0.4;

/// The least part of the stroke's length that its passes make up. Rubbing, round turns included, has 0.8;
/// outlines that come and go, such as fingers and flowers, have less than 0.6.
const STRAIGHTNESS: f32 = 0.65;

/// How far one pass may lie beside the one before, in lengths of a pass. Hair, grass and saw teeth go on by 0.3
/// and more; a wide eraser goes on by 0.2.
const ADVANCE: f32 = 0.25;

/// The least number of lines of the sketch that a pass crosses, on average. Rubbing crosses what it is to erase
/// with every pass, or every second where it begins beside it; hatching stays within its outline but for slips
/// at every third pass.
const CROSSINGS: f32 = 0.45;

/// The least diagonal, as a part of the screen's shorter side: smaller ones are dots of a shaking hand. The eye
/// of a drawn cat is twice as large.
const SMALLEST: f32 = 0.03;

/// Fewest passes over a node, where no lines are there to be crossed: a zigzag drawn on a shape has fewer.
const PASSES_OVER_NODE: usize = 8;

/// Slowest scribble over a node, in shorter sides of the screen a second: hatching on a shape is drawn at up to
/// 1.5, people rub at 3 and more.
const SPEED_OVER_NODE: f32 = 2.0;

/// Directions of boxes that are tried: every 2.5°, which costs at most 4 % of the box's width at its ends.
const DIRECTIONS: usize = 36;

/// What a scribble erases here; `None` if it is none.
pub(super) fn erased(trace: &Trace, context: &Context) -> Option<Gesture> {
    let axis = pass_direction(trace)?;
    let passes = passes(trace, axis)?;
    let area = smallest_box(trace);
    let side = context.screen.min_element();
    if passes < PASSES || trace.diagonal < SMALLEST * side {
        return None;
    }
    let over_lines = crossings(trace, &area, context) >= CROSSINGS * passes as f32;
    if over_lines || lies_along(trace, axis, context.sketch) {
        return Some(Gesture::Erase(area));
    }
    let over_node = context.sketch.is_empty()
        && context.selected.is_some_and(|outline| is_inside(outline, area.center))
        && trace.speed().is_some_and(|speed| speed >= SPEED_OVER_NODE * side);
    (over_node && passes >= PASSES_OVER_NODE).then_some(Gesture::Remove)
}

/// The number of passes along the axis of a stroke that goes back and forth over one place; `None` for others.
fn passes(trace: &Trace, axis: Vec2) -> Option<usize> {
    let ends = turning_points(trace, axis);
    let lengths: f32 = ends.windows(2).map(|pair| (ends_apart(trace, pair, axis)).abs()).sum();
    let passes = ends.len().checked_sub(1).filter(|passes| *passes > 0)?;
    let across = OrientedBox::around(trace.points.iter().copied(), axis)?.half.y * 2.0;
    // The passes lie side by side, so their mean distance follows from how wide they are together.
    let advance = across / lengths;
    (lengths >= STRAIGHTNESS * trace.length && advance <= ADVANCE).then_some(passes)
}

fn ends_apart(trace: &Trace, pair: &[usize], axis: Vec2) -> f32 {
    (trace.points[pair[1]] - trace.points[pair[0]]).dot(axis)
}

/// The direction in which most of the line runs, forth or back.
fn pass_direction(trace: &Trace) -> Option<Vec2> {
    // Doubled angles make forth and back the same.
    let doubled = |step: Vec2| step.try_normalize().map_or(Vec2::ZERO, |unit| step.rotate(unit));
    let sum: Vec2 = trace.points.windows(2).map(|pair| doubled(pair[1] - pair[0])).sum();
    (sum.length() > 0.0).then(|| Vec2::from_angle(0.5 * sum.to_angle()))
}

/// The ends of the passes along the axis: where the line turns back, and where it starts and ends.
fn turning_points(trace: &Trace, axis: Vec2) -> Vec<usize> {
    let along: Vec<f32> = trace.points.iter().map(|p| p.dot(axis)).collect();
    let lo = along.iter().copied().fold(f32::MAX, f32::min);
    let hi = along.iter().copied().fold(f32::MIN, f32::max);
    let swing = PASS * (hi - lo);
    let (mut least, mut most, mut rising) = (0, 0, None);
    let mut ends = Vec::new();
    for (i, &x) in along.iter().enumerate() {
        if x < along[least] {
            least = i;
        }
        if x > along[most] {
            most = i;
        }
        let falls = rising != Some(false) && along[most] - x >= swing;
        let rises = rising != Some(true) && x - along[least] >= swing;
        if falls || rises {
            ends.push(if falls { most } else { least });
            rising = Some(rises && !falls);
            (least, most) = (i, i);
        }
    }
    ends.extend(rising.map(|rising| if rising { most } else { least }));
    ends
}

/// How many lines of the sketch the scribble crosses, each time counted. Dots in its box, which have no line to
/// be crossed, count as much as it takes.
fn crossings(trace: &Trace, area: &OrientedBox, context: &Context) -> f32 {
    let Some([lo, hi]) = bounds(trace.points.iter().copied()) else { return 0.0 };
    let near = |c: Vec2, d: Vec2| c.min(d).cmple(hi).all() && c.max(d).cmpge(lo).all();
    let mut count = 0;
    for stroke in &context.sketch.strokes {
        if let [dot] = stroke.samples.as_slice()
            && area.contains(dot.pen.place())
        {
            return f32::INFINITY;
        }
        for pair in stroke.samples.windows(2) {
            let (c, d) = (pair[0].pen.place(), pair[1].pen.place());
            if !near(c, d) {
                continue;
            }
            count += trace.points.windows(2).filter(|ab| cross(ab[0], ab[1], c, d)).count();
        }
    }
    count as f32
}

fn cross(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// The box of the least area around the stroke, among boxes in 36 directions.
fn smallest_box(trace: &Trace) -> OrientedBox {
    let area = |b: &OrientedBox| b.half.x * b.half.y;
    (0..DIRECTIONS)
        .filter_map(|i| {
            let angle = std::f32::consts::FRAC_PI_2 * i as f32 / DIRECTIONS as f32;
            OrientedBox::around(trace.points.iter().copied(), Vec2::from_angle(angle))
        })
        .min_by(|a, b| area(a).total_cmp(&area(b)))
        .expect("a trace has points")
}
