//! Bakes, kept from one version of a scene to the next.

use super::{Bake, BakeError, Baker, BrushStroke, SupportFree, SupportMode};
use crate::cache::NodeCache;
use crate::eval::Tree;
use crate::node::{Node, NodeRef, Shape};
use std::collections::HashMap;
use std::sync::{Arc, Weak};

/// Most bakes that are kept; beyond, those of other versions are dropped.
const MOST_BAKES: usize = 64;

/// By what a bake depends on: the child's address, the numbers of the rule, and the strokes' addresses.
type Key = (usize, SupportMode, [u32; 3], Vec<usize>);

/// The bakes of a scene's support-free nodes.
///
/// They belong to the nodes' children by identity: an edit elsewhere, a new name, or an undone edit costs
/// nothing. A store serves one baker, whose results may depend on nothing but the node.
#[derive(Clone, Debug, Default)]
pub struct BakeStore {
    bakes: HashMap<Key, KeptBake>,
}

/// A bake with what keeps the addresses in its key from being used again.
#[derive(Clone, Debug)]
struct KeptBake {
    child: Weak<Node>,
    _strokes: Vec<Arc<BrushStroke>>,
    bake: Arc<Bake>,
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
        self.bakes.retain(|_, kept| kept.child.strong_count() > 0);
        if self.bakes.len() > MOST_BAKES {
            let mut present = Vec::new();
            visit(root, &mut |rule, child| present.push(key(rule, child)));
            self.bakes.retain(|key, _| present.contains(key));
        }
        let mut missing = Vec::new();
        visit(root, &mut |rule, child| missing.push((rule.clone(), child.clone())));
        for (rule, child) in missing {
            if self.find(&rule, &child).is_none() {
                let upright = Tree::compiled_in(&child, &rule.upright_from_child().inverse(), self.kept());
                let mut bake = baker.bake(&rule, &upright)?;
                let node = Node::new(Shape::SupportFree(rule.clone(), child.clone()));
                let with = |bake: &Bake| self.with(&rule, &child, bake.clone());
                if !rule.strokes.is_empty() {
                    let store = with(&Bake { cut_at_bed: false, ..bake.clone() });
                    let upright =
                        Tree::compiled_in(&node, &rule.upright_from_child().inverse(), store.kept());
                    bake = baker.brush(&rule, &upright, bake)?;
                }
                let baked = |bake: &Bake| with(bake).compile(&node);
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

    /// The same, but for this node, whose bake is another one.
    pub(crate) fn with(&self, rule: &SupportFree, child: &NodeRef, bake: Bake) -> Self {
        let mut store = self.clone();
        store.insert(rule, child, bake);
        store
    }

    fn insert(&mut self, rule: &SupportFree, child: &NodeRef, bake: Bake) {
        let kept =
            KeptBake { child: Arc::downgrade(child), _strokes: rule.strokes.clone(), bake: Arc::new(bake) };
        self.bakes.insert(key(rule, child), kept);
    }

    pub(crate) fn find(&self, rule: &SupportFree, child: &NodeRef) -> Option<&Arc<Bake>> {
        let kept = self.bakes.get(&key(rule, child))?;
        (kept.child.strong_count() > 0).then_some(&kept.bake)
    }

    /// These bakes and no caches.
    pub(crate) fn kept(&self) -> Kept<'_> {
        Kept { cache: &|_| None, bakes: self }
    }
}

fn key(rule: &SupportFree, child: &NodeRef) -> Key {
    let numbers = [rule.overhang_degrees, rule.layer_height, rule.bed].map(f32::to_bits);
    let strokes = rule.strokes.iter().map(|stroke| Arc::as_ptr(stroke) as usize).collect();
    (Arc::as_ptr(child) as usize, rule.mode, numbers, strokes)
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
