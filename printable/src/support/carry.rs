//! What a layer carries, and what it takes to carry one: dilation and erosion of rows of words.
//!
//! The loops are compiled once more for wide registers, chosen at run time.

use super::element::Step;
use crate::voxels::{Bits, Block, Row, Rows};
use pulp::NullaryFnOnce;
use std::ops::Range;

/// A row with both its neighbours along x moved into place.
#[derive(Clone, Copy)]
struct Moved<const W: usize> {
    row: Row<W>,
    /// Voxel x holds what voxel x − 1 held.
    up: Row<W>,
    /// Voxel x holds what voxel x + 1 held.
    down: Row<W>,
}

#[inline(always)]
fn moved<const W: usize>(row: Row<W>) -> Moved<W> {
    let (mut up, mut down) = ([0; W], [0; W]);
    for w in 0..W {
        up[w] = row[w] << 1 | if w > 0 { row[w - 1] >> 63 } else { 0 };
        down[w] = row[w] >> 1 | if w + 1 < W { row[w + 1] << 63 } else { 0 };
    }
    Moved { row, up, down }
}

/// Joins words so that any of them counts, or with `ALL` so that all must be set.
#[inline(always)]
fn join<const ALL: bool>(a: u64, b: u64) -> u64 {
    if ALL { a & b } else { a | b }
}

/// A pair of neighbours, as far as the mask lets it count.
#[inline(always)]
fn pair<const ALL: bool>(a: u64, b: u64, mask: u64) -> u64 {
    if ALL { a & b | !mask } else { (a | b) & mask }
}

/// A row after any step, from the rows before, at and after it.
#[inline(always)]
fn stepped<const W: usize, const ALL: bool>(
    [x, y, rising, falling]: [u64; 4],
    [before, here, after]: [&Moved<W>; 3],
) -> Row<W> {
    std::array::from_fn(|w| {
        let along_x = pair::<ALL>(here.up[w], here.down[w], x);
        let along_y = pair::<ALL>(before.row[w], after.row[w], y);
        let rising = pair::<ALL>(before.up[w], after.down[w], rising);
        let falling = pair::<ALL>(before.down[w], after.up[w], falling);
        join::<ALL>(join::<ALL>(here.row[w], along_x), join::<ALL>(along_y, join::<ALL>(rising, falling)))
    })
}

/// One step for the rows of `out`.
#[inline(always)]
fn step_rows<const W: usize, const ALL: bool>(step: Step, from: Rows<W>, full: Row<W>, out: &mut Block<W>) {
    let masks = step.masks();
    let first = out.first;
    let mut before = moved(from.at(first.wrapping_sub(1)));
    let mut here = moved(from.at(first));
    for (n, row) in out.rows.iter_mut().enumerate() {
        let after = moved(from.at(first + n + 1));
        let reached = stepped::<W, ALL>(masks, [&before, &here, &after]);
        *row = std::array::from_fn(|w| reached[w] & full[w]);
        (before, here) = (here, after);
    }
}

/// The same for the square, whose step along x and step along y are independent.
#[inline(always)]
fn square_rows<const W: usize, const ALL: bool>(from: Rows<W>, full: Row<W>, out: &mut Block<W>) {
    let along_x = |row: Row<W>| -> Row<W> {
        let Moved { row, up, down } = moved(row);
        std::array::from_fn(|w| join::<ALL>(row[w], join::<ALL>(up[w], down[w])))
    };
    let first = out.first;
    let mut before = along_x(from.at(first.wrapping_sub(1)));
    let mut here = along_x(from.at(first));
    for (n, row) in out.rows.iter_mut().enumerate() {
        let after = along_x(from.at(first + n + 1));
        *row = std::array::from_fn(|w| join::<ALL>(before[w], join::<ALL>(here[w], after[w])) & full[w]);
        (before, here) = (here, after);
    }
}

/// A step as a job.
struct StepJob<'a, const W: usize, const ALL: bool> {
    step: Step,
    from: Rows<'a, W>,
    full: Row<W>,
    out: &'a mut Block<W>,
}

impl<const W: usize, const ALL: bool> NullaryFnOnce for StepJob<'_, W, ALL> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        if self.step == Step::SQUARE {
            square_rows::<W, ALL>(self.from, self.full, self.out);
        } else {
            step_rows::<W, ALL>(self.step, self.from, self.full, self.out);
        }
    }
}

/// Carries layers, with the memory that it takes.
#[derive(Clone, Debug)]
pub(crate) struct Carrier<const W: usize> {
    arch: pulp::Arch,
    /// Rows of a layer.
    height: usize,
    /// The voxels of a row.
    full: Row<W>,
    spare: Block<W>,
}

impl<const W: usize> Carrier<W> {
    /// For the layers of a volume.
    pub fn new(bits: &Bits) -> Self {
        Self { arch: pulp::Arch::new(), height: bits.size[1], full: bits.full_row(), spare: Block::default() }
    }

    /// Which rows can be reached from these.
    pub fn widened(&self, rows: Range<usize>, by: usize) -> Range<usize> {
        if rows.is_empty() { rows } else { rows.start.saturating_sub(by)..(rows.end + by).min(self.height) }
    }

    /// The part of `rows` that the steps reach from `from`, each of them within the grid.
    pub fn carried(&mut self, steps: &[Step], from: Rows<W>, rows: Range<usize>, out: &mut Block<W>) {
        let reached = self.widened(from.range(), steps.len());
        let rows = rows.start.max(reached.start)..rows.end.min(reached.end);
        self.run::<false>(steps, from, rows.start..rows.end.max(rows.start), out);
    }

    /// The part of `rows` from which the steps reach nothing outside `from`.
    pub fn needed(&mut self, steps: &[Step], from: Rows<W>, rows: Range<usize>, out: &mut Block<W>) {
        let rows = rows.start.max(from.first)..rows.end.min(from.range().end);
        self.run::<true>(steps, from, rows.start..rows.end.max(rows.start), out);
    }

    /// Step by step, each for as many rows as the next ones look at.
    fn run<const ALL: bool>(
        &mut self,
        steps: &[Step],
        from: Rows<W>,
        rows: Range<usize>,
        out: &mut Block<W>,
    ) {
        let Some((&step, rest)) = steps.split_first() else { return };
        let full = self.full;
        out.reset(self.widened(rows.clone(), rest.len()));
        self.arch.dispatch(StepJob::<W, ALL> { step, from, full, out });
        for (n, &step) in rest.iter().enumerate() {
            std::mem::swap(&mut self.spare, out);
            out.reset(self.widened(rows.clone(), rest.len() - 1 - n));
            self.arch.dispatch(StepJob::<W, ALL> { step, from: self.spare.as_rows(), full, out });
        }
    }
}
