//! One thin-plate spline: assembly and solution of its linear system.

use super::kernel::{Column, MinusThreePairs, Sum, TimesThree};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::{Mat, Par};
use glam::DVec2;
use pulp::Arch;

/// A constraint in the frame of the fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub at: DVec2,
    pub value: f64,
    pub smoothing: f64,
}

/// `Σ wᵢ·kernel(|p − pᵢ|²) + a + b·x + c·y`.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub weight: Vec<f64>,
    /// For 1, x and y.
    pub affine: [f64; 3],
}

/// The sites all lie on one line, or the numbers are beyond what the solver can handle.
#[derive(Debug)]
pub(super) struct Unsolvable;

impl Spline {
    /// Fits by Cholesky on what is left of the system when the affine functions are taken out.
    ///
    /// With `Q` from the Householder factorisation of the affine columns `P = Q·[R; 0]`, the weights are
    /// `Q·[0; z]`, so that `(Qᵀ(K + Λ)Q)₂₂ z = (Qᵀf)₂`, which is positive definite.
    pub fn fit(sites: &[Site]) -> Result<Self, Unsolvable> {
        let n = sites.len();
        let x: Vec<f64> = sites.iter().map(|s| s.at.x).collect();
        let y: Vec<f64> = sites.iter().map(|s| s.at.y).collect();
        let affine = Reflections::of_affine_columns(&x, &y)?;
        let mut values: Vec<f64> = sites.iter().map(|s| s.value).collect();
        affine.apply_transposed(&mut values);
        let mut weight = vec![0.0; n];
        let mut coupling = [0.0; 3];
        if n > 3 {
            let mut matrix = assemble(sites, &x, &y);
            affine.apply_on_both_sides(&mut matrix);
            weight[3..].copy_from_slice(&values[3..]);
            solve_lower_right(&mut matrix, &mut weight)?;
            for (k, coupling) in coupling.iter_mut().enumerate() {
                let column = matrix.col_as_slice(k);
                *coupling = column[3..].iter().zip(&weight[3..]).map(|(m, w)| m * w).sum();
            }
        }
        let affine_part = affine.solve([0, 1, 2].map(|k| values[k] - coupling[k]));
        affine.apply(&mut weight);
        let spline = Self { x, y, weight, affine: affine_part };
        let all_finite = spline.weight.iter().chain(&spline.affine).all(|w| w.is_finite());
        if all_finite { Ok(spline) } else { Err(Unsolvable) }
    }

    pub fn value(&self, arch: Arch, p: DVec2) -> f64 {
        let sum = arch.dispatch(Sum { x: &self.x, y: &self.y, weight: &self.weight, at: p.into() });
        sum + self.affine_value(p)
    }

    pub fn affine_value(&self, p: DVec2) -> f64 {
        self.affine[0] + self.affine[1] * p.x + self.affine[2] * p.y
    }

    pub fn gradient(&self, p: DVec2) -> DVec2 {
        let mut gradient = DVec2::new(self.affine[1], self.affine[2]);
        for ((x, y), w) in self.x.iter().zip(&self.y).zip(&self.weight) {
            let away = p - DVec2::new(*x, *y);
            let squared = away.length_squared();
            if squared > 0.0 {
                gradient += w * (squared.ln() + 1.0) * away;
            }
        }
        gradient
    }
}

/// The kernel between all sites, lower triangle only, with the smoothing on the diagonal.
fn assemble(sites: &[Site], x: &[f64], y: &[f64]) -> Mat<f64> {
    let arch = Arch::new();
    let mut matrix = Mat::zeros(sites.len(), sites.len());
    for (j, site) in sites.iter().enumerate() {
        let out = &mut matrix.col_as_slice_mut(j)[j..];
        arch.dispatch(Column { x: &x[j..], y: &y[j..], at: site.at.into(), out });
        out[0] = site.smoothing;
    }
    matrix
}

/// Solves with the matrix without its first three rows and columns, in place.
fn solve_lower_right(matrix: &mut Mat<f64>, right_side: &mut [f64]) -> Result<(), Unsolvable> {
    let n = matrix.nrows() - 3;
    let mut block = matrix.as_mut().submatrix_mut(3, 3, n, n);
    // A pivot lost to rounding is a site that its neighbours already determine: it gets no weight.
    let regularization = llt::factor::LltRegularization {
        dynamic_regularization_epsilon: 1e-15,
        dynamic_regularization_delta: 1.0,
    };
    let params = Default::default();
    let memory = &mut MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, params));
    llt::factor::cholesky_in_place(block.as_mut(), regularization, Par::Seq, MemStack::new(memory), params)
        .map_err(|_| Unsolvable)?;
    let right_side = faer::MatMut::from_column_major_slice_mut(&mut right_side[3..], n, 1);
    let memory = &mut MemBuffer::new(llt::solve::solve_in_place_scratch::<f64>(n, 1, Par::Seq));
    llt::solve::solve_in_place(block.as_ref(), right_side, Par::Seq, MemStack::new(memory));
    Ok(())
}

/// The Householder factorisation of the columns 1, x, y: `Q = I − V·T·Vᵀ`.
struct Reflections {
    v: [Vec<f64>; 3],
    /// Upper triangular, by rows.
    t: [[f64; 3]; 3],
    /// Upper triangular, by rows.
    r: [[f64; 3]; 3],
}

impl Reflections {
    fn of_affine_columns(x: &[f64], y: &[f64]) -> Result<Self, Unsolvable> {
        let n = x.len();
        if n < 3 {
            return Err(Unsolvable);
        }
        let mut v = [vec![1.0; n], x.to_vec(), y.to_vec()];
        let (mut t, mut r) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        for k in 0..3 {
            let (done, [column, rest @ ..]) = v.split_at_mut(k) else { return Err(Unsolvable) };
            for (i, entry) in column[..k].iter_mut().enumerate() {
                r[i][k] = std::mem::take(entry);
            }
            let norm = dot(column, column).sqrt();
            // Sites in a box of about 1 and on a line to this share of it leave the slope across undecided.
            if norm < 1e-6 * (n as f64).sqrt() {
                return Err(Unsolvable);
            }
            r[k][k] = -norm.copysign(column[k]);
            column[k] -= r[k][k];
            let tau = 2.0 / dot(column, column);
            for other in rest {
                let share = tau * dot(column, other);
                other.iter_mut().zip(&*column).for_each(|(o, c)| *o -= share * c);
            }
            t[k][k] = tau;
            let overlaps: [f64; 3] = std::array::from_fn(|i| done.get(i).map_or(0.0, |d| dot(d, column)));
            for (i, t) in t.iter_mut().enumerate().take(k) {
                t[k] = -tau * (i..k).map(|j| t[j] * overlaps[j]).sum::<f64>();
            }
        }
        Ok(Self { v, t, r })
    }

    /// `Q·a`.
    fn apply(&self, a: &mut [f64]) {
        let overlap = self.v.each_ref().map(|v| dot(v, a));
        self.subtract(a, |k| (0..3).map(|j| self.t[k][j] * overlap[j]).sum());
    }

    /// `Qᵀ·a`.
    fn apply_transposed(&self, a: &mut [f64]) {
        let overlap = self.v.each_ref().map(|v| dot(v, a));
        self.subtract(a, |k| (0..3).map(|j| self.t[j][k] * overlap[j]).sum());
    }

    fn subtract(&self, a: &mut [f64], share: impl Fn(usize) -> f64) {
        for (k, v) in self.v.iter().enumerate() {
            let share = share(k);
            a.iter_mut().zip(v).for_each(|(a, v)| *a -= share * v);
        }
    }

    /// `Qᵀ·M·Q` for a symmetric `M` of which the lower triangle is stored: `M − V·Yᵀ − Y·Vᵀ`.
    fn apply_on_both_sides(&self, matrix: &mut Mat<f64>) {
        let (arch, n) = (Arch::new(), matrix.nrows());
        let mut products = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for j in 0..n {
            let out = products.each_mut().map(|p| &mut p[j..]);
            let v = self.v.each_ref().map(|v| &v[j..]);
            arch.dispatch(TimesThree { column: &matrix.col_as_slice(j)[j..], v, out });
        }
        let mut y: [Vec<f64>; 3] = std::array::from_fn(|k| {
            (0..n).map(|i| (0..=k).map(|j| products[j][i] * self.t[j][k]).sum()).collect()
        });
        let overlap: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|k| dot(&self.v[i], &y[k])));
        for k in 0..3 {
            for i in 0..3 {
                let share = 0.5 * (0..=i).map(|j| self.t[j][i] * overlap[j][k]).sum::<f64>();
                y[k].iter_mut().zip(&self.v[i]).for_each(|(y, v)| *y -= share * v);
            }
        }
        for j in 0..n {
            let column = &mut matrix.col_as_slice_mut(j)[j..];
            let (v0, y0) = (self.v.each_ref().map(|v| v[j]), y.each_ref().map(|y| y[j]));
            let (v, y) = (self.v.each_ref().map(|v| &v[j..]), y.each_ref().map(|y| &y[j..]));
            arch.dispatch(MinusThreePairs { column, v, y, v0, y0 });
        }
    }

    /// `R⁻¹·a`.
    fn solve(&self, a: [f64; 3]) -> [f64; 3] {
        let mut out = a;
        for k in (0..3).rev() {
            for j in k + 1..3 {
                out[k] -= self.r[k][j] * out[j];
            }
            out[k] /= self.r[k][k];
        }
        out
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
