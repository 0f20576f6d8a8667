//! What a change did, word by word, so that it can be undone, done again, and asked why.

use super::Element;
use super::why::{self, Why};
use crate::VoxelGrid;
use crate::voxels::{Bits, Row, WORD_VOXELS, for_width, ones};

/// The words that a change touched, as they were before.
///
/// **Memory:** 16 bytes for every changed word of 64 voxels, 68 more where materials changed.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// Number and former content of changed words, in the order of the changes. One may come twice.
    words: Vec<(u32, u64)>,
    /// Number and former materials of changed words.
    materials: Vec<(u32, [u8; WORD_VOXELS])>,
    /// Number of a word and the voxels that the rule took from it, or did not let in.
    taken: Vec<(u32, u64)>,
    /// Grown voxels with the voxel that each was grown for, both by number.
    grown: Vec<(u32, u32)>,
    removed: usize,
    added: usize,
    undone: bool,
}

impl Changes {
    /// How many voxels were removed.
    pub fn removed(&self) -> usize {
        self.removed
    }

    /// How many voxels were added.
    pub fn added(&self) -> usize {
        self.added
    }

    /// How many voxels the rule took away or did not let in.
    pub fn taken(&self) -> usize {
        self.taken.iter().map(|(_, bits)| bits.count_ones() as usize).sum()
    }

    /// Whether nothing changed.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty() && self.materials.is_empty()
    }

    /// Bytes that are kept.
    pub fn bytes(&self) -> usize {
        self.words.len() * size_of::<(u32, u64)>()
            + self.materials.len() * size_of::<(u32, [u8; WORD_VOXELS])>()
            + self.taken.len() * size_of::<(u32, u64)>()
            + self.grown.len() * size_of::<(u32, u32)>()
    }

    /// Undoes the change, or does it again after it was undone. `grid` must be the one that was changed, with all
    /// later changes undone.
    pub fn swap(&mut self, grid: &mut VoxelGrid) {
        let swap_word = |grid: &mut VoxelGrid, (number, word): &mut (u32, u64)| {
            std::mem::swap(grid.solid.word_mut(grid.solid.word_place(*number)), word);
        };
        let swap_materials = |grid: &mut VoxelGrid, (number, old): &mut (u32, [u8; WORD_VOXELS])| {
            let place = grid.solid.word_place(*number);
            let now = grid.materials.of_word(place);
            grid.materials.set_word(place, std::mem::replace(old, now));
        };
        if self.undone {
            self.words.iter_mut().for_each(|change| swap_word(grid, change));
            self.materials.iter_mut().for_each(|change| swap_materials(grid, change));
        } else {
            self.words.iter_mut().rev().for_each(|change| swap_word(grid, change));
            self.materials.iter_mut().rev().for_each(|change| swap_materials(grid, change));
        }
        self.undone = !self.undone;
    }

    /// Why a voxel was taken, not let in, or added; none if the change did not concern it. `grid` must be as the
    /// change left it, and `element` the one it was made with.
    pub fn why(&self, grid: &VoxelGrid, element: &Element, voxel: [usize; 3]) -> Option<Why> {
        let [x, y, z] = voxel;
        if self.undone || (0..3).any(|axis| voxel[axis] >= grid.solid.size[axis]) {
            return None;
        }
        let word = grid.solid.word_number([x / 64, y, z]);
        let bit = 1u64 << (x % 64);
        if self.taken.iter().any(|&(number, bits)| number == word && bits & bit != 0) {
            return Some(why::taken(grid, element, &self.taken, voxel));
        }
        let number = grid.solid.word_number([0, y, z]) * WORD_VOXELS as u32 + x as u32;
        if let Some(&(_, cause)) = self.grown.iter().find(|(grown, _)| *grown == number) {
            return Some(Why::GrownFor(voxel_of(grid, cause)));
        }
        let before = self.words.iter().find(|(number, _)| *number == word)?.1;
        ((before ^ grid.solid.word([x / 64, y, z])) & bit != 0).then_some(Why::Brushed)
    }

    /// Replaces a row of a layer, and writes down what it was.
    pub(crate) fn write<const W: usize>(
        &mut self,
        grid: &mut VoxelGrid,
        [y, z]: [usize; 2],
        [old, new]: [Row<W>; 2],
    ) {
        if old == new {
            return;
        }
        for (w, (&old, &new)) in old.iter().zip(&new).enumerate() {
            if old != new {
                self.words.push((grid.solid.word_number([w, y, z]), old));
                self.removed += (old & !new).count_ones() as usize;
                self.added += (new & !old).count_ones() as usize;
                *grid.solid.word_mut([w, y, z]) = new;
            }
        }
    }

    /// Notes what the rule took from a row, or did not let in.
    pub(crate) fn take<const W: usize>(&mut self, grid: &VoxelGrid, [y, z]: [usize; 2], taken: Row<W>) {
        for (w, &bits) in taken.iter().enumerate() {
            if bits != 0 {
                self.taken.push((grid.solid.word_number([w, y, z]), bits));
            }
        }
    }

    /// Gives the voxels set in a row a material.
    pub(crate) fn paint<const W: usize>(
        &mut self,
        grid: &mut VoxelGrid,
        [y, z]: [usize; 2],
        voxels: Row<W>,
        material: u8,
    ) {
        for (w, &bits) in voxels.iter().enumerate() {
            if bits == 0 {
                continue;
            }
            let old = grid.materials.of_word([w, y, z]);
            let mut new = old;
            ones(bits).for_each(|x| new[x] = material);
            if old != new {
                self.materials.push((grid.solid.word_number([w, y, z]), old));
                grid.materials.set_word([w, y, z], new);
            }
        }
    }

    /// Makes all voxels of `add` solid, which must be empty; with a cause, they count as grown for it.
    pub(crate) fn add_all(
        &mut self,
        grid: &mut VoxelGrid,
        add: &Bits,
        material: u8,
        cause: Option<[usize; 3]>,
    ) {
        for_width!(add.words, W => {
            for z in 0..add.size[2] {
                let add = add.layers[z].rows::<W>();
                for y in add.range() {
                    let old = grid.solid.layers[z].rows::<W>().at(y);
                    let new = std::array::from_fn(|w| old[w] | add.at(y)[w]);
                    self.write::<W>(grid, [y, z], [old, new]);
                    self.paint::<W>(grid, [y, z], add.at(y), material);
                }
            }
        });
        if let Some(cause) = cause {
            let cause = voxel_number(grid, cause);
            self.grown.extend(add.iter().map(|voxel| (voxel_number(grid, voxel), cause)));
        }
    }

    /// Notes what a voxel was grown for.
    pub(crate) fn grow(&mut self, grid: &VoxelGrid, voxel: [usize; 3], cause: u32) {
        self.grown.push((voxel_number(grid, voxel), cause));
    }
}

/// The number of a voxel in the whole grid.
pub(crate) fn voxel_number(grid: &VoxelGrid, [x, y, z]: [usize; 3]) -> u32 {
    grid.solid.word_number([0, y, z]) * WORD_VOXELS as u32 + x as u32
}

/// The voxel with this number.
pub(crate) fn voxel_of(grid: &VoxelGrid, number: u32) -> [usize; 3] {
    let [w, y, z] = grid.solid.word_place(number / WORD_VOXELS as u32);
    [w * WORD_VOXELS + number as usize % WORD_VOXELS, y, z]
}
