//! What brushes promise, dab by dab.

use super::reference::{Plain, blobs, elements, grid_of};
use blobtree::build::{cuboid, point};
use blobtree::{NodeRef, Tree};
use fastrand::Rng;
use glam::Vec3;
use printable::{
    Action, Brush, Dab, DabError, Element, GroundPaths, PathCost, PathMap, Paths, PressureRange,
    StrokeSample, StrokeShape, Tip, VoxelGrid, Why, stroke, trim, unsupported,
};
use std::sync::Arc;

const SIZE: [usize; 3] = [72, 40, 40];

/// A supported solid, and a dab somewhere in it.
fn scene(seed: u64, element: &Element) -> (VoxelGrid, Dab) {
    let mut rng = Rng::with_seed(seed);
    let mut grid = grid_of(&blobs(&mut rng, SIZE));
    trim(&mut grid, element);
    let center = grid.shape().center(std::array::from_fn(|axis| rng.usize(0..SIZE[axis])));
    (grid, Dab::new(center, 0.3 + 2.5 * rng.f32(), 1.0).expect("legal"))
}

fn brush(action: Action, seed: u64) -> Brush {
    let field: NodeRef = cuboid([0.2, 0., 0.], [1.2, 0.8, 1.4]).into();
    let tip = match seed % 4 {
        0 => Tip::Ball,
        1 => Tip::Cube,
        2 => Tip::Cylinder,
        _ => Tip::Solid(Arc::new(Tree::new(&field))),
    };
    Brush { action, tip, material: 2, grown_material: 3 }
}

/// Whether a voxel's centre lies in the box around a tip.
fn in_box(grid: &VoxelGrid, dab: &Dab, voxel: [usize; 3]) -> bool {
    (grid.shape().center(voxel) - dab.center()).abs().max_element() <= dab.radius() * 1.0001
}

/// The voxels that differ.
fn changed(before: &VoxelGrid, after: &VoxelGrid) -> Vec<[usize; 3]> {
    let [nx, ny, nz] = SIZE;
    let all = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    all.filter(|&voxel| before.is_solid(voxel) != after.is_solid(voxel)).collect()
}

/// Runs a check on many dabs of one kind; each must leave nothing hanging and come undone, materials included.
fn try_dabs(action: impl Fn(&VoxelGrid, &Element) -> (Option<Box<dyn Paths>>, usize), check: impl Fn(Case)) {
    for seed in 0..12 {
        for (name, element) in elements() {
            let (before, dab) = scene(seed, &element);
            let (paths, kind) = action(&before, &element);
            let action = match (kind, &paths) {
                (0, _) => Action::AddTrim,
                (1, _) => Action::RemoveTrim,
                (2, _) => Action::RemovePreserve,
                (3, Some(paths)) => Action::AddGrow(&**paths),
                _ => Action::SmoothTrim,
            };
            let brush = brush(action, seed);
            let mut after = before.clone();
            let mut changes = brush.dab(&mut after, &element, &dab);
            let label = format!("seed {seed}, {name}, {:?}", brush.tip);
            assert!(unsupported(&after, &element).is_empty(), "{label}: left something hanging");
            let differing = changed(&before, &after);
            assert_eq!(before.count() + changes.added(), after.count() + changes.removed(), "{label}");
            for &voxel in &differing {
                assert!(changes.why(&after, &element, voxel).is_some(), "{label}: no reason for {voxel:?}");
            }
            check(Case {
                label: &label,
                before: &before,
                after: &after,
                dab: &dab,
                differing: &differing,
                element: &element,
            });
            let mut undone = after.clone();
            changes.swap(&mut undone);
            assert!(undone.same_solid(&before), "{label}: not undone");
            assert!(
                before.solid_voxels().all(|v| undone.material(v) == before.material(v)),
                "{label}: repainted"
            );
            changes.swap(&mut undone);
            assert!(undone.same_solid(&after), "{label}: not done again");
            assert!(
                after.solid_voxels().all(|v| undone.material(v) == after.material(v)),
                "{label}: other paint"
            );
        }
    }
}

/// A dab and what it did.
struct Case<'a> {
    label: &'a str,
    before: &'a VoxelGrid,
    after: &'a VoxelGrid,
    dab: &'a Dab,
    differing: &'a [[usize; 3]],
    element: &'a Element,
}

#[test]
fn add_trim_changes_nothing_outside_its_box_and_adds_all_that_is_carried() {
    try_dabs(
        |_, _| (None, 0),
        |case| {
            for &voxel in case.differing {
                assert!(in_box(case.before, case.dab, voxel), "{}: {voxel:?} is outside", case.label);
                assert!(case.after.is_solid(voxel), "{}: removed", case.label);
                assert_eq!(case.after.material(voxel), 2);
            }
        },
    );
}

#[test]
fn remove_trim_changes_nothing_below_the_dab_nor_outside_its_upward_cone() {
    try_dabs(
        |_, _| (None, 1),
        |case| {
            // The cone: what the box can reach, layer by layer.
            let mut cone = Plain::new(SIZE);
            for voxel in cone.voxels() {
                cone.set(voxel, in_box(case.before, case.dab, voxel.map(|n| n as usize)));
            }
            for z in 0..SIZE[2] - 1 {
                for [x, y, _] in cone.voxels().filter(|voxel| voxel[2] == 0) {
                    let from = case.element.carriers(z, [x, y].map(|n| n as usize), [SIZE[0], SIZE[1]]);
                    if from.into_iter().any(|[x, y]| cone.at([x as i32, y as i32, z as i32])) {
                        cone.set([x, y, z as i32 + 1], true);
                    }
                }
            }
            for &voxel in case.differing {
                assert!(!case.after.is_solid(voxel), "{}: added", case.label);
                assert!(cone.at(voxel.map(|n| n as i32)), "{}: {voxel:?} is outside", case.label);
            }
        },
    );
}

#[test]
fn remove_trim_equals_removing_the_tip_and_trimming_everything() {
    for seed in 0..15 {
        for (name, element) in elements() {
            let (before, dab) = scene(seed, &element);
            let mut after = before.clone();
            brush(Action::RemoveTrim, 0).dab(&mut after, &element, &dab);
            let mut expected = before.clone();
            let in_ball =
                |&voxel: &[usize; 3]| before.shape().center(voxel).distance(dab.center()) <= dab.radius();
            before.solid_voxels().filter(in_ball).for_each(|voxel| expected.set_solid(voxel, false));
            trim(&mut expected, &element);
            assert!(after.same_solid(&expected), "seed {seed}, {name}");
        }
    }
}

#[test]
fn remove_preserve_keeps_no_less_than_remove_trim_and_only_takes_from_the_cone() {
    try_dabs(
        |_, _| (None, 2),
        |case| {
            let lowest = case.differing.iter().map(|voxel| voxel[2]).min().unwrap_or(0);
            let below = case.dab.center().z - case.dab.radius();
            assert!(
                (lowest as f32 + 0.5) * 0.25 >= below - 1e-3 || case.differing.is_empty(),
                "{}",
                case.label
            );
            assert!(case.differing.iter().all(|&voxel| !case.after.is_solid(voxel)), "{}: added", case.label);
        },
    );
    let mut kept = [0, 0];
    for seed in 0..30 {
        for (_, element) in elements() {
            let (before, dab) = scene(seed, &element);
            for (action, kept) in [Action::RemoveTrim, Action::RemovePreserve].into_iter().zip(&mut kept) {
                let mut after = before.clone();
                brush(action, seed).dab(&mut after, &element, &dab);
                *kept += after.count();
            }
        }
    }
    assert!(kept[1] >= kept[0], "{kept:?}");
}

#[test]
fn remove_preserve_leaves_a_funnel_in_a_pillar() {
    let element = Element::square();
    let mut grid = VoxelGrid::new(super::reference::cubic([49, 49, 60]));
    for (x, y) in (4..45).flat_map(|y| (4..45).map(move |x| (x, y))) {
        (0..60).for_each(|z| grid.set_solid([x, y, z], true));
    }
    let slab: NodeRef = cuboid([0., 0., 0.], [8., 8., 1.]).into();
    let tip = Tip::Solid(Arc::new(Tree::new(&slab)));
    let dab = Dab::new(grid.shape().center([24, 24, 20]), 3.9, 1.0).expect("legal");
    let brush = Brush { action: Action::RemovePreserve, tip, material: 0, grown_material: 0 };
    brush.dab(&mut grid, &element, &dab);
    // The slab is 15 layers high. Below what stays above it, each layer is a voxel narrower on every side.
    for z in 0..60 {
        let side = if (13..28).contains(&z) { 41 - 2 * (28 - z) } else { 41 };
        assert_eq!(grid.solid_voxels().filter(|voxel| voxel[2] == z).count(), side * side, "layer {z}");
    }
}

#[test]
fn add_grow_adds_the_whole_tip_and_stands_it_on_something() {
    let kinds = |grid: &VoxelGrid, element: &Element| -> (Option<Box<dyn Paths>>, usize) {
        let paths: Box<dyn Paths> = match grid.count() % 3 {
            0 => Box::new(GroundPaths::new(grid, element)),
            1 => Box::new(PathMap::new(grid, element, PathCost::Climbed)),
            _ => Box::new(PathMap::new(grid, element, PathCost::InSlice)),
        };
        (Some(paths), 3)
    };
    try_dabs(kinds, |case| {
        assert!(case.differing.iter().all(|&voxel| case.after.is_solid(voxel)), "{}: removed", case.label);
        for &voxel in case.differing {
            let material = case.after.material(voxel);
            assert!(material == 3 || material == 2 && in_box(case.before, case.dab, voxel), "{}", case.label);
        }
        if case.label.ends_with("Ball") {
            let mut ball = Plain::new(SIZE).voxels().map(|voxel| voxel.map(|n| n as usize));
            let inside = |voxel: [usize; 3]| {
                case.before.shape().center(voxel).distance(case.dab.center()) < case.dab.radius() - 1e-3
            };
            assert!(
                ball.all(|voxel| !inside(voxel) || case.after.is_solid(voxel)),
                "{}: not whole",
                case.label
            );
        }
    });
}

#[test]
fn smooth_trim_changes_nothing_but_the_tip_and_what_it_topples() {
    try_dabs(
        |_, _| (None, 4),
        |case| {
            let outside = case.differing.iter().filter(|&&voxel| !in_box(case.before, case.dab, voxel));
            assert!(outside.into_iter().all(|&voxel| !case.after.is_solid(voxel)), "{}", case.label);
        },
    );
}

#[test]
fn a_light_dab_moves_the_surface_by_its_strength() {
    let element = Element::square();
    let mut grid = VoxelGrid::new(super::reference::cubic([64, 64, 40]));
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        (0..20).for_each(|z| grid.set_solid([x, y, z], true));
    }
    let dab = Dab::new(Vec3::new(8., 8., 5.), 4.0, 0.25).expect("legal");
    for (action, layers) in [(Action::AddTrim, 20..24), (Action::RemoveTrim, 16..20)] {
        let mut after = grid.clone();
        brush(action, 0).dab(&mut after, &element, &dab);
        let touched: Vec<_> =
            (0..40).filter(|&z| grid.is_solid([32, 32, z]) != after.is_solid([32, 32, z])).collect();
        assert_eq!(touched, layers.collect::<Vec<_>>(), "{action:?}");
    }
}

#[test]
fn a_refused_part_of_a_tip_says_why() {
    let element = Element::square();
    let mut grid = VoxelGrid::new(super::reference::cubic([64, 64, 40]));
    for (x, y) in (20..30).flat_map(|y| (20..30).map(move |x| (x, y))) {
        (0..30).for_each(|z| grid.set_solid([x, y, z], true));
    }
    let add = |grid: &mut VoxelGrid, place: [usize; 3]| {
        let dab = Dab::new(grid.shape().center(place), 2.0, 1.0).expect("legal");
        brush(Action::AddTrim, 0).dab(grid, &element, &dab)
    };
    let changes = add(&mut grid, [30, 25, 17]);
    assert!(changes.taken() > 0 && changes.added() > 0);
    assert_eq!(changes.why(&grid, &element, [36, 25, 13]), Some(Why::TooSteep));
    let changes = add(&mut grid, [50, 50, 25]);
    assert_eq!((changes.added(), changes.why(&grid, &element, [50, 50, 25])), (0, Some(Why::Island)));
}

#[test]
fn dabs_follow_the_pen_at_their_spacing_with_its_pressure() {
    let shape = StrokeShape {
        radius: PressureRange { light: 1.0, full: 3.0 },
        strength: PressureRange::always(1.0),
        spacing: 0.5,
    };
    let sample = |x: f32, pressure: f32| StrokeSample { place: Vec3::new(x, 0., 1.), pressure };
    let dabs =
        shape.dabs(&[sample(0., 0.), sample(f32::NAN, 1.), sample(10., 0.), sample(10., 0.)]).expect("legal");
    let places: Vec<f32> = dabs.iter().map(|dab| dab.center().x).collect();
    assert_eq!(dabs.len(), 21, "{places:?}");
    assert!(places.iter().enumerate().all(|(n, x)| (x - n as f32 / 2.0).abs() < 1e-3), "{places:?}");
    let harder = shape.dabs(&[sample(0., 0.), sample(10., 1.)]).expect("legal");
    assert!(harder.windows(2).all(|two| two[0].radius() < two[1].radius()) && harder.len() < 21);
    assert_eq!(shape.dabs(&[]).expect("legal"), []);
    assert_eq!(shape.dabs(&[sample(1., f32::NAN)]).expect("legal")[0].radius(), 1.0);
    let endless = shape.dabs(&[sample(0., 0.), sample(1e9, 0.)]);
    assert!(matches!(endless, Err(DabError::TooLong { .. })), "{endless:?}");
    assert!(matches!(Dab::new(Vec3::NAN, 1., 1.), Err(DabError::Center { .. })));
    assert!(matches!(Dab::new(Vec3::ZERO, f32::NAN, 1.), Err(DabError::Radius { .. })));
    assert!(matches!(Dab::new(Vec3::ZERO, 1., 1.5), Err(DabError::Strength { .. })));
}

#[test]
fn a_stroke_is_undone_dab_by_dab_from_its_end() {
    let (_, element) = elements().swap_remove(2);
    let (before, _) = scene(3, &element);
    let field: NodeRef = point([0., 0., 0.], 1.).into();
    let tip = Tip::Solid(Arc::new(Tree::new(&field)));
    let shape = StrokeShape {
        radius: PressureRange::always(1.0),
        strength: PressureRange::always(1.0),
        spacing: 0.3,
    };
    let ends = [Vec3::new(1., 2., 1.), Vec3::new(18., 11., 9.)];
    let dabs = shape.dabs(&ends.map(|place| StrokeSample { place, pressure: 1.0 })).expect("legal");
    for action in [Action::AddTrim, Action::RemoveTrim, Action::SmoothTrim] {
        let mut grid = before.clone();
        let brush = Brush { action, tip: tip.clone(), material: 1, grown_material: 1 };
        let mut changes = stroke(&mut grid, &element, &brush, &dabs);
        assert!(unsupported(&grid, &element).is_empty() && !grid.same_solid(&before));
        changes.iter_mut().rev().for_each(|changes| changes.swap(&mut grid));
        assert!(grid.same_solid(&before), "{action:?}");
    }
}

#[test]
fn dabs_off_the_grid_do_nothing_and_those_at_its_sides_stay_in_it() {
    for (name, element) in elements() {
        let (before, _) = scene(1, &element);
        let paths = GroundPaths::new(&before, &element);
        let actions = [
            Action::AddTrim,
            Action::RemoveTrim,
            Action::RemovePreserve,
            Action::AddGrow(&paths),
            Action::SmoothTrim,
        ];
        for action in actions {
            let mut grid = before.clone();
            let far = Dab::new(Vec3::new(1e6, -1e6, 1e6), 3.0, 1.0).expect("legal");
            assert!(brush(action, 0).dab(&mut grid, &element, &far).is_empty(), "{name}, {action:?}");
            for corner in [[0., 0., 0.], [20., 14., 14.], [20., 0., 7.], [-0.4, 7., 14.3]] {
                let dab = Dab::new(Vec3::from_array(corner), 2.0, 1.0).expect("legal");
                brush(action, 0).dab(&mut grid, &element, &dab);
                assert!(unsupported(&grid, &element).is_empty(), "{name}, {action:?} at {corner:?}");
            }
        }
    }
}
