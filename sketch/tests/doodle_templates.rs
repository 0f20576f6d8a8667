//! Template fields of drawings by many people: slopes beside their curves.
//!
//! `cargo test -p sketch --features shared --test doodle_templates -- --nocapture`. Needs `../shared/doodles`.

mod doodles;

use blobtree::{Drawing, Template};
use glam::DVec2;
use sketch::curve::{Curve, fit};
use sketch::stroke::{Placement, Sketch, Standing, Stroke};
use sketch::template;

/// Every how manieth drawing is judged.
const SAMPLE: usize = 61;

/// Larger side of a drawing, mm.
const SIZE: f32 = 60.0;

/// Slopes looked at and slopes that are off by more than a quarter.
#[derive(Default)]
struct Slopes {
    all: usize,
    off: usize,
}

/// A drawing of the right size on the ground.
fn drawing(strokes: &[Stroke]) -> Drawing {
    let sketch = Sketch::from_strokes(strokes);
    Placement::of_size(&sketch, SIZE, Standing::OnGround).drawing(&sketch)
}

/// The distance to the nearest of some places.
fn nearest(places: &[DVec2], at: DVec2) -> f64 {
    places.iter().map(|p| p.distance_squared(at)).fold(f64::INFINITY, f64::min).sqrt()
}

/// The radius of the largest circle on one side of a place on the curve that holds none of the others.
fn room(at: DVec2, normal: DVec2, places: &[DVec2]) -> f64 {
    let radius = |p: &DVec2| (*p - at).length_squared() / (2.0 * normal.dot(*p - at));
    places.iter().map(radius).filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min)
}

/// Slopes on normals of the curve, on the nearer half of the way to its skeleton, away from corners, as far out as
/// the field goes and as far in as it takes three quarters.
fn slopes(curve: &Curve, template: &Template) -> Slopes {
    let (falloff, depth) = (f64::from(template.falloff), f64::from(template.depth));
    let levels = [0.5f64, 0.75].map(|value| (1.0 - value.cbrt()).sqrt());
    let inner = falloff / (1.0 - levels[0]) * (levels[0] - levels[1]);
    let places: Vec<DVec2> = curve.contours.iter().flat_map(|c| &c.points).copied().collect();
    let corners: Vec<DVec2> = template.corners.iter().map(|c| c.as_dvec2()).collect();
    let mut slopes = Slopes::default();
    for contour in &curve.contours {
        let n = contour.points.len();
        for i in (0..n).step_by(5) {
            let across = contour.points[(i + 1) % n] - contour.points[(i + n - 1) % n];
            let Some(outward) = (-across.perp()).try_normalize() else { continue };
            for (side, most) in [(-1.0, inner), (1.0, falloff)] {
                let room = room(contour.points[i], side * outward, &places);
                for share in [0.1, 0.2, 0.35, 0.5] {
                    let away = share * room.min(2.0 * most);
                    let p = contour.points[i] + side * away * outward;
                    if nearest(&corners, p) < 0.6 * depth || nearest(&places, p) < 0.98 * away {
                        continue;
                    }
                    let slope = f64::from(template.distance.value_and_gradient(p.as_vec2()).1.length());
                    slopes.all += 1;
                    slopes.off += usize::from((slope - 1.0).abs() > 0.25);
                }
            }
        }
    }
    slopes
}

#[test]
fn fields_of_real_drawings_rise_as_a_distance_does() {
    let (mut all, mut off, mut worst) = (0, 0, (0.0, String::new()));
    for (name, strokes) in doodles::every(SAMPLE) {
        let drawing = drawing(&strokes);
        let Ok(curve) = fit(&drawing) else { continue };
        let template = template::solve(&curve, None, &[]).expect("an outline has a field");
        let slopes = slopes(&curve, &template);
        (all, off) = (all + slopes.all, off + slopes.off);
        let share = slopes.off as f64 / slopes.all.max(1) as f64;
        if share > worst.0 {
            worst = (share, format!("{name}: {} of {}", slopes.off, slopes.all));
        }
    }
    println!("{off} of {all} slopes are off by more than a quarter; worst {worst:?}");
    assert!(all > 10_000 && off * 500 <= all, "{off} of {all}, worst {worst:?}");
}
