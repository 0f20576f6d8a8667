//! What was found out about a node.

use blobtree::{NodePath, NodeRef};

/// What was found out about a node, remembered for as long as neither it nor anything around it changes.
#[derive(Debug)]
pub struct Known<T> {
    of: Option<(NodeRef, NodePath)>,
    /// None of no node, and where there is nothing to be found.
    pub found: Option<T>,
}

impl<T> Default for Known<T> {
    fn default() -> Self {
        Self { of: None, found: None }
    }
}

impl<T> Known<T> {
    /// Finds it out again if the node or anything around it is another one now.
    pub fn follow(
        &mut self,
        root: &NodeRef,
        path: Option<&NodePath>,
        find: impl FnOnce(&NodeRef, &NodePath) -> Option<T>,
    ) {
        let same = |(known, at): &(NodeRef, NodePath)| NodeRef::ptr_eq(known, root) && path == Some(at);
        if path.is_some() && self.of.as_ref().is_some_and(same) {
            return;
        }
        self.of = path.map(|path| (root.clone(), path.clone()));
        self.found = path.and_then(|path| find(root, path));
    }
}
