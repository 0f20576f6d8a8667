//! The kernel r² ln r, many at a time.
//!
//! The loops are structs that [`pulp::Arch::dispatch`] compiles for the processor at hand. They only add and
//! multiply, one after the other, so that the choice does not change a result.

use pulp::NullaryFnOnce;

/// r² ln r from r².
#[inline(always)]
pub(super) fn kernel(squared: f64) -> f64 {
    0.5 * squared * ln(squared)
}

/// The natural logarithm of a positive normal number to about 1e-13, without branches; something finite
/// for 0.
///
/// `x = 2ᵏ·m` with `m` around 1, then `ln m = 2 artanh((m − 1)/(m + 1))` by its series.
#[inline(always)]
pub(super) fn ln(x: f64) -> f64 {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const EXPONENT: u64 = 0xfff0_0000_0000_0000;
    // As the low bits of a float this large, an integer reads as itself.
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    let shifted = x.to_bits().wrapping_add(ONE - ROOT_HALF);
    let mantissa = f64::from_bits(x.to_bits().wrapping_sub(shifted & EXPONENT).wrapping_add(ONE));
    let exponent = f64::from_bits((shifted >> 52) | TWO_TO_52.to_bits()) - (TWO_TO_52 + 1023.0);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let mut series = 1.0 / 15.0;
    for odd in [13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        series = series * z + 1.0 / odd;
    }
    exponent * std::f64::consts::LN_2 + 2.0 * s * series
}

/// `out[i] = kernel(|pᵢ − at|²)`.
pub(super) struct Column<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub at: [f64; 2],
    pub out: &'a mut [f64],
}

impl NullaryFnOnce for Column<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for ((out, x), y) in self.out.iter_mut().zip(self.x).zip(self.y) {
            let (dx, dy) = (x - self.at[0], y - self.at[1]);
            *out = kernel(dx * dx + dy * dy);
        }
    }
}

/// `Σ weightᵢ · kernel(|pᵢ − at|²)`.
pub(super) struct Sum<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub weight: &'a [f64],
    pub at: [f64; 2],
}

impl NullaryFnOnce for Sum<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        const LANES: usize = 8;
        let term = |x: f64, y: f64, w: f64| {
            let (dx, dy) = (x - self.at[0], y - self.at[1]);
            w * kernel(dx * dx + dy * dy)
        };
        let mut lanes = [0.0; LANES];
        let (x, x_rest) = self.x.as_chunks::<LANES>();
        let (y, y_rest) = self.y.as_chunks::<LANES>();
        let (w, w_rest) = self.weight.as_chunks::<LANES>();
        for ((x, y), w) in x.iter().zip(y).zip(w) {
            for i in 0..LANES {
                lanes[i] += term(x[i], y[i], w[i]);
            }
        }
        let rest: f64 = x_rest.iter().zip(y_rest).zip(w_rest).map(|((x, y), w)| term(*x, *y, *w)).sum();
        lanes.iter().sum::<f64>() + rest
    }
}

/// `out[i] += Σⱼ weightⱼ · kernel(|placeᵢ − sourceⱼ|²)`.
pub(super) struct Add<'a, const N: usize> {
    pub x: &'a [f64; N],
    pub y: &'a [f64; N],
    pub sources: &'a [[f64; 3]],
    pub out: &'a mut [f64; N],
}

impl<const N: usize> NullaryFnOnce for Add<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for [sx, sy, weight] in self.sources {
            for i in 0..N {
                let (dx, dy) = (self.x[i] - sx, self.y[i] - sy);
                self.out[i] += weight * kernel(dx * dx + dy * dy);
            }
        }
    }
}

/// For a symmetric matrix of which column `j` is given from the diagonal down: adds what that column (and the
/// row it mirrors) contributes to matrix × `v`, for three vectors at once.
pub(super) struct TimesThree<'a> {
    /// The diagonal entry, then those below it.
    pub column: &'a [f64],
    /// The vectors from row `j` on.
    pub v: [&'a [f64]; 3],
    /// The products from row `j` on.
    pub out: [&'a mut [f64]; 3],
}

impl NullaryFnOnce for TimesThree<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let n = self.column.len();
        for (v, out) in self.v.into_iter().zip(self.out) {
            let (v, out) = (&v[..n], &mut out[..n]);
            let (head, below) = (v[0], &self.column[1..]);
            let mut lanes = [0.0; 8];
            let (entries, entries_rest) = below.as_chunks::<8>();
            let (vs, vs_rest) = v[1..].as_chunks::<8>();
            let (outs, outs_rest) = out[1..].as_chunks_mut::<8>();
            for ((entry, v), out) in entries.iter().zip(vs).zip(outs) {
                for i in 0..8 {
                    lanes[i] += entry[i] * v[i];
                    out[i] += entry[i] * head;
                }
            }
            let mut mirrored = self.column[0] * head;
            for ((entry, v), out) in entries_rest.iter().zip(vs_rest).zip(outs_rest) {
                mirrored += entry * v;
                *out += entry * head;
            }
            out[0] += mirrored + lanes.iter().sum::<f64>();
        }
    }
}

/// `column[i] −= Σₖ vₖ[i]·y₀ₖ + yₖ[i]·v₀ₖ` for three pairs of vectors.
pub(super) struct MinusThreePairs<'a> {
    pub column: &'a mut [f64],
    pub v: [&'a [f64]; 3],
    pub y: [&'a [f64]; 3],
    pub v0: [f64; 3],
    pub y0: [f64; 3],
}

impl NullaryFnOnce for MinusThreePairs<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let n = self.column.len();
        let ([va, vb, vc], [ya, yb, yc]) = (self.v.map(|v| &v[..n]), self.y.map(|y| &y[..n]));
        let (v0, y0) = (self.v0, self.y0);
        for i in 0..n {
            self.column[i] -= va[i] * y0[0]
                + ya[i] * v0[0]
                + (vb[i] * y0[1] + yb[i] * v0[1])
                + (vc[i] * y0[2] + yc[i] * v0[2]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_logarithm_agrees_with_the_library() {
        let random = &mut fastrand::Rng::with_seed(1);
        for _ in 0..100_000 {
            let x = 10f64.powf(random.f64() * 40.0 - 38.0);
            assert!((ln(x) - x.ln()).abs() < 2e-13 * (1.0 + x.ln().abs()), "{x}");
        }
        assert_eq!(kernel(0.0), 0.0);
    }
}
