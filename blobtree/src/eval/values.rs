//! Programs run for values, over bricks or clouds.

use super::loops::{Each, KernelValues, SumTables, Zip};
use super::places::{Axes, Cloud, Places, ROW};
use super::program::{Instr, Op};
use super::sampler::TreeSampler;
use super::slopes::Want;
use crate::combine::{self, Ricci};
use crate::falloff::{larger, smaller};
use crate::leaf::{Leaf, with_kernel};
use crate::scalar::Slope;

/// What a batch of places needs beyond being places: sums of points are quicker on the lattice.
pub(crate) trait Batch: Places + Sync {
    /// Writes the sum of these leaves, point primitives all, and returns true; or does nothing.
    fn sum_points(&self, sampler: &mut TreeSampler, points: &[Instr], out: &mut [[f32; ROW]]) -> bool;
}

impl Batch for Axes {
    fn sum_points(&self, sampler: &mut TreeSampler, points: &[Instr], out: &mut [[f32; ROW]]) -> bool {
        let tree = sampler.tree;
        let tables = &mut sampler.tables;
        tables.clear();
        tables.extend(points.iter().map(|instr| match instr.op {
            Op::Leaf(i) => match &tree.leaves[i as usize] {
                Leaf::PurePoint(point) => std::array::from_fn(|a| self.along[a].map(|x| point.term(a, x))),
                _ => unreachable!("only point primitives are summed by tables"),
            },
            _ => unreachable!("only leaves are summed by tables"),
        }));
        sampler.arch.dispatch(SumTables { tables, out });
        true
    }
}

impl Batch for Cloud {
    fn sum_points(&self, _: &mut TreeSampler, _: &[Instr], _: &mut [[f32; ROW]]) -> bool {
        false
    }
}

impl TreeSampler<'_> {
    /// Writes the value of `instr` at every place.
    pub(crate) fn run_values<B: Batch>(&mut self, instr: Instr, places: &B, out: &mut [[f32; ROW]]) {
        match instr.op {
            Op::Empty => out.fill([0.0; ROW]),
            Op::Leaf(i) => self.leaf_values(i, places, out),
            Op::Warp(i) => {
                let cloud = self.warped_cloud(i, places);
                self.run_values(self.narrower.arena[instr.first as usize], &cloud, out);
                self.scratch.give_cloud(cloud);
            }
            Op::Cache { number, creased } => {
                self.cached_values(number, creased, instr.first as usize, places, out);
            }
            Op::Sum => self.sum_values(instr, places, out),
            Op::Union => self.fold_values(instr, places, out, |f, g| larger(g, f)),
            Op::Intersection => self.fold_values(instr, places, out, |f, g| smaller(g, f)),
            Op::Difference => self.fold_values(instr, places, out, |f, g| larger(smaller(1.0 - g, f), 0.0)),
            Op::Blend(s) => {
                let at = instr.operands();
                self.ricci_values(s, at, places, out);
            }
            Op::BlendIntersection(s) => {
                let first = instr.first as usize;
                self.run_values(self.narrower.arena[first], places, out);
                self.arch.dispatch(Each { out: &mut *out, f: |f| 1.0 - f });
                for at in instr.operands().skip(1) {
                    self.joined(at, places, out, |u, g| {
                        combine::soft_outside(plain(u), plain(1.0 - g), s).value
                    });
                }
                self.arch.dispatch(Each { out, f: |u| larger(1.0 - u, 0.0) });
            }
            Op::BlendDifference(s) => {
                self.run_values(self.narrower.arena[instr.first as usize], places, out);
                let mut cut = self.scratch.take_values(places.rows());
                self.ricci_values(s, instr.first as usize + 1..instr.operands().end, places, &mut cut);
                let f = |f, g| combine::soft_cut(plain(f), plain(g), s).value;
                self.arch.dispatch(Zip { out, operand: &cut, f });
                self.scratch.give_values(cut);
            }
            Op::GradientBlend(_) => {
                let mut slopes = self.scratch.take_slopes(places.rows());
                self.run_slopes(instr, places, &mut slopes, Want::Direction);
                out.copy_from_slice(&slopes.value);
                self.scratch.give_slopes(slopes);
            }
        }
    }

    fn leaf_values<B: Batch>(&mut self, leaf: u32, places: &B, out: &mut [[f32; ROW]]) {
        self.evaluations += (places.rows() * ROW) as u64;
        let (arch, tree) = (self.arch, self.tree);
        let instr = Instr { op: Op::Leaf(leaf), first: 0, count: 0 };
        if tree.is_pure_point(&instr) && places.sum_points(self, &[instr], out) {
            return;
        }
        let leaf = &tree.leaves[leaf as usize];
        with_kernel!(leaf, kernel => arch.dispatch(KernelValues { kernel, places, out }));
    }

    fn sum_values<B: Batch>(&mut self, instr: Instr, places: &B, out: &mut [[f32; ROW]]) {
        let operands = instr.operands();
        let is_point = |at: &usize| self.tree.is_pure_point(&self.narrower.arena[*at]);
        let points = operands.clone().take_while(is_point).count();
        let mut rest = operands.clone();
        let mut instrs = std::mem::take(&mut self.points);
        instrs.clear();
        instrs.extend_from_slice(&self.narrower.arena[operands.start..operands.start + points]);
        if points > 0 && places.sum_points(self, &instrs, out) {
            self.evaluations += (points * places.rows() * ROW) as u64;
            rest.start += points;
        } else {
            self.run_values(self.narrower.arena[operands.start], places, out);
            rest.start += 1;
        }
        self.points = instrs;
        for at in rest {
            self.joined(at, places, out, |f, g| f + g);
        }
    }

    /// Ricci's blend of the operands in this part of the arena.
    fn ricci_values<B: Batch>(
        &mut self,
        s: f32,
        mut operands: std::ops::Range<usize>,
        places: &B,
        out: &mut [[f32; ROW]],
    ) {
        let ricci = Ricci(s);
        let Some(first) = operands.next() else {
            out.fill([0.0; ROW]);
            return;
        };
        self.run_values(self.narrower.arena[first], places, out);
        self.arch.dispatch(Each { out: &mut *out, f: |f| ricci.term(plain(f)).value });
        for at in operands {
            self.joined(at, places, out, |f, g| ricci.join(plain(f), ricci.term(plain(g))).value);
        }
        self.arch.dispatch(Each { out, f: |f| ricci.root(plain(f)).value });
    }

    fn fold_values<B: Batch>(
        &mut self,
        instr: Instr,
        places: &B,
        out: &mut [[f32; ROW]],
        join: impl Fn(f32, f32) -> f32 + Copy,
    ) {
        self.run_values(self.narrower.arena[instr.first as usize], places, out);
        for at in instr.operands().skip(1) {
            self.joined(at, places, out, join);
        }
    }

    /// Joins the operand at `at` to what is in `out`.
    fn joined<B: Batch>(
        &mut self,
        at: usize,
        places: &B,
        out: &mut [[f32; ROW]],
        join: impl Fn(f32, f32) -> f32,
    ) {
        let mut operand = self.scratch.take_values(places.rows());
        self.run_values(self.narrower.arena[at], places, &mut operand);
        self.arch.dispatch(Zip { out, operand: &operand, f: join });
        self.scratch.give_values(operand);
    }
}

#[inline(always)]
fn plain(value: f32) -> Slope<f32> {
    Slope::constant(value)
}
