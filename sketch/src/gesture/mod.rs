//! Strokes that are commands: erase, smooth, undo, select the parent, press a button.
//!
//! [`recognise`] is a pure function of a stroke and of what is on the screen. It knows no pixel sizes: every
//! threshold is a part of the screen, of the button, or of the stroke itself, or a number of turns or passes.
//! A gesture is only seen where it can mean something. Drawings are full of zigzags, spirals and straight
//! lines; what tells a gesture from them is, next to its form, what lies under it and how fast it was drawn.
//! A stroke that is no gesture belongs to the sketch. What a gesture does, the caller does: see
//! [`crate::stroke::Sketch`].
//!
//! **Source:** Schmidt & Wyvill 2011, §11.2.1, §11.2.2 and §11.2.4. **Departs:** where the paper's system asks
//! for a gesture's form only, this one also asks for its sense: an eraser must cross something, a circle must
//! hold something.

mod along;
mod circle;
mod crossing;
mod line;
mod scribble;
mod trace;

pub use crossing::Button;

use crate::stroke::{OrientedBox, Sketch, Stroke};
use glam::Vec2;
use trace::Trace;

/// What is on the screen when a stroke is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The size of the drawing area, pixels.
    pub screen: Vec2,
    /// The sketch so far, not yet a shape.
    pub sketch: &'a Sketch,
    /// The outline on the screen of the selected node, pixels; `None` if nothing is selected. Four corners of
    /// its box will do.
    pub selected: Option<&'a [Vec2]>,
    /// The buttons, those on top first.
    pub buttons: &'a [Button],
}

/// A stroke understood as a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Gesture {
    /// A stroke across a button, given by its place in [`Context::buttons`].
    Press(usize),
    /// A scribble: remove the samples in this box.
    Erase(OrientedBox),
    /// A scribble over the selected node, and no sketch there: remove the node.
    Remove,
    /// Two circles or more: smooth the samples inside this polygon.
    Smooth(Vec<Vec2>),
    /// A quick stroke to the left: take back the last stroke.
    Undo,
    /// A line straight upwards: select the parent of the selected node.
    SelectParent,
}

/// The command that a finished stroke means here; `None` if it is a drawing.
///
/// The stroke needs not be cleaned. Strokes of the eraser end are no gestures: they erase as they go.
/// Where samples have no times, the gestures that must be fast are not seen.
/// **Cost:** linear in the stroke and in the sketch.
pub fn recognise(stroke: &Stroke, context: &Context) -> Option<Gesture> {
    if stroke.eraser || !context.screen.is_finite() || context.screen.min_element() <= 0.0 {
        return None;
    }
    let trace = Trace::of(stroke)?;
    crossing::pressed(&trace, context)
        .map(Gesture::Press)
        .or_else(|| circle::smoothed(&trace, context))
        .or_else(|| scribble::erased(&trace, context))
        .or_else(|| line::read(&trace, context))
}
