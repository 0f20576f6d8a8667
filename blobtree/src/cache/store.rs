//! Which nodes get caches, and how these survive edits.

use super::bricks::NodeCache;
use super::pages::Budget;
use crate::changes::changed_region;
use crate::eval::{Tree, support};
use crate::node::{Node, NodeRef, Shape};
use crate::operator::Operator;
use crate::primitive::Primitive;
use crate::support_free::{BakeStore, Kept};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Weak};

/// Most bricks of samples that the caches of a store keep at a time: some 350 MiB. Those beyond are made anew for
/// every question, which is slow but changes no answer.
const MOST_BRICKS: usize = 1 << 18;

/// Most cells along the longest side of a node's box.
const MOST_CELLS: usize = 256;

/// When a node deserves a cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachePolicy {
    /// Least number of primitives below it. A mesh counts for a thousand.
    pub least_cost: usize,
    /// Cells along the longest side of the node's box; the paper's choice is 128. From 1 to 256: what is outside
    /// counts as the nearest of these.
    pub cells: usize,
}

impl Default for CachePolicy {
    /// Caches that may pay in time: above 64 primitives.
    fn default() -> Self {
        Self { least_cost: 64, cells: 128 }
    }
}

/// The caches of a scene's nodes, kept from one version of the scene to the next.
#[derive(Debug)]
pub struct CacheStore {
    policy: CachePolicy,
    /// By address of the node; the weak reference keeps the address from being used again.
    caches: HashMap<usize, (Weak<Node>, Arc<NodeCache>)>,
    latest: Option<NodeRef>,
    budget: Arc<Budget>,
}

impl Default for CacheStore {
    fn default() -> Self {
        Self::new(CachePolicy::default())
    }
}

impl CacheStore {
    /// An empty store.
    pub fn new(policy: CachePolicy) -> Self {
        Self::with_room_for(policy, MOST_BRICKS)
    }

    fn with_room_for(policy: CachePolicy, bricks: usize) -> Self {
        let budget = Arc::new(Budget::new(bricks));
        Self { policy, caches: HashMap::new(), latest: None, budget }
    }

    /// Compiles `root` for evaluation through caches: those of nodes seen before, and new ones that inherit
    /// from the node at the same place of the version compiled last whatever the edit cannot reach.
    ///
    /// The field differs from the exact one by less than 0.01, and not at all near creases. Support-free nodes are
    /// their children as drawn.
    pub fn tree(&mut self, root: &NodeRef) -> Tree {
        self.tree_with(root, &BakeStore::default())
    }

    /// The same with bakes for the tree's support-free nodes, which themselves get no caches.
    pub fn tree_with(&mut self, root: &NodeRef, bakes: &BakeStore) -> Tree {
        self.caches.retain(|_, (node, _)| node.strong_count() > 0);
        let latest = self.latest.take();
        self.visit(root, latest.as_ref(), usize::MAX, true);
        self.latest = Some(root.clone());
        if self.budget.is_spent() {
            self.forget_other_versions(root);
        }
        let caches = &self.caches;
        let find = |node: &Node| {
            let (weak, cache) = caches.get(&(std::ptr::from_ref(node) as usize))?;
            (weak.strong_count() > 0).then(|| cache.clone())
        };
        Tree::compiled(root, Kept { cache: &find, bakes })
    }

    /// How often a primitive was evaluated at a point to fill the caches that are still known.
    pub fn evaluations(&self) -> u64 {
        self.caches.values().map(|(_, cache)| cache.exact.evaluations()).sum()
    }

    /// Drops the caches of nodes that are not in this version.
    fn forget_other_versions(&mut self, root: &NodeRef) {
        let mut present = HashSet::new();
        let mut rest = vec![root];
        while let Some(node) = rest.pop() {
            if present.insert(Arc::as_ptr(node) as usize) {
                rest.extend(node.children());
            }
        }
        self.caches.retain(|key, _| present.contains(key));
    }

    /// Gives caches to the parts below and including `node`. `above` is the cost of the nearest cached node
    /// above; `part` whether the node is a part of its own: named, the root, or an operand of CSG.
    ///
    /// Nodes of CSG have none: where they are smooth, a single operand decides, and its cache serves.
    fn visit(&mut self, node: &NodeRef, older: Option<&NodeRef>, above: usize, part: bool) {
        if !node.is_heard() {
            return;
        }
        let key = Arc::as_ptr(node) as usize;
        let cost = cost(node);
        if cost < self.policy.least_cost {
            return;
        }
        let is_part = part || node.name.is_some() || above == usize::MAX;
        let mut above = above;
        if self.caches.contains_key(&key) {
            above = cost;
        } else if !is_csg(node) && is_part && cost <= above / 4 && !node.holds_support_free() {
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
        let longest = support(node).size().max_element();
        let wanted = longest / self.policy.cells.clamp(1, MOST_CELLS) as f32;
        let known =
            older.and_then(|older| Some((older, &self.caches.get(&(Arc::as_ptr(older) as usize))?.1)));
        let fits = |spacing: f32| (0.5..=2.0).contains(&(spacing / wanted));
        let spacing = known.map(|(_, cache)| cache.spacing).filter(|s| fits(*s)).unwrap_or(wanted);
        let mut cache = NodeCache::new(Tree::new(node), spacing.max(1e-4), self.budget.clone());
        if let Some((older, older_cache)) = known {
            cache.inherit(older_cache, &changed_region(older, node));
        }
        cache
    }
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
        Shape::Primitive(Primitive::Mesh(_)) => 1000,
        Shape::Primitive(_) => 1,
        Shape::Operator(Operator::GradientBlend, children) => {
            8 * children.iter().map(|c| cost(c)).sum::<usize>()
        }
        Shape::Operator(_, children) => children.iter().map(|c| cost(c)).sum(),
        Shape::Warp(_, child) | Shape::SupportFree(_, child) => cost(child),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{Build, point, sum};
    use crate::field::Field;
    use fastrand::Rng;
    use glam::Vec3;

    #[test]
    fn a_full_store_answers_as_an_empty_one_in_any_order() {
        let mut rng = Rng::with_seed(1);
        let mut place = || Vec3::from_array(std::array::from_fn(|_| 30.0 * rng.f32()));
        let balls: Vec<Node> = (0..12).map(|_| point(place(), 5.0).with_falloff(4.0)).collect();
        let root: NodeRef = sum(balls).into();
        let points: Vec<Vec3> = (0..3000).map(|_| place()).collect();
        let policy = CachePolicy { least_cost: 2, cells: 32 };
        let values = |bricks: usize, backwards: bool| {
            let tree = CacheStore::with_room_for(policy, bricks).tree(&root);
            let mut order: Vec<usize> = (0..points.len()).collect();
            if backwards {
                order.reverse();
            }
            let mut sampler = tree.sampler();
            let mut values = vec![0.0; points.len()];
            order.into_iter().for_each(|i| sampler.values(&[points[i]], &mut values[i..=i]));
            values
        };
        let roomy = values(MOST_BRICKS, false);
        let exact = Tree::new(&root);
        assert!(points.iter().zip(&roomy).any(|(p, value)| exact.value(*p) != *value), "caches are read");
        for (bricks, backwards) in [(MOST_BRICKS, true), (0, false), (20, false), (20, true)] {
            assert!(values(bricks, backwards) == roomy, "room for {bricks} bricks, backwards: {backwards}");
        }
    }
}
