//! What the keyboard does. Everything here can be done with the pen as well.

use crate::camera::Side;
use crate::dialog::Dialog;
use crate::modeler::Modeler;
use crate::settings::Tool;
use blobtree::Operator;
use egui::{Key, KeyboardShortcut, Modifiers, Popup, Ui};
use glam::Vec2;

/// A key, what it does in words, and how.
pub struct Binding {
    /// The key.
    pub shortcut: KeyboardShortcut,
    /// What it does.
    pub help: &'static str,
    run: fn(&mut Modeler),
}

const fn with(modifiers: Modifiers, key: Key, help: &'static str, run: fn(&mut Modeler)) -> Binding {
    Binding { shortcut: KeyboardShortcut::new(modifiers, key), help, run }
}

/// All keys, in the order of the help.
pub const BINDINGS: [Binding; 40] = [
    with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z, "do again what was undone", Modeler::redo),
    with(Modifiers::COMMAND, Key::Y, "do again what was undone", Modeler::redo),
    with(Modifiers::COMMAND, Key::Z, "undo the last stroke or step", Modeler::undo),
    with(Modifiers::COMMAND, Key::N, "new page", Dialog::begin_new),
    with(Modifiers::COMMAND, Key::O, "open", Dialog::begin_open),
    with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::S, "save under another name", |m| {
        Dialog::begin_save(m, true, None);
    }),
    with(Modifiers::COMMAND, Key::S, "save", |m| Dialog::begin_save(m, false, None)),
    with(Modifiers::COMMAND, Key::E, "export for printing", Dialog::begin_export),
    with(Modifiers::COMMAND, Key::D, "duplicate what is selected", Modeler::duplicate_selected),
    with(Modifiers::COMMAND, Key::G, "put what is selected together", |m| m.group_selected(Operator::Union)),
    with(Modifiers::COMMAND, Key::M, "mute what is selected, or let it be heard", Modeler::mute_selected),
    with(Modifiers::NONE, Key::Delete, "remove what is selected", Modeler::remove_selected),
    with(Modifiers::NONE, Key::Backspace, "remove what is selected", Modeler::remove_selected),
    with(Modifiers::NONE, Key::Escape, "put the sketch away, else select nothing", escape),
    with(Modifiers::NONE, Key::P, "select the parent", Modeler::select_parent),
    with(Modifiers::NONE, Key::M, "mirror to the other side", Modeler::mirror_selected),
    with(Modifiers::NONE, Key::G, "put on the ground", Modeler::ground_selected),
    with(Modifiers::NONE, Key::ArrowLeft, "move what is selected by 1 mm", |m| m.nudge(-Vec2::X)),
    with(Modifiers::NONE, Key::ArrowRight, "move what is selected by 1 mm", |m| m.nudge(Vec2::X)),
    with(Modifiers::NONE, Key::ArrowUp, "move it up, or away when seen from above", |m| m.nudge(Vec2::Y)),
    with(Modifiers::NONE, Key::ArrowDown, "move it down, or nearer when seen from above", |m| {
        m.nudge(-Vec2::Y);
    }),
    with(Modifiers::NONE, Key::Plus, "make what is selected larger", |m| m.size_selected(1.1)),
    with(Modifiers::NONE, Key::Minus, "make what is selected smaller", |m| m.size_selected(1.0 / 1.1)),
    with(Modifiers::NONE, Key::R, "turn what is selected by 15°, seen from above", |m| {
        m.turn_selected(15.0);
    }),
    with(Modifiers::NONE, Key::L, "the field lens: what makes the value at a place", Modeler::toggle_lens),
    with(Modifiers::NONE, Key::F, "see everything", |m| m.camera.show(m.bounds())),
    with(Modifiers::NONE, Key::D, "draw", |m| m.settings.tool = Tool::Draw),
    with(Modifiers::NONE, Key::S, "select several", |m| m.settings.tool = Tool::Select),
    with(Modifiers::NONE, Key::E, "erase", |m| m.settings.tool = Tool::Erase),
    with(Modifiers::NONE, Key::T, "turn the model", |m| m.settings.tool = Tool::Turn),
    with(Modifiers::NONE, Key::V, "move the view", |m| m.settings.tool = Tool::Pan),
    with(Modifiers::NONE, Key::Enter, "take the first suggestion", |m| m.choose(0)),
    with(Modifiers::NONE, Key::Questionmark, "show this help", |m| m.dialog = Some(Dialog::Help)),
    with(Modifiers::COMMAND, Key::Num0, "look from the corner", |m| m.look_from(Side::Corner)),
    with(Modifiers::COMMAND, Key::Num1, "look from the front", |m| m.look_from(Side::Front)),
    with(Modifiers::COMMAND, Key::Num2, "look from behind", |m| m.look_from(Side::Back)),
    with(Modifiers::COMMAND, Key::Num3, "look from the left", |m| m.look_from(Side::Left)),
    with(Modifiers::COMMAND, Key::Num4, "look from the right", |m| m.look_from(Side::Right)),
    with(Modifiers::COMMAND, Key::Num5, "look from above", |m| m.look_from(Side::Top)),
    with(Modifiers::COMMAND, Key::Num6, "look from below", |m| m.look_from(Side::Bottom)),
];

/// Does what the keys say that were pressed, unless something is being typed; keys alone belong to the control that has
/// the focus.
pub fn heed(modeler: &mut Modeler, ui: &mut Ui) {
    // An open menu has the keyboard: Escape closes it.
    if ui.ctx().text_edit_focused() || modeler.dialog.is_some() || Popup::is_any_open(ui.ctx()) {
        return;
    }
    // Escape lets go of a control, and does nothing else.
    let focused = ui.ctx().egui_wants_keyboard_input() || modeler.view.had_focus;
    for binding in BINDINGS.iter().filter(|binding| !focused || binding.shortcut.modifiers.command) {
        if ui.input_mut(|input| input.consume_shortcut(&binding.shortcut)) {
            (binding.run)(modeler);
        }
    }
}

fn escape(modeler: &mut Modeler) {
    if modeler.pad.is_empty() {
        modeler.select(None);
    } else {
        modeler.pad.clear();
    }
}
