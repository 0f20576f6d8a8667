//! The expectation list: what a sketch might become.
//!
//! [`suggest`] looks at a sketch over a model and gives suggestions, the likeliest first, each with an icon, a
//! colour, a name, a sentence, and the one command that does it. It decides nothing and changes nothing.
//!
//! The sketch plane is parallel to the screen. It goes through the mean depth of what lies under the strokes:
//! of the selected part alone, if one is selected; without anything under them, through the origin. People find
//! guessed depths hard to foresee, so a caller can also say where the plane is to be.
//!
//! **Source:** Schmidt & Wyvill 2011, §11.2.1 and §11.2.3.

mod commands;
mod companion;
mod rules;
mod surface;
mod tubes;
mod view;

pub use rules::Icon;
pub use surface::Coverage;
pub use view::{Projection, Ray, View};

use crate::solid::Outline;
use crate::stroke::Sketch;
use blobtree::{Color, Command, Drawing, NodePath, NodeRef, Shape, SketchPlane, Template};
use commands::Sketched;
use companion::Companion;
use glam::Vec3;
use rules::Facts;
use std::sync::Arc;
use surface::{Surface, drawn_on};

/// A sketch over a model.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The strokes, pixels on the view's screen.
    pub sketch: &'a Sketch,
    /// How the model is seen.
    pub view: View,
    /// The model.
    pub root: &'a NodeRef,
    /// The selected part of it.
    pub selected: Option<&'a NodePath>,
    /// The depth of the sketch plane before the eye, mm; `None` to find it from what lies under the strokes.
    pub depth: Option<f32>,
}

/// Whoever finds the outline of a drawing, in mm.
pub trait Outlines {
    /// Why a drawing has none.
    type Reason;

    /// The strokes of the drawing that are no part of its outline, by place, ascending.
    ///
    /// Errors: why there is no outline.
    fn left_out(&self, drawing: &Drawing) -> Result<Vec<usize>, Self::Reason>;

    /// The field of a drawing all of whose strokes are part of its outline.
    ///
    /// Errors: why there is none.
    fn template(&self, drawing: &Drawing) -> Result<Arc<Template>, Self::Reason>;
}

/// What a sketch might become. `R` is why it has no outline.
#[derive(Clone, Debug)]
pub struct Expectations<R> {
    /// The suggestions, the likeliest first.
    pub suggestions: Vec<Suggestion>,
    /// How much of the sketch lies on the model, or on the selected part of it.
    pub coverage: Coverage,
    /// The depth of the sketch plane before the eye, mm: where a handle for it goes.
    pub depth: f32,
    /// The sketch plane.
    pub plane: SketchPlane,
    /// Why nothing is suggested that needs a closed outline.
    pub no_outline: Option<R>,
}

/// Something to do with a sketch.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// What it is; the picture that stands for it.
    pub icon: Icon,
    /// The colour of its picture.
    pub color: Color,
    /// Its name, as on a button.
    pub name: &'static str,
    /// What it does, said to a child.
    pub sentence: &'static str,
    /// What does it.
    pub command: Command,
}

/// The nearest that a sketch plane may be to the eye of a perspective view, mm.
const NEAREST_PLANE: f32 = 1.0;

/// What a sketch might become, the likeliest first.
///
/// **Cost:** some hundred rays, and what it takes to find the outline once. **Errors:** none; an empty sketch, or
/// one that can become nothing, has no suggestions.
pub fn suggest<O: Outlines>(request: &Request, outlines: &O) -> Expectations<O::Reason> {
    let Lie { coverage, drawable, depth } = Lie::of(request);
    let plane = request.view.plane(depth);
    let placement = request.view.placement(depth);
    let drawing = placement.drawing(request.sketch);
    let found = outlines.left_out(&drawing).and_then(|left_out| {
        let drawing = without(drawing, &left_out);
        let template = outlines.template(&drawing)?;
        let companion = Companion::of(request.sketch, &left_out, &template, &placement);
        Ok((Outline { drawing: Arc::new(drawing), plane, template }, companion))
    });
    let (outline, companion, no_outline) = match found {
        Ok((outline, companion)) => (Some(outline), companion, None),
        Err(reason) => (None, Companion::default(), Some(reason)),
    };
    let facts = Facts {
        closed: outline.is_some(),
        path: !companion.path.is_empty(),
        meant: companion.meant,
        axis: companion.is_axis(),
        coverage,
        drawable,
    };
    let sketched = Sketched { request, target: target(request), depth, outline, companion };
    let suggestions = rules::ranked(&facts).into_iter().filter_map(|icon| {
        let command = sketched.command(icon)?;
        Some(Suggestion { icon, color: icon.color(), name: icon.name(), sentence: icon.sentence(), command })
    });
    Expectations { suggestions: suggestions.collect(), coverage, depth, plane, no_outline }
}

/// The drawing without some of its strokes: those beside an outline are no part of the node that it becomes.
fn without(mut drawing: Drawing, left_out: &[usize]) -> Drawing {
    let strokes = std::mem::take(&mut drawing.strokes).into_iter().enumerate();
    drawing.strokes = strokes.filter(|(i, _)| !left_out.contains(i)).map(|(_, stroke)| stroke).collect();
    drawing
}

/// Where a sketch lies.
struct Lie {
    /// On the model, or on the selected part of it.
    coverage: Coverage,
    /// Whether anything under it can be drawn on.
    drawable: bool,
    /// The depth of the sketch plane, mm.
    depth: f32,
}

impl Lie {
    fn of(request: &Request) -> Self {
        let Request { sketch, view, root, selected, depth } = *request;
        let selected = selected.filter(|path| !path.0.is_empty()).and_then(|path| path.find_alone(root));
        let model = selected.as_ref().unwrap_or(root);
        let on_model = Surface::new(model).found(&view, sketch);
        let all = drawn_on(root);
        let on_all =
            if NodeRef::ptr_eq(&all, model) { on_model } else { Surface::new(&all).found(&view, sketch) };
        // Construction nodes are made to draw on, so they say how deep, too, unless a part is selected.
        let found = if selected.is_some() { on_model.depth } else { on_all.depth };
        let inferred = || found.unwrap_or_else(|| view.depth(Vec3::ZERO));
        let depth = depth.filter(|depth| depth.is_finite()).unwrap_or_else(inferred);
        let depth = match view.projection {
            Projection::Orthographic { .. } => depth,
            Projection::Perspective { .. } => depth.max(NEAREST_PLANE),
        };
        Self { coverage: on_model.coverage, drawable: on_all.coverage != Coverage::Beside, depth }
    }
}

/// The node on which commands work: the selected one, or the warp above it that is the outermost, below which
/// the sketch plane would not be where it was seen; the root if nothing is selected.
fn target(request: &Request) -> NodePath {
    let path = request.selected.cloned().unwrap_or_default();
    let above = (0..path.0.len()).map(|len| NodePath(path.0[..len].to_vec()));
    let is_warp =
        |path: &NodePath| path.find(request.root).is_some_and(|node| matches!(node.shape, Shape::Warp(..)));
    let target = above.into_iter().find(is_warp).unwrap_or(path);
    if target.find(request.root).is_some() { target } else { NodePath::default() }
}
