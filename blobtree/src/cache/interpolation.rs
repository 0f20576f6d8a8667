//! Tricubic interpolation of lattice samples, and how far it may be off.

use crate::scalar::{Scalar, Slope, Triple};

/// Cells along each side of a brick: with fewer, more of the samples lie outside the brick; with more, a lone
/// question fills more.
pub(super) const CELLS: usize = 4;

/// Samples along each side of a brick: those of its cells, and one more on either side.
pub(super) const SIDE: usize = CELLS + 3;

/// Samples of a brick.
pub(super) const SAMPLES: usize = SIDE * SIDE * SIDE;

/// Cells of a brick.
pub(super) const BRICK_CELLS: usize = CELLS * CELLS * CELLS;

/// Samples of a brick, x fastest. The first lies one spacing below the brick's corner along each axis.
pub(super) type Samples = [f32; SAMPLES];

/// How much of the largest third difference around a cell counts as error, along each axis.
///
/// Added to the error in the middle of the cell it makes a bound of that elsewhere in the cell: 1.4 times the error
/// where the second or third derivative jumps across an axis, 1.1 times in the worst direction.
const SHARE_OF_THIRD_DIFFERENCE: f32 = 1.0 / 24.0;

/// The weights of four neighbouring samples at `t` from 0 to 1 between the middle two, and their derivatives:
/// exact for quadratics, with continuous slope.
///
/// **Source:** Catmull & Rom 1974, the spline of tension one half.
#[inline(always)]
fn weights<S: Scalar>(t: S) -> ([S; 4], [S; 4]) {
    let half = S::of(0.5);
    let cubic = |c: [f32; 4]| half * (S::of(c[0]) + t * (S::of(c[1]) + t * (S::of(c[2]) + t * S::of(c[3]))));
    let slope = |c: [f32; 3]| half * (S::of(c[0]) + t * (S::of(c[1]) + t * S::of(c[2])));
    (
        [
            cubic([0.0, -1.0, 2.0, -1.0]),
            cubic([2.0, 0.0, -5.0, 3.0]),
            cubic([0.0, 1.0, 4.0, -3.0]),
            cubic([0.0, 0.0, -1.0, 1.0]),
        ],
        [
            slope([-1.0, 4.0, -3.0]),
            slope([0.0, -10.0, 9.0]),
            slope([1.0, 8.0, -9.0]),
            slope([0.0, -2.0, 3.0]),
        ],
    )
}

/// The interpolated value at `t` (0 to 1 along each axis) in the cell at `cell`, and its derivative by `t`.
#[inline(always)]
pub(super) fn tricubic<S: Scalar>(samples: &Samples, cell: [usize; 3], t: Triple<S>) -> Slope<S> {
    let [(wx, dx), (wy, dy), (wz, dz)] = t.map(weights);
    let zero = [S::of(0.0); 4];
    let (mut along, mut by_y, mut by_z) = (zero, zero, zero);
    for k in 0..4 {
        for j in 0..4 {
            let start = cell[0] + SIDE * (cell[1] + j + SIDE * (cell[2] + k));
            let (w, y, z) = (wy[j] * wz[k], dy[j] * wz[k], wy[j] * dz[k]);
            for i in 0..4 {
                let sample = S::of(samples[start + i]);
                along[i] = along[i] + w * sample;
                by_y[i] = by_y[i] + y * sample;
                by_z[i] = by_z[i] + z * sample;
            }
        }
    }
    let sum = |w: [S; 4], of: [S; 4]| (w[0] * of[0] + w[1] * of[1]) + (w[2] * of[2] + w[3] * of[3]);
    Slope::new(sum(wx, along), [sum(dx, along), sum(wx, by_y), sum(wx, by_z)])
}

/// A bound of the interpolation's error in each cell, given the field in the middle of each.
pub(super) fn errors(samples: &Samples, middles: &[f32; BRICK_CELLS]) -> [f32; BRICK_CELLS] {
    let (interpolated, bends) = (in_the_middle(samples), bends(samples));
    std::array::from_fn(|cell| (interpolated[cell] - middles[cell]).abs() + bends[cell])
}

/// The part of that bound that the samples know of.
pub(super) fn bends(samples: &Samples) -> [f32; BRICK_CELLS] {
    let along = [0, 1, 2].map(|axis| third_differences(samples, axis));
    std::array::from_fn(|cell| SHARE_OF_THIRD_DIFFERENCE * (along[0][cell] + along[1][cell] + along[2][cell]))
}

/// The interpolated values in the middle of all cells.
fn in_the_middle(samples: &Samples) -> [f32; BRICK_CELLS] {
    let middle = |v: [f32; 4]| (9.0 * (v[1] + v[2]) - (v[0] + v[3])) / 16.0;
    let mut table = Table::new(samples);
    (0..3).for_each(|axis| table.reduce(axis, middle));
    table.cells()
}

/// The largest third difference along an axis among the samples around each cell.
fn third_differences(samples: &Samples, along: usize) -> [f32; BRICK_CELLS] {
    let bend = |v: [f32; 4]| ((v[3] - v[0]) - 3.0 * (v[2] - v[1])).abs();
    let largest = |v: [f32; 4]| v[0].max(v[1]).max(v[2].max(v[3]));
    let mut table = Table::new(samples);
    table.reduce(along, bend);
    (0..3).filter(|axis| *axis != along).for_each(|axis| table.reduce(axis, largest));
    table.cells()
}

/// Samples that are reduced to numbers per cell, one axis after the other.
struct Table {
    values: Samples,
    sides: [usize; 3],
}

impl Table {
    fn new(samples: &Samples) -> Self {
        Self { values: *samples, sides: [SIDE; 3] }
    }

    /// Puts `f` of the four numbers around each cell along this axis in their place.
    fn reduce(&mut self, axis: usize, f: impl Fn([f32; 4]) -> f32) {
        let before = self.sides;
        self.sides[axis] = CELLS;
        let stride = before[..axis].iter().product::<usize>();
        let mut to = 0;
        for z in 0..self.sides[2] {
            for y in 0..self.sides[1] {
                for x in 0..self.sides[0] {
                    let from = x + before[0] * (y + before[1] * z);
                    // What is written lies never behind what is still to be read.
                    self.values[to] = f(std::array::from_fn(|i| self.values[from + i * stride]));
                    to += 1;
                }
            }
        }
    }

    fn cells(&self) -> [f32; BRICK_CELLS] {
        std::array::from_fn(|cell| self.values[cell])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a function whose cells have side 1, the brick's corner in the origin.
    fn sampled(f: impl Fn([f32; 3]) -> f32) -> Samples {
        std::array::from_fn(|at| {
            f([at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE].map(|index| index as f32 - 1.0))
        })
    }

    fn cell(number: usize) -> [usize; 3] {
        [number % CELLS, number / CELLS % CELLS, number / CELLS / CELLS]
    }

    #[test]
    fn quadratics_are_exact_with_their_slopes() {
        let f = |[x, y, z]: [f32; 3]| 1.0 + 2.0 * x - y + 0.5 * x * x - 0.25 * y * z + 0.125 * z * z;
        let samples = sampled(f);
        for number in 0..BRICK_CELLS {
            let (at, t) = (cell(number), [0.3, 0.85, 0.5]);
            let [x, y, z] = std::array::from_fn(|a| at[a] as f32 + t[a]);
            let found = tricubic(&samples, at, t);
            assert!((found.value - f([x, y, z])).abs() < 1e-4, "{at:?}: {}", found.value);
            let expected = [2.0 + x, -1.0 - 0.25 * z, 0.25 * z - 0.25 * y];
            for (a, (found, expected)) in found.gradient.iter().zip(expected).enumerate() {
                assert!((found - expected).abs() < 1e-4, "{at:?}, axis {a}: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn the_bound_holds_for_curves_and_jumps_of_second_and_third_derivatives_in_any_direction() {
        let mut rng = fastrand::Rng::with_seed(1);
        for round in 0..300 {
            let [a, b, c] = std::array::from_fn(|_| 2.0 * rng.f32() - 1.0);
            let length = (a * a + b * b + c * c).sqrt().max(0.1);
            let offset = CELLS as f32 * rng.f32();
            let f = |[x, y, z]: [f32; 3]| {
                let along = (a * x + b * y + c * z) / length - offset;
                match round % 3 {
                    0 => along.max(0.0).powi(2),
                    1 => along.max(0.0).powi(3),
                    _ => (0.7 * along).sin(),
                }
            };
            let samples = sampled(f);
            let middles = std::array::from_fn(|number| f(cell(number).map(|i| i as f32 + 0.5)));
            let bounds = errors(&samples, &middles);
            for (number, bound) in bounds.into_iter().enumerate() {
                for _ in 0..20 {
                    let t = std::array::from_fn(|_| rng.f32());
                    let at = cell(number);
                    let exact = f(std::array::from_fn(|a| at[a] as f32 + t[a]));
                    let off = (tricubic(&samples, at, t).value - exact).abs();
                    assert!(
                        off <= bound + 1e-4 * (1.0 + exact.abs()),
                        "round {round}, cell {at:?}: {off} off, not {bound}"
                    );
                }
            }
        }
    }
}
