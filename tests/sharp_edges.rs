//! Meshes keep the edges and corners of boxes, however these are turned.

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

/// The farthest that a corner is from all vertices, and a point of an edge from the mesh, mm.
fn farthest(mesh: &Mesh, corners: &[Vec3; 8], mm: f32) -> (f32, f32) {
    let to_vertex =
        |corner: &Vec3| mesh.positions.iter().map(|v| v.distance(*corner)).fold(f32::INFINITY, f32::min);
    let corner = corners.iter().map(to_vertex).fold(0.0, f32::max);
    let mut edge = 0.0_f32;
    for [a, b] in edges() {
        let (a, b) = (corners[a], corners[b]);
        let is_near = |i: &u32| distance_to_segment(mesh.positions[*i as usize], a, b) < 2.0 * mm;
        let near: Vec<[u32; 3]> = mesh.triangles.iter().filter(|t| t.iter().any(is_near)).copied().collect();
        for i in 0..=60 {
            edge = edge.max(distance_to(mesh, &near, a.lerp(b, i as f32 / 60.0)));
        }
    }
    (corner, edge)
}

#[test]
fn a_turned_box_keeps_its_12_edges_and_8_corners() {
    let (mut bad, mut meshes) = (Vec::new(), Vec::new());
    let mut worst = (0.0_f32, 0.0_f32);
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
        let (corner, edge) = farthest(&mesh, &corners, mm);
        let (corner, edge) = (corner / mm, edge / mm);
        worst = (worst.0.max(corner), worst.1.max(edge));
        meshes.push((mesh, mm, format!("box {seed}")));
        if corner > 0.05 || edge > 0.05 {
            bad.push(format!("seed {seed}: corner {corner:.3}, edge {edge:.3}"));
        }
    }
    println!("corners to {:.4} cells, edges to {:.4} cells", worst.0, worst.1);
    assert!(bad.is_empty(), "{} of 100 boxes lose edges, in cells: {bad:#?}", bad.len());
    meshes.iter().for_each(|(mesh, mm, name)| drop(assert_sound(mesh, *mm, name)));
}

#[test]
fn a_box_on_the_lattice_keeps_its_edges_too() {
    // Faces exactly on lattice planes, between them, and just beside.
    for offset in [0.0_f32, 0.25, 0.5, 0.499, 1e-4, -1e-4] {
        let transform = Transform { translate: Vec3::splat(offset), ..Transform::default() };
        let half = Vec3::new(10.0, 6.0, 4.0);
        let mesh = meshed(&cuboid([0.0; 3], half * 2.0).warp(Warp::Transform(transform.clone())), 0.5);
        assert_sound(&mesh, 0.5, &format!("box moved by {offset}"));
        let (corner, edge) = farthest(&mesh, &corners(half, &transform), 0.5);
        assert!(corner < 0.025 && edge < 0.025, "moved by {offset}: {corner} and {edge} mm");
    }
}

#[test]
fn the_rim_of_a_turned_cylinder_and_the_tip_of_a_cone_are_kept() {
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
                assert!(off < 0.05, "seed {seed}: the rim is {off} cells off at {p}");
            }
        }
        let tip = at + axis * 12.0;
        let mesh = meshed(&cone(at, tip, 6.0), mm);
        let off = mesh.positions.iter().map(|v| v.distance(tip)).fold(f32::INFINITY, f32::min) / mm;
        assert!(off < 0.05, "seed {seed}: the tip is {off} cells off");
    }
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
