//! What lies under a sketch: rays through its strokes.

use super::view::View;
use crate::stroke::{Sketch, SketchStroke, Stroke, resample};
use blobtree::{Aabb, Field, Node, NodePath, NodeRef, Operator, Shape, Tree, cast_ray};
use glam::{Vec2, Vec3};

/// Rays for a whole sketch: enough to tell 3 % of it, few enough for every stroke to be answered at once.
const RAYS: f32 = 160.0;

/// The part of a sketch that may miss the surface, or hit it, by slips of the hand at its edge.
const SLIP: f32 = 0.03;

/// The least detail that rays see, as a part of the model's longest side.
const DETAIL: f32 = 1.0 / 1024.0;

/// How much of a sketch lies on the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Nothing: it is drawn beside the model, or around it, or there is none.
    Beside,
    /// Some: it crosses the silhouette.
    Across,
    /// All: it lies inside the silhouette.
    Inside,
}

/// A model as rays see it.
pub(super) struct Surface {
    tree: Tree,
    support: Aabb,
}

/// A place on a surface under a stroke.
#[derive(Clone, Copy, Debug)]
pub(super) struct Under {
    pub point: Vec3,
    pub depth: f32,
}

/// What rays through a sketch found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub coverage: Coverage,
    /// The mean depth of the hits, mm.
    pub depth: Option<f32>,
}

impl Surface {
    pub fn new(node: &NodeRef) -> Self {
        let tree = Tree::new(node);
        let support = tree.support();
        Self { tree, support }
    }

    pub fn is_empty(&self) -> bool {
        self.support.is_empty()
    }

    /// The least and greatest depth of what there is, mm; of nothing, 0 and 0.
    pub fn depths(&self, view: &View) -> [f32; 2] {
        if self.is_empty() {
            return [0.0; 2];
        }
        let Aabb { min, max } = self.support;
        let corners =
            (0..8).map(|i| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), max, min));
        corners
            .map(|corner| view.depth(corner))
            .fold([f32::MAX, f32::MIN], |[lo, hi], d| [lo.min(d), hi.max(d)])
    }

    /// The surface that a pixel shows.
    pub fn under(&self, view: &View, px: Vec2) -> Option<Under> {
        if self.is_empty() {
            return None;
        }
        let mut ray = view.ray(px);
        if let super::Projection::Orthographic { .. } = view.projection {
            // An orthographic view has no eye: what lies behind its plane is seen as well.
            ray.origin += view.forward * self.depths(view)[0].min(0.0);
        }
        let resolution = DETAIL * self.support.size().max_element();
        let hit = cast_ray(&self.tree, ray.origin, ray.direction, resolution)?;
        Some(Under { point: hit.point, depth: view.depth(hit.point) })
    }

    /// How much of a sketch lies on the surface, and how deep it is there.
    pub fn found(&self, view: &View, sketch: &Sketch) -> Found {
        let (mut rays, mut hits, mut depth) = (0, 0, 0.0);
        for place in spread(sketch) {
            rays += 1;
            if let Some(under) = self.under(view, place) {
                hits += 1;
                depth += f64::from(under.depth);
            }
        }
        let part = hits as f32 / rays.max(1) as f32;
        let coverage = match part {
            part if part <= SLIP => Coverage::Beside,
            part if part < 1.0 - SLIP => Coverage::Across,
            _ => Coverage::Inside,
        };
        let depth = (coverage != Coverage::Beside).then(|| (depth / f64::from(hits)) as f32);
        Found { coverage, depth }
    }
}

/// Places at equal distances along all strokes of a sketch.
fn spread(sketch: &Sketch) -> impl Iterator<Item = Vec2> + '_ {
    let length: f32 = sketch.strokes.iter().map(|stroke| plain(stroke).length()).sum();
    let spacing = length / RAYS;
    // Dots have no length, so each stroke gives at least one place; a sketch of thousands only some of them.
    let every = sketch.strokes.len().div_ceil(2 * RAYS as usize).max(1);
    sketch
        .strokes
        .iter()
        .step_by(every)
        .flat_map(move |stroke| resample(&plain(stroke), spacing).places().collect::<Vec<_>>())
}

/// The stroke of a piece of a sketch.
pub(super) fn plain(stroke: &SketchStroke) -> Stroke {
    Stroke { samples: stroke.samples.iter().map(|sample| sample.pen).collect(), eraser: false }
}

/// All that can be drawn on: the model and the construction nodes, whatever they are part of.
pub(super) fn drawn_on(root: &NodeRef) -> NodeRef {
    let mut all = vec![root.clone()];
    let mut open = vec![NodePath::default()];
    while let Some(path) = open.pop() {
        let Some(node) = path.find(root).filter(|node| !node.muted) else { continue };
        if node.construction {
            all.extend(path.find_alone(root));
        } else {
            open.extend((0..node.children().len()).rev().map(|i| path.child(i)));
        }
    }
    if all.len() == 1 { root.clone() } else { Node::new(Shape::Operator(Operator::Union, all)).into() }
}
