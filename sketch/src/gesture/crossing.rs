//! Buttons are pressed by a stroke across them.

use super::Context;
use super::trace::Trace;
use glam::Vec2;

/// A button on the screen: a level rectangle, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Button {
    /// Its upper left corner.
    pub min: Vec2,
    /// Its lower right corner.
    pub max: Vec2,
}

/// Longest stroke that presses, in diagonals of the button. Strokes across a button are one and a half to three
/// long; outlines that pass behind a button on the drawing are mostly longer than five.
const LONGEST: f32 = 4.0;

/// The least distance between a stroke's ends, as a part of its length: 0.95 for strokes across, 0.8 for a
/// quarter of a small circle behind a button.
const STRAIGHTNESS: f32 = 0.88;

/// The least way through the button, as a part of its shorter side. A stroke that is meant and leaves by the side
/// next to the one where it entered has 0.6 and more, one that clips a corner less than half.
const ACROSS: f32 = 0.55;

/// The button that the stroke crosses first, by its place in the list.
pub(super) fn pressed(trace: &Trace, context: &Context) -> Option<usize> {
    let crossed =
        context.buttons.iter().enumerate().filter_map(|(i, button)| Some((crossed(trace, button)?, i)));
    crossed.min().map(|(_, i)| i)
}

/// Where along the stroke the button is entered, if it is crossed from side to side.
fn crossed(trace: &Trace, button: &Button) -> Option<usize> {
    let size = button.max - button.min;
    let chord = trace.first().distance(trace.last());
    if trace.length > LONGEST * size.length() || chord < STRAIGHTNESS * trace.length {
        return None;
    }
    let outside = |p: Vec2| p.cmplt(button.min).any() || p.cmpgt(button.max).any();
    let enters = trace.points.iter().position(|p| !outside(*p))?;
    let leaves = enters + trace.points[enters..].iter().position(|p| outside(*p))?;
    let (before, after) = (trace.points[enters.checked_sub(1)?], trace.points[leaves]);
    let stays_out = trace.points[leaves..].iter().all(|p| outside(*p));
    (stays_out && before.distance(after) >= ACROSS * size.min_element()).then_some(enters)
}
