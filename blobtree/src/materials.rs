//! What the solid is made of where: what support-free nodes have grown is of another material than the shape.
//!
//! At each support-free node, what its child fills is the child's; the rest was added by the node. Where several parts
//! are put together, the one with the largest value is asked; what is cut keeps its material.

use crate::eval::Tree;
use crate::field::{Aabb, Field as _, ISO, Sampler};
use crate::node::{NodeRef, Shape};
use crate::operator::Operator;
use crate::support_free::{Bake, BakeStore, GROWN_MATERIAL, SupportFree};
use glam::Vec3;

/// The parts of a tree of other materials than 0, ready to be asked for places.
#[derive(Debug)]
pub struct Materials {
    top: Option<Branch>,
}

/// A node with something of another material than 0 in or below it.
#[derive(Debug)]
enum Branch {
    /// An operator that puts children together.
    Choice(Vec<(Tree, Option<Branch>)>),
    /// A support-free node that added something.
    Added(Box<Added>),
}

/// A support-free node in the root's space.
#[derive(Debug)]
struct Added {
    drawn: Tree,
    /// What its mode has made of that.
    grown: Tree,
    below: Option<Branch>,
}

impl Materials {
    /// Those of the tree below and including `root`, as it was baked.
    pub fn new(root: &NodeRef, bakes: &BakeStore) -> Self {
        Self { top: branch(root, &mut Vec::new(), bakes) }
    }

    /// Whether all of the solid is of material 0, so that nobody needs to ask.
    pub fn is_plain(&self) -> bool {
        self.top.is_none()
    }

    /// One thread's worker.
    pub fn finder(&self) -> MaterialFinder<'_> {
        MaterialFinder { top: self.top.as_ref().map(Finder::new) }
    }
}

fn branch(node: &NodeRef, warps: &mut Vec<NodeRef>, bakes: &BakeStore) -> Option<Branch> {
    if !node.is_heard() {
        return None;
    }
    match &node.shape {
        Shape::Primitive(_) => None,
        Shape::Warp(_, child) => {
            warps.push(node.clone());
            let below = branch(child, warps, bakes);
            warps.pop();
            below
        }
        Shape::SupportFree(rule, child) => {
            let below = branch(child, warps, bakes);
            match bakes.of(node).filter(|bake| bake.grown.is_some()) {
                Some(bake) => Some(added(rule, child, node, bake, below, warps, bakes)),
                None => below,
            }
        }
        Shape::Operator(operator, children) => match operator {
            Operator::Union | Operator::Blend(_) | Operator::GradientBlend | Operator::Sum => {
                let heard = children.iter().filter(|child| child.is_heard());
                let parts: Vec<_> = heard.map(|child| (child, branch(child, warps, bakes))).collect();
                let tree = |child: &NodeRef| bakes.compile(&child.under(warps));
                let any = parts.iter().any(|(_, below)| below.is_some());
                any.then(|| Branch::Choice(parts.into_iter().map(|(c, below)| (tree(c), below)).collect()))
            }
            Operator::Difference | Operator::BlendDifference(_) => branch(children.first()?, warps, bakes),
            Operator::Intersection | Operator::BlendIntersection(_) => {
                children.iter().find_map(|child| branch(child, warps, bakes))
            }
        },
    }
}

fn added(
    rule: &SupportFree,
    child: &NodeRef,
    node: &NodeRef,
    bake: &Bake,
    below: Option<Branch>,
    warps: &[NodeRef],
    bakes: &BakeStore,
) -> Branch {
    let Bake { grown, limit, .. } = bake.clone();
    let unbrushed = bakes.with(rule, child, Bake { grown, limit, ..Bake::default() });
    let drawn = bakes.compile(&child.under(warps));
    let grown = unbrushed.compile(&node.under(warps));
    Branch::Added(Box::new(Added { drawn, grown, below }))
}

/// Finds the materials of places, for one thread.
pub struct MaterialFinder<'a> {
    top: Option<Finder<'a>>,
}

enum Finder<'a> {
    Choice(Vec<(Probe<'a>, Option<Finder<'a>>)>),
    Added(Box<AddedFinder<'a>>),
}

struct AddedFinder<'a> {
    drawn: Probe<'a>,
    grown: Probe<'a>,
    below: Option<Finder<'a>>,
}

impl MaterialFinder<'_> {
    /// The material at each place of the solid; just outside it, that of what is nearest. Places should be near each
    /// other.
    pub fn materials(&mut self, places: &[Vec3]) -> Vec<u8> {
        find(&mut self.top, places)
    }
}

/// The materials at places below something; 0 where nothing is of another one.
fn find(finder: &mut Option<Finder>, places: &[Vec3]) -> Vec<u8> {
    match finder {
        _ if places.is_empty() => Vec::new(),
        None => vec![0; places.len()],
        Some(Finder::Choice(parts)) => choose(parts, places),
        Some(Finder::Added(node)) => node.find(places),
    }
}

fn choose(parts: &mut [(Probe, Option<Finder>)], places: &[Vec3]) -> Vec<u8> {
    let mut best = vec![(f32::NEG_INFINITY, 0); places.len()];
    for (number, (probe, _)) in parts.iter_mut().enumerate() {
        for (best, value) in best.iter_mut().zip(probe.values(places)) {
            if value > best.0 {
                *best = (value, number);
            }
        }
    }
    let mut materials = vec![0; places.len()];
    for (number, (_, below)) in parts.iter_mut().enumerate() {
        put(&mut materials, places, |i| best[i].1 == number, |own| find(below, own));
    }
    materials
}

/// Writes the materials of those places whose numbers are wanted.
fn put(
    materials: &mut [u8],
    places: &[Vec3],
    wanted: impl Fn(usize) -> bool,
    find: impl FnOnce(&[Vec3]) -> Vec<u8>,
) {
    let which: Vec<usize> = (0..places.len()).filter(|i| wanted(*i)).collect();
    let own: Vec<Vec3> = which.iter().map(|i| places[*i]).collect();
    which.into_iter().zip(find(&own)).for_each(|(i, material)| materials[i] = material);
}

impl AddedFinder<'_> {
    fn find(&mut self, places: &[Vec3]) -> Vec<u8> {
        let (drawn, grown) = (self.drawn.values(places), self.grown.values(places));
        let is_drawn = |i: usize| drawn[i] >= ISO || grown[i] <= drawn[i];
        let mut materials = vec![GROWN_MATERIAL; places.len()];
        put(&mut materials, places, is_drawn, |own| find(&mut self.below, own));
        materials
    }
}

impl<'a> Finder<'a> {
    fn new(branch: &'a Branch) -> Self {
        let optional = |below: &'a Option<Branch>| below.as_ref().map(Self::new);
        match branch {
            Branch::Choice(parts) => {
                Self::Choice(parts.iter().map(|(tree, below)| (Probe::new(tree), optional(below))).collect())
            }
            Branch::Added(node) => Self::Added(Box::new(AddedFinder {
                drawn: Probe::new(&node.drawn),
                grown: Probe::new(&node.grown),
                below: optional(&node.below),
            })),
        }
    }
}

/// A field to be asked for places near each other.
struct Probe<'a> {
    support: Aabb,
    sampler: Box<dyn Sampler + 'a>,
}

impl<'a> Probe<'a> {
    fn new(tree: &'a Tree) -> Self {
        Self { support: tree.support(), sampler: tree.sampler() }
    }

    fn values(&mut self, places: &[Vec3]) -> Vec<f32> {
        let mut values = vec![0.0; places.len()];
        let region = Aabb::of_points(places.iter().copied());
        if self.support.overlaps(&region) {
            if self.sampler.enter(region).hi > 0.0 {
                self.sampler.values(places, &mut values);
            }
            self.sampler.leave();
        }
        values
    }
}
