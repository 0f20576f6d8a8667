//! How far a node's solid reaches.

use blobtree::{Aabb, NodePath, NodeRef, Tree, solid_box};
use polygonizer::{CellSize, Options, Surface};

/// Cells along the longest side of a node in looking for its lowest point: on a round underside, the lowest corner of
/// the mesh is within a ten-thousandth of the node's size of it.
const CELLS: f32 = 64.0;

/// Around the solid of a node, mm; none for a node without one.
pub fn box_of(root: &NodeRef, path: &NodePath) -> Option<Aabb> {
    let alone = path.find_alone(root)?;
    let solid = solid_box(&Tree::new(&alone));
    (!solid.is_empty()).then_some(solid)
}

/// The height of the lowest point of a node's solid, mm: closer than the box around it. None for a node without one.
///
/// **Cost:** a surface of 64 cells.
pub fn lowest(root: &NodeRef, path: &NodePath) -> Option<f32> {
    let alone = path.find_alone(root)?;
    let tree = Tree::new(&alone);
    let longest = solid_box(&tree).size().max_element();
    let cell = CellSize::from_mm((longest / CELLS).max(1e-3)).ok()?;
    let mesh = Surface::build(&tree, cell, &Options::default()).ok()?;
    mesh.mesh().positions.iter().map(|at| at.z).reduce(f32::min)
}
