//! Fixed-point coordinates for the plane of a layer.

use super::error::{SliceError, WIDEST_MM};
use glam::DVec2;
use i_overlay::i_float::int::point::IntPoint;
use mesh::Bounds;

/// A place on the grid.
pub(crate) type Point = IntPoint<i32>;

/// Coordinates reach to ±2²⁸ steps at most: the clipper takes ±2³⁰, and shapes must be able to grow.
const HALF_RANGE: f64 = (1 << 28) as f64;

/// A grid over the plane, the same for all layers of a part: polygons of different layers share it exactly.
///
/// The step is a power of two: 2⁻²⁰ mm, about a nanometre, for parts up to 512 mm wide, and doubled for wider ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    origin: DVec2,
    /// mm.
    pub(crate) step: f64,
}

impl Grid {
    /// The grid for a part in `bounds`.
    ///
    /// Errors: [`SliceError::TooWide`].
    pub(crate) fn over(bounds: &Bounds) -> Result<Self, SliceError> {
        let size = bounds.size().as_dvec3();
        let width_mm = size.x.max(size.y);
        if width_mm > WIDEST_MM {
            return Err(SliceError::TooWide { width_mm });
        }
        let mut step = 2f64.powi(-20);
        while width_mm * 0.5 > HALF_RANGE * step {
            step *= 2.0;
        }
        // An origin on the grid itself: moving a part by whole steps moves its polygons by whole steps.
        let origin = (bounds.centre().truncate() / step).round() * step;
        Ok(Self { origin, step })
    }

    /// The nearest grid point, for a place on the part.
    pub(crate) fn point(&self, p: DVec2) -> Point {
        let q = ((p - self.origin) / self.step).round();
        Point::new(q.x as i32, q.y as i32)
    }

    /// mm.
    pub(crate) fn place(&self, p: Point) -> DVec2 {
        DVec2::new(f64::from(p.x), f64::from(p.y)) * self.step + self.origin
    }

    /// A length in steps.
    pub(crate) fn steps(&self, mm: f64) -> f64 {
        mm / self.step
    }

    /// mm² of an area in square steps.
    pub(crate) fn square_mm(&self, square_steps: f64) -> f64 {
        square_steps * self.step * self.step
    }
}
