//! Programs run for values with gradients, over clouds or bricks.

use super::loops::{EachSlope, KernelSlopes, SumPointSlopes, ZipSlopes};
use super::places::{Places, ROW, Row};
use super::program::{Instr, Op};
use super::sampler::TreeSampler;
use super::scratch::Slopes;
use crate::combine::{self, Ricci};
use crate::leaf::{Leaf, with_kernel};
use crate::scalar::{Jet, Slope};

/// What goes with the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Want {
    /// The exact gradient of the value.
    Gradient,
    /// The direction from which a gradient blend measures its angle: the gradient, but for gradient blends,
    /// whose direction holds that angle fixed.
    Direction,
}

impl TreeSampler<'_> {
    /// Writes value and gradient of `instr` at every place.
    pub(crate) fn run_slopes<P: Places + Sync>(
        &mut self,
        instr: Instr,
        places: &P,
        out: &mut Slopes,
        want: Want,
    ) {
        let first = instr.first as usize;
        match instr.op {
            Op::Empty => self.each_slope(out, |_| Slope::constant(0.0)),
            Op::Leaf(i) => {
                self.evaluations += (places.rows() * ROW) as u64;
                let (arch, tree) = (self.arch, self.tree);
                let leaf = &tree.leaves[i as usize];
                with_kernel!(leaf, kernel => arch.dispatch(KernelSlopes { kernel, number: i, places, out }));
            }
            Op::Warp(i) => self.warped_slopes(i, first, places, out, want),
            Op::Cache { number, creased } => {
                self.cached_slopes(number, creased, first, places, out, want);
            }
            Op::Sum => self.sum_slopes(instr, places, out, want),
            Op::Union => self.fold_slopes(instr, places, out, want, combine::union),
            Op::Intersection => self.fold_slopes(instr, places, out, want, combine::intersection),
            Op::Difference => self.fold_slopes(instr, places, out, want, combine::cut),
            Op::Blend(s) => self.ricci_slopes(s, instr.operands(), places, out, want),
            Op::BlendIntersection(s) => {
                self.run_slopes(self.narrower.arena[first], places, out, want);
                self.each_slope(out, combine::complement);
                for at in instr.operands().skip(1) {
                    let join = |u, g| combine::soft_outside(u, combine::complement(g), s);
                    self.joined_slopes(at, places, out, want, join);
                }
                self.each_slope(out, |u| combine::solid_part(combine::complement(u)));
            }
            Op::BlendDifference(s) => {
                self.run_slopes(self.narrower.arena[first], places, out, want);
                let mut cut = self.scratch.take_slopes(places.rows());
                self.ricci_slopes(s, first + 1..instr.operands().end, places, &mut cut, want);
                self.arch.dispatch(ZipSlopes { out, operand: &cut, f: |f, g| combine::soft_cut(f, g, s) });
                self.scratch.give_slopes(cut);
            }
            Op::GradientBlend(_) if want == Want::Gradient => self.jet_slopes(instr, places, out),
            Op::GradientBlend(frame) => {
                let frame = self.tree.frames[frame as usize];
                self.run_slopes(self.narrower.arena[first], places, out, want);
                for at in instr.operands().skip(1) {
                    self.joined_slopes(at, places, out, want, |f, g| {
                        combine::gradient_blend_in(frame.as_ref(), f, g)
                    });
                }
            }
        }
    }

    fn warped_slopes<P: Places>(
        &mut self,
        warp: u32,
        inner: usize,
        places: &P,
        out: &mut Slopes,
        want: Want,
    ) {
        let cloud = self.warped_cloud(warp, places);
        self.run_slopes(self.narrower.arena[inner], &cloud, out, want);
        let warp = &self.tree.warps[warp as usize];
        for r in 0..places.rows() {
            let row = places.row(r);
            for i in 0..ROW {
                let slope = out.get(r, i);
                let warped = warp.child_from_parent(row.place(i));
                let piece = warped.piece_of(&slope);
                out.set(r, i, Slope::new(slope.value, warped.pull_back(slope.gradient)).on(piece));
            }
        }
        self.scratch.give_cloud(cloud);
    }

    fn sum_slopes<P: Places + Sync>(&mut self, instr: Instr, places: &P, out: &mut Slopes, want: Want) {
        let tree = self.tree;
        let operands = instr.operands();
        let arena = &self.narrower.arena;
        self.numbered_points.clear();
        self.numbered_points.extend(operands.clone().map_while(|at| match arena[at].op {
            Op::Leaf(i) => match &tree.leaves[i as usize] {
                Leaf::PurePoint(point) => Some((i, *point)),
                _ => None,
            },
            _ => None,
        }));
        let points = self.numbered_points.len();
        if points < 2 {
            return self.fold_slopes(instr, places, out, want, combine::add);
        }
        self.evaluations += (points * places.rows() * ROW) as u64;
        self.arch.dispatch(SumPointSlopes { points: &self.numbered_points, places, out: &mut *out });
        for at in operands.skip(points) {
            self.joined_slopes(at, places, out, want, combine::add);
        }
    }

    /// A gradient blend's exact gradient, from jets: it depends on how the children's gradients change.
    fn jet_slopes<P: Places>(&mut self, instr: Instr, places: &P, out: &mut Slopes) {
        for r in 0..places.rows() {
            let row = places.row(r);
            for i in 0..ROW {
                let [x, y, z] = row.place(i);
                let p = [Jet::coordinate(x, 0), Jet::coordinate(y, 1), Jet::coordinate(z, 2)];
                let jet = self.run_point(instr, p);
                out.set(r, i, Slope::new(jet.value.value, jet.value.slope).on(jet.piece));
            }
        }
    }

    fn ricci_slopes<P: Places + Sync>(
        &mut self,
        s: f32,
        mut operands: std::ops::Range<usize>,
        places: &P,
        out: &mut Slopes,
        want: Want,
    ) {
        let ricci = Ricci(s);
        let Some(first) = operands.next() else {
            self.each_slope(out, |_| Slope::constant(0.0));
            return;
        };
        self.run_slopes(self.narrower.arena[first], places, out, want);
        self.each_slope(out, |f| ricci.term(f));
        for at in operands {
            self.joined_slopes(at, places, out, want, |f, g| ricci.join(f, ricci.term(g)));
        }
        self.each_slope(out, |f| ricci.root(f));
    }

    fn fold_slopes<P: Places + Sync>(
        &mut self,
        instr: Instr,
        places: &P,
        out: &mut Slopes,
        want: Want,
        join: impl Fn(Slope<f32>, Slope<f32>) -> Slope<f32> + Copy,
    ) {
        self.run_slopes(self.narrower.arena[instr.first as usize], places, out, want);
        for at in instr.operands().skip(1) {
            self.joined_slopes(at, places, out, want, join);
        }
    }

    fn each_slope(&self, out: &mut Slopes, f: impl Fn(Slope<f32>) -> Slope<f32>) {
        self.arch.dispatch(EachSlope { out, f });
    }

    fn joined_slopes<P: Places + Sync>(
        &mut self,
        at: usize,
        places: &P,
        out: &mut Slopes,
        want: Want,
        join: impl Fn(Slope<f32>, Slope<f32>) -> Slope<f32>,
    ) {
        let mut operand = self.scratch.take_slopes(places.rows());
        self.run_slopes(self.narrower.arena[at], places, &mut operand, want);
        self.arch.dispatch(ZipSlopes { out, operand: &operand, f: join });
        self.scratch.give_slopes(operand);
    }
}
