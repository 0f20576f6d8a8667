//! The loops over rows of places, as jobs that are compiled once more for wide registers.
//!
//! A job's `call` is inlined into code for the processor at hand, which is chosen at run time; a closure
//! handed to [`pulp::Arch::dispatch`] would stay behind in baseline code. Results do not depend on the choice:
//! the operations are the same, and none are fused.

use super::places::{Places, ROW, Row};
use super::scratch::{SlopeRow, Slopes};
use crate::combine;
use crate::falloff::{cube, larger};
use crate::leaf::{Kernel, PurePoint};
use crate::scalar::{Slope, both_pieces};
use pulp::NullaryFnOnce;

/// The value of a leaf at every place.
pub(super) struct KernelValues<'a, K, P> {
    pub kernel: &'a K,
    pub places: &'a P,
    pub out: &'a mut [[f32; ROW]],
}

impl<K: Kernel, P: Places> NullaryFnOnce for KernelValues<'_, K, P> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (r, out) in self.out.iter_mut().enumerate() {
            let row = self.places.row(r);
            for (i, value) in out.iter_mut().enumerate() {
                *value = self.kernel.at(row.place(i)).value;
            }
        }
    }
}

/// Value and gradient of a leaf at every place.
pub(super) struct KernelSlopes<'a, K, P> {
    pub kernel: &'a K,
    /// Which of the tree's leaves it is.
    pub number: u32,
    pub places: &'a P,
    pub out: &'a mut Slopes,
}

impl<K: Kernel, P: Places> NullaryFnOnce for KernelSlopes<'_, K, P> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for r in 0..self.places.rows() {
            let (row, mut out) = (self.places.row(r), SlopeRow::ZERO);
            for i in 0..ROW {
                let slope = self.kernel.at(row.place(i));
                out.set(i, slope.on(leaf_piece(self.number, slope.piece)));
            }
            self.out.set_row(r, &out);
        }
    }
}

/// Value and gradient of the sum of point primitives, each with its number among the tree's leaves.
pub(super) struct SumPointSlopes<'a, P> {
    pub points: &'a [(u32, PurePoint)],
    pub places: &'a P,
    pub out: &'a mut Slopes,
}

impl<P: Places> NullaryFnOnce for SumPointSlopes<'_, P> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for r in 0..self.places.rows() {
            let (row, mut out) = (self.places.row(r), SlopeRow::ZERO);
            for (number, point) in self.points {
                for i in 0..ROW {
                    let slope = point.at(row.place(i)).on(leaf_piece(*number, 0));
                    out.set(i, combine::add(out.get(i), slope));
                }
            }
            self.out.set_row(r, &out);
        }
    }
}

/// A leaf's piece, told from those of all other leaves.
#[inline(always)]
pub(super) fn leaf_piece(leaf: u32, piece: u32) -> u32 {
    both_pieces(leaf.wrapping_add(1).wrapping_mul(0x9e37_79b1), piece)
}

/// `Σ (1 − x[i] − y[j] − z[k])₊³` over tables of x, y and z, for a brick.
pub(super) struct SumTables<'a> {
    pub tables: &'a [[[f32; ROW]; 3]],
    pub out: &'a mut [[f32; ROW]],
}

impl NullaryFnOnce for SumTables<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (r, row) in self.out.iter_mut().enumerate() {
            let (j, k) = (r % ROW, r / ROW);
            let mut total = [0.0f32; ROW];
            for [x, y, z] in self.tables {
                let rest = 1.0 - y[j] - z[k];
                if rest > 0.0 {
                    for i in 0..ROW {
                        total[i] += cube(larger(rest - x[i], 0.0));
                    }
                }
            }
            *row = total;
        }
    }
}

/// `out = f(out)`.
pub(super) struct Each<'a, F> {
    pub out: &'a mut [[f32; ROW]],
    pub f: F,
}

impl<F: Fn(f32) -> f32> NullaryFnOnce for Each<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for value in self.out.as_flattened_mut() {
            *value = (self.f)(*value);
        }
    }
}

/// `out = f(out, operand)`.
pub(super) struct Zip<'a, F> {
    pub out: &'a mut [[f32; ROW]],
    pub operand: &'a [[f32; ROW]],
    pub f: F,
}

impl<F: Fn(f32, f32) -> f32> NullaryFnOnce for Zip<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (value, other) in self.out.as_flattened_mut().iter_mut().zip(self.operand.as_flattened()) {
            *value = (self.f)(*value, *other);
        }
    }
}

/// `out = f(out)`, with gradients.
pub(super) struct EachSlope<'a, F> {
    pub out: &'a mut Slopes,
    pub f: F,
}

impl<F: Fn(Slope<f32>) -> Slope<f32>> NullaryFnOnce for EachSlope<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for r in 0..self.out.value.len() {
            let mut row = self.out.row(r);
            for i in 0..ROW {
                row.set(i, (self.f)(row.get(i)));
            }
            self.out.set_row(r, &row);
        }
    }
}

/// `out = f(out, operand)`, with gradients.
pub(super) struct ZipSlopes<'a, F> {
    pub out: &'a mut Slopes,
    pub operand: &'a Slopes,
    pub f: F,
}

impl<F: Fn(Slope<f32>, Slope<f32>) -> Slope<f32>> NullaryFnOnce for ZipSlopes<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for r in 0..self.out.value.len() {
            let (mut row, operand) = (self.out.row(r), self.operand.row(r));
            for i in 0..ROW {
                row.set(i, (self.f)(row.get(i), operand.get(i)));
            }
            self.out.set_row(r, &row);
        }
    }
}
