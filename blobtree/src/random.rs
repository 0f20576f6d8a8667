//! Seeded random trees, for tests and benches.
//!
//! The same seed gives the same tree everywhere. All node types occur except imported meshes, which need a
//! file, and drawn solids, which need templates; hand a mesh in with [`RandomTree::mesh`], and ask for drawn
//! solids with [`RandomTree`]'s `drawn`.

mod drawn;

use crate::imported::ImportedMesh;
use crate::node::{Color, Node, NodeRef, Shape};
use crate::operator::{Operator, Sharpness};
use crate::primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, PolylinePoint, Primitive,
    Segment, Torus,
};
use crate::sketched::{
    Drawing, Inflation, LinearSweep, PathSweep, Profile, Revolution, RevolutionAxis, Side, SketchPlane,
    Template,
};
use crate::support_free::{BrushKind, BrushStroke, BrushTip, SupportFree, SupportMode};
use crate::warp::{AffineMap, Axis, Bend, Taper, Transform, Twist, Warp};
pub use drawn::{PolygonSources, polygon_template, stroke};
use fastrand::Rng;
use glam::{Mat3, Quat, Vec2, Vec3};
use std::sync::Arc;

/// Farthest coordinate of a random place, mm.
const REACH: f32 = 60.0;

/// Makes random trees whose numbers are legal: sizes of 1 to 60 mm, within 60 mm of the origin before warps.
#[derive(Clone, Debug)]
pub struct RandomTree {
    rng: Rng,
    /// Most nodes on the way from the root to a leaf; at least 1. Default: 8.
    pub depth: usize,
    /// Most children of an operator; at least 1. Default: 4.
    pub children: usize,
    /// Used as a primitive among the others, if there is one.
    pub mesh: Option<ImportedMesh>,
    /// Whether drawn solids occur among the primitives. Default: no.
    pub drawn: bool,
    /// Whether support-free nodes occur. Default: no.
    pub support_free: bool,
}

impl RandomTree {
    /// With the defaults above.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Rng::with_seed(seed),
            depth: 8,
            children: 4,
            mesh: None,
            drawn: false,
            support_free: false,
        }
    }

    /// The next tree: an operator or a warp at the root, unless `depth` is 1.
    pub fn tree(&mut self) -> NodeRef {
        if self.depth <= 1 { self.leaf().into() } else { self.inner(self.depth).into() }
    }

    /// The next primitive as a node.
    pub fn leaf(&mut self) -> Node {
        let primitive = self.primitive();
        self.dressed(Shape::Primitive(primitive))
    }

    fn node(&mut self, depth: usize) -> Node {
        // Fewer inner nodes further down, or the trees would have thousands of nodes.
        if depth <= 1 || self.rng.f32() < 0.45 { self.leaf() } else { self.inner(depth) }
    }

    fn inner(&mut self, depth: usize) -> Node {
        let shape = if self.support_free && self.rng.u32(..16) == 0 {
            let rule = self.rule();
            Shape::SupportFree(rule, self.node(depth - 1).into())
        } else if self.rng.u32(..4) == 0 {
            let warp = self.warp();
            Shape::Warp(warp, self.node(depth - 1).into())
        } else {
            let operator = self.operator();
            let count = self.rng.usize(1..=self.children.max(1));
            let mut children: Vec<NodeRef> = (0..count).map(|_| self.node(depth - 1).into()).collect();
            if self.rng.u32(..12) == 0 {
                // The same node a second time.
                children.push(children[0].clone());
            }
            Shape::Operator(operator, children)
        };
        self.dressed(shape)
    }

    /// A node with, now and then, a name, a colour, or a sign that it is left out.
    fn dressed(&mut self, shape: Shape) -> Node {
        let rng = &mut self.rng;
        let mut node = Node::new(shape);
        node.name = (rng.u32(..4) == 0).then(|| format!("part {}", rng.u32(..100)));
        node.color = (rng.u32(..4) == 0).then(|| Color([rng.u8(..), rng.u8(..), rng.u8(..)]));
        node.muted = rng.u32(..24) == 0;
        node.construction = rng.u32(..24) == 0;
        node
    }

    /// The next primitive.
    pub fn primitive(&mut self) -> Primitive {
        if self.drawn && self.rng.u32(..15) < 4 {
            return self.drawn();
        }
        let falloff = (self.rng.u32(..3) == 0).then(|| self.size());
        match self.rng.u32(..11 + u32::from(self.mesh.is_some())) {
            0 => Primitive::Point(Point { center: self.place(), radius: self.size(), falloff }),
            1 => Primitive::Segment(Segment {
                from: self.place(),
                to: self.place(),
                radius: self.size(),
                falloff,
            }),
            2 => Primitive::Polyline(self.polyline(falloff)),
            3 => Primitive::Disc(self.disc(falloff)),
            4 => Primitive::Polygon(self.polygon(falloff)),
            5 => Primitive::Box(self.cuboid(falloff)),
            6 => {
                let (from, to) = self.axis();
                Primitive::Cylinder(Cylinder { from, to, radius: self.size(), falloff })
            }
            7 => {
                let (from, to) = self.axis();
                let radius_to = if self.rng.bool() { 0.0 } else { self.size() };
                Primitive::Cone(Cone { from, to, radius_from: self.size(), radius_to, falloff })
            }
            8 => Primitive::Torus(Torus {
                center: self.place(),
                normal: self.direction(),
                major_radius: self.size(),
                minor_radius: self.size() / 3.0 + 1.0,
                falloff,
            }),
            9 => {
                let radii = Vec3::new(self.size(), self.size(), self.size());
                Primitive::Ellipsoid(Ellipsoid { center: self.place(), radii, falloff })
            }
            10 => Primitive::HalfSpace(HalfSpace {
                point: self.place(),
                normal: self.direction(),
                extent: 60.0 + self.size(),
                falloff: self.size(),
            }),
            _ => Primitive::Mesh(self.mesh.clone().expect("counted only if it is there")),
        }
    }

    fn drawn(&mut self) -> Primitive {
        let drawing = drawn::drawing(&mut self.rng);
        let falloff = (self.rng.u32(..3) == 0).then(|| self.size());
        // Stars enclose something, whatever their points.
        let template = Arc::new(polygon_template(&drawing, falloff, 64).unwrap_or_default());
        let turn = self.turn();
        let plane = SketchPlane { origin: self.place(), right: turn * Vec3::X, up: turn * Vec3::Y };
        self.drawn_from(Arc::new(drawing), plane, falloff, template)
    }

    fn drawn_from(
        &mut self,
        drawing: Arc<Drawing>,
        plane: SketchPlane,
        falloff: Option<f32>,
        template: Arc<Template>,
    ) -> Primitive {
        match self.rng.u32(..4) {
            0 => Primitive::Inflation(Inflation {
                thickness: self.rng.bool().then(|| self.size()),
                contrast: if self.rng.bool() { 0.0 } else { self.between(0.0, 0.9) },
                pressure: if self.rng.bool() { 0.0 } else { self.rng.f32() },
                profile: if self.rng.bool() { Profile::Round } else { Profile::Flat },
                falloff,
                ..Inflation::new(drawing, plane, template)
            }),
            1 => {
                let length = self.size();
                let fillet = if self.rng.bool() { 0.0 } else { self.between(0.0, 0.5) * length };
                let offset = self.between(-20.0, 20.0);
                let sweep = LinearSweep::new(drawing, plane, template, length);
                Primitive::LinearSweep(LinearSweep { offset, fillet, falloff, ..sweep })
            }
            2 => {
                let at = Vec2::new(self.between(-30.0, 30.0), 0.0);
                let direction = self.turn().mul_vec3(Vec3::X).truncate() + Vec2::Y * 1.5;
                let side = [None, Some(Side::Left), Some(Side::Right), Some(Side::Both)][self.rng.usize(..4)];
                let revolution = Revolution::new(drawing, plane, template, RevolutionAxis { at, direction });
                Primitive::Revolution(Revolution { side, falloff, ..revolution })
            }
            _ => {
                let (mut at, mut ahead) = (plane.origin, self.direction());
                let mut path = vec![at];
                for _ in 0..self.rng.usize(1..24) {
                    ahead = (ahead + 0.7 * self.direction()).normalize_or(Vec3::Z);
                    at += ahead * self.between(1.0, 12.0);
                    path.push(at);
                }
                let fillet = if self.rng.bool() { 0.0 } else { self.size() / 4.0 };
                let sweep = PathSweep::new(drawing, plane, template, path);
                Primitive::PathSweep(PathSweep { fillet, falloff, ..sweep })
            }
        }
    }

    fn polyline(&mut self, falloff: Option<f32>) -> Polyline {
        let count = self.rng.usize(1..=6);
        let points = (0..count).map(|_| PolylinePoint { at: self.place(), radius: self.size() / 2.0 + 0.5 });
        Polyline { points: points.collect(), falloff }
    }

    fn disc(&mut self, falloff: Option<f32>) -> Disc {
        let radius = self.size();
        let thickness = self.between(0.2, 2.0) * radius;
        Disc { center: self.place(), normal: self.direction(), radius, thickness, falloff }
    }

    /// A star-shaped polygon in a random plane.
    fn polygon(&mut self, falloff: Option<f32>) -> Polygon {
        let (center, turn) = (self.place(), self.turn());
        let count = self.rng.usize(3..=9);
        let points = (0..count).map(|i| {
            let angle = std::f32::consts::TAU * i as f32 / count as f32;
            center + turn * (Vec3::new(angle.cos(), angle.sin(), 0.0) * self.between(5.0, 30.0))
        });
        Polygon { points: points.collect(), thickness: self.size() / 4.0 + 1.0, falloff }
    }

    fn cuboid(&mut self, falloff: Option<f32>) -> Cuboid {
        let size = Vec3::new(self.size(), self.size(), self.size());
        let rounding = if self.rng.bool() { 0.0 } else { self.between(0.0, 0.5) * size.min_element() };
        Cuboid { center: self.place(), size, rounding, falloff }
    }

    /// The next operator.
    pub fn operator(&mut self) -> Operator {
        // Now and then the ends of the range, where formulas change.
        let exponents = [1.0, 2.0, 3.0, 64.0, self.between(1.0, 16.0)];
        let exponent = exponents[self.rng.usize(..exponents.len())];
        let sharpness = Sharpness::new(exponent).expect("1 to 64");
        match self.rng.u32(..8) {
            0 => Operator::Union,
            1 => Operator::Intersection,
            2 => Operator::Difference,
            3 => Operator::Blend(sharpness),
            4 => Operator::BlendIntersection(sharpness),
            5 => Operator::BlendDifference(sharpness),
            6 => Operator::Sum,
            _ => Operator::GradientBlend,
        }
    }

    /// The next rule of a support-free node.
    pub fn rule(&mut self) -> SupportFree {
        SupportFree {
            mode: [SupportMode::Trim, SupportMode::Grow, SupportMode::Off][self.rng.usize(..3)],
            overhang_degrees: self.between(20.0, 70.0),
            layer_height: self.between(0.1, 2.0),
            bed: if self.rng.bool() { 0.0 } else { self.between(-30.0, 30.0) },
            strokes: Vec::new(),
        }
    }

    /// The next brush stroke.
    pub fn stroke(&mut self) -> BrushStroke {
        let kinds = [
            BrushKind::AddTrim,
            BrushKind::RemoveTrim,
            BrushKind::RemovePreserve,
            BrushKind::AddGrow,
            BrushKind::SmoothTrim,
        ];
        let places: Vec<[f32; 3]> = (0..self.rng.usize(1..5)).map(|_| self.place().to_array()).collect();
        let count = places.len();
        let brush = kinds[self.rng.usize(..kinds.len())];
        let mut stroke = BrushStroke::new(brush, self.between(0.5, 5.0), places);
        stroke.tip = match self.rng.u32(..4) {
            0 => BrushTip::Cube,
            1 => BrushTip::Cylinder,
            2 => BrushTip::Shape(Node::new(Shape::Primitive(ball_of(self.between(0.5, 1.0)))).into()),
            _ => BrushTip::Ball,
        };
        if self.rng.bool() {
            stroke.light_radius = Some(self.between(0.2, 2.0));
            stroke.light_strength = Some(self.rng.f32());
            stroke.spacing = Some(self.between(0.5, 2.0));
            stroke.pressures = Some((0..count).map(|_| self.rng.f32()).collect());
        }
        (stroke.material, stroke.grown_material) = (self.rng.u8(..3), self.rng.u8(..3));
        stroke
    }

    /// The next warp.
    pub fn warp(&mut self) -> Warp {
        let start = self.between(-40.0, 20.0);
        let end = start + self.between(5.0, 60.0);
        match self.rng.u32(..5) {
            0 => Warp::Transform(Transform {
                translate: self.place() / 3.0,
                rotate_degrees: self.place() * 3.0,
                scale: Vec3::new(self.factor(), self.factor(), self.factor()),
            }),
            1 => {
                let linear = Mat3::from_quat(self.turn())
                    * Mat3::from_diagonal(Vec3::new(self.factor(), self.factor(), self.factor()))
                    * Mat3::from_quat(self.turn());
                let (columns, moved) = (linear.to_cols_array_2d(), self.place() / 3.0);
                let row = |i: usize| [columns[0][i], columns[1][i], columns[2][i], moved[i]];
                Warp::Affine(AffineMap { rows: [row(0), row(1), row(2)] })
            }
            2 => Warp::Taper(Taper { axis: self.axis_name(), start, end, scale: self.between(0.3, 2.0) }),
            3 => Warp::Twist(Twist { axis: self.axis_name(), degrees_per_mm: self.between(-4.0, 4.0) }),
            _ => {
                let axis = self.axis_name();
                let towards = match axis {
                    Axis::X => Axis::Y,
                    Axis::Y => Axis::Z,
                    Axis::Z => Axis::X,
                };
                let degrees = self.between(5.0, 120.0) * if self.rng.bool() { 1.0 } else { -1.0 };
                Warp::Bend(Bend { axis, towards, start, end, degrees })
            }
        }
    }

    fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.rng.f32()
    }

    /// A length of 1 to 60 mm, small ones as likely as large ones.
    fn size(&mut self) -> f32 {
        60.0_f32.powf(self.rng.f32())
    }

    fn factor(&mut self) -> f32 {
        2.0_f32.powf(self.between(-1.0, 1.0)) * if self.rng.u32(..6) == 0 { -1.0 } else { 1.0 }
    }

    /// A random place.
    pub fn place(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.between(-REACH, REACH)))
    }

    fn direction(&mut self) -> Vec3 {
        self.turn() * Vec3::Z
    }

    fn turn(&mut self) -> Quat {
        let [x, y, z, w] = std::array::from_fn(|_| self.between(-1.0, 1.0));
        let length = (x * x + y * y + z * z + w * w).sqrt();
        if length > 0.01 {
            Quat::from_xyzw(x / length, y / length, z / length, w / length)
        } else {
            Quat::IDENTITY
        }
    }

    /// Two places at least 1 mm apart.
    fn axis(&mut self) -> (Vec3, Vec3) {
        let from = self.place();
        (from, from + self.direction() * self.size())
    }

    fn axis_name(&mut self) -> Axis {
        [Axis::X, Axis::Y, Axis::Z][self.rng.usize(..3)]
    }
}

/// A ball around the origin.
fn ball_of(radius: f32) -> Primitive {
    Primitive::Point(Point { center: Vec3::ZERO, radius, falloff: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, TYPE_NAMES};
    use std::collections::BTreeSet;

    #[test]
    fn random_trees_are_legal_and_repeatable_and_of_all_types() {
        let mut types = BTreeSet::new();
        for seed in 0..300 {
            let random =
                || RandomTree { drawn: seed % 2 == 0, support_free: true, ..RandomTree::new(seed) }.tree();
            let tree = random();
            let scene = Scene::new(tree.clone());
            assert_eq!(scene.check(), Ok(()), "seed {seed}");
            assert_eq!(tree, random(), "seed {seed}");
            collect_types(&tree, &mut types);
        }
        let expected: BTreeSet<&str> = TYPE_NAMES.into_iter().filter(|name| *name != "mesh").collect();
        assert_eq!(types, expected);
    }

    fn collect_types(node: &NodeRef, types: &mut BTreeSet<&'static str>) {
        types.insert(node.type_name());
        node.children().iter().for_each(|child| collect_types(child, types));
    }
}
