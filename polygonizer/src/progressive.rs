//! A coarse surface at once, finer ones after it.

use blobtree::Field;

use crate::{CellSize, Options, PolygonizeError, Surface};

/// Makes the surface of `field` `levels` times, each with cells half as wide as before, the last with
/// `cell`, and hands each to `show` as soon as it is there.
///
/// - **Errors:** as [`Surface::build`]; surfaces shown before stay valid. A level too coarse to exist (its
///   cells are infinite) is skipped.
/// - **Cost:** each level about a quarter of the next.
///
/// Progress runs from 0 to 1 for every level anew.
pub fn progressive(
    field: &dyn Field,
    cell: CellSize,
    levels: u32,
    options: &Options,
    mut show: impl FnMut(Surface),
) -> Result<(), PolygonizeError> {
    for level in (0..levels).rev() {
        if let Ok(coarse) = CellSize::from_mm(cell.mm() * 2.0_f32.powi(level as i32)) {
            show(Surface::build(field, coarse, options)?);
        }
    }
    Ok(())
}
