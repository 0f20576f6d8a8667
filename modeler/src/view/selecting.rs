//! Selecting in the view: by a tap on a part, and by a stroke across several.

use crate::modeler::Modeler;
use crate::settings::Tool;
use blobtree::{NodePath, NodeRef, Pick, Shape, Tree, pick};
use egui::Modifiers;
use glam::Vec2;

/// A second tap within this distance of the first means the next node there, points.
const SAME_PLACE: f32 = 8.0;

/// Places of a stroke that are looked at, at most.
const MOST_PLACES: usize = 40;

/// How far they are from each other at least, points.
const APART: f32 = 6.0;

/// Selects what is below the pen; at the same place again, the next of those that made the surface there. With Shift or
/// Ctrl, or with the tool that selects several, it is selected with the others, or no longer.
pub fn tap(modeler: &mut Modeler, at: Vec2, modifiers: Modifiers) {
    let root = modeler.bench.scene().root.clone();
    let found = below(modeler, &root, &Tree::new(&root), at);
    let held = modifiers.shift || modifiers.command;
    let several = held || modeler.settings.tool == Tool::Select;
    let again = modeler.view.tapped.take().filter(|(before, _)| before.distance(at) < SAME_PLACE);
    let Some(found) = found else {
        if !held {
            modeler.select(None);
        }
        return;
    };
    if several {
        if let Some((path, _)) = found.contributors.first() {
            modeler.select_too(meant(&root, path));
        }
        return;
    }
    let turn = again.map_or(0, |(_, turn)| turn + 1) % found.contributors.len().max(1);
    modeler.view.tapped = Some((at, turn));
    modeler.select(found.contributors.get(turn).map(|(path, _)| meant(&root, path)));
}

/// Selects all parts that a stroke passes over, with those that are selected.
pub fn cross(modeler: &mut Modeler, stroke: impl Iterator<Item = Vec2>) {
    let root = modeler.bench.scene().root.clone();
    let tree = Tree::new(&root);
    let mut places: Vec<Vec2> = Vec::new();
    for place in stroke {
        if places.last().is_none_or(|last| last.distance(place) >= APART) {
            places.push(place);
        }
    }
    let mut chosen = modeler.bench.selection().to_vec();
    for place in places.iter().step_by(places.len().div_ceil(MOST_PLACES).max(1)) {
        let found = below(modeler, &root, &tree, *place);
        chosen.extend(found.and_then(|found| Some(meant(&root, &found.contributors.first()?.0))));
    }
    modeler.select_all(chosen);
}

fn below(modeler: &Modeler, root: &NodeRef, tree: &Tree, at: Vec2) -> Option<Pick> {
    let ray = modeler.camera.view(modeler.view.screen).ray(at);
    pick(root, tree, ray.origin, ray.direction)
}

/// The node, or the outermost of the warps that bend only it: what a person means who points at it.
pub fn meant(root: &NodeRef, path: &NodePath) -> NodePath {
    let mut path = path.clone();
    while let Some(parent) = path.parent() {
        let is_warp = parent.find(root).is_some_and(|node| matches!(node.shape, Shape::Warp(..)));
        if !is_warp || parent.0.is_empty() {
            break;
        }
        path = parent;
    }
    path
}
