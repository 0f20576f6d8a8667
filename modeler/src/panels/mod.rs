//! Everything around the model view.

mod bar;
mod edit;
mod history;
mod parameters;
pub(crate) mod recent;
mod several;
mod status;
mod tree;
mod variants;

pub use tree::{rule, title};

use crate::modeler::Modeler;
use egui::{Panel, ScrollArea, Ui};

/// Shows the bar above, the tree and the parameters at the sides, and a line below.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    Panel::top("bar").show(ui, |ui| bar::show(modeler, ui));
    Panel::bottom("status").show(ui, |ui| status::show(modeler, ui));
    let left_handed = modeler.settings.left_handed;
    let side = |id: &'static str, left: bool| if left { Panel::left(id) } else { Panel::right(id) };
    side("tree", !left_handed)
        .default_size(230.0)
        .size_range(160.0..=420.0)
        .show(ui, |ui| tree::show(modeler, ui));
    side("parameters", left_handed).default_size(250.0).size_range(200.0..=420.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            parameters::show(modeler, ui);
            ui.add_space(8.0);
            history::show(modeler, ui);
            ui.add_space(8.0);
            variants::show(modeler, ui);
        });
    });
}
