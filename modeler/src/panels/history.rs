//! What was done, to be gone back to.

use crate::modeler::Modeler;
use egui::{CollapsingHeader, RichText, Ui};

/// Most steps shown in each direction.
const SHOWN: usize = 60;

/// Shows it, the latest first.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let document = modeler.bench.document();
    let done = document.undo_names().count();
    // Steps of the same name are told apart by their numbers.
    let numbered = |number: usize, name: &str| format!("{number}. {name}");
    let forward: Vec<String> = document
        .redo_names()
        .take(SHOWN)
        .zip(done + 1..)
        .map(|(name, number)| numbered(number, name))
        .collect();
    let back: Vec<String> =
        document.undo_names().take(SHOWN).enumerate().map(|(ago, name)| numbered(done - ago, name)).collect();
    let mut go = None;
    CollapsingHeader::new("History").default_open(true).show(ui, |ui| {
        for (i, name) in forward.iter().enumerate().rev() {
            if ui.button(RichText::new(name).weak()).on_hover_text("Go forward to here").clicked() {
                go = Some(-(i as isize) - 1);
            }
        }
        for (i, name) in back.iter().enumerate() {
            let button = egui::Button::selectable(i == 0, name);
            if ui.add(button).on_hover_text("Go back to here").clicked() {
                go = Some(i as isize);
            }
        }
        if done > back.len() {
            ui.weak(format!("and {} earlier steps", done - back.len()));
        }
        if ui.add(egui::Button::selectable(done == 0, "The beginning")).clicked() {
            go = Some(done as isize);
        }
    });
    if let Some(steps) = go.filter(|steps| *steps != 0) {
        modeler.go_back(steps);
    }
}
