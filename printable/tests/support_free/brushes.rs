//! Brush strokes in a node, against the same brushes on voxels.

use crate::common::trimming;
use blobtree::build::{Build, cuboid, cylinder, point, union};
use blobtree::{
    Bake, BakeError, BakeStore, Baker, BrushKind, BrushStroke, BrushTip, Field, NodeRef, SupportFree, Tree,
};
use glam::{Vec3, Vec3Swizzles};
use polygonizer::Cancel;
use printable::{
    Action, Brush, Element, GridShape, LayerHeight, PathCost, PathMap, Rebaker, SupportRule, Tip, VoxelGrid,
    VoxelSize, dabs_of, trim, unsupported,
};
use std::sync::Arc;

const KINDS: [BrushKind; 5] = [
    BrushKind::AddTrim,
    BrushKind::RemoveTrim,
    BrushKind::RemovePreserve,
    BrushKind::AddGrow,
    BrushKind::SmoothTrim,
];

/// A block with a step, with room around it.
fn block() -> NodeRef {
    cuboid([0., 0., 8.], [16., 12., 16.]).union(cuboid([6., 0., 3.], [16., 8., 6.])).into()
}

fn compiled(root: &NodeRef) -> Tree {
    let mut store = BakeStore::new();
    store.tree(root, &Rebaker::new()).expect("it can be baked")
}

/// A node with these strokes over it, and the same without.
fn brushed(child: &NodeRef, strokes: Vec<BrushStroke>) -> [Tree; 2] {
    let rule = |strokes: Vec<BrushStroke>| SupportFree {
        strokes: strokes.into_iter().map(Arc::new).collect(),
        ..trimming(45.0, 0.25)
    };
    [rule(strokes), rule(Vec::new())].map(|rule| compiled(&child.clone().support_free(rule).into()))
}

/// The voxels of a field, in a grid that holds all the scenes here.
fn voxels(field: &dyn Field) -> VoxelGrid {
    let height = LayerHeight::from_mm(0.25).expect("legal");
    let shape = GridShape::new([136, 96, 112], VoxelSize::cubic(height), [-17., -12.]).expect("legal");
    let mut grid = VoxelGrid::new(shape);
    let mut sampler = field.sampler();
    let [nx, ny, nz] = shape.voxels();
    let mut values = vec![0.0; nx];
    for z in 0..nz {
        for y in 0..ny {
            let places: Vec<Vec3> = (0..nx).map(|x| shape.center([x, y, z])).collect();
            sampler.values(&places, &mut values);
            values.iter().enumerate().for_each(|(x, value)| grid.set_solid([x, y, z], *value >= 0.5));
        }
    }
    grid
}

/// The same strokes done to the voxels of the node without them.
fn on_voxels(before: &Tree, strokes: &[BrushStroke]) -> VoxelGrid {
    let element = Element::for_rule(SupportRule::default()).expect("legal");
    let mut grid = voxels(before);
    trim(&mut grid, &element);
    for stroke in strokes {
        let paths = PathMap::new(&grid, &element, PathCost::Climbed);
        let action = match stroke.brush {
            BrushKind::AddTrim => Action::AddTrim,
            BrushKind::RemoveTrim => Action::RemoveTrim,
            BrushKind::RemovePreserve => Action::RemovePreserve,
            BrushKind::AddGrow => Action::AddGrow(&paths),
            BrushKind::SmoothTrim => Action::SmoothTrim,
        };
        let tip = match &stroke.tip {
            BrushTip::Ball => Tip::Ball,
            BrushTip::Cube => Tip::Cube,
            BrushTip::Cylinder => Tip::Cylinder,
            BrushTip::Shape(node) => Tip::Solid(Arc::new(Tree::new(node))),
        };
        let brush = Brush { action, tip, material: 0, grown_material: 0 };
        for dab in dabs_of(stroke).expect("legal") {
            brush.dab(&mut grid, &element, &dab);
        }
    }
    grid
}

/// How many voxels have nothing below them, nor beside that: what even a coarse look finds hanging.
fn hanging(grid: &VoxelGrid) -> usize {
    unsupported(grid, &Element::square()).len()
}

/// How many voxels differ, and how many of them lie farther than `far` voxels from any change of solid to air in
/// `expected`.
fn differences(found: &VoxelGrid, expected: &VoxelGrid, far: usize) -> [usize; 2] {
    let [nx, ny, nz] = found.shape().voxels();
    let near = |at: usize, most: usize| at.saturating_sub(far)..(at + far + 1).min(most);
    let mut count = [0, 0];
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let own = expected.is_solid([x, y, z]);
                if found.is_solid([x, y, z]) == own {
                    continue;
                }
                count[0] += 1;
                let at_surface = near(z, nz)
                    .any(|z| near(y, ny).any(|y| near(x, nx).any(|x| expected.is_solid([x, y, z]) != own)));
                count[1] += usize::from(!at_surface);
            }
        }
    }
    count
}

fn tips() -> [BrushTip; 4] {
    let two: NodeRef = union([point([-0.3, 0., 0.], 0.7), point([0.4, 0., 0.2], 0.6)]).into();
    [BrushTip::Ball, BrushTip::Cube, BrushTip::Cylinder, BrushTip::Shape(two)]
}

#[test]
fn strokes_make_the_solid_that_they_make_of_voxels() {
    for brush in KINDS {
        for tip in tips() {
            // Smoothing is felt at edges only.
            let places = match brush {
                BrushKind::SmoothTrim => vec![[8., 6., 16.], [8., 5., 16.], [8., 4., 16.]],
                _ => vec![[8., 1., 11.], [8.5, 2., 12.], [7.5, -1., 9.5]],
            };
            let stroke = BrushStroke { tip: tip.clone(), ..BrushStroke::new(brush, 2.5, places) };
            let [after, before] = brushed(&block(), vec![stroke.clone()]);
            let (found, expected) = (voxels(&after), on_voxels(&before, &[stroke]));
            let changed = differences(&found, &voxels(&before), 0)[0];
            // What preserving keeps leans by less, and between two balls it fills what is narrower than two places.
            let is_narrow = brush == BrushKind::RemovePreserve && tip_name(&tip) == "two balls";
            let share = if is_narrow { 0.2 } else { 0.15 };
            let [differ, away] = differences(&found, &expected, 2);
            let label = format!("{brush:?}, {}", tip_name(&tip));
            println!("{label}: {changed} voxels changed, {differ} differ");
            assert!(changed > 20, "{label}: nothing happened");
            assert_eq!(away, 0, "{label}: voxels that differ far from the surface");
            let smoothed = brush == BrushKind::SmoothTrim;
            assert!(smoothed || differ as f32 <= share * changed as f32, "{label}: {differ} of {changed}");
            assert_eq!(hanging(&found), 0, "{label}");
        }
    }
}

fn tip_name(tip: &BrushTip) -> &'static str {
    match tip {
        BrushTip::Ball => "ball",
        BrushTip::Cube => "cube",
        BrushTip::Cylinder => "cylinder",
        BrushTip::Shape(_) => "two balls",
    }
}

#[test]
fn weak_strokes_move_the_surface_by_their_strength() {
    for (brush, depth) in [(BrushKind::RemovePreserve, 1.0), (BrushKind::RemoveTrim, 1.5)] {
        let places = [[0., 0., 16.]];
        let stroke = BrushStroke { strength: depth / 5.0, ..BrushStroke::new(brush, 5.0, places) };
        let [after, _] = brushed(&block(), vec![stroke]);
        let top =
            (0..400).map(|i| i as f32 * 0.01 + 12.5).rfind(|z| after.value(Vec3::new(0., 0., *z)) >= 0.5);
        let top = top.expect("some of the block is left");
        assert!((16.0 - depth - top).abs() < 0.15, "{brush:?}: the top is at {top}, {depth} mm lower");
    }
}

/// Checks that two fields are the same, to the last bit, at many places where `outside` says so.
fn same_outside(after: &Tree, before: &Tree, outside: impl Fn(Vec3) -> bool, label: &str) {
    let mut rng = fastrand::Rng::with_seed(5);
    let mut tried = 0;
    for _ in 0..60_000 {
        let p = Vec3::new(rng.f32() * 34. - 17., rng.f32() * 24. - 12., rng.f32() * 28. - 1.);
        if outside(p) {
            assert_eq!(after.value(p), before.value(p), "{label}: another value at {p}");
            tried += 1;
        }
    }
    assert!(tried > 10_000, "{label}: only {tried} places");
}

#[test]
fn nothing_changes_beyond_a_dabs_reach() {
    let center = Vec3::new(8.0, 0.0, 10.0);
    for brush in KINDS {
        let stroke = BrushStroke::new(brush, 2.5, [center.to_array()]);
        let [after, before] = brushed(&block(), vec![stroke]);
        // The tip, the way in which its field ends, and the brick of the image around that.
        let reach = 2.5 + 2.0 + 2.5;
        let beside = |p: Vec3| (p - center).abs().max_element() > reach;
        same_outside(
            &after,
            &before,
            |p| match brush {
                BrushKind::AddTrim => beside(p),
                BrushKind::AddGrow => p.z > center.z + reach,
                _ => {
                    beside(p) && p.z < center.z
                        || beside(p) && (p - center).xy().length() > reach + p.z - center.z
                }
            },
            &format!("{brush:?}"),
        );
    }
}

#[test]
fn preserving_keeps_what_stands_on_a_pillar_and_trimming_topples_it() {
    let pillar: NodeRef = cylinder([0., 0., 0.], [0., 0., 20.], 2.0).into();
    let cut = |brush| {
        let tip = BrushTip::Cube;
        let stroke = BrushStroke { tip, ..BrushStroke::new(brush, 4.0, [[0., 0., 10.]]) };
        let [after, _] = brushed(&pillar, vec![stroke]);
        voxels(&after)
    };
    let layers = |grid: &VoxelGrid| {
        let tallest = grid.solid_voxels().map(|[_, _, z]| z + 1).max();
        tallest.unwrap_or(0)
    };
    let (kept, toppled) = (cut(BrushKind::RemovePreserve), cut(BrushKind::RemoveTrim));
    assert_eq!(layers(&kept), 80, "the top of the pillar fell");
    assert!((23..=25).contains(&layers(&toppled)), "{} layers stand", layers(&toppled));
    let of_cut = |grid: &VoxelGrid| grid.solid_voxels().filter(|[_, _, z]| (24..56).contains(z)).count();
    let whole = voxels(&compiled(&pillar));
    let share = of_cut(&kept) as f32 / of_cut(&whole) as f32;
    assert!((0.02..0.6).contains(&share), "{share} of the cut is left");
    assert_eq!(hanging(&kept), 0);
}

#[test]
fn a_grown_bridge_stands_on_the_bed_or_on_the_shape_and_later_strokes_stand_on_it() {
    let grow = BrushStroke::new(BrushKind::AddGrow, 1.5, [[0., 8., 20.]]);
    let mut on_top = BrushStroke::new(BrushKind::AddTrim, 1.5, [[0., 8., 22.]]);
    let height = |strokes: Vec<BrushStroke>| {
        let [after, _] = brushed(&block(), strokes);
        let top = (0..2800).map(|i| i as f32 * 0.01).rfind(|z| after.value(Vec3::new(0., 8., *z)) >= 0.5);
        top.unwrap_or(0.0)
    };
    assert!((height(vec![grow.clone()]) - 21.5).abs() < 0.1);
    assert!((height(vec![grow.clone(), on_top.clone()]) - 23.5).abs() < 0.1);
    // In the other order, there is nothing yet to stand on.
    assert!((height(vec![on_top.clone(), grow]) - 21.5).abs() < 0.1);
    on_top.places[0].z = 40.0;
    assert_eq!(height(vec![on_top]), 0.0);
}

#[test]
fn strokes_on_nothing_stand_on_the_bed() {
    let nothing: NodeRef = union(Vec::<NodeRef>::new()).into();
    let strokes = vec![
        BrushStroke::new(BrushKind::AddTrim, 3.0, [[0., 0., 1.]]),
        BrushStroke::new(BrushKind::AddGrow, 1.5, [[4., 0., 12.]]),
    ];
    let [after, before] = brushed(&nothing, strokes);
    assert!(before.support().is_empty());
    let grid = voxels(&after);
    assert!(grid.is_solid([68, 48, 8]), "the ball on the bed");
    assert_eq!(hanging(&grid), 0);
    assert_eq!(grid.solid_voxels().map(|[_, _, z]| z).max(), Some(53), "the top of what was grown");
}

#[test]
fn an_edit_below_is_replayed_and_an_undone_one_is_not_baked_again() {
    let stroke = Arc::new(BrushStroke::new(BrushKind::AddTrim, 2.0, [[8., 0., 11.]]));
    let rule = SupportFree { strokes: vec![stroke], ..trimming(45.0, 0.25) };
    let child = block();
    let root: NodeRef = child.clone().support_free(rule.clone()).into();
    let mut store = BakeStore::new();
    store.bake(&root, &Rebaker::new()).expect("it can be baked");
    let first = store.of(&root).expect("it is baked").clone();
    assert!(first.brushed.grown.is_some() && first.brushed.limit.is_none());
    let moved: NodeRef = child.translate([0.5, 0., 0.]).support_free(rule).into();
    store.bake(&moved, &Rebaker::new()).expect("it can be baked");
    assert!(*store.of(&moved).expect("it is baked") != first, "the edit is not seen");
    store.bake(&root, &Rebaker::new()).expect("it can be baked");
    assert!(Arc::ptr_eq(store.of(&root).expect("it is baked"), &first), "baked twice");
}

#[test]
fn replaying_stops_when_asked_to() {
    let cancel = Cancel::new();
    cancel.cancel();
    let stroke = Arc::new(BrushStroke::new(BrushKind::AddTrim, 2.0, [[8., 0., 11.]]));
    let rule = SupportFree { strokes: vec![stroke], ..trimming(45.0, 0.25) };
    let tree = Tree::new(&block());
    let result = Rebaker::with_cancel(&cancel).brush(&rule, &tree, Bake::default());
    assert_eq!(result, Err(BakeError::Cancelled));
}

#[test]
fn one_thread_and_many_replay_the_same_bytes() {
    let strokes = KINDS.map(|brush| {
        let places = (0..8).map(|n| [4. + 0.5 * n as f32, 0.3 * n as f32, 9. + 0.4 * n as f32]);
        Arc::new(BrushStroke::new(brush, 2.0, places))
    });
    let rule = SupportFree { strokes: strokes.to_vec(), ..trimming(45.0, 0.25) };
    let root: NodeRef = block().support_free(rule).into();
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut store = BakeStore::new();
        pool.install(|| store.bake(&root, &Rebaker::new())).expect("it can be baked");
        store.of(&root).expect("it is baked").clone()
    };
    let one = bake(1);
    assert!(one.brushed.grown.is_some() && one.brushed.limit.is_some());
    for threads in [2, 5] {
        assert!(bake(threads) == one, "{threads} threads differ");
    }
}
