//! All keys, strokes and touches, to be read.

use crate::keys::BINDINGS;
use egui::{Grid, Key, KeyboardShortcut, Ui};

/// The least width of a window with two entries on each line, points.
const TWO: f32 = 760.0;

/// Strokes that are commands.
const STROKES: [(&str, &str); 6] = [
    ("Scribble over a stroke", "rub it out"),
    ("Scribble over what is selected", "remove it"),
    ("Circle twice around a stroke", "make it smoother"),
    ("Quick stroke to the left", "take back the last stroke"),
    ("Quick line straight up", "select the parent"),
    ("Stroke across a button", "press it"),
];

/// What else pens, hands and mice do in the view.
const TOUCHES: [(&str, &str); 14] = [
    ("Tap", "select a part"),
    ("Tap again", "the next part there"),
    ("Tap with Shift or Ctrl", "select several"),
    ("Tap beside the model", "select nothing"),
    ("Ctrl while dragging", "do not snap"),
    ("Eraser end of the pen", "rub out"),
    ("Button on the pen", "turn the model"),
    ("Space and drag", "turn the model"),
    ("Tap of two fingers", "undo"),
    ("Tap of three fingers", "do again"),
    ("Two fingers", "move and size the view"),
    ("Three fingers", "turn the model"),
    ("Wheel", "make the view larger or smaller"),
    ("Shift and wheel", "move the view"),
];

/// Shows them; whether they are to stay.
pub fn show(ui: &mut Ui) -> bool {
    crate::dialog::scrolled(ui, |ui| {
        table(ui, "Strokes that are commands", &STROKES.map(|(what, does)| (what.to_owned(), does)));
        table(ui, "In the view", &TOUCHES.map(|(what, does)| (what.to_owned(), does)));
        let keys: Vec<_> =
            BINDINGS.iter().map(|binding| (name(ui, &binding.shortcut), binding.help)).collect();
        table(ui, "With the keyboard", &keys);
        ui.weak("Tab goes from control to control, Space presses one, Escape lets go of it.");
    });
    !ui.button("Close").clicked()
}

/// Two entries on each line, where there is room.
fn table(ui: &mut Ui, title: &str, entries: &[(String, &str)]) {
    ui.strong(title);
    Grid::new(title).num_columns(4).striped(true).show(ui, |ui| {
        for pair in entries.chunks(if ui.ctx().content_rect().width() < TWO { 1 } else { 2 }) {
            for (what, does) in pair {
                ui.label(what);
                ui.label(*does);
            }
            ui.end_row();
        }
    });
    ui.add_space(6.0);
}

/// A key as it is written on keyboards.
fn name(ui: &Ui, shortcut: &KeyboardShortcut) -> String {
    let text = ui.ctx().format_shortcut(shortcut);
    match shortcut.logical_key {
        Key::Questionmark => text.replace("Questionmark", "?"),
        Key::Plus => text.replace("Plus", "+"),
        Key::Minus => text.replace("Minus", "−"),
        _ => text,
    }
}
