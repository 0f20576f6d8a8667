//! What the spline of a template must keep to.

use super::contours;
use super::exact::Exact;
use super::levels::Levels;
use super::outline::Outline;
use super::samples::{Sample, Samples};
use crate::thin_plate::{Constraint, CornerRidge, FitError, ThinPlate};
use glam::DVec2;
use rayon::prelude::*;

/// Most constraints of a template. Shapes of ordinary complexity need 300 to 1,000; a tight spiral needs all.
const MOST: usize = 2000;

/// Most of them on the curve, about on one contour of the distance, and on the skeleton of one side, at first.
const MOST_ON_CURVE: f64 = 400.0;
const MOST_ON_CONTOUR: f64 = 80.0;
const MOST_ON_SKELETON: usize = 100;

/// Constraints that one round of corrections adds at most.
const MOST_CORRECTIONS: usize = 400;

/// The least distance between corrections of one round, as a part of the room beside the curve there, and half of it
/// on the curve: closer ones correct the same miss. Beyond 0.6, fields that were turned differ by too much.
const APART: f64 = 0.5;

/// Most places around corners that are looked at.
const MOST_AROUND_CORNERS: usize = 1000;

/// Along the longer side of the curve, samples between which contours are traced; fewer if the falloff is wide.
const TRACED: f64 = 64.0;
const MOST_TRACED: f64 = 192.0;

/// Smoothing away from the curve, where the distance may have kinks that the spline need not follow.
const SMOOTHING: f64 = 1e-5;

/// The smooth spline and the ridges of the corners, which together come close to the signed distance.
pub(super) struct Fitted {
    pub spline: ThinPlate,
    pub ridges: Vec<CornerRidge>,
}

impl Fitted {
    /// The smoothed signed distance at a place.
    pub fn value(&self, p: DVec2) -> f64 {
        self.spline.value(p) + ridges_at(&self.ridges, p)
    }
}

/// The sum of the ridges at a place.
pub(super) fn ridges_at(ridges: &[CornerRidge], p: DVec2) -> f64 {
    ridges.iter().map(|ridge| ridge.value(p)).sum()
}

/// A place that may need a correction.
#[derive(Clone, Copy)]
struct Candidate {
    at: DVec2,
    on_curve: bool,
    /// The least distance from corrections of the same round.
    apart: f64,
}

/// The curve as the fit sees it.
pub(super) struct Subject<'a> {
    pub outline: &'a Outline,
    pub samples: &'a Samples,
    pub levels: &'a Levels,
    /// The longer side of the curve's box.
    pub size: f64,
    pub exact: &'a Exact,
}

impl Subject<'_> {
    /// Fits a spline to the curve, to contours of its distance and to some places of its skeleton, then adds
    /// constraints where it is still off, and fits again.
    pub fn fit(&self) -> Result<Fitted, FitError> {
        let ridges = self.ridges();
        let mut places = self.on_curve();
        places.extend(self.on_contours());
        places.extend(self.on_skeleton(0));
        places.extend(self.on_skeleton(1));
        let mut constraints = self.constraints(&places, &ridges);
        let mut fitted = Fitted { spline: ThinPlate::fit(&constraints)?, ridges };
        // Again only where much is left, as on a shape with many corners, or a spiral.
        let candidates = self.candidates(&fitted.ridges);
        for few in [0, 12, 60] {
            let most = MOST_CORRECTIONS.min(MOST.saturating_sub(constraints.len()));
            let places = self.corrections(&fitted, &candidates, most);
            if places.len() <= few {
                break;
            }
            constraints.extend(self.constraints(&places, &fitted.ridges));
            fitted.spline = ThinPlate::fit(&constraints)?;
        }
        Ok(fitted)
    }

    /// The true distance less the ridges, at places on the curve (true) or off it.
    fn constraints(&self, places: &[(DVec2, bool)], ridges: &[CornerRidge]) -> Vec<Constraint> {
        let constraint = |&(at, on_curve): &(DVec2, bool)| {
            let distance = if on_curve { 0.0 } else { self.outline.distance(at) };
            let smoothing = if on_curve { 0.0 } else { SMOOTHING };
            Constraint { at, value: distance - ridges_at(ridges, at), smoothing }
        };
        places.par_iter().map(constraint).collect()
    }

    fn ridges(&self) -> Vec<CornerRidge> {
        let ridge = |corner: &super::samples::Corner| {
            let radius = (0.6 * self.levels.depth).min(0.8 * corner.room);
            CornerRidge::new(corner.before, corner.at, corner.after, radius)
        };
        self.samples.corners.iter().filter_map(ridge).collect()
    }

    /// Places on the curve, denser where there is less room beside it.
    fn on_curve(&self) -> Vec<(DVec2, bool)> {
        let samples = &self.samples.samples;
        let total: f64 = samples.iter().map(|s| s.length).sum();
        let finest = total / samples.len() as f64;
        let spacing =
            |s: &Sample| (0.7 * s.room[0].min(s.room[1])).clamp(finest, (self.size / 16.0).max(finest));
        let wanted: f64 = samples.iter().map(|s| s.length / spacing(s)).sum();
        let thinner = (wanted / MOST_ON_CURVE).max(1.0);
        let mut passed = 1.0;
        let mut places = Vec::new();
        for sample in samples {
            passed += sample.length / (thinner * spacing(sample));
            if passed >= 1.0 || sample.normal.is_none() {
                passed = if sample.normal.is_none() { 0.0 } else { passed.fract() };
                places.push((sample.at, true));
            }
        }
        places
    }

    fn on_contours(&self) -> Vec<(DVec2, bool)> {
        let mut places = Vec::new();
        let grid = &self.exact.grid;
        let longer = grid.pixel * grid.size[0].max(grid.size[1]) as f64;
        let wanted = (self.size / TRACED).max(longer / MOST_TRACED);
        let coarse = self.exact.coarser(((wanted / grid.pixel) as usize).max(1));
        for level in self.levels.contours() {
            let around: f64 = self.samples.samples.iter().map(|s| s.length).sum();
            let spacing = (0.4 * level.abs()).max(around / MOST_ON_CONTOUR);
            let found = contours::sample(&coarse.samples, &coarse.grid, level, spacing);
            let thinner = (found.len() as f64 / (2.0 * MOST_ON_CONTOUR)).ceil().max(1.0) as usize;
            places.extend(found.into_iter().step_by(thinner).map(|p| (p, false)));
        }
        places
    }

    /// Centres of the largest empty circles inside (0) or outside (1), apart by two thirds of their radii or more.
    fn on_skeleton(&self, side: usize) -> Vec<(DVec2, bool)> {
        let limit = [self.levels.depth, self.levels.falloff][side] * 1.001;
        let centre = |s: &Sample| {
            let (normal, room) = (s.normal?, s.room[side]);
            let fits = room <= limit && room >= 0.2 * self.levels.depth.min(limit);
            fits.then(|| (s.at + normal * if side == 0 { -room } else { room }, room))
        };
        let mut centres: Vec<(DVec2, f64)> = self.samples.samples.iter().filter_map(centre).collect();
        centres.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut kept: Vec<(DVec2, f64)> = Vec::new();
        for (p, room) in centres {
            if kept.len() < MOST_ON_SKELETON && kept.iter().all(|(other, _)| other.distance(p) > 0.7 * room) {
                kept.push((p, room));
            }
        }
        kept.into_iter().map(|(p, _)| (p, false)).collect()
    }

    /// Places that are looked at for corrections: on the curve; beside it, where that is clear of the skeleton; and
    /// around corners.
    fn candidates(&self, ridges: &[CornerRidge]) -> Vec<Candidate> {
        let limits = [self.levels.depth, self.levels.falloff.min(2.0 * self.levels.depth)];
        let samples = &self.samples.samples;
        let step = samples.iter().map(|s| s.length).sum::<f64>() / samples.len() as f64;
        let apart = |room: f64| (APART * room).max(2.0 * step);
        let beside = |s: &Sample, side: usize, share: f64| {
            let room = s.room[side].min(limits[side]);
            let away = share * room;
            let normal = s.normal.filter(|_| away > 0.5 * s.length)?;
            let at = s.at + normal * if side == 0 { -away } else { away };
            Some(Candidate { at, on_curve: false, apart: apart(room) })
        };
        let around = |(i, s): (usize, &Sample)| {
            let room = s.room[0].min(limits[0]).min(s.room[1].min(limits[1]));
            let on_curve = Some(Candidate { at: s.at, on_curve: true, apart: apart(0.5 * room) });
            // Outside, half as many as inside: the true distance takes over there.
            let share = if i.is_multiple_of(2) { 0.3 } else { 0.6 };
            [on_curve, beside(s, 0, 0.3), beside(s, 0, 0.6), beside(s, 1, share)]
        };
        let mut candidates: Vec<_> = samples.iter().enumerate().flat_map(around).flatten().collect();
        // Where a ridge fades, what is left for the spline bends most.
        let turns = (MOST_AROUND_CORNERS / (4 * ridges.len()).max(1)).min(16);
        for ridge in ridges {
            for (turn, share) in (0..turns).flat_map(|turn| [0.4, 0.7, 1.0, 1.3].map(|share| (turn, share))) {
                let angle = std::f64::consts::TAU * turn as f64 / turns as f64;
                let at = ridge.at + share * ridge.radius * DVec2::from_angle(angle);
                candidates.push(Candidate { at, on_curve: false, apart: apart(ridge.radius) });
            }
        }
        candidates
    }

    /// Places where the fit is off by more than 0.04 % of the drawing on the curve, or 5 % of the distance beside
    /// it; the worst first, no two close to each other.
    fn corrections(&self, fitted: &Fitted, candidates: &[Candidate], most: usize) -> Vec<(DVec2, bool)> {
        let miss = |candidate: &Candidate| {
            let distance = if candidate.on_curve { 0.0 } else { self.exact.near(candidate.at) };
            let allowed = if candidate.on_curve { 4e-4 * self.size } else { 0.05 * distance.abs() };
            (fitted.value(candidate.at) - distance).abs() / allowed
        };
        let misses: Vec<f64> = candidates.par_iter().map(miss).collect();
        let mut worst: Vec<usize> = (0..candidates.len()).filter(|&i| misses[i] > 1.0).collect();
        worst.sort_by(|&a, &b| misses[b].total_cmp(&misses[a]));
        let mut kept: Vec<(DVec2, bool)> = Vec::new();
        for i in worst {
            if kept.len() == most {
                break;
            }
            let Candidate { at, on_curve, apart } = candidates[i];
            if kept.iter().all(|(p, _)| p.distance(at) > apart) {
                kept.push((at, on_curve));
            }
        }
        kept
    }
}
