//! Curves fitted to drawings, against the shapes that were drawn.

use blobtree::{Drawing, DrawnPoint, DrawnStroke, Holes};
use glam::{DMat2, DVec2};
use sketch::curve::{Curve, NoOutline, fit, fit_open};
use std::f64::consts::{PI, TAU};

/// A shape of about size 1: its strokes as closed dense polygons, how many are outlines and how many are holes.
struct Shape {
    name: &'static str,
    loops: Vec<Vec<DVec2>>,
    outlines: usize,
    holes: usize,
}

fn around(count: usize, place: impl Fn(f64) -> DVec2) -> Vec<DVec2> {
    (0..count).map(|i| place(i as f64 / count as f64)).collect()
}

/// A polygon with points on its edges.
fn polygon(corners: &[[f64; 2]]) -> Vec<DVec2> {
    let corners: Vec<DVec2> = corners.iter().map(|&c| DVec2::from(c)).collect();
    resampled(&corners, 4000)
}

/// Places along a closed polygon, evenly spaced from its first point.
fn resampled(points: &[DVec2], count: usize) -> Vec<DVec2> {
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

fn circle(x: f64, y: f64, radius: f64) -> Vec<DVec2> {
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

fn shapes() -> Vec<Shape> {
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
struct Hand {
    samples: usize,
    /// Farthest that a sample is off, of the shape's size.
    noise: f64,
    backward: bool,
    seed: u64,
}

fn size(shape: &Shape) -> f64 {
    let all = || shape.loops.iter().flatten().copied();
    let least = all().reduce(DVec2::min).expect("a shape has points");
    let most = all().reduce(DVec2::max).expect("a shape has points");
    (most - least).max_element()
}

/// Strokes along the loops, samples shared by length, each beginning anywhere and closing.
fn draw(shape: &Shape, hand: Hand, place: impl Fn(DVec2) -> DVec2) -> Drawing {
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

fn point(at: DVec2) -> DrawnPoint {
    DrawnPoint { at: at.as_vec2(), pressure: 1., smoothing: 0. }
}

fn strokes(strokes: &[Vec<DVec2>]) -> Drawing {
    let stroke = |points: &Vec<DVec2>| DrawnStroke { points: points.iter().map(|&p| point(p)).collect() };
    Drawing { strokes: strokes.iter().map(stroke).collect(), ..Drawing::default() }
}

fn signed_area(points: &[DVec2]) -> f64 {
    let n = points.len();
    (0..n).map(|i| points[i].perp_dot(points[(i + 1) % n])).sum::<f64>() / 2.
}

fn area(curve: &Curve) -> f64 {
    curve.contours.iter().map(|contour| signed_area(&contour.points)).sum()
}

fn pieces(curve: &Curve) -> (usize, usize) {
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
fn hausdorff(a: &[Vec<DVec2>], b: &[Vec<DVec2>]) -> f64 {
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

fn loops(curve: &Curve) -> Vec<Vec<DVec2>> {
    curve.contours.iter().map(|contour| contour.points.clone()).collect()
}

/// Every shape drawn by every hand; complains with all that is wrong.
fn judge(counts: &[usize], noise: f64, tolerance: impl Fn(&Shape) -> f64, seeds: u64) {
    let mut wrong = Vec::new();
    for shape in shapes().iter().filter(|shape| noise <= most_noise(shape)) {
        let truth: Vec<Vec<DVec2>> =
            shape.loops.iter().map(|l| l.iter().map(|&p| 40. * p).collect()).collect();
        for &samples in counts.iter().filter(|&&samples| samples >= fewest(shape, noise)) {
            for (seed, backward) in (0..seeds).flat_map(|seed| [(seed, false), (seed, true)]) {
                let hand = Hand { samples, noise, backward, seed };
                let complaint = match fit(&draw(shape, hand, |p| 40. * p)) {
                    Err(reason) => Some(reason.to_string()),
                    Ok(curve) if pieces(&curve) != (shape.outlines, shape.holes) => {
                        Some(format!("pieces and holes {:?}", pieces(&curve)))
                    }
                    Ok(curve) => {
                        let off = hausdorff(&truth, &loops(&curve)) / (40. * size(shape));
                        (off > tolerance(shape)).then(|| format!("off by {:.2} %", 100. * off))
                    }
                };
                wrong.extend(complaint.map(|complaint| format!("{}, {hand:?}: {complaint}", shape.name)));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

fn is_round(shape: &Shape) -> bool {
    ["circle", "ellipse", "O"].contains(&shape.name)
}

/// The fewest samples that say where a shape's corners and turns are.
fn fewest(shape: &Shape, noise: f64) -> usize {
    let clean = match shape.name {
        "circle" | "ellipse" => 30,
        "O" => 120,
        "rounded square" | "star" | "crescent" | "figure of eight" => 250,
        _ => 700,
    };
    let many = noise > 0.01 || noise > 0. && shape.name == "figure of eight";
    if many && !is_round(shape) { clean.max(700) } else { clean.max((noise * 6000.) as usize) }
}

/// A band of a twentieth has no ends left in noise that is nearly as wide.
fn most_noise(shape: &Shape) -> f64 {
    if shape.name == "spiral" { 0. } else { 1. }
}

const COUNTS: [usize; 5] = [30, 120, 250, 700, 2000];

/// The lobes of an eight are held apart where they would touch.
fn clean_tolerance(shape: &Shape) -> f64 {
    if shape.name == "figure of eight" { 0.01 } else { 0.005 }
}

#[test]
fn clean_drawings_give_the_shape() {
    judge(&COUNTS, 0., clean_tolerance, 2);
}

#[test]
fn drawings_with_half_a_percent_of_noise_give_the_shape_within_one_and_a_half() {
    judge(&COUNTS, 0.005, |_| 0.015, 2);
}

#[test]
fn drawings_with_two_percent_of_noise_give_round_shapes_within_one_and_a_half_and_others_within_two_and_a_half()
 {
    judge(&[700, 2000], 0.02, |shape| if is_round(shape) { 0.015 } else { 0.025 }, 2);
}

#[test]
fn moving_turning_and_scaling_strokes_does_the_same_to_the_curve() {
    let turn = DMat2::from_angle(0.7);
    for shape in shapes() {
        let hand = Hand { samples: 700, noise: 0., backward: false, seed: 5 };
        let plain = fit(&draw(&shape, hand, |p| 40. * p)).expect("it closes");
        let place = |p: DVec2| turn * (p * 3.) + DVec2::new(-500., 90.);
        let moved = fit(&draw(&shape, hand, |p| place(40. * p))).expect("it closes");
        let expected: Vec<Vec<DVec2>> =
            loops(&plain).into_iter().map(|l| l.into_iter().map(place).collect()).collect();
        let off = hausdorff(&expected, &loops(&moved)) / (120. * size(&shape));
        assert!(off < 0.01, "{}: off by {off}", shape.name);
        assert_eq!(pieces(&plain), pieces(&moved), "{}", shape.name);
    }
}

#[test]
fn how_many_samples_and_which_way_does_not_matter() {
    for shape in shapes() {
        let hand = Hand { samples: 700, noise: 0., backward: false, seed: 6 };
        let curve = |hand| fit(&draw(&shape, hand, |p| 40. * p)).expect("it closes");
        let plain = curve(hand);
        for other in [Hand { backward: true, ..hand }, Hand { samples: 1700, ..hand }] {
            let off = hausdorff(&loops(&plain), &loops(&curve(other))) / (40. * size(&shape));
            assert!(off < 0.01, "{}, {other:?}: off by {off}", shape.name);
        }
    }
}

#[test]
fn corners_are_found_and_only_there_and_obey() {
    let corners = |drawing: &Drawing| -> usize {
        fit(drawing).expect("it closes").contours.iter().map(|contour| contour.corners.len()).sum()
    };
    for (name, expected) in
        [("circle", 0), ("ellipse", 0), ("rounded square", 0), ("star", 10), ("crescent", 2)]
    {
        let shape = shapes().into_iter().find(|shape| shape.name == name).expect("there is one");
        for seed in 0..4 {
            let hand = Hand { samples: 700, noise: 0., backward: false, seed };
            assert_eq!(corners(&draw(&shape, hand, |p| 40. * p)), expected, "{name}, seed {seed}");
        }
    }
    let square = [[0., 0.], [30., 0.], [30., 30.], [0., 30.], [0., 0.]].map(DVec2::from).to_vec();
    let mut drawing = strokes(&[square]);
    assert_eq!(corners(&drawing), 4);
    drawing.rounded.push(glam::Vec2::new(29.5, 30.));
    assert_eq!(corners(&drawing), 3);
    drawing.sharpened.push(glam::Vec2::new(15., 0.));
    assert_eq!(corners(&drawing), 4);
}

#[test]
fn strokes_are_joined_gaps_closed_and_decorations_left_out() {
    let side = |a: [f64; 2], b: [f64; 2]| vec![DVec2::from(a), DVec2::from(a).midpoint(b.into()), b.into()];
    let house = strokes(&[
        side([0., 1.], [0., 40.]),
        side([39., 41.], [1., 41.]),
        side([40., 0.], [40., 42.]),
        side([41., 0.5], [-1., 0.]),
        side([10., 15.], [20., 17.]),
    ]);
    let curve = fit(&house).expect("the gaps are small");
    assert_eq!((pieces(&curve), &curve.left_out[..]), ((1, 0), &[4][..]));
    assert!((area(&curve) - 1620.).abs() < 50., "{}", area(&curve));
    let circle =
        |x: f64, radius: f64| around(60, |t| DVec2::new(x, 0.) + radius * DVec2::from_angle(6.4 * t));
    let mut rings = strokes(&[circle(0., 20.), circle(0., 10.), circle(0., 4.), circle(50., 8.)]);
    assert_eq!(pieces(&fit(&rings).expect("it closes")), (3, 1));
    rings.holes = Holes::Fill;
    assert_eq!(pieces(&fit(&rings).expect("it closes")), (2, 0));
}

#[test]
fn lines_thinned_out_to_their_bends_keep_their_corners_and_only_those() {
    let star = around(10, |t| {
        let radius = if ((10. * t).round() as usize).is_multiple_of(2) { 20. } else { 9. };
        radius * DVec2::from_angle(PI / 2. + TAU * t)
    });
    let closed = |mut points: Vec<DVec2>| {
        points.push(points[0]);
        points
    };
    let curve = fit(&strokes(&[closed(star.clone())])).expect("it closes");
    assert_eq!(curve.contours[0].corners.len(), 10);
    assert!(hausdorff(&[star], &loops(&curve)) < 0.01 * 40.);
    for count in 12..=20 {
        let ring = around(count, |t| 20. * DVec2::from_angle(TAU * t));
        let curve = fit(&strokes(&[closed(ring)])).expect("it closes");
        assert_eq!(curve.contours[0].corners, [0usize; 0], "{count} places");
        let off = hausdorff(&[circle(0., 0., 20.)], &loops(&curve)) / 40.;
        assert!(off < 0.0125, "{count} places: off by {off}");
    }
    // A wheel of a large drawing: so small that its seven places may be all that is left of a circle.
    let wheel = around(7, |t| DVec2::new(40., -20.) + 3. * DVec2::from_angle(TAU * t));
    let body = vec![[0., 0.], [60., 0.], [60., 20.], [0., 20.], [0., 0.]].into_iter().map(DVec2::from);
    let curve = fit(&strokes(&[body.collect(), closed(wheel)])).expect("both close");
    let corners: Vec<usize> = curve.contours.iter().map(|contour| contour.corners.len()).collect();
    assert_eq!(corners, [4, 0]);
}

#[test]
fn outlines_left_open_by_whoever_drew_are_closed_but_mouths_in_faces_are_not() {
    let line = |points: &[[f64; 2]]| points.iter().map(|&p| DVec2::from(p)).collect::<Vec<_>>();
    let cap = line(&[[12., 60.], [18., 60.], [18., 65.], [12., 65.], [12., 60.]]);
    let left = line(&[[12., 60.], [12., 45.], [5., 35.], [5., 0.]]);
    let right = line(&[[18., 60.], [18., 45.], [25., 35.], [25., 0.]]);
    let bottle = fit(&strokes(&[cap, left, right])).expect("its bottom can be closed");
    assert!((area(&bottle) - 950.).abs() < 20., "{}", area(&bottle));
    let face = around(60, |t| 20. * DVec2::from_angle(6.4 * t));
    let mouth = line(&[[-10., -4.], [-6., -10.], [0., -12.], [6., -10.], [10., -4.]]);
    let curve = fit(&strokes(&[face, mouth])).expect("the face closes");
    assert_eq!((pieces(&curve), &curve.left_out[..]), ((1, 0), &[1][..]));
    let bowl = line(&[[0., 20.], [1., 10.], [6., 2.], [15., 0.], [24., 2.], [29., 10.], [30., 20.]]);
    let stand = around(40, |t| DVec2::new(15., -30.) + DVec2::from_angle(6.4 * t) * DVec2::new(12., 3.));
    let glass = fit(&strokes(&[bowl, stand])).expect("both are parts");
    assert_eq!(pieces(&glass), (2, 0));
}

#[test]
fn a_small_detail_is_not_the_outline_of_a_large_open_line() {
    let wave = (0..60).map(|i| DVec2::new(f64::from(i), 6. * (0.2 * f64::from(i)).sin())).collect();
    let dot = around(30, |t| DVec2::new(30., 15.) + 3. * DVec2::from_angle(6.4 * t));
    assert!(matches!(fit(&strokes(&[wave, dot])), Err(NoOutline::Open { .. })));
}

#[test]
fn a_bow_tie_is_two_lobes_and_a_circle_drawn_twice_is_one_disc() {
    let tie = strokes(&[[[0., 0.], [20., 12.], [20., 0.], [0., 12.], [0., 0.]].map(DVec2::from).to_vec()]);
    let curve = fit(&tie).expect("it closes");
    assert_eq!(pieces(&curve), (2, 0));
    assert!((area(&curve) - 120.).abs() < 6., "{}", area(&curve));
    let twice = around(300, |t| (20. + (13. * t).sin()) * DVec2::from_angle(2.1 * TAU * t));
    let curve = fit(&strokes(&[twice])).expect("it closes");
    assert_eq!(pieces(&curve), (1, 0));
    assert!((area(&curve) / (PI * 400.) - 1.).abs() < 0.1, "{}", area(&curve));
}

#[test]
fn bad_input_gives_a_reason_or_a_shape() {
    let none = [f64::NAN, f64::INFINITY];
    assert_eq!(fit(&Drawing::default()), Err(NoOutline::Nothing));
    assert_eq!(fit(&strokes(&[vec![], vec![DVec2::from(none)]])), Err(NoOutline::Nothing));
    assert_eq!(fit(&strokes(&[vec![DVec2::ONE; 9]])), Err(NoOutline::Dots));
    let line = fit(&strokes(&[vec![DVec2::ZERO, DVec2::new(3., 4.)]]));
    assert!(matches!(line, Err(NoOutline::Open { gap }) if (gap - 5.).abs() < 1e-3), "{line:?}");
    let and_back = fit(&strokes(&[vec![DVec2::ZERO, DVec2::new(30., 0.), DVec2::new(0., 0.1)]]));
    assert_eq!(and_back, Err(NoOutline::Flat));
    let mut round = around(50, |t| 20. * DVec2::from_angle(TAU * t));
    round.insert(7, DVec2::from(none));
    assert_eq!(pieces(&fit(&strokes(&[round])).expect("the rest closes")), (1, 0));
}

#[test]
fn huge_and_wild_input_ends_soon() {
    let start = std::time::Instant::now();
    let million = around(1_000_000, |t| 20. * DVec2::from_angle(TAU * t));
    assert_eq!(pieces(&fit(&strokes(&[million])).expect("it closes")), (1, 0));
    let mut random = fastrand::Rng::with_seed(8);
    let mut place = || 100. * DVec2::new(random.f64(), random.f64());
    let scribble: Vec<DVec2> = (0..3000).map(|_| place()).collect();
    assert!(fit(&strokes(&[scribble])).is_ok());
    let many: Vec<Vec<DVec2>> = (0..5000).map(|_| vec![place(), place(), place()]).collect();
    let _either_way_is_fine = fit(&strokes(&many));
    let rings: Vec<Vec<DVec2>> = (0..3000)
        .map(|_| (place(), 0.7))
        .map(|(middle, radius)| around(20, |t| middle + radius * DVec2::from_angle(TAU * t)))
        .collect();
    assert!(fit(&strokes(&rings)).is_ok());
    assert!(start.elapsed().as_secs_f64() < 8., "{:?}", start.elapsed());
}

#[test]
fn an_open_line_keeps_its_ends() {
    let wave: Vec<DVec2> =
        (0..80).map(|i| DVec2::new(f64::from(i), 10. * (0.1 * f64::from(i)).sin())).collect();
    let lines = fit_open(&strokes(std::slice::from_ref(&wave)));
    assert_eq!(lines.len(), 1);
    assert!(lines[0][0].distance(wave[0]) < 0.5 && lines[0][lines[0].len() - 1].distance(wave[79]) < 0.5);
    assert!(lines[0].iter().all(|p| (p.y - 10. * (0.1 * p.x).sin()).abs() < 0.5));
}
