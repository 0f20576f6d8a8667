//! Quick straight strokes: to the left takes back, upwards selects the parent.

use super::trace::Trace;
use super::{Context, Gesture};
use glam::Vec2;

/// How far a flick may leave the line between its ends, as a part of it. A flick of the wrist is an arc that sags
/// by 0.05; a drawn eyebrow sags by 0.1 and more.
const SAG_LEFT: f32 = 0.06;

/// How far a line upwards may: arms that mean it draw arcs that sag by 0.04, sides of vases sag by 0.05.
const SAG_UP: f32 = 0.046;

/// How much longer a straight stroke may be than the line between its ends: 1.01 with a shaking hand, 1.03 where
/// a drawn line begins with a hook.
const DETOUR: f32 = 1.02;

/// The tangent of the angle by which a flick may miss the left, 20°: hands turn by up to 15° about the elbow,
/// and 45° is no side at all.
const SLANT_LEFT: f32 = 0.364;

/// The tangent of the angle by which a line may miss the top of the screen, 10°: people stray by less, and
/// roofs, legs and rays that are drawn upwards lean by 11° and more.
const SLANT_UP: f32 = 0.176;

/// Shortest and longest gesture, as parts of the screen's side along which it goes. Short strokes of drawings are
/// up to 0.08 long, flicks 0.1 and more; a wrist reaches over 0.45 of it, masts and walls go on beyond half.
const LENGTHS: [f32; 2] = [0.09, 0.5];

/// Slowest flick, in widths of the screen a second. Lines are drawn at up to 0.8; flicks have 1.5 to 5.
const FLICK: f32 = 1.2;

/// Slowest line upwards, in heights of the screen a second: quick drawers begin with lines at up to 1.4, those who
/// mean it have 1.5 and more.
const LINE_UP: f32 = 1.45;

/// How near both ends of a stroke come to lines of the sketch if it joins them, as a part of the stroke's length:
/// bottoms of boxes and rungs of ladders miss by up to 0.05, a flick ends where it happens to.
const JOINED: f32 = 0.06;

/// What a straight stroke means here.
///
/// A line upwards is only looked for while there is no sketch: lines drawn beside other lines belong to them.
pub(super) fn read(trace: &Trace, context: &Context) -> Option<Gesture> {
    let speed = trace.speed()? / context.screen;
    let along = trace.last() - trace.first();
    let part = along / context.screen;
    let long = |part: f32| (LENGTHS[0]..=LENGTHS[1]).contains(&part);
    let to_the_left = long(-part.x) && along.y.abs() <= SLANT_LEFT * along.x.abs() && speed.x >= FLICK;
    let upwards = long(-part.y) && along.x.abs() <= SLANT_UP * along.y.abs() && speed.y >= LINE_UP;
    if to_the_left && !context.sketch.is_empty() && is_straight(trace, along, SAG_LEFT) {
        (!joins_lines(trace, context)).then_some(Gesture::Undo)
    } else {
        let free = context.sketch.is_empty() && context.selected.is_some();
        (upwards && free && is_straight(trace, along, SAG_UP)).then_some(Gesture::SelectParent)
    }
}

fn is_straight(trace: &Trace, along: Vec2, sag: f32) -> bool {
    let chord = along.length();
    let far = sag * chord * chord;
    trace.length <= DETOUR * chord
        && trace.points.iter().all(|p| (p - trace.first()).perp_dot(along).abs() <= far)
}

/// Whether the stroke goes from one line of the sketch to another, as strokes of a drawing do.
fn joins_lines(trace: &Trace, context: &Context) -> bool {
    let near = (JOINED * trace.length).powi(2);
    let touches = |end: Vec2| {
        let strokes = context.sketch.strokes.iter();
        strokes.flat_map(|stroke| stroke.samples.windows(2)).any(|pair| {
            let (a, b) = (pair[0].pen.place(), pair[1].pen.place());
            let share = ((end - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            end.distance_squared(a.lerp(b, if share.is_finite() { share } else { 0.0 })) <= near
        })
    };
    touches(trace.first()) && touches(trace.last())
}
