//! What can stop a surface from being made.

/// Why there is no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonizeError {
    /// The cell size is zero, negative, or no number.
    #[error("cell size is {mm} mm; it must be a positive number")]
    CellSize {
        /// As asked for.
        mm: f32,
    },
    /// The field's box has no end, so no lattice covers it.
    #[error("the field's box reaches from {min:?} to {max:?} mm; it must be finite")]
    Support {
        /// Lowest corner of the field's box.
        min: [f32; 3],
        /// Highest corner of the field's box.
        max: [f32; 3],
    },
    /// The field's box is too many cells wide, or too many cells from the origin.
    #[error("cells of {cell_mm} mm are too small for a shape of this size and place; {fits_mm} mm fits")]
    TooFine {
        /// The cell size asked for.
        cell_mm: f32,
        /// A cell size that is large enough.
        fits_mm: f32,
    },
    /// The surface has more triangles than allowed.
    #[error("the mesh has more than {limit} triangles at a cell size of {cell_mm} mm; try {} mm", 2.0 * cell_mm)]
    TooManyTriangles {
        /// [`crate::Options::max_triangles`].
        limit: usize,
        /// The cell size asked for.
        cell_mm: f32,
    },
    /// [`crate::Cancel`] was used. Nothing has changed.
    #[error("cancelled")]
    Cancelled,
}
