//! From pixels on the screen to mm in a sketch plane.

use super::{PenSample, Sketch, SketchSample, SketchStroke};
use blobtree::{Drawing, DrawnPoint, DrawnStroke, Holes};
use glam::Vec2;

/// About the most points that a drawing gets: more than the finest curve fit uses, few enough for a scene file.
pub const MAX_DRAWN_POINTS: usize = 8192;

/// Points nearer than this to the one before are left out, as a part of the drawing's larger side: an eighth of
/// a pixel of the template's usual field image.
const FINEST: f32 = 1.0 / 4096.0;

/// Where on the sketch plane a sketch lies: y turns upwards, and pixels become mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The pixel that lies on the origin of the sketch plane.
    pub origin_px: Vec2,
    /// The size of a pixel in the sketch plane, mm.
    pub mm_per_px: f32,
}

/// Where a placed sketch comes to lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Its middle on the origin.
    Centred,
    /// The middle of its lowest edge on the origin.
    OnGround,
}

impl Placement {
    /// The placement that gives a sketch a larger side of `size` mm. A sketch without extent keeps a pixel for
    /// a mm.
    pub fn of_size(sketch: &Sketch, size: f32, standing: Standing) -> Self {
        let [lo, hi] = sketch.bounds().unwrap_or([Vec2::ZERO; 2]);
        let extent = (hi - lo).max_element();
        let mm_per_px = if extent > 0.0 && size > 0.0 && size.is_finite() { size / extent } else { 1.0 };
        let middle = 0.5 * (lo + hi);
        let origin_px = match standing {
            Standing::Centred => middle,
            Standing::OnGround => Vec2::new(middle.x, hi.y),
        };
        Self { origin_px, mm_per_px }
    }

    /// Where a pixel lies in the sketch plane, mm, y up.
    pub fn mm_from_px(&self, place: Vec2) -> Vec2 {
        (place - self.origin_px) * self.mm_per_px * Vec2::new(1.0, -1.0)
    }

    /// The pixel at a place of the sketch plane.
    pub fn px_from_mm(&self, place: Vec2) -> Vec2 {
        place / self.mm_per_px * Vec2::new(1.0, -1.0) + self.origin_px
    }

    /// The drawing that a sketch node keeps. Points far closer than any detail are left out, so that there are
    /// no more than about [`MAX_DRAWN_POINTS`]; ends of strokes always stay. **Cost:** linear.
    pub fn drawing(&self, sketch: &Sketch) -> Drawing {
        let extent = sketch.bounds().map_or(0.0, |[lo, hi]| (hi - lo).max_element());
        let length: f64 = sketch.strokes.iter().map(|stroke| steps(stroke).sum::<f64>()).sum();
        let thinning = Thinning { along: length / MAX_DRAWN_POINTS as f64, apart: FINEST * extent };
        let strokes = sketch.strokes.iter().map(|stroke| self.drawn(stroke, &thinning)).collect();
        Drawing { strokes, rounded: Vec::new(), sharpened: Vec::new(), holes: Holes::Keep }
    }

    /// The sketch that a drawing was, to be drawn on, erased and smoothed again; times and tilts are not kept.
    /// [`Self::drawing`] of it gives the same strokes, up to rounding; exactly where a pixel is a mm about the
    /// origin. **Cost:** linear.
    pub fn sketch(&self, drawing: &Drawing) -> Sketch {
        let sample = |point: &DrawnPoint| {
            let pen = PenSample { pressure: point.pressure, ..PenSample::at(self.px_from_mm(point.at)) };
            SketchSample { pen, smoothing: point.smoothing }
        };
        let strokes = drawing.strokes.iter().map(|stroke| stroke.points.iter().map(sample).collect());
        Sketch::from_samples(strokes)
    }

    fn drawn(&self, stroke: &SketchStroke, thinning: &Thinning) -> DrawnStroke {
        let mut points: Vec<DrawnPoint> = Vec::new();
        let mut last: Option<Vec2> = None;
        let mut along = 0.0;
        let steps = std::iter::once(0.0).chain(steps(stroke));
        for (i, (sample, step)) in stroke.samples.iter().zip(steps).enumerate() {
            along += step;
            let place = sample.pen.place();
            let is_end = i + 1 == stroke.samples.len();
            let is_apart = |last: Vec2| last.distance(place) >= thinning.apart && along >= thinning.along;
            if is_end || last.is_none_or(is_apart) {
                points.push(self.point(sample));
                (last, along) = (Some(place), 0.0);
            }
        }
        DrawnStroke { points }
    }

    fn point(&self, sample: &SketchSample) -> DrawnPoint {
        DrawnPoint {
            at: self.mm_from_px(sample.pen.place()),
            pressure: sample.pen.pressure,
            smoothing: sample.smoothing,
        }
    }
}

/// When a sample is far enough from the last one that was kept, pixels.
struct Thinning {
    /// Along the line; keeps long scribbles short.
    along: f64,
    /// As the crow flies; leaves out what is too close to matter.
    apart: f32,
}

/// The distances from sample to sample, pixels.
fn steps(stroke: &SketchStroke) -> impl Iterator<Item = f64> + '_ {
    let place = |i: usize| stroke.samples[i].pen.place().as_dvec2();
    (1..stroke.samples.len()).map(move |i| place(i - 1).distance(place(i)))
}
