//! Curves of drawings by many people whose places differ by rounding errors.
//!
//! `cargo test -p sketch --features shared --test doodle_curves -- --nocapture`. Needs `../shared/doodles`.

mod doodles;
use blobtree::Drawing;
use glam::{DVec2, Vec2};
use sketch::curve::{Curve, fit};
use sketch::stroke::{Placement, Sketch, Standing, Stroke};

/// Every how manieth drawing is judged.
const SAMPLE: usize = 43;

/// Larger side of a drawing, mm, and how far its places are moved: what the last digit of a coordinate is worth.
const SIZE: f32 = 60.0;
const ROUNDING: f32 = 4e-6;

/// How often each drawing is moved.
const TIMES: u64 = 3;

/// Curves further apart than this, of the drawing's size, are others to the eye.
const SEEN: f64 = 0.003;

/// A drawing of the right size on the ground.
fn drawing(strokes: &[Stroke]) -> Drawing {
    let sketch = Sketch::from_strokes(strokes);
    Placement::of_size(&sketch, SIZE, Standing::OnGround).drawing(&sketch)
}

fn moved(drawing: &Drawing, seed: u64) -> Drawing {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut off = || ROUNDING * (2.0 * random.f32() - 1.0);
    let mut moved = drawing.clone();
    moved.strokes.iter_mut().flat_map(|stroke| &mut stroke.points).for_each(|point| {
        point.at += Vec2::new(off(), off());
    });
    moved
}

/// How far the points of one curve are from another one at most.
fn farthest(from: &Curve, to: &Curve) -> f64 {
    let edges = |points: &[DVec2]| -> Vec<(DVec2, DVec2)> {
        points.iter().copied().zip(points.iter().copied().cycle().skip(1)).collect()
    };
    let edges: Vec<(DVec2, DVec2)> = to.contours.iter().flat_map(|contour| edges(&contour.points)).collect();
    let nearest = |at: &DVec2| {
        let far = |&(a, b): &(DVec2, DVec2)| {
            let along = b - a;
            let share = (*at - a).dot(along) / along.length_squared().max(1e-30);
            (a + share.clamp(0.0, 1.0) * along).distance(*at)
        };
        edges.iter().map(far).fold(f64::INFINITY, f64::min)
    };
    from.contours.iter().flat_map(|contour| &contour.points).map(nearest).fold(0.0, f64::max)
}

/// How far the curves of a drawing and of the same one moved are from each other, of its size; a reason if one has none.
fn apart(plain: &Drawing, seed: u64) -> Result<f64, String> {
    match (fit(plain), fit(&moved(plain, seed))) {
        (Ok(one), Ok(other)) => Ok(farthest(&one, &other).max(farthest(&other, &one)) / f64::from(SIZE)),
        (Err(_), Err(_)) => Ok(0.0),
        (Ok(_), Err(reason)) | (Err(reason), Ok(_)) => Err(reason.to_string()),
    }
}

#[test]
fn rounding_errors_in_strokes_do_not_show_in_curves() {
    let (mut all, mut others) = (0, Vec::new());
    for (name, strokes) in doodles::every(SAMPLE) {
        let plain = drawing(&strokes);
        let worst: Result<f64, String> =
            (0..TIMES).map(|seed| apart(&plain, seed)).try_fold(0.0_f64, |a, b| Ok(a.max(b?)));
        all += 1;
        match worst {
            Ok(small) if small < SEEN => {}
            Ok(large) => others.push(format!("{name}: {:.2} %", 100.0 * large)),
            Err(reason) => others.push(format!("{name}: {reason}")),
        }
    }
    println!("{} of {all} drawings have other curves: {others:#?}", others.len());
    assert!(all >= 100 && others.len() <= 3, "{} of {all}: {others:#?}", others.len());
}
