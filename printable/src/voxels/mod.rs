//! Solids as voxels: one bit each, in layers as a printer makes them.
//!
//! A [`VoxelGrid`] holds up to 512³ voxels. Voxel `[x, y, z]` is a box of [`VoxelSize`]; layer z is the slab from
//! `z · h` to `(z + 1) · h` above the bed. Whether it is solid is decided at its centre, so a layer is the slice at
//! its middle height, which is where slicers cut too. 64 voxels share a word, and a layer keeps only the rows
//! between its first and its last solid one.
//!
//! Grids come from fields and meshes; what holds for them, and how to change them, is the matter of the support
//! operators and brushes.

mod bits;
mod columns;
mod from_field;
mod from_mesh;
mod grid;
mod materials;
mod shape;

pub(crate) use bits::{Bits, Block, Row, Rows, for_width, join, moved_row, ones, run_of_bits};
pub(crate) use from_field::solid_bounds;
pub use grid::VoxelGrid;
pub(crate) use materials::WORD_VOXELS;
pub use shape::{GridShape, MAX_VOXELS, VoxelError, VoxelSize};
