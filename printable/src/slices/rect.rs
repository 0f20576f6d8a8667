//! Boxes in the plane, and what of outlines lies in them.

use super::clip::{Region, distance, pairs};
use super::grid::Point;

/// A box in the plane, on a [`Grid`](super::grid::Grid).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) min: Point,
    pub(crate) max: Point,
}

impl Rect {
    /// The box of everything in `regions`; none around nothing.
    pub(crate) fn around<'a>(regions: impl IntoIterator<Item = &'a Region>) -> Option<Self> {
        Self::of_points(regions.into_iter().filter_map(|region| region.first()).flatten())
    }

    /// The box of points; none of none.
    pub(crate) fn of_points<'a>(points: impl IntoIterator<Item = &'a Point>) -> Option<Self> {
        points.into_iter().fold(None, |known: Option<Self>, &p| {
            let Some(Self { min, max }) = known else { return Some(Self { min: p, max: p }) };
            let (min, max) =
                (Point::new(min.x.min(p.x), min.y.min(p.y)), Point::new(max.x.max(p.x), max.y.max(p.y)));
            Some(Self { min, max })
        })
    }

    /// Whether two boxes come closer than `gap` steps along both axes.
    pub(crate) fn is_near(&self, other: &Self, gap: i32) -> bool {
        let apart = |low: i32, high: i32| i64::from(low) - i64::from(high) > i64::from(gap);
        !(apart(self.min.x, other.max.x)
            || apart(other.min.x, self.max.x)
            || apart(self.min.y, other.max.y)
            || apart(other.min.y, self.max.y))
    }

    /// Whether all of another box is inside, off the rim.
    pub(crate) fn encloses(&self, other: &Self) -> bool {
        let inside = |low: i32, p: i32, high: i32| low < p && p < high;
        [other.min, other.max]
            .iter()
            .all(|p| inside(self.min.x, p.x, self.max.x) && inside(self.min.y, p.y, self.max.y))
    }

    /// Whether a point is inside or on the rim.
    pub(crate) fn contains(&self, p: Point) -> bool {
        (self.min.x..=self.max.x).contains(&p.x) && (self.min.y..=self.max.y).contains(&p.y)
    }

    /// The box with a margin of so many steps.
    pub(crate) fn widened(&self, by: i32) -> Self {
        let moved = |p: Point, by: i32| Point::new(p.x.saturating_add(by), p.y.saturating_add(by));
        Self { min: moved(self.min, -by), max: moved(self.max, by) }
    }

    /// Its diagonal, in steps.
    pub(crate) fn diagonal(&self) -> f64 {
        distance(self.min, self.max)
    }

    /// What of a ring lies in the box: around every place inside, it winds as often as before; elsewhere it does not.
    /// Empty if that is nothing.
    ///
    /// - **Promises:** right to half a step along the rim.
    /// - **Source:** Sutherland and Hodgman 1974, "Reentrant polygon clipping".
    pub(crate) fn clipped(&self, ring: &[Point]) -> Vec<Point> {
        let sides = [(0, self.min.x, 1), (0, self.max.x, -1), (1, self.min.y, 1), (1, self.max.y, -1)];
        let mut kept = ring.to_vec();
        for (axis, bound, inward) in sides {
            kept = on_one_side(kept, axis, bound, inward);
        }
        kept
    }
}

/// The part of a ring where `inward` times a coordinate is at least that times `bound`.
fn on_one_side(ring: Vec<Point>, axis: usize, bound: i32, inward: i64) -> Vec<Point> {
    let along = |p: Point| i64::from(if axis == 0 { p.x } else { p.y });
    let across = |p: Point| i64::from(if axis == 0 { p.y } else { p.x });
    let depth = |p: Point| inward * (along(p) - i64::from(bound));
    let inside = ring.iter().filter(|p| depth(**p) >= 0).count();
    if inside == ring.len() {
        return ring;
    }
    if inside == 0 {
        return Vec::new();
    }
    let mut kept = Vec::with_capacity(inside + 16);
    for (a, b) in pairs(&ring) {
        let [from, to] = [depth(a), depth(b)];
        if from >= 0 {
            kept.push(a);
        }
        if (from > 0 && to < 0) || (from < 0 && to > 0) {
            let rise = (across(b) - across(a)) as f64 * (from as f64 / (from - to) as f64);
            let crossing = (across(a) + rise.round() as i64) as i32;
            kept.push(if axis == 0 { Point::new(bound, crossing) } else { Point::new(crossing, bound) });
        }
    }
    kept
}
