//! Corners between two samples: whoever draws fast along straight sides hardly ever leaves one on a corner.

use super::corners::meeting;
use super::line::Sample;
use glam::DVec2;

/// The least turn of a corner between straight sides, radians: an octagon's corners are.
const LEAST_TURN: f64 = 0.5;
/// Three samples are on a straight side if the middle one is off the way between the others by this share of that
/// way, for each radian of the corner. Three on an arc are off by a twelfth, and where the corner is a fillet that
/// has an end of a side on it, by a seventieth.
const STRAIGHT: f64 = 0.01;
/// Corners nearer than this to a sample, in extents, are that sample.
const NEAR: f64 = 4e-4;
/// A corner is put no further from the edge that cuts it off than this, in lengths of that edge: tips sharper than
/// 28° stay cut.
const FARTHEST: f64 = 2.;

/// A closed line with the corners that its edges cut off.
pub(super) struct Restored {
    pub samples: Vec<Sample>,
    /// Which samples are where straight sides meet, ascending.
    pub corners: Vec<usize>,
}

impl Restored {
    /// Which of other samples, these and more in the same order, are the corners.
    pub fn places_in(&self, more: &[Sample]) -> Vec<usize> {
        let mut places = Vec::with_capacity(self.corners.len());
        let mut corners = self.corners.iter().map(|&corner| self.samples[corner]).peekable();
        for (i, sample) in more.iter().enumerate() {
            if corners.next_if(|corner| corner == sample).is_some() {
                places.push(i);
            }
        }
        places
    }
}

/// Puts a sample where the straight sides before and after an edge meet.
///
/// Both sides need three samples in a line, so that lines which bend, shake, or were thinned out stay as they are.
pub(super) fn restored(samples: &[Sample], extent: f64) -> Restored {
    let mut restored = Restored { samples: Vec::with_capacity(samples.len()), corners: Vec::new() };
    let near = NEAR * extent;
    let cut_off: Vec<Option<DVec2>> = (0..samples.len()).map(|i| met(samples, i, i + 1, near)).collect();
    for (i, &sample) in samples.iter().enumerate() {
        let beside = cut_off[i].or(cut_off[(i + samples.len() - 1) % samples.len()]);
        if beside.is_none() && met(samples, i, i, near).is_some() {
            restored.corners.push(restored.samples.len());
        }
        restored.samples.push(sample);
        if let Some(at) = cut_off[i] {
            restored.corners.push(restored.samples.len());
            restored.samples.push(Sample { at, ..sample });
        }
    }
    restored
}

/// Where the straight side that ends at sample `end` meets the one that begins at `start`, the same or the next.
fn met(samples: &[Sample], end: usize, start: usize, near: f64) -> Option<DVec2> {
    let n = samples.len();
    if n < 6 {
        return None;
    }
    let three = |from: usize| [from, from + 1, from + 2].map(|k| samples[k % n]);
    let (before, after) = (three(end + n - 2), three(start));
    if before.iter().chain(&after).any(|sample| sample.weight < 0.5 || sample.sparse) {
        return None;
    }
    let [a, b] = [before[2].at, after[0].at];
    let [on, off] = [along(&before)?, along(&after)?];
    let turn = on.0.angle_to(off.0).abs();
    if turn < LEAST_TURN || on.1.max(off.1) > STRAIGHT * turn {
        return None;
    }
    if end == start {
        return Some(a);
    }
    let tip = meeting((a, on.0), (b, off.0))?;
    let beyond = (tip - a).dot(on.0).min((b - tip).dot(off.0));
    let far = tip.distance(a).max(tip.distance(b));
    (beyond > near && far < FARTHEST * a.distance(b)).then_some(tip)
}

/// The direction in which three samples go forward, and how far the middle one is off, in shares of their way.
fn along(three: &[Sample; 3]) -> Option<(DVec2, f64)> {
    let [a, b, c] = three.map(|sample| sample.at);
    let way = a.distance(c);
    let along = (c - a).try_normalize()?;
    let forward = (b - a).dot(along) > 0. && (c - b).dot(along) > 0.;
    forward.then(|| (along, along.perp_dot(b - a).abs() / way))
}
