//! Strokes made fit for geometry: finite, without repetitions, bounded in number, and in a frame of size 1.

use blobtree::{Drawing, DrawnStroke};
use glam::DVec2;

/// Samples that no stroke needs more of; what is above is averaged with its neighbours.
const MOST_SAMPLES: usize = 2000;
/// Samples of a whole drawing, shared fairly above that.
const MOST_SAMPLES_IN_ALL: usize = 20_000;
/// Nearer than this to the one before, a sample says nothing new (in drawing sizes).
const REPETITION: f64 = 5e-4;
/// A stroke that stays within this is a dot (in drawing sizes).
const DOT: f64 = 0.004;
/// Shakiness beyond this is taken for shape: no more than half of a shaky hand's 2 %.
pub(super) const MOST_NOISE: f64 = 0.012;

/// Strokes whose samples are further apart than this on average, in drawing sizes, were thinned out to the places
/// where they bend, as files of drawings often are. A hand that shakes by 2 % of the drawing makes steps of 0.025.
const SPARSE: f64 = 0.03;
/// Of such a stroke hardly a sample lies on the straight way between its neighbours, to this share of that way; one
/// drawn fast along straight sides has many.
const ON_THE_WAY: f64 = 0.01;
/// Nor are most of its steps within this share of their median, while most of its samples turn by less than this, in
/// radians: the corners of an octagon are even, but turn further.
const EVEN: f64 = 0.2;
const GENTLE: f64 = 0.45;
/// Of fewer steps than twice this, all may be even by chance.
const FEWEST_EVEN: usize = 6;

/// The times of the cubic come from the noisy samples too, which hides this part of the noise (measured).
const TIMES_FROM_NOISE: f64 = 1.4;

/// A place that the curve should pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub at: DVec2,
    /// How much it counts: 1 for a place of the pen, nearly 0 in a gap.
    pub weight: f64,
    /// How much the user asked to smooth here, see [`blobtree::DrawnPoint::smoothing`].
    pub smoothing: f64,
    /// Whether its stroke was thinned out to the places where it bends.
    pub sparse: bool,
}

/// A cleaned stroke.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Its place in the drawing.
    pub stroke: usize,
    pub samples: Vec<Sample>,
}

/// From mm to a frame in which the longer side of the drawing is 1 and its middle 0, and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    middle: DVec2,
    size: f64,
}

impl Frame {
    /// None where there is no finite point.
    pub fn of(drawing: &Drawing) -> Option<Self> {
        let places = || finite_points(drawing.strokes.iter()).map(|(at, _)| at);
        let least = places().reduce(DVec2::min)?;
        let most = places().reduce(DVec2::max)?;
        let size = (most - least).max_element();
        Some(Self { middle: least.midpoint(most), size: if size > 0. { size } else { 1. } })
    }

    pub fn local(&self, at: DVec2) -> DVec2 {
        (at - self.middle) / self.size
    }

    pub fn global(&self, at: DVec2) -> DVec2 {
        self.middle + at * self.size
    }

    /// mm for one unit of the frame.
    pub fn size(&self) -> f64 {
        self.size
    }
}

fn finite_points<'a>(strokes: impl Iterator<Item = &'a DrawnStroke>) -> impl Iterator<Item = (DVec2, f32)> {
    strokes
        .flat_map(|stroke| &stroke.points)
        .filter(|point| point.at.is_finite())
        .map(|point| (point.at.as_dvec2(), point.smoothing))
}

/// The strokes that are more than dots, in the drawing's frame.
pub(super) fn clean(drawing: &Drawing, frame: &Frame) -> Vec<Line> {
    let mut lines: Vec<Line> = drawing
        .strokes
        .iter()
        .enumerate()
        .map(|(stroke, drawn)| Line { stroke, samples: distinct_samples(drawn, frame) })
        .filter(|line| line.samples.len() > 1 && extent(&line.samples) > DOT)
        .collect();
    let total: usize = lines.iter().map(|line| line.samples.len().min(MOST_SAMPLES)).sum();
    let share = (MOST_SAMPLES_IN_ALL as f64 / total.max(1) as f64).min(1.);
    for line in &mut lines {
        let most = (MOST_SAMPLES as f64 * share) as usize;
        let group = line.samples.len().div_ceil(most.max(8));
        line.samples = averaged(&line.samples, group);
        calm(&mut line.samples);
    }
    lines
}

fn distinct_samples(drawn: &DrawnStroke, frame: &Frame) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::new();
    for (at, smoothing) in finite_points(std::iter::once(drawn)) {
        let at = frame.local(at);
        if samples.last().is_some_and(|last| last.at.distance(at) < REPETITION) {
            continue;
        }
        let smoothing = f64::from(if smoothing.is_finite() { smoothing.clamp(0., 100.) } else { 0. });
        samples.push(Sample { at, weight: 1., smoothing, sparse: false });
    }
    let step = length(&samples) / samples.len() as f64;
    let sparse = step > SPARSE && 4 * on_the_way(&samples) < samples.len() && !goes_evenly(&samples);
    samples.iter_mut().for_each(|sample| sample.sparse = sparse);
    samples
}

/// How many samples lie on the straight way between their neighbours.
pub(super) fn on_the_way(samples: &[Sample]) -> usize {
    let straight = |three: &&[Sample]| {
        let (way, aside) = (three[2].at - three[0].at, three[1].at - three[0].at);
        way.perp_dot(aside).abs() <= ON_THE_WAY * way.length_squared() && way.dot(aside) > 0.
    };
    samples.windows(3).filter(straight).count()
}

/// Whether samples follow each other at even steps around gentle bends, as a pen leaves them and no thinning out does.
fn goes_evenly(samples: &[Sample]) -> bool {
    let mut steps: Vec<f64> = samples.windows(2).map(|two| two[0].at.distance(two[1].at)).collect();
    let middle = steps.len() / 2;
    if middle < FEWEST_EVEN {
        return false;
    }
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    let median = *median;
    let even = steps.iter().filter(|step| (*step / median - 1.).abs() < EVEN).count();
    let turn = |three: &[Sample]| (three[1].at - three[0].at).angle_to(three[2].at - three[1].at).abs();
    let gentle = samples.windows(3).filter(|three| turn(three) < GENTLE).count();
    3 * even > 2 * steps.len() && 3 * gentle > 2 * (samples.len() - 2)
}

/// Whether most of the drawn samples are of strokes that were thinned out.
pub(super) fn are_sparse(samples: &[Sample]) -> bool {
    let drawn = || samples.iter().filter(|sample| sample.weight > 0.5);
    2 * drawn().filter(|sample| sample.sparse).count() > drawn().count()
}

/// About every `group` of neighbours becomes their mean.
fn averaged(samples: &[Sample], group: usize) -> Vec<Sample> {
    if group < 2 || samples.len() < 3 {
        return samples.to_vec();
    }
    let mean = |some: &[Sample]| Sample {
        at: some.iter().map(|s| s.at).sum::<DVec2>() / some.len() as f64,
        weight: 1.,
        smoothing: some.iter().map(|s| s.smoothing).sum::<f64>() / some.len() as f64,
        sparse: some[0].sparse,
    };
    let (n, groups) = (samples.len(), samples.len() / group);
    (0..groups).map(|k| mean(&samples[k * n / groups..(k + 1) * n / groups])).collect()
}

/// Averages neighbours until a step along the stroke is longer than its noise, so that it goes forward.
fn calm(samples: &mut Vec<Sample>) {
    while samples.len() > 24 {
        let step = length(samples) / samples.len() as f64;
        if noise(samples) < 0.3 * step {
            break;
        }
        *samples = averaged(samples, 2);
    }
}

/// Standard deviation of the samples from a smooth curve, in each coordinate.
///
/// Each sample is compared with the cubic through its four neighbours. The median makes corners harmless. Of lines
/// that were thinned out a cubic says nothing, and the answer is 0.
pub(super) fn noise(samples: &[Sample]) -> f64 {
    noise_between(samples, &[])
}

/// As [`noise`], of lines with corners known to be at some of the samples, ascending.
pub(super) fn noise_between(samples: &[Sample], corners: &[usize]) -> f64 {
    let smooth = |first: usize| {
        let next = corners.partition_point(|&corner| corner < first);
        corners.get(next).is_none_or(|&corner| corner > first + 4)
    };
    let fives = samples.windows(5).enumerate().filter(|(first, _)| smooth(*first));
    let mut squares: Vec<f64> = fives.map(|(_, five)| cubic_misfit(five)).collect();
    if squares.len() < 8 || are_sparse(samples) {
        return 0.;
    }
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    // The median of a χ² with two degrees of freedom is 2 ln 2.
    (TIMES_FROM_NOISE * (*median / std::f64::consts::LN_2 / 2.).sqrt()).min(MOST_NOISE)
}

/// Square of the middle sample's distance from the cubic through the others, over the variance that noise of
/// deviation 1 would give it.
fn cubic_misfit(five: &[Sample]) -> f64 {
    let mut times = [0.; 5];
    for i in 1..5 {
        times[i] = times[i - 1] + five[i].at.distance(five[i - 1].at).sqrt();
    }
    let mut off = five[2].at;
    let mut variance = 1.;
    for i in [0, 1, 3, 4] {
        let weight: f64 = [0, 1, 3, 4]
            .iter()
            .filter(|&&j| j != i)
            .map(|&j| (times[2] - times[j]) / (times[i] - times[j]))
            .product();
        off -= weight * five[i].at;
        variance += weight * weight;
    }
    let misfit = off.length_squared() / variance;
    if misfit.is_finite() { misfit } else { 0. }
}

/// A length in steps that rounding errors do not reach, in drawing sizes, for comparing: what people and programs draw
/// is often just as long. Of whole numbers of something, none lies between two steps, which are a power of two.
pub(super) fn coarse(length: f64) -> f64 {
    (length * 131_072.).round()
}

pub(super) fn length(samples: &[Sample]) -> f64 {
    samples.windows(2).map(|pair| pair[0].at.distance(pair[1].at)).sum()
}

/// The longer side of the box around the samples.
pub(super) fn extent(samples: &[Sample]) -> f64 {
    let least = samples.iter().map(|s| s.at).reduce(DVec2::min);
    let most = samples.iter().map(|s| s.at).reduce(DVec2::max);
    least.zip(most).map_or(0., |(least, most)| (most - least).max_element())
}
