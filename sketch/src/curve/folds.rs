//! Corners that shaking hides: where two sides explain the samples better than one that bends.

use super::corners::{Closed, NEAR, STEADY, Wishes};
use super::fair::{Sides, least_expected_error_of};
use super::line::Sample;
use glam::DVec2;
use std::ops::Range;

/// The least turn of a corner, radians.
const LEAST_TURN: f64 = 0.7;
/// Directions beside a place are taken over this, in extents, or so many samples, whichever is longer.
const REACH: f64 = 0.05;
const SAMPLES_IN_REACH: f64 = 4.;
/// A side needs so many samples of the pen.
const LEAST_ON_A_SIDE: usize = 3;
/// By how much a corner lowers the expected error, in variances of the noise: at 10, ends of ellipses of 250 samples
/// with noise of 2 % are corners; at 20, inner corners of stars of 60 samples with noise of 0.5 % are none.
const LEAST_GAIN: f64 = 13.;
/// How many samples to either side of the sharpest bend a corner is looked for.
const AROUND: usize = 3;
/// How many bends are tried.
const MOST_TRIED: usize = 4;

/// The corners with those that were hidden, ascending; none if there are no more.
///
/// Sides are cut in two as long as that lowers the expected error (Mallows' C_p) enough. Bends that are wished round stay.
pub(super) fn more(line: &Closed, sides: &Sides, found: &[usize], wishes: &Wishes) -> Option<Vec<usize>> {
    if line.sparse || line.noise < STEADY * line.extent {
        return None;
    }
    let n = line.samples.len();
    let mut all = found.to_vec();
    let round = |sample: &Sample| {
        let near = |place: &DVec2| place.distance(sample.at) < NEAR * line.extent;
        sample.smoothing >= 0.5 || wishes.rounded.iter().any(near)
    };
    let fold = |from: usize, to: usize, closed: bool| {
        fold(line, sides, from, to, closed).filter(|fold| !round(&line.samples[fold % n]))
    };
    if all.is_empty() {
        all.push(fold(0, n, true)?);
    }
    let known = all.clone();
    for (k, &corner) in known.iter().enumerate() {
        let next = if k + 1 < known.len() { known[k + 1] } else { known[0] + n };
        let mut open = vec![(corner + 1, next)];
        while let Some((from, to)) = open.pop() {
            if let Some(at) = fold(from, to, false) {
                all.push(at % n);
                open.extend([(from, at), (at + 1, to)]);
            }
        }
    }
    all.sort_unstable();
    (all.len() > found.len()).then_some(all)
}

/// The sample between two others that is a corner between two sides, if that is likelier than one side; of a closed
/// line, one that is likelier a corner than not.
fn fold(line: &Closed, sides: &Sides, from: usize, to: usize, closed: bool) -> Option<usize> {
    let n = line.samples.len();
    let run: Vec<Sample> = (from..to).map(|i| line.samples[i % n]).collect();
    let drawn: Vec<usize> = (0..run.len()).filter(|&i| run[i].weight > 0.5).collect();
    if drawn.len() < 2 * LEAST_ON_A_SIDE + 1 {
        return None;
    }
    let inner = if closed { 0..drawn.len() } else { LEAST_ON_A_SIDE..drawn.len() - LEAST_ON_A_SIDE };
    let density = sides.density();
    let error = |run: &[Sample], closed| least_expected_error_of(run, closed, density, sides);
    let (smooth, whole) = error(&run, closed);
    let folded = |i: usize| {
        let (before, after) = (&run[..i], &run[i + 1..]);
        if closed {
            error(&[after, before].concat(), false).1
        } else {
            error(before, false).1 + error(after, false).1
        }
    };
    let step = super::line::length(&run) / drawn.len() as f64;
    let reach = (REACH * line.extent).max(SAMPLES_IN_REACH * step);
    let turns: Vec<f64> = drawn.iter().map(|&i| turn(&smooth, i, reach, closed)).collect();
    let around = |k: usize| k.saturating_sub(AROUND).max(inner.start)..(k + AROUND + 1).min(inner.end);
    bends(&turns, &inner).into_iter().find_map(|bend| {
        let tried = around(bend).map(|k| (drawn[k], folded(drawn[k])));
        let (best, least) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (least + LEAST_GAIN * line.noise * line.noise < whole).then_some(from + best)
    })
}

/// Where a line turns further than around there, the sharpest bend first.
fn bends(turns: &[f64], inner: &Range<usize>) -> Vec<usize> {
    let sharpest_near = |&k: &usize| {
        let near = k.saturating_sub(AROUND)..(k + AROUND + 1).min(turns.len());
        turns[k] > LEAST_TURN && near.into_iter().all(|other| turns[other] < turns[k] || other == k)
    };
    let mut bends: Vec<usize> = inner.clone().filter(sharpest_near).collect();
    bends.sort_by(|&a, &b| turns[b].total_cmp(&turns[a]));
    bends.truncate(MOST_TRIED);
    bends
}

/// How far a smooth line turns around a place.
fn turn(smooth: &[DVec2], i: usize, reach: f64, closed: bool) -> f64 {
    let n = smooth.len();
    let (back, on) = if closed { (n / 2, n / 2) } else { (i, n - 1 - i) };
    let far = |p: &DVec2| p.distance(smooth[i]) > reach;
    let before = (1..=back).map(|k| smooth[(i + n - k) % n]).find(far).or(smooth.first().copied());
    let after = (1..=on).map(|k| smooth[(i + k) % n]).find(far).or(smooth.last().copied());
    before.zip(after).map_or(0., |(a, b)| (smooth[i] - a).angle_to(b - smooth[i]).abs())
}
