//! Meshes of every example and of random trees: sound, and as large as the field says.
//!
//! `TRULLO_SWEEP=full` meshes all examples at four resolutions and 500 random trees; without it, a part.

mod geometry;

use blobtree::build::*;
use blobtree::random::RandomTree;
use blobtree::{Field, ImportedMesh, NodeRef, Tree};
use geometry::*;
use glam::Vec3;
use mesh::{Mesh, MeshDistance, SelfIntersections, Validity, shapes};
use polygonizer::{Options, PolygonizeError, Surface};
use std::sync::Arc;

/// The largest difference of a mesh's volume from the field's, as a share.
const SHARE: f64 = 0.01;

/// All that is wrong with some meshes, told at the end.
#[derive(Default)]
struct Complaints(Vec<String>);

impl Complaints {
    /// Notes one, and says so at once, as a sweep may take long.
    fn note(&mut self, complaint: String) {
        println!("{complaint}");
        self.0.push(complaint);
    }

    /// Notes what makes the mesh unsound.
    fn check_sound(&mut self, mesh: &Mesh, mm: f32, name: &str) -> Validity {
        let report = mesh.validity(SelfIntersections::Skip);
        faults_of(mesh, &report, mm).into_iter().for_each(|fault| self.note(format!("{name}: {fault}")));
        report
    }

    /// Notes a volume that is not the field's to 1 %; returns the difference as a share.
    fn check_volume(&mut self, mesh: &Mesh, field: volume::Volume, name: &str) -> f64 {
        let off = mesh.volume() / field.estimate - 1.0;
        if field.relative_error() > SHARE / 4.0 {
            self.note(format!("{name}: the estimate {field:?} says too little"));
        }
        if off.abs() >= SHARE {
            self.note(format!(
                "{name}: {:.0} mm³, {:.2} % off the field's {field:?}",
                mesh.volume(),
                100.0 * off
            ));
        }
        off
    }
}

impl Drop for Complaints {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.0.is_empty(), "{} complaints: {:#?}", self.0.len(), self.0);
        }
    }
}

/// Largest change of a mesh's volume by halving its cells that shows that they were small enough, as a share.
///
/// Vertices lie on the surface, so what is convex and only a few cells wide must lose volume: a ball four
/// cells wide about a tenth. Volumes say something about the mesher only in cells smaller than that.
const SETTLED: f64 = 0.005;

/// Cells along the longest side of a random solid, until it is shown.
const CELLS: [u32; 5] = [40, 80, 160, 320, 640];

/// Crossing pairs of triangles that examples have left, by name and cells across. The goal is none.
const CROSSING: [(&str, u32, usize); 3] = [("forest", 32, 13), ("snowman", 128, 3), ("twisted-vase", 64, 40)];

fn has_settled(coarse: &Mesh, fine: &Mesh) -> bool {
    (coarse.volume() / fine.volume() - 1.0).abs() < SETTLED
}

#[test]
fn every_example_meshes_soundly_at_every_resolution_and_has_its_volume_where_that_shows_it() {
    let mut complaints = Complaints::default();
    for name in example_names() {
        let tree = Tree::new(&example(&name).root);
        let longest = solid_box(&tree).size().max_element();
        let field = volume::sampled_to(&tree, longest / 200.0, longest / 900.0, SHARE / 10.0, 1);
        let few = matches!(&*name, "bracket" | "snowman" | "two-blobs" | "forest");
        let all: &[u32] = if few || full_sweep() { &[32, 64, 128, 256] } else { &[32, 64, 128] };
        let mut finer: Option<Mesh> = None;
        for cells in all.iter().rev() {
            let mm = longest / *cells as f32;
            let allowed =
                CROSSING.iter().find(|(at, of, _)| *at == name && of == cells).map_or(0, |(.., n)| *n);
            let name = format!("{name} at {cells} cells");
            let mesh = surface(&tree, mm).mesh();
            let report = complaints.check_sound(&mesh, mm, &name);
            let crossing = mesh.crossings().count;
            if crossing > allowed {
                complaints.note(format!("{name}: {crossing} pairs of triangles cross"));
            }
            let settled = finer.as_ref().is_none_or(|finer| has_settled(&mesh, finer));
            let off = if settled {
                complaints.check_volume(&mesh, field, &name)
            } else {
                mesh.volume() / field.estimate - 1.0
            };
            println!(
                "{name}: {} triangles, {} parts, volume off by {:.3} % (estimate to {:.3} %){}",
                mesh.triangles.len(),
                report.bodies,
                100.0 * off,
                100.0 * field.relative_error(),
                if settled { "" } else { ", too coarse to show it" }
            );
            finer = Some(mesh);
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

/// The mesh in the coarsest cells, a 40th of the solid's box or a half, a quarter and so on of that, that show
/// the solid: their halves change the volume by less than [`SETTLED`]. Thin sheets and spikes need the finest.
/// Every mesh on the way must be sound. Solids too large for cells as fine show as much as they can; none those whose
/// field reaches too far for any.
fn telling_mesh(tree: &Tree, longest: f32, name: &str, complaints: &mut Complaints) -> Option<(f32, Mesh)> {
    let mut last: Option<(f32, Mesh)> = None;
    for cells in CELLS {
        let mm = longest / cells as f32;
        let mesh = match Surface::build(tree, cell(mm), &Options::default()) {
            Ok(surface) => surface.mesh(),
            Err(PolygonizeError::TooFine { .. }) => break,
            Err(error) => panic!("{name} at {cells} cells: {error}"),
        };
        complaints.check_sound(&mesh, mm, &format!("{name} at {cells} cells"));
        if last.as_ref().is_some_and(|last| has_settled(&last.1, &mesh)) {
            break;
        }
        last = Some((mm, mesh));
    }
    last
}

#[test]
fn random_trees_mesh_soundly_and_have_the_volume_of_their_field() {
    let imported = imported();
    let mut complaints = Complaints::default();
    let wanted = ordinary_or_full(15, 500);
    let (mut solids, mut empty, mut too_far) = (0, 0, 0);
    let (mut worst, mut needed) = ((0.0_f64, 0), [0; CELLS.len()]);
    for seed in 0.. {
        if solids == wanted {
            break;
        }
        let tree = Tree::new(&random_tree(seed, &imported));
        let longest = solid_box(&tree).size().max_element();
        if longest <= 0.0 {
            let stratum = (tree.support().size().max_element() / 256.0).max(0.01);
            let found = volume::sampled(&tree, stratum, seed).estimate;
            assert!(found < f64::from(4.0 * stratum).powi(3), "seed {seed}: {found} mm³ were not found");
            empty += 1;
            continue;
        }
        let name = format!("seed {seed}");
        let Some((mm, mesh)) = telling_mesh(&tree, longest, &name, &mut complaints) else {
            println!("{name}: a solid of {longest} mm in a field of {:?}", tree.support().size());
            too_far += 1;
            continue;
        };
        solids += 1;
        needed[(longest / mm / 40.0).log2().round() as usize] += 1;
        let field = volume::sampled_to(&tree, mm, mm / 8.0, SHARE / 10.0, seed);
        let off = complaints.check_volume(&mesh, field, &format!("{name} in cells of {mm} mm"));
        if off.abs() > worst.0 {
            worst = (off.abs(), seed);
        }
        if solids % 20 == 0 {
            println!("{solids} solids, {empty} empty trees; volumes to {:.3} % so far", 100.0 * worst.0);
        }
    }
    println!("{solids} solids, {empty} empty trees; volumes to {:.3} % (seed {})", 100.0 * worst.0, worst.1);
    println!("shown by {CELLS:?} cells: {needed:?}");
    assert!(empty <= solids && 50 * too_far <= solids, "too few solids to say anything: {empty}, {too_far}");
}

#[test]
fn random_trees_mesh_soundly_however_coarse_the_cells() {
    let imported = imported();
    let mut complaints = Complaints::default();
    let mut meshes = 0;
    for seed in 0..ordinary_or_full(120, 1000) {
        let tree = Tree::new(&random_tree(seed, &imported));
        for cells in [7.0, 19.0, 40.0] {
            let mm = tree.support().size().max_element() / cells;
            if mm > 0.0 {
                let mesh = surface(&tree, mm).mesh();
                complaints.check_sound(&mesh, mm, &format!("seed {seed} at {cells} cells"));
                meshes += usize::from(!mesh.triangles.is_empty());
            }
        }
    }
    println!("{meshes} meshes");
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
