//! Trim: away with what nothing carries.

use super::carry::Carrier;
use super::edit::{self, Edit};
use super::{Changes, Element};
use crate::VoxelGrid;
use crate::voxels::{Block, Row, Rows, for_width};
use pulp::NullaryFnOnce;

/// Removes every voxel that the layer below cannot carry, from the bed up; returns how many.
///
/// - **In/out:** layer 0 rests on the bed and always stays.
/// - **Promises:** only removes; what is left is the largest part of the grid without unsupported voxels; running
///   it again removes nothing; more solid to begin with leaves more.
/// - **Cost:** one pass over the rows that are kept.
/// - **Source:** Reiner & Lefebvre 2016, equation 1 and "trim".
pub fn trim(grid: &mut VoxelGrid, element: &Element) -> usize {
    for_width!(grid.solid.words, W => trim_rows::<W>(grid, element))
}

fn trim_rows<const W: usize>(grid: &mut VoxelGrid, element: &Element) -> usize {
    let mut carrier = Carrier::<W>::new(&grid.solid);
    let mut carried = Block::default();
    let arch = pulp::Arch::new();
    let mut removed = 0;
    // One sweep is enough: a removal can only unsupport voxels that are still ahead.
    for z in 1..grid.solid.size[2] {
        let kept = grid.solid.kept(z);
        if kept.is_empty() {
            continue;
        }
        let (below, here) = grid.solid.layers.split_at_mut(z);
        carrier.carried(element.steps(z - 1), below[z - 1].rows(), kept, &mut carried);
        let (first, rows) = here[0].rows_mut::<W>();
        removed += arch.dispatch(Intersect { first, rows, with: carried.as_rows() });
    }
    removed
}

/// The same as [`trim`], with all that it takes to undo it and to say why.
pub fn trim_with_changes(grid: &mut VoxelGrid, element: &Element) -> Changes {
    let mut changes = Changes::default();
    for_width!(grid.solid.words, W => {
        let mut carrier = Carrier::<W>::new(&grid.solid);
        let mut carried = Block::default();
        for z in 1..grid.solid.size[2] {
            let kept = grid.solid.kept(z);
            carrier.carried(element.steps(z - 1), grid.solid.layers[z - 1].rows(), kept.clone(), &mut carried);
            for y in kept {
                let (here, carried) = (grid.solid.layers[z].rows::<W>().at(y), carried.as_rows().at(y));
                changes.take::<W>(grid, [y, z], std::array::from_fn(|w| here[w] & !carried[w]));
                changes.write::<W>(grid, [y, z], [here, std::array::from_fn(|w| here[w] & carried[w])]);
            }
        }
    });
    changes
}

/// All voxels that the layer below does not carry, layer by layer. None after [`trim`].
pub fn unsupported(grid: &VoxelGrid, element: &Element) -> Vec<[usize; 3]> {
    let mut found = Vec::new();
    for_width!(grid.solid.words, W => {
        let mut carrier = Carrier::<W>::new(&grid.solid);
        let mut carried = Block::default();
        for z in 1..grid.solid.size[2] {
            let here = grid.solid.layers[z].rows::<W>();
            let below = grid.solid.layers[z - 1].rows();
            carrier.carried(element.steps(z - 1), below, here.range(), &mut carried);
            for y in here.range() {
                let (here, carried) = (here.at(y), carried.as_rows().at(y));
                let hanging = (0..W).flat_map(|w| crate::voxels::ones(here[w] & !carried[w]).map(move |x| w * 64 + x));
                found.extend(hanging.map(|x| [x, y, z]));
            }
        }
    });
    found
}

/// Adds `add` where it is carried, from the bed up, and leaves everything else as it is: the same as adding all of
/// it to a grid without unsupported voxels and trimming.
pub fn add_supported(grid: &mut VoxelGrid, add: &VoxelGrid, element: &Element, material: u8) -> Changes {
    let mut changes = Changes::default();
    if add.solid.size == grid.solid.size {
        let edit = Edit { add: Some(&add.solid), remove: None, material };
        edit::apply(grid, element, &edit, &mut changes);
    }
    changes
}

/// `rows &= with`; returns how many bits that cleared.
struct Intersect<'a, const W: usize> {
    first: usize,
    rows: &'a mut [Row<W>],
    with: Rows<'a, W>,
}

impl<const W: usize> NullaryFnOnce for Intersect<'_, W> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let mut cleared = 0;
        for (n, row) in self.rows.iter_mut().enumerate() {
            let with = self.with.at(self.first + n);
            let gone: Row<W> = std::array::from_fn(|w| row[w] & !with[w]);
            if gone.iter().fold(0, |any, word| any | word) != 0 {
                cleared += gone.iter().map(|word| word.count_ones() as usize).sum::<usize>();
                *row = std::array::from_fn(|w| row[w] & with[w]);
            }
        }
        cleared
    }
}
