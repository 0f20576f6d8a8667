//! Where an edit can be felt.

use crate::eval::{Tree, support, warped_region};
use crate::field::{Aabb, Dirty, Field, Interval, Sampler};
use crate::node::{Node, NodeRef, Shape};
use crate::operator::Operator;
use std::sync::Arc;

/// What was changed is looked at more closely than its box if it has at most as many primitives; with more, asking
/// costs more than it saves.
const FEW: usize = 16;

/// A box outside which the fields of two versions of a node are equal, to the last bit, in its parent's
/// space. Shared nodes are recognised by identity, so the box is small after an edit and empty without one.
///
/// Cost: that of the nodes on the paths that differ, and of the supports of what was replaced.
pub fn changed_region(old: &NodeRef, new: &NodeRef) -> Aabb {
    bounds_of(&parts(old, new))
}

/// Where an edit can be felt, more closely than by [`changed_region`]: in that box, but not in those of its corners
/// that nothing which was changed reaches. A region that only meets the box around a ball is not touched.
pub struct ChangedPlaces {
    bounds: Aabb,
    /// What was changed, alone; `None` where only the box is known.
    parts: Option<Vec<Tree>>,
}

impl ChangedPlaces {
    /// The places where the fields of two versions of a root differ. Not for trees with caches, which carry a change
    /// on by the distance of their samples.
    ///
    /// Cost: as [`changed_region`], and that of compiling what was changed.
    pub fn between(old: &NodeRef, new: &NodeRef) -> Self {
        let parts = parts(old, new);
        // What is baked also reaches where its drawing does not.
        let is_drawn = parts.iter().all(|part| !part.node.holds_support_free());
        let trees = is_drawn.then(|| parts.iter().map(|part| Tree::new(&part.node)).collect::<Vec<_>>());
        let few = |trees: &Vec<Tree>| trees.iter().map(Tree::primitives).sum::<usize>() <= FEW;
        Self { bounds: bounds_of(&parts), parts: trees.filter(few) }
    }
}

impl Dirty for ChangedPlaces {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn touch(&self) -> Box<dyn FnMut(&Aabb) -> bool + '_> {
        let Some(parts) = &self.parts else { return self.bounds.touch() };
        let mut samplers: Vec<_> = parts.iter().map(Field::sampler).collect();
        Box::new(move |region| {
            self.bounds.overlaps(region) && samplers.iter_mut().any(|part| reaches(&mut **part, region))
        })
    }
}

fn reaches(part: &mut dyn Sampler, region: &Aabb) -> bool {
    let bounds = part.enter(*region);
    part.leave();
    bounds != Interval::ZERO
}

/// One of the nodes by which two versions of a tree differ: where the fields of all of them are 0, the versions are
/// equal.
struct Part {
    /// Under the warps above it, so that it is in the space of the tree's parent.
    node: NodeRef,
    /// Where it can be felt.
    bounds: Aabb,
}

fn bounds_of(parts: &[Part]) -> Aabb {
    parts.iter().fold(Aabb::EMPTY, |all, part| all.union(&part.bounds))
}

fn whole<'a>(nodes: impl IntoIterator<Item = &'a NodeRef>) -> Vec<Part> {
    let heard = nodes.into_iter().filter(|node| node.is_heard());
    heard.map(|node| Part { node: node.clone(), bounds: support(node) }).collect()
}

fn parts(old: &NodeRef, new: &NodeRef) -> Vec<Part> {
    if Arc::ptr_eq(old, new) || !(old.is_heard() || new.is_heard()) {
        return Vec::new();
    }
    if old.is_heard() != new.is_heard() {
        return whole([old, new]);
    }
    let mut parts = match (&old.shape, &new.shape) {
        (Shape::Warp(a, old), Shape::Warp(b, new)) if a == b => {
            let warped = |part: Part| Part {
                node: Node::new(Shape::Warp(a.clone(), part.node)).into(),
                bounds: warped_region(a, &part.bounds),
            };
            parts(old, new).into_iter().map(warped).collect()
        }
        (Shape::Operator(a, old_operands), Shape::Operator(b, new_operands)) if a == b => {
            operands(*a, old_operands, new_operands).unwrap_or_else(|| whole([old, new]))
        }
        (Shape::Primitive(a), Shape::Primitive(b)) if a == b => Vec::new(),
        (Shape::SupportFree(a, old), Shape::SupportFree(b, new)) if a == b && Arc::ptr_eq(old, new) => {
            Vec::new()
        }
        _ => whole([old, new]),
    };
    let either = support(old).union(&support(new));
    for part in &mut parts {
        let felt = part.bounds.intersection(&either);
        part.bounds = felt.grown(1e-5 * felt.min.abs().max(felt.max.abs()).max_element());
    }
    parts
}

/// The parts among an operator's children; `None` if all that it makes may have changed.
fn operands(operator: Operator, old: &[NodeRef], new: &[NodeRef]) -> Option<Vec<Part>> {
    use Operator::{BlendDifference, BlendIntersection, Difference, Intersection};
    let same_ends = |a: &NodeRef, b: &NodeRef| Arc::ptr_eq(a, b);
    let head = old.iter().zip(new).take_while(|(a, b)| same_ends(a, b)).count();
    let (old, new) = (&old[head..], &new[head..]);
    let tail = old.iter().rev().zip(new.iter().rev()).take_while(|(a, b)| same_ends(a, b)).count();
    let (old, new) = (&old[..old.len() - tail], &new[..new.len() - tail]);
    let heard = |nodes: &[NodeRef]| nodes.iter().map(|node: &NodeRef| node.is_heard()).collect::<Vec<_>>();
    let in_place = old.len() == new.len() && heard(old) == heard(new);
    let everything = match operator {
        // An operand that comes or goes is felt where it is 0, too.
        Intersection | BlendIntersection(_) => !in_place,
        Difference | BlendDifference(_) => head == 0 && !in_place,
        _ => false,
    };
    if everything {
        return None;
    }
    if in_place {
        return Some(old.iter().zip(new).flat_map(|(old, new)| parts(old, new)).collect());
    }
    Some(whole(old.iter().chain(new)))
}
