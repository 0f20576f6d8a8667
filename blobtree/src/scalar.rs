//! Numbers that a formula can be written in once: plain, or carrying their derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What field formulas need of a number. Comparisons look at the value alone.
pub(crate) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn of(value: f32) -> Self;
    fn value(self) -> f32;
    fn sqrt(self) -> Self;
    /// For a base above 0.
    fn powf(self, exponent: f32) -> Self;
    fn sin_cos(self) -> (Self, Self);
    /// The angle of the point (`x`, `self`), −π to π.
    fn atan2(self, x: Self) -> Self;

    #[inline(always)]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self.value() > other.value() { self } else { other }
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if self.value() < other.value() { self } else { other }
    }
}

impl Scalar for f32 {
    #[inline(always)]
    fn of(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn value(self) -> f32 {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn powf(self, exponent: f32) -> Self {
        self.powf(exponent)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.atan2(x)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
}

/// A number with its derivatives along x, y and z: forward-mode differentiation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jet {
    pub value: f32,
    pub slope: [f32; 3],
}

impl Jet {
    /// The coordinate number `axis` at `value`.
    pub fn coordinate(value: f32, axis: usize) -> Self {
        Self { value, slope: std::array::from_fn(|a| if a == axis { 1.0 } else { 0.0 }) }
    }

    /// A function of this number, from its value and derivative here.
    fn map(self, value: f32, derivative: f32) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: std::array::from_fn(|i| self.slope[i] + b.slope[i]) }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
impl Mul for Jet {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let slope = std::array::from_fn(|i| self.slope[i] * b.value + self.value * b.slope[i]);
        Self { value: self.value * b.value, slope }
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the quotient rule subtracts and multiplies")]
impl Div for Jet {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Self { value, slope: std::array::from_fn(|i| (self.slope[i] - value * b.slope[i]) / b.value) }
    }
}

impl Scalar for Jet {
    fn of(value: f32) -> Self {
        Self { value, slope: [0.0; 3] }
    }
    fn value(self) -> f32 {
        self.value
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    fn powf(self, exponent: f32) -> Self {
        self.map(self.value.powf(exponent), exponent * self.value.powf(exponent - 1.0))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.map(sin, cos), self.map(cos, -sin))
    }
    fn atan2(self, x: Self) -> Self {
        let square = (x.value * x.value + self.value * self.value).max(f32::MIN_POSITIVE);
        let slope = |i: usize| (x.value * self.slope[i] - self.value * x.slope[i]) / square;
        Self { value: self.value.atan2(x.value), slope: std::array::from_fn(slope) }
    }
}

/// Three numbers: a place or a direction.
pub(crate) type Triple<S> = [S; 3];

#[inline(always)]
pub(crate) fn dot<S: Scalar>(a: Triple<S>, b: Triple<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn scaled<S: Scalar>(a: Triple<S>, by: S) -> Triple<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline(always)]
pub(crate) fn sum<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn difference<S: Scalar>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The piece of a field that depends smoothly on two others, each on its own.
#[inline(always)]
pub(crate) fn both_pieces(a: u32, b: u32) -> u32 {
    a.wrapping_mul(0x01000193).wrapping_add(b)
}

/// A field's value and gradient, or any value with a direction that goes with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slope<S> {
    pub value: S,
    pub gradient: Triple<S>,
    /// Tells smooth pieces of the field apart: see [`Sample::piece`](crate::Sample::piece).
    pub piece: u32,
}

impl<S: Scalar> Slope<S> {
    pub const fn new(value: S, gradient: Triple<S>) -> Self {
        Self { value, gradient, piece: 0 }
    }

    /// The same on this piece.
    #[inline(always)]
    pub fn on(self, piece: u32) -> Self {
        Self { piece, ..self }
    }

    #[inline(always)]
    pub fn constant(value: f32) -> Self {
        Self::new(S::of(value), [S::of(0.0); 3])
    }
}
