//! How fine to mesh.

use crate::PolygonizeError;

/// Side of a meshing cell: positive and finite.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct CellSize(f32);

impl CellSize {
    /// A cell this many mm wide. Errors: [`PolygonizeError::CellSize`] unless positive and finite.
    pub fn from_mm(mm: f32) -> Result<Self, PolygonizeError> {
        if mm.is_normal() && mm > 0.0 { Ok(Self(mm)) } else { Err(PolygonizeError::CellSize { mm }) }
    }

    /// The cell of which `cells` fit along `longest_side` (mm). Errors: [`PolygonizeError::CellSize`] if
    /// that is not positive and finite.
    pub fn across(longest_side: f32, cells: u32) -> Result<Self, PolygonizeError> {
        Self::from_mm(longest_side / cells as f32)
    }

    /// Its width, mm.
    pub fn mm(self) -> f32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_positive_finite_cells_exist() {
        for mm in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45] {
            assert!(CellSize::from_mm(mm).is_err(), "{mm}");
        }
        assert!(CellSize::across(10.0, 0).is_err());
        assert_eq!(CellSize::across(10.0, 40).map(CellSize::mm), Ok(0.25));
    }
}
