//! Why a node is solid or empty somewhere, in scenes whose answers are known.

use crate::common::{baked, ball_on_stem, growing, letter_t, trimming};
use blobtree::build::{Build, cuboid, cylinder, point, segment};
use blobtree::{BakeStore, BrushKind, BrushStroke, Field, ISO, NodeRef, SupportFree, SupportMode, Tree};
use glam::Vec3;
use polygonizer::CellSize;
use printable::{Cause, Change, Rebaker};
use std::sync::Arc;

fn why(known: &(NodeRef, BakeStore), place: [f32; 3]) -> Vec<Change> {
    let (root, store) = known;
    let mut answers = Rebaker::new().why(root, store, &[place.into()]).expect("there is an answer");
    answers.remove(0)
}

/// The one thing that changed at a place.
fn only(known: &(NodeRef, BakeStore), place: [f32; 3]) -> Change {
    let changes = why(known, place);
    let [change] = &changes[..] else { panic!("{} changes at {place:?}", changes.len()) };
    let solid = known.1.compile(&known.0).value(place.into()) >= ISO;
    assert_eq!(change.added, solid, "{place:?}");
    change.clone()
}

#[test]
fn a_ball_on_a_stem_loses_what_leans_out_too_far() {
    // The ball's middle is at 17 mm, and it hangs over the stem of 2 mm.
    let known = baked(ball_on_stem(2.0, 8.0), trimming(45.0, 0.25));
    for (x, z) in [(5.0, 11.5), (4.0, 10.4)] {
        let Cause::Overhang { lean_degrees, most_degrees, underside } = only(&known, [x, 0., z]).cause else {
            panic!("{:?}", only(&known, [x, 0., z]));
        };
        // Straight below is the ball, which leans out by the angle of its radius there.
        let expected = (64.0_f32 - x * x).sqrt().atan2(x).to_degrees();
        assert!((lean_degrees - expected).abs() < 1.0, "{lean_degrees}°, not {expected}°");
        assert_eq!(most_degrees, 45.0);
        let bottom = Vec3::new(x, 0.0, 17.0 - (64.0 - x * x).sqrt());
        assert!(underside.distance(bottom) < 0.05, "{underside}, not {bottom}");
    }
    // Where the ball leans out by less, but over what was taken away.
    assert_eq!(only(&known, [7.4, 0., 14.5]).cause, Cause::Toppled);
    // In the stem, in what is left of the ball, and beside it.
    for place in [[0., 0., 5.], [0., 0., 17.], [0., 0., 24.], [7., 0., 3.]] {
        assert_eq!(why(&known, place), [], "{place:?}");
    }
}

#[test]
fn the_arms_of_a_t_lean_out_flat_and_are_held_if_matter_grows() {
    let trimmed = baked(letter_t(), trimming(45.0, 0.25));
    let Cause::Overhang { lean_degrees, underside, .. } = only(&trimmed, [10., 0., 18.]).cause else {
        panic!("{:?}", only(&trimmed, [10., 0., 18.]));
    };
    assert!(lean_degrees > 85.0, "{lean_degrees}");
    assert!((underside.z - 16.0).abs() < 0.05, "{underside}");
    let grown = baked(letter_t(), growing(45.0, 0.25));
    let tree = grown.1.compile(&grown.0);
    let mut places = (0..60).map(|n| [3.0, 0.0, 16.0 - 0.25 * n as f32]);
    let place = places.find(|p| tree.value(Vec3::from(*p)) >= ISO && p[2] < 15.5);
    let place = place.expect("something grows below the arm");
    let change = only(&grown, place);
    let Cause::Grown { holds: Some(holds) } = change.cause else { panic!("{change:?}") };
    assert!(change.added && (16.0..16.3).contains(&holds.z) && holds.x.abs() > 2.0, "{holds}");
}

#[test]
fn what_floats_is_an_island_and_what_is_below_the_bed_is_cut_wherever_that_is() {
    for bed in [0.0, -3.0, 5.0] {
        let up = Vec3::Z * bed;
        let shape = cylinder([0., 0., -2.], [0., 0., 6.], 3.0).union(point([0., 0., 14.], 3.0));
        let known = baked(shape.translate(up), SupportFree { bed, ..trimming(45.0, 0.25) });
        let at = |z: f32| [0., 0., z + bed];
        assert_eq!(only(&known, at(14.0)).cause, Cause::Island, "bed at {bed}");
        assert_eq!(only(&known, at(-1.0)).cause, Cause::BelowBed, "bed at {bed}");
        assert_eq!(why(&known, at(3.0)), []);
    }
}

#[test]
fn a_stroke_is_named_and_so_is_what_follows_from_it() {
    let strokes = [
        // Far from all that is asked.
        BrushStroke::new(BrushKind::AddTrim, 2.0, [[-6., 0., 20.]]),
        BrushStroke::new(BrushKind::AddTrim, 2.0, [[6., 0., 20.]]),
        // On the pillar beside the block, whose top then falls.
        BrushStroke::new(BrushKind::RemoveTrim, 3.0, [[20., 0., 8.]]),
        BrushStroke::new(BrushKind::AddGrow, 1.5, [[0., 14., 12.]]),
        BrushStroke::new(BrushKind::SmoothTrim, 1.0, [[-9., -5., 20.]]),
    ];
    let strokes = strokes.map(Arc::new).to_vec();
    let shape = cuboid([0., 0., 10.], [20., 12., 20.]).union(cylinder([20., 0., 0.], [20., 0., 18.], 2.0));
    let known = baked(shape, SupportFree { strokes, ..trimming(45.0, 0.25) });
    let stroke = |number, brush, under_tip, added| Cause::Stroke { number, brush, under_tip, added };
    let expected = [
        ([6., 0., 21.], stroke(1, BrushKind::AddTrim, true, true)),
        ([20., 0., 8.], stroke(2, BrushKind::RemoveTrim, true, false)),
        ([20., 0., 16.], stroke(2, BrushKind::RemoveTrim, false, false)),
        ([0., 14., 12.], stroke(3, BrushKind::AddGrow, true, true)),
    ];
    for (place, cause) in expected {
        assert_eq!(only(&known, place).cause, cause, "{place:?}");
    }
    assert_eq!(why(&known, [0., 0., 10.]), []);
    let words = only(&known, [20., 0., 16.]).cause.to_string();
    assert_eq!(words, "stroke 3 (remove_trim) took away what carried it");
}

#[test]
fn nodes_within_the_tree_are_asked_in_their_own_space() {
    let below: NodeRef = ball_on_stem(2.0, 8.0).support_free(trimming(45.0, 0.25)).into();
    let root: NodeRef = below.translate([100., 0., 0.]).union(cuboid([100., 20., 2.], [4., 4., 4.])).into();
    let mut store = BakeStore::new();
    store.bake(&root, &Rebaker::new()).expect("it can be baked");
    let change = only(&(root, store), [105., 0., 11.5]);
    assert_eq!(change.node.to_string(), "/0/0");
    let Cause::Overhang { underside, .. } = change.cause else { panic!("{change:?}") };
    assert!((underside.x - 105.0).abs() < 1e-3, "{underside}");
}

#[test]
fn a_node_that_is_switched_off_or_not_baked_changes_nothing() {
    let off = SupportFree { mode: SupportMode::Off, ..trimming(45.0, 0.25) };
    assert_eq!(why(&baked(letter_t(), off), [10., 0., 18.]), []);
    let root: NodeRef = letter_t().support_free(trimming(45.0, 0.25)).into();
    assert_eq!(why(&(root, BakeStore::new()), [10., 0., 18.]), []);
}

#[test]
fn what_settling_took_says_so() {
    // Thin arms, whose tips the lattice does not see.
    let block = cuboid([0., 0., 6.], [14., 10., 12.]);
    let arms = segment([0., 0., 9.], [14., 1., 8.], 0.6).union(segment([0., 2., 10.], [-13., 4., 5.], 0.4));
    let (root, unsettled) = baked(block.union(arms), trimming(45.0, 0.25));
    let mut store = BakeStore::new();
    let cell = CellSize::from_mm(0.25).expect("legal");
    store.bake(&root, &Rebaker::new().settling(cell)).expect("it can be baked");
    let (before, after) = (unsettled.compile(&root), store.compile(&root));
    let places = (0..1_000_000).map(|n| {
        let [x, y, z] = [n % 250, n / 250 % 80, n / 20_000].map(|n| n as f32);
        [x * 0.1 - 12.0, y * 0.1 - 2.0, z * 0.125 + 4.0]
    });
    let solid = |tree: &Tree, place: &[f32; 3]| tree.value(Vec3::from(*place)) >= ISO;
    let settled = places.filter(|place| solid(&before, place) && !solid(&after, place));
    let settled: Vec<[f32; 3]> = settled.take(5).collect();
    assert!(!settled.is_empty(), "nothing was settled");
    let known = (root, store);
    settled.iter().for_each(|place| assert_eq!(only(&known, *place).cause, Cause::Settled, "{place:?}"));
}

#[test]
fn there_is_a_cause_exactly_where_the_node_differs_from_its_child() {
    let strokes = [
        BrushStroke::new(BrushKind::RemoveTrim, 2.0, [[2., 0., 3.]]),
        BrushStroke::new(BrushKind::AddGrow, 1.5, [[9., 3., 12.]]),
    ];
    for (rule, brushed) in [trimming(45.0, 0.25), growing(45.0, 0.25)].into_iter().zip([true, false]) {
        let strokes = if brushed { strokes.clone().map(Arc::new).to_vec() } else { Vec::new() };
        let (root, store) = baked(letter_t(), SupportFree { strokes, ..rule });
        let (child, made) = (store.compile(&root.children()[0]), store.compile(&root));
        let mut rng = fastrand::Rng::with_seed(11);
        let mut place = || Vec3::new(rng.f32() * 28. - 14., rng.f32() * 10. - 4., rng.f32() * 22. - 1.);
        let places: Vec<Vec3> = (0..400).map(|_| place()).collect();
        let answers = Rebaker::new().why(&root, &store, &places).expect("there are answers");
        assert_eq!(answers.len(), places.len());
        let mut changed = 0;
        for (p, changes) in places.iter().zip(&answers) {
            let [before, after] = [&child, &made].map(|tree| tree.value(*p) >= ISO);
            let added: Vec<bool> = changes.iter().map(|change| change.added).collect();
            let expected = if before == after { vec![] } else { vec![after] };
            assert_eq!(added, expected, "seed 11, {p}: {changes:?}");
            changed += changes.len();
        }
        assert!(changed > 10, "only {changed} of 400 places changed");
    }
}
