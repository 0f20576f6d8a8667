//! The voxel grid.

use super::bits::{Bits, Block, Row, for_width};
use super::materials::Materials;
use super::shape::GridShape;

/// A solid in voxels, with a material for each.
///
/// **Memory:** an eighth of a byte a voxel between the first and the last solid row of each layer, at most 16 MiB
/// in a grid of 512³; materials 4 KiB for every 64 × 8 × 8 voxels in which one is not the default.
#[derive(Clone, Debug)]
pub struct VoxelGrid {
    pub(crate) shape: GridShape,
    pub(crate) solid: Bits,
    pub(crate) materials: Materials,
}

impl VoxelGrid {
    /// An empty grid.
    pub fn new(shape: GridShape) -> Self {
        let solid = Bits::new(shape.voxels);
        Self { shape, materials: Materials::new(&solid), solid }
    }

    /// A grid from its words: bit `x % 64` of word `(z · ny + y) · w + x / 64`, where w is the number of words that
    /// hold nx bits, rounded up to 1, 2, 4 or 8. Missing words are empty; words and bits beyond the grid are ignored.
    pub fn from_words(shape: GridShape, words: &[u64]) -> Self {
        let mut grid = Self::new(shape);
        let per_layer = (grid.solid.words * shape.voxels[1]).max(1);
        for_width!(grid.solid.words, W => {
            let full: Row<W> = grid.solid.full_row();
            for (layer, words) in grid.solid.layers.iter_mut().zip(words.chunks(per_layer)) {
                let mut block = Block::<W>::default();
                let rows = words.as_chunks::<W>().0;
                block.rows.extend(rows.iter().map(|row| std::array::from_fn(|w| row[w] & full[w])));
                block.tighten();
                layer.set(&block);
            }
        });
        grid
    }

    /// The words that [`Self::from_words`] takes.
    pub fn to_words(&self) -> Vec<u64> {
        let [_, ny, nz] = self.shape.voxels;
        let places = (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z)));
        places.flat_map(|(y, z)| (0..self.solid.words).map(move |w| self.solid.word([w, y, z]))).collect()
    }

    /// Where the voxels lie.
    pub fn shape(&self) -> &GridShape {
        &self.shape
    }

    /// Whether a voxel is solid; those outside the grid are not.
    pub fn is_solid(&self, voxel: [usize; 3]) -> bool {
        self.solid.get(voxel)
    }

    /// Makes a voxel solid or empty, and asks no rule; one outside the grid is left alone.
    pub fn set_solid(&mut self, voxel: [usize; 3], solid: bool) {
        if (0..3).all(|axis| voxel[axis] < self.shape.voxels[axis]) {
            self.solid.set(voxel, solid);
        }
    }

    /// The material of a voxel; 0, the default, outside the grid. What an empty voxel says has no meaning.
    pub fn material(&self, [x, y, z]: [usize; 3]) -> u8 {
        let inside = (0..3).all(|axis| [x, y, z][axis] < self.shape.voxels[axis]);
        if inside { self.materials.of_word([x / 64, y, z])[x % 64] } else { 0 }
    }

    /// Gives a voxel of the grid another material.
    pub fn set_material(&mut self, [x, y, z]: [usize; 3], material: u8) {
        if (0..3).all(|axis| [x, y, z][axis] < self.shape.voxels[axis]) {
            let mut word = self.materials.of_word([x / 64, y, z]);
            word[x % 64] = material;
            self.materials.set_word([x / 64, y, z], word);
        }
    }

    /// How many voxels are solid.
    pub fn count(&self) -> usize {
        self.solid.count()
    }

    /// All solid voxels, layer by layer from the bed, x fastest.
    pub fn solid_voxels(&self) -> impl Iterator<Item = [usize; 3]> {
        self.solid.iter()
    }

    /// Whether the solid voxels are the same; materials are not looked at.
    pub fn same_solid(&self, other: &Self) -> bool {
        self.solid == other.solid
    }

    /// Bytes that the grid takes now.
    pub fn bytes(&self) -> usize {
        let rows: usize = (0..self.shape.voxels[2]).map(|z| self.solid.kept(z).len()).sum();
        rows * self.solid.words * size_of::<u64>() + self.materials.bytes()
    }
}
