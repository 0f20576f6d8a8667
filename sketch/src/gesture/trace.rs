//! A stroke measured for recognition.

use crate::stroke::{Stroke, bounds, clean, resample};
use glam::Vec2;

/// Points along a stroke on which forms are judged: two dozen for each pass of a long scribble.
const POINTS: f32 = 384.0;

/// A stroke as evenly spaced points.
pub(super) struct Trace {
    /// Points along the line at equal distances; at least two.
    pub points: Vec<Vec2>,
    /// The length of the line, pixels, above 0.
    pub length: f32,
    /// Seconds from its start to its end, if known.
    pub duration: Option<f32>,
    /// The diagonal of the box around it, pixels, above 0.
    pub diagonal: f32,
}

impl Trace {
    /// `None` for a stroke without length.
    pub fn of(stroke: &Stroke) -> Option<Self> {
        let stroke = clean(stroke);
        let length = stroke.length();
        let [lo, hi] = bounds(stroke.places())?;
        let diagonal = lo.distance(hi);
        if !length.is_finite() || length <= 0.0 || diagonal <= 0.0 {
            return None;
        }
        let points = resample(&stroke, length / POINTS).places().collect();
        Some(Self { points, length, duration: stroke.duration(), diagonal })
    }

    /// Pixels a second; `None` where times are not known.
    pub fn speed(&self) -> Option<f32> {
        self.duration.map(|seconds| self.length / seconds)
    }

    /// Where it starts.
    pub fn first(&self) -> Vec2 {
        self.points[0]
    }

    /// Where it ends.
    pub fn last(&self) -> Vec2 {
        self.points[self.points.len() - 1]
    }
}

/// The convex polygon around points, by Andrew's monotone chain.
pub(super) fn hull(points: &[Vec2]) -> Vec<Vec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let mut around = half_hull(sorted.iter().copied());
    around.pop();
    let mut back = half_hull(sorted.iter().rev().copied());
    back.pop();
    around.extend(back);
    around
}

fn half_hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut chain: Vec<Vec2> = Vec::new();
    for p in points {
        while let [.., a, b] = chain.as_slice() {
            if (b - a).perp_dot(p - b) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(p);
    }
    chain
}
