//! The strokes of one drawing, and what the eraser and the smoothing gesture did to them.

use super::eraser::Rubbed;
use super::{PenSample, Stroke, bounds, clean};
use glam::Vec2;

/// The most that smoothing adds up to; far more than any drawing bears.
pub const MAX_SMOOTHING: f32 = 100.0;

/// A drawing in the making: strokes in pixels, y down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// What is left of the strokes, in the order in which they were drawn; none is empty.
    pub strokes: Vec<SketchStroke>,
    /// The number of the next stroke.
    next: usize,
}

/// A stroke, or a piece of one that the eraser split.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchStroke {
    /// The samples; at least one.
    pub samples: Vec<SketchSample>,
    /// Which movement of the pen drew it; pieces of one stroke have the same number.
    pub drawn: usize,
}

/// A sample of a sketch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SketchSample {
    /// What the pen did.
    pub pen: PenSample,
    /// How far the curve may leave this sample to be smooth, 0 to [`MAX_SMOOTHING`]; each smoothing gesture
    /// adds 1.
    pub smoothing: f32,
}

/// A box that need not be level, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Its middle.
    pub center: Vec2,
    /// Half its extent along its first and its second axis.
    pub half: Vec2,
    /// The first axis, a unit vector; the second is a quarter turn from it.
    pub axis: Vec2,
}

impl OrientedBox {
    /// The smallest box along `axis`, a unit vector, around places; `None` without any.
    pub fn around(places: impl IntoIterator<Item = Vec2>, axis: Vec2) -> Option<Self> {
        let [lo, hi] = bounds(places.into_iter().map(|p| Vec2::new(p.dot(axis), p.dot(axis.perp()))))?;
        let middle = 0.5 * (lo + hi);
        let center = middle.x * axis + middle.y * axis.perp();
        Some(Self { center, half: 0.5 * (hi - lo), axis })
    }

    /// Whether a place is in the box or on its edge.
    pub fn contains(&self, place: Vec2) -> bool {
        let from = place - self.center;
        from.dot(self.axis).abs() <= self.half.x && from.dot(self.axis.perp()).abs() <= self.half.y
    }
}

impl Sketch {
    /// The sketch that these strokes make, one after the other, as [`Self::add`] takes them.
    /// **Cost:** linear in their samples and lengths.
    pub fn from_strokes<'a>(strokes: impl IntoIterator<Item = &'a Stroke>) -> Self {
        let mut sketch = Self::default();
        let mut erasers = Vec::new();
        for stroke in strokes {
            erasers.extend(sketch.drawn(stroke));
        }
        sketch.rub_out(&erasers);
        sketch
    }

    /// The sketch of strokes that were one before.
    pub(super) fn from_samples(strokes: impl IntoIterator<Item = Vec<SketchSample>>) -> Self {
        let some = strokes.into_iter().filter(|samples| !samples.is_empty());
        let strokes: Vec<SketchStroke> =
            some.enumerate().map(|(drawn, samples)| SketchStroke { samples, drawn }).collect();
        Self { next: strokes.len(), strokes }
    }

    /// Takes in a stroke, cleaned. One of the eraser end rubs out what it passes over; one without a single
    /// usable sample does nothing.
    pub fn add(&mut self, stroke: &Stroke) {
        let eraser = self.drawn(stroke);
        self.rub_out(eraser.as_slice());
    }

    /// Takes in a stroke, cleaned; or gives back one that erases, with the number of the next stroke.
    fn drawn(&mut self, stroke: &Stroke) -> Option<(u32, Stroke)> {
        let stroke = clean(stroke);
        if stroke.eraser {
            return Some((self.next as u32, stroke));
        }
        let samples: Vec<SketchSample> =
            stroke.samples.into_iter().map(|pen| SketchSample { pen, smoothing: 0.0 }).collect();
        if !samples.is_empty() {
            self.strokes.push(SketchStroke { samples, drawn: self.next });
            self.next += 1;
        }
        None
    }

    /// Removes what was there when erasers passed over it.
    fn rub_out(&mut self, erasers: &[(u32, Stroke)]) {
        if erasers.is_empty() {
            return;
        }
        if let Some(rubbed) = Rubbed::by(erasers, &self.strokes) {
            let strokes = std::mem::take(&mut self.strokes);
            self.strokes = strokes.into_iter().flat_map(|stroke| rubbed.left_of(stroke)).collect();
        }
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.strokes.is_empty()
    }

    /// All places, pixels.
    pub fn places(&self) -> impl Iterator<Item = Vec2> + Clone {
        self.strokes.iter().flat_map(|stroke| stroke.samples.iter().map(|sample| sample.pen.place()))
    }

    /// The least and greatest coordinates, pixels; `None` for an empty sketch.
    pub fn bounds(&self) -> Option<[Vec2; 2]> {
        bounds(self.places())
    }

    /// Removes what lies in the box, and splits strokes there; lines are cut at its edges, wherever their
    /// samples are. Returns whether anything was removed. **Cost:** linear.
    pub fn erase(&mut self, area: &OrientedBox) -> bool {
        self.erase_where(|a, b| stretch_in(area, a, b))
    }

    /// Adds 1 to the smoothing of all samples inside the polygon; returns how many. Edges that cross count
    /// even-odd. **Cost:** samples × corners.
    pub fn smooth(&mut self, polygon: &[Vec2]) -> usize {
        let Some([lo, hi]) = bounds(polygon.iter().copied()) else { return 0 };
        let mut smoothed = 0;
        for sample in self.strokes.iter_mut().flat_map(|stroke| &mut stroke.samples) {
            let p = sample.pen.place();
            if p.cmpge(lo).all() && p.cmple(hi).all() && is_inside(polygon, p) {
                sample.smoothing = (sample.smoothing + 1.0).min(MAX_SMOOTHING);
                smoothed += 1;
            }
        }
        smoothed
    }

    /// Takes back the stroke that was drawn last, with all its pieces; returns whether there was one.
    pub fn undo_last_stroke(&mut self) -> bool {
        let Some(last) = self.strokes.iter().map(|stroke| stroke.drawn).max() else { return false };
        self.strokes.retain(|stroke| stroke.drawn != last);
        true
    }

    /// Removes the part of each line for which `gone` gives a stretch between 0 and 1.
    fn erase_where(&mut self, gone: impl Fn(Vec2, Vec2) -> Option<(f32, f32)>) -> bool {
        let mut erased = false;
        let mut left = Vec::with_capacity(self.strokes.len());
        for stroke in std::mem::take(&mut self.strokes) {
            let drawn = stroke.drawn;
            let (pieces, touched) = pieces(stroke, &gone);
            erased |= touched;
            left.extend(pieces.into_iter().map(|samples| SketchStroke { samples, drawn }));
        }
        self.strokes = left;
        erased
    }
}

/// What is left of a stroke, and whether anything is gone.
fn pieces(
    stroke: SketchStroke,
    gone: &impl Fn(Vec2, Vec2) -> Option<(f32, f32)>,
) -> (Vec<Vec<SketchSample>>, bool) {
    let samples = &stroke.samples;
    if let [only] = samples.as_slice() {
        let p = only.pen.place();
        return if gone(p, p).is_some() { (Vec::new(), true) } else { (vec![stroke.samples], false) };
    }
    let (mut pieces, mut piece, mut touched) = (Vec::new(), Vec::new(), false);
    for (i, pair) in samples.windows(2).enumerate() {
        let stretch = gone(pair[0].pen.place(), pair[1].pen.place());
        touched |= stretch.is_some();
        let starts_gone = stretch.is_some_and(|(from, _)| from <= 0.0);
        if i == 0 && !starts_gone {
            piece.push(pair[0]);
        }
        match stretch {
            None => piece.push(pair[1]),
            Some((from, to)) => {
                if from > 0.0 {
                    piece.push(mixed(&pair[0], &pair[1], from));
                }
                if !piece.is_empty() {
                    pieces.push(std::mem::take(&mut piece));
                }
                if to < 1.0 {
                    piece.extend([mixed(&pair[0], &pair[1], to), pair[1]]);
                }
            }
        }
    }
    if !piece.is_empty() {
        pieces.push(piece);
    }
    (pieces, touched)
}

/// The sample a part of the way from one to another.
pub(super) fn mixed(a: &SketchSample, b: &SketchSample, part: f32) -> SketchSample {
    let pen = clean::between(&a.pen, &b.pen, part);
    SketchSample { pen, smoothing: a.smoothing + (b.smoothing - a.smoothing) * part }
}

/// The stretch of the line from `a` to `b` inside the box, as parts of its length.
fn stretch_in(area: &OrientedBox, a: Vec2, b: Vec2) -> Option<(f32, f32)> {
    let (mut from, mut to) = (0.0f32, 1.0f32);
    for (axis, half) in [(area.axis, area.half.x), (area.axis.perp(), area.half.y)] {
        let (start, slope) = ((a - area.center).dot(axis), (b - a).dot(axis));
        if slope.abs() < 1e-12 {
            if start.abs() > half {
                return None;
            }
            continue;
        }
        let ends = [(-half - start) / slope, (half - start) / slope];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from <= to).then_some((from, to))
}

/// Whether a place is inside a polygon, even-odd.
pub(crate) fn is_inside(polygon: &[Vec2], p: Vec2) -> bool {
    let mut inside = false;
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}
