//! Preserve: keep below what is needed above.

use super::Element;
use super::carry::Carrier;
use crate::VoxelGrid;
use crate::voxels::{Bits, Block, Row, Rows, for_width};
use pulp::NullaryFnOnce;

/// Adds to each layer, from the top down, the least that the layer above needs; returns how many voxels.
///
/// - **In:** with `within`, only voxels that are solid there are added; another size counts as empty.
/// - **Promises:** only adds. Where a layer is a union of shifted elements, it is carried afterwards. What is
///   narrower than the element finds nothing to stand on: that is left to [`trim`](super::trim()).
/// - **Cost:** one pass over the rows that are kept.
/// - **Source:** Reiner & Lefebvre 2016, "preserve": `S(k) ∪ (S(k+1) ⊖ B(r))`.
pub fn preserve(grid: &mut VoxelGrid, element: &Element, within: Option<&VoxelGrid>) -> usize {
    if within.is_some_and(|within| within.solid.size != grid.solid.size) {
        return 0;
    }
    for_width!(grid.solid.words, W => preserve_rows::<W>(grid, element, within.map(|within| &within.solid)))
}

fn preserve_rows<const W: usize>(grid: &mut VoxelGrid, element: &Element, within: Option<&Bits>) -> usize {
    let mut carrier = Carrier::<W>::new(&grid.solid);
    let mut needed = Block::default();
    let arch = pulp::Arch::new();
    let mut added = 0;
    for z in (0..grid.solid.size[2].saturating_sub(1)).rev() {
        let (here, above) = grid.solid.layers.split_at_mut(z + 1);
        let above = above[0].rows::<W>();
        carrier.needed(element.steps(z), above, above.range(), &mut needed);
        needed.tighten();
        let rows = needed.range();
        here[z].keep::<W>(rows.clone());
        let (first, all) = here[z].rows_mut::<W>();
        let within = within.map(|bits| bits.layers[z].rows::<W>());
        let start = rows.start.saturating_sub(first).min(all.len());
        let rows = &mut all[start..][..needed.rows.len()];
        added += arch.dispatch(Unite { rows, with: needed.as_rows(), within });
    }
    added
}

/// Takes out of `remove` what the rest of the grid needs, from the top down: what a brush must leave standing.
pub(crate) fn leave_needed(grid: &VoxelGrid, element: &Element, remove: &mut Bits) {
    for_width!(grid.solid.words, W => leave_needed_rows::<W>(&grid.solid, element, remove));
}

fn leave_needed_rows<const W: usize>(solid: &Bits, element: &Element, remove: &mut Bits) {
    let mut carrier = Carrier::<W>::new(solid);
    let (mut above, mut needed) = (Block::default(), Block::default());
    for z in (0..solid.size[2].saturating_sub(1)).rev() {
        let rows = remove.kept(z);
        if rows.is_empty() {
            continue;
        }
        let (full, gone) = (solid.layers[z + 1].rows::<W>(), remove.layers[z + 1].rows::<W>());
        above.reset(carrier.widened(rows.clone(), element.reach()));
        for y in above.range() {
            let (full, gone) = (full.at(y), gone.at(y));
            *above.at_mut(y) = std::array::from_fn(|w| full[w] & !gone[w]);
        }
        carrier.needed(element.steps(z), above.as_rows(), rows, &mut needed);
        let needed = needed.as_rows();
        let (first, rows) = remove.layers[z].rows_mut::<W>();
        for (n, row) in rows.iter_mut().enumerate() {
            let needed = needed.at(first + n);
            *row = std::array::from_fn(|w| row[w] & !needed[w]);
        }
    }
}

/// `rows |= with`, as far as `within` lets it; returns how many bits that set. `rows` are the same as those of `with`.
struct Unite<'a, const W: usize> {
    rows: &'a mut [Row<W>],
    with: Rows<'a, W>,
    within: Option<Rows<'a, W>>,
}

impl<const W: usize> NullaryFnOnce for Unite<'_, W> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let mut set = 0;
        for (n, (row, with)) in self.rows.iter_mut().zip(self.with.rows).enumerate() {
            let mut new: Row<W> = std::array::from_fn(|w| with[w] & !row[w]);
            if let Some(within) = self.within {
                let within = within.at(self.with.first + n);
                new = std::array::from_fn(|w| new[w] & within[w]);
            }
            if new.iter().fold(0, |any, word| any | word) != 0 {
                set += new.iter().map(|word| word.count_ones() as usize).sum::<usize>();
                *row = std::array::from_fn(|w| row[w] | new[w]);
            }
        }
        set
    }
}
