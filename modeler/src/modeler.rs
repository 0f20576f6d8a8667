//! All that the modeler is, and how its parts hear of each other.

mod add;
mod files;
mod habits;
mod parts;
mod variants;

pub(crate) use add::added;
pub use files::{Fetched, How, Newcomer};

use crate::brought::newest;
use crate::camera::{Camera, Side};
use crate::cutting::Cut;
use crate::desk::Desk;
use crate::dialog::Dialog;
use crate::errand::Errands;
use crate::expecting::{Asked, Thinker, Thought};
use crate::extent;
use crate::form::Form;
use crate::kept::Kept;
use crate::known::Known;
use crate::lens::Lens;
use crate::lesson::Lesson;
use crate::lowest::Lowest;
use crate::notices::Notices;
use crate::pad::{Pad, Stroked};
use crate::panels;
use crate::pen::Pen;
use crate::pointing::Pointing;
use crate::portraits::Portraits;
use crate::settings::{Settings, Theme};
use crate::solid::{Asking, Solid, SolidMaker};
use crate::stage::{Line, Stage};
use crate::trace::{Trace, Wait};
use crate::view::{self, ViewState};
use crate::workbench::{EditError, Workbench};
use blobtree::{Aabb, Command, JournalEntry, NodePath, NodeRef};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// The modeler, without a window.
pub struct Modeler {
    /// The document on the table.
    pub bench: Workbench,
    /// From where it is looked at.
    pub camera: Camera,
    /// The sketch in the air.
    pub pad: Pad,
    /// The pen, as far as the platform tells of it.
    pub pen: Pen,
    /// How the user likes to work.
    pub settings: Settings,
    /// What is kept from one start to the next; nothing in tests that do not want it.
    pub kept: Kept,
    /// The theme and the scale that everything has.
    dressed: (Theme, f32),
    /// What the user is told.
    pub notices: Notices,
    /// What is asked of the user.
    pub dialog: Option<Dialog>,
    /// What the user is being taught.
    pub lesson: Option<Lesson>,
    /// The field lens, while it is wanted.
    pub lens: Option<Lens>,
    /// Whether the user has selected what is selected. What is new is selected, too, but sketches mean the whole model
    /// then.
    selected_by_hand: bool,
    /// Who opens and writes files.
    pub desk: Arc<dyn Desk>,
    /// What is being read and written.
    pub errands: Errands,
    /// How many documents have been on the table: those that errands began with may be gone.
    documents: u64,
    /// Where the user's waits are written down, if somewhere.
    pub trace: Option<Trace>,
    /// When the present frame began.
    pub(crate) now: Instant,
    /// Why the next solid is asked for.
    asking: Asking,
    pub(crate) view: ViewState,
    /// The node that the pointer is over in the tree.
    pub(crate) hovered: Option<NodePath>,
    /// The part that the pointer is over in the view.
    pub(crate) pointing: Pointing,
    /// Where the selected nodes are.
    boxes: Vec<Known<Aabb>>,
    hovered_box: Known<Aabb>,
    /// Around the selected nodes before they were dragged.
    held_box: Option<Aabb>,
    /// The lowest point of the selected nodes.
    pub(crate) lowest: Lowest,
    /// What the selected node is cut out of.
    cut: Known<Cut>,
    /// The form of the selected node, and the scene it was made for.
    pub(crate) form: Option<(NodeRef, Form)>,
    /// The file to be opened as soon as the size of the view is known, which drawings need.
    waiting: Option<PathBuf>,
    solids: SolidMaker,
    solid: Option<Arc<Solid>>,
    /// The tree of which the solid was asked for last, and whether with its seams.
    asked: Option<(NodeRef, bool)>,
    thinker: Thinker,
    portraits: Portraits,
    /// Pictures of the nodes that show in the tree, and which those are.
    pub(crate) parts: Portraits,
    parts_shown: Vec<NodeRef>,
    /// Called when a background thread has something to show.
    wake: Arc<dyn Fn() + Send + Sync>,
    /// Where sessions are kept; nowhere in tests that do not want them.
    sessions: Option<PathBuf>,
}

impl Modeler {
    /// A modeler with an empty page. `wake` is called when a background thread has something to show.
    ///
    /// Errors: a system without threads to spare.
    pub fn new(
        desk: Box<dyn Desk>,
        sessions: Option<PathBuf>,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> std::io::Result<Self> {
        let (bench, unprotected) = Workbench::new(Workbench::empty_page(), None, sessions.as_deref())
            .expect("an empty page is legal");
        let solids = SolidMaker::start(wake.clone(), desk.bake())?;
        let mut notices = Notices::default();
        if let Some(error) = unprotected {
            notices.warn(EditError::from(error).to_string());
        }
        Ok(Self {
            bench,
            camera: Camera::default(),
            pad: Pad::default(),
            pen: Pen::default(),
            settings: Settings::default(),
            kept: Kept::default(),
            dressed: (Theme::System, 1.0),
            notices,
            dialog: None,
            lesson: None,
            lens: None,
            selected_by_hand: false,
            desk: desk.into(),
            errands: Errands::new(wake.clone()),
            documents: 0,
            trace: None,
            now: Instant::now(),
            asking: Asking::Other,
            view: ViewState::default(),
            hovered: None,
            pointing: Pointing::start(wake.clone())?,
            boxes: Vec::new(),
            hovered_box: Known::default(),
            held_box: None,
            lowest: Lowest::start(wake.clone())?,
            cut: Known::default(),
            form: None,
            waiting: None,
            solids,
            solid: None,
            asked: None,
            thinker: Thinker::start(wake.clone())?,
            portraits: Portraits::default(),
            parts: Portraits::default(),
            parts_shown: Vec::new(),
            wake,
            sessions,
        })
    }

    /// Shows everything, and does what the user wants.
    pub fn ui(&mut self, ui: &mut egui::Ui, stage: &mut dyn Stage) {
        if !std::mem::replace(&mut self.view.is_dressed, true) {
            crate::theme::dress(ui.ctx());
        }
        self.pen.guard(ui.ctx());
        self.begin_frame();
        self.dress(ui.ctx());
        self.hear();
        self.measure();
        crate::keys::heed(self, ui);
        panels::show(self, ui);
        view::show(self, ui, stage);
        if let Some(file) = self.waiting.take() {
            self.fetch(file, How::Instead);
        }
        let dropped = |input: &egui::InputState| {
            input.raw.dropped_files.iter().map(|file| file.path().to_path_buf()).collect()
        };
        self.dropped(ui.input(dropped));
        crate::dialog::show(self, ui);
        self.notices.show(ui);
        self.ask();
        self.kept.follow(&self.settings);
        self.view.had_focus = ui.ctx().egui_wants_keyboard_input();
        let computing = !self.is_at_rest();
        if let Some(trace) = &mut self.trace {
            trace.frame(self.now, computing);
        }
    }

    fn begin_frame(&mut self) {
        self.now = Instant::now();
        if let Some(error) = self.trace.as_mut().and_then(Trace::write) {
            self.notices.warn(format!("The trace cannot be written: {error}"));
        }
    }

    /// A wait of the user ends with the present frame.
    pub(crate) fn ends(&mut self, wait: Wait, since: Instant, geometry: Option<std::time::Duration>) {
        if let Some(trace) = &mut self.trace {
            trace.ends(wait, since, geometry);
        }
    }

    /// The solid as it is drawn.
    pub fn solid(&self) -> Option<&Arc<Solid>> {
        self.solid.as_ref()
    }

    /// Whether all that is shown is as fine as it gets, and nothing is being thought about.
    pub fn is_at_rest(&self) -> bool {
        let is_newest = |found| self.thinker.is_newest(found);
        let sketched = self.pad.sketch().is_empty() || self.pad.expectations.as_ref().is_some_and(is_newest);
        let asked = self.is_asked();
        let seen = self.lens.as_ref().is_none_or(Lens::is_at_rest);
        let drawn = self.parts.has(&self.parts_shown);
        let looked = seen && drawn && self.pointing.is_at_rest() && self.lowest.is_at_rest();
        sketched && asked && looked && self.errands.is_empty() && self.solids.is_done(self.solid.as_deref())
    }

    /// The knobs in the view: what they say, and where they are, in points of the view.
    pub fn knobs(&self) -> Vec<(String, glam::Vec2)> {
        view::knobs(self)
    }

    /// The seams of the solid as it is drawn, as far as they are known and wanted, and how strongly they show, from 0 to
    /// 1.
    pub fn seams(&self) -> (&[Line], f32) {
        match &self.solid {
            Some(solid) if self.settings.shows_seams => self.solids.seams(solid),
            _ => (&[], 0.0),
        }
    }

    /// The part that the pointer is over in the view.
    pub fn pointed(&self) -> Option<&NodePath> {
        self.pointing.found()
    }

    /// On what the dragged parts rest: "on the bed, z = 0".
    pub fn rests_on(&self) -> Vec<&'static str> {
        self.view.guides.iter().map(|guide| guide.name()).collect()
    }

    /// Takes in what the background threads have made.
    fn hear(&mut self) {
        self.receive();
        if let Some(solid) = self.solids.ready() {
            if !solid.is_fine {
                let wait = match solid.asking {
                    Asking::Choice => Some(Wait::ChoiceToSolid),
                    Asking::Drag => Some(Wait::DragToSolid),
                    Asking::Other => None,
                };
                if let Some(wait) = wait {
                    self.ends(wait, solid.asked, Some(solid.took));
                }
            }
            let first = self.solid.as_ref().is_none_or(|old| old.bounds.is_empty()) && self.view.shows_new;
            if first && !solid.bounds.is_empty() {
                self.camera.show(solid.bounds);
                self.view.shows_new = false;
            }
            self.solid = Some(Arc::new(solid));
        }
        if let Some(lens) = &mut self.lens {
            lens.hear();
        }
        self.pointing.hear();
        let thoughts: Vec<_> = self.thinker.thoughts().collect();
        for thought in thoughts {
            if let Thought::Expectations(found) = &thought {
                self.ends(Wait::StrokeToSuggestions, found.asked, Some(found.took));
            }
            self.pad.hear(thought);
        }
    }

    /// Finds where the selected nodes and the hovered one are.
    fn measure(&mut self) {
        let root = &self.bench.shown().root;
        let selection = self.bench.selection();
        self.boxes.resize_with(selection.len(), Known::default);
        for (known, path) in self.boxes.iter_mut().zip(selection) {
            known.follow(root, Some(path), extent::box_of);
        }
        self.lowest.follow(&self.bench.scene().root, selection);
        self.hovered_box.follow(root, self.hovered.as_ref(), extent::box_of);
        let primitive = self.bench.selected().and_then(|path| view::primitive_at(root, path));
        self.cut.follow(root, primitive.as_ref(), Cut::of);
        if NodeRef::ptr_eq(root, &self.bench.scene().root) {
            self.held_box = self.selected_box();
        }
    }

    /// Around the selected nodes before the hand took hold of them, mm.
    pub(crate) fn held_box(&self) -> Option<Aabb> {
        self.held_box
    }

    /// The selected part as a cut, if it is one.
    pub fn selected_cut(&self) -> Option<&Cut> {
        self.cut.found.as_ref()
    }

    /// Around the solid of the node that the pointer is over in the tree, mm.
    pub(crate) fn hovered_box(&self) -> Option<Aabb> {
        self.hovered_box.found
    }

    /// Whether the solid that is to be shown was asked for.
    fn is_asked(&self) -> bool {
        let is_same = |(root, seams): &(NodeRef, bool)| {
            NodeRef::ptr_eq(root, &self.bench.shown().root) && *seams == self.settings.shows_seams
        };
        self.asked.as_ref().is_some_and(is_same)
    }

    /// Asks the background threads for what has changed.
    fn ask(&mut self) {
        if !self.is_asked() {
            let (root, seams) = (&self.bench.shown().root, self.settings.shows_seams);
            self.asked = Some((root.clone(), seams));
            let asking = if self.bench.is_dragged() { Asking::Drag } else { self.asking };
            self.solids.ask(root, seams, asking, self.now);
            self.asking = Asking::Other;
        }
        let bounds = self.bounds();
        if let Some(lens) = &mut self.lens {
            lens.look(&self.bench.shown().root, bounds);
        }
    }

    /// Lets the thinker think about the sketch as it is.
    pub(crate) fn think(&mut self) {
        if let (Some(view), false) = (self.pad.drawn_in(), self.pad.sketch().is_empty()) {
            self.thinker.ask(Asked {
                sketch: self.pad.sketch().clone(),
                view: *view,
                root: self.bench.scene().root.clone(),
                selected: self.bench.selected().cloned().filter(|_| self.selected_by_hand),
                depth: self.pad.depth,
                since: self.now,
            });
        }
    }

    /// Does something to the document, and tells the user if it cannot be done.
    pub fn act(&mut self, entry: JournalEntry) -> bool {
        let was_protected = self.bench.is_protected();
        match self.bench.act(entry) {
            Ok(_) => {
                if self.bench.is_protected() && !was_protected {
                    self.notices.tell("What you do is protected against a crash again.");
                }
                true
            }
            Err(error) => {
                let kept = matches!(error, EditError::Journal(_));
                self.notices.warn(error.to_string());
                kept
            }
        }
    }

    /// Carries out a command.
    pub fn apply(&mut self, command: Command) -> bool {
        self.act(JournalEntry::Command(command))
    }

    /// Takes back the last stroke of the sketch, else the last thing done to the document.
    pub fn undo(&mut self) {
        if self.pad.undo() {
            self.think();
        } else if self.bench.document().undo_names().next().is_some() {
            self.act(JournalEntry::Undo);
        }
    }

    /// Does again what was taken back.
    pub fn redo(&mut self) {
        if self.bench.document().redo_names().next().is_some() {
            self.act(JournalEntry::Redo);
        }
    }

    /// Goes to a step of the history: back by so many steps, or forward if less than 0.
    pub fn go_back(&mut self, steps: isize) {
        let entry = if steps > 0 { JournalEntry::Undo } else { JournalEntry::Redo };
        for _ in 0..steps.unsigned_abs() {
            if !self.act(entry.clone()) {
                break;
            }
        }
    }

    /// Makes the sketch what the suggestion at this place says.
    pub fn choose(&mut self, suggestion: usize) {
        let chosen = self.pad.expectations.as_ref().and_then(|found| found.suggestions.get(suggestion));
        let Some(chosen) = chosen.cloned() else { return };
        let before = self.bench.scene().root.clone();
        if self.apply(chosen.command) {
            self.asking = Asking::Choice;
            // Its pictures would only keep the solid waiting.
            self.thinker.stop();
            self.pad.clear();
            self.bench.select(newest(&before, &self.bench.scene().root));
            self.selected_by_hand = false;
        }
    }

    /// What a finished stroke was.
    pub(crate) fn stroked(&mut self, stroked: Stroked) {
        match stroked {
            Stroked::Sketched => self.think(),
            Stroked::Pressed(button) => self.choose(button),
            Stroked::Removed => self.remove_selected(),
            Stroked::UndoneStep => self.undo(),
            Stroked::ParentSelected => self.select_parent(),
            Stroked::Nothing => {}
        }
    }

    /// Takes up the field lens, or puts it away.
    pub fn toggle_lens(&mut self) {
        self.lens = match self.lens.take() {
            Some(_) => None,
            None => match Lens::new(self.wake.clone()) {
                Ok(lens) => Some(lens),
                Err(error) => {
                    self.notices.warn(format!("The field lens cannot be used now: {error}"));
                    None
                }
            },
        };
    }

    /// Shows what a command would do, or does it.
    pub(crate) fn try_out(&mut self, command: Command, is_final: bool) {
        if is_final {
            self.apply(command);
        } else if let Err(error) = self.bench.drag(Some(command)) {
            self.notices.tell(error.to_string());
        }
    }

    /// Where the solid of the scene is, mm; empty without one.
    pub fn bounds(&self) -> Aabb {
        self.solid.as_ref().map_or(Aabb::EMPTY, |solid| solid.bounds)
    }

    /// Looks from a named side.
    pub fn look_from(&mut self, side: Side) {
        self.camera.look_from(side);
    }
}
