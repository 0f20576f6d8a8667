//! Drawings moved along a path.

use super::extrusion::{rounded, rounded_bound};
use super::frame::Range;
use super::section::Section;
use super::solid::Solid;
use crate::checks::SHORTEST;
use crate::field::Aabb;
use crate::scalar::{Scalar, Slope, Triple, difference, dot};
use crate::sketched::{PathSweep, Rectangle};
use glam::{DQuat, DVec3, Vec2, Vec3};

/// How fast the distance grows beyond the plane in which two parts meet: at a bend by twice the angle φ, going
/// straight on must not stick out of the next part, for which 2 sin φ is enough.
const BEYOND: f32 = 2.0;
/// Parts that turn by more than this end square, or the outside of the bend would become a long spike; cosine
/// of half the angle of 120°.
const SHARPEST: f64 = 0.5;
/// Parts in a group that is passed over at once.
const GROUP: usize = 8;

/// The section along a polyline, with rotation-minimising frames.
///
/// Each part is a prism between the planes halfway to its neighbours, in which their surfaces meet. Outside
/// these planes its distance grows, so that where prisms overlap, as inside tight bends, the field is still
/// continuous.
#[derive(Clone, Debug)]
pub(crate) struct Pipe {
    section: Section,
    parts: Vec<Part>,
    /// Boxes outside which the field of some parts in a row is 0.
    groups: Vec<Aabb>,
    /// The deepest that the section gets.
    depth: f32,
    fillet: f32,
}

/// One straight part.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: Vec3,
    /// Directions of the section's x and y, and along the path.
    axes: [Vec3; 3],
    length: f32,
    /// Where the path's start lies in the section.
    shift: Vec2,
    /// The way out through the planes at both ends.
    ends: [Vec3; 2],
    /// Whether the path ends here.
    capped: [bool; 2],
}

/// Where a place lies in a part.
struct Within<S> {
    at: [S; 2],
    along: S,
    /// How far beyond the plane to the next part, with the direction; at most one of them counts.
    beyond: S,
    out: Vec3,
}

impl Part {
    #[inline(always)]
    fn locate<S: Scalar>(&self, q: Triple<S>) -> Within<S> {
        let triple = |v: Vec3| v.to_array().map(S::of);
        let p = difference(q, triple(self.start));
        let [x, y, along] = self.axes.map(|axis| dot(p, triple(axis)));
        let before = dot(p, triple(self.ends[0]));
        let after = dot(p, triple(self.ends[1])) - S::of(self.length * self.ends[1].dot(self.axes[2]));
        let (mut beyond, mut out) = (S::of(0.0), Vec3::ZERO);
        for (end, past) in [before, after].into_iter().enumerate() {
            if !self.capped[end] && past.value() > beyond.value() {
                (beyond, out) = (past, self.ends[end]);
            }
        }
        Within { at: [x + S::of(self.shift.x), y + S::of(self.shift.y)], along, beyond, out }
    }

    /// Where the plane at an end lies along the part, at this place of the section.
    fn end(&self, end: usize, at: Vec2) -> f32 {
        let (out, place) = (self.ends[end], at - self.shift);
        let across = out.dot(self.axes[0]) * place.x + out.dot(self.axes[1]) * place.y;
        (if end == 0 { 0.0 } else { self.length }) - across / out.dot(self.axes[2])
    }

    /// A box around everything within `reach` of the section, as far as `beyond` past the ends.
    fn reach(&self, reach: &Rectangle, beyond: f32) -> Aabb {
        let corners = [0, 1, 2, 3].map(|i| {
            Vec2::new(
                if i & 1 == 0 { reach.min.x } else { reach.max.x },
                if i & 2 == 0 { reach.min.y } else { reach.max.y },
            )
        });
        let points = [0, 1].into_iter().flat_map(|end| {
            corners.map(|at| {
                let past = beyond / self.ends[end].dot(self.axes[2]);
                let place = at - self.shift;
                let [x, y, z] = self.axes;
                self.start + x * place.x + y * place.y + z * (self.end(end, at) + past)
            })
        });
        Aabb::of_points(points)
    }

    /// Bounds of the part's distance, in a range around a place.
    fn bound(&self, pipe: &Pipe, range: &Range) -> (f32, f32) {
        let within = self.locate(range.center.to_array());
        let spread = |axis: Vec3| axis.abs().dot(range.half) * (1.0 + 1e-5) + 1e-5 * range.center.length();
        let half = Vec2::new(spread(self.axes[0]), spread(self.axes[1]));
        let at = Vec2::from_array(within.at);
        let side = pipe.section.bound(&Rectangle { min: at - half, max: at + half });
        let along = spread(self.axes[2]);
        let caps = [-within.along, within.along - self.length];
        let mut both = side;
        for (cap, _) in caps.into_iter().zip(self.capped).filter(|(_, capped)| *capped) {
            both = rounded_bound(both, (cap - along, cap + along), pipe.fillet);
        }
        let p = range.center - self.start;
        let (mut lo, mut hi) = (0.0f32, 0.0f32);
        for (end, out) in self.ends.into_iter().enumerate().filter(|(end, _)| !self.capped[*end]) {
            let past = p.dot(out) - if end == 0 { 0.0 } else { self.length * out.dot(self.axes[2]) };
            (lo, hi) = (lo.max(past - spread(out)), hi.max(past + spread(out)));
        }
        (both.0 + BEYOND * lo, both.1 + BEYOND * hi)
    }
}

impl Pipe {
    pub fn new(sweep: &PathSweep, section: Section) -> Self {
        let template = &*sweep.template;
        let deepest = template.distance.bound(section.reach().min, section.reach().max).0;
        let depth = template.depth.max(-deepest);
        let beyond = (section.far() + depth) / BEYOND;
        let parts = parts(sweep);
        let group = |parts: &[Part]| {
            parts.iter().fold(Aabb::EMPTY, |all, part| all.union(&part.reach(&section.reach(), beyond)))
        };
        let room = |b: Aabb| b.grown(1e-5 * b.min.abs().max(b.max.abs()).max_element());
        let groups = parts.chunks(GROUP).map(group).map(room).collect();
        Self { groups, parts, depth, fillet: sweep.fillet.min(template.depth), section }
    }

    /// The box outside which the field is 0.
    pub fn reach(&self) -> Aabb {
        let is_empty = self.section.reach().min.cmpgt(self.section.reach().max).any();
        if is_empty {
            Aabb::EMPTY
        } else {
            self.groups.iter().fold(Aabb::EMPTY, |all, group| all.union(group))
        }
    }

    /// The distance from a part, unless it is no less than `limit`.
    #[inline(always)]
    fn part<S: Scalar>(&self, number: usize, q: Triple<S>, limit: f32) -> Option<Slope<S>> {
        let part = &self.parts[number];
        let within = part.locate(q);
        if BEYOND * within.beyond.value() - self.depth >= limit {
            return None;
        }
        let reading = self.section.read(within.at);
        let along = |x: S, axis: Vec3| axis.to_array().map(|c| x * S::of(c));
        let (a, b) = (along(reading.slope[0], part.axes[0]), along(reading.slope[1], part.axes[1]));
        let piece = 4 * self.section.piece(within.at.map(S::value));
        let mut d = Slope::new(reading.value, crate::scalar::sum(a, b)).on(piece);
        let caps = [(-within.along, -part.axes[2]), (within.along - S::of(part.length), part.axes[2])];
        for (end, (cap, out)) in caps.into_iter().enumerate().filter(|(end, _)| part.capped[*end]) {
            d = rounded(d, Slope::new(cap, out.to_array().map(S::of)).on(1 + end as u32), self.fillet);
        }
        let push = within.out.to_array();
        Some(Slope {
            value: d.value + S::of(BEYOND) * within.beyond,
            gradient: std::array::from_fn(|a| d.gradient[a] + S::of(BEYOND * push[a])),
            piece: d.piece.wrapping_mul(2 * self.parts.len() as u32)
                + 2 * number as u32
                + u32::from(push != [0.0; 3]),
        })
    }
}

impl Solid for Pipe {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let mut nearest: Slope<S> = Slope::constant(self.section.far());
        let place = Vec3::from_array(q.map(S::value));
        for (group, reach) in self.groups.iter().enumerate() {
            if !reach.contains(place) {
                continue;
            }
            for number in group * GROUP..self.parts.len().min((group + 1) * GROUP) {
                match self.part(number, q, nearest.value.value()) {
                    Some(part) if part.value.value() < nearest.value.value() => nearest = part,
                    _ => {}
                }
            }
        }
        nearest
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let (far, region) = (self.section.far(), range.to_box());
        let mut all = (far, far);
        for (group, _) in self.groups.iter().enumerate().filter(|(_, reach)| reach.overlaps(&region)) {
            for part in self.parts.iter().skip(group * GROUP).take(GROUP) {
                let one = part.bound(self, range);
                all = (all.0.min(one.0), all.1.min(one.1));
            }
        }
        all
    }

    fn creased(&self, _range: &Range) -> bool {
        true
    }

    /// Most bends are faint.
    fn is_faceted(&self) -> bool {
        true
    }
}

/// The straight parts of a path, each with the section's axes turned as little as possible from the one before;
/// on a closed path, by as much more, evenly, as lets the ends meet.
fn parts(sweep: &PathSweep) -> Vec<Part> {
    let (points, closed) = corners(&sweep.path);
    let along: Vec<DVec3> =
        points.windows(2).map(|pair| (pair[1] - pair[0]).normalize_or(DVec3::Z)).collect();
    let count = along.len();
    let [right, up, normal] = sweep.plane.precise_axes();
    let (shift, _) = sweep.plane.project(points[0].as_vec3());
    let toward = if normal.dot(along[0]) < 0.0 { -normal } else { normal };
    let mut turn = DQuat::from_rotation_arc(toward, along[0]);
    let mut axes = Vec::with_capacity(count);
    for i in 0..count {
        if i > 0 {
            turn = DQuat::from_rotation_arc(along[i - 1], along[i]) * turn;
        }
        axes.push([turn * right, turn * up]);
    }
    if closed {
        let back = DQuat::from_rotation_arc(along[count - 1], along[0]) * axes[count - 1][0];
        let twist = back.cross(axes[0][0]).dot(along[0]).atan2(back.dot(axes[0][0]));
        for (i, axes) in axes.iter_mut().enumerate() {
            let more = DQuat::from_axis_angle(along[i], twist * i as f64 / count as f64);
            *axes = axes.map(|axis| more * axis);
        }
    }
    let plane_between = |a: DVec3, b: DVec3| {
        let between = (a + b).normalize_or_zero();
        if between.dot(a) < SHARPEST { a } else { between }
    };
    let part = |i: usize| {
        let (first, last) = (i == 0 && !closed, i + 1 == count && !closed);
        let before = if first { along[i] } else { plane_between(along[i], along[(i + count - 1) % count]) };
        let after = if last { along[i] } else { plane_between(along[i], along[(i + 1) % count]) };
        Part {
            start: points[i].as_vec3(),
            axes: [axes[i][0].as_vec3(), axes[i][1].as_vec3(), along[i].as_vec3()],
            length: points[i].distance(points[i + 1]) as f32,
            shift,
            ends: [-before.as_vec3(), after.as_vec3()],
            capped: [first, last],
        }
    };
    (0..count).map(part).collect()
}

/// The points of a path but for repeated ones, and whether it comes back to its start.
fn corners(path: &[Vec3]) -> (Vec<DVec3>, bool) {
    let mut points: Vec<DVec3> = Vec::with_capacity(path.len());
    for p in path {
        let p = p.as_dvec3();
        if points.last().is_none_or(|last| last.distance(p) >= f64::from(SHORTEST)) {
            points.push(p);
        }
    }
    if points.len() < 2 {
        // No legal path, but one that cannot do harm.
        points.resize(1, DVec3::ZERO);
        points.push(points[0] + DVec3::Z * f64::from(SHORTEST));
    }
    let closed =
        points.len() > 3 && points[0].distance(points[points.len() - 1]) < 10.0 * f64::from(SHORTEST);
    (points, closed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(path: Vec<Vec3>) -> PathSweep {
        PathSweep {
            drawing: std::sync::Arc::default(),
            plane: crate::sketched::SketchPlane::default(),
            path,
            fillet: 0.0,
            falloff: None,
            template: crate::sketched::Solved::default(),
        }
    }

    #[test]
    fn frames_turn_as_little_as_possible_and_meet_on_closed_paths() {
        // A path in a plane keeps the direction across that plane.
        let arc = (0..30).map(|i| Vec3::new((0.1 * i as f32).sin(), 0.0, (0.1 * i as f32).cos()) * 10.0);
        for part in parts(&sweep(arc.collect())) {
            let [x, y, z] = part.axes;
            assert!(x.dot(y).abs() < 1e-6 && y.dot(z).abs() < 1e-6 && x.dot(z).abs() < 1e-6);
            assert!((part.ends[0].dot(z) + 1.0).abs() < 2e-3, "a mitre plane is nearly across");
        }
        let knot = (0..=200).map(|i| {
            let t = std::f32::consts::TAU * i as f32 / 200.0;
            Vec3::new(20.0 * t.cos(), 20.0 * t.sin(), 6.0 * (3.0 * t).sin() + 4.0 * (2.0 * t).cos())
        });
        let parts = parts(&sweep(knot.collect()));
        assert!(parts.iter().all(|part| part.capped == [false; 2]), "a closed path has no ends");
        for (a, b) in parts.iter().zip(parts.iter().cycle().skip(1)) {
            assert!(a.axes[0].dot(b.axes[0]) > 0.99, "{a:?} {b:?}");
        }
    }

    #[test]
    fn paths_without_length_are_harmless() {
        for path in [vec![], vec![Vec3::ONE], vec![Vec3::ONE; 5]] {
            assert_eq!(parts(&sweep(path)).len(), 1);
        }
    }
}
