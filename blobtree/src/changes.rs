//! Where an edit can be felt.

use crate::eval::{support, warped_region};
use crate::field::Aabb;
use crate::node::{Node, NodeRef, Shape};
use crate::operator::Operator;
use std::sync::Arc;

/// A box outside which the fields of two versions of a node are equal, to the last bit, in its parent's
/// space. Shared nodes are recognised by identity, so the box is small after an edit and empty without one.
///
/// Cost: that of the nodes on the paths that differ, and of the supports of what was replaced.
pub fn changed_region(old: &NodeRef, new: &NodeRef) -> Aabb {
    if Arc::ptr_eq(old, new) {
        return Aabb::EMPTY;
    }
    let either = support(old).union(&support(new));
    if old.is_heard() != new.is_heard() {
        return either;
    }
    let changed = match (&old.shape, &new.shape) {
        (Shape::Warp(a, old), Shape::Warp(b, new)) if a == b => warped_region(a, &changed_region(old, new)),
        (Shape::Operator(a, old), Shape::Operator(b, new)) if a == b => {
            changed_operands(*a, old, new).unwrap_or(either)
        }
        (Shape::Primitive(a), Shape::Primitive(b)) if a == b => Aabb::EMPTY,
        (Shape::SupportFree(a, old), Shape::SupportFree(b, new)) if a == b && Arc::ptr_eq(old, new) => {
            Aabb::EMPTY
        }
        _ => either,
    };
    let felt = changed.intersection(&either);
    felt.grown(1e-5 * felt.min.abs().max(felt.max.abs()).max_element())
}

/// The same for an operator's children; `None` if all that it makes may have changed.
fn changed_operands(operator: Operator, old: &[NodeRef], new: &[NodeRef]) -> Option<Aabb> {
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
        return Some(
            old.iter().zip(new).fold(Aabb::EMPTY, |b, (old, new)| b.union(&changed_region(old, new))),
        );
    }
    let of = |nodes: &[NodeRef]| nodes.iter().fold(Aabb::EMPTY, |b, n: &Arc<Node>| b.union(&support(n)));
    Some(of(old).union(&of(new)))
}
