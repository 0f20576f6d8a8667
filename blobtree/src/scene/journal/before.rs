//! The scene before a command, as the reader of the command's nodes needs it.

use crate::imported::ImportedMesh;
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::primitive::{Drawn, Primitive};
use crate::scene::Scene;
use crate::scene::check::{Size, measure};
use std::collections::HashSet;

/// A scene to which nodes may refer.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Before<'a>(pub &'a Scene);

impl Before<'_> {
    /// The node there, if there is one, with its size.
    pub fn kept(self, path: &NodePath) -> Option<(NodeRef, Size)> {
        path.find(&self.0.root).and_then(measured)
    }

    /// The definition of this name, with its size.
    pub fn definition(self, name: &str) -> Option<(NodeRef, Size)> {
        self.0.definitions.get(name).and_then(measured)
    }

    /// All meshes that were loaded and all drawings that were solved for it.
    pub fn sources(self, mut mesh: impl FnMut(&ImportedMesh), mut drawn: impl FnMut(Drawn<'_>)) {
        let mut seen: HashSet<*const Node> = HashSet::new();
        let mut open: Vec<&NodeRef> = self.0.definitions.values().chain([&self.0.root]).collect();
        while let Some(node) = open.pop() {
            if !seen.insert(std::ptr::from_ref(&**node)) {
                continue;
            }
            open.extend(node.children());
            match &node.shape {
                Shape::Primitive(Primitive::Mesh(imported)) => mesh(imported),
                Shape::Primitive(primitive) if primitive.is_drawn() => {
                    primitive.clone().drawn().into_iter().for_each(&mut drawn);
                }
                _ => {}
            }
        }
    }
}

/// Scenes of documents are legal, so that every node has a size.
fn measured(node: &NodeRef) -> Option<(NodeRef, Size)> {
    measure(node).ok().map(|size| (node.clone(), size))
}
