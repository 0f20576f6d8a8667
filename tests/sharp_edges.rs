//! Meshes keep the corners of boxes, however these are turned, and their edges but for a few places near corners.

mod geometry;

use blobtree::build::*;
use blobtree::{Transform, Tree, Warp};
use fastrand::Rng;
use geometry::*;
use glam::{Quat, Vec3};
use mesh::Mesh;

/// Where the corners of a box end up; bit 0, 1, 2 of the number is the side in x, y, z.
fn corners(half: Vec3, transform: &Transform) -> [Vec3; 8] {
    let [x, y, z] = transform.rotate_degrees.to_array().map(|d| f64::from(d).to_radians());
    let turn =
        glam::DQuat::from_rotation_z(z) * glam::DQuat::from_rotation_y(y) * glam::DQuat::from_rotation_x(x);
    std::array::from_fn(|i| {
        let side = |axis: usize| if i >> axis & 1 == 1 { half[axis] } else { -half[axis] };
        let corner = Vec3::new(side(0), side(1), side(2)).as_dvec3();
        (turn * corner + transform.translate.as_dvec3()).as_vec3()
    })
}

/// The 12 pairs of corners that an edge joins.
fn edges() -> impl Iterator<Item = [usize; 2]> {
    (0..8).flat_map(|i| (0..3).filter(move |axis| i >> axis & 1 == 0).map(move |axis| [i, i | 1 << axis]))
}

/// Distance from a point to the nearest of some triangles of a mesh, mm.
fn distance_to(mesh: &Mesh, near: &[[u32; 3]], p: Vec3) -> f32 {
    near.iter()
        .map(|t| distance_to_triangle(p, t.map(|i| mesh.positions[i as usize])))
        .fold(f32::INFINITY, f32::min)
}

/// How far a box's features are from those of its mesh, in cells.
struct Off {
    /// From the worst corner to the nearest vertex.
    corner: f32,
    /// From each of 61 points of every edge to the mesh, ascending.
    edges: Vec<f32>,
}

impl Off {
    fn worst_edge(&self) -> f32 {
        self.edges.last().copied().unwrap_or_default()
    }

    /// How many edge points are more than 0.05 cells off.
    fn cut_off(&self) -> usize {
        self.edges.len() - self.edges.partition_point(|off| *off <= CLOSE)
    }
}

/// How far features may be off, in cells.
const CLOSE: f32 = 0.05;

/// The share of points on edges that may be farther off: where a triangle joins the edges that meet in a corner,
/// past that corner. The goal is none.
const MOST_CUT_OFF: f32 = 0.0015;

fn off(mesh: &Mesh, corners: &[Vec3; 8], mm: f32) -> Off {
    let to_vertex =
        |corner: &Vec3| mesh.positions.iter().map(|v| v.distance(*corner)).fold(f32::INFINITY, f32::min);
    let corner = corners.iter().map(to_vertex).fold(0.0, f32::max) / mm;
    let mut off = Vec::new();
    for [a, b] in edges() {
        let (a, b) = (corners[a], corners[b]);
        let is_near = |i: &u32| distance_to_segment(mesh.positions[*i as usize], a, b) < 2.0 * mm;
        let near: Vec<[u32; 3]> = mesh.triangles.iter().filter(|t| t.iter().any(is_near)).copied().collect();
        off.extend((0..=60).map(|i| distance_to(mesh, &near, a.lerp(b, i as f32 / 60.0)) / mm));
    }
    off.sort_unstable_by(f32::total_cmp);
    Off { corner, edges: off }
}

#[test]
fn a_turned_box_keeps_its_8_corners_and_nearly_all_of_its_12_edges() {
    let (mut bad, mut meshes) = (Vec::new(), Vec::new());
    let (mut worst, mut cut_off, mut points) = ((0.0_f32, 0.0_f32), 0, 0);
    for seed in 0..100 {
        let mut rng = Rng::with_seed(seed);
        let size = Vec3::from_array(std::array::from_fn(|_| 6.0 + 14.0 * rng.f32()));
        let transform = Transform {
            translate: direction(&mut rng) * 20.0 * rng.f32(),
            rotate_degrees: Vec3::from_array(std::array::from_fn(|_| 360.0 * rng.f32() - 180.0)),
            ..Transform::default()
        };
        let corners = corners(size / 2.0, &transform);
        let node = cuboid([0.0; 3], size).warp(Warp::Transform(transform));
        let mm = size.max_element() / 30.0;
        let mesh = meshed(&node, mm);
        let off = off(&mesh, &corners, mm);
        let (corner, edge) = (off.corner, off.worst_edge());
        (cut_off, points) = (cut_off + off.cut_off(), points + off.edges.len());
        worst = (worst.0.max(corner), worst.1.max(edge));
        meshes.push((mesh, mm, format!("box {seed}")));
        if corner > CLOSE {
            bad.push(format!("seed {seed}: corner {corner:.3}"));
        }
    }
    println!("corners to {:.4} cells, edges to {:.4} cells", worst.0, worst.1);
    println!("{cut_off} of {points} edge points are more than {CLOSE} cells off");
    assert!(bad.is_empty(), "{} of 100 boxes lose corners, in cells: {bad:#?}", bad.len());
    assert!(
        (cut_off as f32) < MOST_CUT_OFF * points as f32,
        "{cut_off} of {points} points of edges are cut off"
    );
    meshes.iter().for_each(|(mesh, mm, name)| drop(assert_sound(mesh, *mm, name)));
}

#[test]
fn a_box_along_the_lattice_keeps_its_8_corners_and_its_12_edges_wherever_its_faces_are() {
    let mut bad = Vec::new();
    // Faces exactly on lattice planes, between them, and just beside.
    for offset in [0.0_f32, 0.25, 0.5, 0.499, 0.45, 0.05, 2e-3, 1e-3, 3e-4, 1e-4, -1e-4, -3e-4, -1e-3, -2e-3]
    {
        let transform = Transform { translate: Vec3::splat(offset), ..Transform::default() };
        let half = Vec3::new(10.0, 6.0, 4.0);
        let mesh = meshed(&cuboid([0.0; 3], half * 2.0).warp(Warp::Transform(transform.clone())), 0.5);
        assert_sound(&mesh, 0.5, &format!("box moved by {offset}"));
        let off = off(&mesh, &corners(half, &transform), 0.5);
        if off.corner > CLOSE || off.worst_edge() > CLOSE {
            let (corner, edge, share) = (off.corner, off.worst_edge(), off.cut_off());
            bad.push(format!("moved by {offset}: corner {corner}, edge {edge}, {share} edge points"));
        }
    }
    assert!(bad.is_empty(), "features are off, in cells: {bad:#?}");
}

#[test]
fn the_rim_of_a_turned_cylinder_and_the_tip_of_a_cone_are_kept() {
    let (mut bad, mut points) = (Vec::new(), 0);
    for seed in 0..30 {
        let mut rng = Rng::with_seed(seed);
        let axis = direction(&mut rng);
        let at = direction(&mut rng) * 5.0;
        let mm = 0.5;
        let mesh = meshed(&cylinder(at - axis * 7.0, at + axis * 7.0, 6.0), mm);
        let side = axis.any_orthonormal_vector();
        for end in [-7.0, 7.0] {
            for i in 0..48 {
                let around = Quat::from_axis_angle(axis, i as f32 / 48.0 * std::f32::consts::TAU);
                let p = at + axis * end + around * side * 6.0;
                let is_near = |i: &u32| mesh.positions[*i as usize].distance(p) < 2.0 * mm;
                let near: Vec<[u32; 3]> =
                    mesh.triangles.iter().filter(|t| t.iter().any(is_near)).copied().collect();
                let off = distance_to(&mesh, &near, p) / mm;
                points += 1;
                if off > CLOSE {
                    bad.push(format!("seed {seed}: {off} cells at {p}"));
                }
            }
        }
        let tip = at + axis * 12.0;
        let mesh = meshed(&cone(at, tip, 6.0), mm);
        let off = mesh.positions.iter().map(|v| v.distance(tip)).fold(f32::INFINITY, f32::min) / mm;
        assert!(off < CLOSE, "seed {seed}: the tip is {off} cells off");
    }
    let cut_off = bad.len() as f32;
    assert!(
        cut_off < MOST_CUT_OFF * 2.0 * points as f32,
        "{cut_off} of {points} points of rims are cut off: {bad:#?}"
    );
}

#[test]
fn the_field_of_a_turned_box_is_one_half_on_its_edges() {
    let transform = Transform { rotate_degrees: Vec3::new(20.0, 50.0, -70.0), ..Transform::default() };
    let half = Vec3::new(5.0, 6.0, 7.0);
    let corners = corners(half, &transform);
    let tree = Tree::new(&cuboid([0.0; 3], half * 2.0).warp(Warp::Transform(transform)));
    for [a, b] in edges() {
        for i in 0..=20 {
            let value = blobtree::Field::value(&tree, corners[a].lerp(corners[b], i as f32 / 20.0));
            assert!((value - 0.5).abs() < 1e-5, "{value}");
        }
    }
}
