//! Indexed triangle meshes: what every other room hands around once a shape has become triangles.
//!
//! Coordinates are millimetres, right-handed, z up; triangles run counter-clockwise seen from outside.
//! Positions are `f32`; measures (volume, centre of mass, inertia) are `f64`.

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
