//! Meshes of every example and of random trees: sound, and as large as the field says.
//!
//! `TRULLO_SWEEP=full` meshes all examples at four resolutions and 500 random trees; without it, a part.

mod geometry;

use blobtree::build::*;
use blobtree::random::RandomTree;
use blobtree::{Field, ImportedMesh, NodeRef, Tree};
use geometry::*;
use glam::Vec3;
use mesh::{MeshDistance, shapes};
use std::sync::Arc;

/// The largest difference of a mesh's volume from the field's, as a share.
const SHARE: f64 = 0.01;

/// Panics unless the mesh has the field's volume to 1 %; returns the difference.
fn assert_volume(mesh_volume: f64, field: volume::Volume, name: &str) -> f64 {
    assert!(field.relative_error() < SHARE / 4.0, "{name}: the estimate {field:?} says too little");
    let off = mesh_volume / field.estimate - 1.0;
    let percent = 100.0 * off;
    assert!(off.abs() < SHARE, "{name}: {mesh_volume} mm³ are {percent:.2} % off the field's {field:?}");
    off
}

#[test]
fn every_example_meshes_soundly_at_every_resolution() {
    for name in example_names() {
        let tree = Tree::new(&example(&name).root);
        let longest = solid_box(&tree).size().max_element();
        let field = volume::sampled_to(&tree, longest / 200.0, longest / 900.0, SHARE / 10.0, 1);
        let few = matches!(&*name, "bracket" | "snowman");
        let finest = ordinary_or_full(if few { 256 } else { 128 }, 256);
        for cells in [32, 64, 128, 256].into_iter().filter(|cells| *cells <= finest) {
            let mm = longest / cells as f32;
            let name = format!("{name} at {cells} cells");
            let mesh = surface(&tree, mm).mesh();
            let report = assert_sound(&mesh, mm, &name);
            let off = assert_volume(mesh.volume(), field, &name);
            println!(
                "{name}: {} triangles, {} parts, volume off by {:.3} % (estimate to {:.3} %)",
                mesh.triangles.len(),
                report.bodies,
                100.0 * off,
                100.0 * field.relative_error()
            );
        }
    }
}

/// A random tree of all node types, an imported mesh among the primitives.
fn random_tree(seed: u64, imported: &ImportedMesh) -> NodeRef {
    let mut random = RandomTree::new(seed);
    random.mesh = Some(imported.clone());
    random.tree()
}

fn imported() -> ImportedMesh {
    let ring = shapes::torus(Vec3::new(5.0, -3.0, 8.0), 20.0, 7.0, 48, 24);
    let distance = MeshDistance::new(&ring).unwrap_or_else(|e| panic!("{e}"));
    ImportedMesh {
        file: "ring.stl".into(),
        sha256: "0".repeat(64),
        falloff: 6.0,
        distance: Arc::new(distance),
    }
}

/// A cell that shows the solid: a 40th of its box, or half of volume over area where it is thin. A sheet is
/// then four cells thick, and a ball twelve cells wide.
fn telling_cell(tree: &Tree, coarse: f32) -> Option<f32> {
    let field = volume::sampled_to(tree, coarse / 2.0, coarse / 20.0, 0.05, 7);
    let mesh = surface(tree, coarse).mesh();
    let thickness = (field.estimate / mesh.area().max(f64::MIN_POSITIVE)) as f32;
    (field.estimate > 0.0).then(|| coarse.min(thickness / 2.0))
}

#[test]
fn random_trees_mesh_soundly_and_have_the_volume_of_their_field() {
    let imported = imported();
    let seeds = ordinary_or_full(100, 500);
    let (mut empty, mut worst, mut finest) = (0, (0.0_f64, 0), (0.0_f32, 0));
    for seed in 0..seeds {
        let tree = Tree::new(&random_tree(seed, &imported));
        let longest = solid_box(&tree).size().max_element();
        let Some(mm) = (longest > 0.0).then(|| telling_cell(&tree, longest / 40.0)).flatten() else {
            empty += 1;
            continue;
        };
        let name = format!("seed {seed} in cells of {mm} mm");
        let mesh = surface(&tree, mm).mesh();
        assert_sound(&mesh, mm, &name);
        let field = volume::sampled_to(&tree, mm, mm / 8.0, SHARE / 10.0, seed);
        let off = assert_volume(mesh.volume(), field, &name);
        if off.abs() > worst.0 {
            worst = (off.abs(), seed);
        }
        if longest / mm > finest.0 {
            finest = (longest / mm, seed);
        }
    }
    println!("{empty} of {seeds} trees are empty; volumes to {:.3} % (seed {})", 100.0 * worst.0, worst.1);
    println!("the thinnest took {:.0} cells across (seed {})", finest.0, finest.1);
    assert!(empty * 5 < seeds, "too many empty trees to say anything");
}

#[test]
fn random_trees_mesh_soundly_in_cells_far_too_coarse_for_them() {
    let imported = imported();
    for seed in 0..ordinary_or_full(150, 500) {
        let tree = Tree::new(&random_tree(seed, &imported));
        if tree.support().is_empty() {
            continue;
        }
        for cells in [7.0, 19.0] {
            let mm = tree.support().size().max_element() / cells;
            let mesh = surface(&tree, mm).mesh();
            if !mesh.triangles.is_empty() {
                assert_sound(&mesh, mm, &format!("seed {seed} at {cells} cells"));
            }
        }
    }
}

#[test]
fn two_small_spheres_far_from_everything_are_found() {
    let cell_mm = 1.0;
    for round in 0..20 {
        let mut rng = fastrand::Rng::with_seed(round);
        // Two cells in diameter, 400 cells from each other and from the ball in the middle.
        let away = direction(&mut rng) * 400.0;
        let small = |at: Vec3| point(at, 1.0);
        let root = union([small(away), point([0.0; 3], 12.0), small(away * -1.0)]);
        let mesh = meshed(&root, cell_mm);
        let report = assert_sound(&mesh, cell_mm, &format!("round {round}"));
        assert_eq!(report.bodies, 3, "round {round}");
        for at in [away, away * -1.0] {
            assert!(mesh.positions.iter().any(|p| p.distance(at) < 1.5), "round {round}: nothing at {at}");
        }
    }
}
