//! What every field promises, held against support-free nodes in trees.

use crate::common::{ball_on_stem, growing, trimming};
use blobtree::build::{Build, point};
use blobtree::random::RandomTree;
use blobtree::{
    Aabb, BRICK, BRICK_SAMPLES, BakeStore, Brick, Field, NodeRef, Sample, SupportFree, SupportMode, Tree,
};
use fastrand::Rng;
use glam::Vec3;
use printable::Rebaker;

/// Random trees that are constrained, moved, blended and constrained again.
fn trees() -> impl Iterator<Item = (u64, Tree)> {
    (0..24).map(|seed| {
        let mut random = RandomTree::new(seed);
        random.depth = 3;
        let rule = SupportFree { layer_height: 1.5, bed: -20.0, ..random.rule() };
        let mut node = match seed % 4 {
            0 => ball_on_stem(3.0, 9.0).support_free(trimming(45.0, 0.5)),
            1 => ball_on_stem(3.0, 9.0).support_free(growing(50.0, 0.5)),
            _ => random.tree().support_free(rule.clone()),
        };
        if seed % 3 > 0 {
            node = node
                .rotate_degrees([20.0, -10.0, 30.0])
                .translate([3.0, 1.0, 2.0])
                .blend(point([8., 0., 6.], 7.));
        }
        if seed % 6 == 2 {
            node = node.support_free(SupportFree { mode: SupportMode::Trim, ..rule });
        }
        let root: NodeRef = node.into();
        let mut store = BakeStore::new();
        (seed, store.tree(&root, &Rebaker::new()).expect("it can be baked"))
    })
}

fn point_in(rng: &mut Rng, region: &Aabb) -> Vec3 {
    region.min + region.size() * Vec3::new(rng.f32(), rng.f32(), rng.f32())
}

fn arena(tree: &Tree) -> Aabb {
    tree.support().intersection(&Aabb::around(Vec3::ZERO, Vec3::splat(60.0)))
}

#[test]
fn bricks_points_gradients_and_regions_give_the_same_bits_within_bounds() {
    for (seed, tree) in trees().filter(|(_, tree)| !arena(tree).is_empty()) {
        let mut rng = Rng::with_seed(seed);
        let arena = arena(&tree);
        for _ in 0..12 {
            let spacing = arena.size().max_element() / 90.0;
            let origin = (point_in(&mut rng, &arena) / spacing).as_ivec3().to_array();
            let brick = Brick { origin, spacing };
            let (mut plain, mut narrow) = ([0.0; BRICK_SAMPLES], [0.0; BRICK_SAMPLES]);
            let mut sampler = tree.sampler();
            sampler.fill(&brick, &mut plain);
            sampler.enter(brick.region().grown(20.0 * spacing));
            let bound = sampler.enter(brick.region());
            sampler.fill(&brick, &mut narrow);
            assert!(plain == narrow, "seed {seed}: narrowing changed a value");
            let at = |i: usize| brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK]);
            let points: Vec<Vec3> = (0..BRICK_SAMPLES).map(at).collect();
            let mut samples = vec![Sample::default(); BRICK_SAMPLES];
            sampler.samples(&points, &mut samples);
            for (sample, value) in samples.iter().zip(&plain) {
                assert_eq!(sample.value, *value, "seed {seed}: gradients change the value");
                assert!(bound.lo <= *value && *value <= bound.hi, "seed {seed}: {value} not in {bound:?}");
                assert!(value.is_finite() && sample.gradient.is_finite(), "seed {seed}: not finite");
            }
        }
    }
}

#[test]
fn bounds_hold_over_boxes_of_all_sizes_and_fields_are_zero_outside_their_support() {
    for (seed, tree) in trees().filter(|(_, tree)| !arena(tree).is_empty()) {
        let mut rng = Rng::with_seed(seed);
        let arena = arena(&tree);
        let mut sampler = tree.sampler();
        for _ in 0..200 {
            let half = 0.5 * arena.size().max_element() * rng.f32().powi(3);
            let region = Aabb::around(point_in(&mut rng, &arena), Vec3::splat(half));
            let bound = sampler.enter(region);
            sampler.leave();
            let points: Vec<Vec3> = (0..64).map(|_| point_in(&mut rng, &region)).collect();
            let mut values = [0.0; 64];
            sampler.values(&points, &mut values);
            for (p, value) in points.iter().zip(values) {
                assert!(
                    bound.lo <= value && value <= bound.hi,
                    "seed {seed}: {value} at {p}: {bound:?} of {region:?}"
                );
            }
            let p = point_in(&mut rng, &Aabb::around(Vec3::ZERO, Vec3::splat(300.0)));
            assert!(
                tree.support().contains(p) || tree.value(p) == 0.0,
                "seed {seed}: {} at {p}",
                tree.value(p)
            );
        }
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    let mut tried = 0;
    for (seed, tree) in trees().filter(|(_, tree)| !arena(tree).is_empty()) {
        let mut rng = Rng::with_seed(seed);
        let arena = arena(&tree);
        for _ in 0..400 {
            let p = point_in(&mut rng, &arena);
            let sample = tree.sample(p);
            let slope = |h: f32| {
                Vec3::from_array([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
                    let (ahead, behind) = (p + axis * h, p - axis * h);
                    (tree.value(ahead) - tree.value(behind)) / (ahead - behind).dot(axis)
                }))
            };
            let (fine, coarse) = (slope(4e-3), slope(8e-3));
            if sample.gradient.length() < 5e-3 || (fine - coarse).length() > 2e-3 * fine.length() {
                continue;
            }
            let off = (sample.gradient - fine).length() / fine.length();
            assert!(off < 1e-2, "seed {seed}: {} instead of {fine} at {p}", sample.gradient);
            tried += 1;
        }
    }
    assert!(tried > 300, "{tried} places");
}
