//! What [`blobtree::Field`] promises, held against random trees and every type of node.

use blobtree::random::RandomTree;
use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, NodeRef, Primitive, Sample, Shape, Tree};
use fastrand::Rng;
use glam::Vec3;

fn random_trees(seeds: std::ops::Range<u64>, depth: usize) -> impl Iterator<Item = (u64, NodeRef)> {
    seeds.map(move |seed| {
        let mut random = RandomTree::new(seed);
        random.depth = depth;
        random.drawn = seed % 4 == 0 || seed >= 20_000;
        (seed, random.tree())
    })
}

fn point_in(rng: &mut Rng, region: &Aabb) -> Vec3 {
    let size = region.size();
    region.min + size * Vec3::new(rng.f32(), rng.f32(), rng.f32())
}

/// The part of a field's support in which random points are worth trying.
fn arena(tree: &Tree) -> Aabb {
    tree.support().intersection(&Aabb::around(Vec3::ZERO, Vec3::splat(200.0)))
}

#[test]
fn bricks_points_and_gradients_give_the_same_bits_at_every_level_of_regions() {
    for (seed, root) in random_trees(0..150, 6) {
        let tree = Tree::new(&root);
        let arena = arena(&tree);
        if arena.is_empty() {
            continue;
        }
        let mut rng = Rng::with_seed(seed);
        let spacing = arena.size().max_element() / 90.0;
        let center = (point_in(&mut rng, &arena) / spacing).as_ivec3();
        let brick = Brick { origin: center.to_array(), spacing };
        let (mut plain, mut narrow) = ([0.0; BRICK_SAMPLES], [0.0; BRICK_SAMPLES]);
        let mut sampler = tree.sampler();
        sampler.fill(&brick, &mut plain);
        let bound = sampler.enter(brick.region().grown(20.0 * spacing));
        sampler.enter(brick.region());
        sampler.fill(&brick, &mut narrow);
        assert!(plain == narrow, "seed {seed}: narrowing changed a value");
        let points: Vec<Vec3> = (0..BRICK_SAMPLES)
            .map(|i| brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK]))
            .collect();
        let mut values = vec![0.0; BRICK_SAMPLES];
        sampler.values(&points, &mut values);
        assert!(values == plain, "seed {seed}: points differ from bricks");
        let mut samples = vec![Sample::default(); BRICK_SAMPLES];
        sampler.samples(&points, &mut samples);
        for (i, (sample, value)) in samples.iter().zip(&plain).enumerate() {
            assert_eq!(sample.value, *value, "seed {seed}, sample {i}: gradients change the value");
            assert!(bound.lo <= *value && *value <= bound.hi, "seed {seed}: {value} not in {bound:?}");
            assert!(value.is_finite() && sample.gradient.is_finite(), "seed {seed}, sample {i}: not finite");
        }
    }
}

#[test]
fn bounds_hold_at_a_million_random_places() {
    let mut tried = 0;
    for (seed, root) in random_trees(1000..1560, 5) {
        let tree = Tree::new(&root);
        let arena = arena(&tree);
        if arena.is_empty() {
            continue;
        }
        let mut rng = Rng::with_seed(seed);
        let mut sampler = tree.sampler();
        for _ in 0..40 {
            let half = arena.size().max_element() * 0.5 * rng.f32().powi(3);
            let region = Aabb::around(point_in(&mut rng, &arena), Vec3::splat(half));
            let bound = sampler.enter(region);
            sampler.leave();
            let points: Vec<Vec3> = (0..64).map(|_| point_in(&mut rng, &region)).collect();
            let mut values = [0.0; 64];
            sampler.values(&points, &mut values);
            for (p, value) in points.iter().zip(values) {
                let within = bound.lo <= value && value <= bound.hi;
                assert!(within, "seed {seed}: {value} at {p} is not in {bound:?} of {region:?}");
                tried += 1;
            }
        }
    }
    assert!(tried > 1_000_000, "{tried} places");
}

#[test]
fn fields_are_zero_outside_their_support() {
    for (seed, root) in random_trees(2000..2300, 5).chain(random_trees(7000..9000, 1)) {
        let tree = Tree::new(&root);
        let support = tree.support();
        let mut rng = Rng::with_seed(seed);
        for _ in 0..200 {
            let p = point_in(&mut rng, &Aabb::around(Vec3::ZERO, Vec3::splat(300.0)));
            assert!(support.contains(p) || tree.value(p) == 0.0, "seed {seed}: {} at {p}", tree.value(p));
        }
    }
}

/// Central differences with the step that suits single precision, or `None` near a crease or kink, where
/// steps of two sizes disagree.
fn central_difference(tree: &Tree, p: Vec3, scale: f32) -> Option<Vec3> {
    let along = |h: f32| {
        let slope = |axis: Vec3| {
            // In double precision only the subtraction is left to chance.
            let (ahead, behind) = (p + axis * h, p - axis * h);
            let step = f64::from((ahead - behind).dot(axis));
            ((f64::from(tree.value(ahead)) - f64::from(tree.value(behind))) / step) as f32
        };
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z))
    };
    let (fine, coarse) = (along(3e-3 * scale), along(6e-3 * scale));
    let size = fine.length().max(1e-3 / scale);
    // Richardson: what is left of the error after extrapolation is well below their difference.
    let better = fine + (fine - coarse) / 3.0;
    ((fine - coarse).length() <= 1.5e-3 * size).then_some(better)
}

#[test]
fn gradients_are_exact_for_every_type_of_node() {
    let mut tried = std::collections::BTreeMap::<&str, usize>::new();
    for (seed, root) in random_trees(10_000..11_500, 1)
        .chain(random_trees(3000..5400, 2))
        .chain(random_trees(6000..6300, 4))
        .chain(random_trees(20_000..22_000, 1))
    {
        let tree = Tree::new(&root);
        let arena = arena(&tree);
        if arena.is_empty() {
            continue;
        }
        let mut rng = Rng::with_seed(seed);
        let scale = arena.size().min_element().min(60.0);
        for _ in 0..40 {
            let p = point_in(&mut rng, &arena);
            let sample = tree.sample(p);
            // Where the field is nearly flat, or steep far from the origin, single precision leaves nothing
            // to compare: rounding of places by 1e-6 of their size against steps of 3e-3 of the scale.
            let scale = scale.min(1.0 / sample.gradient.length());
            let lost = 5e-7 * p.length() / (3e-3 * scale);
            if sample.value < 0.02 || sample.gradient.length() * scale < 0.05 || lost > 5e-4 {
                continue;
            }
            let Some(expected) = central_difference(&tree, p, scale) else { continue };
            let error = (sample.gradient - expected).length() / expected.length();
            assert!(
                error < 1e-3,
                "seed {seed}, {}: {} instead of {expected} at {p}",
                root.type_name(),
                sample.gradient
            );
            *tried.entry(root.type_name()).or_default() += 1;
        }
    }
    for name in blobtree::TYPE_NAMES {
        assert!(
            tried.get(name).copied().unwrap_or(0) > 50 || ["mesh", "support_free"].contains(&name),
            "{name}: {tried:?}"
        );
    }
}

#[test]
fn a_torus_has_its_hole_on_the_axis_too() {
    for falloff in [None, Some(2.0)] {
        let mut ring = blobtree::build::torus([1.0, 2.0, 3.0], [0.0, 0.0, 1.0], 9.0, 3.0);
        if let Shape::Primitive(Primitive::Torus(torus)) = &mut ring.shape {
            torus.falloff = falloff;
        }
        let tree = Tree::new(&ring);
        for z in [-50.0, 0.0, 3.0, 4.0] {
            let (on, beside) = (Vec3::new(1.0, 2.0, z), Vec3::new(1.001, 2.0, z));
            assert_eq!((tree.value(on), tree.value(beside)), (0.0, 0.0), "falloff {falloff:?}, z = {z}");
        }
    }
    // Where the tube reaches the axis, the axis is as deep as what is around it.
    let tree = Tree::new(&blobtree::build::torus([0.0; 3], [0.0, 0.0, 1.0], 2.0, 3.0));
    let (on, beside) = (tree.sample(Vec3::ZERO), tree.sample(Vec3::new(1e-4, 0.0, 0.0)));
    assert!((on.value - beside.value).abs() < 1e-3, "{on:?}, {beside:?}");
    assert!((on.gradient.length() - beside.gradient.length()).abs() < 1e-3, "{on:?}, {beside:?}");
}
