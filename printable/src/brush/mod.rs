//! Sculpting: brushes that keep a solid printable.
//!
//! A brush has a *tip*, any solid; a *dab* puts it somewhere, at a size and strength; a stroke is a sequence of dabs.
//! Each dab changes what it must and nothing else, and gives back its [`Changes`], which undo it without a copy of the
//! grid.
//!
//! **Source:** Reiner & Lefebvre 2016, §2.2 and §3.2.

mod dab;
mod stroke;
mod tip;

pub use dab::{Action, Brush, stroke};
pub use stroke::{Dab, DabError, MAX_DABS, PressureRange, StrokeSample, StrokeShape, dabs_of};
pub use tip::Tip;

#[cfg(doc)]
use crate::Changes;
