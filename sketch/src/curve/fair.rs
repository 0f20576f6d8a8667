//! Smoothing of a closed line as far as it is shaky, its corners kept.

use super::Contour;
use super::banded;
use super::corners::{self, Closed, STEADY, Wishes, meeting};
use super::cut_corners::restored;
use super::folds;
use super::line::{Sample, are_sparse, noise, noise_between};
use super::polygon;
use super::way::Between;
use glam::DVec2;

/// Nearer than this to the first sample, in extents, the last one repeats it.
const REPETITION: f64 = 1e-6;
/// Longest step between samples, in extents; longer edges get samples on their way.
const STEP: f64 = 0.012;
/// Where a line turns further than this at a sample, radians, it does not go on along an arc: circles of twelve samples
/// turn by half a radian.
const MOST_TURN: f64 = 0.7;
/// What a sample put on the way counts beside one of the pen: the edge is a guess between two places that are not.
const WEIGHT_ON_THE_WAY: f64 = 0.02;
/// Shortest step between points of the result, in extents.
const SHORTEST_STEP: f64 = 0.003;
/// Smoothing lengths that are tried, in extents; wiggles shorter than six times the length go.
const LENGTHS: [f64; 13] = [0.003, 0.005, 0.008, 0.012, 0.018, 0.027, 0.04, 0.055, 0.075, 0.1, 0.15, 0.3, 1.];
/// Steps between samples up to this, in extents, may have cut off a corner.
const CUT_TIP: f64 = 0.05;
/// Loops up to this long, in extents, that smoothing leaves are cut off.
const LEAST_LOOP: f64 = 0.25;
/// How uncertain the places of a line are of which only those are kept where it bends, in drawing sizes.
const THINNED_OUT: f64 = 0.002;
/// Smoothing length that one circling gesture asks for, in extents.
const LENGTH_OF_A_GESTURE: f64 = 0.02;

/// A closed line with corners, ready to be smoothed.
pub(super) struct Sides {
    /// Samples from one corner to the next, without the corners; one closed run where there is no corner.
    pub runs: Vec<Vec<Sample>>,
    /// The corner's sample before each run.
    corners: Vec<Sample>,
    /// Whether that is just where the corner is.
    exact: Vec<bool>,
    pub extent: f64,
    pub noise: f64,
    /// Whether only places were kept at which the line bends: tips among them.
    sparse: bool,
}

/// The smooth curve that the samples of a closed line mean; none where nothing is left of it.
///
/// Noise is measured from the samples; of several amounts of smoothing the one with the least expected error is
/// taken (Mallows' C_p). Each side of a corner is smoothed on its own and prolonged to where both meet.
pub(super) fn fair(samples: &[Sample], wishes: &Wishes) -> Option<Contour> {
    let extent = super::line::extent(samples);
    if samples.len() < 3 || extent <= 0. {
        return None;
    }
    let samples = without_repetition(samples, extent);
    let sparse = are_sparse(samples);
    let restored = restored(samples, extent);
    let noise = noise_between(&restored.samples, &restored.corners);
    let dense = densified(&restored.samples, &restored.corners, STEP * extent);
    let lengths = lengths(&dense);
    let known = restored.places_in(&dense);
    let line = Closed { samples: &dense, lengths: &lengths, extent, noise, sparse, known: &known };
    let mut found = corners::find(&line, wishes);
    let mut sides = split(&line, &found);
    if let Some(more) = folds::more(&line, &sides, &found, wishes) {
        found = more;
        sides = split(&line, &found);
    }
    let smooth = least_expected_error(&sides);
    let mut contour = if sides.corners.is_empty() {
        Contour { points: thinned(&smooth[0], SHORTEST_STEP * extent), corners: Vec::new() }
    } else {
        joined(&sides, &smooth)
    };
    untangle(&mut contour, LEAST_LOOP * extent);
    (contour.points.len() >= 3).then_some(contour)
}

/// The smooth line that the samples of an open line mean, from end to end.
pub(super) fn fair_open(samples: &[Sample]) -> Vec<DVec2> {
    let extent = super::line::extent(samples);
    let ends = [0, samples.len() - 1];
    let mut run = densified(samples, &ends, STEP * extent);
    if let Some(last) = run.iter().rposition(|sample| sample.weight > 0.5) {
        // What was put between the last sample and the first would close it.
        run.truncate(last + 1);
    }
    // The ends weigh enough to stay.
    let ends = [0, run.len() - 1];
    ends.into_iter().for_each(|end| run[end].weight = 100.);
    let corners = vec![run[0]];
    let sparse = are_sparse(samples);
    let noise = if sparse { THINNED_OUT } else { noise(samples) };
    let sides = Sides { runs: vec![run], corners, exact: vec![true], extent, noise, sparse };
    least_expected_error(&sides).concat()
}

/// Without samples at the end that are back at the first.
fn without_repetition(samples: &[Sample], extent: f64) -> &[Sample] {
    let far = |sample: &Sample| sample.at.distance(samples[0].at) > REPETITION * extent;
    &samples[..samples.iter().rposition(far).map_or(1, |last| last + 1)]
}

/// Cuts off short loops where the contour crosses itself, such as sides prolonged past each other.
fn untangle(contour: &mut Contour, longest: f64) {
    for _ in 0..32 {
        let Some((i, j, at)) = polygon::first_crossing(&contour.points) else { return };
        let length: f64 = contour.points[i + 1..=j].windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        if length > longest {
            return;
        }
        contour.points.splice(i + 1..=j, [at]);
        let lost = j - i - 1;
        contour.corners.iter_mut().for_each(|corner| match *corner {
            c if c > j => *corner -= lost,
            c if c > i => *corner = i + 1,
            _ => {}
        });
        contour.corners.dedup();
    }
}

/// A closed line with samples on the long ways between others: on the smooth way, but for corners and lines that were
/// thinned out.
fn densified(samples: &[Sample], corners: &[usize], step: f64) -> Vec<Sample> {
    let n = samples.len();
    let mut dense = Vec::with_capacity(n);
    let step = step.max(1e-9);
    let sharp: Vec<bool> = (0..n).map(|i| corners.binary_search(&i).is_ok() || bends(samples, i)).collect();
    for i in 0..n {
        let next = (i + 1) % n;
        let (a, b) = (samples[i], samples[next]);
        dense.push(a);
        let pieces = (a.at.distance(b.at) / step).ceil().clamp(1., 200.) as usize;
        let weight = WEIGHT_ON_THE_WAY * a.weight.min(b.weight);
        let before = (!sharp[i]).then(|| samples[(i + n - 1) % n].at);
        let after = (!sharp[next]).then(|| samples[(i + 2) % n].at);
        let way = Between::new(before, [a.at, b.at], after);
        dense.extend((1..pieces).map(|k| {
            let share = k as f64 / pieces as f64;
            let smoothing = a.smoothing + (b.smoothing - a.smoothing) * share;
            Sample { at: way.at(share), weight, smoothing, sparse: a.sparse }
        }));
    }
    dense
}

/// Whether a line bends at a sample so that it does not go on smoothly.
fn bends(samples: &[Sample], i: usize) -> bool {
    let n = samples.len();
    let [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map(|k| samples[k]);
    a.sparse || b.sparse || c.sparse || (b.at - a.at).angle_to(c.at - b.at).abs() > MOST_TURN
}

/// Length along a closed line up to each sample, and all around.
fn lengths(samples: &[Sample]) -> Vec<f64> {
    let mut gone = 0.;
    let mut lengths = vec![0.];
    for (a, b) in samples.iter().zip(samples.iter().cycle().skip(1)) {
        gone += a.at.distance(b.at).max(1e-9);
        lengths.push(gone);
    }
    lengths
}

fn split(line: &Closed, found: &[usize]) -> Sides {
    let &Closed { samples: dense, extent, sparse, .. } = line;
    let noise = if sparse { line.noise.max(THINNED_OUT) } else { line.noise };
    let n = dense.len();
    let mut runs = Vec::new();
    for (k, &corner) in found.iter().enumerate() {
        let next = if k + 1 < found.len() { found[k + 1] } else { found[0] + n };
        let run: Vec<Sample> = (corner + 1..next).map(|i| dense[i % n]).collect();
        runs.push(without_cut_tips(run, CUT_TIP * extent));
    }
    if found.is_empty() {
        runs.push(dense.to_vec());
    }
    let steady = line.noise < STEADY * extent;
    let exact = found.iter().map(|i| steady && line.known.binary_search(i).is_ok()).collect();
    Sides { runs, corners: found.iter().map(|&i| dense[i]).collect(), exact, extent, noise, sparse }
}

/// The run without what was put between its corners' samples and its first and last drawn ones: if the corner lies
/// between two samples, the straight way between them cuts it off.
fn without_cut_tips(run: Vec<Sample>, reach: f64) -> Vec<Sample> {
    let drawn: Vec<usize> = (0..run.len()).filter(|&i| run[i].weight > 0.5).collect();
    if drawn.len() < 3 {
        return run;
    }
    let (first, last) = (drawn[0], drawn[drawn.len() - 1]);
    let far = |a: usize, b: usize| run[a].at.distance(run[b].at);
    let from = if far(0, first) < reach { first } else { 0 };
    let to = if far(last, run.len() - 1) < reach { last } else { run.len() - 1 };
    run[from..=to].to_vec()
}

impl Sides {
    /// What samples count together on a way of length 1.
    pub fn density(&self) -> f64 {
        let around: f64 = self.runs.iter().map(|run| super::line::length(run)).sum();
        let weight: f64 = self.runs.iter().flatten().map(|sample| sample.weight).sum();
        weight / around.max(1e-9)
    }
}

/// Each run by itself: a straight side bears far more smoothing than a bent one.
fn least_expected_error(sides: &Sides) -> Vec<Vec<DVec2>> {
    let (density, closed) = (sides.density(), sides.corners.is_empty());
    sides.runs.iter().map(|run| least_expected_error_of(run, closed, density, sides).0).collect()
}

/// A run smoothed with the least expected error, and that.
pub(super) fn least_expected_error_of(
    run: &[Sample],
    closed: bool,
    density: f64,
    sides: &Sides,
) -> (Vec<DVec2>, f64) {
    let around = super::line::length(run);
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    for length in LENGTHS.map(|length| length * sides.extent) {
        let smooth = smoothed(run, length, density, sides.extent, closed);
        let squares = run.iter().zip(&smooth).map(|(s, place)| s.weight * s.at.distance_squared(*place));
        let freedom = around / (8f64.sqrt() * length) + 2.;
        let error = squares.sum::<f64>() + 4. * sides.noise * sides.noise * freedom;
        match &best {
            Some((least, _)) if error > 1.5 * least => break,
            Some((least, _)) if error >= *least => {}
            _ => best = Some((error, smooth)),
        }
    }
    best.map(|(error, smooth)| (smooth, error)).unwrap_or_default()
}

fn smoothed(run: &[Sample], length: f64, density: f64, extent: f64, closed: bool) -> Vec<DVec2> {
    let n = run.len();
    let pad = if closed { padding(run, 6. * length.max(0.02 * extent)) } else { 0 };
    let padded: Vec<Sample> = (0..n + 2 * pad).map(|i| run[(i + n - pad) % n]).collect();
    let mut times = Vec::with_capacity(padded.len());
    let mut gone = 0.;
    for (i, sample) in padded.iter().enumerate() {
        gone += if i > 0 { sample.at.distance(padded[i - 1].at).max(1e-5 * extent) } else { 0. };
        times.push(gone);
    }
    let places: Vec<DVec2> = padded.iter().map(|sample| sample.at).collect();
    let weights: Vec<f64> = padded.iter().map(|sample| sample.weight.max(1e-4)).collect();
    let bending: Vec<f64> = padded
        .iter()
        .map(|sample| {
            let asked = LENGTH_OF_A_GESTURE * extent * sample.smoothing;
            density * (length.powi(4) + asked.powi(4))
        })
        .collect();
    let smooth = banded::smooth(&places, &times, &weights, &bending);
    smooth[pad..pad + n].to_vec()
}

/// How many samples a closed line is repeated by at its ends, so that they do not show.
fn padding(run: &[Sample], reach: f64) -> usize {
    let mut gone = 0.;
    let ahead = run.windows(2).take_while(|pair| {
        gone += pair[0].at.distance(pair[1].at);
        gone < reach
    });
    (ahead.count() + 4).min(run.len())
}

/// Sides prolonged to their corners.
fn joined(sides: &Sides, smooth: &[Vec<DVec2>]) -> Contour {
    let count = smooth.len();
    let reach = (0.015 * sides.extent).max(4. * sides.noise);
    let tips: Vec<DVec2> = (0..count)
        .map(|k| match sides.corners[k].at {
            at if sides.exact[k] => at,
            at => tip(&smooth[(k + count - 1) % count], &smooth[k], at, reach, sides),
        })
        .collect();
    let mut contour = Contour::default();
    for (k, side) in smooth.iter().enumerate() {
        let next = tips[(k + 1) % count];
        let start = behind(side.iter().rev().copied(), reach);
        let end = behind(side.iter().copied(), reach);
        let begun = |p: &DVec2| start.is_none_or(|(_, back)| (*p - tips[k]).dot(-back) > 0.);
        let ended = |p: &DVec2| end.is_some_and(|(_, on)| (*p - next).dot(on) >= 0.);
        let first = side.iter().position(begun).unwrap_or(side.len());
        let last = side.iter().rposition(|p| !ended(p)).map_or(0, |i| i + 1);
        contour.corners.push(contour.points.len());
        contour.points.push(tips[k]);
        let inner = side.get(first..last).unwrap_or_default();
        contour.points.extend(between(tips[k], inner, next, SHORTEST_STEP * sides.extent));
    }
    contour
}

/// Where the side before a corner and the side after it meet; the corner's sample if nowhere near it.
fn tip(before: &[DVec2], after: &[DVec2], drawn: DVec2, reach: f64, sides: &Sides) -> DVec2 {
    let meet = behind(before.iter().copied(), reach)
        .zip(behind(after.iter().rev().copied(), reach))
        .and_then(|(a, b)| meeting(a, b));
    let gap = before.last().zip(after.first()).map_or(0., |(a, b)| a.distance(*b));
    let cut_off = if sides.sparse { 0. } else { (1.5 * gap).min(CUT_TIP * sides.extent) };
    let near = cut_off.max(3. * sides.noise).max(0.01 * sides.extent);
    meet.filter(|place| place.distance(drawn) < near).unwrap_or(drawn)
}

/// The last place of a side and the direction in which it ends, over about `reach`.
fn behind(side: impl DoubleEndedIterator<Item = DVec2>, reach: f64) -> Option<(DVec2, DVec2)> {
    let mut back = side.rev();
    let last = back.next()?;
    let far = back.enumerate().take_while(|(i, p)| *i == 0 || p.distance(last) <= reach).last();
    let direction = (last - far?.1).try_normalize()?;
    Some((last, direction))
}

fn between(start: DVec2, inner: &[DVec2], end: DVec2, step: f64) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::new();
    for &p in inner {
        let last = kept.last().copied().unwrap_or(start);
        if p.distance(last) >= step && p.distance(end) >= step {
            kept.push(p);
        }
    }
    kept
}

fn thinned(points: &[DVec2], step: f64) -> Vec<DVec2> {
    let Some(&first) = points.first() else { return Vec::new() };
    let mut kept = vec![first];
    kept.extend(between(first, &points[1..], first, step));
    kept
}

/// Turns a contour so that it runs counter-clockwise, or clockwise.
pub(super) fn turned(mut contour: Contour, counter_clockwise: bool) -> Contour {
    if (polygon::area(&contour.points) > 0.) != counter_clockwise {
        let n = contour.points.len();
        contour.points.reverse();
        contour.corners = contour.corners.iter().rev().map(|&i| n - 1 - i).collect();
    }
    contour
}
