//! Drawn solids against closed forms: balls, cylinders, rings, prisms.

use blobtree::build::{self, Build};
use blobtree::random::{polygon_template, stroke};
use blobtree::{
    Aabb, Drawing, Field, FieldImage, ISO, Node, Primitive, Profile, RevolutionAxis, Sample, Shape, Side,
    SketchPlane, Template, Tree,
};
use fastrand::Rng;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// The exact distance from a circle, 256 samples wide.
fn circle(center: Vec2, radius: f32, falloff: f32) -> Template {
    let pixel = 2.0 * (radius + falloff) / 250.0;
    let origin = center - 128.0 * pixel;
    let place = |i: usize| origin + pixel * Vec2::new((i % 257) as f32, (i / 257) as f32);
    let samples = (0..257 * 257).map(|i| place(i).distance(center) - radius).collect();
    let distance = FieldImage::new(origin, pixel, [257, 257], samples).expect("a legal image");
    Template {
        bulge: distance.bulge(radius),
        distance,
        pressure: None,
        falloff,
        depth: radius,
        contours: vec![ring(center, radius).collect()],
        corners: vec![],
    }
}

fn ring(center: Vec2, radius: f32) -> impl Iterator<Item = Vec2> {
    (0..200).map(move |i| center + radius * Vec2::from_angle(TAU * i as f32 / 200.0))
}

fn drawn(points: &[[f32; 2]], falloff: Option<f32>) -> (Drawing, Template) {
    let drawing =
        Drawing { strokes: vec![stroke(points.iter().map(|p| Vec2::from(*p)))], ..Drawing::default() };
    let template = polygon_template(&drawing, falloff, 256).expect("it encloses something");
    (drawing, template)
}

fn points(seed: u64, region: Aabb, count: usize) -> impl Iterator<Item = Vec3> {
    let mut rng = Rng::with_seed(seed);
    (0..count).map(move |_| region.min + region.size() * Vec3::new(rng.f32(), rng.f32(), rng.f32()))
}

/// The volume, by adding up what of each cell lies behind the plane that fits the field in its middle.
fn volume(node: &Node, cells: i32) -> f64 {
    let tree = Tree::new(node);
    let region = tree.support();
    let step = region.size() / cells as f32;
    let at = |i: i32| {
        let [x, y, z] = [i % cells, i / cells % cells, i / cells / cells].map(|i| i as f32 + 0.5);
        region.min + step * Vec3::new(x, y, z)
    };
    let all: Vec<Vec3> = (0..cells.pow(3)).map(at).collect();
    let mut samples = vec![Sample::default(); all.len()];
    tree.sampler().samples(&all, &mut samples);
    let filled = samples.iter().map(|s| {
        let across = (s.gradient.abs() * step).element_sum().max(1e-9);
        f64::from((0.5 + (s.value - ISO) / across).clamp(0.0, 1.0))
    });
    filled.sum::<f64>() * f64::from(step.x) * f64::from(step.y) * f64::from(step.z)
}

/// Compares two fields at random places.
fn assert_alike(a: &Node, b: &Node, tolerance: f32) {
    let (a, b) = (Tree::new(a), Tree::new(b));
    let region = a.support().union(&b.support());
    let mut felt = 0;
    for p in points(5, region, 20_000) {
        let (x, y) = (a.value(p), b.value(p));
        assert!((x - y).abs() < tolerance, "{x} and {y} at {p}");
        felt += usize::from(y > 0.0);
    }
    assert!(felt > 500, "only {felt} places in the field");
}

fn change<T>(mut node: Node, f: impl Fn(&mut Primitive) -> T) -> Node {
    if let Shape::Primitive(primitive) = &mut node.shape {
        f(primitive);
    }
    node
}

#[test]
fn an_inflated_circle_is_a_ball_with_any_falloff() {
    let natural = 10.0 * 1.201_67;
    for falloff in [2.0, natural, 30.0] {
        let ball = build::inflation(Drawing::default(), circle(Vec2::new(3.0, 5.0), 10.0, 30.0));
        let (ball, exact) =
            (ball.with_falloff(falloff), build::point([3.0, 0.0, 5.0], 10.0).with_falloff(falloff));
        assert_alike(&ball, &exact, 4e-3);
        let expected = 4.0 / 3.0 * f64::from(PI) * 1e3;
        assert!(
            (volume(&ball, 120) / expected - 1.0).abs() < 3e-3,
            "falloff {falloff}: {}",
            volume(&ball, 120)
        );
    }
}

#[test]
fn the_thickness_is_kept_with_every_profile_contrast_and_falloff() {
    for (profile, contrast, falloff) in [
        (Profile::Round, 0.0, 20.0),
        (Profile::Round, 0.9, 2.0),
        (Profile::Flat, 0.0, 2.0),
        (Profile::Flat, 0.5, 20.0),
    ] {
        let node = build::inflation(Drawing::default(), circle(Vec2::ZERO, 10.0, 20.0)).with_falloff(falloff);
        let node = change(node, |primitive| {
            let Primitive::Inflation(p) = primitive else { panic!("an inflation") };
            (p.thickness, p.profile, p.contrast) = (Some(7.0), profile, contrast);
        });
        let tree = Tree::new(&node);
        for side in [-1.0, 1.0] {
            assert!(tree.value(Vec3::new(0.0, side * 3.49, 0.0)) > ISO, "{profile:?}, {contrast}");
            assert!(tree.value(Vec3::new(0.0, side * 3.51, 0.0)) < ISO, "{profile:?}, {contrast}");
        }
        // Half the thickness at half the radius, as documented.
        let s = 0.5_f32;
        let round = (1.0 - contrast * s * s * (2.0 - s * s)).sqrt();
        let height = 3.5
            * round
            * if profile == Profile::Flat { (1.0 - s.powi(4)).powf(0.25) } else { (1.0 - s * s).sqrt() };
        assert!(tree.value(Vec3::new(5.0, 0.99 * height, 0.0)) > ISO, "{profile:?}, {contrast}: {height}");
        assert!(tree.value(Vec3::new(5.0, 1.01 * height, 0.0)) < ISO, "{profile:?}, {contrast}: {height}");
    }
}

#[test]
fn the_silhouette_of_an_inflation_is_the_drawn_curve() {
    let star = [
        [0., 20.],
        [-5., 6.],
        [-19., 6.],
        [-8., -3.],
        [-12., -16.],
        [0., -8.],
        [12., -16.],
        [8., -3.],
        [19., 6.],
        [5., 6.],
    ];
    let (drawing, template) = drawn(&star, Some(3.0));
    let image = template.distance.clone();
    for contrast in [0.0, 0.9] {
        let node = change(build::inflation(drawing.clone(), template.clone()), |primitive| {
            let Primitive::Inflation(p) = primitive else { panic!("an inflation") };
            (p.contrast, p.falloff) = (contrast, Some(3.0));
        });
        let tree = Tree::new(&node);
        for p in points(1, tree.support(), 20_000) {
            let (on, off) = (tree.value(Vec3::new(p.x, 0.0, p.z)), tree.value(p));
            let distance = image.value(Vec2::new(p.x, p.z));
            // At corners the image is rounded, and the solid is not.
            if distance.abs() > 0.3 * image.pixel() {
                assert_eq!(on >= ISO, distance < 0.0, "{on} where the distance is {distance}");
            }
            assert!(off <= on, "it grows away from the plane: {on} to {off} at {p}");
        }
    }
}

#[test]
fn pressure_drives_the_thickness_as_much_as_asked() {
    let mut template = circle(Vec2::ZERO, 10.0, 12.0);
    let image = &template.distance;
    let pressed = image.samples().iter().map(|_| 0.4).collect();
    template.pressure =
        Some(FieldImage::new(image.origin(), image.pixel(), image.size(), pressed).expect("legal"));
    for (pressure, half) in [(0.0, 10.0), (0.5, 7.0), (1.0, 4.0)] {
        let node = change(build::inflation(Drawing::default(), template.clone()), |primitive| {
            let Primitive::Inflation(p) = primitive else { panic!("an inflation") };
            p.pressure = pressure;
        });
        let tree = Tree::new(&node);
        assert!(tree.value(Vec3::new(0.0, half - 0.02, 0.0)) > ISO, "pressure {pressure}");
        assert!(tree.value(Vec3::new(0.0, half + 0.02, 0.0)) < ISO, "pressure {pressure}");
    }
}

#[test]
fn a_swept_circle_is_a_cylinder_and_a_fillet_takes_what_it_should() {
    let sweep = build::linear_sweep(Drawing::default(), circle(Vec2::new(0.0, 20.0), 8.0, 12.0), 30.0);
    assert_alike(&sweep, &build::cylinder([0.0, -15.0, 20.0], [0.0, 15.0, 20.0], 8.0), 4e-3);
    let expected = f64::from(PI) * 64.0 * 30.0;
    assert!((volume(&sweep, 120) / expected - 1.0).abs() < 5e-3);
    let filleted = change(sweep, |primitive| {
        let Primitive::LinearSweep(p) = primitive else { panic!("a sweep") };
        (p.fillet, p.offset) = (3.0, -15.0);
    });
    // By Pappus: the square corner without its quarter disc, about the axis, at both ends.
    let (r, pi) = (3.0, f64::from(PI));
    let missing = r * r * (1.0 - pi / 4.0);
    // Seen from the fillet's centre: the square's moment r³/2 without the quarter disc's r³/3.
    let centroid = 8.0 - r + r * (0.5 - 1.0 / 3.0) / (1.0 - pi / 4.0);
    let expected = expected - 2.0 * missing * 2.0 * pi * centroid;
    assert!(
        (volume(&filleted, 120) / expected - 1.0).abs() < 5e-3,
        "{} not {expected}",
        volume(&filleted, 120)
    );
    let tree = Tree::new(&filleted);
    assert!(tree.value(Vec3::new(0.0, 29.9, 20.0)) > ISO && tree.value(Vec3::new(0.0, 30.1, 20.0)) < ISO);
}

#[test]
fn a_turned_circle_is_a_ring_or_a_ball() {
    let turned = build::revolution(Drawing::default(), circle(Vec2::new(-20.0, 7.0), 6.0, 8.0));
    let ring = build::torus([0.0, 0.0, 7.0], [0.0, 0.0, 1.0], 20.0, 6.0);
    assert_alike(&turned, &ring, 4e-3);
    let expected = f64::from(2.0 * PI * PI) * 20.0 * 36.0;
    assert!((volume(&turned, 120) / expected - 1.0).abs() < 5e-3);
    // A full circle on the axis, and the half of one that a hand has drawn nearly up to the axis.
    let ball = build::revolution(Drawing::default(), circle(Vec2::new(0.0, 10.0), 10.0, 13.0));
    assert!((volume(&ball, 120) / (f64::from(PI) * 4000.0 / 3.0) - 1.0).abs() < 5e-3);
    let mut half: Vec<[f32; 2]> =
        (0..=60).map(|i| Vec2::from_angle(PI * (i as f32 / 60.0 - 0.5)) * 10.0).map(Vec2::into).collect();
    half.extend((1..20).map(|i| [0.2 * (i as f32).sin(), 10.0 - i as f32]));
    let (drawing, template) = drawn(&half, None);
    let ball = build::revolution(drawing, template);
    assert!(
        (volume(&ball, 120) / (f64::from(PI) * 4000.0 / 3.0) - 1.0).abs() < 5e-3,
        "{}",
        volume(&ball, 120)
    );
    let tree = Tree::new(&ball);
    for i in -97..=97 {
        let p = Vec3::new(0.0, 0.0, 0.1 * i as f32);
        assert!(tree.value(p) >= ISO, "a hole on the axis at {p}");
    }
}

#[test]
fn the_side_that_is_turned_is_the_fuller_one_unless_told() {
    let (drawing, template) = drawn(&[[-3.0, 0.0], [9.0, 0.0], [9.0, 4.0], [-3.0, 4.0]], None);
    let of = |side: Option<Side>, axis: RevolutionAxis| {
        change(build::revolution(drawing.clone(), template.clone()), |primitive| {
            let Primitive::Revolution(p) = primitive else { panic!("a revolution") };
            (p.side, p.axis) = (side, axis);
        })
    };
    let up = RevolutionAxis::default();
    let disc = |radius: f64| f64::from(PI) * radius * radius * 4.0;
    for (side, expected) in [
        (None, disc(9.0)),
        (Some(Side::Right), disc(9.0)),
        (Some(Side::Left), disc(3.0)),
        (Some(Side::Both), disc(9.0)),
    ] {
        let found = volume(&of(side, up), 100);
        assert!((found / expected - 1.0).abs() < 1.5e-2, "{side:?}: {found}, not {expected}");
    }
    // About a slanted axis through a corner, right and left swap when its direction does.
    let at = Vec2::new(9.0, 4.0);
    let slanted = |x: f32, y: f32| RevolutionAxis { at, direction: Vec2::new(x, y) };
    let found = [
        volume(&of(Some(Side::Left), slanted(1.0, 2.0)), 100),
        volume(&of(Some(Side::Right), slanted(-1.0, -2.0)), 100),
    ];
    assert!((found[0] / found[1] - 1.0).abs() < 1e-3, "{found:?}");
}

#[test]
fn along_a_straight_path_a_sweep_is_a_prism_and_along_a_circle_a_ring() {
    let template = circle(Vec2::new(2.0, 4.0), 5.0, 7.0);
    let straight =
        build::path_sweep(Drawing::default(), template.clone(), [[2.0, 0.0, 4.0], [2.0, 20.0, 4.0]]);
    assert_alike(
        &straight,
        &build::cylinder([2.0, 0.0, 4.0], [2.0, 20.0, 4.0], 5.0).with_falloff(6.008),
        4e-3,
    );
    let around = (0..=120).map(|i| {
        let at = Vec2::from_angle(TAU * i as f32 / 120.0) * 20.0 - Vec2::new(20.0, 0.0);
        [2.0 + at.x, at.y, 4.0]
    });
    let ring = build::path_sweep(Drawing::default(), template, around);
    assert_alike(&ring, &build::torus([-18.0, 0.0, 4.0], [0.0, 0.0, 1.0], 20.0, 5.0), 8e-3);
    let expected = f64::from(2.0 * PI * PI) * 20.0 * 25.0;
    assert!((volume(&ring, 120) / expected - 1.0).abs() < 5e-3, "{} not {expected}", volume(&ring, 120));
}

#[test]
fn bent_paths_have_whole_corners_and_nothing_beyond_them() {
    // Two square bars that meet at a right angle: a mitred corner.
    let (drawing, template) = drawn(&[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]], None);
    let bars = build::path_sweep(
        drawing.clone(),
        template.clone(),
        [[0.0, 0.0, 0.0], [0.0, 20.0, 0.0], [20.0, 20.0, 0.0]],
    );
    assert!((volume(&bars, 120) / (36.0 * 40.0) - 1.0).abs() < 1e-2, "{}", volume(&bars, 120));
    let tree = Tree::new(&bars);
    for (p, solid) in [
        ([-2.9, 22.9, 2.9], true),
        ([-3.1, 22.9, 0.0], false),
        ([-2.9, 23.1, 0.0], false),
        ([2.9, 17.1, 0.0], true),
        ([3.1, 16.9, 0.0], false),
        ([0.0, 20.0, 0.0], true),
    ] {
        assert_eq!(tree.value(Vec3::from(p)) >= ISO, solid, "at {p:?}");
    }
    // A path that turns back, doubles on itself, or bends tighter than the drawing is wide still makes a field
    // without jumps.
    for path in [
        vec![Vec3::ZERO, Vec3::new(0.0, 20.0, 0.0), Vec3::new(1.0, 0.0, 0.0)],
        vec![Vec3::ZERO, Vec3::new(0.0, 20.0, 0.0), Vec3::ZERO, Vec3::new(0.0, 0.0, 9.0)],
        (0..40)
            .map(|i| Vec3::from_array([(0.4 * i as f32).cos(), (0.4 * i as f32).sin(), 0.2 * i as f32]))
            .collect(),
    ] {
        let tree = Tree::new(&build::path_sweep(drawing.clone(), template.clone(), path));
        for p in points(3, tree.support(), 20_000) {
            let beside = p + Vec3::new(1e-3, -1e-3, 1e-3);
            let jump = (tree.value(p) - tree.value(beside)).abs();
            assert!(jump < 3e-3, "a jump of {jump} at {p}");
        }
    }
}

/// One of each kind over the same drawing, with different falloffs.
fn one_of_each() -> Vec<Node> {
    let (mut drawing, mut template) = drawn(&[[-4.0, 0.0], [9.0, -2.0], [7.0, 8.0], [0.0, 11.0]], Some(9.0));
    let image = &template.distance;
    let pressed =
        (0..image.samples().len()).map(|i| 0.5 + 0.4 * (0.02 * (i % image.size()[0]) as f32).sin()).collect();
    template.pressure =
        Some(FieldImage::new(image.origin(), image.pixel(), image.size(), pressed).expect("legal"));
    drawing.strokes[0].points[0].pressure = 0.5;
    let path = [[0.0, 0.0, 0.0], [3.0, 9.0, 1.0], [12.0, 12.0, 2.0]];
    let mut nodes = vec![
        build::inflation(drawing.clone(), template.clone()),
        build::linear_sweep(drawing.clone(), template.clone(), 6.0),
        build::revolution(drawing.clone(), template.clone()),
        build::path_sweep(drawing.clone(), template.clone(), path),
    ];
    for i in 0..nodes.len() {
        nodes.push(change(nodes[i].clone(), |primitive| match primitive {
            Primitive::Inflation(p) => {
                (p.contrast, p.pressure, p.falloff, p.thickness) = (0.7, 0.8, Some(2.0), Some(5.0));
            }
            Primitive::LinearSweep(p) => (p.fillet, p.falloff) = (2.0, Some(9.0)),
            Primitive::Revolution(p) => (p.side, p.axis.at) = (Some(Side::Both), Vec2::new(2.0, 0.0)),
            Primitive::PathSweep(p) => (p.fillet, p.falloff) = (2.0, Some(2.0)),
            _ => panic!("a drawn solid"),
        }));
    }
    nodes.push(change(nodes[0].clone(), |primitive| {
        let Primitive::Inflation(p) = primitive else { panic!("an inflation") };
        (p.contrast, p.profile) = (0.4, Profile::Flat);
    }));
    nodes
}

#[test]
fn gradients_are_those_of_the_values() {
    for (number, node) in one_of_each().iter().enumerate() {
        let tree = Tree::new(node);
        let (mut tried, mut off) = (0, 0);
        for p in points(9, tree.support(), 20_000) {
            let sample = tree.sample(p);
            // Single precision leaves nothing to compare where the field is nearly flat.
            if sample.gradient.length() < 0.02 {
                continue;
            }
            let slope = |axis: Vec3| {
                let (ahead, behind) = (p + axis * 2e-3, p - axis * 2e-3);
                (tree.value(ahead) - tree.value(behind)) / (ahead - behind).dot(axis)
            };
            let expected = Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z));
            let error = (expected - sample.gradient).length() / sample.gradient.length();
            // At edges, and from pixel to pixel at corners, differences show both sides.
            (tried, off) = (tried + 1, off + usize::from(error > 0.02));
        }
        assert!(tried > 2000 && off * 50 < tried, "{number}: {off} of {tried} gradients are wrong");
    }
}

#[test]
fn bounds_hold_for_boxes_of_all_sizes() {
    for (number, node) in one_of_each().iter().enumerate() {
        let tree = Tree::new(node);
        let mut rng = Rng::with_seed(number as u64);
        let mut sampler = tree.sampler();
        for center in points(11, tree.support(), 12_000) {
            let half = tree.support().size() * 0.5 * rng.f32().powi(4);
            let region = Aabb::around(center, half);
            let bound = sampler.enter(region);
            sampler.leave();
            let inside: Vec<Vec3> = points(rng.u64(..), region, 16).collect();
            let mut values = [0.0; 16];
            sampler.values(&inside, &mut values);
            for (p, value) in inside.iter().zip(values) {
                assert!(
                    (bound.lo..=bound.hi).contains(&value),
                    "{number}: {value} at {p}, {bound:?} in {region:?}"
                );
            }
            if half.max_element() < 1e-3 {
                assert!(bound.hi - bound.lo < 0.35, "{number}: {bound:?} says too little of {region:?}");
            }
        }
    }
}

#[test]
fn planes_carry_the_solid_along_as_transforms_do() {
    let (drawing, template) = drawn(&[[-4.0, 0.0], [9.0, -2.0], [7.0, 8.0], [0.0, 11.0]], None);
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
    let moved = Vec3::new(4.0, -7.0, 12.0);
    let plane = SketchPlane { origin: moved, right: turn * Vec3::X * 3.0, up: turn * Vec3::Z };
    let (x, y, z) = turn.to_euler(glam::EulerRot::ZYX);
    let degrees = Vec3::new(z, y, x).map(f32::to_degrees);
    let path = [[0.0, 0.0, 0.0], [3.0, 9.0, 1.0], [12.0, 12.0, 2.0]];
    for node in [
        build::inflation(drawing.clone(), template.clone()),
        build::linear_sweep(drawing.clone(), template.clone(), 6.0),
        build::revolution(drawing.clone(), template.clone()),
        build::path_sweep(drawing, template, path),
    ] {
        let in_plane = change(node.clone(), |primitive| match primitive {
            Primitive::Inflation(p) => p.plane = plane,
            Primitive::LinearSweep(p) => p.plane = plane,
            Primitive::Revolution(p) => p.plane = plane,
            Primitive::PathSweep(p) => {
                p.plane = plane;
                p.path.iter_mut().for_each(|q| *q = turn * *q + moved);
            }
            _ => panic!("a drawn solid"),
        });
        let transformed = node.rotate_degrees(degrees).translate(moved);
        assert_alike(&in_plane, &transformed, 1e-3);
    }
}

#[test]
fn a_template_with_nothing_in_it_is_an_empty_field() {
    let empty: Arc<Template> = Arc::default();
    for node in [
        build::inflation(Drawing::default(), empty.clone()),
        build::linear_sweep(Drawing::default(), empty.clone(), 6.0),
        build::revolution(Drawing::default(), empty.clone()),
        build::path_sweep(Drawing::default(), empty, [[0.0; 3], [1.0; 3]]),
    ] {
        let tree = Tree::new(&node);
        assert!(points(1, Aabb::around(Vec3::ZERO, Vec3::splat(5.0)), 1000).all(|p| tree.value(p) == 0.0));
    }
}
