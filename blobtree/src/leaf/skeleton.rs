//! Skeletal primitives: the field is a function of the distance to a point, line, disc, ring or polygon.

use super::Kernel;
use super::frame::{Frame, Range};
use super::polygon::Outline;
use crate::falloff::{Falloff, cube, larger};
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple, dot, scaled};

/// A set of points, standing at the origin.
pub(crate) trait Skeleton: Send + Sync {
    /// From the nearest point of the skeleton to `q`.
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S>;

    /// Tells apart places between which the nearest point may jump.
    #[inline(always)]
    fn piece<S: Scalar>(&self, _q: Triple<S>) -> u32 {
        0
    }

    /// Bounds of the distance from the skeleton.
    fn distance_bound(&self, range: &Range) -> (f32, f32);

    /// Whether nearest points may jump in the range, the skeleton itself left aside.
    fn creased(&self, _range: &Range) -> bool {
        false
    }
}

/// A skeleton with a falloff that reaches 1 at some distance from it.
#[derive(Clone, Debug)]
pub(crate) struct Skeletal<T> {
    pub frame: Frame,
    pub skeleton: T,
    /// Distance from the skeleton up to which the field is 1; below 0 if it would only be so behind it.
    full: f32,
    inv_reach2: f32,
}

/// A skeleton with the paper's falloff, 1 just on the skeleton: needs no square root.
#[derive(Clone, Debug)]
pub(crate) struct PureSkeletal<T> {
    pub frame: Frame,
    pub skeleton: T,
    inv_reach2: f32,
}

impl<T: Skeleton> Skeletal<T> {
    pub fn new(frame: Frame, skeleton: T, depth: f32, falloff: Falloff) -> Self {
        Self { frame, skeleton, full: depth - falloff.core, inv_reach2: falloff.reach.powi(-2) }
    }
}

impl<T: Skeleton> PureSkeletal<T> {
    pub fn new(frame: Frame, skeleton: T, depth: f32) -> Self {
        Self { frame, skeleton, inv_reach2: Falloff::of_depth(depth).reach.powi(-2) }
    }
}

impl<T: Skeleton> Kernel for Skeletal<T> {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let q = self.frame.apply(p);
        let o = self.skeleton.offset(q);
        let d = dot(o, o).sqrt();
        let e = (d - S::of(self.full)).larger(S::of(0.0));
        let t = (S::of(1.0) - e * e * S::of(self.inv_reach2)).larger(S::of(0.0));
        let slope = S::of(-6.0 * self.inv_reach2) * t * t * e / d.larger(S::of(1e-12));
        let piece = if t.value() > 0.0 { self.skeleton.piece(q) } else { 0 };
        Slope::new(t * t * t, self.frame.pull_back(scaled(o, slope))).on(piece)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let (near, far) = self.skeleton.distance_bound(&self.frame.range(region));
        falloff_bound(near - self.full, far - self.full, self.inv_reach2)
    }

    fn creased(&self, region: &Aabb) -> bool {
        self.skeleton.creased(&self.frame.range(region))
    }
}

impl<T: Skeleton> Kernel for PureSkeletal<T> {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let q = self.frame.apply(p);
        let o = self.skeleton.offset(q);
        let t = (S::of(1.0) - dot(o, o) * S::of(self.inv_reach2)).larger(S::of(0.0));
        let slope = S::of(-6.0 * self.inv_reach2) * t * t;
        let piece = if t.value() > 0.0 { self.skeleton.piece(q) } else { 0 };
        Slope::new(t * t * t, self.frame.pull_back(scaled(o, slope))).on(piece)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let (near, far) = self.skeleton.distance_bound(&self.frame.range(region));
        falloff_bound(near, far, self.inv_reach2)
    }

    fn creased(&self, region: &Aabb) -> bool {
        self.skeleton.creased(&self.frame.range(region))
    }
}

/// Bounds of `(1 − e²/reach²)³` for `e` from `near` to `far`, with room for rounding.
pub(crate) fn falloff_bound(near: f32, far: f32, inv_reach2: f32) -> Interval {
    let value = |e: f32, slack: f32| {
        let e = larger(e, 0.0);
        cube(larger(1.0 - e * e * inv_reach2 + slack, 0.0))
    };
    Interval { lo: value(far, -4e-6), hi: value(near, 4e-6) }
}

/// The paper's point primitive in a space that is at most turned and scaled evenly: the most common leaf,
/// for which a brick of samples needs three short tables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PurePoint {
    pub center: [f32; 3],
    pub inv_reach2: f32,
}

impl PurePoint {
    /// The share of one axis in `1 − d²/reach²`.
    #[inline(always)]
    pub fn term<S: Scalar>(&self, axis: usize, x: S) -> S {
        let d = x - S::of(self.center[axis]);
        d * d * S::of(self.inv_reach2)
    }
}

impl Kernel for PurePoint {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        // Along a row of samples only x changes: its term comes last.
        let row = S::of(1.0) - self.term(1, p[1]) - self.term(2, p[2]);
        let t = (row - self.term(0, p[0])).larger(S::of(0.0));
        let slope = S::of(-6.0 * self.inv_reach2) * t * t;
        let o = std::array::from_fn(|a| p[a] - S::of(self.center[a]));
        Slope::new(t * t * t, scaled(o, slope))
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let (center, half) = (region.center(), region.size() * 0.5);
        let (mut near2, mut far2) = (0.0, 0.0);
        for a in 0..3 {
            let d = (self.center[a] - center[a]).abs();
            let reach = half[a] + 2e-6 * (self.center[a].abs() + center[a].abs() + half[a]);
            near2 += larger(d - reach, 0.0).powi(2);
            far2 += (d + reach).powi(2);
        }
        let value = |d2: f32, slack: f32| cube(larger(1.0 - d2 * self.inv_reach2 + slack, 0.0));
        Interval { lo: value(far2, -4e-6), hi: value(near2, 4e-6) }
    }

    fn creased(&self, _region: &Aabb) -> bool {
        false
    }
}

/// The origin: balls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin;

impl Skeleton for Origin {
    #[inline(always)]
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S> {
        q
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        range.length()
    }
}

/// The z axis from 0 to `length`: capsules.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub length: f32,
}

impl Skeleton for Line {
    #[inline(always)]
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S> {
        [q[0], q[1], q[2] - q[2].larger(S::of(0.0)).smaller(S::of(self.length))]
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let ((lo, hi), (near, far)) = (range.along(2), range.around_z());
        let closest = larger(0.0, larger(-hi, lo - self.length));
        let farthest = larger(0.0, larger(-lo, hi - self.length));
        (near.hypot(closest) * (1.0 - 1e-6), far.hypot(farthest) * (1.0 + 1e-6))
    }
}

/// The disc of this radius in z = 0: pebbles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plate {
    pub radius: f32,
}

impl Skeleton for Plate {
    #[inline(always)]
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S> {
        let around = (q[0] * q[0] + q[1] * q[1]).sqrt().larger(S::of(1e-12));
        let beyond = (S::of(1.0) - S::of(self.radius) / around).larger(S::of(0.0));
        [q[0] * beyond, q[1] * beyond, q[2]]
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let ((near, far), (low, high)) = (range.around_z(), range.abs(2));
        let beyond = |around: f32| larger(around - self.radius, 0.0);
        (beyond(near).hypot(low) * (1.0 - 1e-6), beyond(far).hypot(high) * (1.0 + 1e-6))
    }
}

/// The circle of this radius in z = 0: rings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    pub radius: f32,
}

impl Skeleton for Circle {
    #[inline(always)]
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S> {
        let around = (q[0] * q[0] + q[1] * q[1]).sqrt().larger(S::of(1e-12));
        let beyond = S::of(1.0) - S::of(self.radius) / around;
        // On the axis every point of the circle is as near: the one on the x axis will do.
        let is_apart = around.value() > 1e-12;
        let x = if is_apart { q[0] * beyond } else { q[0] - S::of(self.radius) };
        let y = if is_apart { q[1] * beyond } else { q[1] };
        [x, y, q[2]]
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let ((near, far), (low, high)) = (range.around_z(), range.abs(2));
        let closest = larger(near - self.radius, larger(self.radius - far, 0.0));
        let farthest = (near - self.radius).abs().max((far - self.radius).abs());
        (closest.hypot(low) * (1.0 - 1e-6), farthest.hypot(high) * (1.0 + 1e-6))
    }

    /// On the axis every point of the circle is as near.
    fn creased(&self, range: &Range) -> bool {
        range.around_z().0 <= 0.0
    }
}

impl Skeleton for Outline {
    #[inline(always)]
    fn offset<S: Scalar>(&self, q: Triple<S>) -> Triple<S> {
        let [x, y] = self.offset_in_plane([q[0], q[1]]).0;
        [x, y, q[2]]
    }

    #[inline(always)]
    fn piece<S: Scalar>(&self, q: Triple<S>) -> u32 {
        if self.is_convex() { 0 } else { self.offset_in_plane([q[0], q[1]]).1 }
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let [x, y] = self.offset_in_plane([range.center.x, range.center.y]).0;
        let middle = x.hypot(y).hypot(range.center.z);
        (larger(middle - range.radius(), 0.0) * (1.0 - 1e-5), (middle + range.radius()) * (1.0 + 1e-5))
    }

    fn creased(&self, _range: &Range) -> bool {
        !self.is_convex()
    }
}
