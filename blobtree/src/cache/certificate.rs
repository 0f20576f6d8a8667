//! In which cells of a brick samples may stand in for the field.

use super::interpolation::{self, BRICK_CELLS, CELLS, SIDE, Samples};
use crate::eval::Crease;
use crate::field::Sample;
use glam::Vec3;

/// Largest bound of a cell's error where the gradient does not jump. The field is promised to be within 0.01.
const TOLERANCE: f32 = 0.008;

/// The same where it may: for faceted fields, and where fields end, which some do with a kink. There the error is
/// up to 2.2 times the bound.
const KINKED_TOLERANCE: f32 = 0.003;

/// Cosine of the angle by which directions may differ within a cell of a faceted field: 20°, less than what
/// meshing takes for an edge.
const SAME_FACE: f32 = 0.94;

/// Gradients that change the field by less than this in a cell do not say where it is folded.
const FAINT: f32 = 1e-3;

/// The largest bound of the error that still certifies a cell.
pub(super) fn tolerances(samples: &Samples, crease: Crease) -> [f32; BRICK_CELLS] {
    std::array::from_fn(|cell| {
        let zeros = corners(cell).into_iter().filter(|at| samples[*at] <= 0.0).count();
        let is_smooth = crease == Crease::None && (zeros == 0 || zeros == 8);
        if is_smooth { TOLERANCE } else { KINKED_TOLERANCE }
    })
}

/// The cells of which the samples alone do not say that interpolation is farther off than this.
pub(super) fn hopeful_cells(samples: &Samples, tolerances: &[f32; BRICK_CELLS]) -> Cells {
    within(&interpolation::bends(samples), tolerances)
}

/// The cells in which interpolation is this accurate, given the field in the middle of each.
pub(super) fn accurate_cells(
    samples: &Samples,
    middles: &[f32; BRICK_CELLS],
    tolerances: &[f32; BRICK_CELLS],
) -> Cells {
    within(&interpolation::errors(samples, middles), tolerances)
}

fn within(errors: &[f32; BRICK_CELLS], tolerances: &[f32; BRICK_CELLS]) -> Cells {
    Cells::of(std::array::from_fn(|cell| errors[cell] <= tolerances[cell]))
}

/// Where the samples at a cell's corners stand.
fn corners(cell: usize) -> [usize; 8] {
    let low = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
    std::array::from_fn(|i| {
        let at: [usize; 3] = std::array::from_fn(|a| low[a] + 1 + (i >> a & 1));
        at[0] + SIDE * (at[1] + SIDE * at[2])
    })
}

/// The cells of a faceted field in which no fold is sharp, as far as samples can tell.
pub(super) fn even_cells(samples: &[Sample], spacing: f32) -> Cells {
    let directions: Vec<Vec3> =
        samples
            .iter()
            .map(|s| {
                if s.gradient.length() * spacing < FAINT {
                    Vec3::ZERO
                } else {
                    s.gradient.normalize_or_zero()
                }
            })
            .collect();
    Cells::of(std::array::from_fn(|cell| {
        let corners = corners(cell).map(|at| directions[at]);
        let agree = |a: Vec3, b: Vec3| a == Vec3::ZERO || b == Vec3::ZERO || a.dot(b) >= SAME_FACE;
        (0..8).all(|i| (0..i).all(|j| agree(corners[i], corners[j])))
    }))
}

/// Some cells of a brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cells([u64; BRICK_CELLS / 64]);

impl Cells {
    pub const ALL: Self = Self([u64::MAX; BRICK_CELLS / 64]);

    fn of(cells: [bool; BRICK_CELLS]) -> Self {
        let mut bits = Self([0; BRICK_CELLS / 64]);
        for (number, _) in cells.iter().enumerate().filter(|(_, is_in)| **is_in) {
            bits.0[number / 64] |= 1 << (number % 64);
        }
        bits
    }

    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] & other.0[word]))
    }

    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|word| *word == 0)
    }

    #[inline(always)]
    pub fn contains(&self, [x, y, z]: [usize; 3]) -> bool {
        let number = x + CELLS * (y + CELLS * z);
        self.0[number / 64] >> (number % 64) & 1 == 1
    }
}
