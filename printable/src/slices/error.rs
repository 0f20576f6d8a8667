//! Why a mesh cannot be sliced.

/// Most layers of one part; a part with more is most likely in another unit than millimetres.
pub const MOST_LAYERS: usize = 100_000;
/// Most crossings of triangles and planes, which bounds memory: about 50 bytes each.
pub const MOST_CROSSINGS: u64 = 50_000_000;
/// The widest part, mm; wider ones could not be told to a micrometre.
pub const WIDEST_MM: f64 = 100_000.0;

/// Why there are no slices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SliceError {
    /// No triangle has three corners that exist.
    #[error("the mesh has no triangles to slice")]
    Empty,
    /// A corner is NaN or infinite.
    #[error("a vertex of triangle {triangle} is not finite; repair the mesh first")]
    NotFinite {
        /// Index of the triangle.
        triangle: usize,
    },
    /// The part is too wide for the fixed-point numbers that slices are made of.
    #[error("the part is {width_mm:.0} mm wide, more than {WIDEST_MM} mm; is its unit right?")]
    TooWide {
        /// The longer side of its outline, mm.
        width_mm: f64,
    },
    /// More layers than [`MOST_LAYERS`].
    #[error(
        "{layers:.0} layers of {layer_height_mm} mm are more than {MOST_LAYERS}; use thicker layers, or is the unit wrong?"
    )]
    TooManyLayers {
        /// Layers of the part.
        layers: f64,
        /// Height of a layer, mm.
        layer_height_mm: f64,
    },
    /// More outline in all layers together than [`MOST_CROSSINGS`].
    #[error(
        "the outlines of all layers would have {crossings} points, more than {MOST_CROSSINGS}; use thicker layers or simplify the mesh"
    )]
    TooDetailed {
        /// Crossings of triangles and planes.
        crossings: u64,
    },
    /// Somebody asked to stop.
    #[error("slicing was stopped")]
    Cancelled,
}
