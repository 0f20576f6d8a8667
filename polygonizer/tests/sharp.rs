//! Edges and corners are kept.

mod common;

use common::*;
use glam::{Quat, Vec3};
use mesh::Mesh;
use polygonizer::{CellSize, polygonize};

/// How far features may be off, in cells.
const CLOSE: f32 = 0.05;

/// The triangles with a vertex near the segment from `a` to `b`.
fn triangles_near(mesh: &Mesh, a: Vec3, b: Vec3, distance: f32) -> Mesh {
    let is_near = |i: u32| {
        let p = mesh.positions[i as usize] - a;
        let t = (p.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance((b - a) * t) < distance
    };
    let near = mesh.triangles.iter().copied().filter(|t| t.iter().any(|&i| is_near(i)));
    Mesh { positions: mesh.positions.clone(), triangles: near.collect() }
}

fn random_box(seed: u64) -> TurnedBox {
    let mut random = Random(seed);
    TurnedBox {
        center: random.point(5.0),
        turn: random.turn(),
        half: Vec3::new(random.between(3.0, 8.0), random.between(3.0, 8.0), random.between(3.0, 8.0)),
    }
}

#[test]
fn turned_boxes_keep_all_corners_and_nearly_all_of_their_edges() {
    let (mut worst_corner, mut points, mut cut_off) = (0.0_f32, 0, Vec::new());
    for seed in 0..100 {
        let turned = random_box(seed);
        let solid = if seed % 4 < 2 { turned.as_planes() } else { turned.as_distance() };
        let cells = if seed % 2 == 0 { 20 } else { 40 };
        let size = CellSize::across(solid.bounds.size().max_element(), cells).expect("positive");
        let mesh = polygonize(&solid, size).expect("small");
        assert_sound(&mesh, &format!("seed {seed}"));
        for corner in turned.corners() {
            let nearest = mesh.positions.iter().map(|v| v.distance(corner)).fold(f32::INFINITY, f32::min);
            let off = nearest / size.mm();
            assert!(off < CLOSE, "seed {seed}: a corner is {off} cells from the nearest vertex");
            worst_corner = worst_corner.max(off);
        }
        for [a, b] in turned.edges() {
            let near = triangles_near(&mesh, a, b, 2.0 * size.mm());
            for i in 0..40 {
                let off = distance_to_mesh(a.lerp(b, i as f32 / 39.0), &near) / size.mm();
                points += 1;
                if off >= CLOSE {
                    cut_off.push((off, seed));
                }
            }
        }
    }
    let share = cut_off.len() as f32 / points as f32;
    println!("worst corner {worst_corner} cells; {:.3} % of edges cut off: {cut_off:?}", 100.0 * share);
    // What is left are triangles that join the edges that meet in a corner, past that corner. The goal is none.
    assert!(share < 8e-4, "{share} of all edge points are off: {cut_off:?}");
    assert!(cut_off.iter().all(|(off, _)| *off < 0.4), "{cut_off:?}");
}

#[test]
fn boxes_along_the_lattice_keep_their_corners_and_edges() {
    let size = CellSize::from_mm(0.5).expect("positive");
    let mut bad = Vec::new();
    for offset in [0.0_f32, 0.25, 0.5, 0.499, 0.45, 0.05, 2e-3, 1e-3, 3e-4, 1e-4, -1e-4, -3e-4, -1e-3, -2e-3]
    {
        let half = Vec3::new(10.0, 6.0, 4.0);
        let along = TurnedBox { center: Vec3::splat(offset), turn: Quat::IDENTITY, half };
        for (name, solid) in [("planes", along.as_planes()), ("distance", along.as_distance())] {
            let name = format!("box by {name} moved by {offset}");
            let mesh = polygonize(&solid, size).expect("small");
            assert_sound(&mesh, &name);
            for corner in along.corners() {
                let off = mesh.positions.iter().map(|v| v.distance(corner)).fold(f32::INFINITY, f32::min);
                if off / size.mm() > CLOSE {
                    bad.push(format!("{name}: a corner is {} cells off", off / size.mm()));
                }
            }
            for [a, b] in along.edges() {
                let near = triangles_near(&mesh, a, b, 2.0 * size.mm());
                let off = |i: usize| distance_to_mesh(a.lerp(b, i as f32 / 39.0), &near) / size.mm();
                let worst = (0..40).map(off).fold(0.0, f32::max);
                if worst > CLOSE {
                    bad.push(format!("{name}: the edge from {a} to {b} is {worst} cells off"));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{bad:#?}");
}

#[test]
fn the_rims_of_a_cylinder_and_the_apex_of_a_cone_are_kept() {
    let size = CellSize::from_mm(0.4).expect("positive");
    let center = Vec3::new(0.31, 0.17, -0.23);
    let mesh = polygonize(&cylinder(center, 5.0, 6.0), size).expect("small");
    assert_sound(&mesh, "cylinder");
    let mut off_rim = Vec::new();
    for side in [-6.0, 6.0] {
        for i in 0..500 {
            let (sin, cos) = (i as f32 / 500.0 * std::f32::consts::TAU).sin_cos();
            let on_rim = center + Vec3::new(5.0 * cos, 5.0 * sin, side);
            off_rim.push(distance_to_mesh(on_rim, &mesh) / size.mm());
        }
    }
    let cut_off = off_rim.iter().filter(|off| **off >= CLOSE).count();
    println!("{cut_off} of 1000 points of the rims are cut off");
    assert!(cut_off <= 10, "{cut_off} of 1000 points of the rims are cut off");
    let mesh = polygonize(&cone(center, 5.0, 9.0), size).expect("small");
    assert_sound(&mesh, "cone");
    let apex = distance_to_mesh(center + Vec3::new(0.0, 0.0, 9.0), &mesh) / size.mm();
    assert!(apex < CLOSE, "the apex is {apex} cells off");
}

#[test]
fn a_smooth_field_said_to_be_creased_has_the_same_mesh() {
    let size = CellSize::from_mm(0.5).expect("positive");
    let smooth = torus(Vec3::new(0.2, 0.1, 0.0), 8.0, 3.0);
    let plain = polygonize(&smooth, size).expect("small");
    let creased = Solid { creased: true, ..smooth };
    assert!(polygonize(&creased, size).expect("small") == plain);
}
