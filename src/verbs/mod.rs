//! What each verb does: opens its input, asks the rooms, and makes a report.

pub mod check;
pub mod convert;
pub mod eval;
pub mod mesh;
pub mod render;
pub mod sketch;
pub mod slice;
pub mod support_free;
pub mod tree;
