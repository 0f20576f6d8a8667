//! Keys and gestures, to be read.

use super::Dialog;
use crate::keys::BINDINGS;
use egui::{Grid, Ui};

/// Strokes that are commands.
const GESTURES: [(&str, &str); 7] = [
    ("Scribble over a stroke", "rub it out"),
    ("Scribble over what is selected", "remove it"),
    ("Circle twice around a stroke", "make it smoother"),
    ("Quick stroke to the left", "undo"),
    ("Line straight up", "select the parent"),
    ("Tap with Shift or Ctrl", "select several"),
    ("Stroke across a button", "press it"),
];

/// Shows them.
pub fn show(ui: &mut Ui) -> Option<Dialog> {
    ui.strong("With the pen");
    Grid::new("gestures").num_columns(2).striped(true).show(ui, |ui| {
        for (gesture, meaning) in GESTURES {
            ui.label(gesture);
            ui.label(meaning);
            ui.end_row();
        }
    });
    ui.separator();
    ui.strong("With the keyboard");
    Grid::new("keys").num_columns(4).striped(true).show(ui, |ui| {
        for pair in BINDINGS.chunks(2) {
            for binding in pair {
                ui.label(ui.ctx().format_shortcut(&binding.shortcut));
                ui.label(binding.help);
            }
            ui.end_row();
        }
    });
    (!ui.button("Close").clicked()).then_some(Dialog::Help)
}
