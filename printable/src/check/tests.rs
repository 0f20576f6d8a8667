//! Shapes whose answers are known, and whatever can be wrong with a part.

use super::*;
use crate::LayerHeight;
use glam::{Quat, Vec3};
use mesh::shapes::{cuboid, ico_sphere};
use polygonizer::Cancel;
use std::f64::consts::{PI, TAU};

/// What the default rule tolerates beyond one layer, mm.
const REACH: f64 = 0.26;

fn checked(mesh: &Mesh) -> PrintCheck {
    checked_as(mesh, &CheckSettings::default())
}

fn checked_as(mesh: &Mesh, settings: &CheckSettings) -> PrintCheck {
    let watch = Watch::default();
    let slices =
        Slices::new(mesh, settings.rule.layer_height, settings.bottom, &watch).expect("can be sliced");
    PrintCheck::new(mesh, &slices, settings, &watch).expect("nobody stops it")
}

fn block(low: [f32; 3], high: [f32; 3]) -> Mesh {
    cuboid(low.into(), high.into())
}

/// Several bodies as one mesh.
fn joined(parts: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    parts.iter().for_each(|part| all.append(part));
    all
}

/// A frustum with `sides` sides, by the circumscribed radii of its bottom and top.
fn frustum(sides: u32, bottom: f64, top: f64, height: f64) -> Mesh {
    let ring = |radius: f64, z: f64| {
        (0..sides).map(move |i| {
            let angle = TAU * (f64::from(i) + 0.5) / f64::from(sides);
            Vec3::new((radius * angle.cos()) as f32, (radius * angle.sin()) as f32, z as f32)
        })
    };
    let positions = ring(bottom, 0.0).chain(ring(top, height)).chain([Vec3::ZERO, Vec3::Z * height as f32]);
    let (low, high) = (2 * sides, 2 * sides + 1);
    let triangles = (0..sides).flat_map(|i| {
        let j = (i + 1) % sides;
        [[i, j, sides + j], [i, sides + j, sides + i], [low, j, i], [high, sides + i, sides + j]]
    });
    Mesh { positions: positions.collect(), triangles: triangles.collect() }
}

#[test]
fn cones_within_the_limit_are_held_and_steeper_ones_hang_by_their_rings() {
    let cone = |degrees: f64| frustum(360, 5.0, 5.0 + 15.0 * degrees.to_radians().tan(), 15.0);
    for degrees in [0.0, 30.0, 44.0, 45.0, 46.0] {
        let check = checked(&cone(degrees));
        assert!(check.is_support_free(), "{degrees}°: {} mm²", check.unsupported());
        assert_eq!(check.largest_excess(), 0.0);
    }
    let check = checked(&cone(50.0));
    let grows = 0.25 * 50f64.to_radians().tan();
    // The polygon's rim advances by its apothem's growth, and stays a polygon but for tiny arcs.
    let ring = |k: f64| {
        let inner = (5.0 + (k - 0.5) * grows) * (PI / 360.0).cos();
        let (held, rim) = (inner + REACH, inner + grows * (PI / 360.0).cos());
        (rim * rim - held * held) * 360.0 * (PI / 360.0).tan()
    };
    let expected: f64 = (1..60).map(|k| ring(f64::from(k))).sum();
    assert!((check.unsupported() - expected).abs() < 0.02, "{}, not {expected}", check.unsupported());
    assert!((check.largest_excess() - (grows - 0.25)).abs() < 1e-3, "{}", check.largest_excess());
    let area = check.steep.outside;
    let lateral = PI * (5.0 + 5.0 + 15.0 * 50f64.to_radians().tan()) * 15.0 / 50f64.to_radians().cos();
    assert!((area / lateral - 1.0).abs() < 1e-3, "{area}, not {lateral}");
}

#[test]
fn an_inverted_pyramid_of_45_degrees_hangs_at_its_ridges() {
    let check = checked(&frustum(4, 0.0, 10.0 * 2f64.sqrt(), 10.0));
    // In each corner, what of a square of 0.25 mm lies outside a quarter disc of 0.26 mm.
    let primitive = |x: f64| 0.5 * (x * (REACH * REACH - x * x).sqrt() + REACH * REACH * (x / REACH).asin());
    let cut = (REACH * REACH - 0.0625).sqrt();
    let corner = 0.0625 - cut * 0.25 - (primitive(0.25) - primitive(cut));
    let expected = 39.0 * 4.0 * corner;
    assert!((check.unsupported() - expected).abs() < 0.01, "{}, not {expected}", check.unsupported());
    assert!(
        check.is_printable() && !check.is_support_free(),
        "small enough to print, not to satisfy slicers"
    );
    assert!((check.largest_excess() - 0.25 * (2f64.sqrt() - 1.0)).abs() < 1e-3);
}

#[test]
fn a_bridge_hangs_between_its_pillars_and_farthest_in_the_middle() {
    let bridge = joined(&[
        block([0.0, 0.0, 0.0], [5.0, 6.0, 15.0]),
        block([15.0, 0.0, 0.0], [20.0, 6.0, 15.0]),
        block([0.0, 0.0, 15.0], [20.0, 6.0, 20.0]),
    ]);
    let check = checked(&bridge);
    assert!((check.unsupported() - (10.0 - 2.0 * REACH) * 6.0).abs() < 1e-3, "{}", check.unsupported());
    assert!((check.largest_excess() - 4.75).abs() < 0.03, "{}", check.largest_excess());
    assert_eq!(check.islands(), 0);
    let [first, ..] = check.findings[..] else { panic!("found nothing") };
    assert_eq!(first.layer, Some(60));
    assert!(first.place.abs_diff_eq(DVec3::new(10.0, first.place.y, 15.125), 0.05), "{first}");
    assert!(first.to_string().starts_with("layer 60, z = 15.12 mm, at ("), "{first}");
}

#[test]
fn the_bar_of_a_t_hangs_on_both_sides_and_a_hollow_cube_by_its_ceiling() {
    let t =
        joined(&[block([-3.0, -3.0, 0.0], [3.0, 3.0, 20.0]), block([-15.0, -5.0, 20.0], [15.0, 5.0, 24.0])]);
    let check = checked(&t);
    let grown = 36.0 + 4.0 * 6.0 * REACH + PI * REACH * REACH;
    assert!((check.unsupported() - (300.0 - grown)).abs() < 1e-2, "{}", check.unsupported());
    let mut void = block([2.0, 2.0, 2.0], [18.0, 18.0, 18.0]);
    void.flip();
    let check = checked(&joined(&[block([0.0; 3], [20.0; 3]), void]));
    assert!((check.unsupported() - (16.0 - 2.0 * REACH).powi(2)).abs() < 1e-3, "{}", check.unsupported());
    assert!((check.largest_excess() - 7.75).abs() < 0.03);
    assert_eq!((check.voids.len(), check.steep.outside), (1, 0.0));
    assert!((check.voids[0].volume - 4096.0).abs() < 1e-6 && (check.steep.inside - 256.0).abs() < 1e-6);
}

#[test]
fn islands_are_regions_with_nothing_below_even_if_they_are_close() {
    let plate = block([0.0, 0.0, 0.0], [20.0, 20.0, 5.0]);
    for (gap, detached) in [(0.1, 0), (3.0, 1)] {
        let low = block([20.0 + gap, 0.0, 2.0], [25.0, 20.0, 5.0]);
        let check = checked(&joined(&[plate.clone(), low]));
        assert_eq!(check.islands(), 1, "gap of {gap}");
        assert_eq!(check.layers.iter().map(|layer| layer.detached).sum::<usize>(), detached, "gap of {gap}");
        let [first, ..] = check.findings[..] else { panic!("found nothing") };
        assert!(
            matches!(first.kind, Kind::Island { area } if (area - 20.0 * f64::from(5.0 - gap)).abs() < 1e-3)
        );
        assert_eq!(first.layer, Some(8));
        assert!(!check.is_printable());
    }
    // Touching along a line is no support.
    let corner = joined(&[block([0.0; 3], [5.0; 3]), block([5.0, 5.0, 5.0], [9.0; 3])]);
    assert_eq!(checked(&corner).islands(), 1);
}

#[test]
fn turned_copies_hang_by_the_same_area() {
    let t = joined(&[block([-3.0, -3.0, 0.0], [3.0, 3.0, 8.0]), block([-9.0, -5.0, 8.0], [9.0, 5.0, 10.0])]);
    let straight = checked(&t);
    for degrees in [7.0f32, 30.0, 45.0, 111.0] {
        let mut turned = t.clone();
        let turn = Quat::from_rotation_z(degrees.to_radians());
        turned.positions.iter_mut().for_each(|p| *p = turn * *p + Vec3::new(31.0, -17.0, 4.0));
        let check = checked(&turned);
        assert!((check.unsupported() - straight.unsupported()).abs() < 0.01, "{degrees}°");
        assert!((check.largest_excess() - straight.largest_excess()).abs() < 0.03, "{degrees}°");
    }
}

#[test]
fn a_bed_at_zero_makes_what_floats_above_it_an_island() {
    let floating = block([0.0, 0.0, 3.0], [5.0, 5.0, 8.0]);
    assert!(checked(&floating).is_support_free());
    let settings = CheckSettings { bottom: Bottom::Bed, ..CheckSettings::default() };
    let check = checked_as(&floating, &settings);
    assert_eq!((check.islands(), check.layers.len()), (1, 32));
    assert!((check.unsupported() - 25.0).abs() < 1e-6);
    assert_eq!(check.spots[0].excess, None, "there is nothing to measure from");
}

#[test]
fn remarks_are_no_problems_and_flat_parts_are() {
    let mut void = ico_sphere(Vec3::new(0.0, 0.0, 10.0), 0.1, 1);
    void.flip();
    let part = joined(&[block([-5.0, -5.0, 0.0], [5.0, 5.0, 20.0]), void]);
    let check = checked(&part);
    assert!(check.findings.iter().any(|f| matches!(f.kind, Kind::ClosedVoid { .. })));
    assert!(check.findings.iter().all(|f| !f.kind.is_serious()) && check.is_support_free());
    let thin = checked(&block([0.0, 0.0, 0.0], [30.0, 0.3, 10.0]));
    assert!(
        thin.findings.iter().any(|f| matches!(f.kind, Kind::ThinWall { thickness, .. } if thickness < 0.31))
    );
    let flat = checked(&block([0.0; 3], [10.0, 10.0, 0.1]));
    assert!(!flat.is_printable() && flat.findings[0].kind == Kind::Nothing, "{:?}", flat.findings);
}

#[test]
fn the_number_of_threads_changes_nothing_and_a_cancelled_check_ends() {
    let mesh = joined(&[ico_sphere(Vec3::ZERO, 8.0, 4), ico_sphere(Vec3::new(9.0, 2.0, 1.0), 4.0, 3)]);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| checked(&mesh))
    };
    assert_eq!(with(1), with(3));
    let cancel = Cancel::new();
    let settings = CheckSettings::default();
    let slices = Slices::new(&mesh, settings.rule.layer_height, settings.bottom, &Watch::default());
    cancel.cancel();
    let watch = Watch { cancel: Some(&cancel), progress: None };
    let stopped = PrintCheck::new(&mesh, &slices.expect("can be sliced"), &settings, &watch);
    assert_eq!(stopped, Err(SliceError::Cancelled));
}

#[test]
fn soups_of_triangles_are_judged_without_a_panic() {
    for seed in 0..60 {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut coordinate = || (random.f32() * 12.0).round() / 3.0;
        let positions = (0..30).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
        let triangles = (0..40).map(|_| [(); 3].map(|()| random.u32(0..33))).collect();
        let mesh = Mesh { positions, triangles };
        let settings = CheckSettings::default();
        let height = LayerHeight::from_mm(0.1).expect("legal");
        if let Ok(slices) = Slices::new(&mesh, height, Bottom::LowestPoint, &Watch::default()) {
            let check =
                PrintCheck::new(&mesh, &slices, &settings, &Watch::default()).expect("nobody stops it");
            assert!(check.unsupported().is_finite() && !check.is_support_free(), "seed {seed}");
        }
    }
}

#[test]
fn certificates_come_back_from_text_and_hold_for_their_part_alone() {
    let cone = frustum(90, 5.0, 9.0, 5.0);
    let check = checked(&cone);
    let certificate = Certificate::of(&check).expect("short").expect("the cone prints");
    let text = certificate.to_string();
    let read: Certificate = text.parse().expect("a certificate");
    assert_eq!((read.rule, read.bottom, read.layers.len()), (certificate.rule, certificate.bottom, 20));
    assert_eq!(read.doubts(&checked_as(&cone, &read.settings())), []);

    let mut taller = cone.clone();
    taller.scale(1.1);
    let doubts = read.doubts(&checked(&taller));
    assert!(matches!(doubts[..], [Doubt::LayerCount { .. }, Doubt::Area { .. }]), "{doubts:?}");
    let with_island = joined(&[cone, block([20.0, 0.0, 2.0], [22.0, 2.0, 5.0])]);
    let doubts = read.doubts(&checked(&with_island));
    assert!(
        doubts.iter().any(|doubt| matches!(doubt, Doubt::NeedsSupports { islands: 1, .. })),
        "{doubts:?}"
    );
    assert_eq!(Certificate::of(&checked(&with_island)), Ok(None), "nothing to certify");
}

#[test]
fn broken_certificates_are_refused_in_words() {
    let good =
        Certificate::of(&checked(&block([0.0; 3], [4.0; 3]))).expect("short").expect("prints").to_string();
    for (from, to, words) in [
        ("support-free 1", "support-free 2", "begins with"),
        ("layer_height_mm 0.25", "layer_height_mm 25", "layer height is 25 mm"),
        ("layer_height_mm 0.25", "layer_height_mm x", "line 2"),
        ("overhang_degrees 45", "overhang_degrees NaN", "line 3"),
        ("tolerance_mm 0.01", "tolerance_mm 5", "line 4"),
        ("bottom lowest", "bottom top", "line 5"),
        ("16.0000 0.0000", "16.0000", "line 7"),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from}");
        let error = bad.parse::<Certificate>().expect_err(to).to_string();
        assert!(error.contains(words), "{to}: {error}");
    }
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..2000 {
        let mut bytes = good.clone().into_bytes();
        for _ in 0..random.usize(1..6) {
            let at = random.usize(..bytes.len());
            bytes[at] = random.u8(b' '..b'~');
        }
        // Whatever comes out, it comes out.
        let _ = String::from_utf8_lossy(&bytes[..random.usize(..bytes.len())]).parse::<Certificate>();
    }
}
