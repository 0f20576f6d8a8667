use super::*;
use fastrand::Rng;

/// Constraints on a wavy closed curve and along offsets of it.
fn wavy(n: usize) -> Vec<Constraint> {
    let m = n / 6;
    let mut constraints = Vec::new();
    for offset in [0.0, 0.01, -0.01, 0.12, -0.06, -0.12] {
        for i in 0..m {
            let shift = if offset == 0.0 { 0.0 } else { 0.5 };
            let t = std::f64::consts::TAU * (i as f64 + shift) / m as f64;
            let r = 0.55 + 0.10 * (3.0 * t).cos() + 0.06 * (5.0 * t).sin();
            let slope = -0.30 * (3.0 * t).sin() + 0.30 * (5.0 * t).cos();
            let out = DVec2::from_angle(t);
            let normal = (out * r - out.perp() * slope).normalize();
            constraints.push(Constraint { at: out * r + normal * offset, value: offset, smoothing: 0.0 });
        }
    }
    constraints
}

fn scattered(random: &mut Rng, n: usize) -> Vec<Constraint> {
    let mut constraint = || Constraint {
        at: DVec2::new(random.f64(), random.f64()),
        value: random.f64() - 0.5,
        smoothing: 0.0,
    };
    (0..n).map(|_| constraint()).collect()
}

#[test]
fn the_spline_takes_the_values_it_is_given() {
    for n in [3, 4, 10, 60, 198, 600, 1800, 3000usize] {
        let constraints = wavy(6 * n.div_ceil(6));
        let spline = ThinPlate::fit(&constraints[..n.min(constraints.len())]).expect("enough places");
        for c in constraints.iter().take(n) {
            let miss = (spline.value(c.at) - c.value).abs();
            assert!(miss < 1e-8, "{n}: misses by {miss} at {}", c.at);
        }
    }
}

#[test]
fn affine_values_give_the_affine_function_whatever_the_smoothing() {
    let function = |p: DVec2| 3.0 - 2.0 * p.x + 0.5 * p.y;
    for seed in 0..20 {
        let random = &mut Rng::with_seed(seed);
        let mut constraints = scattered(random, 50);
        for c in &mut constraints {
            c.value = function(c.at);
            c.smoothing = if random.bool() { random.f64() } else { 0.0 };
        }
        let spline = ThinPlate::fit(&constraints).expect("places in general position");
        for p in [DVec2::splat(0.3), DVec2::new(-5.0, 7.0)] {
            assert!((spline.value(p) - function(p)).abs() < 1e-8, "seed {seed}");
            assert!((spline.gradient(p) - DVec2::new(-2.0, 0.5)).length() < 1e-8, "seed {seed}");
        }
    }
}

#[test]
fn moving_turning_and_scaling_the_places_does_the_same_to_the_spline() {
    let map = |p: DVec2| DVec2::new(40.0, -7.0) + 250.0 * DVec2::from_angle(0.7).rotate(p);
    for seed in 0..20 {
        let random = &mut Rng::with_seed(seed);
        let mut constraints = scattered(random, 80);
        constraints.iter_mut().for_each(|c| c.smoothing = 1e-3 * random.f64());
        let moved: Vec<_> = constraints.iter().map(|c| Constraint { at: map(c.at), ..*c }).collect();
        let [spline, other] = [constraints, moved].map(|c| ThinPlate::fit(&c).expect("general position"));
        for _ in 0..20 {
            let p = DVec2::new(random.f64(), random.f64());
            assert!((spline.value(p) - other.value(map(p))).abs() < 1e-9, "seed {seed}");
        }
    }
}

#[test]
fn smoothing_goes_from_the_values_to_their_affine_mean() {
    let constraints = scattered(&mut Rng::with_seed(3), 100);
    let roughness = |smoothing: f64| {
        let smoothed: Vec<_> = constraints.iter().map(|c| Constraint { smoothing, ..*c }).collect();
        let spline = ThinPlate::fit(&smoothed).expect("general position");
        constraints.iter().map(|c| (spline.value(c.at) - c.value).powi(2)).sum::<f64>()
    };
    let misses = [0.0, 1e-5, 1e-3, 1e-1, 1e3].map(roughness);
    assert!(misses.is_sorted() && misses[0] < 1e-16 && misses[4] > 4.0, "{misses:?}");
}

#[test]
fn the_gradient_is_the_slope_of_the_value() {
    for n in [120, 1800] {
        let spline = ThinPlate::fit(&wavy(n)).expect("a fair curve");
        let random = &mut Rng::with_seed(9);
        for _ in 0..200 {
            let p = DVec2::new(random.f64() * 2.0 - 1.0, random.f64() * 2.0 - 1.0);
            let h = 1e-5;
            let slope = [DVec2::X, DVec2::Y]
                .map(|axis| (spline.value(p + h * axis) - spline.value(p - h * axis)) / (2.0 * h));
            let miss = (spline.gradient(p) - DVec2::from(slope)).length();
            assert!(miss < 2e-4, "{n}: {miss} at {p}");
        }
    }
}

#[test]
fn a_grid_holds_the_same_values_as_place_by_place() {
    for (n, size) in [(60, [40, 70]), (600, [300, 200]), (1800, [260, 260])] {
        let spline = ThinPlate::fit(&wavy(n)).expect("a fair curve");
        let grid = Grid { origin: DVec2::new(-1.1, -0.9), pixel: 2.2 / size[0] as f64, size };
        let samples = spline.sample_grid(&grid);
        for (i, sample) in samples.iter().enumerate().step_by(37) {
            let exact = spline.value(grid.at(i % size[0], i / size[0]));
            assert!((f64::from(*sample) - exact).abs() < 1e-6, "{n}, sample {i}: {sample} for {exact}");
        }
    }
}

#[test]
fn patches_differ_little_from_the_whole_spline_and_join_smoothly() {
    let dense = wavy(3000);
    let whole = ThinPlate::fit(&dense.iter().copied().step_by(3).collect::<Vec<_>>()).expect("fair");
    let patched = ThinPlate::fit(&dense).expect("fair");
    assert!(patched.patches.len() > 4 && whole.patches.len() == 1);
    let random = &mut Rng::with_seed(5);
    for _ in 0..1000 {
        // Between the outermost and the innermost constraints, where both know the field.
        let (c, share) = (dense[random.usize(500..1000)].at, random.f64());
        let p = c * (1.0 + 0.15 * (2.0 * share - 1.0));
        let total: f64 = patched.patches.iter().map(|patch| patch.share(patched.inside(p)).0).sum();
        assert!((total - 1.0).abs() < 1e-12);
        let miss = (patched.value(p) - whole.value(p)).abs();
        assert!(miss < 2e-3, "{miss} at {p}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let constraints = wavy(1800);
    let image = |threads: usize| -> Vec<u32> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        let grid = Grid { origin: DVec2::splat(-1.0), pixel: 0.01, size: [200, 200] };
        let samples = pool.install(|| ThinPlate::fit(&constraints).map(|s| s.sample_grid(&grid)));
        samples.expect("fair").into_iter().map(f32::to_bits).collect()
    };
    assert!(image(1) == image(3));
}

#[test]
fn hopeless_input_is_refused_with_a_reason() {
    let at = |x: f64, y: f64| Constraint { at: DVec2::new(x, y), value: 1.0, smoothing: 0.0 };
    let error = |constraints: &[Constraint]| ThinPlate::fit(constraints).expect_err("hopeless");
    assert_eq!(error(&[]), FitError::TooFew { found: 0 });
    assert_eq!(error(&[at(1.0, 2.0); 9]), FitError::TooFew { found: 1 });
    assert_eq!(error(&[at(0.0, 0.0), at(1.0, 0.0), at(0.0, 0.0)]), FitError::TooFew { found: 2 });
    let line: Vec<_> = (0..2000).map(|i| at(f64::from(i), 2.0 * f64::from(i))).collect();
    assert_eq!(error(&line[..50]), FitError::OnALine);
    assert_eq!(error(&line), FitError::OnALine);
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(error(&[at(0.0, 0.0), at(bad, 0.0), at(0.0, 1.0)]), FitError::BadNumber { index: 1 });
    }
    assert!(matches!(error(&vec![at(0.0, 0.0); 4001]), FitError::TooMany { .. }));
    let huge = [at(1e200, 0.0), at(-1e200, 0.0), at(0.0, 1e200), at(1e308, -1e308)];
    let _ = ThinPlate::fit(&huge);
}

#[test]
fn the_same_place_twice_counts_as_one_with_the_mean_value() {
    let mut constraints = scattered(&mut Rng::with_seed(11), 30);
    let at = constraints[4].at;
    constraints[4].value = 1.0;
    constraints.push(Constraint { at: at + DVec2::splat(1e-9), value: 3.0, smoothing: 0.0 });
    constraints.push(Constraint { at, value: 1e6, smoothing: 1.0 });
    let spline = ThinPlate::fit(&constraints).expect("general position");
    assert!((spline.value(at) - 2.0).abs() < 1e-6, "{}", spline.value(at));
}
