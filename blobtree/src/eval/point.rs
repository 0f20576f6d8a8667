//! Programs run at one place, with any kind of number.

use super::loops::leaf_piece;
use super::program::{Instr, Op};
use super::sampler::TreeSampler;
use crate::combine::{self, Ricci};
use crate::scalar::{Scalar, Slope, Triple};

impl TreeSampler<'_> {
    /// The value of `instr` at `p` with its direction (see [`Want`](super::slopes::Want)). The same formulas
    /// in the same order as in batches.
    pub(crate) fn run_point<S: Scalar>(&mut self, instr: Instr, p: Triple<S>) -> Slope<S> {
        let first = instr.first as usize;
        match instr.op {
            Op::Empty => Slope::constant(0.0),
            Op::Leaf(i) => {
                self.evaluations += 1;
                let slope = self.tree.leaves[i as usize].at(p);
                slope.on(leaf_piece(i, slope.piece))
            }
            Op::Warp(i) => {
                let warped = self.tree.warps[i as usize].child_from_parent(p);
                let inner = self.run_point(self.narrower.arena[first], warped.place);
                let piece = warped.piece_of(&inner);
                Slope::new(inner.value, warped.pull_back(inner.gradient)).on(piece)
            }
            Op::Cache { number, creased } => match self.readers[number as usize].read(p, creased) {
                Some(slope) => slope,
                None => self.run_point(self.narrower.arena[first], p),
            },
            Op::Sum => self.fold_point(instr, p, combine::add),
            Op::Union => self.fold_point(instr, p, combine::union),
            Op::Intersection => self.fold_point(instr, p, combine::intersection),
            Op::Difference => self.fold_point(instr, p, combine::cut),
            Op::Blend(s) => self.ricci_point(s, instr.operands(), p),
            Op::BlendIntersection(s) => {
                let f = self.run_point(self.narrower.arena[first], p);
                let outside = instr.operands().skip(1).fold(combine::complement(f), |u, at| {
                    let g = self.run_point(self.narrower.arena[at], p);
                    combine::soft_outside(u, combine::complement(g), s)
                });
                combine::solid_part(combine::complement(outside))
            }
            Op::BlendDifference(s) => {
                let f = self.run_point(self.narrower.arena[first], p);
                let cut = self.ricci_point(s, first + 1..instr.operands().end, p);
                combine::soft_cut(f, cut, s)
            }
            Op::GradientBlend(frame) => {
                let frame = self.tree.frames[frame as usize];
                self.fold_point(instr, p, |f, g| combine::gradient_blend_in(frame.as_ref(), f, g))
            }
        }
    }

    fn ricci_point<S: Scalar>(
        &mut self,
        s: f32,
        mut operands: std::ops::Range<usize>,
        p: Triple<S>,
    ) -> Slope<S> {
        let ricci = Ricci(s);
        let Some(first) = operands.next() else {
            return Slope::constant(0.0);
        };
        let first = ricci.term(self.run_point(self.narrower.arena[first], p));
        let join = operands
            .fold(first, |join, at| ricci.join(join, ricci.term(self.run_point(self.narrower.arena[at], p))));
        ricci.root(join)
    }

    fn fold_point<S: Scalar>(
        &mut self,
        instr: Instr,
        p: Triple<S>,
        join: impl Fn(Slope<S>, Slope<S>) -> Slope<S>,
    ) -> Slope<S> {
        let first = self.run_point(self.narrower.arena[instr.first as usize], p);
        instr.operands().skip(1).fold(first, |f, at| join(f, self.run_point(self.narrower.arena[at], p)))
    }
}
