//! Fields to meshes: closed, sharp, and quick to follow an edit.
//!
//! Ask for the mesh of a field in cells of some size:
//!
//! ```
//! # use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, Interval, Sample, Sampler};
//! # use glam::Vec3;
//! # struct Ball;
//! # impl Ball { fn at(p: Vec3) -> Sample { Sample { value: (1.0 - 0.05 * p.length()).max(0.0), gradient: p * -0.05 / p.length().max(1e-9), piece: 1 } } }
//! # impl Field for Ball {
//! #     fn support(&self) -> Aabb { Aabb::around(Vec3::ZERO, Vec3::splat(20.0)) }
//! #     fn sampler(&self) -> Box<dyn Sampler + '_> { Box::new(BallSampler) }
//! # }
//! # struct BallSampler;
//! # impl Sampler for BallSampler {
//! #     fn enter(&mut self, _: Aabb) -> Interval { Interval { lo: 0.0, hi: 1.0 } }
//! #     fn leave(&mut self) {}
//! #     fn creased(&self) -> bool { false }
//! #     fn fill(&mut self, brick: &Brick, values: &mut [f32; BRICK_SAMPLES]) {
//! #         for (i, v) in values.iter_mut().enumerate() { *v = Ball::at(brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK])).value; }
//! #     }
//! #     fn values(&mut self, points: &[Vec3], values: &mut [f32]) { for (p, v) in points.iter().zip(values) { *v = Ball::at(*p).value; } }
//! #     fn samples(&mut self, points: &[Vec3], samples: &mut [Sample]) { for (p, s) in points.iter().zip(samples) { *s = Ball::at(*p); } }
//! # }
//! # let field = Ball; // a ball of 10 mm radius
//! use polygonizer::{CellSize, Options, Surface, polygonize, progressive};
//!
//! let cell = CellSize::from_mm(0.5)?;
//! let mesh = polygonize(&field, cell)?;
//! assert!(mesh.positions.iter().all(|p| (p.length() - 10.0).abs() < 0.005));
//! # Ok::<(), polygonizer::PolygonizeError>(())
//! ```
//!
//! Keep the [`Surface`] instead to let it follow edits, or to draw it brick by brick; it can also be made
//! coarse first:
//!
//! ```no_run
//! # use blobtree::{Aabb, Field};
//! # use polygonizer::{CellSize, Options, PolygonizeError, Surface, progressive};
//! # fn show(_: &polygonizer::Chunk) {}
//! # fn tour(field: &dyn Field, edited: &dyn Field, dirty: Aabb) -> Result<(), PolygonizeError> {
//! let cell = CellSize::from_mm(0.5)?;
//! let mut surface = Surface::build(field, cell, &Options::default())?;
//! let changes = surface.update(edited, &dirty, &Options::default())?;
//! for &brick in &changes.changed {
//!     show(&surface.chunk(brick));
//! }
//! progressive(edited, cell, 3, &Options::default(), |coarser| println!("{:?}", coarser.cell()))?;
//! # Ok(())
//! # }
//! ```
//!
//! # How
//!
//! Manifold dual contouring on the lattice of all integer multiples of the cell size, in bricks of 15³ cells.
//! Bounds prove most of space empty, in blocks of 4³ bricks and then bricks. Then, each brick by itself:
//!
//! 1. one vertex for every patch of every cell that the surface passes (`patches`), on the patch's own sheet of the
//!    surface if that is smooth there (`place`), else on its sharp edge or corner (`feature`);
//! 2. features that had to leave their cells' safe boxes (`bold`) are admitted if no triangle suffers (`settle`);
//! 3. one quadrilateral for every lattice edge that the surface crosses (`stitch`), cut in two so that no triangle is
//!    turned over if that can be (`ring`);
//! 4. one vertex more on every line that cuts off a sharp edge (`crease`, `split`).
//!
//! A brick's vertices depend on the field in it and one cell around only. So an update remakes the bricks that
//! an edit touches, and has the very same bytes as a fresh surface.
//!
//! # What it does not do
//!
//! Parts of the solid that hold no lattice point and gaps that no lattice point lies in are not seen: choose
//! cells smaller than what matters. Sheets closer than a cell may touch, and at a few places cross. Lines that cut off sharp edges are
//! split, but not turned: a triangle that joins the three edges of a corner, past that corner, stays.

mod bold;
mod brick_surface;
mod cell_size;
mod crease;
mod crossings;
mod error;
mod feature;
mod finish;
mod grid;
mod guess;
mod lattice;
mod patches;
mod place;
mod progress;
mod progressive;
mod qef;
mod ring;
mod settle;
mod split;
mod stitch;
mod surface;
mod walk;
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
