//! Surfaces follow their fields, stop when asked, and do not depend on threads.

mod common;

use std::sync::Mutex;

use blobtree::{Aabb, Field};
use common::*;
use glam::Vec3;
use polygonizer::{Cancel, CellSize, Options, PolygonizeError, Surface, progressive};

fn cell(mm: f32) -> CellSize {
    CellSize::from_mm(mm).expect("positive")
}

/// A body of turned boxes and balls, some cut away.
fn body(parts: &[(TurnedBox, u64)]) -> Solid {
    let part = |&(shape, kind): &(TurnedBox, u64)| match kind % 2 {
        0 => shape.as_planes(),
        _ => ball(shape.center, shape.half.x),
    };
    let mut body = part(&parts[0]);
    for next in &parts[1..] {
        body = if next.1 % 3 == 2 { difference(body, part(next)) } else { union(body, part(next)) };
    }
    body
}

fn random_part(random: &mut Random) -> (TurnedBox, u64) {
    let half = Vec3::from_array([(); 3].map(|()| random.between(1.0, 4.0)));
    (TurnedBox { center: random.point(9.0), turn: random.turn(), half }, random.next())
}

/// Seven random parts of a body, and the noise to go on with.
fn random_parts(seed: u64) -> (Random, Vec<(TurnedBox, u64)>) {
    let mut random = Random(seed);
    let parts = (0..7).map(|_| random_part(&mut random)).collect();
    (random, parts)
}

#[test]
fn after_random_edits_an_updated_surface_equals_a_fresh_one_exactly() {
    for seed in 0..4 {
        let (mut random, mut parts) = random_parts(seed);
        let options = Options::default();
        let size = cell(0.31);
        let mut surface = Surface::build(&body(&parts), size, &options).expect("small");
        for edit in 0..8 {
            let i = (random.next() % parts.len() as u64) as usize;
            let before = parts[i];
            parts[i] = random_part(&mut random);
            let reach = |(shape, kind): &(TurnedBox, u64)| body(&[(*shape, *kind)]).support();
            let dirty = reach(&before).union(&reach(&parts[i]));
            let field = body(&parts);
            // The box of a difference is that of its first part, so the first edit may touch all.
            let dirty = if i == 0 { Aabb::around(Vec3::ZERO, Vec3::splat(1e6)) } else { dirty };
            let old = surface.clone();
            let changes = surface.update(&field, &dirty, &options).expect("small");
            let fresh = Surface::build(&field, size, &options).expect("small");
            assert!(surface == fresh, "seed {seed}, edit {edit}: the update differs");
            assert_eq!(surface.mesh(), fresh.mesh());
            assert_sound(&surface.mesh(), &format!("seed {seed}, edit {edit}"));
            for key in old.bricks().chain(surface.bricks()) {
                let told = changes.changed.contains(&key) || changes.removed.contains(&key);
                assert!(told || old.chunk(key) == surface.chunk(key), "seed {seed}, edit {edit}: {key:?}");
            }
        }
    }
}

#[test]
fn an_update_of_several_boxes_equals_a_fresh_surface_exactly() {
    for seed in 0..4 {
        let (mut random, mut parts) = random_parts(seed);
        let options = Options::default();
        let mut surface = Surface::build(&body(&parts), cell(0.31), &options).expect("small");
        let mut dirty = Vec::new();
        for part in parts.iter_mut().skip(1).step_by(2) {
            let before = body(&[*part]).support();
            *part = random_part(&mut random);
            dirty.extend([before, body(&[*part]).support()]);
        }
        surface.update(&body(&parts), &dirty, &options).expect("small");
        let fresh = Surface::build(&body(&parts), cell(0.31), &options).expect("small");
        assert!(surface == fresh, "seed {seed}: the update differs");
    }
}

/// Against the contract of `update`, so it need not be right; but it must not be the end.
#[test]
fn an_update_with_too_small_a_box_does_no_harm_that_the_next_cannot_mend() {
    for seed in 0..20 {
        let mut random = Random(seed);
        let parts: Vec<_> = (0..5).map(|_| random_part(&mut random)).collect();
        let mut surface = Surface::build(&body(&parts), cell(0.4), &Options::default()).expect("small");
        let others: Vec<_> = (0..5).map(|_| random_part(&mut random)).collect();
        let too_small = Aabb::around(random.point(5.0), Vec3::splat(random.between(0.1, 5.0)));
        surface.update(&body(&others), &too_small, &Options::default()).expect("small");
        assert_eq!(surface.bricks().map(|key| surface.chunk(key).mesh.triangles.len()).sum::<usize>(), {
            surface.mesh().triangles.len()
        });
        let everywhere = Aabb::around(Vec3::ZERO, Vec3::splat(1e6));
        surface.update(&body(&others), &everywhere, &Options::default()).expect("small");
        let fresh = Surface::build(&body(&others), cell(0.4), &Options::default()).expect("small");
        assert!(surface == fresh, "seed {seed}: the update differs");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_mesh() {
    let mut random = Random(77);
    let parts: Vec<_> = (0..9).map(|_| random_part(&mut random)).collect();
    let field = body(&parts);
    let meshes = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Surface::build(&field, cell(0.3), &Options::default()).expect("small").mesh())
    });
    assert!(meshes[0] == meshes[1] && meshes[1] == meshes[2]);
}

#[test]
fn chunks_together_are_the_surface() {
    let surface =
        Surface::build(&torus(Vec3::ZERO, 8.0, 3.0), cell(0.4), &Options::default()).expect("small");
    let chunks: Vec<_> = surface.bricks().map(|key| surface.chunk(key)).collect();
    let whole = surface.mesh();
    assert_eq!(chunks.iter().map(|c| c.mesh.triangles.len()).sum::<usize>(), whole.triangles.len());
    let total: f64 = chunks.iter().map(|c| area(&c.mesh)).sum();
    assert!((total / area(&whole) - 1.0).abs() < 1e-9);
    assert_eq!(surface.normals().len(), whole.positions.len());
    assert_eq!(surface.chunk([1000; 3]).mesh.triangles.len(), 0);
}

#[test]
fn a_cancelled_update_leaves_the_surface_as_it_was() {
    let options = Options::default();
    let mut surface = Surface::build(&ball(Vec3::ZERO, 5.0), cell(0.2), &options).expect("small");
    let before = surface.clone();
    let cancel = Cancel::new();
    cancel.cancel();
    let cancelled = Options { cancel: Some(&cancel), ..options };
    let other = ball(Vec3::X, 5.0);
    assert_eq!(surface.update(&other, &other.support(), &cancelled), Err(PolygonizeError::Cancelled));
    assert!(surface == before);
    assert_eq!(Surface::build(&other, cell(0.2), &cancelled), Err(PolygonizeError::Cancelled));
}

#[test]
fn progress_ends_at_one_and_can_cancel() {
    let shares = Mutex::new(Vec::new());
    let cancel = Cancel::new();
    let watch = |share: f32| {
        shares.lock().expect("no panic").push(share);
        if share > 0.4 && share < 1.0 {
            cancel.cancel();
        }
    };
    let ball = ball(Vec3::ZERO, 20.0);
    let options = Options { progress: Some(&watch), ..Options::default() };
    Surface::build(&ball, cell(0.3), &options).expect("small");
    assert_eq!(shares.lock().expect("no panic").pop(), Some(1.0));
    assert!(shares.lock().expect("no panic").iter().all(|s| (0.0..=1.0).contains(s)));
    let options = Options { cancel: Some(&cancel), ..options };
    assert_eq!(Surface::build(&ball, cell(0.3), &options), Err(PolygonizeError::Cancelled));
}

#[test]
fn levels_come_from_coarse_to_fine() {
    let mut sizes = Vec::new();
    let show = |surface: Surface| sizes.push((surface.cell().mm(), surface.triangle_count()));
    progressive(&ball(Vec3::ZERO, 5.0), cell(0.25), 3, &Options::default(), show).expect("small");
    assert_eq!(sizes.iter().map(|s| s.0).collect::<Vec<_>>(), [1.0, 0.5, 0.25]);
    assert!(sizes.is_sorted_by(|a, b| 3 * a.1 < b.1));
}

#[test]
fn what_is_too_fine_is_refused_with_a_size_that_fits() {
    let ball = ball(Vec3::ZERO, 500.0);
    let too_fine = Surface::build(&ball, cell(1e-3), &Options::default());
    let Err(PolygonizeError::TooFine { fits_mm, .. }) = too_fine else { panic!("{too_fine:?}") };
    let few = Options { max_triangles: 1000, ..Options::default() };
    assert!(matches!(
        Surface::build(&ball, cell(fits_mm), &few),
        Err(PolygonizeError::TooManyTriangles { limit: 1000, .. })
    ));
    let mut endless = ball;
    endless.bounds.max.x = f32::INFINITY;
    let refused = Surface::build(&endless, cell(1.0), &few);
    assert!(matches!(refused, Err(PolygonizeError::Support { .. })), "{refused:?}");
}

#[test]
fn an_empty_field_has_an_empty_surface() {
    let mut nothing = ball(Vec3::ZERO, 1.0);
    nothing.bounds = Aabb::EMPTY;
    let surface = Surface::build(&nothing, cell(0.1), &Options::default()).expect("nothing to do");
    assert_eq!(surface.bricks().len(), 0);
    assert!(surface.mesh().triangles.is_empty());
}

#[test]
fn values_that_are_no_numbers_are_outside_and_harm_nothing() {
    let mut broken =
        TurnedBox { center: Vec3::ZERO, turn: Random(3).turn(), half: Vec3::splat(4.0) }.as_planes();
    let whole = broken.distance;
    broken.distance = Box::new(move |p| {
        let (d, g) = whole(p);
        if (p.x * 3.0).sin() > 0.6 {
            (f32::NAN, g)
        } else {
            (d, if p.y > 1.0 { g * f32::INFINITY } else { g })
        }
    });
    let mesh = Surface::build(&broken, cell(0.3), &Options::default()).expect("small").mesh();
    assert_sound(&mesh, "broken field");
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
}
