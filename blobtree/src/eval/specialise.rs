//! Programs narrowed to a region: whatever cannot matter there vanishes.

use super::program::{Instr, Op, Tree};
use crate::field::{Aabb, Interval};

/// By how much a cache may differ from the exact field.
const CACHE_ERROR: f32 = 0.01;

/// A program narrowed to a region, and what is known of its values there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Narrowed {
    pub instr: Instr,
    pub bound: Interval,
    pub crease: Crease,
}

/// Whether the gradient may jump in a region; the worse comes later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Crease {
    /// It does not.
    None,
    /// Only between the facets of meshes: samples tell where that matters.
    Faceted,
    /// It may, anywhere.
    Sharp,
}

impl Narrowed {
    const EMPTY: Self = Self { instr: Instr::EMPTY, bound: Interval::ZERO, crease: Crease::None };

    fn is_empty(&self) -> bool {
        self.instr.op == Op::Empty
    }
}

/// The memory in which programs are narrowed, level upon level.
#[derive(Debug)]
pub(crate) struct Narrower {
    /// The tree's own program, then those of the levels.
    pub arena: Vec<Instr>,
    /// Narrowed operands of operations that are not finished.
    pending: Vec<Narrowed>,
}

impl Narrower {
    pub fn new(tree: &Tree) -> Self {
        Self { arena: tree.arena.clone(), pending: Vec::new() }
    }

    /// Narrows `instr`, whose operands stand in the arena, to `region`; new operands are added at the end.
    ///
    /// Values never change by this, to the last bit: what goes is 0 or loses every comparison. Nothing is left
    /// of what lies outside its support, so that an edit there leaves the program the same.
    pub fn narrow(&mut self, tree: &Tree, instr: Instr, region: &Aabb) -> Narrowed {
        match instr.op {
            Op::Empty => Narrowed::EMPTY,
            Op::Leaf(i) if !tree.leaf_supports[i as usize].overlaps(region) => Narrowed::EMPTY,
            Op::Leaf(i) => {
                let leaf = &tree.leaves[i as usize];
                let bound = leaf.bound(region);
                if bound.hi <= 0.0 {
                    return Narrowed::EMPTY;
                }
                Narrowed { instr, bound, crease: leaf.crease(region) }
            }
            Op::Warp(i) if !tree.warp_supports[i as usize].overlaps(region) => Narrowed::EMPTY,
            Op::Warp(i) => {
                let warp = &tree.warps[i as usize];
                let inner = self.narrow(tree, self.arena[instr.first as usize], &warp.child_region(region));
                if inner.is_empty() {
                    return Narrowed::EMPTY;
                }
                let first = self.arena.len() as u32;
                self.arena.push(inner.instr);
                let crease = if warp.creased(region) { Crease::Sharp } else { inner.crease };
                Narrowed { instr: Instr { first, ..instr }, bound: inner.bound, crease }
            }
            Op::Cache { number, .. } => {
                let exact = self.narrow(tree, self.arena[instr.first as usize], region);
                if exact.is_empty() {
                    return exact;
                }
                let first = self.arena.len() as u32;
                self.arena.push(exact.instr);
                let op = Op::Cache { number, creased: exact.crease > Crease::None };
                let bound = exact.bound.widened(CACHE_ERROR);
                Narrowed { instr: Instr { op, first, count: 1 }, bound, crease: exact.crease }
            }
            _ => {
                let base = self.pending.len();
                for at in instr.operands() {
                    let operand = self.narrow(tree, self.arena[at], region);
                    self.pending.push(operand);
                }
                let narrowed = self.narrow_operation(instr.op, base);
                self.pending.truncate(base);
                narrowed
            }
        }
    }

    /// Narrows an operation whose operands are pending from `base` on.
    fn narrow_operation(&mut self, op: Op, base: usize) -> Narrowed {
        let operands = &mut self.pending;
        let first = operands[base];
        let (bound, creases) = match op {
            Op::Union => {
                let best = operands[base..].iter().fold(0.0f32, |best, o| best.max(o.bound.lo));
                retain_from(operands, base, |o| !o.is_empty() && o.bound.hi >= best);
                (fold(&operands[base..], Interval::union), true)
            }
            Op::Intersection => {
                if operands[base..].iter().any(Narrowed::is_empty) {
                    return Narrowed::EMPTY;
                }
                let worst = operands[base..].iter().fold(f32::MAX, |worst, o| worst.min(o.bound.hi));
                retain_from(operands, base, |o| o.bound.lo <= worst);
                (fold(&operands[base..], Interval::intersection), true)
            }
            Op::Difference => {
                if first.is_empty() {
                    return Narrowed::EMPTY;
                }
                retain_from(operands, base + 1, |o| first.bound.hi > 1.0 - o.bound.hi);
                (fold(&operands[base..], Interval::cut), true)
            }
            Op::Sum => {
                retain_from(operands, base, |o| !o.is_empty());
                (fold(&operands[base..], Interval::add), false)
            }
            Op::Blend(s) => {
                retain_from(operands, base, |o| !o.is_empty());
                (fold(&operands[base..], |f, g| f.ricci(g, s)), false)
            }
            Op::BlendIntersection(s) => {
                if operands[base..].iter().any(Narrowed::is_empty) {
                    return Narrowed::EMPTY;
                }
                let outside = operands[base..].iter().map(|o| o.bound.complement());
                let outside = outside.reduce(|u, v| u.soft_outside(v, s)).unwrap_or(Interval::ZERO);
                (outside.complement().solid_part(), false)
            }
            Op::BlendDifference(s) => {
                if first.is_empty() {
                    return Narrowed::EMPTY;
                }
                retain_from(operands, base + 1, |o| !o.is_empty());
                let cut = fold(&operands[base + 1..], |f, g| f.ricci(g, s));
                (first.bound.soft_cut(cut, s), false)
            }
            Op::GradientBlend(_) => {
                retain_from(operands, base, |o| !o.is_empty());
                (fold(&operands[base..], Interval::gradient_blend), false)
            }
            Op::Empty | Op::Leaf(_) | Op::Warp(_) | Op::Cache { .. } => {
                unreachable!("not an operation on many")
            }
        };
        match self.pending[base..] {
            [] => Narrowed::EMPTY,
            [only] => only,
            _ if bound.hi <= 0.0 => Narrowed::EMPTY,
            ref operands => {
                let start = self.arena.len() as u32;
                let worst = operands.iter().fold(Crease::None, |worst, o| worst.max(o.crease));
                let crease = if creases { Crease::Sharp } else { worst };
                self.arena.extend(operands.iter().map(|o| o.instr));
                let instr = Instr { op, first: start, count: operands.len() as u32 };
                Narrowed { instr, bound, crease }
            }
        }
    }
}

fn fold(operands: &[Narrowed], join: impl Fn(Interval, Interval) -> Interval) -> Interval {
    operands.iter().map(|o| o.bound).reduce(join).unwrap_or(Interval::ZERO)
}

/// Keeps, from `base` on, what passes, in order.
fn retain_from(operands: &mut Vec<Narrowed>, base: usize, keep: impl Fn(&Narrowed) -> bool) {
    let mut kept = base;
    for at in base..operands.len() {
        if keep(&operands[at]) {
            operands[kept] = operands[at];
            kept += 1;
        }
    }
    operands.truncate(kept);
}
