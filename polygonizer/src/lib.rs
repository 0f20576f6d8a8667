//! Fields to meshes.

mod brick_surface;
mod cell_size;
mod crossings;
mod error;
mod feature;
mod grid;
mod lattice;
mod patches;
mod place;
mod progress;
mod progressive;
mod qef;
mod ring;
mod settle;
mod stitch;
mod surface;
mod workers;

pub use cell_size::CellSize;
pub use error::PolygonizeError;
pub use place::VertexKind;
pub use progress::{Cancel, Options};
pub use progressive::progressive;
pub use surface::{Changes, Chunk, Surface};

use blobtree::Field;
use mesh::Mesh;

/// The mesh of `field` in cells of this size: [`Surface::build`] with default options, then
/// [`Surface::mesh`].
pub fn polygonize(field: &dyn Field, cell: CellSize) -> Result<Mesh, PolygonizeError> {
    Ok(Surface::build(field, cell, &Options::default())?.mesh())
}
