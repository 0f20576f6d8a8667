//! What a command brought to a tree.

use blobtree::{NodePath, NodeRef, Shape};
use std::collections::HashSet;
use std::sync::Arc;

/// The primitive that a command brought: the last one of the new tree that is not in the old one.
pub fn newest(old: &NodeRef, new: &NodeRef) -> Option<NodePath> {
    let mut known = HashSet::new();
    walk(old, &mut NodePath::default(), &mut |node, _| known.insert(Arc::as_ptr(node)));
    let mut found = None;
    walk(new, &mut NodePath::default(), &mut |node, path| {
        let is_new = !known.contains(&Arc::as_ptr(node));
        if is_new && matches!(node.shape, Shape::Primitive(_)) {
            found = Some(path.clone());
        }
        is_new
    });
    found
}

/// Visits nodes, parents first, and goes below those for which `visit` says so.
fn walk(node: &NodeRef, path: &mut NodePath, visit: &mut impl FnMut(&NodeRef, &NodePath) -> bool) {
    if visit(node, path) {
        for (index, child) in node.children().iter().enumerate() {
            path.0.push(index);
            walk(child, path, visit);
            path.0.pop();
        }
    }
}
