//! What the solid is made of where: what support-free nodes have grown, and what brush strokes have added, may be of
//! another material than the shape.
//!
//! The field of a support-free node goes through stages: its child, what its mode makes of that, what strokes make of
//! that. A place is of the first stage in which it is solid. Where several parts are put together, the one with the
//! largest value is asked; what is cut keeps its material.

use crate::eval::{Tree, warp_map};
use crate::field::{Aabb, Field as _, ISO, Sampler};
use crate::node::{NodeRef, Shape};
use crate::operator::Operator;
use crate::support_free::{Bake, BakeStore, GROWN_MATERIAL, SupportFree, VoxelMaterials};
use crate::warp_map::{AffineWarp, WarpMap};
use glam::{DAffine3, Vec3};
use std::sync::Arc;

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
    /// A support-free node that added something: its stages.
    Added(Vec<(Tree, Source)>),
}

/// Who made a stage of a support-free node, and so says what is new in it.
#[derive(Debug)]
enum Source {
    Child(Option<Box<Branch>>),
    Mode,
    Strokes(Option<Arc<VoxelMaterials>>, WayBack),
}

/// From the root's space to that in which a node was baked.
#[derive(Debug)]
struct WayBack(Vec<WarpMap>);

impl WayBack {
    fn new(warps: &[NodeRef], rule: &SupportFree) -> Self {
        let affine = |map: &DAffine3| WarpMap::Affine(AffineWarp::new(map));
        let back = |node: &NodeRef| match &node.shape {
            Shape::Warp(warp, _) => Some(match warp.parent_from_child() {
                Some(map) => {
                    let (matrix, offset) = (map.matrix3.as_dmat3(), map.translation.as_dvec3());
                    affine(&DAffine3::from_mat3_translation(matrix, offset).inverse())
                }
                None => warp_map(warp),
            }),
            _ => None,
        };
        let baked = affine(&rule.upright_from_child());
        Self(warps.iter().filter_map(back).chain([baked]).collect())
    }

    fn from(&self, place: Vec3) -> Vec3 {
        let back = |place, map: &WarpMap| map.child_from_parent::<f32>(place).place;
        self.0.iter().fold(place.to_array(), back).into()
    }
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
            match bakes.of(node).filter(|bake| bake.grown.is_some() || bake.brushed.materials.is_some()) {
                Some(bake) => Some(Branch::Added(stages(node, (rule, child), bake, below, warps, bakes))),
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

/// The stages of a support-free node that add something, from its child on.
fn stages(
    node: &NodeRef,
    (rule, child): (&SupportFree, &NodeRef),
    bake: &Bake,
    below: Option<Branch>,
    warps: &[NodeRef],
    bakes: &BakeStore,
) -> Vec<(Tree, Source)> {
    let Bake { grown, limit, brushed, .. } = bake.clone();
    let of_mode = Bake { grown, limit, ..Bake::default() };
    let of_strokes = Bake { brushed, ..of_mode.clone() };
    let stage = |bake: Bake| bakes.with(rule, child, bake).compile(&node.under(warps));
    let mut stages = vec![(bakes.compile(&child.under(warps)), Source::Child(below.map(Box::new)))];
    if of_mode.grown.is_some() {
        stages.push((stage(of_mode), Source::Mode));
    }
    if of_strokes.brushed.grown.is_some() {
        let materials = of_strokes.brushed.materials.clone();
        stages.push((stage(of_strokes), Source::Strokes(materials, WayBack::new(warps, rule))));
    }
    stages
}

/// Finds the materials of places, for one thread.
pub struct MaterialFinder<'a> {
    top: Option<Finder<'a>>,
}

enum Finder<'a> {
    Choice(Vec<(Probe<'a>, Option<Finder<'a>>)>),
    Added(Vec<(Probe<'a>, Teller<'a>)>),
}

/// A [`Source`], ready to be asked.
enum Teller<'a> {
    Child(Option<Box<Finder<'a>>>),
    Mode,
    Strokes(Option<&'a VoxelMaterials>, &'a WayBack),
}

impl MaterialFinder<'_> {
    /// The material at each place of the solid; just outside it, that of what is nearest. Places should be near each
    /// other.
    pub fn materials(&mut self, places: &[Vec3]) -> Vec<u8> {
        find(self.top.as_mut(), places)
    }
}

/// The materials at places below something; 0 where nothing is of another one.
fn find(finder: Option<&mut Finder>, places: &[Vec3]) -> Vec<u8> {
    match finder {
        _ if places.is_empty() => Vec::new(),
        None => vec![0; places.len()],
        Some(Finder::Choice(parts)) => {
            choose(parts, f32::INFINITY, places, |below, own| find(below.as_mut(), own))
        }
        Some(Finder::Added(stages)) => choose(stages, ISO, places, Teller::find),
    }
}

/// Asks for each place the one whose field is largest there, or else the first that is `enough`.
fn choose<T>(
    all: &mut [(Probe, T)],
    enough: f32,
    places: &[Vec3],
    find: impl Fn(&mut T, &[Vec3]) -> Vec<u8>,
) -> Vec<u8> {
    let mut best = vec![(f32::NEG_INFINITY, 0); places.len()];
    for (number, (probe, _)) in all.iter_mut().enumerate() {
        for (best, value) in best.iter_mut().zip(probe.values(places)) {
            if best.0 < enough && value > best.0 {
                *best = (value, number);
            }
        }
    }
    let mut materials = vec![0; places.len()];
    for (number, (_, teller)) in all.iter_mut().enumerate() {
        let which: Vec<usize> = (0..places.len()).filter(|i| best[*i].1 == number).collect();
        let own: Vec<Vec3> = which.iter().map(|i| places[*i]).collect();
        which.into_iter().zip(find(teller, &own)).for_each(|(i, material)| materials[i] = material);
    }
    materials
}

impl Teller<'_> {
    fn find(&mut self, places: &[Vec3]) -> Vec<u8> {
        match self {
            Self::Child(below) => find(below.as_deref_mut(), places),
            Self::Mode => vec![GROWN_MATERIAL; places.len()],
            Self::Strokes(None, _) => vec![0; places.len()],
            Self::Strokes(Some(materials), way) => {
                places.iter().map(|place| materials.at(way.from(*place))).collect()
            }
        }
    }
}

impl<'a> Finder<'a> {
    fn new(branch: &'a Branch) -> Self {
        let part =
            |(tree, below): &'a (Tree, Option<Branch>)| (Probe::new(tree), below.as_ref().map(Self::new));
        let stage = |(tree, source): &'a (Tree, Source)| {
            let teller = match source {
                Source::Child(below) => Teller::Child(below.as_deref().map(|b| Box::new(Self::new(b)))),
                Source::Mode => Teller::Mode,
                Source::Strokes(materials, way) => Teller::Strokes(materials.as_deref(), way),
            };
            (Probe::new(tree), teller)
        };
        match branch {
            Branch::Choice(parts) => Self::Choice(parts.iter().map(part).collect()),
            Branch::Added(stages) => Self::Added(stages.iter().map(stage).collect()),
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
