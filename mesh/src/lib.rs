//! Indexed triangle meshes: what every other room hands around once a shape has become triangles.
//!
//! Coordinates are millimetres, right-handed, z up; triangles run counter-clockwise seen from outside.
//! Positions are `f32`; measures (volume, centre of mass, inertia) are `f64`.

use glam::Vec3;

/// An indexed triangle mesh. Nothing is promised about it: [`Validity`] tells what holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, mm.
    pub positions: Vec<Vec3>,
    /// Corner indices into `positions`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}
