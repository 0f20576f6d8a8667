use super::*;
use crate::curve::Contour;
use std::f64::consts::{PI, TAU};

/// A curve of rings given by functions of the turn, corners where a polygon is asked for.
fn ring(n: usize, at: impl Fn(f64) -> DVec2) -> Contour {
    Contour { points: (0..n).map(|i| at(i as f64 / n as f64)).collect(), corners: Vec::new() }
}

fn disc(centre: DVec2, radius: f64) -> Contour {
    ring(400, |t| centre + radius * DVec2::from_angle(TAU * t))
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

fn square(half: f64) -> Contour {
    polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| half * DVec2::new(x, y)))
}

fn star(points: usize, outer: f64, inner: f64) -> Contour {
    let corner = |i: usize| {
        let angle = PI * i as f64 / points as f64;
        DVec2::from_angle(angle) * if i.is_multiple_of(2) { outer } else { inner }
    };
    polygon(&(0..2 * points).map(corner).collect::<Vec<_>>())
}

fn hole(mut contour: Contour) -> Contour {
    let n = contour.points.len();
    contour.points.reverse();
    contour.corners = contour.corners.iter().rev().map(|i| n - 1 - i).collect();
    contour
}

fn curve(contours: Vec<Contour>) -> Curve {
    Curve { contours, ..Curve::default() }
}

fn spiral() -> Contour {
    let arm = |t: f64, side: f64| DVec2::from_angle(5.0 * PI * t) * (8.0 + 40.0 * t + 2.5 * side);
    let mut points: Vec<DVec2> = (0..600).map(|i| arm(f64::from(i) / 600.0, 1.0)).collect();
    let cap = |t: f64, turn: f64| {
        let (middle, rim) = (arm(t, 0.0), arm(t, 1.0) - arm(t, 0.0));
        (0..20).map(move |i| middle + DVec2::from_angle(PI * (f64::from(i) / 20.0) + turn).rotate(rim))
    };
    points.extend(cap(1.0, 0.0));
    points.extend((0..600).rev().map(|i| arm((f64::from(i) + 0.5) / 600.0, -1.0)));
    points.extend(cap(0.0, PI));
    Contour { points, corners: Vec::new() }
}

fn shapes() -> Vec<(&'static str, Curve)> {
    let wavy = |t: f64| {
        let angle = TAU * t;
        DVec2::from_angle(angle) * (55.0 + 10.0 * (3.0 * angle).cos() + 6.0 * (5.0 * angle).sin())
    };
    vec![
        ("disc", curve(vec![disc(DVec2::new(5.0, -8.0), 20.0)])),
        ("ellipse", curve(vec![ring(500, |t| DVec2::new(40.0, 12.0) * DVec2::from_angle(TAU * t))])),
        ("wavy", curve(vec![ring(800, wavy)])),
        ("square", curve(vec![square(10.0)])),
        ("star", curve(vec![star(5, 30.0, 12.0)])),
        ("ring", curve(vec![disc(DVec2::ZERO, 30.0), hole(disc(DVec2::new(4.0, 0.0), 15.0))])),
        ("frame", curve(vec![square(20.0), hole(square(12.0))])),
        ("two", curve(vec![disc(DVec2::ZERO, 10.0), square(5.0).moved(DVec2::new(25.0, 0.0))])),
        ("spiral", curve(vec![spiral()])),
    ]
}

impl Contour {
    fn moved(mut self, by: DVec2) -> Self {
        self.points.iter_mut().for_each(|p| *p += by);
        self
    }
}

/// What a solved template is judged by.
struct Judged {
    name: &'static str,
    template: Template,
    outline: Outline,
    samples: Samples,
    size: f64,
}

impl Judged {
    fn all(falloff: Option<f32>) -> Vec<Self> {
        let judge = |(name, curve): (&'static str, Curve)| {
            let template = solve(&curve, falloff, &[]).expect("a plain shape");
            let points = || curve.contours.iter().flat_map(|c| &c.points).copied();
            let extent = points().fold(DVec2::MIN, DVec2::max) - points().fold(DVec2::MAX, DVec2::min);
            let size = extent.max_element();
            let samples = Samples::new(&curve, size);
            Self { name, template, outline: Outline::new(&curve), samples, size }
        };
        shapes().into_iter().map(judge).collect()
    }

    /// The exact distance, and the image's with its gradient, at places four to a pixel.
    fn places(&self) -> impl Iterator<Item = (DVec2, f64, f64, DVec2)> {
        let image = &self.template.distance;
        let [width, height] = image.size();
        let pixel = f64::from(image.pixel());
        let grid = Grid {
            origin: image.origin().as_dvec2() + 0.77 * pixel,
            pixel: 0.93 * pixel,
            size: [width - 2, height - 2],
        };
        let exact = self.outline.image(&grid, f64::INFINITY);
        exact.into_iter().enumerate().map(move |(i, exact)| {
            let p = grid.at(i % grid.size[0], i / grid.size[0]);
            let (value, gradient) = image.value_and_gradient(p.as_vec2());
            (p, exact, f64::from(value), gradient.as_dvec2())
        })
    }
}

#[test]
fn the_zero_contour_stays_by_the_curve_both_ways() {
    for judged in Judged::all(None) {
        let Judged { name, size, template, .. } = &judged;
        let pixel = f64::from(template.distance.pixel());
        for (p, exact, value, _) in judged.places() {
            if (value < 0.0) != (exact < 0.0) {
                assert!(exact.abs() < 2e-3 * size, "{name}: sign of {value} at {p}, {exact} from the curve");
            }
        }
        let mut on_curve: f64 = 0.0;
        for p in template.contours.iter().flatten() {
            let corner = template.corners.iter().map(|c| c.distance(*p)).fold(f32::INFINITY, f32::min);
            let off = f64::from(template.distance.value(*p)).abs();
            assert!(off < 1.0 * pixel, "{name}: {off} on the curve at {p}, pixel {pixel}");
            if f64::from(corner) > 3.0 * pixel {
                on_curve = on_curve.max(off / size);
            }
        }
        assert!(on_curve < 1.5e-3, "{name}: {on_curve} of the size");
    }
}

#[test]
fn the_distance_is_at_least_the_falloff_beyond_it() {
    for falloff in [None, Some(1.0), Some(40.0)] {
        for judged in Judged::all(falloff) {
            let falloff = f64::from(judged.template.falloff);
            for (p, exact, value, _) in judged.places() {
                assert!(exact < falloff || value >= falloff * 0.999_999, "{}: {value} at {p}", judged.name);
            }
            let image = &judged.template.distance;
            let ([width, height], samples) = (image.size(), image.samples());
            let border = |i: &usize| {
                let (x, y) = (i % width, i / width);
                x == 0 || y == 0 || x == width - 1 || y == height - 1
            };
            let least = (0..width * height).filter(border).map(|i| samples[i]).fold(f32::INFINITY, f32::min);
            assert!(f64::from(least) >= falloff, "{}: {least} at the border", judged.name);
        }
    }
}

#[test]
fn the_gradient_is_about_one_between_the_contours_away_from_corners_and_kinks() {
    for judged in Judged::all(None) {
        let levels = Levels::new(f64::from(judged.template.depth), None);
        let (mut worst, mut all) = (0.0f64, 0usize);
        for (p, exact, _, gradient) in judged.places().step_by(7) {
            if exact > levels.falloff || exact < -levels.inner {
                continue;
            }
            // Away from the medial axis: on the nearer half of the way to it.
            let nearest = judged
                .samples
                .samples
                .iter()
                .min_by(|a, b| a.at.distance_squared(p).total_cmp(&b.at.distance_squared(p)));
            let smooth = nearest.filter(|sample| sample.normal.is_some());
            let room = smooth.map_or(0.0, |sample| sample.room[usize::from(exact > 0.0)]);
            let near_corner =
                judged.template.corners.iter().any(|c| c.as_dvec2().distance(p) < 0.6 * levels.depth);
            if near_corner || exact.abs() > 0.5 * room {
                continue;
            }
            all += 1;
            let off = (gradient.length() - 1.0).abs();
            worst = worst.max(off);
        }
        assert!(all > 100 && worst < 0.25, "{}: gradient off by {worst}", judged.name);
    }
}

#[test]
fn the_gradient_does_not_jump_between_the_cells_of_the_image() {
    for judged in Judged::all(None) {
        let image = &judged.template.distance;
        let (origin, pixel) = (image.origin().as_dvec2(), f64::from(image.pixel()));
        let [width, height] = image.size();
        for i in (0..(width - 3) * (height - 3)).step_by(11) {
            let cell = DVec2::new((1 + i % (width - 3)) as f64, (1 + i / (width - 3)) as f64);
            for (across, along) in [(DVec2::X, DVec2::Y), (DVec2::Y, DVec2::X)] {
                let border = cell + 0.5 * across + 0.3 * along;
                let [before, after] = [-1e-3, 1e-3].map(|step| {
                    let p = origin + pixel * (border + step * across);
                    image.value_and_gradient(p.as_vec2()).1
                });
                let jump = before.distance(after);
                assert!(jump < 0.05, "{}: {before} and {after} at {border}", judged.name);
            }
        }
    }
}

#[test]
fn corners_are_round_by_less_than_a_pixel() {
    for (name, curve) in [("square", curve(vec![square(10.0)])), ("star", curve(vec![star(5, 30.0, 12.0)]))] {
        let template = solve(&curve, None, &[]).expect("a plain shape");
        let pixel = f64::from(template.distance.pixel());
        let samples = Samples::new(&curve, 20.0);
        assert_eq!(samples.corners.len(), template.corners.len());
        for corner in &samples.corners {
            let [back, forth] = [corner.before, corner.after].map(|p| (p - corner.at).normalize());
            let bisector = (back + forth).normalize();
            let convex = (-back).perp_dot(forth) > 0.0;
            for (step, inside) in [(1.0, convex), (-1.0, !convex)] {
                let p = corner.at + step * pixel * bisector;
                let value = template.distance.value(p.as_vec2());
                assert!((value < 0.0) == inside, "{name}: {value} a pixel from the corner {}", corner.at);
            }
        }
    }
}

#[test]
fn the_depth_is_the_largest_distance_inside() {
    for (curve, depth) in [
        (curve(vec![disc(DVec2::ZERO, 20.0)]), 20.0),
        (curve(vec![square(10.0)]), 10.0),
        (curve(vec![square(20.0), hole(square(12.0))]), 8.0 * (2.0 - 2f64.sqrt())),
    ] {
        let template = solve(&curve, None, &[]).expect("a plain shape");
        assert!((f64::from(template.depth) - depth).abs() < 2e-3 * depth, "{} for {depth}", template.depth);
        let least = template.distance.samples().iter().copied().fold(f32::INFINITY, f32::min);
        assert!((-least / template.depth - 1.0).abs() < 0.15, "{least} for {depth}");
    }
}

#[test]
fn moving_turning_and_scaling_the_curve_does_the_same_to_the_field() {
    let map = |p: DVec2| DVec2::new(100.0, 30.0) + 3.0 * DVec2::from_angle(0.6).rotate(p);
    for contours in [vec![star(5, 30.0, 12.0)], vec![disc(DVec2::ZERO, 30.0), hole(square(8.0))]] {
        let mut moved = contours.clone();
        moved.iter_mut().flat_map(|c| &mut c.points).for_each(|p| *p = map(*p));
        let [here, there] = [contours, moved].map(|c| solve(&curve(c), None, &[]).expect("a plain shape"));
        for i in 0..400 {
            let p = DVec2::from_angle(f64::from(i)) * f64::from(i) * 0.1;
            let value = f64::from(here.distance.value(p.as_vec2()));
            let miss = f64::from(there.distance.value(map(p).as_vec2())) / 3.0 - value;
            let beyond = value >= f64::from(here.falloff);
            assert!(beyond || miss.abs() < 0.3 + 0.1 * value.abs(), "{miss} at {p}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_template() {
    let shape = curve(vec![star(5, 30.0, 12.0), hole(disc(DVec2::ZERO, 5.0))]);
    let [one, many] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        pool.install(|| solve(&shape, None, &[(DVec2::ZERO, 0.1), (DVec2::X, 0.9)]).expect("a plain shape"))
    });
    assert!(one == many);
}

#[test]
fn hopeless_curves_are_refused_with_a_reason() {
    let refused = |contours, falloff| solve(&curve(contours), falloff, &[]).expect_err("hopeless");
    let line = |points: &[(f64, f64)]| Contour {
        points: points.iter().map(|&(x, y)| DVec2::new(x, y)).collect(),
        corners: vec![0, 1, 7],
    };
    assert_eq!(refused(vec![], None), NoTemplate::Empty);
    assert_eq!(refused(vec![line(&[(0.0, 0.0), (1.0, 0.0)])], None), NoTemplate::Empty);
    assert_eq!(
        refused(vec![line(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 0.0)])], None),
        NoTemplate::Empty
    );
    assert_eq!(refused(vec![line(&[(1.0, 1.0); 20])], None), NoTemplate::Empty);
    let bad = vec![square(1.0), line(&[(0.0, 0.0), (f64::NAN, 0.0), (0.0, 1.0)])];
    assert_eq!(refused(bad, None), NoTemplate::BadPoint { contour: 1 });
    for falloff in [0.0, -1.0, 40.0, f32::INFINITY] {
        let refused = refused(vec![square(1.0)], Some(falloff));
        assert!(matches!(refused, NoTemplate::Falloff { .. }), "{refused}");
    }
    let many = ring(20_001, |t| DVec2::from_angle(TAU * t));
    assert!(matches!(refused(vec![many], None), NoTemplate::TooManyPoints { .. }));
    let grid = |i: usize| disc(DVec2::new((i % 40) as f64, (i / 40) as f64), 0.3);
    let thinned =
        |i| Contour { points: grid(i).points.into_iter().step_by(40).collect(), corners: Vec::new() };
    assert!(matches!(refused((0..1001).map(thinned).collect(), None), NoTemplate::TooManyParts { .. }));
}

#[test]
fn whatever_is_scribbled_gives_a_finite_field_or_a_reason() {
    for seed in 0..40 {
        let random = &mut fastrand::Rng::with_seed(seed);
        let scale = 10f64.powi(random.i32(-3..4));
        let mut contour = || {
            let n = random.usize(3..40);
            let points = (0..n).map(|_| scale * DVec2::new(random.f64(), random.f64())).collect();
            Contour { points, corners: (0..n).filter(|_| random.u8(..) < 60).collect() }
        };
        let contours = [contour(), contour()].to_vec();
        let falloff = random.bool().then(|| (scale * random.f64()) as f32 + 1e-6);
        let options = Options { pixels: 64 };
        match solve_with(&curve(contours), falloff, &[], &options) {
            Ok(template) => {
                assert!(template.distance.samples().iter().all(|x| x.is_finite()), "seed {seed}");
                assert!(template.depth > 0.0 && template.falloff > 0.0, "seed {seed}");
            }
            Err(reason) => assert!(!reason.to_string().is_empty(), "seed {seed}"),
        }
    }
}

#[test]
fn many_small_pieces_are_all_there() {
    let blob = |i: usize| disc(DVec2::new((i % 15) as f64 * 3.0, (i / 15) as f64 * 3.0), 1.0);
    let contours: Vec<Contour> = (0..150).map(blob).collect();
    let thin = |c: Contour| Contour { points: c.points.into_iter().step_by(10).collect(), ..c };
    let template = solve(&curve(contours.into_iter().map(thin).collect()), None, &[]).expect("plain discs");
    for i in 0..150 {
        let centre = DVec2::new((i % 15) as f64 * 3.0, (i / 15) as f64 * 3.0);
        assert!(template.distance.value(centre.as_vec2()) < -0.5, "piece {i}");
        assert!(template.distance.value((centre + 1.5).as_vec2()) > 0.3, "beside piece {i}");
    }
}
