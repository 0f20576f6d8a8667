//! Chains of round cones: polylines whose radius changes from point to point.

use super::frame::Range;
use super::solid::Solid;
use crate::scalar::{Scalar, Slope, Triple, difference, dot, scaled};
use glam::Vec3;

/// The union of round cones, each the convex hull of two balls.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    links: Vec<Link>,
}

/// The convex hull of two balls, neither inside the other unless `length` is 0.
#[derive(Clone, Copy, Debug)]
struct Link {
    start: Vec3,
    along: Vec3,
    length: f32,
    radius: f32,
    end_radius: f32,
    /// Sine and cosine of the side's angle from the axis; above 0 if it narrows.
    sine: f32,
    cosine: f32,
}

impl Link {
    fn new((start, radius): (Vec3, f32), (end, end_radius): (Vec3, f32)) -> Self {
        let length = start.distance(end);
        if length <= (radius - end_radius).abs() {
            let (start, radius) = if radius >= end_radius { (start, radius) } else { (end, end_radius) };
            let along = Vec3::Z;
            return Self { start, along, length: 0.0, radius, end_radius: radius, sine: 0.0, cosine: 1.0 };
        }
        let sine = (radius - end_radius) / length;
        let (along, cosine) = ((end - start) / length, (1.0 - sine * sine).max(0.0).sqrt());
        Self { start, along, length, radius, end_radius, sine, cosine }
    }

    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let axis = self.along.to_array().map(S::of);
        let p = difference(q, self.start.to_array().map(S::of));
        let z = dot(p, axis);
        let radial = difference(p, scaled(axis, z));
        let around = dot(radial, radial).sqrt().larger(S::of(1e-12));
        // Along the side, seen in the half-plane of the axis and `p`.
        let side = z * S::of(self.cosine) - around * S::of(self.sine);
        if side.value() <= 0.0 {
            return ball(p, self.radius);
        }
        if side.value() >= self.cosine * self.length {
            return ball(difference(p, scaled(axis, S::of(self.length))), self.end_radius);
        }
        let out = scaled(radial, S::of(self.cosine) / around);
        let value = around * S::of(self.cosine) + z * S::of(self.sine) - S::of(self.radius);
        Slope::new(value, std::array::from_fn(|a| out[a] + axis[a] * S::of(self.sine)))
    }
}

#[inline(always)]
fn ball<S: Scalar>(p: Triple<S>, radius: f32) -> Slope<S> {
    let length = dot(p, p).sqrt();
    Slope::new(length - S::of(radius), scaled(p, S::of(1.0) / length.larger(S::of(1e-12))))
}

impl Chain {
    /// Through at least one point, each with its radius.
    pub fn new(points: &[(Vec3, f32)]) -> Self {
        let links = match points {
            [only] => vec![Link::new(*only, *only)],
            _ => points.windows(2).map(|pair| Link::new(pair[0], pair[1])).collect(),
        };
        Self { links }
    }
}

impl Solid for Chain {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let mut nearest = self.links[0].distance(q);
        for (number, link) in self.links.iter().enumerate().skip(1) {
            let next = link.distance(q).on(number as u32);
            if next.value.value() < nearest.value.value() {
                nearest = next;
            }
        }
        nearest
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let middle = self.distance(range.center.to_array()).value;
        let radius = range.radius() + 1e-5 * (middle.abs() + range.center.length());
        (middle - radius, middle + radius)
    }

    fn creased(&self, _range: &Range) -> bool {
        self.links.len() > 1
    }
}
