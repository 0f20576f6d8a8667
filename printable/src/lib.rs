//! What prints without supports, and what does not.
//!
//! A printer makes a solid in layers of one height h, from the bed z = 0 upwards. A layer prints without supports
//! if it reaches beyond the layer below by at most `r = h · tan θ`, where θ is the largest overhang, measured
//! from the vertical:
//!
//! ```text
//! S(k+1) ⊆ S(k) ⊕ B(r)                                          (Reiner & Lefebvre 2016, equation 1)
//! ```
//!
//! with S(k) the slice of layer k and B(r) a disc. Whatever lies on the bed is supported. [`SupportRule`] is
//! that rule with its two numbers.

mod brush;
pub mod check;
mod rebake;
mod rule;
pub mod slices;
mod support;
mod voxels;
mod why;

pub use brush::{
    Action, Brush, Dab, DabError, MAX_DABS, PressureRange, StrokeSample, StrokeShape, Tip, dabs_of, stroke,
};
pub use rebake::Rebaker;
pub use rule::{LayerHeight, OverhangAngle, RuleError, SupportRule};
pub use support::{
    Changes, Element, ElementError, GroundPaths, PathCost, PathMap, Paths, UnderBed, Why, add_supported,
    grow, preserve, smooth, trim, trim_with_changes, unsupported,
};
pub use voxels::{GridShape, MAX_VOXELS, VoxelError, VoxelGrid, VoxelSize};
pub use why::{Cause, Change};
