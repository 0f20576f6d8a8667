//! From what a device reports to what a hand drew.

use super::{PenSample, Stroke};
use glam::Vec2;

/// The farthest from the screen's corner that a sample can be, pixels: beyond the largest wall of screens, and
/// small enough for `f32` to keep 1/16 of a pixel.
pub const MAX_COORDINATE: f32 = 1e6;

/// Most samples that resampling makes.
const MAX_RESAMPLED: usize = 1_000_000;

/// A lone sample this many typical steps away from both its neighbours is a fault of the device. Fast pens step
/// 3 to 4 times their typical step where they start to run, and digitizers that lose the pen report places
/// across the screen.
const SPIKE_STEPS: f32 = 8.0;

/// Fewest samples that show what a typical step is.
const FEWEST_FOR_STEPS: usize = 16;

/// A stroke is dense, as devices report it, if nine of ten steps are within this many typical ones. Files often
/// keep only where a line bends; their steps differ far more, and long ones in them are meant.
const DENSE_SPREAD: f32 = 4.0;

/// Samples on whole steps of the hardware show stairs where they are fewer than this many steps apart.
const STAIRS: f32 = 3.0;

/// Takes out of a stroke what no hand drew.
///
/// - **Dropped:** samples that are not finite or not within [`MAX_COORDINATE`], samples at the same place as
///   the one before (the higher pressure stays), and in dense strokes lone samples far off the line.
/// - **Mended:** unknown or impossible pressures and tilts become those of a device without them, and times
///   never run backwards.
/// - **Smoothed:** stairs of the hardware's whole steps, each sample by at most the half step by which it was
///   rounded.
/// - **Promises:** the result is finite, and cleaning it again drops nothing. **Cost:** linear.
pub fn clean(stroke: &Stroke) -> Stroke {
    let mut samples = merged(stroke.samples.iter().filter_map(mended));
    let mut latest = f32::NEG_INFINITY;
    for sample in &mut samples {
        sample.time = sample.time.map(|time| time.max(latest));
        latest = sample.time.unwrap_or(latest);
    }
    let samples = without_stairs(without_spikes(samples));
    Stroke { samples, eraser: stroke.eraser }
}

/// The sample with every number in its range; `None` if its place is not known.
fn mended(sample: &PenSample) -> Option<PenSample> {
    let known = sample.place().is_finite() && sample.place().abs().max_element() <= MAX_COORDINATE;
    let pressure = if sample.pressure.is_nan() { 1.0 } else { sample.pressure.clamp(0.0, 1.0) };
    let tilt = sample.tilt.map(|degrees| if degrees.is_finite() { degrees.clamp(-90.0, 90.0) } else { 0.0 });
    let time = sample.time.filter(|time| time.is_finite());
    known.then_some(PenSample { time, pressure, tilt, ..*sample })
}

/// Without samples that repeat the place before.
fn merged(samples: impl Iterator<Item = PenSample>) -> Vec<PenSample> {
    let mut kept: Vec<PenSample> = Vec::new();
    for sample in samples {
        match kept.last_mut() {
            Some(last) if last.place() == sample.place() => {
                last.pressure = last.pressure.max(sample.pressure);
            }
            _ => kept.push(sample),
        }
    }
    kept
}

/// The typical step of a dense stroke, pixels; `None` for sparse and short ones.
fn typical_step(samples: &[PenSample]) -> Option<f32> {
    if samples.len() < FEWEST_FOR_STEPS {
        return None;
    }
    let mut steps: Vec<f32> =
        samples.windows(2).map(|pair| pair[0].place().distance(pair[1].place())).collect();
    let (middle, nine_of_ten) = (steps.len() / 2, steps.len() * 9 / 10);
    let typical = *steps.select_nth_unstable_by(middle, f32::total_cmp).1;
    let long = *steps.select_nth_unstable_by(nine_of_ten, f32::total_cmp).1;
    (typical > 0.0 && long <= DENSE_SPREAD * typical).then_some(typical)
}

fn without_spikes(samples: Vec<PenSample>) -> Vec<PenSample> {
    let Some(step) = typical_step(&samples) else { return samples };
    let far = |a: &PenSample, b: &PenSample| a.place().distance(b.place()) > SPIKE_STEPS * step;
    let is_spike = |i: usize| {
        let here = &samples[i];
        let before = i.checked_sub(1).map(|i| &samples[i]);
        let after = samples.get(i + 1);
        match (before, after) {
            (Some(before), Some(after)) => far(here, before) && far(here, after) && !far(before, after),
            _ => false,
        }
    };
    let kept: Vec<PenSample> = (0..samples.len()).filter(|&i| !is_spike(i)).map(|i| samples[i]).collect();
    merged(kept.into_iter())
}

/// Smooths dense samples on whole steps of the hardware, each by at most half a step.
fn without_stairs(mut samples: Vec<PenSample>) -> Vec<PenSample> {
    let on_whole_steps = samples.iter().all(|s| s.x.fract() == 0.0 && s.y.fract() == 0.0);
    if !on_whole_steps || typical_step(&samples).is_none_or(|step| step > STAIRS) {
        return samples;
    }
    let reported: Vec<Vec2> = samples.iter().map(PenSample::place).collect();
    for _ in 0..2 {
        let before: Vec<Vec2> = samples.iter().map(PenSample::place).collect();
        for i in 1..samples.len() - 1 {
            let mean = 0.25 * (before[i - 1] + 2.0 * before[i] + before[i + 1]);
            let half = Vec2::splat(0.5);
            let p = mean.clamp(reported[i] - half, reported[i] + half);
            (samples[i].x, samples[i].y) = (p.x, p.y);
        }
    }
    merged(samples.into_iter())
}

/// The stroke with samples at equal distances along its line, `spacing` pixels or a little less; its ends stay.
///
/// Times, pressures and tilts between samples are interpolated. Where the stroke would need more than a million
/// samples, or `spacing` is not above 0, the spacing is larger. A single sample stays as it is.
/// Corners between new samples are cut by less than half a spacing. **Cost:** linear in both.
pub fn resample(stroke: &Stroke, spacing: f32) -> Stroke {
    let total: f64 = stroke.samples.windows(2).map(|p| step(&p[0], &p[1])).sum();
    if stroke.samples.len() < 2 || !total.is_finite() || total == 0.0 {
        return stroke.clone();
    }
    let wanted = (total / f64::from(spacing.max(0.0))).ceil();
    let count = wanted.clamp(1.0, MAX_RESAMPLED as f64) as usize;
    let mut samples = Vec::with_capacity(count + 1);
    let (mut along, mut pair) = (0.0, 0);
    for i in 0..count {
        let target = total * i as f64 / count as f64;
        let mut length = step(&stroke.samples[pair], &stroke.samples[pair + 1]);
        while along + length < target && pair + 2 < stroke.samples.len() {
            along += length;
            pair += 1;
            length = step(&stroke.samples[pair], &stroke.samples[pair + 1]);
        }
        let part = if length > 0.0 { ((target - along) / length).clamp(0.0, 1.0) as f32 } else { 0.0 };
        samples.push(between(&stroke.samples[pair], &stroke.samples[pair + 1], part));
    }
    samples.extend(stroke.samples.last());
    Stroke { samples, eraser: stroke.eraser }
}

fn step(a: &PenSample, b: &PenSample) -> f64 {
    a.place().as_dvec2().distance(b.place().as_dvec2())
}

pub(super) fn between(a: &PenSample, b: &PenSample, part: f32) -> PenSample {
    let mix = |from: f32, to: f32| from + (to - from) * part;
    PenSample {
        x: mix(a.x, b.x),
        y: mix(a.y, b.y),
        time: a.time.zip(b.time).map(|(from, to)| mix(from, to)),
        pressure: mix(a.pressure, b.pressure),
        tilt: [mix(a.tilt[0], b.tilt[0]), mix(a.tilt[1], b.tilt[1])],
    }
}
