//! Several selected parts: which they are, and what can be done with all of them.

use super::color;
use super::edit;
use super::tree::title;
use crate::modeler::Modeler;
use blobtree::{Color, Command, STONE};
use egui::{Layout, Ui};

/// Most parts that are named.
const MOST_NAMES: usize = 12;

/// Shows it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let root = modeler.bench.shown().root.clone();
    let nodes: Vec<_> = modeler.bench.selection().iter().filter_map(|path| path.find(&root)).collect();
    ui.strong(format!("{} parts selected", nodes.len()));
    for node in nodes.iter().take(MOST_NAMES) {
        ui.label(title(node));
    }
    if nodes.len() > MOST_NAMES {
        ui.weak(format!("and {} more", nodes.len() - MOST_NAMES));
    }
    ui.separator();
    let color = nodes.iter().find_map(|node| node.color).unwrap_or(STONE).0;
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        if let Some(color) = color::choose(ui, label.id, color) {
            modeler.try_each(|path| Command::SetColor { path, color: Some(Color(color)) });
        }
    });
    ui.separator();
    let chosen =
        ui.with_layout(Layout::top_down_justified(egui::Align::Min), |ui| edit::parts(modeler, ui)).inner;
    if let Some(act) = chosen {
        act(modeler);
    }
}
