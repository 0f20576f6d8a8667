use super::*;
use glam::Vec2;

/// A bulge over a distance that is known in closed form, on an image of this many samples.
fn bulge_of(half: Vec2, falloff: f32, pixel: f32, distance: impl Fn(Vec2) -> f32, depth: f32) -> FieldImage {
    let origin = -(half + falloff + 3.0 * pixel);
    let size = (-2.0 * origin / pixel).ceil().to_array().map(|n| n as usize + 1);
    let place = |i: usize| origin + pixel * Vec2::new((i % size[0]) as f32, (i / size[0]) as f32);
    let samples: Vec<f32> = (0..size[0] * size[1]).map(|i| distance(place(i))).collect();
    let exact: Vec<f64> = samples.iter().map(|d| f64::from(*d)).collect();
    let image = FieldImage::new(origin, pixel, size, samples).expect("a legal image");
    bulge(&image, &exact, depth, falloff).expect("a bulge")
}

#[test]
fn a_disc_becomes_a_ball_inside_and_outside() {
    for (radius, pixel) in [(10.0, 0.1), (10.0, 0.37), (300.0, 9.0), (0.01, 0.0004)] {
        let falloff = 1.2 * radius;
        let at = 0.03 * Vec2::splat(radius);
        let image = bulge_of(Vec2::splat(1.1 * radius), falloff, pixel, |p| p.distance(at) - radius, radius);
        for i in 0..2000 {
            let p = at + Vec2::from_angle(i as f32) * radius * 2.1 * (i as f32 / 2000.0);
            let exact = (radius - p.distance(at)) * (radius + p.distance(at));
            let off = (image.value(p) - exact).abs() / (radius * radius);
            assert!(off < 2e-3, "{off} at {p}, radius {radius}");
        }
    }
}

#[test]
fn a_strip_becomes_a_round_bar_inside_and_outside() {
    let (width, length, falloff) = (5.0, 120.0, 6.0);
    let distance = |p: Vec2| {
        let along = (p.x.abs() - length).max(0.0);
        p.y.hypot(along) - width
    };
    let image = bulge_of(Vec2::new(length + width, width), falloff, 0.3, distance, width);
    for i in 0..500 {
        let p = Vec2::new(-60.0 + 0.23 * i as f32, 10.5 * (i as f32).sin());
        let exact = (width - p.y) * (width + p.y);
        assert!((image.value(p) - exact).abs() < 0.1, "{} for {exact} at {p}", image.value(p));
    }
}

#[test]
fn the_equation_holds_inside_a_shape_with_necks_and_thin_parts() {
    // A disc, a bar two pixels wide, a bar of one and a half, and a disc beyond.
    let distance = |p: Vec2| {
        let discs = (p.distance(Vec2::new(-30.0, 0.0)) - 20.0).min(p.distance(Vec2::new(30.0, 3.0)) - 12.0);
        let bar = |y: f32, half: f32| ((p.x.abs() - 40.0).max((p.y - y).abs() - half)).max(-100.0);
        discs.min(bar(0.3, 0.52)).min(bar(6.1, 0.37))
    };
    let [width, height] = [300, 140];
    let pixel = 0.5;
    let place =
        |i: usize| pixel * (Vec2::new((i % width) as f32, (i / width) as f32) - Vec2::new(150.0, 70.0));
    let nodes: Vec<f32> = (0..width * height).map(|i| distance(place(i)) / pixel).collect();
    let solution = Poisson::new(&nodes, [width, height]).solve();
    let highest = solution.iter().copied().fold(0.0, f32::max);
    // The larger disc alone has the square of its radius.
    assert!((1595.0..1800.0).contains(&highest), "{highest}");
    let (mut worst, mut sum, mut count) = (0.0f32, 0.0, 0);
    for i in width..width * (height - 1) {
        let beside = [i - 1, i + 1, i - width, i + width];
        assert!(solution[i] == 0.0 || nodes[i] < 0.0);
        if nodes[i] < 0.0 && beside.iter().all(|n| nodes[*n] < 0.0) {
            let left = 4.0 + beside.iter().map(|n| solution[*n]).sum::<f32>() - 4.0 * solution[i];
            worst = worst.max(left.abs());
            (sum, count) = (sum + left.abs(), count + 1);
        }
    }
    let mean = sum / count as f32;
    assert!(worst < 0.7 && mean < 0.02, "{worst} at worst, {mean} on average");
}

#[test]
fn outside_it_falls_all_the_way_and_ends_where_the_distance_says() {
    for slope in [0.0, 0.5, 2.0, 6.0] {
        for felt in [0.05, 1.0, 4.0] {
            let at = |i: i32| below(0.01 * felt * i as f32, slope, 1.0, felt);
            assert_eq!(at(0), 0.0);
            for i in 0..200 {
                assert!(at(i + 1) < at(i), "slope {slope}, felt to {felt}: {} after {}", at(i + 1), at(i));
            }
            let far = 1.5 * felt;
            assert!((below(far, slope, 1.0, felt) - (1.0 - (1.0 + far).powi(2))).abs() < 1e-5);
        }
    }
}

#[test]
fn what_the_image_cannot_show_still_gets_a_bulge() {
    let image = bulge_of(Vec2::splat(1.0), 1.0, 0.5, |_| 0.3, 0.01);
    assert!(image.samples().iter().all(|x| *x <= 0.0));
}

#[test]
fn slits_that_coarser_levels_do_not_see_leave_the_height_bounded() {
    // A disc with three narrow wedges cut into it, as between the fingers of a hand.
    let [width, height] = [700, 700];
    let radius = 330.0;
    for slope in [0.02, 0.05, 0.1] {
        let distance = |p: Vec2| {
            let wedge =
                |x: f32| (slope * (p.y + 0.3 * radius) - (p.x - x).abs()) / (1.0 + slope * slope).sqrt();
            let wedges = [-140.3, -20.6, 110.1].map(wedge).into_iter().fold(f32::MIN, f32::max);
            (p.length() - radius).max(wedges)
        };
        let place = |i: usize| Vec2::new((i % width) as f32, (i / width) as f32) - Vec2::splat(350.0);
        let nodes: Vec<f32> = (0..width * height).map(|i| distance(place(i))).collect();
        let solution = Poisson::new(&nodes, [width, height]).solve();
        // The disc without slits has the square of its radius.
        let [least, most] = [f32::min, f32::max].map(|of| solution.iter().copied().fold(0.0, of));
        assert!(least > -1.0 && most < radius * radius, "{least} to {most} with slope {slope}");
        assert!(most > 0.2 * radius * radius, "{most} with slope {slope}");
    }
}
