//! What preserving keeps: all that stands above, on no more than that needs.

use crate::common::trimming;
use crate::settle::settled;
use blobtree::build::{Build, cuboid, cylinder, point};
use blobtree::{BakeStore, BrushKind, BrushStroke, BrushTip, Field, Node, NodeRef, SupportFree, Tree};
use glam::Vec3;
use printable::Rebaker;
use std::sync::Arc;

/// Places along each side of a lattice around all shapes here, and their distance, mm.
const SIDES: [usize; 3] = [96, 96, 128];
const STEP: f32 = 0.25;

/// Which places of the lattice are solid, x fastest.
struct Places(Vec<bool>);

impl Places {
    fn of(tree: &Tree) -> Self {
        let mut solid = Vec::new();
        let mut values = vec![0.0; SIDES[0]];
        let mut sampler = tree.sampler();
        for n in (0..SIDES.iter().product()).step_by(SIDES[0]) {
            let row: Vec<Vec3> = (n..n + SIDES[0]).map(place).collect();
            sampler.values(&row, &mut values);
            solid.extend(values.iter().map(|value| *value >= 0.5));
        }
        Self(solid)
    }

    fn count(&self, within: impl Fn(Vec3) -> bool) -> usize {
        (0..self.0.len()).filter(|n| self.0[*n] && within(place(*n))).count()
    }

    /// Those that a plus of five places fits around, or a place beside them: what is thinner is gone.
    fn opened(&self) -> Self {
        let around = |n: usize| [n, n - 1, n + 1, n - SIDES[0], n + SIDES[0]];
        let inner = SIDES[0]..self.0.len() - SIDES[0];
        let deep: Vec<bool> =
            (0..self.0.len()).map(|n| inner.contains(&n) && around(n).iter().all(|n| self.0[*n])).collect();
        Self((0..deep.len()).map(|n| inner.contains(&n) && around(n).iter().any(|n| deep[*n])).collect())
    }
}

fn place(n: usize) -> Vec3 {
    let [width, depth, _] = SIDES;
    let at = Vec3::new((n % width) as f32, (n / width % depth) as f32, (n / width / depth) as f32);
    (at - Vec3::new(0.5 * width as f32, 0.5 * depth as f32, -0.5)) * STEP
}

fn shapes() -> [(&'static str, Node); 6] {
    let pillar = |radius| cylinder([0., 0., 0.], [0., 0., 20.], radius);
    [
        ("pillar with a plate", pillar(2.5).union(cuboid([0., 0., 22.], [12., 12., 4.]))),
        ("square pillar", cuboid([0., 0., 12.], [4., 4., 24.]).union(cuboid([0., 0., 25.], [10., 10., 6.]))),
        ("ball on a stem", pillar(2.0).union(point([0., 0., 23.], 5.0))),
        ("wall", cuboid([0., 0., 12.], [14., 1.5, 24.])),
        ("arch", cuboid([0., 0., 12.], [18., 6., 24.]).subtract(cylinder([0., -5., 6.], [0., 5., 6.], 5.0))),
        (
            "bent",
            cylinder([-2., 0.4, 0.], [1., 0., 12.], 2.2).union(cylinder([1., 0., 12.], [-1., 0., 26.], 2.)),
        ),
    ]
}

fn stroke(radius: f32, places: impl IntoIterator<Item = [f32; 3]>) -> BrushStroke {
    BrushStroke::new(BrushKind::RemovePreserve, radius, places)
}

fn strokes() -> [(&'static str, Vec<BrushStroke>); 7] {
    let down = || (0..10).map(|i| [0., 0., 15. - i as f32 * 1.2]);
    let across = |y: f32| (0..9).map(move |i| [i as f32 * 2. - 8., y, 12.]);
    let along = || (0..9).map(|i| [0., i as f32 * 2. - 8., 12.]);
    [
        ("a dab", vec![stroke(4., [[0., 0., 11.]])]),
        ("a dab beside", vec![stroke(3., [[2.3, 0.4, 11.3]])]),
        ("a cube", vec![BrushStroke { tip: BrushTip::Cube, ..stroke(4., [[0.3, 0.6, 11.]]) }]),
        ("ten down", vec![stroke(3., down())]),
        ("ten up, weak", vec![BrushStroke { strength: 0.3, ..stroke(3., down().rev()) }]),
        ("across", vec![stroke(2.5, across(0.7))]),
        ("two that cross", vec![stroke(2.5, across(0.)), stroke(2.5, along())]),
    ]
}

fn rule(strokes: &[BrushStroke]) -> SupportFree {
    SupportFree { strokes: strokes.iter().cloned().map(Arc::new).collect(), ..trimming(45.0, 0.25) }
}

fn places(shape: &Node, strokes: &[BrushStroke]) -> Places {
    let root: NodeRef = shape.clone().support_free(rule(strokes)).into();
    Places::of(&BakeStore::new().tree(&root, &Rebaker::new()).expect("it can be baked"))
}

#[test]
fn what_stands_above_stays_on_no_threads() {
    for (shape_name, shape) in shapes() {
        let before = places(&shape, &[]);
        for (name, strokes) in strokes() {
            let label = format!("{shape_name}, {name}");
            let after = places(&shape, &strokes);
            let tops = strokes.iter().flat_map(|stroke| stroke.places.iter().map(|at| at.z + stroke.radius));
            let top = tops.fold(0.0, f32::max) + STEP;
            let [had, has] = [&before, &after].map(|places| places.count(|at| at.z > top));
            let lost = (had - has.min(had)) as f32 / had as f32;
            assert!(lost < 0.005, "{label}: {lost} of what stands above is lost");
            let in_tip = |at: Vec3| {
                let near = |stroke: &BrushStroke| {
                    stroke.places.iter().any(|tip| (at - *tip).abs().max_element() < stroke.radius)
                };
                strokes.iter().any(near)
            };
            let [had, kept] = [&before, &after].map(|places| places.count(in_tip));
            let thin = kept - after.opened().count(in_tip).min(kept);
            println!("{label}: {kept} of {had} places in the tips are left, {thin} of them thin");
            assert!((thin as f32) < 0.22 * kept as f32, "{label}: {thin} of {kept} places are thin");
        }
    }
}

#[test]
fn strokes_down_along_and_across_pillars_take_most_of_them() {
    for (name, shape) in shapes().into_iter().take(3) {
        let [before, after] = [vec![], strokes()[3].1.clone()].map(|strokes| places(&shape, &strokes));
        let [had, has] = [before, after].map(|places| places.count(|at| (5.0..12.0).contains(&at.z)));
        assert!(has < had / 2, "{name}: {has} of {had} places are left");
    }
}

#[test]
fn what_is_left_is_support_free_in_the_eyes_of_the_print_check() {
    let strokes = strokes();
    for (shape_name, shape) in &shapes()[..3] {
        for (name, strokes) in [&strokes[0], &strokes[3], &strokes[6]] {
            let (check, _) = settled(shape.clone(), rule(strokes));
            assert!(check.is_support_free(), "{shape_name}, {name}: {:?}", check.findings.first());
            let layers = check.layers.len();
            assert!(layers >= 96, "{shape_name}, {name}: only {layers} layers stand");
        }
    }
}

#[test]
fn random_strokes_fell_nothing() {
    for seed in 0..40 {
        let mut rng = fastrand::Rng::with_seed(seed);
        let mut between = |low: f32, high: f32| low + (high - low) * rng.f32();
        let [_, (_, square), (_, ball), .., (_, bent)] = shapes();
        let shape = [square, ball, bent][seed as usize % 3].clone();
        let strokes: Vec<BrushStroke> = (0..1 + seed % 3)
            .map(|_| {
                let mut end = || Vec3::new(between(-4., 4.), between(-4., 4.), between(3., 15.));
                let (from, to) = (end(), end());
                let count = between(1., 12.) as usize;
                let places = (0..count).map(|i| from.lerp(to, i as f32 / count as f32).to_array());
                stroke(between(1., 5.), places.collect::<Vec<_>>())
            })
            .collect();
        let [before, after] = [places(&shape, &[]), places(&shape, &strokes)];
        let [had, has] = [before, after].map(|places| places.count(|at| at.z > 21.0));
        assert!(has as f32 > 0.98 * had as f32, "seed {seed}: {has} of {had} places above are left");
    }
}

#[test]
fn the_same_strokes_again_take_little_more() {
    for (shape_name, shape) in &shapes()[..3] {
        for (name, strokes) in [&strokes()[0], &strokes()[3], &strokes()[6]] {
            let twice: Vec<BrushStroke> = strokes.iter().chain(strokes).cloned().collect();
            let counts = [&[][..], strokes, &twice].map(|strokes| places(shape, strokes).count(|_| true));
            let [taken, more] = [counts[0] - counts[1], counts[1].saturating_sub(counts[2])];
            println!("{shape_name}, {name}: {taken}, and {more} more");
            assert!((more as f32) < 0.3 * taken as f32, "{shape_name}, {name}: {taken}, and {more} more");
        }
    }
}
