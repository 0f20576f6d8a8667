//! Solids against their closed forms: volume, area, and where the surface is.

mod geometry;

use blobtree::build::*;
use blobtree::random::RandomTree;
use blobtree::{
    Aabb, AffineMap, Axis, BakeStore, Field, ImportedMesh, Node, Primitive, Sample, Shape, SupportFree,
    SupportMode, TYPE_NAMES, Transform, Tree, Warp,
};
use fastrand::Rng;
use geometry::*;
use glam::{DVec3, Mat3, Quat, Vec3};
use mesh::MeshDistance;
use printable::Rebaker;
use std::f32::consts::TAU;
use std::f64::consts::PI;
use std::sync::Arc;

/// A solid with what geometry knows about it.
struct Known {
    name: &'static str,
    node: Node,
    /// Longest side of its box before it is turned, mm.
    size: f32,
    volume: f64,
    /// `None` where there is no closed form.
    area: Option<f64>,
    /// A random point of its surface from three numbers between 0 and 1.
    on_surface: fn([f32; 3]) -> Vec3,
}

/// A unit vector of longitude `u` and height `v`, both from 0 to 1: uniform on the sphere.
fn on_sphere(u: f32, v: f32) -> Vec3 {
    let z = 2.0 * v - 1.0;
    let flat = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(flat * (TAU * u).cos(), flat * (TAU * u).sin(), z)
}

fn on_circle(u: f32) -> Vec3 {
    Vec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0)
}

fn sphere() -> Known {
    Known {
        name: "sphere",
        node: point([0.0; 3], 10.0),
        size: 20.0,
        volume: 4.0 / 3.0 * PI * 1000.0,
        area: Some(4.0 * PI * 100.0),
        on_surface: |[u, v, _]| 10.0 * on_sphere(u, v),
    }
}

fn ring() -> Known {
    Known {
        name: "torus",
        node: torus([0.0; 3], [0.0, 0.0, 1.0], 12.0, 4.0),
        size: 32.0,
        volume: 2.0 * PI * PI * 12.0 * 16.0,
        area: Some(4.0 * PI * PI * 12.0 * 4.0),
        on_surface: |[u, v, _]| {
            let out = on_circle(u);
            out * (12.0 + 4.0 * (TAU * v).cos()) + Vec3::Z * (4.0 * (TAU * v).sin())
        },
    }
}

fn tube() -> Known {
    Known {
        name: "cylinder",
        node: cylinder([0.0, 0.0, -9.0], [0.0, 0.0, 9.0], 7.0),
        size: 18.0,
        volume: PI * 49.0 * 18.0,
        area: Some(2.0 * PI * 7.0 * (7.0 + 18.0)),
        on_surface: |[u, v, w]| match w {
            0.0..0.5 => on_circle(u) * 7.0 + Vec3::Z * (18.0 * v - 9.0),
            _ => on_circle(u) * (7.0 * v) + Vec3::Z * if w < 0.75 { 9.0 } else { -9.0 },
        },
    }
}

fn hat() -> Known {
    Known {
        name: "cone",
        node: cone([0.0, 0.0, -8.0], [0.0, 0.0, 12.0], 9.0),
        size: 20.0,
        volume: PI * 81.0 * 20.0 / 3.0,
        area: Some(PI * 9.0 * (9.0 + 9.0_f64.hypot(20.0))),
        on_surface: |[u, v, w]| match w {
            0.0..0.5 => on_circle(u) * (9.0 * v) + Vec3::Z * (12.0 - 20.0 * v),
            _ => on_circle(u) * (9.0 * v) - Vec3::Z * 8.0,
        },
    }
}

fn bucket() -> Known {
    Known {
        name: "truncated cone",
        node: truncated_cone([0.0, 0.0, 0.0], [0.0, 0.0, 16.0], 5.0, 9.0),
        size: 18.0,
        volume: PI * 16.0 / 3.0 * (25.0 + 45.0 + 81.0),
        area: Some(PI * (25.0 + 81.0 + (5.0 + 9.0) * 4.0_f64.hypot(16.0))),
        on_surface: |[u, v, w]| match w {
            0.0..0.5 => on_circle(u) * (5.0 + 4.0 * v) + Vec3::Z * (16.0 * v),
            0.5..0.75 => on_circle(u) * (5.0 * v),
            _ => on_circle(u) * (9.0 * v) + Vec3::Z * 16.0,
        },
    }
}

fn brick() -> Known {
    Known {
        name: "box",
        node: cuboid([0.0; 3], [20.0, 14.0, 9.0]),
        size: 20.0,
        volume: 20.0 * 14.0 * 9.0,
        area: Some(2.0 * (20.0 * 14.0 + 14.0 * 9.0 + 9.0 * 20.0)),
        on_surface: |[u, v, w]| {
            let (axis, side) = ((w * 2.999) as usize, if (w * 2.999).fract() < 0.5 { 0.5 } else { -0.5 });
            let mut p = Vec3::new(u - 0.5, v - 0.5, u * v - 0.5);
            p[axis] = side;
            p * Vec3::new(20.0, 14.0, 9.0)
        },
    }
}

fn soap() -> Known {
    // A box of 20 × 14 × 10 with edges of radius 3: the box inside (14 × 8 × 4) grown by 3 (Steiner).
    let (volume, faces, edges) = (14.0 * 8.0 * 4.0, 2.0 * (14.0 * 8.0 + 8.0 * 4.0 + 4.0 * 14.0), 4.0 * 26.0);
    Known {
        name: "rounded box",
        node: rounded_cuboid([0.0; 3], [20.0, 14.0, 10.0], 3.0),
        size: 20.0,
        volume: volume + faces * 3.0 + edges * PI * 9.0 / 4.0 + 4.0 / 3.0 * PI * 27.0,
        area: Some(faces + edges * PI * 3.0 / 2.0 + 4.0 * PI * 9.0),
        on_surface: |[u, v, w]| {
            let corner = Vec3::new(7.0, 4.0, 2.0);
            let out = on_sphere(u, v);
            if w < 0.5 {
                out.signum() * corner + 3.0 * out
            } else {
                Vec3::new(14.0 * u - 7.0, 8.0 * v - 4.0, 5.0)
            }
        },
    }
}

fn capsule() -> Known {
    Known {
        name: "segment",
        node: segment([0.0, 0.0, -8.0], [0.0, 0.0, 8.0], 5.0),
        size: 26.0,
        volume: PI * 25.0 * 16.0 + 4.0 / 3.0 * PI * 125.0,
        area: Some(2.0 * PI * 5.0 * 16.0 + 4.0 * PI * 25.0),
        on_surface: |[u, v, w]| {
            let out = on_sphere(u, v);
            if w < 0.5 {
                out * 5.0 + Vec3::Z * 8.0 * out.z.signum()
            } else {
                on_circle(u) * 5.0 + Vec3::Z * (16.0 * v - 8.0)
            }
        },
    }
}

fn pebble() -> Known {
    // Everything within 3 mm of a disc of 9 mm: a cylinder and the outer half of a torus (Pappus).
    let half_circle = PI * 9.0 / 2.0;
    let centroid = 9.0 + 4.0 * 3.0 / (3.0 * PI);
    let arc_centroid = 9.0 + 2.0 * 3.0 / PI;
    Known {
        name: "disc",
        node: disc([0.0; 3], [0.0, 0.0, 1.0], 12.0, 6.0),
        size: 24.0,
        volume: PI * 81.0 * 6.0 + 2.0 * PI * centroid * half_circle,
        area: Some(2.0 * PI * 81.0 + 2.0 * PI * arc_centroid * PI * 3.0),
        on_surface: |[u, v, w]| {
            let angle = PI as f32 * (v - 0.5);
            if w < 0.5 {
                on_circle(u) * (9.0 + 3.0 * angle.cos()) + Vec3::Z * (3.0 * angle.sin())
            } else {
                on_circle(u) * (9.0 * v) + Vec3::Z * 3.0
            }
        },
    }
}

fn egg() -> Known {
    // A spheroid has a closed area: 2πa²(1 + c/(a e) asin e) for c > a, e² = 1 − a²/c².
    let (a, c) = (6.0_f64, 11.0_f64);
    let e = (1.0 - a * a / (c * c)).sqrt();
    Known {
        name: "ellipsoid",
        node: ellipsoid([0.0; 3], [6.0, 6.0, 11.0]),
        size: 22.0,
        volume: 4.0 / 3.0 * PI * a * a * c,
        area: Some(2.0 * PI * a * a * (1.0 + c / (a * e) * e.asin())),
        on_surface: |[u, v, _]| on_sphere(u, v) * Vec3::new(6.0, 6.0, 11.0),
    }
}

fn potato() -> Known {
    Known {
        name: "ellipsoid of three radii",
        node: ellipsoid([0.0; 3], [12.0, 7.0, 4.0]),
        size: 24.0,
        volume: 4.0 / 3.0 * PI * 12.0 * 7.0 * 4.0,
        area: None,
        on_surface: |[u, v, _]| on_sphere(u, v) * Vec3::new(12.0, 7.0, 4.0),
    }
}

fn slab() -> Known {
    // A rectangle of 16 × 10 grown by 2 (Steiner in space).
    let (area, outline) = (160.0, 52.0);
    Known {
        name: "polygon",
        node: polygon([[-8.0, -5.0, 0.0], [8.0, -5.0, 0.0], [8.0, 5.0, 0.0], [-8.0, 5.0, 0.0]], 4.0),
        size: 20.0,
        volume: area * 4.0 + outline * PI * 4.0 / 2.0 + 4.0 / 3.0 * PI * 8.0,
        area: Some(2.0 * area + outline * PI * 2.0 + 4.0 * PI * 4.0),
        on_surface: |[u, v, w]| Vec3::new(16.0 * u - 8.0, 10.0 * v - 5.0, if w < 0.5 { 2.0 } else { -2.0 }),
    }
}

fn all() -> Vec<Known> {
    vec![
        sphere(),
        ring(),
        tube(),
        hat(),
        bucket(),
        brick(),
        soap(),
        capsule(),
        pebble(),
        egg(),
        potato(),
        slab(),
    ]
}

/// Some ways to stand in space, all of which keep volume and area.
fn poses() -> Vec<(&'static str, Transform)> {
    let turned = |x: f32, y: f32, z: f32, translate: [f32; 3]| Transform {
        translate: translate.into(),
        rotate_degrees: Vec3::new(x, y, z),
        ..Transform::default()
    };
    vec![
        ("upright", Transform::default()),
        ("off the lattice", turned(0.0, 0.0, 0.0, [0.137, -31.4, 7.77])),
        ("lying", turned(90.0, 0.0, 0.0, [3.0, 2.0, 1.0])),
        ("turned", turned(33.0, -71.0, 118.0, [-4.4, 12.3, 55.5])),
    ]
}

/// Panics unless the mesh at 128 cells across has this volume and area to 0.5 %; returns both errors.
fn assert_measures(name: &str, node: &Node, mm: f32, volume: f64, area: Option<f64>) -> (f64, f64) {
    let mesh = meshed(node, mm);
    assert_sound(&mesh, mm, name);
    let volume_error = mesh.volume() / volume - 1.0;
    let area_error = area.map_or(0.0, |area| mesh.area() / area - 1.0);
    assert!(volume_error.abs() < 0.005, "{name}: volume is off by {:.3} %", 100.0 * volume_error);
    assert!(area_error.abs() < 0.005, "{name}: area is off by {:.3} %", 100.0 * area_error);
    (volume_error.abs(), area_error.abs())
}

#[test]
fn solids_have_the_volume_and_area_of_their_closed_forms_at_128_cells() {
    for solid in all() {
        let mut worst = (0.0_f64, 0.0_f64);
        for (pose, transform) in poses() {
            let name = format!("{}, {pose}", solid.name);
            let node = solid.node.clone().warp(Warp::Transform(transform));
            let off = assert_measures(&name, &node, solid.size / 128.0, solid.volume, solid.area);
            worst = (worst.0.max(off.0), worst.1.max(off.1));
        }
        println!("{}: volume to {:.4} %, area to {:.4} %", solid.name, 100.0 * worst.0, 100.0 * worst.1);
    }
}

#[test]
fn scaled_and_sheared_solids_have_their_volume_times_the_determinant() {
    for solid in all() {
        for (name, linear) in [
            ("three scales", Mat3::from_diagonal(Vec3::new(1.5, 0.7, 1.1))),
            ("mirrored", Mat3::from_diagonal(Vec3::new(-1.0, 1.3, 0.8))),
            (
                "sheared",
                Mat3::from_cols(Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.4, 1.0, 0.1), Vec3::new(0.0, 0.3, 0.9)),
            ),
        ] {
            let rows = linear.transpose().to_cols_array_2d();
            let affine = AffineMap { rows: rows.map(|[x, y, z]| [x, y, z, 1.7]) };
            let node = solid.node.clone().warp(Warp::Affine(affine));
            let volume = solid.volume * f64::from(linear.determinant()).abs();
            assert_measures(&format!("{}, {name}", solid.name), &node, solid.size / 128.0, volume, None);
        }
    }
}

#[test]
fn twists_and_bends_keep_the_volume_that_calculus_says_they_keep() {
    // A twist keeps the volume of everything; a bend that of what lies symmetrically around its axis (Pappus).
    let tower = cuboid([0.0, 0.0, 15.0], [12.0, 8.0, 30.0]);
    assert_measures("twisted box", &tower.clone().twist(Axis::Z, 6.0), 30.0 / 128.0, 12.0 * 8.0 * 30.0, None);
    let bent = tower.clone().bend(Axis::Z, Axis::X, 5.0, 25.0, 90.0);
    assert_measures("bent box", &bent, 30.0 / 128.0, 12.0 * 8.0 * 30.0, None);
    // Cross-sections shrink linearly from 1 to s: the mean of the squares is (1 + s + s²)/3.
    let tapered = tower.taper(Axis::Z, 0.0, 30.0, 0.4);
    assert_measures("tapered box", &tapered, 30.0 / 128.0, 12.0 * 8.0 * 30.0 * 1.56 / 3.0, None);
}

#[test]
fn every_solid_is_one_half_on_its_surface() {
    for solid in all() {
        let mut rng = Rng::with_seed(1);
        let mut worst = 0.0_f32;
        for falloff in [None, Some(0.8), Some(12.0)] {
            let node = match falloff {
                Some(width) => solid.node.clone().with_falloff(width),
                None => solid.node.clone(),
            };
            let tree = Tree::new(&node);
            let points: Vec<Vec3> =
                (0..4000).map(|_| (solid.on_surface)([rng.f32(), rng.f32(), rng.f32()])).collect();
            let mut values = vec![0.0; points.len()];
            tree.sampler().values(&points, &mut values);
            for (p, value) in points.iter().zip(values) {
                worst = worst.max((value - 0.5).abs());
                assert!(
                    (value - 0.5).abs() < 1e-5,
                    "{} with falloff {falloff:?}: {value} at {p}",
                    solid.name
                );
            }
        }
        println!("{}: one half to {worst:.1e}", solid.name);
    }
}

/// Where the surface is along a ray from a point inside, mm: by bisection of the field.
fn surface_along(tree: &Tree, from: Vec3, direction: Vec3, reach: f32) -> f64 {
    let (from, direction) = (from.as_dvec3(), direction.as_dvec3());
    let (mut inside, mut outside) = (0.0, f64::from(reach));
    let at = |t: f64| tree.value((from + direction * t).as_vec3());
    assert!(at(inside) >= 0.5 && at(outside) < 0.5);
    for _ in 0..40 {
        let middle: f64 = f64::midpoint(inside, outside);
        *(if at(middle) >= 0.5 { &mut inside } else { &mut outside }) = middle;
    }
    f64::midpoint(inside, outside)
}

#[test]
fn a_points_surface_is_where_the_user_put_it() {
    let mut rng = Rng::with_seed(2);
    let mut worst = 0.0_f64;
    for round in 0..300 {
        let radius = [0.5_f32, 1.0, 10.0, 60.0][round % 4];
        let center = direction(&mut rng) * 50.0 * rng.f32();
        let falloff = [None, Some(0.1 * radius), Some(radius), Some(5.0 * radius)][rng.usize(..4)];
        let factor = [1.0_f32, 0.25, 3.0][rng.usize(..3)];
        let turn = direction(&mut rng) * 180.0;
        let ball = point(center, radius);
        let ball = match falloff {
            Some(width) => ball.with_falloff(width),
            None => ball,
        };
        let node = ball.scale([factor; 3]).rotate_degrees(turn).translate([1.0, -2.0, 3.0]);
        let [x, y, z] = turn.to_array().map(f32::to_radians);
        let turned = Quat::from_rotation_z(z) * Quat::from_rotation_y(y) * Quat::from_rotation_x(x);
        let middle = turned * (center * factor) + Vec3::new(1.0, -2.0, 3.0);
        let tree = Tree::new(&node);
        for _ in 0..10 {
            let wanted = f64::from(radius * factor);
            let off = surface_along(&tree, middle, direction(&mut rng), 4.0 * radius * factor) - wanted;
            worst = worst.max(off.abs() / wanted);
            let name = format!("radius {radius}, falloff {falloff:?}, scaled by {factor}, at {middle}");
            assert!(off.abs() < 1e-4 * wanted.max(1.0), "{name}: off by {off} mm");
        }
    }
    println!("surfaces of points are right to {worst:.1e} of the radius");
}

#[test]
fn unevenly_scaled_points_are_ellipsoids() {
    let mut rng = Rng::with_seed(3);
    let factors = Vec3::new(2.0, 0.5, 1.25);
    let tree = Tree::new(&point([0.0; 3], 8.0).scale(factors));
    for _ in 0..300 {
        let d = direction(&mut rng);
        let expected = 8.0 / (d / factors).length();
        let found = surface_along(&tree, Vec3::ZERO, d, 40.0);
        assert!((found - f64::from(expected)).abs() < 1e-4 * 16.0, "along {d}: {found}, not {expected}");
    }
}

#[test]
fn the_middle_of_a_mesh_is_that_of_the_solid() {
    for solid in [sphere(), ring(), brick(), egg()] {
        let node = solid.node.clone().translate([5.0, -7.0, 11.0]);
        let mass = meshed(&node, solid.size / 64.0).mass().expect("it has a volume");
        let off = mass.centre.distance(DVec3::new(5.0, -7.0, 11.0));
        assert!(off < 1e-3 * f64::from(solid.size), "{}: the centre of mass is off by {off} mm", solid.name);
    }
}

/// The types of nodes that are made from a drawing.
const DRAWN: [&str; 4] = ["inflation", "sweep", "revolution", "path_sweep"];

/// Random nodes of one type; operators and warps stand on primitives.
struct Nodes {
    random: RandomTree,
    meshes: Vec<Arc<MeshDistance>>,
    rng: Rng,
}

impl Nodes {
    fn new(seed: u64) -> Self {
        let meshes = [ring(), brick(), potato()].map(|solid| {
            let mesh = meshed(&solid.node.rotate_degrees([20.0, 30.0, 40.0]), solid.size / 24.0);
            Arc::new(MeshDistance::new(&mesh).expect("meshes of solids are sound"))
        });
        let (random, rng) = (RandomTree::new(seed), Rng::with_seed(seed));
        Self { random, meshes: meshes.into(), rng }
    }

    fn of_type(&mut self, name: &str) -> Node {
        if name == "mesh" {
            return Node::new(Shape::Primitive(Primitive::Mesh(ImportedMesh {
                file: "some.stl".into(),
                sha256: "0".repeat(64),
                falloff: 1.0 + 9.0 * self.rng.f32(),
                distance: self.meshes[self.rng.usize(..self.meshes.len())].clone(),
            })));
        }
        if name == "support_free" {
            let child = Node::new(Shape::Primitive(self.random.primitive()));
            let mode = [SupportMode::Trim, SupportMode::Grow][self.rng.usize(..2)];
            let rule = SupportFree { mode, layer_height: 1.0 + self.rng.f32(), ..self.random.rule() };
            return Node::new(Shape::SupportFree(rule, child.into()));
        }
        // Solving a drawing takes a while, so other nodes do without.
        self.random.drawn = DRAWN.contains(&name);
        let kinds = if self.random.drawn { 1 } else { 3 };
        for _ in 0..10_000 {
            let shape = match self.rng.u32(..kinds) {
                0 => Shape::Primitive(self.random.primitive()),
                1 => {
                    let operator = self.random.operator();
                    let count = self.rng.usize(2..=3);
                    let child = |_| Node::new(Shape::Primitive(self.random.primitive())).into();
                    Shape::Operator(operator, (0..count).map(child).collect())
                }
                _ => {
                    let warp = self.random.warp();
                    Shape::Warp(warp, Node::new(Shape::Primitive(self.random.primitive())).into())
                }
            };
            let node = Node::new(shape);
            if node.type_name() == name {
                return node;
            }
        }
        panic!("no random tree has a node of type {name}");
    }
}

/// Gradients by central differences with the steps that suit single precision, extrapolated from two sizes.
///
/// `None` within a step of a crease or a kink, where there is no single gradient to compare: at an edge of a solid,
/// where a warp ends, at places as far from one face of a mesh as from another. There the two sizes disagree, or,
/// if the kink is close to the very place, the field bends in proportion to the step instead of its square.
fn central_differences(tree: &Tree, places: &[(Vec3, f32)]) -> Vec<Option<Vec3>> {
    let steps = [3e-3, 6e-3];
    let mut points = Vec::new();
    for (p, scale) in places {
        points.push(*p);
        for (step, axis) in steps.into_iter().flat_map(|step| Vec3::AXES.map(|axis| (step, axis))) {
            points.extend([*p + axis * (step * scale), *p - axis * (step * scale)]);
        }
    }
    let mut values = vec![0.0; points.len()];
    tree.sampler().values(&points, &mut values);
    // In double precision only the subtraction is left to chance.
    let value = |at: usize| f64::from(values[at]);
    let step = |at: usize| f64::from((points[at] - points[at + 1]).length());
    let slope = |at: usize| ((value(at) - value(at + 1)) / step(at)) as f32;
    let gradient = |at: usize| Vec3::new(slope(at), slope(at + 2), slope(at + 4));
    let extrapolated = |(i, (_, scale)): (usize, &(Vec3, f32))| {
        let (middle, near, far) = (13 * i, 13 * i + 1, 13 * i + 7);
        let (fine, coarse) = (gradient(near), gradient(far));
        let size = fine.length().max(1e-3 / scale);
        let bend = |at: usize| value(at) + value(at + 1) - 2.0 * value(middle);
        let jump = |a: usize| ((4.0 * bend(near + a) - bend(far + a)) / step(near + a)) as f32;
        let jumps = Vec3::new(jump(0), jump(2), jump(4));
        let is_smooth = (fine - coarse).length() <= 5e-4 * size && jumps.length() <= 5e-4 * size;
        is_smooth.then(|| fine + (fine - coarse) / 3.0)
    };
    places.iter().enumerate().map(extrapolated).collect()
}

/// Errors of the gradients at up to `count` random places of a tree, and how many places were close to a kink.
fn gradient_errors(tree: &Tree, count: usize, rng: &mut Rng) -> (Vec<(f32, Vec3)>, usize) {
    let arena = tree.support().intersection(&Aabb::around(Vec3::ZERO, Vec3::splat(200.0)));
    if arena.is_empty() {
        return (Vec::new(), 0);
    }
    let points: Vec<Vec3> = (0..count).map(|_| point_in(rng, &arena)).collect();
    let mut samples = vec![Sample::default(); points.len()];
    tree.sampler().samples(&points, &mut samples);
    let size = arena.size().min_element().min(60.0);
    // Where the field is nearly flat, or steep far from the origin, single precision leaves nothing to compare.
    let tried = points.iter().zip(&samples).filter_map(|(p, sample)| {
        let steep = sample.gradient.length();
        let scale = size.min(1.0 / steep);
        let lost = 5e-7 * p.length() / (3e-3 * scale);
        let is_clear = sample.value >= 0.02 && steep * scale >= 0.05 && lost <= 5e-4;
        is_clear.then_some(((*p, scale), sample.gradient))
    });
    let (places, gradients): (Vec<_>, Vec<_>) = tried.unzip();
    let expected = central_differences(tree, &places);
    let kinks = expected.iter().filter(|e| e.is_none()).count();
    let errors = gradients.iter().zip(&expected).zip(&places).filter_map(|((found, expected), (p, _))| {
        let expected = (*expected)?;
        Some(((*found - expected).length() / expected.length(), *p))
    });
    (errors.collect(), kinks)
}

#[test]
fn gradients_are_those_of_central_differences_at_ten_thousand_places_of_every_type_of_node() {
    let seed = 11;
    let (mut nodes, mut rng) = (Nodes::new(seed), Rng::with_seed(seed));
    for name in TYPE_NAMES {
        let (mut tried, mut kinks, mut worst, mut round) = (0, 0, 0.0_f32, 0);
        let count = if DRAWN.contains(&name) || name == "support_free" { 3000 } else { 300 };
        while tried < 10_000 {
            let node = nodes.of_type(name);
            round += 1;
            assert!(round < 20_000, "{name}: only {tried} places to compare");
            // A shape that does not reach above the bed cannot be baked.
            let Ok(tree) = BakeStore::new().tree(&node.clone().into(), &Rebaker::new()) else { continue };
            let (errors, near_kinks) = gradient_errors(&tree, count, &mut rng);
            tried += errors.len();
            kinks += near_kinks;
            for (error, p) in errors {
                worst = worst.max(error);
                assert!(error < 1e-3, "{name}, seed {seed}, round {round}: {error:.1e} off at {p}: {node:?}");
            }
        }
        println!("{name}: {tried} places, {worst:.1e} off at most, {kinks} more within a step of a kink");
        assert!(kinks < tried, "{name}: too many places cannot be compared");
    }
}
