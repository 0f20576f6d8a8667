//! Places along a curve, and how much room there is on either side of them.

use crate::curve::{Contour, Curve};
use glam::DVec2;

/// A place on the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub at: DVec2,
    /// Unit normal, pointing out of the shape; none at a corner.
    pub normal: Option<DVec2>,
    /// Radii of the largest circles that touch the curve here and contain none of it, inside and outside.
    pub room: [f64; 2],
    /// Length of the curve that this sample stands for.
    pub length: f64,
}

/// A sharp corner with places just before and after it on the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub before: DVec2,
    pub at: DVec2,
    pub after: DVec2,
    /// Distance to the nearest part of the curve that is not one of the two sides.
    pub room: f64,
}

/// Samples over the whole curve.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    pub samples: Vec<Sample>,
    pub corners: Vec<Corner>,
}

impl Samples {
    /// Places evenly over the curve, at least some on every contour, and all corners: 600 altogether, up to twice
    /// as many on a curve that is long for its `size`.
    ///
    /// Cost: O(places²).
    pub fn new(curve: &Curve, size: f64) -> Self {
        let total: f64 = curve.contours.iter().map(length).sum();
        let step = total / (100.0 * total / size).clamp(600.0, 1200.0);
        let rings: Vec<Vec<(DVec2, bool)>> =
            curve.contours.iter().map(|contour| evenly(contour, step)).collect();
        let mut samples: Vec<Sample> = rings.iter().flat_map(|ring| along(ring)).collect();
        let mut corners = Vec::new();
        for ring in &rings {
            corners.extend(corners_of(ring, &rings));
        }
        let places: Vec<DVec2> = samples.iter().map(|sample| sample.at).collect();
        for sample in &mut samples {
            if let Some(normal) = sample.normal {
                sample.room = room(sample.at, normal, &places);
            }
        }
        Self { samples, corners }
    }
}

fn length(contour: &Contour) -> f64 {
    let n = contour.points.len();
    (0..n).map(|i| contour.points[i].distance(contour.points[(i + 1) % n])).sum()
}

/// Places about `step` apart, at least four between corners; which of them are corners.
fn evenly(contour: &Contour, step: f64) -> Vec<(DVec2, bool)> {
    let n = contour.points.len();
    let mut ends: Vec<usize> = contour.corners.iter().copied().filter(|&i| i < n).collect();
    let cornered = !ends.is_empty();
    if !cornered {
        ends.push(0);
    }
    let mut places = Vec::new();
    for (k, &start) in ends.iter().enumerate() {
        let count = match ends.get(k + 1) {
            Some(end) => end - start,
            None => n - start + ends[0],
        };
        let points: Vec<DVec2> = (0..=count).map(|i| contour.points[(start + i) % n]).collect();
        let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let step = length / (length / step).ceil().max(4.0);
        places.push((points[0], cornered));
        let mut ahead = step;
        for w in points.windows(2) {
            let piece = w[0].distance(w[1]);
            while ahead < piece {
                places.push((w[0].lerp(w[1], ahead / piece), false));
                ahead += step;
            }
            ahead -= piece;
        }
        // Rounding may have put a last place on the end, which comes next.
        let end = points[count];
        if places.last().is_some_and(|(last, corner)| !corner && last.distance(end) < 0.5 * step) {
            places.pop();
        }
    }
    places
}

/// The samples of a closed ring, their room still open.
fn along(ring: &[(DVec2, bool)]) -> impl Iterator<Item = Sample> {
    let n = ring.len();
    (0..n).map(move |i| {
        let (at, corner) = ring[i];
        let [before, after] = [ring[(i + n - 1) % n], ring[(i + 1) % n]];
        let length = 0.5 * (at.distance(before.0) + at.distance(after.0));
        // The tangent of the parabola through the three places.
        let (back, forth) = (at - before.0, after.0 - at);
        let tangent = back * forth.length_squared() + forth * back.length_squared();
        let normal = if corner { None } else { (-tangent.perp()).try_normalize() };
        Sample { at, normal, room: [f64::INFINITY; 2], length }
    })
}

/// The radii of the largest empty circles that touch the curve at a place.
fn room(at: DVec2, normal: DVec2, places: &[DVec2]) -> [f64; 2] {
    let mut room = [f64::INFINITY; 2];
    for place in places {
        let to = place - at;
        let beside = 2.0 * normal.dot(to);
        let side = usize::from(beside > 0.0);
        let radius = to.length_squared() / beside.abs();
        // At the place itself, 0/0.
        if radius < room[side] {
            room[side] = radius;
        }
    }
    room
}

fn corners_of<'a>(
    ring: &'a [(DVec2, bool)],
    rings: &'a [Vec<(DVec2, bool)>],
) -> impl Iterator<Item = Corner> + 'a {
    let n = ring.len();
    (0..n).filter(|&i| ring[i].1).map(move |i| {
        let at = ring[i].0;
        let mut room = f64::INFINITY;
        for other in rings.iter().filter(|other| !std::ptr::eq(other.as_slice(), ring)) {
            room = other.iter().map(|(p, _)| p.distance(at)).fold(room, f64::min);
        }
        for forth in [1, n - 1] {
            let (mut last, mut arc, mut beyond) = (at, 0.0, false);
            for k in 1..n {
                let (p, corner) = ring[(i + k * forth) % n];
                arc += p.distance(last);
                last = p;
                // A side ends where the curve turns back towards the corner, or at the next one.
                beyond |= corner || arc > 1.6 * p.distance(at);
                if beyond {
                    room = room.min(p.distance(at));
                    if arc > 0.0 && corner {
                        break;
                    }
                }
            }
        }
        Corner { before: ring[(i + n - 1) % n].0, at, after: ring[(i + 1) % n].0, room }
    })
}
