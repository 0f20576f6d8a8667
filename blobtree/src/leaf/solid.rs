//! Solids with a signed distance: the field is a function of the depth below the surface.

use super::Kernel;
use super::frame::{Frame, Range};
use super::skeleton::falloff_bound;
use crate::falloff::{Falloff, larger};
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple, dot, scaled};
use glam::Vec3;

/// A solid standing at the origin.
pub(crate) trait Solid: Send + Sync {
    /// Signed distance to the surface (exact or a bound that keeps its zeros), below 0 inside, and its
    /// gradient; different pieces where the gradient may jump in between.
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S>;

    /// Bounds of the signed distance.
    fn distance_bound(&self, range: &Range) -> (f32, f32);

    /// Whether the gradient of the distance may jump in the range.
    fn creased(&self, range: &Range) -> bool;

    /// See [`Kernel::is_faceted`].
    fn is_faceted(&self) -> bool {
        false
    }
}

/// A solid with its place and falloff.
#[derive(Clone, Debug)]
pub(crate) struct Fallen<T> {
    pub frame: Frame,
    pub solid: T,
    core: f32,
    inv_reach2: f32,
}

impl<T: Solid> Fallen<T> {
    pub fn new(frame: Frame, solid: T, falloff: Falloff) -> Self {
        Self { frame, solid, core: falloff.core, inv_reach2: falloff.reach.powi(-2) }
    }
}

impl<T: Solid> Kernel for Fallen<T> {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let d = self.solid.distance(self.frame.apply(p));
        let e = (d.value + S::of(self.core)).larger(S::of(0.0));
        let t = (S::of(1.0) - e * e * S::of(self.inv_reach2)).larger(S::of(0.0));
        let slope = S::of(-6.0 * self.inv_reach2) * t * t * e;
        // Where the field is 0 it is smooth, whatever the distance does there.
        let piece = if t.value() > 0.0 { d.piece } else { 0 };
        Slope::new(t * t * t, self.frame.pull_back(scaled(d.gradient, slope))).on(piece)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let (near, far) = self.solid.distance_bound(&self.frame.range(region));
        falloff_bound(near + self.core, far + self.core, self.inv_reach2)
    }

    fn creased(&self, region: &Aabb) -> bool {
        self.solid.creased(&self.frame.range(region))
    }

    fn is_faceted(&self) -> bool {
        self.solid.is_faceted()
    }
}

/// The larger of two distances, with its gradient.
#[inline(always)]
pub(super) fn farther<S: Scalar>(a: Slope<S>, b: Slope<S>) -> Slope<S> {
    if b.value.value() > a.value.value() { b } else { a }
}

/// 1 or −1, with the sign of `x`.
#[inline(always)]
fn sign<S: Scalar>(x: S) -> S {
    S::of(if x.value() < 0.0 { -1.0 } else { 1.0 })
}

/// Whether two functions with these bounds can be equal.
pub(super) fn meet(a: (f32, f32), b: (f32, f32)) -> bool {
    a.0 <= b.1 && b.0 <= a.1
}

/// `|q_axis| − half` with its gradient.
#[inline(always)]
pub(super) fn slab<S: Scalar>(q: Triple<S>, axis: usize, half: f32) -> Slope<S> {
    let side = sign(q[axis]);
    let gradient = std::array::from_fn(|a| if a == axis { side } else { S::of(0.0) });
    let piece = 2 * axis as u32 + if q[axis].value() < 0.0 { 1 } else { 2 };
    Slope::new(q[axis].abs() - S::of(half), gradient).on(piece)
}

/// A box with sharp edges; the distance is the largest of those to the faces, so that edges stay sharp at
/// every level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharpBox {
    pub half: Vec3,
}

impl SharpBox {
    fn faces(&self, range: &Range) -> [(f32, f32); 3] {
        [0, 1, 2].map(|a| {
            let (lo, hi) = range.abs(a);
            (lo - self.half[a], hi - self.half[a])
        })
    }

    /// Whether two faces, or two opposite ones, may decide in the range.
    fn faces_meet(&self, range: &Range) -> bool {
        let faces = self.faces(range);
        let top = faces.iter().fold(f32::NEG_INFINITY, |top, f| top.max(f.0));
        let deciding = |a: &usize| faces[*a].1 >= top;
        (0..3).filter(deciding).count() > 1 || (0..3).filter(deciding).any(|a| range.abs(a).0 <= 0.0)
    }
}

impl Solid for SharpBox {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        farther(farther(slab(q, 0, self.half.x), slab(q, 1, self.half.y)), slab(q, 2, self.half.z))
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let [x, y, z] = self.faces(range);
        (x.0.max(y.0).max(z.0), x.1.max(y.1).max(z.1))
    }

    fn creased(&self, range: &Range) -> bool {
        self.faces_meet(range)
    }
}

/// A box with rounded edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundBox {
    /// The box on whose surface the rounding is centred.
    pub inner: SharpBox,
    pub rounding: f32,
}

impl Solid for RoundBox {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let rounding = S::of(self.rounding);
        let flat = self.inner.distance(q);
        let out = [0, 1, 2].map(|a| (q[a].abs() - S::of(self.inner.half[a])).larger(S::of(0.0)));
        let length = dot(out, out).sqrt();
        let inverse = S::of(1.0) / length.larger(S::of(1e-12));
        let round = std::array::from_fn(|a| out[a] * inverse * sign(q[a]));
        if length.value() > 0.0 {
            Slope::new(length - rounding, round)
        } else {
            Slope::new(flat.value - rounding, flat.gradient).on(flat.piece)
        }
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let faces = self.inner.faces(range);
        let at = |pick: fn(&(f32, f32)) -> f32| {
            let q = Vec3::from_array([0, 1, 2].map(|a| pick(&faces[a])));
            q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - self.rounding
        };
        let (lo, hi) = (at(|f| f.0), at(|f| f.1));
        (lo - 1e-6 * (lo.abs() + self.rounding), hi + 1e-6 * (hi.abs() + self.rounding))
    }

    fn creased(&self, range: &Range) -> bool {
        self.distance_bound(range).0 < -self.rounding && self.inner.faces_meet(range)
    }
}

/// `around − radius` about the z axis, with its gradient.
#[inline(always)]
fn tube<S: Scalar>(q: Triple<S>, radius: S, slope: Triple<S>) -> Slope<S> {
    let around = (q[0] * q[0] + q[1] * q[1]).sqrt();
    let inverse = S::of(1.0) / around.larger(S::of(1e-12));
    let out = [q[0] * inverse, q[1] * inverse, S::of(0.0)];
    Slope::new(around - radius, std::array::from_fn(|a| out[a] - slope[a]))
}

/// A cylinder around the z axis, from −`half` to `half`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube {
    pub radius: f32,
    pub half: f32,
}

impl Tube {
    fn parts(&self, range: &Range) -> ((f32, f32), (f32, f32)) {
        let (around, along) = (range.around_z(), range.abs(2));
        ((around.0 - self.radius, around.1 - self.radius), (along.0 - self.half, along.1 - self.half))
    }
}

impl Solid for Tube {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        farther(tube(q, S::of(self.radius), [S::of(0.0); 3]), slab(q, 2, self.half))
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let (side, caps) = self.parts(range);
        (side.0.max(caps.0), side.1.max(caps.1))
    }

    fn creased(&self, range: &Range) -> bool {
        let (side, caps) = self.parts(range);
        // On the axis, and in the middle plane, a thin solid has creases inside.
        meet(side, caps)
            || side.1 >= caps.0 && range.around_z().0 <= 0.0
            || caps.1 >= side.0 && range.abs(2).0 <= 0.0
    }
}

/// A truncated cone around the z axis, from z = 0 to `length`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub radius_from: f32,
    pub radius_to: f32,
    pub length: f32,
}

impl Frustum {
    /// How fast the radius grows with z, and the cosine of the side's angle from the axis.
    fn growth(&self) -> (f32, f32) {
        let growth = (self.radius_to - self.radius_from) / self.length;
        (growth, 1.0 / (1.0 + growth * growth).sqrt())
    }

    fn parts(&self, range: &Range) -> ((f32, f32), (f32, f32)) {
        let ((growth, cosine), around, (lo, hi)) = (self.growth(), range.around_z(), range.along(2));
        let radius = |z: f32| self.radius_from + growth * z;
        let (thin, thick) = (radius(lo).min(radius(hi)), radius(lo).max(radius(hi)));
        let slack = 1e-6 * (thick.abs() + thin.abs());
        let side = ((around.0 - thick - slack) * cosine, (around.1 - thin + slack) * cosine);
        (side, (larger(-hi, lo - self.length), larger(-lo, hi - self.length)))
    }
}

impl Solid for Frustum {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let (growth, cosine) = self.growth();
        let radius = S::of(self.radius_from) + S::of(growth) * q[2];
        let side = tube(q, radius, [S::of(0.0), S::of(0.0), S::of(growth)]);
        // The side is smooth but at its tip, around which all its quarters meet.
        let quarter = 3 + u32::from(q[0].value() < 0.0) + 2 * u32::from(q[1].value() < 0.0);
        let side = Slope::new(side.value * S::of(cosine), scaled(side.gradient, S::of(cosine))).on(quarter);
        let half = S::of(0.5 * self.length);
        let caps = slab([q[0], q[1], q[2] - half], 2, 0.5 * self.length);
        farther(side, caps)
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let (side, caps) = self.parts(range);
        (side.0.max(caps.0), side.1.max(caps.1))
    }

    fn creased(&self, range: &Range) -> bool {
        let (side, caps) = self.parts(range);
        let (lo, hi) = range.along(2);
        let middle = 0.5 * self.length;
        meet(side, caps)
            || side.1 >= caps.0 && range.around_z().0 <= 0.0
            || caps.1 >= side.0 && lo <= middle && middle <= hi
    }
}

/// An ellipsoid; the distance is exact outside, and to first order at the surface inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spheroid {
    pub radii: Vec3,
}

impl Spheroid {
    /// `k₀ (k₀ − 1) / k₁` with `k₀ = |q/r|` and `k₁ = |q/r²|`: the implicit function over its gradient.
    #[inline(always)]
    fn inside<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let inverse = self.radii.recip();
        let over =
            |power: i32| -> Triple<S> { std::array::from_fn(|i| q[i] * S::of(inverse[i].powi(power))) };
        let (a, b, c) = (over(1), over(2), over(4));
        // Near the centre, where both vanish, their ratio is kept at the largest radius.
        let k0 = dot(a, a).sqrt().larger(S::of(1e-6));
        let k1 = dot(b, b).sqrt().larger(S::of(1e-6 * inverse.min_element()));
        let value = k0 * (k0 - S::of(1.0)) / k1;
        let along_b = (k0 + k0 - S::of(1.0)) / (k0 * k1);
        let along_c = value / (k1 * k1);
        Slope::new(value, std::array::from_fn(|i| b[i] * along_b - c[i] * along_c))
    }

    /// The nearest point of the surface is `r² q / (r² + t)` for the `t` at which `p = r q / (r² + t)` has
    /// length 1. Newton's method on `1/|p|`, which is nearly linear in `t`, finds it from `t = 0` in a few
    /// steps, without overshooting.
    #[inline(always)]
    fn outside<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let r = self.radii;
        let mut t = S::of(0.0);
        // Six steps leave the direction 0.4 % off near the rim of a disc thirty times as wide as thick.
        for _ in 0..8 {
            let inverse: Triple<S> = std::array::from_fn(|i| S::of(1.0) / (S::of(r[i] * r[i]) + t));
            let p: Triple<S> = std::array::from_fn(|i| S::of(r[i]) * q[i] * inverse[i]);
            let squares: Triple<S> = std::array::from_fn(|i| p[i] * p[i]);
            let length2 = dot(p, p);
            let steepness = dot(squares, inverse).larger(S::of(1e-30));
            t = (t + length2 / steepness * (length2.sqrt() - S::of(1.0))).larger(S::of(0.0));
        }
        let normal: Triple<S> = std::array::from_fn(|i| q[i] / (S::of(r[i] * r[i]) + t));
        let length = dot(normal, normal).sqrt().larger(S::of(1e-12));
        Slope::new(t * length, scaled(normal, S::of(1.0) / length))
    }
}

impl Solid for Spheroid {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let inverse = self.radii.recip();
        let a: Triple<S> = std::array::from_fn(|i| q[i] * S::of(inverse[i]));
        let (inside, outside) = (self.inside(q), self.outside(q));
        if dot(a, a).value() > 1.0 { outside } else { inside }
    }

    /// Inside, `k₀/k₁` lies between the smallest and the largest radius; outside, distances have Lipschitz
    /// constant 1.
    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let inverse = self.radii.recip();
        let shrunk = Range { center: range.center * inverse, half: range.half * inverse };
        let (near, far) = shrunk.length();
        let (thin, thick) = (self.radii.min_element(), self.radii.max_element());
        let lo = (near - 1.0) * if near > 1.0 { thin } else { thick };
        let hi = (far - 1.0) * if far > 1.0 { thick } else { thin };
        let slack = 1e-5 * (thick + range.center.length());
        if near <= 1.0 {
            return (lo - slack, hi + slack);
        }
        let (middle, radius) = (self.distance(range.center.to_array()).value, range.radius());
        (lo.max(middle - radius) - slack, hi.min(middle + radius) + slack)
    }

    fn creased(&self, range: &Range) -> bool {
        range.length().0 <= 0.0
    }
}

/// What lies below z = 0, at most `extent` from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    pub extent: f32,
}

impl Solid for Ground {
    #[inline(always)]
    fn distance<S: Scalar>(&self, q: Triple<S>) -> Slope<S> {
        let plane = Slope::new(q[2], [S::of(0.0), S::of(0.0), S::of(1.0)]);
        let length = dot(q, q).sqrt();
        let inverse = S::of(1.0) / length.larger(S::of(1e-12));
        farther(plane, Slope::new(length - S::of(self.extent), scaled(q, inverse)).on(1))
    }

    fn distance_bound(&self, range: &Range) -> (f32, f32) {
        let (plane, length) = (range.along(2), range.length());
        (plane.0.max(length.0 - self.extent), plane.1.max(length.1 - self.extent))
    }

    fn creased(&self, range: &Range) -> bool {
        let (lo, hi) = range.length();
        meet(range.along(2), (lo - self.extent, hi - self.extent))
    }
}
