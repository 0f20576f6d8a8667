//! Which nodes get caches, and how these survive edits.

use super::bricks::NodeCache;
use crate::changes::changed_region;
use crate::eval::{Tree, support};
use crate::node::{Node, NodeRef, Shape};
use crate::operator::Operator;
use std::collections::HashMap;
use std::sync::{Arc, Weak};

/// When a node deserves a cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachePolicy {
    /// Least number of primitives below it. Reading a cache costs about as much as this many point
    /// primitives in a brick; a mesh counts for a thousand.
    pub least_cost: usize,
    /// Cells along the longest side of the node's box; the paper's choice is 128.
    pub cells: usize,
}

impl Default for CachePolicy {
    /// Caches that pay in time: above 64 primitives.
    fn default() -> Self {
        Self { least_cost: 64, cells: 128 }
    }
}

/// The caches of a scene's nodes, kept from one version of the scene to the next.
#[derive(Debug, Default)]
pub struct CacheStore {
    policy: CachePolicy,
    /// By address of the node; the weak reference keeps the address from being used again.
    caches: HashMap<usize, (Weak<Node>, Arc<NodeCache>)>,
    latest: Option<NodeRef>,
}

impl CacheStore {
    /// An empty store.
    pub fn new(policy: CachePolicy) -> Self {
        Self { policy, ..Self::default() }
    }

    /// Compiles `root` for evaluation through caches: those of nodes seen before, and new ones that inherit
    /// from the node at the same place of the version compiled last whatever the edit cannot reach.
    ///
    /// The field differs from the exact one by less than 0.01, and not at all near creases.
    pub fn tree(&mut self, root: &NodeRef) -> Tree {
        self.caches.retain(|_, (node, _)| node.strong_count() > 0);
        let latest = self.latest.take();
        self.visit(root, latest.as_ref(), usize::MAX, true);
        self.latest = Some(root.clone());
        let caches = &self.caches;
        let find = |node: &Node| {
            let (weak, cache) = caches.get(&(std::ptr::from_ref(node) as usize))?;
            (weak.strong_count() > 0).then(|| cache.clone())
        };
        Tree::compiled(root, &find)
    }

    /// How often a primitive was evaluated at a point to fill the caches that are still known.
    pub fn evaluations(&self) -> u64 {
        self.caches.values().map(|(_, cache)| cache.exact.evaluations()).sum()
    }

    /// Gives caches to the parts below and including `node`. `above` is the cost of the nearest cached node
    /// above; `part` whether the node is a part of its own: named, the root's, or an operand of CSG.
    fn visit(&mut self, node: &NodeRef, older: Option<&NodeRef>, above: usize, part: bool) {
        if !node.is_heard() {
            return;
        }
        let key = Arc::as_ptr(node) as usize;
        let cost = cost(node);
        let mut above = above;
        let deserves = cost >= self.policy.least_cost
            && !matches!(node.shape, Shape::Primitive(_))
            && (part || node.name.is_some())
            && above / 4 >= cost.min(above);
        if self.caches.contains_key(&key) {
            above = cost;
        } else if deserves || above == usize::MAX && cost >= self.policy.least_cost && !is_csg(node) {
            let cache = self.fresh(node, older);
            self.caches.insert(key, (Arc::downgrade(node), Arc::new(cache)));
            above = cost;
        }
        // Below a gradient blend even directions must be exact.
        if matches!(node.shape, Shape::Operator(Operator::GradientBlend, _)) {
            return;
        }
        let part = is_csg(node);
        for (i, child) in node.children().iter().enumerate() {
            let older = older.and_then(|older| older.children().get(i));
            self.visit(child, older, above, part);
        }
    }

    fn fresh(&self, node: &NodeRef, older: Option<&NodeRef>) -> NodeCache {
        let longest = support_in_own_space(node).size().max_element();
        let wanted = longest / self.policy.cells as f32;
        let known =
            older.and_then(|older| Some((older, &self.caches.get(&(Arc::as_ptr(older) as usize))?.1)));
        let fits = |spacing: f32| (0.5..=2.0).contains(&(spacing / wanted));
        let spacing = known.map(|(_, cache)| cache.spacing).filter(|s| fits(*s)).unwrap_or(wanted);
        let mut cache = NodeCache::new(Tree::new(node), spacing.max(1e-4));
        if let Some((older, older_cache)) = known {
            cache.inherit(older_cache, &changed_region(older, node));
        }
        cache
    }
}

/// A node's support as seen by its parent, whose space is also that of the node's cache.
fn support_in_own_space(node: &Node) -> crate::field::Aabb {
    support(node)
}

/// Whether the node's children are parts that are put together or cut.
fn is_csg(node: &Node) -> bool {
    use Operator::{Difference, Intersection, Union};
    matches!(node.shape, Shape::Operator(Union | Intersection | Difference, _))
}

/// What evaluating a node costs, in point primitives.
fn cost(node: &Node) -> usize {
    match &node.shape {
        _ if !node.is_heard() => 0,
        Shape::Primitive(crate::primitive::Primitive::Mesh(_)) => 1000,
        Shape::Primitive(_) => 1,
        Shape::Operator(Operator::GradientBlend, children) => {
            8 * children.iter().map(|c| cost(c)).sum::<usize>()
        }
        Shape::Operator(_, children) => children.iter().map(|c| cost(c)).sum(),
        Shape::Warp(_, child) => cost(child),
    }
}
