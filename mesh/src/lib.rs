//! Indexed triangle meshes: what every other room hands around once a shape has become triangles.
//!
//! Coordinates are millimetres, right-handed, z up; triangles run counter-clockwise seen from outside.
//! Positions are `f32`; measures (volume, centre of mass, inertia) are `f64`.
//!
//! A [`Mesh`] can be measured and judged, read and written by [`io`], thinned out by [`simplify()`], and asked for
//! distances by [`MeshDistance`]. What a mesh means, and where it came from, is not known here.
//!
//! ```
//! use glam::Vec3;
//! use mesh::{MeshDistance, SelfIntersections, shapes};
//!
//! let block = shapes::cuboid(Vec3::ZERO, Vec3::new(20.0, 10.0, 5.0));
//! assert!((block.volume() - 1000.0).abs() < 1e-6);
//! assert!(block.validity(SelfIntersections::Search).is_printable_solid());
//!
//! let distance = MeshDistance::new(&block)?;
//! assert_eq!(distance.signed_distance(Vec3::new(10.0, 5.0, 1.0)), -1.0);
//!
//! // With a hole, it is still clear what is inside; only the verdict changes.
//! let mut open = block.clone();
//! open.triangles.pop();
//! assert!(!open.is_closed_manifold());
//! assert!(MeshDistance::new(&open)?.signed_distance(Vec3::new(10.0, 5.0, 1.0)) < 0.0);
//! # Ok::<(), mesh::MeshDistanceError>(())
//! ```

mod bvh;
mod bvh_build;
mod closest;
mod components;
mod crossings;
mod distance;
mod edges;
pub mod io;
mod measure;
mod normals;
mod quadric;
pub mod shapes;
mod simplify;
#[cfg(test)]
mod test_random;
mod validity;
mod winding;

pub use bvh::{Bvh, Closest, RayHit};
pub use closest::Feature;
pub use components::{Body, Components};
pub use crossings::Crossings;
pub use distance::{MeshDistance, MeshDistanceError, Nearest};
pub use measure::{Bounds, Mass};
pub use simplify::simplify;
pub use validity::{Element, Fault, Finding, MOST_PLACES, SelfIntersections, Validity};

use glam::Vec3;

/// An indexed triangle mesh. Nothing is promised about it: [`Validity`] tells what holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, mm.
    pub positions: Vec<Vec3>,
    /// Corner indices into `positions`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}
