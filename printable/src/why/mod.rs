//! Why matter was taken away or added at a place.
//!
//! A node's field goes through stages: the child, what grew below it, what the limit leaves of both, what brushes made
//! of that, and what settling took. Asked at a place, the last stage that changed the answer names the cause; the reason
//! for what the rule took or grew comes from voxels of the stage before, trimmed or looked at by the same rule.
//!
//! For places that somebody points at. What this does not do: lists of everything that changed.

mod cause;
mod stages;
mod voxels;

pub use cause::Cause;

use crate::Rebaker;
use blobtree::{BakeError, BakeStore, NodePath, NodeRef, Shape, SupportMode};
use glam::{Affine3A, Vec3};

/// What a support-free node changed at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where the node stands.
    pub node: NodePath,
    /// Whether matter was added; else it was taken away.
    pub added: bool,
    /// Why.
    pub cause: Cause,
}

impl Rebaker<'_> {
    /// What the support-free nodes of a tree changed at `place`, outermost first, and why. Empty if none did.
    ///
    /// - **In:** `place` in the root's space, mm, as are the places in the answer. `bakes` holds all nodes, as they were
    ///   baked; nodes that are not in it are passed over, and so are those below a taper, twist or bend.
    /// - **Cost:** a few samples where nothing changed. Else the voxels of the node, at most 512 along a side; for
    ///   strokes, their replay as often as it takes to find the one among them by halving.
    /// - **Errors:** as [`Baker::brush`](blobtree::Baker::brush).
    pub fn why(&self, root: &NodeRef, bakes: &BakeStore, place: Vec3) -> Result<Vec<Change>, BakeError> {
        let mut changes = Vec::new();
        let question = Question { rebaker: self, bakes, place };
        question.ask(root, NodePath::default(), Affine3A::IDENTITY, &mut changes)?;
        Ok(changes)
    }
}

/// What is asked of each node.
struct Question<'a> {
    rebaker: &'a Rebaker<'a>,
    bakes: &'a BakeStore,
    /// In the root's space.
    place: Vec3,
}

impl Question<'_> {
    fn ask(
        &self,
        node: &NodeRef,
        path: NodePath,
        root_from_node: Affine3A,
        changes: &mut Vec<Change>,
    ) -> Result<(), BakeError> {
        if !node.is_heard() {
            return Ok(());
        }
        if let Shape::SupportFree(rule, child) = &node.shape
            && rule.mode != SupportMode::Off
            && let Some(bake) = self.bakes.of(node)
        {
            let place = root_from_node.inverse().transform_point3(self.place);
            let known = stages::Known { rule, child, bake, bakes: self.bakes, rebaker: self.rebaker };
            if let Some((added, cause)) = known.change_at(place)? {
                let cause = cause.seen_through(&root_from_node);
                changes.push(Change { node: path.clone(), added, cause });
            }
        }
        let root_from_child = match &node.shape {
            Shape::Warp(warp, _) => warp.parent_from_child().map(|affine| root_from_node * affine),
            _ => Some(root_from_node),
        };
        let Some(root_from_child) = root_from_child else { return Ok(()) };
        for (n, child) in node.children().iter().enumerate() {
            self.ask(child, path.child(n), root_from_child, changes)?;
        }
        Ok(())
    }
}
