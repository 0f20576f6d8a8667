//! Bakes, kept from one version of a scene to the next.

use super::{Bake, BakeError, Baker, SupportFree, SupportMode};
use crate::cache::NodeCache;
use crate::eval::Tree;
use crate::node::{Node, NodeRef, Shape};
use std::collections::HashMap;
use std::sync::{Arc, Weak};

/// Most bakes that are kept; beyond, those of other versions are dropped.
const MOST_BAKES: usize = 64;

/// By what a bake depends on: the child's address, and the numbers of the rule.
type Key = (usize, SupportMode, [u32; 3]);

/// The bakes of a scene's support-free nodes.
///
/// They belong to the nodes' children by identity: an edit elsewhere, a new name, or an undone edit costs
/// nothing. A store serves one baker, whose results may depend on nothing but the node.
#[derive(Clone, Debug, Default)]
pub struct BakeStore {
    /// The weak reference keeps the address from being used again.
    bakes: HashMap<Key, (Weak<Node>, Arc<Bake>)>,
}

/// What is already known of a tree's nodes when it is compiled.
#[derive(Clone, Copy)]
pub(crate) struct Kept<'a> {
    pub cache: &'a dyn Fn(&Node) -> Option<Arc<NodeCache>>,
    pub bakes: &'a BakeStore,
}

impl BakeStore {
    /// An empty store.
    pub fn new() -> Self {
        Self::default()
    }

    /// Bakes every support-free node of the tree that is heard, switched on, and not baked yet, from the innermost
    /// outwards, and compiles the tree with all of them.
    ///
    /// Errors: the baker's.
    pub fn tree(&mut self, root: &NodeRef, baker: &dyn Baker) -> Result<Tree, BakeError> {
        self.bake(root, baker)?;
        Ok(self.compile(root))
    }

    /// Bakes as [`Self::tree`] does.
    ///
    /// Errors: the baker's.
    pub fn bake(&mut self, root: &NodeRef, baker: &dyn Baker) -> Result<(), BakeError> {
        self.bakes.retain(|_, (child, _)| child.strong_count() > 0);
        if self.bakes.len() > MOST_BAKES {
            let mut present = Vec::new();
            visit(root, &mut |rule, child| present.push(key(rule, child)));
            self.bakes.retain(|key, _| present.contains(key));
        }
        let mut missing = Vec::new();
        visit(root, &mut |rule, child| missing.push((*rule, child.clone())));
        for (rule, child) in missing {
            if self.find(&rule, &child).is_none() {
                let upright = Tree::compiled_in(&child, &rule.upright_from_child().inverse(), self.kept());
                let bake = baker.bake(&rule, &upright)?;
                let node = Node::new(Shape::SupportFree(rule, child.clone()));
                let baked = |bake: &Bake| {
                    let mut store = self.clone();
                    store.insert(&rule, &child, bake.clone());
                    store.compile(&node)
                };
                let bake = baker.finish(&rule, &baked, bake)?;
                self.insert(&rule, &child, bake);
            }
        }
        Ok(())
    }

    /// Compiles any tree with the bakes that are known; its other support-free nodes show their child as it is.
    pub fn compile(&self, node: &Node) -> Tree {
        Tree::compiled(node, self.kept())
    }

    /// The bake of a support-free node, if there is one.
    pub fn of(&self, node: &Node) -> Option<&Arc<Bake>> {
        match &node.shape {
            Shape::SupportFree(rule, child) => self.find(rule, child),
            _ => None,
        }
    }

    fn insert(&mut self, rule: &SupportFree, child: &NodeRef, bake: Bake) {
        self.bakes.insert(key(rule, child), (Arc::downgrade(child), Arc::new(bake)));
    }

    pub(crate) fn find(&self, rule: &SupportFree, child: &NodeRef) -> Option<&Arc<Bake>> {
        let (weak, bake) = self.bakes.get(&key(rule, child))?;
        (weak.strong_count() > 0).then_some(bake)
    }

    /// These bakes and no caches.
    pub(crate) fn kept(&self) -> Kept<'_> {
        Kept { cache: &|_| None, bakes: self }
    }
}

fn key(rule: &SupportFree, child: &NodeRef) -> Key {
    let numbers = [rule.overhang_degrees, rule.layer_height, rule.bed].map(f32::to_bits);
    (Arc::as_ptr(child) as usize, rule.mode, numbers)
}

/// Calls `found` for every support-free node to bake, children before parents.
fn visit<'a>(node: &'a NodeRef, found: &mut dyn FnMut(&SupportFree, &'a NodeRef)) {
    if !node.is_heard() {
        return;
    }
    node.children().iter().for_each(|child| visit(child, found));
    if let Shape::SupportFree(rule, child) = &node.shape
        && rule.mode != SupportMode::Off
    {
        found(rule, child);
    }
}
