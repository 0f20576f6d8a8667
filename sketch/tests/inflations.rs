//! Inflated curves against closed forms and their own outlines: balls, bars, silhouettes, no ridges.

use blobtree::{Drawing, Field, ISO, Template, Tree, build};
use glam::{DVec2, Vec2, Vec3};
use sketch::curve::{Contour, Curve};
use sketch::template;
use std::f64::consts::{PI, TAU};

fn ring(count: usize, at: impl Fn(f64) -> DVec2) -> Contour {
    Contour { points: (0..count).map(|i| at(i as f64 / count as f64)).collect(), corners: Vec::new() }
}

fn polygon(corners: &[DVec2]) -> Contour {
    let mut contour = Contour::default();
    for (i, &from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % corners.len()];
        contour.corners.push(contour.points.len());
        contour.points.extend((0..40).map(|k| from.lerp(to, f64::from(k) / 40.0)));
    }
    contour
}

fn star() -> Contour {
    let corner = |i: usize| {
        DVec2::from_angle(PI * (i as f64 / 5.0 + 0.5)) * if i.is_multiple_of(2) { 30.0 } else { 13.0 }
    };
    polygon(&(0..10).map(corner).collect::<Vec<_>>())
}

fn square() -> Contour {
    polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| 20.0 * DVec2::new(x, y)))
}

/// Nearly a stadium: two half circles of 6 mm, 80 mm apart, and slightly convex sides.
fn stadium() -> Contour {
    ring(600, |t| {
        let turned = DVec2::from_angle(TAU * t);
        6.0 * turned + DVec2::new(40.0 * (8.0 * turned.x).clamp(-1.0, 1.0), 0.0)
    })
}

/// An ellipse with a round hole beside its middle.
fn with_hole() -> Vec<Contour> {
    let mut hole = ring(300, |t| DVec2::new(4.0, 2.0) + 9.0 * DVec2::from_angle(TAU * t));
    hole.points.reverse();
    vec![ring(500, |t| DVec2::new(30.0, 24.0) * DVec2::from_angle(TAU * t)), hole]
}

fn inflated(contours: Vec<Contour>) -> (Template, Tree) {
    let curve = Curve { contours, ..Curve::default() };
    let template = template::solve(&curve, None, &[]).expect("a plain shape");
    let tree = Tree::new(&build::inflation(Drawing::default(), template.clone()));
    (template, tree)
}

/// How high the surface is over a place of the drawing, mm.
fn height(tree: &Tree, at: Vec2) -> f32 {
    let (mut low, mut high) = (0.0f32, 200.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        // The front of a drawing looks along y.
        if tree.value(Vec3::new(at.x, -middle, at.y)) >= ISO { low = middle } else { high = middle }
    }
    low
}

/// The normal of the surface over a place.
fn normal(tree: &Tree, at: Vec2) -> Vec3 {
    let sample = tree.sample(Vec3::new(at.x, -height(tree, at), at.y));
    -sample.gradient.normalize_or_zero()
}

#[test]
fn a_drawn_circle_becomes_a_ball() {
    let (_, tree) = inflated(vec![ring(400, |t| DVec2::new(7.0, -3.0) + 25.0 * DVec2::from_angle(TAU * t))]);
    // Volume: heights over rings of equal area.
    let (rings, around) = (200, 12);
    let mut sum = 0.0;
    for i in 0..rings * around {
        let r = 25.0 * ((f64::from(i / around) + 0.5) / f64::from(rings)).sqrt();
        let at =
            DVec2::new(7.0, -3.0) + r * DVec2::from_angle(TAU * f64::from(i % around) / f64::from(around));
        sum += 2.0 * f64::from(height(&tree, at.as_vec2()));
    }
    let volume = sum / f64::from(rings * around) * PI * 625.0;
    let ball = 4.0 / 3.0 * PI * 25f64.powi(3);
    assert!((volume / ball - 1.0).abs() < 5e-3, "{volume} for {ball}");
}

#[test]
fn a_drawn_strip_becomes_a_round_bar() {
    let sides =
        polygon(&[(-60.0, -5.0), (60.0, -5.0), (60.0, 5.0), (-60.0, 5.0)].map(|(x, y)| DVec2::new(x, y)));
    let (_, tree) = inflated(vec![sides]);
    for i in 0..400 {
        let at = Vec2::new(-40.0 + 0.2 * i as f32, 4.99 * (0.7 * i as f32).sin());
        let found = height(&tree, at).hypot(at.y);
        assert!((found / 5.0 - 1.0).abs() < 0.02, "{found} from the middle at {at}");
    }
}

#[test]
fn seen_along_the_normal_an_inflation_is_the_drawn_curve() {
    for (name, contours) in
        [("star", vec![star()]), ("with a hole", with_hole()), ("stadium", vec![stadium()])]
    {
        let (template, tree) = inflated(contours.clone());
        let corners = &template.corners;
        for points in contours.iter().map(|contour| &contour.points) {
            for i in 0..points.len() {
                let at = points[i].as_vec2();
                let along = (points[(i + 1) % points.len()] - points[i]).as_vec2().normalize_or_zero();
                // 0.5 % of 60 mm across the curve, on both sides; the solid is to its left.
                let inward = 0.3 * along.perp();
                let tip = corners.iter().any(|corner| corner.distance(at) < 0.6);
                let value = |p: Vec2| tree.value(Vec3::new(p.x, 0.0, p.y));
                assert!(value(at - inward) < ISO, "{name}: solid beyond {at}");
                assert!(tip || value(at + inward) > ISO, "{name}: empty within {at}");
            }
        }
    }
}

#[test]
fn nothing_has_ridges_away_from_sharp_corners() {
    for (name, contour) in [("star", star()), ("square", square())] {
        let (template, tree) = inflated(vec![contour]);
        let mut tried = 0;
        for i in 0..3000 {
            let turn = i as f32 * 2.399_963;
            let at = 28.0 * (i as f32 / 3000.0).sqrt() * Vec2::from_angle(turn);
            let clear = template.corners.iter().all(|corner| corner.distance(at) > 6.0);
            if !clear || template.distance.value(at) > -2.5 {
                continue;
            }
            tried += 1;
            // Two places 1 mm apart, of a drawing of 60 mm.
            let beside = at + 0.5 * Vec2::from_angle(3.0 * turn);
            let before = at - 0.5 * Vec2::from_angle(3.0 * turn);
            let bend = normal(&tree, before).angle_between(normal(&tree, beside)).to_degrees();
            assert!(bend < 20.0, "{name}: the normal turns by {bend}° at {at}");
        }
        assert!(tried > 400, "{name}: {tried}");
    }
}

#[test]
fn symmetric_drawings_have_symmetric_inflations() {
    let (_, tree) = inflated(vec![star()]);
    for i in 0..500 {
        let at = 20.0 * (i as f32 / 500.0) * Vec2::from_angle(i as f32);
        let here = height(&tree, at);
        let mirrored = height(&tree, Vec2::new(-at.x, at.y));
        let turned = height(&tree, Vec2::from_angle(TAU as f32 / 5.0).rotate(at));
        assert!(
            (here - mirrored).abs() < 0.1 && (here - turned).abs() < 0.1,
            "{here}, {mirrored}, {turned} at {at}"
        );
    }
}

#[test]
fn heights_grow_smoothly_from_limbs_to_bodies() {
    // A ball of 40 mm with an arm of 8.
    let body = |t: f64| 20.0 * DVec2::from_angle(TAU * t);
    let (from, to) = ((4.0f64 / 20.0).asin() / TAU, 1.0 - (4.0f64 / 20.0).asin() / TAU);
    let mut points: Vec<DVec2> = (0..200).map(|i| body(from + (to - from) * f64::from(i) / 200.0)).collect();
    points.extend((0..60).map(|i| DVec2::new(20.0 + f64::from(i), -4.0)));
    points.extend(
        (0..20).map(|i| DVec2::new(80.0, 0.0) + 4.0 * DVec2::from_angle(PI * (f64::from(i) / 20.0 - 0.5))),
    );
    points.extend((0..60).rev().map(|i| DVec2::new(20.0 + f64::from(i), 4.0)));
    let (_, tree) = inflated(vec![Contour { points, corners: Vec::new() }]);
    let along: Vec<f32> = (0..160).map(|i| height(&tree, Vec2::new(0.5 * i as f32, 0.0))).collect();
    assert!((along[0] - 20.0).abs() < 0.3, "{} in the middle of the body", along[0]);
    // √2 times as high as it is wide: as the arm's own strip, w √2 over a ball's r.
    assert!((5.4..6.0).contains(&along[110]), "{} on the arm", along[110]);
    for pair in along[..150].windows(2) {
        assert!(pair[1] < pair[0] + 0.02, "it rises outwards: {pair:?}");
    }
}
