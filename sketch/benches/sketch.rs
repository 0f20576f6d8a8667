//! The thin-plate fit and the field image of the peer comparison, timed: one JSON line per case, in the form that
//! its report reads (`bench`, `case`, `peer`, `threads`, times in ms over the rounds).
//!
//! `cargo bench -p sketch --bench sketch [-- rbf|template]`; `REPS` sets the rounds (15).

use glam::DVec2;
use serde_json::json;
use sketch::curve::{Contour, Curve};
use sketch::thin_plate::{Constraint, Grid, ThinPlate};
use std::f64::consts::TAU;
use std::time::Instant;

/// Samples along each side of the field image.
const SIDE: usize = 512;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let wants = |bench: &str| wanted.is_empty() || wanted.iter().any(|w| w == bench);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("a few threads can always be had");
        if wants("rbf") {
            for n in [198, 600, 1500, 3000] {
                pool.install(|| spline(n, threads));
            }
        }
        if wants("template") {
            pool.install(|| template(threads));
        }
    }
}

/// Points on a wavy closed curve.
fn wavy(t: f64) -> (DVec2, DVec2) {
    let radius = 0.55 + 0.10 * (3.0 * t).cos() + 0.06 * (5.0 * t).sin();
    let slope = -0.30 * (3.0 * t).sin() + 0.30 * (5.0 * t).cos();
    let out = DVec2::from_angle(t);
    (out * radius, (out * radius - out.perp() * slope).normalize())
}

/// The comparison's constraints: on the curve, and between these along five offsets of it.
fn constraints(n: usize) -> Vec<Constraint> {
    let around = n / 6;
    let mut constraints = Vec::new();
    for value in [0.0, 0.01, -0.01, 0.12, -0.06, -0.12] {
        for i in 0..around {
            let shift = if value == 0.0 { 0.0 } else { 0.5 };
            let (at, normal) = wavy(TAU * (i as f64 + shift) / around as f64);
            constraints.push(Constraint { at: at + value * normal, value, smoothing: 0.0 });
        }
    }
    constraints
}

/// Fit, image, and both together, of `n` constraints.
fn spline(n: usize, threads: usize) {
    let constraints = constraints(n);
    let fit = || ThinPlate::fit(&constraints).expect("a fair curve");
    let pixel = 2.0 / SIDE as f64;
    let grid = Grid { origin: DVec2::splat(0.5 * pixel - 1.0), pixel, size: [SIDE; 2] };
    let case = format!("n{n}");
    let spline = fit();
    let residual = constraints.iter().map(|c| (spline.value(c.at) - c.value).abs()).fold(0.0, f64::max);
    assert!(residual < 1e-8, "the spline misses its values by {residual}");
    report("rbf-fit", &case, threads, || drop(fit()));
    report("rbf-image", &case, threads, || drop(spline.sample_grid(&grid)));
    report("rbf", &case, threads, || drop(fit().sample_grid(&grid)));
}

/// The whole way from a curve to its template.
fn template(threads: usize) {
    let points = (0..800).map(|i| 100.0 * wavy(TAU * f64::from(i) / 800.0).0).collect();
    let curve = Curve { contours: vec![Contour { points, corners: Vec::new() }], left_out: Vec::new() };
    report("template", "wavy", threads, || {
        let template = sketch::template::solve(&curve, None, &[]).expect("a fair curve");
        assert!(template.depth > 20.0);
    });
}

/// Times a job over the rounds, after one to warm up, and prints its line.
fn report(bench: &str, case: &str, threads: usize, mut job: impl FnMut()) {
    let rounds: usize = std::env::var("REPS").ok().and_then(|reps| reps.parse().ok()).unwrap_or(15);
    job();
    let mut times: Vec<f64> = (0..rounds.max(1))
        .map(|_| {
            let start = Instant::now();
            job();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let line = json!({
        "bench": bench, "case": case, "peer": "trullo", "threads": threads, "n": times.len(),
        "median_ms": times[times.len() / 2], "min_ms": times[0], "max_ms": times[times.len() - 1],
    });
    println!("{line}");
}
