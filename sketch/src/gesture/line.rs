//! Quick straight strokes: to the left takes back, upwards selects the parent.

use super::trace::Trace;
use super::{Context, Gesture};
use glam::Vec2;

/// How far a straight stroke may leave the line between its ends, as a part of it. A flick of the wrist is an
/// arc that sags by 0.05; a drawn eyebrow sags by 0.1 and more.
const SAG: f32 = 0.08;

/// How much longer a straight stroke may be than the line between its ends: 1.03 with a shaking hand, 2 for a
/// line drawn there and back.
const DETOUR: f32 = 1.15;

/// The tangent of the angle by which a flick may miss the left, 20°: hands turn by up to 15° about the elbow,
/// and 45° is no side at all.
const SLANT_LEFT: f32 = 0.364;

/// The tangent of the angle by which a line may miss the top of the screen, 14°: people stray by up to 10°, and
/// roofs, legs and rays that are drawn upwards lean by 20° and more.
const SLANT_UP: f32 = 0.25;

/// Shortest gesture, as a part of the screen's side along which it goes. A dot that slips is 0.02 long; flicks
/// are 0.1 and more.
const SHORTEST: f32 = 0.06;

/// Slowest flick, in widths of the screen a second. Lines are drawn at up to 0.8; flicks have 1.5 to 5.
const FLICK: f32 = 1.2;

/// Slowest line upwards, in heights of the screen a second: as for the flick, on the shorter side.
const LINE_UP: f32 = 1.2;

/// What a straight stroke means here.
///
/// A line upwards is only looked for while there is no sketch: lines drawn beside other lines belong to them.
pub(super) fn read(trace: &Trace, context: &Context) -> Option<Gesture> {
    let speed = trace.speed()? / context.screen;
    let along = trace.last() - trace.first();
    let part = along / context.screen;
    if !is_straight(trace, along) {
        return None;
    }
    let to_the_left = part.x <= -SHORTEST && along.y.abs() <= SLANT_LEFT * along.x.abs() && speed.x >= FLICK;
    let upwards = part.y <= -SHORTEST && along.x.abs() <= SLANT_UP * along.y.abs() && speed.y >= LINE_UP;
    if to_the_left && !context.sketch.is_empty() {
        Some(Gesture::Undo)
    } else if upwards && context.sketch.is_empty() && context.selected.is_some() {
        Some(Gesture::SelectParent)
    } else {
        None
    }
}

fn is_straight(trace: &Trace, along: Vec2) -> bool {
    let chord = along.length();
    let far = SAG * chord * chord;
    trace.length <= DETOUR * chord
        && trace.points.iter().all(|p| (p - trace.first()).perp_dot(along).abs() <= far)
}
