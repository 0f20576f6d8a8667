//! An empty scene seen from the front.

use blobtree::{Node, NodeRef, Operator, Shape};
use glam::{Vec2, Vec3};
use sketch::suggest::{Projection, View};

/// The size of the screen, pixels.
pub const SCREEN: Vec2 = Vec2::new(800.0, 600.0);

/// Along +y, as someone stands before a thing; the origin in the middle of the screen, 10 px to a mm.
pub fn front() -> View {
    let projection = Projection::Orthographic { mm_per_px: 0.1 };
    View::look_at(Vec3::new(0.0, -100.0, 0.0), Vec3::ZERO, SCREEN, projection)
}

/// A scene without anything in it.
pub fn empty_scene() -> NodeRef {
    Node::new(Shape::Operator(Operator::Union, Vec::new())).into()
}
