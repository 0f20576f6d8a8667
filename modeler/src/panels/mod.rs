//! Everything around the model view.

mod bar;
mod color;
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
use crate::view::suggestions;
use egui::{Panel, ScrollArea, Ui};

/// The least width of a window with panels on both sides of the view, points.
const BOTH_SIDES: f32 = 880.0;

/// The least width of one with panels on one side, unless the user wants them there.
const ONE_SIDE: f32 = 600.0;

/// The share of a panel's height that the tree has above the parameters.
const TREE_SHARE: f32 = 0.38;

/// Shows the bar above, the tree and the parameters at the sides, and a line below.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    parameters::finish(modeler, ui);
    let width = ui.available_width();
    let has_panels = modeler.view.panels.unwrap_or(width >= ONE_SIDE);
    suggestions::find_place(modeler, has_panels);
    Panel::top("bar").show(ui, |ui| bar::show(modeler, ui, has_panels));
    Panel::bottom("status").show(ui, |ui| status::show(modeler, ui));
    if !has_panels {
        let strip = Panel::bottom("strip").exact_size(suggestions::strip_height(ui));
        strip.show(ui, |ui| suggestions::strip(modeler, ui));
        modeler.show_parts(Vec::new(), ui.ctx());
        return;
    }
    let left_handed = modeler.settings.left_handed;
    let side = |id: &'static str, left: bool| if left { Panel::left(id) } else { Panel::right(id) };
    if width >= BOTH_SIDES {
        side("tree", !left_handed)
            .default_size(230.0)
            .size_range(160.0..=420.0)
            .show(ui, |ui| tree::show(modeler, ui));
        side("parameters", left_handed)
            .default_size(250.0)
            .size_range(200.0..=420.0)
            .show(ui, |ui| of_selection(modeler, ui));
        return;
    }
    side("both", left_handed).default_size(236.0).size_range(200.0..=300.0).show(ui, |ui| {
        if suggestions::are_docked(modeler) {
            suggestions::above(modeler, ui);
            tree::show(modeler, ui);
            return;
        }
        let tree = TREE_SHARE * ui.available_height();
        Panel::top("tree above").exact_size(tree).show(ui, |ui| tree::show(modeler, ui));
        of_selection(modeler, ui);
    });
}

/// What there is to say about what is selected, and about the document.
fn of_selection(modeler: &mut Modeler, ui: &mut Ui) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        suggestions::above(modeler, ui);
        parameters::show(modeler, ui);
        ui.add_space(8.0);
        history::show(modeler, ui);
        ui.add_space(8.0);
        variants::show(modeler, ui);
    });
}
