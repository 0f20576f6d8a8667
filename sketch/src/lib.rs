//! Strokes become solids: from pen samples to curves, template fields, gestures and suggestions.
//!
//! The way of the data: [`stroke`] samples are cleaned and kept in a [`blobtree::Drawing`]; [`curve`] fits a
//! variational curve to it; [`template`] makes the field that sketched primitives sweep. [`gesture`] and
//! [`suggest`] read strokes as commands. Strokes come in pixels with y down; drawings are mm with y up.
//! This crate knows nothing of windows, meshes or printers.

pub mod curve;
pub mod gesture;
pub mod solid;
mod solve;
pub mod stroke;
pub mod suggest;
pub mod template;
pub mod thin_plate;

pub use solve::{Solver, drawing_of, redrawn, solve};
