//! Which part made the surface where: for drawing the seams between parts.
//!
//! At each operator, the part that counts most there owns the place: in a union or a blend the one with the largest
//! value, in an intersection the one with the smallest, in a cut the tool where it is nearer to its own surface than
//! the rest is to its. Between two parts that blend, these are the places where their shares are equal.

use crate::eval::Tree;
use crate::field::{Aabb, Field as _, Sampler};
use crate::node::{NodePath, NodeRef, Shape};
use crate::operator::Operator;
use crate::support_free::BakeStore;

/// The parts of a tree, ready to be asked which of them owns a place.
#[derive(Debug)]
pub struct Owners {
    parts: Vec<NodePath>,
    top: Option<Branch>,
}

/// A node as far as it matters here.
#[derive(Debug)]
enum Branch {
    /// A primitive, by its place among the parts.
    Part(u32),
    /// An operator with several children that are heard.
    Choice(Operator, Vec<Candidate>),
}

/// A child of an operator, in the root's space.
#[derive(Debug)]
struct Candidate {
    /// Whether it is the first child, from which others are cut.
    is_first: bool,
    tree: Tree,
    below: Branch,
}

impl Owners {
    /// Those of the tree below and including `root`. Support-free nodes are their children.
    pub fn new(root: &NodeRef, bakes: &BakeStore) -> Self {
        let mut parts = Vec::new();
        let top = branch(root, NodePath::default(), &mut Vec::new(), bakes, &mut parts);
        Self { parts, top }
    }

    /// The primitives that are heard, in the order of the tree.
    pub fn parts(&self) -> &[NodePath] {
        &self.parts
    }

    /// One thread's worker.
    pub fn finder(&self) -> OwnerFinder<'_> {
        OwnerFinder { top: self.top.as_ref().map(Finder::new) }
    }
}

fn branch(
    node: &NodeRef,
    path: NodePath,
    warps: &mut Vec<NodeRef>,
    bakes: &BakeStore,
    parts: &mut Vec<NodePath>,
) -> Option<Branch> {
    if !node.is_heard() {
        return None;
    }
    match &node.shape {
        Shape::Primitive(_) => {
            parts.push(path);
            Some(Branch::Part(parts.len() as u32 - 1))
        }
        Shape::Warp(_, child) => {
            warps.push(node.clone());
            let below = branch(child, path.child(0), warps, bakes, parts);
            warps.pop();
            below
        }
        Shape::SupportFree(_, child) => branch(child, path.child(0), warps, bakes, parts),
        Shape::Operator(operator, children) => {
            let mut candidates = Vec::new();
            for (i, child) in children.iter().enumerate() {
                if let Some(below) = branch(child, path.child(i), warps, bakes, parts) {
                    let tree = bakes.compile(&child.under(warps));
                    candidates.push(Candidate { is_first: i == 0, tree, below });
                }
            }
            match candidates.len() {
                0 | 1 => candidates.pop().map(|only| only.below),
                _ => Some(Branch::Choice(*operator, candidates)),
            }
        }
    }
}

/// How much a child with this value counts in an operator.
fn counts(operator: Operator, is_first: bool, value: f32) -> f32 {
    match operator {
        Operator::Union | Operator::Blend(_) | Operator::GradientBlend | Operator::Sum => value,
        Operator::Intersection | Operator::BlendIntersection(_) => 1.0 - value,
        Operator::Difference | Operator::BlendDifference(_) if is_first => 1.0 - value,
        Operator::Difference | Operator::BlendDifference(_) => value,
    }
}

/// Finds the owners of places, for one thread.
pub struct OwnerFinder<'a> {
    top: Option<Finder<'a>>,
}

enum Finder<'a> {
    Part(u32),
    Choice(Operator, Vec<Candidates<'a>>),
}

struct Candidates<'a> {
    is_first: bool,
    support: Aabb,
    sampler: Box<dyn Sampler + 'a>,
    below: Finder<'a>,
}

impl OwnerFinder<'_> {
    /// For each place on the surface the part that owns it, by its place among [`Owners::parts`]; all 0 without any
    /// part. Places should be near each other.
    pub fn owners(&mut self, places: &[glam::Vec3]) -> Vec<u32> {
        let mut owners = vec![0; places.len()];
        if let Some(top) = &mut self.top {
            let all: Vec<usize> = (0..places.len()).collect();
            top.find(places, all, &mut owners);
        }
        owners
    }
}

impl<'a> Finder<'a> {
    fn new(branch: &'a Branch) -> Self {
        match branch {
            Branch::Part(part) => Self::Part(*part),
            Branch::Choice(operator, candidates) => {
                let candidate = |candidate: &'a Candidate| Candidates {
                    is_first: candidate.is_first,
                    support: candidate.tree.support(),
                    sampler: candidate.tree.sampler(),
                    below: Self::new(&candidate.below),
                };
                Self::Choice(*operator, candidates.iter().map(candidate).collect())
            }
        }
    }

    /// Writes the owners of those places whose numbers are in `which`.
    fn find(&mut self, places: &[glam::Vec3], which: Vec<usize>, owners: &mut [u32]) {
        let (operator, candidates) = match self {
            Self::Part(part) => {
                which.into_iter().for_each(|i| owners[i] = *part);
                return;
            }
            Self::Choice(operator, candidates) => (*operator, candidates),
        };
        let own: Vec<glam::Vec3> = which.iter().map(|&i| places[i]).collect();
        let region = Aabb::of_points(own.iter().copied());
        let mut best = vec![(f32::NEG_INFINITY, 0); own.len()];
        let mut values = vec![0.0; own.len()];
        for (number, candidate) in candidates.iter_mut().enumerate() {
            values.fill(0.0);
            if candidate.support.overlaps(&region) {
                if candidate.sampler.enter(region).hi > 0.0 {
                    candidate.sampler.values(&own, &mut values);
                }
                candidate.sampler.leave();
            }
            for (best, &value) in best.iter_mut().zip(&values) {
                let counts = counts(operator, candidate.is_first, value);
                if counts > best.0 {
                    *best = (counts, number);
                }
            }
        }
        for (number, candidate) in candidates.iter_mut().enumerate() {
            let won = which.iter().zip(&best).filter(|(_, best)| best.1 == number);
            let won: Vec<usize> = won.map(|(&i, _)| i).collect();
            if !won.is_empty() {
                candidate.below.find(places, won, owners);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::*;
    use crate::explain::explain;
    use crate::field::ISO;
    use crate::node::Node;
    use crate::random::RandomTree;
    use glam::Vec3;

    fn owner(root: &NodeRef, place: [f32; 3]) -> String {
        let owners = Owners::new(root, &BakeStore::new());
        let found = owners.finder().owners(&[Vec3::from(place)])[0];
        owners.parts()[found as usize].to_string()
    }

    #[test]
    fn the_wall_of_a_hole_belongs_to_what_was_cut_away_and_the_rest_to_the_rest() {
        let hole = cylinder([0.0, 0.0, -20.0], [0.0, 0.0, 20.0], 3.0).translate([1., 0., 0.]);
        let ball = || point([0.0; 3], 10.0);
        let root: NodeRef = ball().union(point([15.0, 0.0, 0.0], 7.0)).subtract(hole).into();
        assert_eq!(owner(&root, [4.0, 0.0, 0.0]), "/1/0");
        assert_eq!(owner(&root, [-10.0, 0.0, 0.0]), "/0/0");
        assert_eq!(owner(&root, [22.0, 0.0, 0.0]), "/0/1");
        let muted: NodeRef = union([ball().muted(), ball()]).into();
        assert_eq!(owner(&muted, [10.0, 0.0, 0.0]), "/1");
    }

    #[test]
    fn who_owns_a_place_of_the_surface_has_no_smaller_share_than_others_of_its_operator() {
        let mut compared = 0;
        for seed in 0..150 {
            let mut random = RandomTree::new(seed);
            random.depth = 3;
            let root: NodeRef = union([random.leaf(), random.leaf(), random.leaf()]).into();
            let blended = Operator::Blend(crate::operator::Sharpness::DEFAULT);
            let operators = [Operator::Union, blended, Operator::Sum, Operator::Intersection];
            for operator in operators {
                let root: NodeRef = Node::new(Shape::Operator(operator, root.children().to_vec())).into();
                let owners = Owners::new(&root, &BakeStore::new());
                let place = random.place();
                if (Tree::new(&root).sample(place).value - ISO).abs() > 0.4 {
                    continue;
                }
                let found = owners.finder().owners(&[place])[0];
                let path = &owners.parts()[found as usize];
                let shares = explain(&root, place);
                let share = |child: usize| {
                    let path = NodePath(vec![child]);
                    shares.iter().find(|part| part.path == path).map_or(0.0, |part| part.share)
                };
                let most = (0..3).map(share).fold(0.0, f32::max);
                assert!(share(path.0[0]) >= most - 1e-4, "seed {seed} {operator:?}: {path}");
                compared += 1;
            }
        }
        assert!(compared > 50, "{compared}");
    }
}
