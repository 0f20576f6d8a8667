//! What is done to the selected parts: one of them or several, always as one step.

use super::{Modeler, added};
use crate::placing::{self, Motion};
use crate::several;
use blobtree::{Aabb, Command, NodePath, NodeRef, Operator, Shape};
use glam::{Affine3A, Vec2, Vec3};

/// Why a part cannot have a copy.
const NOTHING_BESIDE: &str = "Only parts of a union, a blend or a cut can have a copy beside them.";

impl Modeler {
    /// Selects a node, or nothing.
    pub fn select(&mut self, path: Option<NodePath>) {
        self.select_all(path);
    }

    /// Selects these nodes.
    pub fn select_all(&mut self, paths: impl IntoIterator<Item = NodePath>) {
        self.bench.select_all(paths);
        self.selected_by_hand();
    }

    /// Selects a node with those that are selected, or no longer.
    pub fn select_too(&mut self, path: NodePath) {
        self.bench.select_too(path);
        self.selected_by_hand();
    }

    fn selected_by_hand(&mut self) {
        self.selected_by_hand = true;
        self.think();
    }

    /// Selects the parent of what is selected, or what holds all selected parts; above the root, nothing.
    pub fn select_parent(&mut self) {
        self.select(several::parent(self.bench.selection()));
    }

    /// Around the solids of all selected nodes, as they are shown, mm; none without any.
    pub fn selected_box(&self) -> Option<Aabb> {
        self.selected_boxes().reduce(|all, one| all.union(&one))
    }

    /// Around the solid of each selected node, as it is shown, mm.
    pub(crate) fn selected_boxes(&self) -> impl Iterator<Item = Aabb> {
        self.boxes.iter().filter_map(|known| known.found)
    }

    /// Takes away what is selected.
    pub fn remove_selected(&mut self) {
        if let Some(command) = several::remove(&self.bench.scene().root, self.bench.selection()) {
            self.bench.select(None);
            self.apply(command);
        }
    }

    /// Puts a copy of what is selected beside it, and selects the copies.
    pub fn duplicate_selected(&mut self) {
        let root = &self.bench.scene().root;
        let found = self.whole_beside(NodeRef::clone);
        let found = found.or_else(|| several::duplicate(root, self.bench.selection()));
        self.put_beside(found);
    }

    /// Puts a mirrored copy of what is selected on the other side of the middle, and selects the copies.
    pub fn mirror_selected(&mut self) {
        let root = &self.bench.scene().root;
        let found = self.whole_beside(|root| placing::mirror(root, Affine3A::IDENTITY).into());
        let mirrored = |path: &NodePath| placing::mirrored(root, path);
        let found = found.or_else(|| several::beside(root, self.bench.selection(), mirrored));
        self.put_beside(found);
    }

    /// What puts a copy of all there is beside it, if all is selected, and where that then is.
    fn whole_beside(&self, copy: impl Fn(&NodeRef) -> NodeRef) -> Option<(Command, Vec<NodePath>)> {
        let root = &self.bench.scene().root;
        let is_whole = self.bench.selected()?.0.is_empty() && !root.children().is_empty();
        let (command, path) = is_whole.then(|| added(root, copy(root)))?;
        Some((command, vec![path]))
    }

    /// These nodes show in the tree: their pictures are drawn as soon as the model is.
    pub(crate) fn show_parts(&mut self, nodes: Vec<NodeRef>, ctx: &egui::Context) {
        self.parts_shown = nodes;
        if self.solids.is_done(self.solid.as_deref()) {
            self.parts.get(&self.parts_shown, ctx, &self.wake);
        }
    }

    /// How many nodes show in the tree with a picture.
    pub fn pictures_in_tree(&self) -> usize {
        self.parts_shown.iter().filter(|node| self.parts.of(node).is_some()).count()
    }

    /// What is moved if this node is dragged in the tree: all that is selected, if it is one of them.
    pub(crate) fn moved_with(&self, dragged: &NodePath) -> Vec<NodePath> {
        let selection = self.bench.selection();
        if selection.contains(dragged) { selection.to_vec() } else { vec![dragged.clone()] }
    }

    /// Moves what was dragged in the tree to what it was dropped on, and selects it: an operator gets it as its last
    /// child, others as their neighbour.
    pub(crate) fn drop_in_tree(&mut self, dragged: &NodePath, onto: &NodePath) {
        let (root, dragged) = (&self.bench.scene().root, self.moved_with(dragged));
        let place = match (onto.find(root).map(|node| &node.shape), onto.parent(), onto.0.last()) {
            (Some(Shape::Operator(_, children)), _, _) => Some((onto.clone(), children.len())),
            (_, Some(parent), Some(&index)) => Some((parent, index + 1)),
            _ => None,
        };
        let Some((parent, index)) = place.filter(|_| !dragged.contains(onto)) else { return };
        if let Some((command, places)) = several::moved(root, &dragged, parent, index)
            && self.apply(command)
        {
            self.select_all(places);
        }
    }

    fn put_beside(&mut self, found: Option<(Command, Vec<NodePath>)>) {
        match found {
            Some((command, copies)) => {
                if self.apply(command) {
                    self.bench.select_all(copies);
                }
            }
            None if self.bench.selection().is_empty() => {}
            None => self.notices.tell(NOTHING_BESIDE),
        }
    }

    /// Puts what is selected on the ground. Several parts keep their places to each other.
    pub fn ground_selected(&mut self) {
        if let Some(lowest) = self.lowest.wait(&self.bench.scene().root, self.bench.selection()) {
            self.place(Motion::Move(Vec3::new(0.0, 0.0, -lowest)), true);
        }
    }

    /// Moves what is selected by a millimetre along the axis that is nearest to this direction of the screen, with y up.
    pub fn nudge(&mut self, to: Vec2) {
        let view = self.camera.view(self.view.screen);
        let seen = view.right() * to.x + view.up * to.y;
        let axis = seen.abs().max_position();
        let mut by = Vec3::ZERO;
        by[axis] = seen[axis].signum();
        self.place(Motion::Move(by), true);
    }

    /// Turns what is selected about its middle, degrees, counter-clockwise seen from above.
    pub fn turn_selected(&mut self, degrees: f32) {
        if let Some(bounds) = self.selected_box() {
            self.place(Motion::Turn { about: bounds.center(), axis: Vec3::Z, degrees }, true);
        }
    }

    /// Makes what is selected larger by a factor, about its middle.
    pub fn size_selected(&mut self, factor: f32) {
        if let Some(bounds) = self.selected_box() {
            self.place(Motion::Scale { about: bounds.center(), factor }, true);
        }
    }

    /// Mutes what is selected; if all of it is muted, lets it be heard.
    pub fn mute_selected(&mut self) {
        let root = &self.bench.scene().root;
        let is_muted = |path: &NodePath| path.find(root).is_some_and(|node| node.muted);
        let muted = !self.bench.selection().iter().all(is_muted);
        self.each_selected(|path| Command::SetMuted { path, muted });
    }

    /// Makes what is selected something to draw on only; if all of it is, part of the solid again.
    pub fn construct_selected(&mut self) {
        let root = &self.bench.scene().root;
        let is_one = |path: &NodePath| path.find(root).is_some_and(|node| node.construction);
        let construction = !self.bench.selection().iter().all(is_one);
        self.each_selected(|path| Command::SetConstruction { path, construction });
    }

    /// Does the same to each selected node, as one step.
    pub(crate) fn each_selected(&mut self, command: impl Fn(NodePath) -> Command) {
        if let Some(command) = several::together(self.bench.selection().iter().cloned().map(command)) {
            self.apply(command);
        }
    }

    /// Shows what the same would do to each selected node.
    pub(crate) fn try_each(&mut self, command: impl Fn(NodePath) -> Command) {
        if let Some(command) = several::together(self.bench.selection().iter().cloned().map(command)) {
            self.try_out(command, false);
        }
    }

    /// Puts what is selected into one operator, and selects that.
    pub fn group_selected(&mut self, operator: Operator) {
        match several::group(&self.bench.scene().root, self.bench.selection(), operator) {
            Some((command, place)) => {
                if self.apply(command) {
                    self.bench.select(Some(place));
                }
            }
            None if self.bench.selection().is_empty() => {}
            None => {
                self.notices.tell("Only parts that the same moves, turns and twists hold can become one.");
            }
        }
    }

    /// Shows what is selected moved, or moves it if the hand has let go.
    pub(crate) fn place(&mut self, motion: Motion, let_go: bool) {
        let root = &self.bench.scene().root;
        let moves = self.bench.selection().iter().map(|path| placing::command(root, path, motion));
        match moves.collect::<Option<Vec<_>>>() {
            Some(moves) => {
                if let Some(command) = several::together(moves) {
                    self.try_out(command, let_go);
                }
            }
            None => self.notices.tell("What is inside a twist, a taper or a bend cannot be moved by hand."),
        }
    }
}
