//! Polygons drawn so fast that their sides have few samples.

use blobtree::{Drawing, DrawnPoint, DrawnStroke};
use glam::DVec2;
use sketch::curve::fit;
use std::f64::consts::TAU;

/// Evenly spaced samples along a closed polygon, from a share of the way around on, and back to the first.
fn drawn(corners: &[DVec2], count: usize, start: f64) -> Drawing {
    let n = corners.len();
    let lengths: Vec<f64> = (0..n).map(|i| corners[i].distance(corners[(i + 1) % n])).collect();
    let around: f64 = lengths.iter().sum();
    let place = |share: f64| {
        let (mut left, mut side) = (share.fract() * around, 0);
        while side + 1 < n && left > lengths[side] {
            left -= lengths[side];
            side += 1;
        }
        corners[side].lerp(corners[(side + 1) % n], left / lengths[side])
    };
    let places = (0..=count).map(|i| place(start + (i % count) as f64 / count as f64));
    let points = places.map(|p| DrawnPoint::at(p.as_vec2())).collect();
    Drawing { strokes: vec![DrawnStroke { points }], ..Drawing::default() }
}

fn distance_to(polygon: &[DVec2], at: DVec2) -> f64 {
    let to_side = |(i, &a): (usize, &DVec2)| {
        let along = polygon[(i + 1) % polygon.len()] - a;
        let share = ((at - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (a + share * along).distance(at)
    };
    polygon.iter().enumerate().map(to_side).fold(f64::INFINITY, f64::min)
}

#[test]
fn clean_polygons_of_few_samples_keep_their_corners() {
    let box_of =
        |x: f64, y: f64| vec![DVec2::new(-x, -y), DVec2::new(x, -y), DVec2::new(x, y), DVec2::new(-x, y)];
    let triangle = (0..3).map(|k| 20.0 * DVec2::from_angle(TAU * f64::from(k) / 3.0)).collect();
    for (name, corners, fewest) in [
        ("square", box_of(20.0, 20.0), 24),
        ("rectangle", box_of(20.0, 10.0), 24),
        ("triangle", triangle, 24),
    ] {
        for count in
            [24, 30, 40, 60, 80, 100, 120, 130, 160, 200, 250].into_iter().filter(|count| *count >= fewest)
        {
            for start in [0.0, 0.11, 0.37, 0.523] {
                let curve = fit(&drawn(&corners, count, start)).expect("it closes");
                let contour = &curve.contours[0].points;
                let off = contour.iter().map(|p| distance_to(&corners, *p)).fold(0.0, f64::max);
                let missed = corners.iter().map(|p| distance_to(contour, *p)).fold(0.0, f64::max);
                let worst = off.max(missed) / 40.0;
                assert!(worst < 0.005, "{name}, {count} from {start}: {:.2} %", 100.0 * worst);
            }
        }
    }
}
