//! Where a node is.

use blobtree::{Aabb, NodePath, NodeRef, Tree, solid_box};

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
