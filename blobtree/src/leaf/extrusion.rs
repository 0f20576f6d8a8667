//! Drawings moved along their normal.

use super::frame::Range;
use super::section::Section;
use super::solid::{Solid, farther, meet, slab};
use crate::scalar::{Scalar, Slope, Triple};
use crate::sketched::Rectangle;
use glam::Vec2;

/// The section in the planes z = −`half` to `half`.
#[derive(Clone, Debug)]
pub(crate) struct Extrusion {
    pub section: Section,
    pub half: f32,
    /// Radius of the edges between the ends and the side.
    pub fillet: f32,
}

/// The larger of two distances, but for a rounding of this radius where both are near 0.
#[inline(always)]
pub(super) fn rounded<S: Scalar>(a: Slope<S>, b: Slope<S>, radius: f32) -> Slope<S> {
    let (over, above) = (a.value + S::of(radius), b.value + S::of(radius));
    if over.value() <= 0.0 || above.value() <= 0.0 || radius == 0.0 {
        return farther(a, b);
    }
    let length = (over * over + above * above).sqrt();
    let inverse = S::of(1.0) / length.larger(S::of(1e-12));
    let gradient = std::array::from_fn(|i| (over * a.gradient[i] + above * b.gradient[i]) * inverse);
    Slope::new(length - S::of(radius), gradient).on(a.piece)
}

/// Bounds of [`rounded`].
pub(super) fn rounded_bound(a: (f32, f32), b: (f32, f32), radius: f32) -> (f32, f32) {
    let of = |a: f32, b: f32| {
        let plain = |value: f32| Slope::new(value, [0.0; 3]);
        rounded(plain(a), plain(b), radius).value
    };
    let (lo, hi) = (of(a.0, b.0), of(a.1, b.1));
    let slack = |x: f32| 1e-6 * (x.abs() + radius);
    (lo - slack(lo), hi + slack(hi))
}

impl Extrusion {
    fn parts(&self, range: &Range) -> ((f32, f32), (f32, f32)) {
        let along = range.abs(2);
        (self.section.bound(&across(range)), (along.0 - self.half, along.1 - self.half))
    }
}

/// The rectangle that a range covers in x and y.
pub(super) fn across(range: &Range) -> Rectangle {
    let (x, y) = (range.along(0), range.along(1));
    Rectangle { min: Vec2::new(x.0, y.0), max: Vec2::new(x.1, y.1) }
}

impl Solid for Extrusion {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let reading = self.section.read([q[0], q[1]]);
        // The caps have the numbers 5 and 6.
        let piece = 8 + self.section.piece([q[0].value(), q[1].value()]);
        let side = Slope::new(reading.value, [reading.slope[0], reading.slope[1], S::of(0.0)]).on(piece);
        rounded(side, slab(q, 2, self.half), self.fillet)
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let (side, caps) = self.parts(range);
        rounded_bound(side, caps, self.fillet)
    }

    fn creased(&self, range: &Range) -> bool {
        let (side, caps) = self.parts(range);
        let edges = meet(side, caps) && (self.fillet == 0.0 || side.0.min(caps.0) < -self.fillet);
        // In the middle plane, a thin solid has a crease inside.
        edges || caps.1 >= side.0 && range.abs(2).0 <= 0.0 || self.section.creased(&across(range))
    }
}
