//! Holes that go through everything: cuts whose length says no more than that.

use crate::placing::world_from_node;
use blobtree::{
    AffineMap, LinearSweep, Node, NodePath, NodeRef, Operator, Primitive, Shape, Tree, Warp, solid_box,
};
use glam::Affine3A;

/// How far a cut reaches beyond what it goes through, as a part of that, so that no skin stays.
const BEYOND: f32 = 0.05;

/// A swept drawing that is cut out of something.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The sweep.
    sweep: LinearSweep,
    /// From end to end of what it is cut out of, mm before the sweep's plane.
    body: [f32; 2],
}

impl Cut {
    /// The node at a path as a cut; `None` if it is no sweep, or is not cut out of anything.
    ///
    /// **Cost:** that of the box around what it is cut out of.
    pub fn of(root: &NodeRef, path: &NodePath) -> Option<Self> {
        let Shape::Primitive(Primitive::LinearSweep(sweep)) = &path.find(root)?.shape else { return None };
        let (place, &index) = (0..path.0.len()).rev().zip(path.0.iter().rev()).find(|(place, _)| {
            let above = NodePath(path.0[..*place].to_vec());
            above.find(root).is_some_and(|node| matches!(node.shape, Shape::Operator(..)))
        })?;
        let above = NodePath(path.0[..place].to_vec());
        let is_cut = matches!(
            above.find(root)?.shape,
            Shape::Operator(Operator::Difference | Operator::BlendDifference(_), _)
        );
        let body = (is_cut && index > 0).then(|| above.child(0).find_alone(root))??;
        let plane_from_world = world_from_plane(sweep, world_from_node(root, path)?)?.inverse();
        let (m, t) = (plane_from_world.matrix3.transpose(), plane_from_world.translation);
        let row = |axis: usize| [m.col(axis).x, m.col(axis).y, m.col(axis).z, t[axis]];
        let map = Warp::Affine(AffineMap { rows: [row(0), row(1), row(2)] });
        let seen = solid_box(&Tree::new(&Node::new(Shape::Warp(map, body))));
        (!seen.is_empty()).then(|| Self { sweep: sweep.clone(), body: [seen.min.z, seen.max.z] })
    }

    /// Whether it goes through everything.
    pub fn is_through(&self) -> bool {
        let [near, far] = [0.5, -0.5].map(|half| self.sweep.offset + half * self.sweep.length);
        far <= self.body[0] && near >= self.body[1]
    }

    /// The same cut, through everything, or only to the middle from the side from which it was drawn.
    pub fn going(&self, through: bool) -> Primitive {
        let [low, high] = self.body;
        let beyond = BEYOND * (high - low);
        let (from, to) = (high + beyond, if through { low - beyond } else { 0.5 * (low + high) });
        let (length, offset) = (from - to, 0.5 * (from + to));
        let fillet = self.sweep.fillet.min(0.5 * length);
        Primitive::LinearSweep(LinearSweep { length, offset, fillet, ..self.sweep.clone() })
    }
}

/// Where a plane's origin, right, up and the way towards whoever draws are; `None` for a plane that is none.
fn world_from_plane(sweep: &LinearSweep, world_from_node: Affine3A) -> Option<Affine3A> {
    let plane = &sweep.plane;
    let right = plane.right.try_normalize()?;
    let towards = right.cross(plane.up).try_normalize()?;
    let own = glam::Mat3::from_cols(right, towards.cross(right), towards);
    let all = world_from_node * Affine3A::from_mat3_translation(own, plane.origin);
    let size = all.matrix3.determinant();
    (size.is_finite() && size != 0.0).then_some(all)
}
