//! Why the field has the value it has: every node's part in it.

use crate::combine::gradient_blend_weights;
use crate::eval::{Tree, warp_map};
use crate::field::{Field, Sample};
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::operator::Operator;
use crate::scalar::Slope;
use crate::support_free::BakeStore;
use crate::warp::Warp;
use glam::{Mat3, Vec3};

/// What a node contributes at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Where the node stands.
    pub path: NodePath,
    /// The node's own value there, and its gradient in the root's space.
    pub sample: Sample,
    /// The node's share in the root's value, 0 to 1: through unions, cuts and intersections all goes to the
    /// operand that decides, through blends to each by its weight. The shares of a node's children add up to
    /// its own, unless all are 0.
    pub share: f32,
    /// Whether the node is heard; one that is not has value and share 0.
    pub heard: bool,
}

/// Every node of the tree with its value, gradient and share at `p`, parents before children. Support-free nodes
/// are their children as drawn.
///
/// Cost: O(nodes · depth). For teaching and picking, not for loops.
pub fn explain(root: &NodeRef, p: Vec3) -> Vec<Part> {
    explained(root, p, &BakeStore::default())
}

/// The same with support-free nodes as they are in `tree`, which is `root` compiled. Where such a node was cut or
/// grown, it decides, and its child has no share.
pub fn explain_in(tree: &Tree, root: &NodeRef, p: Vec3) -> Vec<Part> {
    explained(root, p, &tree.bakes)
}

fn explained(root: &NodeRef, p: Vec3, bakes: &BakeStore) -> Vec<Part> {
    let mut parts = Vec::new();
    let sample = sample(root, p, bakes);
    let view = View { path: NodePath::default(), p, root_from_here: Mat3::IDENTITY, share: 1.0, bakes };
    visit(root, sample, view, &mut parts);
    parts
}

/// How a node is looked at.
struct View<'a> {
    path: NodePath,
    /// The place in the space of the node's parent.
    p: Vec3,
    /// From gradients in that space to gradients in the root's.
    root_from_here: Mat3,
    share: f32,
    bakes: &'a BakeStore,
}

fn sample(node: &Node, p: Vec3, bakes: &BakeStore) -> Sample {
    bakes.compile(node).sample(p)
}

fn visit(node: &NodeRef, sample: Sample, view: View, parts: &mut Vec<Part>) {
    let gradient = view.root_from_here * sample.gradient;
    let share = if node.is_heard() { view.share } else { 0.0 };
    parts.push(Part {
        path: view.path.clone(),
        sample: Sample { gradient, ..sample },
        share,
        heard: node.is_heard(),
    });
    match &node.shape {
        Shape::Primitive(_) => {}
        Shape::Warp(warp, child) => {
            let (p, root_from_child) = unwarped(warp, view.p);
            let view = View {
                path: view.path.child(0),
                p,
                root_from_here: view.root_from_here * root_from_child,
                share,
                bakes: view.bakes,
            };
            visit(child, self::sample(child, p, view.bakes), view, parts);
        }
        Shape::SupportFree(_, child) => {
            let below = self::sample(child, view.p, view.bakes);
            let share = if below.value == sample.value { share } else { 0.0 };
            visit(child, below, View { path: view.path.child(0), share, ..view }, parts);
        }
        Shape::Operator(operator, children) => {
            let samples: Vec<Sample> =
                children.iter().map(|child| self::sample(child, view.p, view.bakes)).collect();
            let heard: Vec<bool> = children.iter().map(|child| child.is_heard()).collect();
            let shares = shares(*operator, &samples, &heard);
            for (i, child) in children.iter().enumerate() {
                let view = View { path: view.path.child(i), share: share * shares[i], ..view };
                visit(child, samples[i], view, parts);
            }
        }
    }
}

/// The place in the child's space from which a warp takes `p`, and the map of gradients back.
fn unwarped(warp: &Warp, p: Vec3) -> (Vec3, Mat3) {
    match warp.parent_from_child() {
        Some(parent_from_child) => {
            let inverse = parent_from_child.inverse();
            (inverse.transform_point3(p), Mat3::from(inverse.matrix3).transpose())
        }
        None => {
            let warped = warp_map(warp).child_from_parent(p.to_array());
            // Rows of derivatives are the columns of their transpose.
            (Vec3::from_array(warped.place), Mat3::from_cols_array_2d(&warped.rows))
        }
    }
}

/// Each operand's share in an operator's value, adding up to 1 or all 0.
fn shares(operator: Operator, samples: &[Sample], heard: &[bool]) -> Vec<f32> {
    let values: Vec<f32> = samples.iter().map(|s| s.value).collect();
    let power = |x: f32, s: f32| x.max(0.0).powf(s);
    let weights: Vec<f32> = match operator {
        Operator::Union => decided_by(best(&values, heard, |a, b| a > b && a > 0.0), values.len()),
        Operator::Intersection => decided_by(best(&values, heard, |a, b| a < b), values.len()),
        Operator::Difference => {
            let cuts: Vec<bool> = heard.iter().enumerate().map(|(i, heard)| *heard && i > 0).collect();
            // What is cut off does not reach where it is 0, though the difference is never above 1.
            let cut = best(&values, &cuts, |a, b| a > b);
            let cut = cut.filter(|i| values[*i] > 0.0 && 1.0 - values[*i] < values[0]);
            decided_by(cut.or((!values.is_empty()).then_some(0)), values.len())
        }
        Operator::Blend(s) => values.iter().map(|f| power(*f, s.get())).collect(),
        Operator::Sum => values,
        Operator::BlendIntersection(s) => {
            let outside: Vec<f32> = values.iter().map(|f| 1.0 - f).collect();
            let all_inside = outside.iter().zip(heard).all(|(u, heard)| *u <= 0.0 || !heard);
            if all_inside {
                decided_by(best(&outside, heard, |a, b| a > b), values.len())
            } else {
                outside.iter().map(|u| power(*u, s.get())).collect()
            }
        }
        Operator::BlendDifference(s) => {
            let outside = |i: usize, f: f32| if i == 0 { 1.0 - f } else { f };
            let cut = values.iter().skip(1).any(|g| *g > 0.0);
            match cut {
                true => values.iter().enumerate().map(|(i, f)| power(outside(i, *f), s.get())).collect(),
                false => decided_by((!values.is_empty()).then_some(0), values.len()),
            }
        }
        Operator::GradientBlend => gradient_blend_shares(samples, heard),
    };
    let weights: Vec<f32> =
        weights.iter().zip(heard).map(|(w, heard)| if *heard { *w } else { 0.0 }).collect();
    let total: f32 = weights.iter().sum();
    weights.iter().map(|w| if total > 0.0 { w / total } else { 0.0 }).collect()
}

/// The first heard operand that no other one beats.
fn best(values: &[f32], heard: &[bool], beats: impl Fn(f32, f32) -> bool) -> Option<usize> {
    let candidates = (0..values.len()).filter(|i| heard[*i]);
    candidates.reduce(|best, i| if beats(values[i], values[best]) { i } else { best })
}

fn decided_by(winner: Option<usize>, operands: usize) -> Vec<f32> {
    (0..operands).map(|i| if Some(i) == winner { 1.0 } else { 0.0 }).collect()
}

fn gradient_blend_shares(samples: &[Sample], heard: &[bool]) -> Vec<f32> {
    let mut shares = vec![0.0; samples.len()];
    let mut joined: Option<Slope<f32>> = None;
    for (i, sample) in samples.iter().enumerate().filter(|(i, _)| heard[*i]) {
        let next = Slope::new(sample.value, sample.gradient.to_array());
        let Some(before) = joined else {
            shares[i] = next.value;
            joined = Some(next);
            continue;
        };
        let plain = if next.value > before.value { (0.0, 1.0) } else { (1.0, 0.0) };
        let (keep, add) = gradient_blend_weights(before, next).unwrap_or(plain);
        shares.iter_mut().for_each(|share| *share *= keep);
        shares[i] = next.value * add;
        joined = Some(crate::combine::gradient_blend(before, next));
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::RandomTree;

    #[test]
    fn every_node_has_the_value_it_has_alone_and_shares_add_up() {
        for seed in 0..200 {
            let mut random = RandomTree::new(seed);
            random.depth = 5;
            let root = random.tree();
            let p = random.place();
            let parts = explain(&root, p);
            assert_eq!(parts[0].sample, Tree::new(&root).sample(p), "seed {seed}");
            for part in &parts {
                let below = parts.iter().filter(|child| child.path.parent().as_ref() == Some(&part.path));
                let (count, total) = below.fold((0, 0.0), |(n, sum), child| (n + 1, sum + child.share));
                let none_below = count == 0 || total == 0.0;
                assert!(
                    none_below || (total - part.share).abs() < 1e-4,
                    "seed {seed} {}: {total}",
                    part.path
                );
            }
        }
    }
}
