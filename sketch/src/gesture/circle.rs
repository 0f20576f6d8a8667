//! Circling something at least twice: smooth what is inside.

use super::trace::{Trace, hull};
use super::{Context, Gesture};
use crate::stroke::is_inside;
use glam::Vec2;
use std::f32::consts::TAU;

/// Fewest turns about the middle. People who mean two stop a little early; wheels and eyes that are drawn over
/// once more end below one and three quarters.
const TURNS: f32 = 1.85;

/// The nearest that the line may come to the middle, as a part of the farthest: below 1/4, it is a scribble or
/// a spiral; careless circles reach 0.4.
const ROUNDNESS: f32 = 0.25;

/// The least part of all turning about the middle that goes the same way. Circles of a shaking hand have
/// 0.97; loops that wander have less than 0.8.
const STEADINESS: f32 = 0.9;

/// How much smaller the first or last turn may be than the other: spirals are drawings.
const SPIRAL: f32 = 0.5;

/// The polygon to smooth in, if the stroke is a double circle around samples of the sketch.
pub(super) fn smoothed(trace: &Trace, context: &Context) -> Option<Gesture> {
    is_circled_twice(trace).then(|| hull(&trace.points)).and_then(|hull| {
        let holds_something = context.sketch.places().any(|p| is_inside(&hull, p));
        holds_something.then_some(Gesture::Smooth(hull))
    })
}

fn is_circled_twice(trace: &Trace) -> bool {
    let middle = trace.points.iter().sum::<Vec2>() / trace.points.len() as f32;
    let arms: Vec<Vec2> = trace.points.iter().map(|p| p - middle).collect();
    let steps: Vec<f32> = arms.windows(2).map(|pair| pair[0].angle_to(pair[1])).collect();
    let turned: f32 = steps.iter().sum();
    let all_turning: f32 = steps.iter().map(|step| step.abs()).sum();
    if turned.abs() < TURNS * TAU || turned.abs() < STEADINESS * all_turning {
        return false;
    }
    let radii: Vec<f32> = arms.iter().map(|arm| arm.length()).collect();
    let nearest = radii.iter().copied().fold(f32::MAX, f32::min);
    let farthest = radii.iter().copied().fold(0.0, f32::max);
    let turn = (steps.len() as f32 * TAU / turned.abs()) as usize;
    let mean = |part: &[f32]| part.iter().sum::<f32>() / part.len().max(1) as f32;
    let (first, last) = (mean(&radii[..turn]), mean(&radii[radii.len() - turn..]));
    nearest >= ROUNDNESS * farthest && first.min(last) >= SPIRAL * first.max(last)
}
