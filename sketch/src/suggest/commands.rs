//! The commands behind the suggestions.

use super::companion::Companion;
use super::rules::Icon;
use super::surface::{Surface, drawn_on, plain};
use super::{Request, tubes};
use crate::solid::Outline;
use crate::stroke::{SketchStroke, resample};
use blobtree::{
    Command, LinearSweep, Node, NodePath, NodeRef, Operator, Primitive, RevolutionAxis, Shape, Sharpness,
};
use glam::{Vec2, Vec3};

/// The first radius of tubes on the surface, as a part of the sketch's larger side.
const TUBE: f32 = 0.025;

/// How far a cut reaches beyond the model, as a part of the model's depth: so that no skin stays.
const BEYOND: f32 = 0.02;

/// Points of a path along which an outline is moved.
const PATH_POINTS: f32 = 64.0;

/// What the strokes are, in the sketch plane.
pub(super) struct Sketched<'a> {
    pub request: &'a Request<'a>,
    /// The node on which commands work, in the model's own space.
    pub target: NodePath,
    /// The depth of the plane, mm.
    pub depth: f32,
    /// What they enclose; none if they do not close.
    pub outline: Option<Outline>,
    /// The stroke beside the outline.
    pub companion: Companion,
}

impl Sketched<'_> {
    /// The command behind a suggestion; `None` if it would do nothing.
    pub fn command(&self, icon: Icon) -> Option<Command> {
        if icon == Icon::DrawOn {
            return self.combined(Operator::Union, self.tubes()?);
        }
        let outline = self.outline.as_ref()?;
        let (operator, primitive) = match icon {
            Icon::BlendOn => (Operator::Blend(Sharpness::DEFAULT), Primitive::Inflation(outline.inflation())),
            Icon::CutHole | Icon::CutAcross => {
                (Operator::Difference, Primitive::LinearSweep(self.cutter(outline)?))
            }
            Icon::Sweep => (Operator::Union, Primitive::LinearSweep(outline.sweep())),
            Icon::Revolve => (Operator::Union, Primitive::Revolution(outline.revolution(self.axis()))),
            Icon::SweepAlong => (Operator::Union, Primitive::PathSweep(outline.path_sweep(self.path()))),
            Icon::Inflate | Icon::DrawOn => (Operator::Union, Primitive::Inflation(outline.inflation())),
        };
        self.combined(operator, Node::new(Shape::Primitive(primitive)).into())
    }

    /// Puts a node beside the target: among its children if it is such an operator, else around both.
    fn combined(&self, operator: Operator, node: NodeRef) -> Option<Command> {
        let target = self.target.find(self.request.root)?;
        let children = target.children().len();
        match &target.shape {
            Shape::Operator(own, _) if *own == operator || children == 0 => {
                Some(Command::Insert { parent: self.target.clone(), index: children, node })
            }
            _ => {
                let both = Node::new(Shape::Operator(operator, vec![target.clone(), node]));
                Some(Command::Replace { path: self.target.clone(), node: both.into() })
            }
        }
    }

    /// A sweep through all of the target.
    fn cutter(&self, outline: &Outline) -> Option<LinearSweep> {
        let target = self.target.find_alone(self.request.root)?;
        let [near, far] = Surface::new(&target).depths(&self.request.view);
        let length = (far - near) * (1.0 + 2.0 * BEYOND);
        let offset = self.depth - 0.5 * (near + far);
        (length > 0.0).then(|| LinearSweep { length, offset, ..outline.sweep() })
    }

    /// The straight stroke beside the outline.
    fn axis(&self) -> Option<RevolutionAxis> {
        let placement = self.request.view.placement(self.depth);
        let path = &self.companion.path;
        let (from, to) = path.first().zip(path.last()).filter(|_| self.companion.is_axis())?;
        let at = placement.mm_from_px(*from);
        Some(RevolutionAxis { at, direction: placement.mm_from_px(*to) - at })
    }

    /// The stroke beside the outline in space: on the surface where it lies on that from end to end, else in the
    /// sketch plane.
    fn path(&self) -> Vec<Vec3> {
        let (view, path) = (&self.request.view, &self.companion.path);
        let surface = Surface::new(&drawn_on(self.request.root));
        let on_surface: Option<Vec<Vec3>> =
            path.iter().map(|px| Some(surface.under(view, *px)?.point)).collect();
        on_surface.unwrap_or_else(|| path.iter().map(|px| view.at_depth(*px, self.depth)).collect())
    }

    fn tubes(&self) -> Option<NodeRef> {
        let Request { sketch, view, root, .. } = self.request;
        let [lo, hi] = sketch.bounds()?;
        let extent = (hi - lo).max_element() * view.mm_per_px(self.depth);
        let radius = if extent > 0.0 { TUBE * extent } else { view.mm_per_px(self.depth) };
        tubes::tubes(sketch, view, &Surface::new(&drawn_on(root)), radius)
    }
}

/// Places along a stroke of a sketch, few enough for a path.
pub(super) fn path_of(stroke: &SketchStroke) -> Vec<Vec2> {
    let stroke = plain(stroke);
    resample(&stroke, stroke.length() / PATH_POINTS).places().collect()
}
