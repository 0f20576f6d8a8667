//! What caches promise: accuracy, creases, and work saved.

use blobtree::build::{Build, cuboid, cylinder, point, sum, union};
use blobtree::random::RandomTree;
use blobtree::{
    Aabb, BRICK_SAMPLES, Brick, CachePolicy, CacheStore, ChangedPlaces, Dirty, Field, ISO, ImportedMesh,
    Node, NodeRef, Primitive, Shape, Tree, changed_region,
};
use fastrand::Rng;
use glam::Vec3;
use mesh::MeshDistance;
use std::sync::Arc;

const EVERYWHERE: CachePolicy = CachePolicy { least_cost: 2, cells: 128 };

fn point_in(rng: &mut Rng, region: &Aabb) -> Vec3 {
    region.min + region.size() * Vec3::new(rng.f32(), rng.f32(), rng.f32())
}

/// Fills every brick that the surface may pass, as meshing does.
fn sweep(tree: &Tree, cells: f32) {
    let support = tree.support();
    let spacing = support.size().max_element() / cells;
    let [low, high] = [support.min, support.max].map(|p| (p / (15.0 * spacing)).floor().as_ivec3());
    let mut values = [0.0; BRICK_SAMPLES];
    let mut sampler = tree.sampler();
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let brick = Brick { origin: [x, y, z].map(|i| 15 * i), spacing };
                if sampler.enter(brick.region()).may_cross(ISO) {
                    sampler.fill(&brick, &mut values);
                }
                sampler.leave();
            }
        }
    }
}

/// 1,000 balls in 40 trees of 25.
fn forest() -> Vec<Node> {
    let mut rng = Rng::with_seed(7);
    let tree = |i: usize, rng: &mut Rng| {
        let (x, y) = ((i % 8) as f32 * 24.0, (i / 8) as f32 * 24.0);
        sum((0..25).map(|_| {
            let at = [x + 14.0 * rng.f32(), y + 14.0 * rng.f32(), 4.0 + 14.0 * rng.f32()];
            point(at, 1.5 + 1.5 * rng.f32())
        }))
        .named(format!("tree {i}"))
    };
    (0..40).map(|i| tree(i, &mut rng)).collect()
}

#[test]
fn cached_fields_stay_within_a_hundredth_of_the_exact_one() {
    for seed in 0..60 {
        let mut random = RandomTree::new(seed);
        random.depth = 4;
        let root = random.tree();
        let (exact, cached) = (Tree::new(&root), CacheStore::new(EVERYWHERE).tree(&root));
        let arena = exact.support().intersection(&Aabb::around(Vec3::ZERO, Vec3::splat(150.0)));
        if arena.is_empty() {
            continue;
        }
        let mut rng = Rng::with_seed(seed);
        let points: Vec<Vec3> = (0..3000).map(|_| point_in(&mut rng, &arena)).collect();
        let (mut a, mut b) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        exact.sampler().values(&points, &mut a);
        cached.sampler().values(&points, &mut b);
        for ((p, a), b) in points.iter().zip(&a).zip(&b) {
            assert!((a - b).abs() < 0.01, "seed {seed} at {p}: {b} instead of {a}");
        }
    }
}

#[test]
fn sharp_edges_are_exact_through_caches() {
    let block = || cuboid([0.0, 0.0, 10.0], [40.0, 30.0, 20.0]);
    let bore = || cylinder([5.0, 0.0, -1.0], [5.0, 0.0, 30.0], 6.0);
    let root: NodeRef = union([block().subtract(bore()), point([-20.0, 0.0, 20.0], 7.0)]).into();
    let (exact, cached) = (Tree::new(&root), CacheStore::new(EVERYWHERE).tree(&root));
    let on_edges = (0..200).map(|i| {
        let angle = i as f32 / 200.0 * std::f32::consts::TAU;
        Vec3::new(5.0 + 6.0 * angle.cos(), 6.0 * angle.sin(), 20.0)
    });
    for p in on_edges {
        let spacing = 0.2;
        let origin = (p / spacing).round().as_ivec3() - 8;
        let brick = Brick { origin: origin.to_array(), spacing };
        let (mut a, mut b) = ([0.0; BRICK_SAMPLES], [0.0; BRICK_SAMPLES]);
        for (tree, values) in [(&exact, &mut a), (&cached, &mut b)] {
            let mut sampler = tree.sampler();
            sampler.enter(brick.region());
            sampler.fill(&brick, values);
        }
        assert!(a == b, "near the rim at {p}");
    }
}

#[test]
fn after_moving_one_of_a_thousand_blobs_caches_save_nine_tenths_of_the_work() {
    let trees: Vec<NodeRef> = forest().into_iter().map(NodeRef::from).collect();
    let before: NodeRef = union(trees.iter().cloned()).into();
    let mut store = CacheStore::new(EVERYWHERE);
    sweep(&store.tree(&before), 128.0);

    let mut balls: Vec<NodeRef> = trees[17].children().to_vec();
    balls[3] = NodeRef::from(Node::clone(&balls[3]).translate([1.0, 0.5, 0.0]));
    let mut moved = trees;
    moved[17] = sum(balls).named("tree 17").into();
    let after: NodeRef = union(moved).into();

    let uncached = Tree::new(&after);
    sweep(&uncached, 128.0);
    let filled_before = store.evaluations();
    let cached = store.tree(&after);
    sweep(&cached, 128.0);
    let work = cached.evaluations() + store.evaluations().saturating_sub(filled_before);
    let saved = uncached.evaluations() as f64 / work.max(1) as f64;
    println!(
        "primitive evaluations: {} without caches, {work} with: {saved:.1} times fewer",
        uncached.evaluations()
    );
    assert!(saved >= 10.0, "{saved:.1}");

    // Undo: the very same node, and not one evaluation more.
    let filled = store.evaluations();
    let undone = store.tree(&before);
    sweep(&undone, 128.0);
    assert!(store.evaluations() <= filled, "an undone state must find its caches warm");
}

/// A torus of triangles, smooth to the eye.
fn imported_ring() -> NodeRef {
    let (around, across) = (96, 32);
    let place = |i: usize, j: usize| {
        let turn = std::f32::consts::TAU;
        let ((sin_u, cos_u), (sin_v, cos_v)) =
            ((turn * i as f32 / around as f32).sin_cos(), (turn * j as f32 / across as f32).sin_cos());
        Vec3::new((20.0 + 7.0 * cos_v) * cos_u, (20.0 + 7.0 * cos_v) * sin_u, 7.0 * sin_v)
    };
    let number = |i: usize, j: usize| (i % around * across + j % across) as u32;
    let positions = (0..around * across).map(|at| place(at / across, at % across)).collect();
    let quads = (0..around * across).map(|at| (at / across, at % across));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let ring = mesh::Mesh { positions, triangles: triangles.collect() };
    Node::new(Shape::Primitive(Primitive::Mesh(ImportedMesh {
        file: "ring.stl".into(),
        sha256: "0".repeat(64),
        falloff: 4.0,
        distance: Arc::new(MeshDistance::new(&ring).expect("it has triangles")),
    })))
    .into()
}

#[test]
fn an_imported_mesh_is_searched_a_second_time_only_where_samples_cannot_serve() {
    let root = imported_ring();
    let exact = Tree::new(&root);
    let cached = CacheStore::new(CachePolicy::default()).tree(&root);
    let part = Aabb::around(Vec3::new(24.0, 0.0, 4.0), Vec3::splat(7.0));
    let mut rng = Rng::with_seed(1);
    let points: Vec<Vec3> = (0..4000).map(|_| point_in(&mut rng, &part)).collect();
    let (mut a, mut b) = (vec![0.0; points.len()], vec![0.0; points.len()]);
    exact.sampler().values(&points, &mut a);
    cached.sampler().values(&points, &mut b);
    for ((p, a), b) in points.iter().zip(&a).zip(&b) {
        assert!((a - b).abs() < 0.01, "at {p}: {b} instead of {a}");
    }
    let share = cached.evaluations() as f64 / exact.evaluations() as f64;
    println!("{:.1} % of the places are evaluated exactly", 100.0 * share);
    assert!(share < 0.3, "{share}");
}

#[test]
fn edits_are_not_felt_outside_the_changed_places() {
    let within = Aabb::around(Vec3::ZERO, Vec3::splat(120.0));
    let (mut boxes, mut touched) = (0, 0);
    for seed in 0..300 {
        let mut random = RandomTree::new(seed);
        random.depth = 4;
        let old = random.tree();
        let Some(path) = some_leaf(&old, seed) else { continue };
        let new = with_leaf(&old, &path, random.leaf());
        let changed = changed_region(&old, &new);
        let (a, b) = (Tree::new(&old), Tree::new(&new));
        let mut rng = Rng::with_seed(seed);
        for _ in 0..300 {
            let p = point_in(&mut rng, &within);
            assert!(changed.contains(p) || a.value(p) == b.value(p), "seed {seed} at {p}: {changed:?}");
        }
        let places = ChangedPlaces::between(&old, &new);
        assert_eq!(places.bounds(), changed);
        let mut touch = places.touch();
        let near = changed.intersection(&within);
        if near.is_empty() {
            continue;
        }
        for _ in 0..100 {
            let half = Vec3::splat(10.0 * rng.f32());
            let region = Aabb::around(point_in(&mut rng, &near), half);
            boxes += 1;
            if touch(&region) {
                touched += 1;
                continue;
            }
            for _ in 0..20 {
                let p = point_in(&mut rng, &region);
                let [a, b] = [&a, &b].map(|tree| tree.sample(p));
                assert_eq!((a.value, a.gradient), (b.value, b.gradient), "seed {seed} at {p} in {region:?}");
            }
        }
    }
    println!("{touched} of {boxes} boxes in the changed regions are touched");
    assert!(touched * 10 < boxes * 9, "{touched} of {boxes}: the places are no better than their box");
}

fn some_leaf(root: &NodeRef, seed: u64) -> Option<Vec<usize>> {
    let mut rng = Rng::with_seed(seed);
    let (mut node, mut path) = (root, Vec::new());
    while !node.children().is_empty() {
        path.push(rng.usize(..node.children().len()));
        node = &node.children()[*path.last()?];
    }
    (!path.is_empty()).then_some(path)
}

fn with_leaf(node: &NodeRef, path: &[usize], leaf: Node) -> NodeRef {
    let Some((first, rest)) = path.split_first() else {
        return leaf.into();
    };
    let child = with_leaf(&node.children()[*first], rest, leaf);
    let mut copy = Node::clone(node);
    match &mut copy.shape {
        Shape::Operator(_, children) => children[*first] = child,
        Shape::Warp(_, only) | Shape::SupportFree(_, only) => *only = child,
        Shape::Primitive(_) => unreachable!("paths lead through inner nodes"),
    }
    copy.into()
}
