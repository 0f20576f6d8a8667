//! Smoothing: a voxel goes with the majority of the 27 around it.

use crate::VoxelGrid;
use crate::voxels::{Bits, Block, Row, Rows, for_width, join};
use pulp::NullaryFnOnce;
use rayon::prelude::*;
use std::ops::Range;

/// Layers that are smoothed in one go.
const CHUNK: usize = 32;

/// What smoothing sees under the bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnderBed {
    /// The lowest layer once more, so that a wall keeps its foot.
    LowestLayer,
    /// Nothing.
    Nothing,
}

/// The grid in which a voxel is solid if at least 14 of the 27 voxels around and including it are.
///
/// - **In:** what is outside the grid counts as empty; `under_bed` says what is below it.
/// - **Promises:** the same for any number of threads. Not that the result is supported: trim it.
/// - **Cost:** one pass; numbers are added for 64 voxels at a time, one bit of them in each word.
/// - **Source:** Reiner & Lefebvre 2016, "generic brushes", which does not say which average; this is the median.
pub fn smooth(grid: &VoxelGrid, under_bed: UnderBed) -> VoxelGrid {
    let mut result = VoxelGrid { solid: Bits::new(grid.solid.size), ..grid.clone() };
    for_width!(grid.solid.words, W => {
        result.solid.layers.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, layers)| {
            let mut median = Median::<W>::new(&grid.solid, under_bed);
            for (n, layer) in layers.iter_mut().enumerate() {
                layer.set(median.layer(chunk * CHUNK + n, 0..grid.solid.size[1]));
            }
        });
    });
    result
}

/// The medians of the voxels that are set in `within`: those of them that are solid after smoothing.
pub(crate) fn smooth_within(solid: &Bits, within: &Bits) -> Bits {
    let mut result = Bits::new(solid.size);
    for_width!(solid.words, W => {
        let mut median = Median::<W>::new(solid, UnderBed::LowestLayer);
        for z in 0..solid.size[2] {
            let within = within.layers[z].rows::<W>();
            if within.rows.is_empty() {
                continue;
            }
            let block = median.layer(z, within.range());
            let first = block.first;
            for (n, row) in block.rows.iter_mut().enumerate() {
                *row = std::array::from_fn(|w| row[w] & within.at(first + n)[w]);
            }
            result.layers[z].set(block);
        }
    });
    result
}

/// A number of up to four bits for every voxel of a row: word i holds bit i.
type Counts<const W: usize> = [Row<W>; 4];

/// How many of the 3 × 3 voxels around each are solid, for the rows of a layer and one more on either side.
#[derive(Clone, Debug, Default)]
struct LayerCounts<const W: usize> {
    layer: Option<usize>,
    first: usize,
    rows: Vec<Counts<W>>,
}

impl<const W: usize> LayerCounts<W> {
    #[inline(always)]
    fn at(&self, y: usize) -> Counts<W> {
        self.rows.get(y.wrapping_sub(self.first)).copied().unwrap_or([[0; W]; 4])
    }
}

/// Medians of layers; quick when asked for one after the other upwards.
struct Median<'a, const W: usize> {
    arch: pulp::Arch,
    solid: &'a Bits,
    under_bed: UnderBed,
    /// Of three neighbouring layers, layer z at z mod 3.
    counts: [LayerCounts<W>; 3],
    nothing: LayerCounts<W>,
    out: Block<W>,
}

impl<'a, const W: usize> Median<'a, W> {
    fn new(solid: &'a Bits, under_bed: UnderBed) -> Self {
        Self {
            arch: pulp::Arch::new(),
            solid,
            under_bed,
            counts: std::array::from_fn(|_| LayerCounts::default()),
            nothing: LayerCounts::default(),
            out: Block::default(),
        }
    }

    /// Layer z smoothed, as far as it lies in `rows`.
    fn layer(&mut self, z: usize, rows: Range<usize>) -> &mut Block<W> {
        let [_, height, layers] = self.solid.size;
        let around = z.saturating_sub(1)..(z + 2).min(layers);
        // A row beyond those of all three layers sees 9 solid voxels at most.
        let kept = around.clone().map(|z| self.solid.kept(z)).fold(0..0, join);
        let rows = rows.start.max(kept.start)..rows.end.min(kept.end);
        self.out.reset(rows.start..rows.end.max(rows.start));
        for layer in around {
            let counts = &mut self.counts[layer % 3];
            if counts.layer != Some(layer) {
                let from = self.solid.layers[layer].rows::<W>();
                counts.layer = Some(layer);
                counts.first = from.first.saturating_sub(1);
                let end =
                    if from.rows.is_empty() { counts.first } else { (from.range().end + 1).min(height) };
                counts.rows.clear();
                counts.rows.resize(end - counts.first, [[0; W]; 4]);
                self.arch.dispatch(Count { from, out: counts });
            }
        }
        let below = match (z, self.under_bed) {
            (0, UnderBed::LowestLayer) => &self.counts[0],
            (0, UnderBed::Nothing) => &self.nothing,
            _ => &self.counts[(z - 1) % 3],
        };
        let above = if z + 1 < layers { &self.counts[(z + 1) % 3] } else { &self.nothing };
        self.arch.dispatch(AtLeast14 { layers: [below, &self.counts[z % 3], above], out: &mut self.out });
        &mut self.out
    }
}

/// Adds three bits: the sum and the carry.
#[inline(always)]
fn add(a: u64, b: u64, c: u64) -> (u64, u64) {
    (a ^ b ^ c, a & b | c & (a | b))
}

/// Counts the solid ones of the 3 × 3 voxels around each of a layer.
struct Count<'a, const W: usize> {
    from: Rows<'a, W>,
    out: &'a mut LayerCounts<W>,
}

impl<const W: usize> NullaryFnOnce for Count<'_, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // Of three voxels along x: bits 0 and 1 of their number.
        let along_x = |row: Row<W>| -> [Row<W>; 2] {
            let mut sums = [[0; W]; 2];
            for w in 0..W {
                let up = row[w] << 1 | if w > 0 { row[w - 1] >> 63 } else { 0 };
                let down = row[w] >> 1 | if w + 1 < W { row[w + 1] << 63 } else { 0 };
                (sums[0][w], sums[1][w]) = add(up, row[w], down);
            }
            sums
        };
        let first = self.out.first;
        let mut before = along_x(self.from.at(first.wrapping_sub(1)));
        let mut here = along_x(self.from.at(first));
        for (n, counts) in self.out.rows.iter_mut().enumerate() {
            let after = along_x(self.from.at(first + n + 1));
            for w in 0..W {
                let (ones, carry) = add(before[0][w], here[0][w], after[0][w]);
                let (twos, fours) = add(before[1][w], here[1][w], after[1][w]);
                let more = twos & carry;
                counts[0][w] = ones;
                counts[1][w] = twos ^ carry;
                counts[2][w] = fours ^ more;
                counts[3][w] = fours & more;
            }
            (before, here) = (here, after);
        }
    }
}

/// Sets the bits of voxels that are in the majority.
struct AtLeast14<'a, const W: usize> {
    layers: [&'a LayerCounts<W>; 3],
    out: &'a mut Block<W>,
}

impl<const W: usize> NullaryFnOnce for AtLeast14<'_, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let first = self.out.first;
        for (n, row) in self.out.rows.iter_mut().enumerate() {
            let [a, b, c] = self.layers.map(|layer| layer.at(first + n));
            for w in 0..W {
                let (_, carry_2) = add(a[0][w], b[0][w], c[0][w]);
                let (sum_2, carry_4) = add(a[1][w], b[1][w], c[1][w]);
                let (bit_2, more_4) = (sum_2 ^ carry_2, sum_2 & carry_2);
                let (sum_4, carry_8) = add(a[2][w], b[2][w], c[2][w]);
                let (bit_4, more_8) = add(sum_4, carry_4, more_4);
                let (sum_8, carry_16) = add(a[3][w], b[3][w], c[3][w]);
                let (bit_8, more_16) = add(sum_8, carry_8, more_8);
                // 14 and 15 have bits 2, 4 and 8; from 16 on there is a higher one.
                row[w] = carry_16 | more_16 | bit_8 & bit_4 & bit_2;
            }
        }
    }
}
