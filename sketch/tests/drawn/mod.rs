//! Shapes drawn by a shaking hand, and how far a curve is from the shape that was drawn.

use blobtree::{Drawing, DrawnPoint, DrawnStroke};
use glam::DVec2;
use sketch::curve::Curve;
use std::f64::consts::{PI, TAU};

/// A shape of about size 1: its strokes as closed dense polygons, how many are outlines and how many are holes.
pub struct Shape {
    pub name: &'static str,
    pub loops: Vec<Vec<DVec2>>,
    pub outlines: usize,
    pub holes: usize,
}

pub fn around(count: usize, place: impl Fn(f64) -> DVec2) -> Vec<DVec2> {
    (0..count).map(|i| place(i as f64 / count as f64)).collect()
}

/// A polygon with points on its edges.
pub fn polygon(corners: &[[f64; 2]]) -> Vec<DVec2> {
    let corners: Vec<DVec2> = corners.iter().map(|&c| DVec2::from(c)).collect();
    resampled(&corners, 4000)
}

/// Places along a closed polygon, evenly spaced from its first point.
pub fn resampled(points: &[DVec2], count: usize) -> Vec<DVec2> {
    let n = points.len();
    let mut lengths = vec![0.];
    for i in 0..n {
        lengths.push(lengths[i] + points[i].distance(points[(i + 1) % n]));
    }
    let mut i = 0;
    let mut place = |length: f64| {
        while lengths[i + 1] < length {
            i += 1;
        }
        let share = (length - lengths[i]) / (lengths[i + 1] - lengths[i]);
        points[i].lerp(points[(i + 1) % n], share)
    };
    (0..count).map(|k| place(lengths[n] * k as f64 / count as f64)).collect()
}

fn arc(from: f64, to: f64, at: [f64; 2], radii: [f64; 2]) -> Vec<[f64; 2]> {
    let angle = |i: usize| from + (to - from) * i as f64 / 100.;
    (0..=100).map(|i| angle(i).sin_cos()).map(|(s, c)| [at[0] + radii[0] * c, at[1] + radii[1] * s]).collect()
}

pub fn circle(x: f64, y: f64, radius: f64) -> Vec<DVec2> {
    around(4000, |t| DVec2::new(x, y) + radius * DVec2::from_angle(TAU * t))
}

fn rounded_square() -> Vec<DVec2> {
    let corner = |k: usize| {
        let at = [[0.35, 0.35], [-0.35, 0.35], [-0.35, -0.35], [0.35, -0.35]][k];
        arc(k as f64 * PI / 2., (k + 1) as f64 * PI / 2., at, [0.15; 2])
    };
    polygon(&(0..4).flat_map(corner).collect::<Vec<_>>())
}

fn star() -> Vec<DVec2> {
    let corner = |k: usize| {
        let radius = if k.is_multiple_of(2) { 0.5 } else { 0.22 };
        (radius * DVec2::from_angle(PI / 2. + PI * k as f64 / 5.)).to_array()
    };
    polygon(&(0..10).map(corner).collect::<Vec<_>>())
}

/// The moon: two arcs that meet in two sharp tips.
fn crescent() -> Vec<DVec2> {
    let mut corners = arc(0.25 * PI, 1.75 * PI, [0., 0.], [0.5; 2]);
    let tip = 0.5 * (0.25 * PI).sin();
    let middle = 0.5 * (0.25 * PI).cos() + 0.15;
    let radius = tip.hypot(0.15);
    let half = tip.atan2(0.15);
    corners.extend(arc(-PI + half, -PI - half, [middle, 0.], [radius; 2]));
    polygon(&corners)
}

/// A band of three eighths of a turn for each eighth of its length, with square ends.
fn spiral() -> Vec<DVec2> {
    let at = |turn: f64, off: f64| ((0.12 + 0.14 * turn + off) * DVec2::from_angle(TAU * turn)).to_array();
    let turns = (0..=400).map(|i| 2.5 * f64::from(i) / 400.);
    let outer = turns.clone().map(|t| at(t, 0.025));
    polygon(&outer.chain(turns.rev().map(|t| at(t, -0.025))).collect::<Vec<_>>())
}

fn letter_a() -> Vec<Vec<DVec2>> {
    let outer = [
        [-0.4, -0.5],
        [-0.24, -0.5],
        [-0.16, -0.25],
        [0.16, -0.25],
        [0.24, -0.5],
        [0.4, -0.5],
        [0.09, 0.5],
        [-0.09, 0.5],
    ];
    vec![polygon(&outer), polygon(&[[-0.11, -0.11], [0.11, -0.11], [0., 0.26]])]
}

fn letter_b() -> Vec<Vec<DVec2>> {
    let half = PI / 2.;
    let mut outer = vec![[-0.3, -0.5]];
    outer.extend(arc(-half, 1.155, [0.08, -0.2], [0.3; 2]));
    outer.extend(arc(-1.016, half, [0.08, 0.27], [0.23; 2]).into_iter().skip(1));
    outer.push([-0.3, 0.5]);
    let bowl = |y: f64, height: f64, x: f64| {
        let mut bowl = vec![[-0.15, y - height]];
        bowl.extend(arc(-half, half, [x, y], [height; 2]));
        bowl.push([-0.15, y + height]);
        polygon(&bowl)
    };
    vec![polygon(&outer), bowl(-0.2, 0.15, 0.08), bowl(0.275, 0.1, 0.08)]
}

fn letter_r() -> Vec<Vec<DVec2>> {
    let half = PI / 2.;
    let mut outer = vec![
        [-0.3, -0.5],
        [-0.13, -0.5],
        [-0.13, -0.06],
        [0.0, -0.06],
        [0.16, -0.5],
        [0.35, -0.5],
        [0.15, -0.03],
    ];
    outer.extend(arc(-1.2, half, [0.06, 0.24], [0.26; 2]));
    outer.push([-0.3, 0.5]);
    let mut bowl = vec![[-0.13, 0.12]];
    bowl.extend(arc(-half, half, [0.04, 0.24], [0.12; 2]));
    bowl.push([-0.13, 0.36]);
    vec![polygon(&outer), polygon(&bowl)]
}

pub fn shapes() -> Vec<Shape> {
    let one = |name, outline| Shape { name, loops: vec![outline], outlines: 1, holes: 0 };
    let eight = around(4000, |t| {
        let (s, c) = (TAU * t + 0.4).sin_cos();
        DVec2::new(0.5 * c, 0.5 * s * c)
    });
    vec![
        one("circle", circle(0., 0., 0.5)),
        one("ellipse", around(4000, |t| DVec2::from_angle(TAU * t) * DVec2::new(0.5, 0.22))),
        one("rounded square", rounded_square()),
        one("star", star()),
        one("crescent", crescent()),
        one("spiral", spiral()),
        Shape { name: "figure of eight", loops: vec![eight], outlines: 2, holes: 0 },
        Shape { name: "A", loops: letter_a(), outlines: 1, holes: 1 },
        Shape { name: "B", loops: letter_b(), outlines: 1, holes: 2 },
        Shape { name: "O", loops: vec![circle(0., 0., 0.5), circle(0., 0., 0.3)], outlines: 1, holes: 1 },
        Shape { name: "R", loops: letter_r(), outlines: 1, holes: 1 },
    ]
}

/// How a shape is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    pub samples: usize,
    /// Farthest that a sample is off, of the shape's size.
    pub noise: f64,
    pub backward: bool,
    pub seed: u64,
}

pub fn size(shape: &Shape) -> f64 {
    let all = || shape.loops.iter().flatten().copied();
    let least = all().reduce(DVec2::min).expect("a shape has points");
    let most = all().reduce(DVec2::max).expect("a shape has points");
    (most - least).max_element()
}

/// Strokes along the loops, samples shared by length, each beginning anywhere and closing.
pub fn draw(shape: &Shape, hand: Hand, place: impl Fn(DVec2) -> DVec2) -> Drawing {
    let mut random = fastrand::Rng::with_seed(hand.seed);
    let length = |points: &[DVec2]| -> f64 {
        (0..points.len()).map(|i| points[i].distance(points[(i + 1) % points.len()])).sum()
    };
    let total: f64 = shape.loops.iter().map(|points| length(points)).sum();
    let size = size(shape);
    let stroke = |points: &Vec<DVec2>| {
        let count = ((hand.samples as f64 * length(points) / total) as usize).max(12);
        let mut turned = points.clone();
        turned.rotate_left(random.usize(0..points.len()));
        if hand.backward {
            turned.reverse();
        }
        let mut samples = resampled(&turned, count);
        samples.push(samples[0]);
        let mut off = || {
            let far = hand.noise * size * random.f64().sqrt();
            far * DVec2::from_angle(TAU * random.f64())
        };
        let points = samples.into_iter().map(|p| point(place(p + off()))).collect();
        DrawnStroke { points }
    };
    Drawing { strokes: shape.loops.iter().map(stroke).collect(), ..Drawing::default() }
}

pub fn point(at: DVec2) -> DrawnPoint {
    DrawnPoint { at: at.as_vec2(), pressure: 1., smoothing: 0. }
}

pub fn signed_area(points: &[DVec2]) -> f64 {
    let n = points.len();
    (0..n).map(|i| points[i].perp_dot(points[(i + 1) % n])).sum::<f64>() / 2.
}

pub fn pieces(curve: &Curve) -> (usize, usize) {
    let outlines = curve.contours.iter().filter(|c| signed_area(&c.points) > 0.).count();
    (outlines, curve.contours.len() - outlines)
}

fn distance_to(loops: &[Vec<DVec2>], at: DVec2) -> f64 {
    let to_segment = |a: DVec2, b: DVec2| {
        let along = b - a;
        let share = ((at - a).dot(along) / along.length_squared().max(1e-30)).clamp(0., 1.);
        (a + share * along).distance(at)
    };
    let segments = loops
        .iter()
        .flat_map(|points| (0..points.len()).map(|i| to_segment(points[i], points[(i + 1) % points.len()])));
    segments.fold(f64::INFINITY, f64::min)
}

/// The larger of the largest distances from either to the other.
pub fn hausdorff(a: &[Vec<DVec2>], b: &[Vec<DVec2>]) -> f64 {
    let one_way = |from: &[Vec<DVec2>], to: &[Vec<DVec2>]| {
        let places = from.iter().flat_map(|points| resampled(points, 700));
        places.map(|p| distance_to(to, p)).fold(0., f64::max)
    };
    let coarse = |loops: &[Vec<DVec2>]| -> Vec<Vec<DVec2>> { loops.iter().map(|l| thinned(l)).collect() };
    let (a, b) = (coarse(a), coarse(b));
    one_way(&a, &b).max(one_way(&b, &a))
}

/// Points less than a thousandth off straight lines left away, so that distances to many are quick.
fn thinned(points: &[DVec2]) -> Vec<DVec2> {
    let mut kept = vec![points[0]];
    let mut last = 0;
    for i in 1..points.len() {
        let next = points[(i + 1) % points.len()];
        let start = points[last];
        let far = |p: &DVec2| (next - start).normalize_or_zero().perp_dot(*p - start).abs();
        if points[last + 1..=i].iter().any(|p| far(p) > 2e-4) || i - last > 60 {
            kept.push(points[i]);
            last = i;
        }
    }
    kept
}

pub fn loops(curve: &Curve) -> Vec<Vec<DVec2>> {
    curve.contours.iter().map(|contour| contour.points.clone()).collect()
}
