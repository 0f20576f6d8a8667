//! The solids that an outline can become, with sizes that suit it.

use crate::stroke::bounds;
use blobtree::{
    Drawing, Inflation, LinearSweep, PathSweep, Revolution, RevolutionAxis, SketchPlane, Template,
};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The first thickness of a sweep, as a part of the geometric mean of its drawing's width and height: a biscuit,
/// neither a sheet nor a block.
const THICKNESS: f32 = 0.5;

/// The least size of a shape, mm.
const THINNEST: f32 = 1e-3;

/// A drawing with its outline solved, lying in space.
#[derive(Clone, Debug)]
pub struct Outline {
    /// The strokes.
    pub drawing: Arc<Drawing>,
    /// Where they lie.
    pub plane: SketchPlane,
    /// What was solved from them.
    pub template: Arc<Template>,
}

impl Outline {
    /// The least and greatest coordinates of the curve in its plane, mm.
    pub fn bounds(&self) -> [Vec2; 2] {
        bounds(self.template.contours.iter().flatten().copied()).unwrap_or_default()
    }

    /// Blown up, as round as it is wide.
    pub fn inflation(&self) -> Inflation {
        Inflation::new(self.drawing.clone(), self.plane, self.template.clone())
    }

    /// As thick as a biscuit of its size, half of it on each side of the plane, with sharp edges.
    pub fn sweep(&self) -> LinearSweep {
        let [low, high] = self.bounds();
        let length = (THICKNESS * (high - low).element_product().max(0.0).sqrt()).max(THINNEST);
        LinearSweep::new(self.drawing.clone(), self.plane, self.template.clone(), length)
    }

    /// Turned about an axis; without one, about the upright through its middle.
    pub fn revolution(&self, axis: Option<RevolutionAxis>) -> Revolution {
        let [low, high] = self.bounds();
        let upright = RevolutionAxis { at: 0.5 * (low + high), direction: Vec2::Y };
        Revolution::new(self.drawing.clone(), self.plane, self.template.clone(), axis.unwrap_or(upright))
    }

    /// Moved along a path in space, mm: its middle goes along, wherever the outline was drawn.
    pub fn path_sweep(&self, path: Vec<Vec3>) -> PathSweep {
        let [low, high] = self.bounds();
        let start = path.first().copied().unwrap_or(self.plane.origin);
        let origin = self.plane.origin + start - self.plane.point(0.5 * (low + high));
        let plane = SketchPlane { origin, ..self.plane };
        PathSweep::new(self.drawing.clone(), plane, self.template.clone(), path)
    }
}
