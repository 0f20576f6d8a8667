//! How fine to mesh: a cell size, from the command line and the size of the shape.

use crate::cli::ResolutionArgs;
use blobtree::{Field, solid_box};
use polygonizer::{CellSize, PolygonizeError};

/// Cells along the longest side unless asked otherwise.
const DEFAULT_CELLS: u32 = 128;

/// The cell size that was asked for, or 128 cells along the longest side of the solid's box.
///
/// Errors: a size that no cell can have.
pub fn cell_size(args: &ResolutionArgs, field: &dyn Field) -> Result<CellSize, PolygonizeError> {
    match args.cell {
        Some(mm) => CellSize::from_mm(mm as f32),
        None => {
            let longest = solid_box(field).size().max_element();
            // An empty shape has no size; any cell gives its empty mesh.
            let longest = if longest > 0.0 { longest } else { 1.0 };
            CellSize::across(longest, args.cells.unwrap_or(DEFAULT_CELLS))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::Tree;
    use blobtree::build::*;

    #[test]
    fn nothing_still_has_a_cell_size() {
        let nothing = point([0.0; 3], 5.0).subtract(point([0.0; 3], 9.0));
        let args = ResolutionArgs { cell: None, cells: None };
        assert!(cell_size(&args, &Tree::new(&nothing)).is_ok());
    }
}
