//! The stages of a node's field, and which of them changed a place.

use super::{Cause, voxels};
use crate::brush::dabs_of;
use crate::{Rebaker, SupportRule};
use blobtree::build::Build;
use blobtree::{
    Bake, BakeError, BakeStore, Baker, BrushStroke, BrushTip, Brushed, Field, ISO, Node, NodeRef, Shape,
    SupportFree, Tree,
};
use glam::Vec3;
use std::cell::OnceCell;

/// Steps in which a surface is looked for, in layers.
const STEP_LAYERS: f32 = 0.25;

/// By how much a surface must lean out beyond the largest overhang for its own lean to be the reason, degrees.
const LEAN_TOLERANCE: f32 = 0.5;

/// A node with its bake.
pub(super) struct Known<'a> {
    pub rule: &'a SupportFree,
    pub child: &'a NodeRef,
    pub bake: &'a Bake,
    pub bakes: &'a BakeStore,
    pub rebaker: &'a Rebaker<'a>,
    pub seen: Seen,
}

/// The node's voxels, once they were needed; the bed is at 0.
#[derive(Default)]
pub(super) struct Seen {
    /// Of what grew and the child, what trimming takes.
    taken: OnceCell<Option<voxels::Taken>>,
    /// Of the child, what nothing carries.
    hanging: OnceCell<Vec<Vec3>>,
}

/// Hands out what is known, and replays strokes if it is to.
struct Prompter<'a> {
    bake: Bake,
    replay: Option<&'a Rebaker<'a>>,
}

impl Baker for Prompter<'_> {
    fn bake(&self, _rule: &SupportFree, _child: &dyn Field) -> Result<Bake, BakeError> {
        Ok(self.bake.clone())
    }

    fn brush(&self, rule: &SupportFree, node: &dyn Field, bake: Bake) -> Result<Bake, BakeError> {
        match self.replay {
            Some(rebaker) => rebaker.brush(rule, node, bake),
            None => Ok(bake),
        }
    }
}

impl Known<'_> {
    /// What the node changed at `place`, in its own space: whether matter was added, and why; none if nothing.
    pub fn change_at(&self, place: Vec3) -> Result<Option<(bool, Cause)>, BakeError> {
        let drawn = self.bakes.compile(self.child);
        let was_solid = drawn.value(place) >= ISO;
        if self.bake.cut_at_bed && place.z < self.rule.bed {
            return Ok(was_solid.then_some((false, Cause::BelowBed)));
        }
        let Bake { limit, dents, grown, brushed, .. } = self.bake.clone();
        let with_grown = Bake { grown, ..Bake::default() };
        let limited = Bake { limit, ..with_grown.clone() };
        let with_strokes = Bake { brushed, ..limited.clone() };
        let settled = Bake { dents, ..with_strokes.clone() };
        let mut solid = [was_solid; 5];
        for (n, bake) in [&with_grown, &limited, &with_strokes, &settled].into_iter().enumerate() {
            solid[n + 1] = self.stage(bake, Vec3::ZERO)?.value(place) >= ISO;
        }
        let added = solid[4];
        if added == was_solid {
            return Ok(None);
        }
        let last = (1..5).rfind(|&n| solid[n] != solid[n - 1]).unwrap_or(0);
        let cause = match last {
            1 => self.why_grown(place)?,
            2 => self.why_taken(&with_grown, place)?,
            3 => self.stroke_that_changed(&limited, solid[2], place)?,
            _ => Cause::Settled,
        };
        Ok(Some((added, cause)))
    }

    fn support_rule(&self) -> Result<SupportRule, BakeError> {
        let rule = SupportRule::new(self.rule.layer_height, self.rule.overhang_degrees);
        rule.map_err(|e| BakeError::Impossible(e.to_string()))
    }

    fn bed(&self) -> Vec3 {
        Vec3::Z * self.rule.bed
    }

    /// The node with another bake, and what knows that.
    fn with(&self, rule: SupportFree, baker: &Prompter) -> Result<(NodeRef, BakeStore), BakeError> {
        // Bakes belong to children by identity: a child of its own gets a bake of its own.
        let child = NodeRef::new((**self.child).clone());
        let node = NodeRef::new(Node::new(Shape::SupportFree(rule, child)));
        let mut store = self.bakes.clone();
        store.bake(&node, baker)?;
        Ok((node, store))
    }

    /// The node as this bake says, moved by `by`.
    fn stage(&self, bake: &Bake, by: Vec3) -> Result<Tree, BakeError> {
        let baker = Prompter { bake: bake.clone(), replay: None };
        let (node, store) = self.with(self.rule.clone(), &baker)?;
        Ok(store.compile(&node.translate(by)))
    }

    /// What hangs of the child, for which matter was grown here.
    fn why_grown(&self, place: Vec3) -> Result<Cause, BakeError> {
        let rule = self.support_rule()?;
        let hanging = match self.seen.hanging.get() {
            Some(hanging) => hanging,
            None => {
                let child = self.stage(&Bake::default(), -self.bed())?;
                self.seen.hanging.get_or_init(|| voxels::hanging(rule, &child))
            }
        };
        let holds = voxels::held_by(rule, hanging, place - self.bed());
        Ok(Cause::Grown { holds: holds.map(|holds| holds + self.bed()) })
    }

    /// Why the rule took what was solid in `before`.
    fn why_taken(&self, before: &Bake, place: Vec3) -> Result<Cause, BakeError> {
        let (tree, rule) = (self.stage(before, -self.bed())?, self.support_rule()?);
        let taken = self.seen.taken.get_or_init(|| voxels::Taken::new(rule, &tree));
        if taken.as_ref().is_some_and(|taken| taken.is_island(place - self.bed())) {
            return Ok(Cause::Island);
        }
        Ok(self.overhang_below(&tree, place - self.bed()).unwrap_or(Cause::Toppled))
    }

    /// The surface straight below a place, if it leans out too far; the bed is at 0.
    fn overhang_below(&self, tree: &Tree, place: Vec3) -> Option<Cause> {
        let step = STEP_LAYERS * self.rule.layer_height;
        let count = (place.z / step).ceil().max(0.0) as usize;
        let at = |depth: f32| place - Vec3::Z * depth;
        let outside = |depth: &f32| tree.value(at(*depth)) < ISO;
        let mut out = (1..=count).map(|n| n as f32 * step).find(outside)?;
        let mut inside = out - step;
        for _ in 0..12 {
            let middle = 0.5 * (inside + out);
            if outside(&middle) { out = middle } else { inside = middle }
        }
        let inwards = tree.sample(at(inside)).gradient.try_normalize()?;
        let lean_degrees = inwards.z.clamp(-1.0, 1.0).asin().to_degrees();
        let most_degrees = self.rule.overhang_degrees;
        let underside = at(inside) + self.bed();
        (lean_degrees > most_degrees + LEAN_TOLERANCE).then_some(Cause::Overhang {
            lean_degrees,
            most_degrees,
            underside,
        })
    }

    /// The stroke that left `place` as it is; `before` is what was baked ahead of all strokes, `was_solid` the place in it.
    fn stroke_that_changed(&self, before: &Bake, was_solid: bool, place: Vec3) -> Result<Cause, BakeError> {
        let before = Bake { brushed: Brushed::default(), ..before.clone() };
        // After so many strokes the place is as before, after so many it has changed.
        let (mut unchanged, mut changed) = (0, self.rule.strokes.len().max(1));
        while changed - unchanged > 1 {
            let middle = unchanged.midpoint(changed);
            let rule = SupportFree { strokes: self.rule.strokes[..middle].to_vec(), ..self.rule.clone() };
            let baker = Prompter { bake: before.clone(), replay: Some(self.rebaker) };
            let (node, store) = self.with(rule, &baker)?;
            let solid = store.compile(&node).value(place) >= ISO;
            if solid == was_solid { unchanged = middle } else { changed = middle }
        }
        let stroke = self.rule.strokes.get(unchanged);
        let stroke = stroke
            .ok_or_else(|| BakeError::Impossible("a bake with strokes, but none in the rule".into()))?;
        let (brush, under_tip) = (stroke.brush, is_under_tip(stroke, place));
        Ok(Cause::Stroke { number: unchanged, brush, under_tip, added: !was_solid })
    }
}

/// Whether a dab of the stroke covers a place.
fn is_under_tip(stroke: &BrushStroke, place: Vec3) -> bool {
    let solid = match &stroke.tip {
        BrushTip::Shape(node) => Some(Tree::new(node)),
        _ => None,
    };
    let covers = |p: Vec3| match &stroke.tip {
        BrushTip::Ball => p.length() <= 1.0,
        BrushTip::Cube => p.abs().max_element() <= 1.0,
        BrushTip::Cylinder => p.truncate().length() <= 1.0 && p.z.abs() <= 1.0,
        BrushTip::Shape(_) => solid.as_ref().is_some_and(|tree| tree.value(p) >= ISO),
    };
    let dabs = dabs_of(stroke).unwrap_or_default();
    dabs.iter().any(|dab| covers((place - dab.center()) / dab.radius()))
}
