//! Slices against closed forms, and what meshes can have wrong.

use super::clip::{doubled_area, pairs};
use super::outline::{Outline, apart};
use super::rect::Rect;
use super::*;
use glam::{Quat, Vec3};
use mesh::shapes::{cuboid, cylinder, ico_sphere, torus};
use polygonizer::Cancel;
use std::f64::consts::{PI, TAU};

fn height(mm: f32) -> LayerHeight {
    LayerHeight::from_mm(mm).expect("legal")
}

fn slices(mesh: &Mesh, mm: f32) -> Slices {
    Slices::new(mesh, height(mm), Bottom::LowestPoint, &Watch::default()).expect("can be sliced")
}

#[test]
fn slices_of_round_shapes_have_the_areas_of_their_mid_layer_polygons() {
    let rod = slices(&cylinder(Vec3::new(3.0, -7.0, 11.0), 5.0, 8.0, 360), 0.25);
    assert_eq!(rod.layers.len(), 32);
    let circle = 0.5 * 360.0 * 25.0 * (2.0 * PI / 360.0).sin();
    for layer in 0..32 {
        assert!((rod.area(layer) - circle).abs() < 1e-4, "layer {layer}: {}", rod.area(layer));
    }
    let ball = ico_sphere(Vec3::ZERO, 10.0, 5);
    assert!((slices(&ball, 0.05).volume() / ball.volume() - 1.0).abs() < 1e-5);
    let ring = torus(Vec3::ZERO, 10.0, 3.0, 96, 48);
    let middle = slices(&ring, 2.0);
    assert_eq!(middle.regions(1).map(|rings| rings.len()).collect::<Vec<_>>(), [2], "an outline and a hole");
}

#[test]
fn vertices_on_planes_neither_break_outlines_nor_move_them() {
    // Planes at 0.5, 1.5, …: every corner of these lies on one.
    let mut stairs = Mesh::default();
    for step in 0..4u8 {
        let (low, high) = (f32::from(step) - 0.5, f32::from(step) + 0.5);
        stairs.append(&cuboid(Vec3::new(0.0, 0.0, low), Vec3::new(8.0 - 2.0 * f32::from(step), 5.0, high)));
    }
    let cut = Slices::new(&stairs, height(1.0), Bottom::Bed, &Watch::default()).expect("can be sliced");
    let areas: Vec<f64> = (0..cut.layers.len()).map(|layer| cut.area(layer)).collect();
    // A corner on a plane counts as above it, so the plane meets the step that ends there, not the next one.
    assert_eq!(areas, [40.0, 30.0, 20.0]);
    assert!(cut.layers.iter().all(|layer| layer.open.is_empty()));
    // An octahedron whose middle corners all lie on a plane.
    let mut octahedron = ico_sphere(Vec3::ZERO, 1.5, 0);
    octahedron
        .positions
        .clone_from(&[Vec3::Z * 1.5, Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y, -Vec3::Z * 1.5].to_vec());
    octahedron.triangles =
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
    let cut = slices(&octahedron, 1.0);
    assert!((cut.area(1) - 2.0).abs() < 1e-9, "{}", cut.area(1));
}

#[test]
fn overlaps_count_once_voids_are_empty_and_inward_meshes_are_turned_round() {
    let block = cuboid(Vec3::ZERO, Vec3::splat(4.0));
    let mut overlapping = block.clone();
    overlapping.append(&cuboid(Vec3::splat(2.0), Vec3::splat(6.0)));
    assert!((slices(&overlapping, 0.5).volume() - (64.0 + 64.0 - 8.0)).abs() < 1e-6);
    let mut doubled = block.clone();
    doubled.append(&block);
    assert!((slices(&doubled, 0.5).volume() - 64.0).abs() < 1e-6);
    let mut hollow = block;
    let mut void = cuboid(Vec3::splat(1.0), Vec3::splat(3.0));
    void.flip();
    hollow.append(&void);
    assert!((slices(&hollow, 0.5).volume() - 56.0).abs() < 1e-6);
    hollow.flip();
    assert!((slices(&hollow, 0.5).volume() - 56.0).abs() < 1e-6);
}

#[test]
fn holes_in_the_mesh_are_told_with_their_layer_and_place() {
    let mut open = cuboid(Vec3::ZERO, Vec3::new(4.0, 4.0, 2.0));
    let before = open.triangles.len();
    open.triangles.retain(|t| {
        let corners =
            open.positions[t[0] as usize] + open.positions[t[1] as usize] + open.positions[t[2] as usize];
        corners.x < 11.9
    });
    assert_eq!(open.triangles.len(), before - 2, "one side is gone");
    let cut = slices(&open, 0.5);
    for layer in &cut.layers {
        assert_eq!(layer.open.len(), 1);
        assert!(layer.open[0].x > 3.9, "{:?}", layer.open);
    }
}

#[test]
fn turned_and_moved_parts_keep_their_volume_wherever_they_are() {
    let mut random = fastrand::Rng::with_seed(7);
    for seed in 0..20 {
        let turn = Quat::from_rotation_z(random.f32() * 7.0) * Quat::from_rotation_x(random.f32());
        let mut mesh = torus(Vec3::ZERO, 20.0, 6.0, 40, 20);
        let offset = Vec3::new(random.f32() * 400.0, random.f32() * -400.0, random.f32() * 10.0);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p + offset);
        let volume = slices(&mesh, 0.1).volume();
        assert!((volume / mesh.volume() - 1.0).abs() < 1e-4, "seed {seed}: {volume}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut mesh = ico_sphere(Vec3::ZERO, 10.0, 4);
    mesh.append(&ico_sphere(Vec3::new(4.0, 3.0, 2.0), 9.0, 4));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| slices(&mesh, 0.25).layers)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_cannot_be_sliced_is_refused_in_words() {
    let cut =
        |mesh: &Mesh, mm| Slices::new(mesh, height(mm), Bottom::LowestPoint, &Watch::default()).map(|_| ());
    assert_eq!(cut(&Mesh::default(), 0.2), Err(SliceError::Empty));
    let missing = Mesh { positions: vec![Vec3::ZERO], triangles: vec![[0, 1, 2]] };
    assert_eq!(cut(&missing, 0.2), Err(SliceError::Empty));
    for bad in [f32::NAN, f32::INFINITY] {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.positions[0].x = bad;
        assert!(matches!(cut(&mesh, 0.2), Err(SliceError::NotFinite { .. })));
    }
    let tower = cuboid(Vec3::ZERO, Vec3::new(1.0, 1.0, 1e6));
    assert!(matches!(cut(&tower, 0.2), Err(SliceError::TooManyLayers { .. })));
    let huge = cuboid(Vec3::splat(-1e38), Vec3::splat(1e38));
    assert!(matches!(cut(&huge, 0.2), Err(SliceError::TooManyLayers { .. })));
    let wide = cuboid(Vec3::ZERO, Vec3::new(3e38, 1.0, 1.0));
    assert!(matches!(cut(&wide, 0.2), Err(SliceError::TooWide { .. })));
    let mut many = Mesh::default();
    (0..700).for_each(|_| many.append(&cuboid(Vec3::ZERO, Vec3::new(1.0, 1.0, 1900.0))));
    assert!(matches!(cut(&many, 0.02), Err(SliceError::TooDetailed { .. })));
}

#[test]
fn a_cancelled_cut_ends_and_progress_reaches_the_end() {
    let mesh = ico_sphere(Vec3::ZERO, 10.0, 3);
    let cancel = Cancel::new();
    cancel.cancel();
    let watch = Watch { cancel: Some(&cancel), progress: None };
    let stopped = Slices::new(&mesh, height(0.1), Bottom::LowestPoint, &watch);
    assert_eq!(stopped.map(|_| ()), Err(SliceError::Cancelled));
    let most = std::sync::Mutex::new(0.0f32);
    let progress = |share: f32| {
        let mut most = most.lock().expect("nobody panics");
        *most = most.max(share);
    };
    let watch = Watch { cancel: None, progress: Some(&progress) };
    Slices::new(&mesh, height(0.1), Bottom::LowestPoint, &watch).expect("can be sliced");
    assert_eq!(*most.lock().expect("nobody panics"), 1.0);
}

/// Distance from a place to the outlines of regions, and whether it is in one; by looking at every side.
fn brute_distance(regions: &[Region], p: DVec2) -> (f64, bool) {
    let place = |p: Point| DVec2::new(f64::from(p.x), f64::from(p.y));
    let (mut nearest, mut inside) = (f64::INFINITY, false);
    for (a, b) in regions.iter().flatten().flat_map(|ring| pairs(ring)) {
        let (a, b) = (place(a), place(b));
        let along = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
        nearest = nearest.min(p.distance(a.lerp(b, along)));
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    (nearest, inside)
}

#[test]
fn grown_regions_are_round_to_half_a_micrometre() {
    let step = 2f64.powi(-20);
    let mut random = fastrand::Rng::with_seed(11);
    for (seed, radius) in (0..24).zip([0.26, 0.05, 1.0, 5.5].into_iter().cycle()) {
        let corners = random.usize(3..60);
        let mut around = |scale: f64| -> Vec<Point> {
            let at = |i: usize, r: f64| {
                let p = DVec2::from_angle(TAU * i as f64 / corners as f64) * r * scale / step;
                Point::new(p.x.round() as i32, p.y.round() as i32)
            };
            (0..corners).map(|i| at(i, 0.4 + random.f64())).collect()
        };
        let (outline, mut hole) = (around(8.0), around(2.0));
        hole.reverse();
        let regions = Clipper::new().fill(&[outline, hole]);
        let grown = clip::grown(&regions, radius, step);
        for _ in 0..400 {
            let p = DVec2::new(random.f64() - 0.5, random.f64() - 0.5) * 30.0 / step;
            let (to_outline, inside) = brute_distance(&regions, p);
            let distance = if inside { 0.0 } else { to_outline * step };
            if (distance - radius).abs() > 0.000_5 {
                let (_, covered) = brute_distance(&grown, p);
                assert_eq!(covered, distance < radius, "seed {seed}, {distance} mm away, radius {radius}");
            }
        }
        for &p in grown.iter().flatten().flatten() {
            let (distance, _) = brute_distance(&regions, DVec2::new(f64::from(p.x), f64::from(p.y)));
            assert!((distance * step - radius).abs() < 0.000_5, "seed {seed}: {}", distance * step);
        }
    }
}

/// A ring of so many points, on a circle of this radius, mm.
fn circle(points: usize, radius: f64, step: f64) -> Vec<Point> {
    let at = |i: usize| DVec2::from_angle(TAU * i as f64 / points as f64) * radius / step;
    (0..points).map(at).map(|p| Point::new(p.x.round() as i32, p.y.round() as i32)).collect()
}

#[test]
fn what_is_grown_again_and_again_keeps_few_points_and_its_form() {
    let step = 2f64.powi(-20);
    let mut regions = vec![vec![circle(40, 0.5, step)]];
    let flat = 0.5 * (PI / 40.0).cos();
    for layer in 1..=60 {
        regions = clip::thinned(&clip::grown(&regions, 0.258, step), step);
        let points: usize = regions.iter().flatten().map(Vec::len).sum();
        assert!(points < 3000, "{points} points in layer {layer}");
        let reached = 0.258 * f64::from(layer);
        for p in regions.iter().flatten().flatten() {
            let far = f64::from(p.x).hypot(f64::from(p.y)) * step;
            let off = 0.001 * f64::from(layer);
            assert!(far < 0.5 + reached + 1e-5, "{far} mm in layer {layer}");
            assert!(far > flat + reached - off, "{far} mm in layer {layer}");
        }
    }
}

#[test]
fn thinned_rings_stay_within_a_third_of_a_micrometre_of_what_they_were() {
    let step = 2f64.powi(-20);
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..50 {
        let count = random.usize(3..2000);
        let ring = circle(count, 0.1 + 20.0 * random.f64(), step);
        let noisy = |p: &Point| Point::new(p.x + random.i32(-200..200), p.y + random.i32(-200..200));
        let ring: Vec<Point> = ring.iter().map(noisy).collect();
        let thin = clip::thinned(&[vec![ring.clone()]], step);
        assert!(thin[0][0].len() >= 3 && thin[0][0].len() <= ring.len());
        for p in &ring {
            let (distance, _) = brute_distance(&thin, DVec2::new(f64::from(p.x), f64::from(p.y)));
            assert!(distance * step < 0.000_301, "{} mm off", distance * step);
        }
    }
}

#[test]
fn what_is_clipped_to_a_box_winds_around_its_places_as_before() {
    let mut rng = fastrand::Rng::with_seed(3);
    let rect = Rect { min: Point::new(-400, -300), max: Point::new(500, 350) };
    for round in 0..200 {
        // Rings of any form, most of which cross themselves.
        let corner = |rng: &mut fastrand::Rng| Point::new(rng.i32(-1000..1000), rng.i32(-1000..1000));
        let ring: Vec<Point> = (0..rng.usize(3..20)).map(|_| corner(&mut rng)).collect();
        let whole = Outline { rect: Rect::of_points(&ring).expect("points"), ring: ring.clone() };
        let ring = rect.clipped(&ring);
        let Some(own) = Rect::of_points(&ring) else { continue };
        assert!(rect.contains(own.min) && rect.contains(own.max), "round {round}: {own:?}");
        let clipped = Outline { rect: own, ring };
        for _ in 0..40 {
            let p = Point::new(rng.i32(-395..495), rng.i32(-295..345));
            let near = |outline: &Outline| {
                pairs(&outline.ring).any(|(a, b)| {
                    let [a, b, p] = [a, b, p].map(|p| DVec2::new(f64::from(p.x), f64::from(p.y)));
                    let share = ((p - a).dot(b - a) / (b - a).length_squared().max(1.0)).clamp(0.0, 1.0);
                    p.distance(a.lerp(b, share)) < 2.0
                })
            };
            if !near(&whole) && !near(&clipped) {
                assert_eq!(whole.winding(p), clipped.winding(p), "round {round}: {p:?}");
            }
        }
    }
}

#[test]
fn rings_that_touch_themselves_come_apart_and_wind_as_before() {
    let ring = |places: &[[i32; 2]]| places.iter().map(|p| Point::new(p[0], p[1])).collect::<Vec<_>>();
    // A square with a speck at one corner and another within it at a second, and a corner said twice.
    let whole = ring(&[
        [0, 0],
        [900, 0],
        [900, 0],
        [900, 900],
        [950, 900],
        [950, 950],
        [900, 950],
        [900, 900],
        [0, 900],
        [0, 0],
        [50, 80],
        [80, 50],
    ]);
    let rings = apart(whole.clone());
    assert_eq!(rings.iter().map(Vec::len).sum::<usize>(), 4 + 4 + 3);
    let mut sizes: Vec<i128> = rings.iter().map(|ring| doubled_area(ring)).collect();
    assert_eq!(sizes.iter().sum::<i128>(), doubled_area(&whole));
    sizes.sort_unstable();
    assert_eq!(sizes, [-3900, 5000, 1_620_000]);
    let simple = ring(&[[0, 0], [9, 0], [9, 9]]);
    assert_eq!(apart(simple.clone()), [simple]);
}
