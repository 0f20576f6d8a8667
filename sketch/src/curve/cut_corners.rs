//! Corners between two samples: whoever draws fast hardly ever leaves one on a corner.

use super::line::{Sample, on_the_way};
use super::way::Way;
use glam::DVec2;

/// The least turn of a corner, radians: an octagon's corners are.
const LEAST_TURN: f64 = 0.5;
/// The least turn at both corners of a side with two samples only: less, and the side is an arc that was drawn fast.
const LEAST_TURN_AT_ENDS: f64 = 1.;
/// Samples are on a straight side, or on an arc, if they are off it by this share of their way, for each radian of the
/// corner. Three on an arc are off a straight line by a twelfth, and where the corner is a fillet that has an end of a
/// side on it, by a seventieth.
const STRAIGHT: f64 = 0.01;
/// Arcs and sides of two samples are looked for if this share of all four neighbours lies on a circle or a straight line:
/// fewer, and what shakes has them by chance.
const STEADY: f64 = 0.33;
/// On an arc no line turns further than this at a sample, radians; four samples around a corner may lie on a circle too.
const MOST_TURN: f64 = 0.7;
/// Three samples are on an arc rather than on a straight line if they are off one by this share of their way.
const LEAST_BEND: f64 = 0.002;
/// How far samples on an arc may be off it, in shares of their way, for each radian of the corner.
const ROUND: f64 = 0.01;
/// Corners nearer than this to a sample, in extents, are that sample.
const NEAR: f64 = 4e-4;
/// A corner is put no further from the edge that cuts it off than this, in lengths of that edge: tips sharper than
/// 28° stay cut.
const FARTHEST: f64 = 2.;

/// A closed line with the corners that its edges cut off.
pub(super) struct Restored {
    pub samples: Vec<Sample>,
    /// Which samples are where two sides meet, ascending.
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

/// Puts a sample where the sides before and after an edge meet.
///
/// A straight side needs three samples, an arc four, so that lines which shake, or were thinned out, stay as they are;
/// between two such sides that nearly turn back, two samples are a side as well.
pub(super) fn restored(samples: &[Sample], extent: f64) -> Restored {
    let mut restored = Restored { samples: Vec::with_capacity(samples.len()), corners: Vec::new() };
    let n = samples.len();
    let mut line = Line { samples, near: NEAR * extent, steady: false };
    line.steady = (0..n).filter(|&i| line.is_round(i)).count() as f64 > STEADY * n as f64;
    if !line.steady && 4 * on_the_way(samples) < n {
        return Restored { samples: samples.to_vec(), corners: Vec::new() };
    }
    let mut cut_off: Vec<Option<DVec2>> = (0..n).map(|i| line.met(i, i + 1)).collect();
    for i in 0..n {
        if let Some([before, after]) = line.short_side(i) {
            cut_off[(i + n - 1) % n].get_or_insert(before);
            cut_off[(i + 1) % n].get_or_insert(after);
        }
    }
    for (i, &sample) in samples.iter().enumerate() {
        let beside = cut_off[i].or(cut_off[(i + n - 1) % n]);
        if beside.is_none() && line.met(i, i).is_some() {
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

/// A closed line.
struct Line<'a> {
    samples: &'a [Sample],
    near: f64,
    /// Whether hardly anything shakes.
    steady: bool,
}

/// How a line goes on beyond some of its samples.
#[derive(Clone, Copy)]
struct Side {
    way: Way,
    /// The least turn of a corner beside which these samples are a side.
    least_turn: f64,
}

impl Line<'_> {
    /// Where the side that ends at sample `end` meets the one that begins at `start`, the same or the next.
    fn met(&self, end: usize, start: usize) -> Option<DVec2> {
        let n = self.samples.len();
        if n < 8 {
            return None;
        }
        let before = self.side([0, 1, 2, 3].map(|k| (end + n - k) % n))?;
        let after = self.side([0, 1, 2, 3].map(|k| (start + k) % n))?;
        if end == start {
            let turn = before.way.turn_to(&after.way, [0., 0.]);
            return (turn >= LEAST_TURN.max(before.least_turn).max(after.least_turn))
                .then_some(before.way.at);
        }
        self.tip(&before, &after, LEAST_TURN)
    }

    /// Where two sides meet beyond their samples.
    fn tip(&self, before: &Side, after: &Side, least: f64) -> Option<DVec2> {
        let [a, b] = [before.way, after.way];
        let beyond = a.meets(&b)?;
        let turn = a.turn_to(&b, beyond);
        let tip = a.ahead(beyond[0]).0;
        let far = tip.distance(a.at).max(tip.distance(b.at));
        let sound = turn >= least.max(before.least_turn).max(after.least_turn);
        let ahead = beyond[0].min(beyond[1]) > self.near && far < FARTHEST * a.at.distance(b.at);
        (sound && ahead).then_some(tip)
    }

    /// Whether a sample and the three after it lie on a circle or a straight line.
    fn is_round(&self, i: usize) -> bool {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.samples[(i + k) % self.samples.len()].at);
        Way::through([a, b, c]).is_some_and(|way| way.off(d) < ROUND * a.distance(d))
    }

    /// Both corners of a side that has only sample `i` and the next one.
    fn short_side(&self, i: usize) -> Option<[DVec2; 2]> {
        let n = self.samples.len();
        if n < 10 || !self.steady {
            return None;
        }
        let [a, b] = [i, i + 1].map(|k| self.samples[k % n]);
        if [a, b].iter().any(|sample| sample.weight < 0.5 || sample.sparse) {
            return None;
        }
        let along = (b.at - a.at).try_normalize()?;
        let [back, on] = [(a.at, -along), (b.at, along)]
            .map(|(at, direction)| Side { way: Way { at, direction, curvature: 0. }, least_turn: 0. });
        let before = self.side([1, 2, 3, 4].map(|k| (i + n - k) % n))?;
        let after = self.side([2, 3, 4, 5].map(|k| (i + k) % n))?;
        let tips = [self.tip(&before, &back, LEAST_TURN_AT_ENDS), self.tip(&on, &after, LEAST_TURN_AT_ENDS)];
        Some([tips[0]?, tips[1]?])
    }

    /// The side of which these are the last samples, the end first: straight if three of them are on a line.
    fn side(&self, last: [usize; 4]) -> Option<Side> {
        let four = last.map(|k| self.samples[k]);
        let usable = |sample: &Sample| sample.weight > 0.5 && !sample.sparse;
        let [a, b, c, d] = four.map(|sample| sample.at);
        if !four[..3].iter().all(usable) {
            return None;
        }
        let forward = (a - c).try_normalize()?;
        if (b - c).dot(forward) <= 0. || (a - b).dot(forward) <= 0. {
            return None;
        }
        let off = forward.perp_dot(b - c).abs() / a.distance(c);
        let straight =
            Side { way: Way { at: a, direction: forward, curvature: 0. }, least_turn: off / STRAIGHT };
        if !self.steady || off < LEAST_BEND {
            return Some(straight);
        }
        let turns = (c - b).angle_to(b - a).abs() < MOST_TURN && (c - d).dot(b - c) > 0. && usable(&four[3]);
        let arc = Way::through([c, b, a])
            .filter(|_| turns)
            .map(|way| Side { way, least_turn: way.off(d) / a.distance(d) / ROUND });
        if let Some(arc) = arc.filter(|arc| arc.least_turn < straight.least_turn) {
            return Some(arc);
        }
        Some(straight)
    }
}
