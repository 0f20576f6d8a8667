//! Meshes are closed, manifold, oriented and on the surface, whatever the field.

mod common;

use common::*;
use glam::Vec3;
use polygonizer::{CellSize, polygonize};

fn cell(mm: f32) -> CellSize {
    CellSize::from_mm(mm).expect("positive")
}

#[test]
fn noise_gives_sound_meshes_in_smooth_and_in_creased_regions() {
    for seed in 0..10 {
        let density = [0.5, 0.3, 0.7, 0.15, 0.85][seed as usize % 5];
        let noise = Noise { seed, size: 24, density, creased: seed % 2 == 0 };
        let mesh = polygonize(&noise, cell(1.0)).expect("small");
        assert_sound(&mesh, &format!("noise with seed {seed}"));
        assert!(!mesh.triangles.is_empty());
    }
}

/// Volume and area against their closed forms at 128 cells across.
fn assert_measures(name: &str, solid: &Solid, exact_volume: f64, exact_area: f64) {
    let size = cell(solid.bounds.size().max_element() / 128.0);
    let mesh = polygonize(solid, size).expect("small");
    assert_sound(&mesh, name);
    let (volume, area) = (volume(&mesh) / exact_volume - 1.0, area(&mesh) / exact_area - 1.0);
    println!("{name}: volume off by {:.4} %, area by {:.4} %", 100.0 * volume, 100.0 * area);
    assert!(volume.abs() < 0.005, "{name}: volume is off by {volume}");
    assert!(area.abs() < 0.005, "{name}: area is off by {area}");
    let worst = mesh.positions.iter().map(|&p| (solid.distance)(p).0.abs() / size.mm()).fold(0.0, f32::max);
    println!("{name}: worst vertex is {worst:.5} cells from the surface");
    assert!(worst < 0.01, "{name}: a vertex is {worst} cells from the surface");
}

#[test]
fn spheres_tori_cylinders_cones_and_boxes_have_their_volume_and_area() {
    use std::f64::consts::PI;
    let center = Vec3::new(0.3, -1.7, 2.9);
    assert_measures("sphere", &ball(center, 10.0), 4.0 / 3.0 * PI * 1000.0, 4.0 * PI * 100.0);
    let (torus_volume, torus_area) = (2.0 * PI * PI * 8.0 * 9.0, 4.0 * PI * PI * 8.0 * 3.0);
    assert_measures("torus", &torus(center, 8.0, 3.0), torus_volume, torus_area);
    assert_measures(
        "cylinder",
        &cylinder(center, 7.0, 10.0),
        PI * 49.0 * 20.0,
        PI * (2.0 * 49.0 + 14.0 * 20.0),
    );
    let slant = 7.0_f64.hypot(15.0);
    assert_measures("cone", &cone(center, 7.0, 15.0), PI * 49.0 * 5.0, PI * 7.0 * (7.0 + slant));
    let turned = TurnedBox { center, turn: Random(5).turn(), half: Vec3::new(5.0, 7.0, 9.0) };
    let (box_volume, box_area) = (10.0 * 14.0 * 18.0, 2.0 * (140.0 + 180.0 + 252.0));
    assert_measures("box of planes", &turned.as_planes(), box_volume, box_area);
    assert_measures("box by distance", &turned.as_distance(), box_volume, box_area);
}

#[test]
fn two_small_spheres_far_apart_are_both_found() {
    let small = |x: f32| ball(Vec3::new(x, 0.7 * x, -x), 1.0);
    let pair = union(small(-150.3), small(150.2));
    let mesh = polygonize(&pair, cell(1.0)).expect("small");
    assert_sound(&mesh, "two spheres");
    for side in [-1.0, 1.0] {
        assert!(mesh.positions.iter().any(|p| p.x * side > 100.0));
    }
}

/// Balls with an eccentric bubble: walls from a fifth of a cell to two cells.
#[test]
fn walls_thinner_than_a_cell_seldom_cross_themselves() {
    let (mut pairs, mut torn) = (0, Vec::new());
    for seed in 0..40 {
        let mut random = Random(seed);
        let center = random.point(0.5);
        let bubble = ball(center + 0.9 * random.direction(), 8.9);
        let mesh = polygonize(&difference(ball(center, 10.0), bubble), cell(1.0)).expect("small");
        assert_sound(&mesh, &format!("bubble with seed {seed}"));
        let count = mesh.crossings().count;
        pairs += count;
        torn.extend((count > 0).then_some(seed));
    }
    println!("{pairs} crossing pairs in the bubbles with seeds {torn:?}");
    // Quadrilaterals cut by the shorter diagonal, with vertices wherever the field leads, have 1390 pairs, in all 40.
    // What is left are walls so thin that a cell's only vertex is led to the other side. The goal is none.
    assert!(pairs <= 40 && torn.len() <= 8, "{pairs} crossing pairs in the bubbles with seeds {torn:?}");
}
