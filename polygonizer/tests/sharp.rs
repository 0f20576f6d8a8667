//! Edges and corners are kept.

mod common;

use common::*;
use glam::Vec3;
use mesh::Mesh;
use polygonizer::{CellSize, polygonize};

/// The worst distance from corners to vertices and from edge points to the mesh, in cells.
fn worst(turned: &TurnedBox, solid: &Solid, cells: u32, name: &str) -> (f32, f32) {
    let size = CellSize::across(solid.bounds.size().max_element(), cells).expect("positive");
    let mesh = polygonize(solid, size).expect("small");
    assert_sound(&mesh, name);
    let nearest_vertex =
        |p: Vec3| mesh.positions.iter().map(|v| v.distance(p)).fold(f32::INFINITY, f32::min);
    let corner = turned.corners().map(nearest_vertex).into_iter().fold(0.0, f32::max);
    let mut edge = 0.0_f32;
    for [a, b] in turned.edges() {
        let near = triangles_near(&mesh, a, b, 2.0 * size.mm());
        for i in 0..60 {
            edge = edge.max(distance_to_mesh(a.lerp(b, i as f32 / 59.0), &near));
        }
    }
    for [a, b] in turned.edges() {
        let near = triangles_near(&mesh, a, b, 2.0 * size.mm());
        for i in 0..60 {
            let d = distance_to_mesh(a.lerp(b, i as f32 / 59.0), &near)/size.mm();
            let mut c = COUNT.lock().unwrap(); c[0] += 1; if d > 0.05 { c[1] += 1; }
        }
    }
    for c in turned.corners() { let mut k = COUNT.lock().unwrap(); k[2] += 1; if nearest_vertex(c) > 0.05*size.mm() { k[3] += 1; } }
    (corner / size.mm(), edge / size.mm())
}

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

static COUNT: std::sync::Mutex<[usize;4]> = std::sync::Mutex::new([0;4]);
#[test]
fn a_turned_box_keeps_its_corners_and_edges() {
    let mut all = Vec::new();
    for seed in 0..100 {
        let mut random = Random(seed);
        let turned = TurnedBox {
            center: random.point(5.0),
            turn: random.turn(),
            half: Vec3::new(random.between(3.0, 8.0), random.between(3.0, 8.0), random.between(3.0, 8.0)),
        };
        let cells = if seed % 2 == 0 { 20 } else { 40 };
        for (name, solid) in [("planes", turned.as_planes()), ("distance", turned.as_distance())] {
            let (corner, edge) = worst(&turned, &solid, cells, &format!("seed {seed}, box of {name}"));
            all.push((seed, name, corner, edge));
        }
    }
    let worst_corner = all.iter().max_by(|a, b| a.2.total_cmp(&b.2)).expect("some");
    let worst_edge = all.iter().max_by(|a, b| a.3.total_cmp(&b.3)).expect("some");
    println!("worst corner {worst_corner:?}\nworst edge {worst_edge:?}");
    println!("{:?}", COUNT.lock().unwrap());
    for bad in all.iter().filter(|a| a.2 > 0.05 || a.3 > 0.05) {
        println!("bad: {bad:?}");
    }
    assert!(worst_corner.2 < 0.05 && worst_edge.3 < 0.05);
}
