//! Curves fitted to drawings.

mod drawn;

use blobtree::{Drawing, DrawnStroke, Holes};
use drawn::{Hand, around, circle, draw, hausdorff, loops, pieces, point, shapes, signed_area, size};
use glam::{DMat2, DVec2};
use sketch::curve::{Curve, NoOutline, fit, fit_open};
use std::f64::consts::{PI, TAU};

fn strokes(strokes: &[Vec<DVec2>]) -> Drawing {
    let stroke = |points: &Vec<DVec2>| DrawnStroke { points: points.iter().map(|&p| point(p)).collect() };
    Drawing { strokes: strokes.iter().map(stroke).collect(), ..Drawing::default() }
}

fn area(curve: &Curve) -> f64 {
    curve.contours.iter().map(|contour| signed_area(&contour.points)).sum()
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
        assert_eq!(pieces(&plain), (shape.outlines, shape.holes), "{}", shape.name);
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
fn corners_hidden_by_a_shaking_hand_are_found_unless_they_are_wished_round() {
    let inner = |k: u32| 8.8 * DVec2::from_angle(PI * (0.7 + 0.4 * f64::from(k)));
    for (name, expected, wished) in [("circle", 0, 0), ("ellipse", 0, 0), ("star", 10, 5)] {
        let shape = shapes().into_iter().find(|shape| shape.name == name).expect("there is one");
        for seed in 0..4 {
            let hand = Hand { samples: 250, noise: 0.005, backward: seed % 2 == 1, seed };
            let mut drawing = draw(&shape, hand, |p| 40. * p);
            let corners = |drawing: &Drawing| fit(drawing).expect("it closes").contours[0].corners.len();
            assert_eq!(corners(&drawing), expected, "{name}, seed {seed}");
            drawing.rounded.extend((0..5).map(|k| inner(k).as_vec2()));
            assert_eq!(corners(&drawing), wished, "{name} with places wished round, seed {seed}");
        }
    }
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
