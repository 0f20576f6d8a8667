//! Whether a tree is legal: its numbers, its depth, its size.

use super::error::{SceneError, SceneProblem};
use super::{MAX_DEPTH, MAX_NODES, Scene};
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::support_free::BrushTip;
use std::collections::HashMap;

/// How large a tree is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    /// Nodes, a shared one counted wherever it stands.
    pub nodes: u64,
    /// Nodes from the root to the deepest leaf, both included.
    pub height: usize,
}

impl Size {
    /// The size of a node over children of these sizes.
    pub(crate) fn over(children: impl Iterator<Item = Self>) -> Self {
        children.fold(Self { nodes: 1, height: 1 }, |sum, child| Self {
            nodes: sum.nodes.saturating_add(child.nodes),
            height: sum.height.max(child.height + 1),
        })
    }
}

/// See [`Scene::check`].
pub(super) fn scene(scene: &Scene) -> Result<(), SceneError> {
    let mut checker = Checker::default();
    checker.tree(&scene.root, "")?;
    for (name, node) in scene.definitions.iter() {
        checker.tree(node, &format!("define.{}", super::error::shortened(name)))?;
    }
    Ok(())
}

/// The size of a tree whose numbers are legal.
///
/// Errors: as [`Scene::check`]. Cost: linear in the number of different nodes.
pub(crate) fn measure(root: &NodeRef) -> Result<Size, SceneError> {
    Checker::default().tree(root, "")
}

/// Errors: the numbers of this one node.
pub(crate) fn numbers(node: &Node) -> Result<(), SceneProblem> {
    match &node.shape {
        Shape::Primitive(primitive) => Ok(primitive.check()?),
        Shape::Warp(warp, _) => Ok(warp.check()?),
        Shape::SupportFree(rule, _) => {
            rule.check()?;
            let tips = rule.strokes.iter().filter_map(|stroke| match &stroke.tip {
                BrushTip::Shape(node) => Some(node),
                _ => None,
            });
            tips.map(|tip| measure(tip).map_err(|e| e.problem)).try_for_each(|size| size.map(drop))
        }
        // A sharpness is checked where it is made.
        Shape::Operator(..) => Ok(()),
    }
}

#[derive(Default)]
struct Checker {
    /// By address; every node seen here stays alive through its root.
    seen: HashMap<*const Node, Size>,
    path: Vec<usize>,
}

impl Checker {
    fn tree(&mut self, root: &NodeRef, label: &str) -> Result<Size, SceneError> {
        self.path.clear();
        self.node(root).map_err(|problem| {
            let path = NodePath(self.path.clone()).to_string();
            let node = if label.is_empty() { path } else { format!("{label}{}", path.trim_end_matches('/')) };
            SceneError { at: None, node: Some(node), problem }
        })
    }

    /// Leaves `path` at the node that is wrong.
    fn node(&mut self, node: &NodeRef) -> Result<Size, SceneProblem> {
        if let Some(&size) = self.seen.get(&std::ptr::from_ref(&**node)) {
            return if self.path.len() + size.height > MAX_DEPTH {
                Err(SceneProblem::TooDeep)
            } else {
                Ok(size)
            };
        }
        if self.path.len() >= MAX_DEPTH {
            return Err(SceneProblem::TooDeep);
        }
        numbers(node)?;
        let mut sizes = Vec::with_capacity(node.children().len());
        for (index, child) in node.children().iter().enumerate() {
            self.path.push(index);
            sizes.push(self.node(child)?);
            self.path.pop();
        }
        let size = Size::over(sizes.into_iter());
        if size.nodes > MAX_NODES {
            return Err(SceneProblem::TooManyNodes);
        }
        self.seen.insert(std::ptr::from_ref(&**node), size);
        Ok(size)
    }
}
