//! Hierarchical spatial caches: fields of subtrees kept as samples, filled where they are asked for.
//!
//! A cache node approximates the field of its subtree by trilinear interpolation of lattice samples, so that
//! asking for a value costs the same however many primitives lie below. It answers only where that is
//! accurate: where a brick of samples shows too much curvature, or where the gradient may jump, the subtree
//! is evaluated exactly instead, so creases stay as sharp as without caches.
//!
//! Caches belong to nodes by identity and live in a [`CacheStore`] beside the scene: an edit keeps every
//! brick that it cannot be felt in, and an undone state finds its caches as they were.
//!
//! **Source:** Schmidt & Wyvill 2011, §11.3.4. **Departs:** the paper's caches smooth creases; these do not.

mod bricks;
mod store;

pub(crate) use bricks::{CacheReader, CacheSite, NodeCache};
pub use store::{CachePolicy, CacheStore};
