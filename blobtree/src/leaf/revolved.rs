//! Drawings turned about an axis.

use super::frame::Range;
use super::section::Section;
use super::solid::Solid;
use crate::falloff::larger;
use crate::scalar::{Scalar, Slope, Triple};
use crate::sketched::{Rectangle, Revolution, Side, Template};
use glam::Vec2;

/// How close to the axis a drawing touches it, as a share of the distance to its far end: strokes along an
/// axis waver by 1 to 2 %, and what is rounded off at the poles is the square of this.
const TOUCHES: f32 = 0.03;

/// The section turned about the z axis.
#[derive(Clone, Debug)]
pub(crate) struct Revolved {
    pub section: Section,
    pub profile: Profile,
}

/// How the half-plane of an axis lies in a drawing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Profile {
    pub at: Vec2,
    /// Along the axis.
    pub up: Vec2,
    /// Away from it, to the right.
    pub right: Vec2,
    pub side: Side,
    /// The section is read this far from the axis on the axis itself.
    pub blunt: f32,
}

impl Profile {
    pub fn new(revolution: &Revolution) -> Self {
        let (template, axis) = (&*revolution.template, revolution.axis);
        let up = axis.direction.try_normalize().unwrap_or(Vec2::Y);
        let right = Vec2::new(up.y, -up.x);
        let side = revolution.side.unwrap_or_else(|| fuller(template, axis.at, right));
        let mut profile = Self { at: axis.at, up, right, side, blunt: 0.0 };
        profile.blunt = profile.bluntness(template);
        profile
    }

    /// The signs of the distance from the axis at which the drawing is read.
    pub fn signs(&self) -> &'static [f32] {
        match self.side {
            Side::Right => &[1.0],
            Side::Left => &[-1.0],
            Side::Both => &[1.0, -1.0],
        }
    }

    fn bluntness(&self, template: &Template) -> f32 {
        let out = |sign: f32| {
            let points = template.contours.iter().flatten();
            let distances = points.map(move |p| sign * (*p - self.at).dot(self.right));
            distances.fold((f32::INFINITY, 0.0f32), |(near, far), d| (near.min(d), far.max(d)))
        };
        let touching = self.signs().iter().map(|sign| out(*sign)).filter(|(near, far)| *near < TOUCHES * far);
        touching.fold(0.0, |blunt, (_, far)| larger(blunt, TOUCHES * far))
    }

    /// The part of the drawing that is read for these distances from the axis and heights along it.
    fn area(&self, sign: f32, around: (f32, f32), along: (f32, f32)) -> Rectangle {
        let (middle, half) = (0.5 * (around.0 + around.1), 0.5 * (around.1 - around.0));
        let (height, reach) = (0.5 * (along.0 + along.1), 0.5 * (along.1 - along.0));
        let center = self.at + self.right * (sign * middle) + self.up * height;
        let size = self.right.abs() * half + self.up.abs() * reach;
        let slack = 2e-6 * (center.abs() + size + self.at.abs());
        Rectangle { min: center - size - slack, max: center + size + slack }
    }
}

/// The side of an axis on which more of the drawing lies.
fn fuller(template: &Template, at: Vec2, right: Vec2) -> Side {
    let area =
        |sign: f32| -> f32 { template.contours.iter().map(|c| area_beyond(c, at, sign * right)).sum() };
    if area(1.0) >= area(-1.0) { Side::Right } else { Side::Left }
}

/// The signed area of the part of a polygon that lies beyond the line through `at` across `out`.
fn area_beyond(points: &[Vec2], at: Vec2, out: Vec2) -> f32 {
    let mut twice = 0.0;
    let mut from = points.last().copied().unwrap_or(at);
    for &to in points {
        let (a, b) = ((from - at).dot(out), (to - at).dot(out));
        // The height along the line, times how far out the middle of the edge lies, summed up.
        let along = (to - from).dot(Vec2::new(-out.y, out.x));
        let clipped = match (a > 0.0, b > 0.0) {
            (true, true) => a + b,
            (false, false) => 0.0,
            _ => larger(a, b) * larger(a, b) / (a - b).abs(),
        };
        twice += along * clipped;
        from = to;
    }
    0.5 * twice
}

impl Revolved {
    fn parts(&self, range: &Range) -> impl Iterator<Item = Rectangle> + '_ {
        let ((near, far), along) = (range.around_z(), range.along(2));
        let blunt = self.profile.blunt;
        let around = (near.hypot(blunt) * (1.0 - 1e-6), far.hypot(blunt) * (1.0 + 1e-6));
        self.profile.signs().iter().map(move |sign| self.profile.area(*sign, around, along))
    }
}

impl Solid for Revolved {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let Profile { at, up, right, blunt, .. } = self.profile;
        let around = (q[0] * q[0] + q[1] * q[1] + S::of(blunt * blunt)).sqrt();
        let inverse = S::of(1.0) / around.larger(S::of(1e-12));
        // On the axis all quarters meet.
        let quarter = 4 * u32::from(q[0].value() < 0.0) + 8 * u32::from(q[1].value() < 0.0);
        let mut nearest: Option<Slope<S>> = None;
        for &sign in self.profile.signs() {
            let place = [0, 1].map(|a| S::of(at[a]) + S::of(sign * right[a]) * around + S::of(up[a]) * q[2]);
            let reading = self.section.read(place);
            let out = S::of(sign * right.x) * reading.slope[0] + S::of(sign * right.y) * reading.slope[1];
            let along = S::of(up.x) * reading.slope[0] + S::of(up.y) * reading.slope[1];
            let gradient = [out * q[0] * inverse, out * q[1] * inverse, along];
            let piece = 16 * self.section.piece(place.map(S::value)) + quarter + u32::from(sign < 0.0);
            let slope = Slope::new(reading.value, gradient).on(piece);
            nearest = match nearest {
                Some(other) if other.value.value() <= slope.value.value() => Some(other),
                _ => Some(slope),
            };
        }
        nearest.unwrap_or(Slope::constant(self.section.far()))
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let bounds = self.parts(range).map(|area| self.section.bound(&area));
        bounds.fold((f32::INFINITY, f32::INFINITY), |all, one| (all.0.min(one.0), all.1.min(one.1)))
    }

    fn creased(&self, range: &Range) -> bool {
        let sides_meet = self.profile.side == Side::Both && {
            let bounds: Vec<_> = self.parts(range).map(|area| self.section.bound(&area)).collect();
            super::solid::meet(bounds[0], bounds[1])
        };
        range.around_z().0 <= 0.0 || sides_meet || self.parts(range).any(|area| self.section.creased(&area))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_beyond_a_line_are_those_of_the_clipped_polygon() {
        let square = [Vec2::ZERO, Vec2::new(4.0, 0.0), Vec2::new(4.0, 2.0), Vec2::new(0.0, 2.0)];
        assert_eq!(area_beyond(&square, Vec2::new(1.0, 7.0), Vec2::X), 6.0);
        assert_eq!(area_beyond(&square, Vec2::new(1.0, 7.0), Vec2::NEG_X), 2.0);
        assert_eq!(area_beyond(&square, Vec2::new(1.0, -1.0), Vec2::Y), 8.0);
        assert_eq!(area_beyond(&square, Vec2::new(1.0, 3.0), Vec2::Y), 0.0);
        assert_eq!(area_beyond(&[], Vec2::ZERO, Vec2::X), 0.0);
        let triangle = [Vec2::new(-1.0, 0.0), Vec2::new(3.0, 0.0), Vec2::new(3.0, 4.0)];
        assert!((area_beyond(&triangle, Vec2::ZERO, Vec2::X) - 7.5).abs() < 1e-6);
    }
}
