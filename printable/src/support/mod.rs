//! Operators that keep voxels printable without supports.
//!
//! A voxel above the bed is *supported* if the layer below holds a voxel within reach. How far that is, an
//! [`Element`] says: a disc in effect. [`trim()`] removes what is not supported, [`preserve()`] keeps below what is
//! needed above, [`grow()`] adds paths below. Each works on whole words of 64 voxels, and every [`Changes`] can be
//! undone and asked why.
//!
//! Brushes do the same to what they touch, and only to that. What is not done here: fields, whose surface is smooth,
//! and meshes.

mod carry;
mod changes;
mod edit;
mod element;
mod grow;
mod path_map;
mod paths;
mod preserve;
mod slice_distance;
mod smooth;
mod trim;
mod why;

pub use changes::Changes;
pub(crate) use edit::{Edit, apply};
pub use element::{Element, ElementError};
pub use grow::grow;
pub(crate) use grow::{grow_below, is_carried};
pub use path_map::{PathCost, PathMap};
pub use paths::{GroundPaths, Paths};
pub(crate) use preserve::leave_needed;
pub use preserve::preserve;
pub(crate) use smooth::smooth_within;
pub use smooth::{UnderBed, smooth};
pub use trim::{add_supported, trim, trim_with_changes, unsupported};
pub use why::Why;
