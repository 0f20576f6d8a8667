//! Voxels, the operators on them, and brushes, as other rooms use them.

mod brushes;
mod conversion;
mod elements;
mod operators;
mod reference;
