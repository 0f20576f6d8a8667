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
    /// What the support-free nodes of a tree changed at each of `places`, outermost first, and why. Empty where none did.
    ///
    /// - **In:** `places` in the root's space, mm, as are those in the answers. `bakes` holds all nodes, as they were
    ///   baked; nodes that are not in it are passed over, and so are those below a taper, twist or bend.
    /// - **Cost:** a few samples where nothing changed. Else once the voxels of the node, at most 512 along a side; for
    ///   each place that a stroke changed, replays until the one among them is found by halving.
    /// - **Errors:** as [`Baker::brush`](blobtree::Baker::brush).
    pub fn why(
        &self,
        root: &NodeRef,
        bakes: &BakeStore,
        places: &[Vec3],
    ) -> Result<Vec<Vec<Change>>, BakeError> {
        let mut answers = vec![Vec::new(); places.len()];
        let question = Question { rebaker: self, bakes, places };
        question.ask(root, NodePath::default(), Affine3A::IDENTITY, &mut answers)?;
        Ok(answers)
    }
}

/// What is asked of each node.
struct Question<'a> {
    rebaker: &'a Rebaker<'a>,
    bakes: &'a BakeStore,
    /// In the root's space.
    places: &'a [Vec3],
}

impl Question<'_> {
    fn ask(
        &self,
        node: &NodeRef,
        path: NodePath,
        root_from_node: Affine3A,
        answers: &mut [Vec<Change>],
    ) -> Result<(), BakeError> {
        if !node.is_heard() {
            return Ok(());
        }
        if let Shape::SupportFree(rule, child) = &node.shape
            && rule.mode != SupportMode::Off
            && let Some(bake) = self.bakes.of(node)
        {
            let seen = stages::Seen::default();
            let known = stages::Known { rule, child, bake, bakes: self.bakes, rebaker: self.rebaker, seen };
            let node_from_root = root_from_node.inverse();
            for (place, changes) in self.places.iter().zip(&mut *answers) {
                if let Some((added, cause)) = known.change_at(node_from_root.transform_point3(*place))? {
                    let cause = cause.seen_through(&root_from_node);
                    changes.push(Change { node: path.clone(), added, cause });
                }
            }
        }
        let root_from_child = match &node.shape {
            Shape::Warp(warp, _) => warp.parent_from_child().map(|affine| root_from_node * affine),
            _ => Some(root_from_node),
        };
        let Some(root_from_child) = root_from_child else { return Ok(()) };
        for (n, child) in node.children().iter().enumerate() {
            self.ask(child, path.child(n), root_from_child, answers)?;
        }
        Ok(())
    }
}
