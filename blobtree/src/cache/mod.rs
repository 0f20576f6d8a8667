//! Hierarchical spatial caches: fields of subtrees kept as samples, filled where they are asked for.
//!
//! A cache node approximates the field of its subtree by tricubic interpolation of lattice samples, so that
//! asking for a value costs the same however many primitives lie below. It answers only where that is
//! accurate: in cells whose third differences and whose middle say so, and where the gradient does not jump.
//! Everywhere else the subtree is evaluated exactly, so creases stay as sharp as without caches. Where a cache
//! answers, and what, depends on the place alone: not on who asked before, nor on how much room is left.
//!
//! Caches belong to nodes by identity and live in a [`CacheStore`] beside the scene: an edit keeps every
//! brick that it cannot be felt in, and an undone state finds its caches as they were.
//!
//! **Source:** Schmidt & Wyvill 2011, §11.3.4. **Departs:** the paper's caches smooth creases; these do not.

mod bricks;
mod certificate;
mod interpolation;
mod pages;
mod reader;
mod store;

pub(crate) use bricks::{CacheSite, NodeCache};
pub(crate) use reader::CacheReader;
pub use store::{CachePolicy, CacheStore};
