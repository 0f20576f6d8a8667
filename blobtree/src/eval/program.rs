//! Trees compiled to flat programs.

use crate::cache::CacheSite;
use crate::field::{Aabb, Field, Sampler};
use crate::leaf::{self, Frame, Leaf, Voxels, even_scale};
use crate::node::{Node, NodeRef, Shape};
use crate::operator::Operator;
use crate::primitive::{HalfSpace, Primitive};
use crate::support_free::{Bake, BakeStore, GROWN_FALLOFF, Kept, SupportFree, SupportMode, VoxelImage};
use crate::warp::Warp;
use crate::warp_map::{AffineWarp, BendMap, TaperMap, TwistMap, WarpMap};
use glam::{DAffine3, Mat3, Vec3};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::sampler::TreeSampler;

/// The box of everything: where a limit that is not in the way is not 0.
const EVERYWHERE: Aabb = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };

/// How far the space above a print bed reaches, mm.
const ABOVE_BED: f32 = 1e6;

/// One operation; its operands follow each other in an arena of the same type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instr {
    pub op: Op,
    pub first: u32,
    pub count: u32,
}

/// What an [`Instr`] does with its operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    /// 0 everywhere.
    Empty,
    /// The leaf of this number.
    Leaf(u32),
    Union,
    Intersection,
    /// The first without the others.
    Difference,
    /// With Ricci's exponent; so the two below.
    Blend(f32),
    BlendIntersection(f32),
    BlendDifference(f32),
    /// Point primitives come first.
    Sum,
    /// In the frame of this number.
    GradientBlend(u32),
    /// The warp of this number.
    Warp(u32),
    /// The cache of this number, before its exact operand, which may be creased in the region at hand.
    Cache {
        number: u32,
        creased: bool,
    },
}

impl Instr {
    pub const EMPTY: Self = Self { op: Op::Empty, first: 0, count: 0 };

    /// Where the operands stand.
    pub fn operands(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// A node compiled for evaluation: the [`Field`] of everything below it that is neither muted nor
/// construction.
///
/// Affine warps are folded into the leaves. A support-free node is what its bake makes of it; without one, it is
/// its child as drawn: see [`Self::unconstrained`]. Cost of making one: O(nodes).
#[derive(Debug)]
pub struct Tree {
    pub(crate) leaves: Vec<Leaf>,
    /// Boxes in the space where each is evaluated, outside which it is 0.
    pub(crate) leaf_supports: Vec<Aabb>,
    pub(crate) warps: Vec<WarpMap>,
    /// The same for what lies below each warp.
    pub(crate) warp_supports: Vec<Aabb>,
    /// From gradients in the space of evaluation to those in a gradient blend's own; `None` if it is at most
    /// turned and scaled evenly, which angles do not notice.
    pub(crate) frames: Vec<Option<Mat3>>,
    pub(crate) caches: Vec<CacheSite>,
    pub(crate) arena: Vec<Instr>,
    pub(crate) root: Instr,
    support: Aabb,
    /// The bakes that take part.
    pub(crate) bakes: BakeStore,
    unconstrained: usize,
    /// Evaluations of a primitive at a point so far, by samplers that are gone.
    pub(crate) evaluations: AtomicU64,
}

impl Tree {
    /// Compiles the tree below and including `node`, which must have passed the checks of its parameters.
    ///
    /// Support-free nodes are their children as drawn; [`BakeStore::tree`] makes trees that print.
    pub fn new(node: &Node) -> Self {
        Self::compiled(node, BakeStore::default().kept())
    }

    /// Compiles the tree with what is known of its nodes.
    pub(crate) fn compiled(node: &Node, kept: Kept) -> Self {
        Self::compiled_in(node, &DAffine3::IDENTITY, kept)
    }

    /// The same for evaluation in another space, from which `node_from_world` leads to the node's.
    pub(crate) fn compiled_in(node: &Node, node_from_world: &DAffine3, kept: Kept) -> Self {
        let mut support = support(node);
        if *node_from_world != DAffine3::IDENTITY && !support.is_empty() {
            support = seen_from(node_from_world, &support);
        }
        let mut tree = Self {
            leaves: Vec::new(),
            leaf_supports: Vec::new(),
            warps: Vec::new(),
            warp_supports: Vec::new(),
            frames: Vec::new(),
            caches: Vec::new(),
            arena: Vec::new(),
            root: Instr::EMPTY,
            support,
            bakes: kept.bakes.clone(),
            unconstrained: 0,
            evaluations: AtomicU64::new(0),
        };
        tree.root = tree.compile(node, node_from_world, kept);
        tree
    }

    /// How many support-free nodes that are switched on are shown as drawn, because nobody baked them: this tree
    /// may need supports.
    pub fn unconstrained(&self) -> usize {
        self.unconstrained
    }

    /// How often a primitive was evaluated at a point, by all samplers that are gone.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// How many primitives take part.
    pub fn primitives(&self) -> usize {
        self.leaves.len()
    }

    /// Compiles a node whose space is reached by `node_from_world` from that of evaluation.
    fn compile(&mut self, node: &Node, node_from_world: &DAffine3, kept: Kept) -> Instr {
        if !node.is_heard() {
            return Instr::EMPTY;
        }
        let exact = self.compile_shape(node, node_from_world, kept);
        match (kept.cache)(node) {
            Some(cache) if exact.op != Op::Empty => {
                let number = self.caches.len() as u32;
                self.caches.push(CacheSite { cache, frame: Frame::new(*node_from_world), number });
                self.push(Op::Cache { number, creased: true }, [exact])
            }
            _ => exact,
        }
    }

    fn compile_shape(&mut self, node: &Node, node_from_world: &DAffine3, kept: Kept) -> Instr {
        match &node.shape {
            Shape::Primitive(primitive) => {
                let support = seen_from(node_from_world, &leaf::support(primitive));
                self.add_leaf(Leaf::new(primitive, node_from_world), support)
            }
            Shape::Warp(warp, child) => self.compile_warp(warp, child, node_from_world, kept),
            Shape::SupportFree(rule, child) => self.compile_support_free(rule, child, node_from_world, kept),
            Shape::Operator(operator, children) => {
                let heard = children.iter().filter(|child| child.is_heard());
                let operands: Vec<Instr> =
                    heard.map(|child| self.compile(child, node_from_world, kept)).collect();
                let minuend_muted = children.first().is_none_or(|first| !first.is_heard());
                self.compile_operator(*operator, operands, minuend_muted, node_from_world)
            }
        }
    }

    fn compile_warp(&mut self, warp: &Warp, child: &Node, node_from_world: &DAffine3, kept: Kept) -> Instr {
        if let Some(parent_from_child) = warp.parent_from_child() {
            let rows = DAffine3 {
                matrix3: parent_from_child.matrix3.as_dmat3(),
                translation: parent_from_child.translation.as_dvec3(),
            };
            return self.compile(child, &(rows.inverse() * *node_from_world), kept);
        }
        let map = warp_map(warp);
        // What lies between this space and that of evaluation happens before the warp.
        let between = *node_from_world != DAffine3::IDENTITY;
        let inner = self.compile(child, &DAffine3::IDENTITY, kept);
        if inner.op == Op::Empty {
            return Instr::EMPTY;
        }
        let support = map.parent_region(&support(child));
        let warped = self.push(Op::Warp(self.warps.len() as u32), [inner]);
        self.warps.push(map);
        self.warp_supports.push(support);
        if !between {
            return warped;
        }
        let outer = self.push(Op::Warp(self.warps.len() as u32), [warped]);
        self.warps.push(WarpMap::Affine(AffineWarp::new(node_from_world)));
        self.warp_supports.push(seen_from(node_from_world, &support));
        outer
    }

    /// What the bake says, all as leaves and operations like others.
    fn compile_support_free(
        &mut self,
        rule: &SupportFree,
        child: &NodeRef,
        node_from_world: &DAffine3,
        kept: Kept,
    ) -> Instr {
        let exact = self.compile(child, node_from_world, kept);
        if rule.mode == SupportMode::Off || exact.op == Op::Empty && rule.strokes.is_empty() {
            return exact;
        }
        let Some(bake) = kept.bakes.find(rule, child) else {
            self.unconstrained += 1;
            return exact;
        };
        self.compile_bake(rule, bake, exact, node_from_world)
    }

    fn compile_bake(
        &mut self,
        rule: &SupportFree,
        bake: &Bake,
        exact: Instr,
        node_from_world: &DAffine3,
    ) -> Instr {
        let image_from_world = rule.upright_from_child() * *node_from_world;
        let mut result = exact;
        let mut limits = Vec::new();
        for (grown, limit) in [(&bake.grown, &bake.limit), (&bake.brushed.grown, &bake.brushed.limit)] {
            if let Some(grown) = grown {
                let grown = self.add_image(&image_from_world, grown);
                limits.insert(0, result);
                let below = self.lowest(std::mem::take(&mut limits));
                result = if below.op == Op::Empty { grown } else { self.push(Op::Union, [below, grown]) };
            }
            if let Some(limit) = limit {
                limits.push(self.add_image(&image_from_world, limit));
            }
        }
        if result.op == Op::Empty {
            return result;
        }
        limits.insert(0, result);
        if let Some(dents) = &bake.dents {
            limits.push(self.add_image(&image_from_world, dents));
        }
        if bake.cut_at_bed {
            let above = Primitive::HalfSpace(HalfSpace {
                point: Vec3::new(0.0, 0.0, rule.bed),
                normal: Vec3::NEG_Z,
                extent: ABOVE_BED,
                falloff: GROWN_FALLOFF,
            });
            limits.push(self.add_leaf(Leaf::new(&above, node_from_world), EVERYWHERE));
        }
        self.lowest(limits)
    }

    fn add_image(&mut self, image_from_world: &DAffine3, image: &Arc<VoxelImage>) -> Instr {
        self.add_leaf(Leaf::Voxels(Voxels::new(image_from_world, image.clone())), EVERYWHERE)
    }

    /// The least of one or more fields.
    fn lowest(&mut self, fields: Vec<Instr>) -> Instr {
        match fields[..] {
            [one] => one,
            _ => self.push(Op::Intersection, fields),
        }
    }

    fn add_leaf(&mut self, leaf: Leaf, support: Aabb) -> Instr {
        self.leaves.push(leaf);
        self.leaf_supports.push(support);
        Instr { op: Op::Leaf(self.leaves.len() as u32 - 1), first: 0, count: 0 }
    }

    fn compile_operator(
        &mut self,
        operator: Operator,
        mut operands: Vec<Instr>,
        minuend_muted: bool,
        node_from_world: &DAffine3,
    ) -> Instr {
        let cuts = matches!(operator, Operator::Difference | Operator::BlendDifference(_));
        if operands.is_empty() || cuts && (minuend_muted || operands[0].op == Op::Empty) {
            return Instr::EMPTY;
        }
        let meets = matches!(operator, Operator::Intersection | Operator::BlendIntersection(_));
        if meets && operands.iter().any(|operand| operand.op == Op::Empty) {
            return Instr::EMPTY;
        }
        operands.retain(|operand| operand.op != Op::Empty);
        match operands[..] {
            [] => return Instr::EMPTY,
            [only] => return only,
            _ => {}
        }
        let op = match operator {
            Operator::Union => Op::Union,
            Operator::Intersection => Op::Intersection,
            Operator::Difference => Op::Difference,
            Operator::Blend(s) => Op::Blend(s.get()),
            Operator::BlendIntersection(s) => Op::BlendIntersection(s.get()),
            Operator::BlendDifference(s) => Op::BlendDifference(s.get()),
            Operator::Sum => {
                operands.sort_by_key(|operand| !self.is_pure_point(operand));
                Op::Sum
            }
            Operator::GradientBlend => {
                let turned = even_scale(node_from_world).is_some();
                let world_from_node = || node_from_world.matrix3.inverse().transpose().as_mat3();
                self.frames.push((!turned).then(world_from_node));
                Op::GradientBlend(self.frames.len() as u32 - 1)
            }
        };
        self.push(op, operands)
    }

    fn push(&mut self, op: Op, operands: impl IntoIterator<Item = Instr>) -> Instr {
        let first = self.arena.len() as u32;
        self.arena.extend(operands);
        Instr { op, first, count: self.arena.len() as u32 - first }
    }

    /// Whether this is a leaf that a sum takes by tables.
    pub(crate) fn is_pure_point(&self, instr: &Instr) -> bool {
        matches!(instr.op, Op::Leaf(i) if matches!(self.leaves[i as usize], Leaf::PurePoint(_)))
    }
}

impl Field for Tree {
    fn support(&self) -> Aabb {
        self.support
    }

    fn sampler(&self) -> Box<dyn Sampler + '_> {
        Box::new(TreeSampler::new(self))
    }
}

/// The compiled form of a warp that is not affine.
///
/// Panics for an affine one, which is folded into the leaves instead.
pub(crate) fn warp_map(warp: &Warp) -> WarpMap {
    match warp {
        Warp::Taper(w) => WarpMap::Taper(TaperMap::new(w)),
        Warp::Twist(w) => WarpMap::Twist(TwistMap::new(w)),
        Warp::Bend(w) => WarpMap::Bend(BendMap::new(w)),
        Warp::Transform(_) | Warp::Affine(_) => unreachable!("affine warps are folded into the leaves"),
    }
}

/// The box around a node's `region` in the space from which `node_from_world` leads to the node's.
fn seen_from(node_from_world: &DAffine3, region: &Aabb) -> Aabb {
    let world_from_node = node_from_world.inverse();
    let corners = region.corners().map(|p| world_from_node.transform_point3(p.as_dvec3()).as_vec3());
    with_room(Aabb::of_points(corners), 1e-6)
}

/// Room for rounding errors of this share of the coordinates.
fn with_room(region: Aabb, share: f32) -> Aabb {
    region.grown(share * region.min.abs().max(region.max.abs()).max_element())
}

/// The box outside which the field of `node` is 0, in its parent's space; empty if the node is not heard.
pub fn support(node: &Node) -> Aabb {
    if !node.is_heard() {
        return Aabb::EMPTY;
    }
    match &node.shape {
        Shape::Primitive(primitive) => leaf::support(primitive),
        Shape::Warp(warp, child) => warped_region(warp, &support(child)),
        Shape::SupportFree(rule, child) => rule.support(&support(child)),
        Shape::Operator(operator, children) => {
            let mut boxes = children.iter().map(|child| (child.is_heard(), support(child)));
            match operator {
                Operator::Difference | Operator::BlendDifference(_) => {
                    boxes.next().map_or(Aabb::EMPTY, |(_, first)| first)
                }
                Operator::Intersection | Operator::BlendIntersection(_) => {
                    let heard = boxes.filter(|(heard, _)| *heard).map(|(_, b)| b);
                    heard.reduce(|a, b| a.intersection(&b)).unwrap_or(Aabb::EMPTY)
                }
                _ => boxes.fold(Aabb::EMPTY, |all, (_, b)| all.union(&b)),
            }
        }
    }
}

/// A box in the parent's space around where a warp takes all points of the child's `region`.
pub(crate) fn warped_region(warp: &Warp, region: &Aabb) -> Aabb {
    match warp.parent_from_child() {
        _ if region.is_empty() => Aabb::EMPTY,
        Some(map) => {
            let corners = region.corners().map(|p| map.transform_point3(p));
            with_room(Aabb::of_points(corners), 2e-6)
        }
        None => warp_map(warp).parent_region(region),
    }
}
