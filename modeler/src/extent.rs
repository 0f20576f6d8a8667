//! Where a node is.

use blobtree::{Aabb, NodePath, NodeRef, Tree, solid_box};
use polygonizer::{CellSize, Options, Surface};

/// Cells along the longest side of a node in looking for its lowest point: on a round underside, the lowest corner of
/// the mesh is within a ten-thousandth of the node's size of it.
const CELLS: f32 = 64.0;

/// Where a node is, remembered for as long as neither it nor anything around it changes.
#[derive(Debug, Default)]
pub struct NodeBox {
    of: Option<(NodeRef, NodePath)>,
    /// Around its solid, mm; none for a node without one.
    pub solid: Option<Aabb>,
}

impl NodeBox {
    /// Measures again if the node or anything around it is another one now.
    pub fn follow(&mut self, root: &NodeRef, path: Option<&NodePath>) {
        let same = |(known, at): &(NodeRef, NodePath)| NodeRef::ptr_eq(known, root) && path == Some(at);
        if path.is_some() && self.of.as_ref().is_some_and(same) {
            return;
        }
        self.of = path.map(|path| (root.clone(), path.clone()));
        let alone = path.and_then(|path| path.find_alone(root));
        self.solid = alone.map(|alone| solid_box(&Tree::new(&alone))).filter(|solid| !solid.is_empty());
    }
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
