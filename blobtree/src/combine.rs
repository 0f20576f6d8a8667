//! The operators' formulas, each written once for plain numbers and for jets, and their bounds.

use crate::falloff::{larger, smaller};
use crate::field::Interval;
use crate::scalar::{Scalar, Slope, Triple, both_pieces, dot, scaled, sum};
use glam::Mat3;

/// `max(f, g)`.
#[inline(always)]
pub(crate) fn union<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Slope<S> {
    if g.value.value() > f.value.value() { g } else { f }
}

/// `min(f, g)`.
#[inline(always)]
pub(crate) fn intersection<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Slope<S> {
    if g.value.value() < f.value.value() { g } else { f }
}

/// `max(0, min(f, 1 − g))`.
#[inline(always)]
pub(crate) fn cut<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Slope<S> {
    solid_part(intersection(f, complement(g)))
}

/// `f + g`.
#[inline(always)]
pub(crate) fn add<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Slope<S> {
    Slope::new(f.value + g.value, sum(f.gradient, g.gradient)).on(both_pieces(f.piece, g.piece))
}

/// `1 − f`: what is outside becomes inside.
#[inline(always)]
pub(crate) fn complement<S: Scalar>(f: Slope<S>) -> Slope<S> {
    Slope::new(S::of(1.0) - f.value, scaled(f.gradient, S::of(-1.0))).on(f.piece)
}

/// `max(0, f)`.
#[inline(always)]
pub(crate) fn solid_part<S: Scalar>(f: Slope<S>) -> Slope<S> {
    if f.value.value() > 0.0 { f } else { Slope::constant(0.0) }
}

/// Ricci's blend `(Σ fˢ)^(1/s)` of values of at least 0, as a fold: terms are joined, the join has a root.
///
/// For s = 2 terms are squares with the gradients of their roots, and one root is taken at the end. For other s joins are norms of pairs, which
/// leave a value exactly as it is beside a 0, and in which no power underflows.
///
/// **Source:** Schmidt & Wyvill 2011, eq. 6.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ricci(pub f32);

impl Ricci {
    #[inline(always)]
    pub fn term<S: Scalar>(self, f: Slope<S>) -> Slope<S> {
        if self.0 == 2.0 { Slope::new(f.value * f.value, f.gradient).on(f.piece) } else { f }
    }

    #[inline(always)]
    pub fn join<S: Scalar>(self, a: Slope<S>, b: Slope<S>) -> Slope<S> {
        if self.0 == 2.0 {
            return add_squares(a, b);
        }
        let (value, by_a, by_b) = norm(a.value, b.value, self.0);
        let gradient = sum(scaled(a.gradient, by_a), scaled(b.gradient, by_b));
        Slope::new(value, gradient).on(both_pieces(a.piece, b.piece))
    }

    #[inline(always)]
    pub fn root<S: Scalar>(self, join: Slope<S>) -> Slope<S> {
        if self.0 != 2.0 { join } else { Slope::new(join.value.sqrt(), join.gradient).on(join.piece) }
    }

    /// The blend of two.
    #[inline(always)]
    pub fn both<S: Scalar>(self, f: Slope<S>, g: Slope<S>) -> Slope<S> {
        self.root(self.join(self.term(f), self.term(g)))
    }
}

/// The sum of two squares, each with the gradient of its root. Beside a 0 nothing changes, to the last bit: whether
/// a program still holds an operand that is 0 in its region must not show.
#[inline(always)]
fn add_squares<S: Scalar>(a: Slope<S>, b: Slope<S>) -> Slope<S> {
    let value = a.value + b.value;
    let gradient = if b.value.value() <= 0.0 {
        a.gradient
    } else if a.value.value() <= 0.0 {
        b.gradient
    } else {
        let inverse = S::of(1.0) / value.sqrt();
        sum(scaled(a.gradient, a.value.sqrt() * inverse), scaled(b.gradient, b.value.sqrt() * inverse))
    };
    Slope::new(value, gradient).on(both_pieces(a.piece, b.piece))
}

/// `(uˢ + vˢ)^(1/s)` of two numbers of at least 0, and its derivatives by both.
#[inline(always)]
pub(crate) fn norm<S: Scalar>(u: S, v: S, s: f32) -> (S, S, S) {
    let (one, zero) = (S::of(1.0), S::of(0.0));
    let (large, small, u_large) = if v.value() > u.value() { (v, u, false) } else { (u, v, true) };
    // The slope across the axis is 0 for every s above 1.
    let across = if s == 1.0 { one } else { zero };
    let (value, by_large, by_small) =
        if small.value() <= 0.0 { (large, one, across) } else { larger_factored_out(large, small, s) };
    if u_large { (value, by_large, by_small) } else { (value, by_small, by_large) }
}

/// [`norm`] of two numbers above 0, the larger first.
#[inline(always)]
fn larger_factored_out<S: Scalar>(large: S, small: S, s: f32) -> (S, S, S) {
    let (one, ratio) = (S::of(1.0), small / large);
    if s == 1.0 {
        return (large + small, one, one);
    }
    if s == 2.0 || s == 4.0 {
        let square = ratio * ratio;
        let power = if s == 2.0 { square } else { square * square };
        let stretch = if s == 2.0 { (one + power).sqrt() } else { (one + power).sqrt().sqrt() };
        let by_large = if s == 2.0 { one / stretch } else { one / (stretch * stretch * stretch) };
        let by_small = if s == 2.0 { ratio } else { ratio * square } * by_large;
        return (large * stretch, by_large, by_small);
    }
    let stretch = (one + ratio.powf(s)).powf(1.0 / s);
    (large * stretch, stretch.powf(1.0 - s), (ratio / stretch).powf(s - 1.0))
}

/// One step of the filleted intersection on complements `u = 1 − f`, `v = 1 − g`: their Ricci norm where
/// either is positive (outside of something), else the larger, so that blends above 1 stay continuous.
#[inline(always)]
pub(crate) fn soft_outside<S: Scalar>(u: Slope<S>, v: Slope<S>, s: f32) -> Slope<S> {
    let piece = both_pieces(u.piece, v.piece);
    if u.value.value() <= 0.0 {
        return union(u, v).on(piece);
    }
    if v.value.value() <= 0.0 {
        return u.on(piece);
    }
    Ricci(s).both(u, v)
}

/// The filleted difference `1 − ((1 − f)ˢ + gˢ)^(1/s)`, where `g` is the Ricci blend of all that is taken
/// away: `f` exactly where `g` is 0, also where blends made `f` exceed 1.
#[inline(always)]
pub(crate) fn soft_cut<S: Scalar>(f: Slope<S>, g: Slope<S>, s: f32) -> Slope<S> {
    let piece = both_pieces(f.piece, g.piece);
    if g.value.value() <= 0.0 {
        return f.on(piece);
    }
    let u = complement(f);
    let outside = if u.value.value() < 0.0 { add(u, g) } else { Ricci(s).both(u, g) };
    solid_part(complement(outside)).on(piece)
}

/// The share of the smaller field in the larger below which [`gradient_blend`] is the plain union.
const CLEAN: f32 = 0.25;

/// The most by which a step of [`gradient_blend`] exceeds the union: `1 + w/(4 − w)` at `w = 1 − CLEAN`.
const FULLEST: f32 = 1.0 + (1.0 - CLEAN) / (3.0 + CLEAN);

/// A blend that opens with the angle α between the gradients: `max · (1 + (t − 1 + w)₊² / (w (4 − w)))` with
/// `t = min/max` and the opening `w = ¾ sin² α`.
///
/// Where surfaces run alongside (α = 0) or face each other (α = 180°) it is the union; at a right angle it
/// is a round blend. The coefficient makes it smooth across `f = g`.
///
/// The gradient that it gives holds α fixed: it serves as the direction of the result, from which an
/// operator above measures its own angle. The true gradient is that of a jet of this value.
///
/// **Source:** the idea of an opening controlled by gradients is that of Gourmel et al. 2013, *A
/// gradient-based implicit blend*. **Departs:** a closed form, homogeneous in (f, g), for their tabulated
/// operator.
#[inline(always)]
pub(crate) fn gradient_blend<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Slope<S> {
    let piece = both_pieces(f.piece, g.piece);
    let Some((by_f, by_g)) = gradient_blend_weights(f, g) else {
        return union(f, g).on(piece);
    };
    let direction: Triple<S> = sum(scaled(f.gradient, by_f), scaled(g.gradient, by_g));
    Slope::new(f.value * by_f + g.value * by_g, direction).on(piece)
}

/// The derivatives of [`gradient_blend`] by its two values, whose weighted sum it is; `None` where it is the
/// union.
#[inline(always)]
pub(crate) fn gradient_blend_weights<S: Scalar>(f: Slope<S>, g: Slope<S>) -> Option<(S, S)> {
    let f_large = g.value.value() <= f.value.value();
    let (large, small) = if f_large { (f.value, g.value) } else { (g.value, f.value) };
    if small.value() <= CLEAN * large.value() {
        return None;
    }
    let along = dot(f.gradient, g.gradient);
    let lengths = dot(f.gradient, f.gradient) * dot(g.gradient, g.gradient);
    let aligned = along * along / (lengths + S::of(1e-20));
    let opening = (S::of(1.0) - aligned) * S::of(1.0 - CLEAN);
    let t = small / large;
    let into = t - S::of(1.0) + opening;
    if into.value() <= 0.0 || opening.value() < 1e-5 {
        return None;
    }
    let steepness = S::of(1.0) / (opening * (S::of(4.0) - opening));
    let by_small = (into + into) * steepness;
    let by_large = S::of(1.0) + into * into * steepness - t * by_small;
    Some(if f_large { (by_large, by_small) } else { (by_small, by_large) })
}

/// [`gradient_blend`] of fields whose gradients are given in another space, from which `frame` leads to the
/// one where the angle is meant.
#[inline(always)]
pub(crate) fn gradient_blend_in<S: Scalar>(frame: Option<&Mat3>, f: Slope<S>, g: Slope<S>) -> Slope<S> {
    let Some(frame) = frame else {
        return gradient_blend(f, g);
    };
    let turned = |map: &Mat3, v: Triple<S>| -> Triple<S> {
        std::array::from_fn(|r| dot(map.row(r).to_array().map(S::of), v))
    };
    let seen = |f: Slope<S>| Slope::new(f.value, turned(frame, f.gradient)).on(f.piece);
    let blend = gradient_blend(seen(f), seen(g));
    Slope::new(blend.value, turned(&frame.inverse(), blend.gradient)).on(blend.piece)
}

impl Interval {
    pub(crate) fn union(self, g: Self) -> Self {
        Self { lo: larger(self.lo, g.lo), hi: larger(self.hi, g.hi) }
    }

    pub(crate) fn intersection(self, g: Self) -> Self {
        Self { lo: smaller(self.lo, g.lo), hi: smaller(self.hi, g.hi) }
    }

    pub(crate) fn add(self, g: Self) -> Self {
        Self { lo: self.lo + g.lo, hi: self.hi + g.hi }.loosened()
    }

    pub(crate) fn complement(self) -> Self {
        Self { lo: 1.0 - self.hi, hi: 1.0 - self.lo }
    }

    pub(crate) fn solid_part(self) -> Self {
        Self { lo: larger(self.lo, 0.0), hi: larger(self.hi, 0.0) }
    }

    pub(crate) fn cut(self, g: Self) -> Self {
        self.intersection(g.complement()).solid_part()
    }

    pub(crate) fn ricci(self, g: Self, s: f32) -> Self {
        Self { lo: norm(self.lo, g.lo, s).0, hi: norm(self.hi, g.hi, s).0 }.loosened()
    }

    /// [`soft_outside`] grows with both.
    pub(crate) fn soft_outside(self, v: Self, s: f32) -> Self {
        let at = |u: f32, v: f32| soft_outside(plain(u), plain(v), s).value;
        Self { lo: at(self.lo, v.lo), hi: at(self.hi, v.hi) }.loosened()
    }

    /// [`soft_cut`] grows with `f` and shrinks with `g`.
    pub(crate) fn soft_cut(self, g: Self, s: f32) -> Self {
        let at = |f: f32, g: f32| soft_cut(plain(f), plain(g), s).value;
        Self { lo: at(self.lo, g.hi), hi: at(self.hi, g.lo) }.loosened()
    }

    pub(crate) fn gradient_blend(self, g: Self) -> Self {
        let plain = self.union(g);
        let clean = smaller(self.hi, g.hi) <= CLEAN * plain.lo;
        if clean { plain } else { Self { lo: plain.lo, hi: plain.hi * FULLEST }.loosened() }
    }

    /// The range of values that may be off by `by`, but not below 0.
    pub(crate) fn widened(self, by: f32) -> Self {
        Self { lo: larger(self.lo - by, 0.0), hi: self.hi + by }
    }

    /// A little wider, for what rounding may have done; 0 stays 0.
    fn loosened(self) -> Self {
        let by = |x: f32| if x == 0.0 { 0.0 } else { 2e-6 * x.abs().max(1.0) };
        Self { lo: self.lo - by(self.lo), hi: self.hi + by(self.hi) }
    }
}

fn plain(value: f32) -> Slope<f32> {
    Slope::constant(value)
}
