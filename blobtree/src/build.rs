//! Trees from Rust, in a few readable lines.
//!
//! Functions make nodes, and the methods of [`Build`] combine, move and name them. Numbers are not checked on
//! the way; [`Scene::check`](crate::Scene::check), and everything that takes a scene, does.
//!
//! ```
//! use blobtree::Scene;
//! use blobtree::build::*;
//!
//! let body = blend([point([0., 0., 15.], 16.), point([0., 0., 38.], 12.), point([0., 0., 55.], 9.)]);
//! let hat = cylinder([0., 0., 61.], [0., 0., 75.], 7.).union(cylinder([0., 0., 61.], [0., 0., 63.], 11.));
//! let eye = point([0., -9., 57.], 1.2).colored("#202020").into_shared();
//! let nose = cone([0., -7., 54.], [0., -20., 53.], 2.).colored("#ff8800").named("nose");
//! let snowman = body.colored("#ffffff").named("body")
//!     .subtract(half_space([0., 0., 0.], [0., 0., 1.]))
//!     .union(hat.colored("#303040").named("hat"))
//!     .union(nose)
//!     .union(eye.clone().translate([3., 0., 0.]))
//!     .union(eye.translate([-3., 0., 0.]));
//!
//! let scene = Scene::new(snowman).titled("Snowman");
//! assert!(scene.to_text()?.contains("\"nose\""));
//! # Ok::<(), blobtree::SceneError>(())
//! ```

use crate::node::{Color, Node, NodeRef, Shape};
use crate::operator::{Operator, Sharpness};
use crate::primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, PolylinePoint, Primitive,
    Segment, Torus,
};
use crate::sketched::{
    Drawing, Inflation, LinearSweep, PathSweep, Revolution, RevolutionAxis, SketchPlane, Template,
};
use crate::support_free::SupportFree;
use crate::warp::{Axis, Bend, Taper, Transform, Twist, Warp};
use glam::Vec3;
use std::sync::Arc;

/// A ball: centre and radius, mm.
pub fn point(center: impl Into<Vec3>, radius: f32) -> Node {
    primitive(Primitive::Point(Point { center: center.into(), radius, falloff: None }))
}

/// A capsule: the ends of its axis and its radius, mm.
pub fn segment(from: impl Into<Vec3>, to: impl Into<Vec3>, radius: f32) -> Node {
    primitive(Primitive::Segment(Segment { from: from.into(), to: to.into(), radius, falloff: None }))
}

/// A chain of capsules: points with their radii, mm.
pub fn polyline<P: Into<Vec3>>(points: impl IntoIterator<Item = (P, f32)>) -> Node {
    let points = points.into_iter().map(|(at, radius)| PolylinePoint { at: at.into(), radius }).collect();
    primitive(Primitive::Polyline(Polyline { points, falloff: None }))
}

/// A flat round pebble: centre, direction across, radius and thickness, mm.
pub fn disc(center: impl Into<Vec3>, normal: impl Into<Vec3>, radius: f32, thickness: f32) -> Node {
    let (center, normal) = (center.into(), normal.into());
    primitive(Primitive::Disc(Disc { center, normal, radius, thickness, falloff: None }))
}

/// A flat pebble around a planar polygon: corners and thickness, mm.
pub fn polygon<P: Into<Vec3>>(points: impl IntoIterator<Item = P>, thickness: f32) -> Node {
    let points = points.into_iter().map(Into::into).collect();
    primitive(Primitive::Polygon(Polygon { points, thickness, falloff: None }))
}

/// A box with sharp edges: centre and side lengths, mm.
pub fn cuboid(center: impl Into<Vec3>, size: impl Into<Vec3>) -> Node {
    rounded_cuboid(center, size, 0.0)
}

/// A box with rounded edges: centre, side lengths and radius of the edges, mm.
pub fn rounded_cuboid(center: impl Into<Vec3>, size: impl Into<Vec3>, rounding: f32) -> Node {
    primitive(Primitive::Box(Cuboid { center: center.into(), size: size.into(), rounding, falloff: None }))
}

/// A cylinder: the centres of its ends and its radius, mm.
pub fn cylinder(from: impl Into<Vec3>, to: impl Into<Vec3>, radius: f32) -> Node {
    primitive(Primitive::Cylinder(Cylinder { from: from.into(), to: to.into(), radius, falloff: None }))
}

/// A cone: the centre of its base, its tip, and the base's radius, mm.
pub fn cone(from: impl Into<Vec3>, to: impl Into<Vec3>, radius: f32) -> Node {
    truncated_cone(from, to, radius, 0.0)
}

/// A truncated cone: the centres of its ends and their radii, mm.
pub fn truncated_cone(from: impl Into<Vec3>, to: impl Into<Vec3>, radius_from: f32, radius_to: f32) -> Node {
    let (from, to) = (from.into(), to.into());
    primitive(Primitive::Cone(Cone { from, to, radius_from, radius_to, falloff: None }))
}

/// A ring: centre, direction of the axis, radius to the middle of the tube and radius of the tube, mm.
pub fn torus(center: impl Into<Vec3>, normal: impl Into<Vec3>, major_radius: f32, minor_radius: f32) -> Node {
    let (center, normal) = (center.into(), normal.into());
    primitive(Primitive::Torus(Torus { center, normal, major_radius, minor_radius, falloff: None }))
}

/// An ellipsoid: centre and radii along x, y and z, mm.
pub fn ellipsoid(center: impl Into<Vec3>, radii: impl Into<Vec3>) -> Node {
    primitive(Primitive::Ellipsoid(Ellipsoid { center: center.into(), radii: radii.into(), falloff: None }))
}

/// Everything within 500 mm of `point` behind the plane there whose outward direction is `normal`.
pub fn half_space(point: impl Into<Vec3>, normal: impl Into<Vec3>) -> Node {
    let (point, normal) = (point.into(), normal.into());
    primitive(Primitive::HalfSpace(HalfSpace { point, normal, extent: 500.0, falloff: 5.0 }))
}

/// A drawing blown up like a cushion, upright in the plane y = 0: the drawing and the template solved for it.
pub fn inflation(drawing: impl Into<Arc<Drawing>>, template: impl Into<Arc<Template>>) -> Node {
    let plane = SketchPlane::default();
    primitive(Primitive::Inflation(Inflation::new(drawing.into(), plane, template.into())))
}

/// A drawing moved along its normal, with sharp ends, its middle upright in the plane y = 0: the drawing, the
/// template solved for it, and the length, mm.
pub fn linear_sweep(
    drawing: impl Into<Arc<Drawing>>,
    template: impl Into<Arc<Template>>,
    length: f32,
) -> Node {
    let plane = SketchPlane::default();
    primitive(Primitive::LinearSweep(LinearSweep::new(drawing.into(), plane, template.into(), length)))
}

/// A drawing turned about its y axis, which is the z axis of space: the drawing and the template solved for it.
pub fn revolution(drawing: impl Into<Arc<Drawing>>, template: impl Into<Arc<Template>>) -> Node {
    let (plane, axis) = (SketchPlane::default(), RevolutionAxis::default());
    primitive(Primitive::Revolution(Revolution::new(drawing.into(), plane, template.into(), axis)))
}

/// A drawing, upright in the plane y = 0, moved along a path, with sharp ends: the drawing, the template solved
/// for it, and the points of the path, mm.
pub fn path_sweep<P: Into<Vec3>>(
    drawing: impl Into<Arc<Drawing>>,
    template: impl Into<Arc<Template>>,
    path: impl IntoIterator<Item = P>,
) -> Node {
    let (plane, path) = (SketchPlane::default(), path.into_iter().map(Into::into).collect());
    primitive(Primitive::PathSweep(PathSweep::new(drawing.into(), plane, template.into(), path)))
}

/// All of them.
pub fn union<N: Into<NodeRef>>(children: impl IntoIterator<Item = N>) -> Node {
    operator(Operator::Union, children)
}

/// What all have in common.
pub fn intersection<N: Into<NodeRef>>(children: impl IntoIterator<Item = N>) -> Node {
    operator(Operator::Intersection, children)
}

/// All of them, flowing into each other, with the usual sharpness.
pub fn blend<N: Into<NodeRef>>(children: impl IntoIterator<Item = N>) -> Node {
    operator(Operator::Blend(Sharpness::DEFAULT), children)
}

/// All of them, flowing into each other as widely as they can.
pub fn sum<N: Into<NodeRef>>(children: impl IntoIterator<Item = N>) -> Node {
    operator(Operator::Sum, children)
}

/// All of them, flowing into each other only where their surfaces meet at an angle.
pub fn gradient_blend<N: Into<NodeRef>>(children: impl IntoIterator<Item = N>) -> Node {
    operator(Operator::GradientBlend, children)
}

/// Any operator over any children.
pub fn operator<N: Into<NodeRef>>(operator: Operator, children: impl IntoIterator<Item = N>) -> Node {
    Node::new(Shape::Operator(operator, children.into_iter().map(Into::into).collect()))
}

/// Any primitive.
pub fn primitive(primitive: Primitive) -> Node {
    Node::new(Shape::Primitive(primitive))
}

/// What can be done with a node while building: [`Node`] and [`NodeRef`] alike.
pub trait Build: Into<NodeRef> + Sized {
    /// The node by value: itself, or a copy of a shared one.
    fn into_node(self) -> Node;

    /// The node, ready to stand in several places; they share it and its caches.
    fn into_shared(self) -> NodeRef {
        self.into()
    }

    /// Gives it a name.
    fn named(self, name: impl Into<String>) -> Node {
        Node { name: Some(name.into()), ..self.into_node() }
    }

    /// Gives it a colour, written `#rrggbb`.
    ///
    /// Panics if `color` is written otherwise: it belongs to the program, not to its input.
    fn colored(self, color: &str) -> Node {
        let color: Color = color.parse().expect("colours in programs are written #rrggbb");
        Node { color: Some(color), ..self.into_node() }
    }

    /// Leaves it out, as if it were not there.
    fn muted(self) -> Node {
        Node { muted: true, ..self.into_node() }
    }

    /// Makes it seen and drawn on, but no part of the solid.
    fn construction(self) -> Node {
        Node { construction: true, ..self.into_node() }
    }

    /// Sets how far a primitive's influence reaches beyond its surface, mm; that of a drawn one no farther than
    /// its template was solved for. Other nodes stay as they are.
    fn with_falloff(self, width: f32) -> Node {
        let mut node = self.into_node();
        if let Shape::Primitive(primitive) = &mut node.shape {
            set_falloff(primitive, width);
        }
        node
    }

    /// This and the other.
    fn union(self, other: impl Into<NodeRef>) -> Node {
        pair(Operator::Union, self, other)
    }

    /// What this and the other have in common.
    fn intersect(self, other: impl Into<NodeRef>) -> Node {
        pair(Operator::Intersection, self, other)
    }

    /// This without the other.
    fn subtract(self, other: impl Into<NodeRef>) -> Node {
        pair(Operator::Difference, self, other)
    }

    /// This without the other, with soft edges of the usual sharpness.
    fn blend_subtract(self, other: impl Into<NodeRef>) -> Node {
        pair(Operator::BlendDifference(Sharpness::DEFAULT), self, other)
    }

    /// This and the other, flowing into each other, with the usual sharpness.
    fn blend(self, other: impl Into<NodeRef>) -> Node {
        pair(Operator::Blend(Sharpness::DEFAULT), self, other)
    }

    /// Moves it, mm.
    fn translate(self, by: impl Into<Vec3>) -> Node {
        self.warp(Warp::Transform(Transform { translate: by.into(), ..Transform::default() }))
    }

    /// Turns it about the x, y and z axis, in this order, degrees.
    fn rotate_degrees(self, angles: impl Into<Vec3>) -> Node {
        self.warp(Warp::Transform(Transform { rotate_degrees: angles.into(), ..Transform::default() }))
    }

    /// Scales it along x, y and z.
    fn scale(self, factors: impl Into<Vec3>) -> Node {
        self.warp(Warp::Transform(Transform { scale: factors.into(), ..Transform::default() }))
    }

    /// Twists it about an axis through the origin.
    fn twist(self, axis: Axis, degrees_per_mm: f32) -> Node {
        self.warp(Warp::Twist(Twist { axis, degrees_per_mm }))
    }

    /// Scales its cross-sections along an axis through the origin: by 1 at `start`, by `scale` at `end`, mm.
    fn taper(self, axis: Axis, start: f32, end: f32, scale: f32) -> Node {
        self.warp(Warp::Taper(Taper { axis, start, end, scale }))
    }

    /// Bends the stretch of `axis` from `start` to `end`, mm, towards another axis.
    fn bend(self, axis: Axis, towards: Axis, start: f32, end: f32, degrees: f32) -> Node {
        self.warp(Warp::Bend(Bend { axis, towards, start, end, degrees }))
    }

    /// Takes away, or makes matter grow below, what would need supports.
    fn support_free(self, rule: SupportFree) -> Node {
        Node::new(Shape::SupportFree(rule, self.into()))
    }

    /// Puts it into any warp.
    fn warp(self, warp: Warp) -> Node {
        Node::new(Shape::Warp(warp, self.into()))
    }
}

impl Build for Node {
    fn into_node(self) -> Node {
        self
    }
}

impl Build for NodeRef {
    fn into_node(self) -> Node {
        NodeRef::unwrap_or_clone(self)
    }
}

fn pair(with: Operator, first: impl Into<NodeRef>, second: impl Into<NodeRef>) -> Node {
    operator(with, [first.into(), second.into()])
}

fn set_falloff(primitive: &mut Primitive, width: f32) {
    match primitive {
        Primitive::Point(p) => p.falloff = Some(width),
        Primitive::Segment(p) => p.falloff = Some(width),
        Primitive::Polyline(p) => p.falloff = Some(width),
        Primitive::Disc(p) => p.falloff = Some(width),
        Primitive::Polygon(p) => p.falloff = Some(width),
        Primitive::Box(p) => p.falloff = Some(width),
        Primitive::Cylinder(p) => p.falloff = Some(width),
        Primitive::Cone(p) => p.falloff = Some(width),
        Primitive::Torus(p) => p.falloff = Some(width),
        Primitive::Ellipsoid(p) => p.falloff = Some(width),
        Primitive::HalfSpace(p) => p.falloff = width,
        Primitive::Mesh(p) => p.falloff = width,
        Primitive::Inflation(p) => p.falloff = Some(width),
        Primitive::LinearSweep(p) => p.falloff = Some(width),
        Primitive::Revolution(p) => p.falloff = Some(width),
        Primitive::PathSweep(p) => p.falloff = Some(width),
    }
}
