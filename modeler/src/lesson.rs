//! First minutes: three lessons on the user's own page.

use crate::dialog::Dialog;
use crate::modeler::Modeler;
use crate::theme::card_width;
use blobtree::{NodeRef, Operator, Shape};
use egui::{Align2, Area, Frame, Id, Order, Rect, RichText, Ui, vec2};

/// The width of a card, points.
const WIDTH: f32 = 320.0;

/// What the lessons teach, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lesson {
    /// Draw an outline.
    Draw,
    /// Choose what it becomes.
    Choose,
    /// Let something grow out of it.
    Blend,
    /// Cut a hole.
    Cut,
    /// What else there is.
    Done,
}

impl Lesson {
    /// The first.
    pub const FIRST: Self = Self::Draw;

    /// Which lesson it belongs to.
    fn title(self) -> &'static str {
        match self {
            Self::Draw | Self::Choose => "Lesson 1 of 3: draw",
            Self::Blend => "Lesson 2 of 3: blend",
            Self::Cut => "Lesson 3 of 3: cut",
            Self::Done => "That is all you need",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Draw => "Draw a circle, or any closed outline, in the middle of the page.",
            Self::Choose => "There are pictures of what your outline may become. Tap Inflate.",
            Self::Blend => "Draw a smaller circle across the edge of your shape, and tap Grow.",
            Self::Cut => "Draw a small circle inside your shape, and tap Cut a hole.",
            Self::Done => {
                "Drag with the right button, or with Turn, to look at it from all sides. Tap a part to move it. \
                 Undo takes anything back. Export writes a file for your printer."
            }
        }
    }

    /// Whether the user has done it.
    fn is_done(self, modeler: &Modeler) -> bool {
        let root = &modeler.bench.scene().root;
        match self {
            Self::Draw => {
                let found = modeler.pad.expectations.as_ref();
                found.is_some_and(|found| !found.suggestions.is_empty()) || !root.children().is_empty()
            }
            Self::Choose => !root.children().is_empty(),
            Self::Blend => has(root, |operator| {
                matches!(operator, Operator::Blend(_) | Operator::GradientBlend | Operator::Sum)
            }),
            Self::Cut => {
                has(root, |operator| matches!(operator, Operator::Difference | Operator::BlendDifference(_)))
            }
            Self::Done => false,
        }
    }

    fn next(self) -> Self {
        match self {
            Self::Draw => Self::Choose,
            Self::Choose => Self::Blend,
            Self::Blend => Self::Cut,
            Self::Cut | Self::Done => Self::Done,
        }
    }
}

/// Whether an operator of this kind has something to do in a tree.
fn has(root: &NodeRef, is_one: impl Fn(&Operator) -> bool) -> bool {
    let mut waiting = vec![root.clone()];
    while let Some(node) = waiting.pop() {
        if matches!(&node.shape, Shape::Operator(operator, children) if children.len() > 1 && is_one(operator))
        {
            return true;
        }
        waiting.extend(node.children().iter().cloned());
    }
    false
}

/// Shows the lesson, or offers lessons on an empty page, in the corner of the view away from the hand.
pub fn show(modeler: &mut Modeler, ui: &Ui, view: Rect) {
    while let Some(lesson) = modeler.lesson.filter(|lesson| lesson.is_done(modeler)) {
        modeler.lesson = Some(lesson.next());
    }
    let is_new = modeler.bench.scene().root.children().is_empty() && modeler.pad.is_empty();
    if modeler.lesson.is_none() && !is_new {
        return;
    }
    let (pivot, corner) = if modeler.settings.left_handed {
        (Align2::RIGHT_BOTTOM, view.right_bottom() + vec2(-12.0, -12.0))
    } else {
        (Align2::LEFT_BOTTOM, view.left_bottom() + vec2(12.0, -12.0))
    };
    let area = Area::new(Id::unique("lesson")).order(Order::Middle).pivot(pivot).fixed_pos(corner);
    area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.set_max_width(card_width(WIDTH, view.width() - 60.0));
            match modeler.lesson {
                Some(lesson) => card(modeler, ui, lesson),
                None => offer(modeler, ui),
            }
        });
    });
}

fn card(modeler: &mut Modeler, ui: &mut Ui, lesson: Lesson) {
    ui.strong(lesson.title());
    ui.label(RichText::new(lesson.text()).size(14.0));
    ui.horizontal(|ui| {
        if lesson != Lesson::Done && ui.button("Skip this").clicked() {
            modeler.lesson = Some(lesson.next());
        }
        if ui.button("End lessons").clicked() {
            modeler.lesson = None;
        }
    });
}

fn offer(modeler: &mut Modeler, ui: &mut Ui) {
    ui.strong("An empty page");
    ui.label(RichText::new("Draw a closed outline: it becomes solid.").size(14.0));
    ui.horizontal(|ui| {
        if ui.button("Show me how").clicked() {
            modeler.lesson = Some(Lesson::FIRST);
        }
        if ui.button("See examples").clicked() {
            modeler.dialog = Some(Dialog::Examples);
        }
    });
    crate::panels::recent::welcome(modeler, ui);
}
