//! Whether something that was dropped is added to what is there, or takes its place.

use super::Dialog;
use crate::modeler::{Fetched, Modeler};
use egui::Ui;

/// Asks.
pub fn show(modeler: &mut Modeler, ui: &mut Ui, fetched: Box<Fetched>) -> Option<Dialog> {
    ui.label(format!("There is a model on the table. What is to become of {}?", fetched.name()));
    ui.horizontal(|ui| {
        let add = ui.button("Add").on_hover_text("Put it beside the model; undo takes it away again");
        if add.clicked() {
            modeler.add(*fetched);
        } else if ui.button("Open instead").on_hover_text("Put the model away").clicked() {
            modeler.open_instead(*fetched);
        } else if !ui.button("Cancel").clicked() {
            return Some(Dialog::Arrival(fetched));
        }
        None
    })
    .inner
}
