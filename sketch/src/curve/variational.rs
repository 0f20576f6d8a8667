//! The zero set of a thin-plate spline: the smoothest curve through the places of a contour.

use super::Contour;
use super::polygon;
use crate::thin_plate::{Constraint, CornerRidge, ThinPlate};
use glam::DVec2;

/// Constraints on all curves together; as many again are beside them.
const MOST_ON_CURVES: usize = 300;
/// With more contours than this, too few constraints are left for each; they stay as they are.
const MOST_CONTOURS: usize = 25;
/// Fewest constraints on a curve.
const FEWEST_ON_A_CURVE: usize = 10;
/// Beside the curve, the spline is held at this distance, in extents of the contour.
const BESIDE: f64 = 0.02;
/// How much of the constraints goes where the curve turns, and near corners, rather than where it is long.
const TURN_SHARE: f64 = 0.3;
const CORNER_SHARE: f64 = 0.3;
/// The spline's smoothing, see [`Constraint::smoothing`]: none that could be seen.
const SMOOTHING: f64 = 1e-7;
/// Ridges reach this far from their corners at most, in extents.
const RIDGE: f64 = 0.08;
/// No point moves further, in extents; beyond, the spline is no longer about the same curve.
const MOST_SHIFT: f64 = 0.004;

/// Moves every point of the contours onto the zero set of the spline that takes 0 on them and the signed distance
/// beside them; contours stay as they are where the spline disagrees about their order in the plane.
///
/// Following the contours, not the grid lines of a picture, keeps spurious loops of the spline out.
pub(super) fn refined(contours: Vec<Contour>) -> Vec<Contour> {
    if contours.len() > MOST_CONTOURS {
        return contours;
    }
    let Some((spline, ridges)) = fitted(&contours) else { return contours };
    let value = |p: DVec2| spline.value(p) + ridges.iter().map(|ridge| ridge.value(p)).sum::<f64>();
    let moved: Vec<Contour> = contours
        .iter()
        .map(|contour| {
            let most = MOST_SHIFT * polygon::extent(&contour.points);
            let normals = normals(&contour.points);
            let onto_zero = |(i, &p): (usize, &DVec2)| {
                let sharp = contour.corners.binary_search(&i).is_ok();
                let shift = if sharp { 0. } else { shift(&value, p, normals[i], most) };
                p + shift * normals[i]
            };
            let points = contour.points.iter().enumerate().map(onto_zero).collect();
            Contour { points, corners: contour.corners.clone() }
        })
        .collect();
    if polygon::cross(moved.iter().map(|contour| &contour.points[..])) { contours } else { moved }
}

/// How far to go along the normal to where the distance-like value is 0, but no further than `most`.
fn shift(value: &impl Fn(DVec2) -> f64, at: DVec2, normal: DVec2, most: f64) -> f64 {
    let mut shift: f64 = 0.;
    for _ in 0..2 {
        shift = (shift - value(at + shift * normal)).clamp(-most, most);
    }
    if shift.is_nan() { 0. } else { shift }
}

/// Unit normals to the right of the way, out of what lies to the left.
fn normals(points: &[DVec2]) -> Vec<DVec2> {
    let n = points.len();
    let across = |i: usize| points[(i + 1) % n] - points[(i + n - 1) % n];
    (0..n).map(|i| -across(i).perp().normalize_or_zero()).collect()
}

fn fitted(contours: &[Contour]) -> Option<(ThinPlate, Vec<CornerRidge>)> {
    let measures: Vec<Vec<f64>> = contours.iter().map(measure).collect();
    let share = MOST_ON_CURVES as f64 / contours.len() as f64;
    let ridges: Vec<CornerRidge> = contours.iter().flat_map(|c| ridges(c, contours)).collect();
    let ridge_value = |p: DVec2| ridges.iter().map(|ridge| ridge.value(p)).sum::<f64>();
    let mut constraints = Vec::new();
    for (contour, measure) in contours.iter().zip(&measures) {
        let count = (share as usize).clamp(FEWEST_ON_A_CURVE, 24 + 4 * contour.points.len());
        let extent = polygon::extent(&contour.points);
        let normals = normals(&contour.points);
        for (k, i) in spread(measure, count, &contour.corners).into_iter().enumerate() {
            let at = contour.points[i];
            constraints.push((at, 0.));
            if contour.corners.binary_search(&i).is_ok() {
                continue;
            }
            // Sides take turns: together they hold the slope.
            let side = if k % 2 == 0 { 1. } else { -1. };
            constraints
                .extend(beside(contours, at, side * normals[i], BESIDE * extent).map(|(p, d)| (p, side * d)));
        }
    }
    let constraints: Vec<Constraint> = constraints
        .into_iter()
        .map(|(at, value)| Constraint { at, value: value - ridge_value(at), smoothing: SMOOTHING })
        .collect();
    Some((ThinPlate::fit(&constraints).ok()?, ridges))
}

/// How much of the constraints each point's way to the next one deserves; 1 altogether.
fn measure(contour: &Contour) -> Vec<f64> {
    let points = &contour.points;
    let n = points.len();
    let reach = RIDGE * polygon::extent(points);
    let corners: Vec<DVec2> = contour.corners.iter().map(|&i| points[i]).collect();
    let length = |i: usize| points[i].distance(points[(i + 1) % n]);
    let turn = |i: usize| {
        let (before, after) = (points[i] - points[(i + n - 1) % n], points[(i + 1) % n] - points[i]);
        if contour.corners.binary_search(&i).is_ok() { 0. } else { before.angle_to(after).abs() }
    };
    let near = |i: usize| corners.iter().any(|corner| corner.distance_squared(points[i]) < reach * reach);
    let measures: [Vec<f64>; 3] = [
        (0..n).map(length).collect(),
        (0..n).map(turn).collect(),
        (0..n).map(|i| if near(i) { length(i) } else { 0. }).collect(),
    ];
    let shares = [1. - TURN_SHARE - CORNER_SHARE, TURN_SHARE, CORNER_SHARE];
    let totals = [0, 1, 2].map(|k| measures[k].iter().sum::<f64>().max(1e-9));
    (0..n).map(|i| (0..3).map(|k| shares[k] * measures[k][i] / totals[k]).sum()).collect()
}

/// Points of equal measure apart, and the corners; ascending.
fn spread(measure: &[f64], count: usize, corners: &[usize]) -> Vec<usize> {
    let total: f64 = measure.iter().sum();
    let mut gone = 0.;
    let mut next = 0.;
    let mut chosen = Vec::with_capacity(count);
    for (i, part) in measure.iter().enumerate() {
        if gone >= next || corners.binary_search(&i).is_ok() {
            chosen.push(i);
            next = gone + total / count as f64;
        }
        gone += part;
    }
    chosen
}

/// A place in a direction off a curve that is not nearer to any other part of the curves, and its distance.
fn beside(contours: &[Contour], at: DVec2, direction: DVec2, far: f64) -> Option<(DVec2, f64)> {
    let clear = |distance: f64| {
        let place = at + distance * direction;
        let near = (0.9 * distance).powi(2);
        let points = contours.iter().flat_map(|contour| &contour.points);
        points.into_iter().all(|p| p.distance_squared(place) >= near)
    };
    [1., 0.5, 0.25, 0.1]
        .map(|share| share * far)
        .into_iter()
        .find(|&d| clear(d))
        .map(|d| (at + d * direction, d))
}

/// The ridges of a contour's corners, each kept from the next corner and from other parts of the curves.
fn ridges(contour: &Contour, contours: &[Contour]) -> Vec<CornerRidge> {
    let n = contour.points.len();
    let extent = polygon::extent(&contour.points);
    let ridge = |&i: &usize| {
        let at = contour.points[i];
        let corners = contours.iter().flat_map(|c| c.corners.iter().map(|&k| c.points[k]));
        let nearest = corners.filter(|&corner| corner != at).map(|corner| corner.distance(at));
        let radius = (0.6 * nearest.fold(f64::INFINITY, f64::min)).min(RIDGE * extent);
        let leg = |step: usize| {
            let ahead = (1..n).map(|k| contour.points[(i + k * step) % n]);
            ahead
                .take(n / 4)
                .find(|p| p.distance(at) > 0.15 * radius)
                .unwrap_or(contour.points[(i + step) % n])
        };
        CornerRidge::new(leg(n - 1), at, leg(1), radius)
    };
    contour.corners.iter().filter_map(ridge).collect()
}
