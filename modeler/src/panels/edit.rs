//! What can be done with the selected parts, as a menu: in the bar, and beside a part of the tree.

use super::bar::entry;
use super::tree::operators;
use crate::modeler::Modeler;
use blobtree::{Command, Node, NodePath};
use egui::Ui;

/// What is to be done.
pub type Act = Box<dyn FnOnce(&mut Modeler)>;

/// Shows the menu of the bar.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let (mut undo, mut redo) = (false, false);
    undo |= ui.add(entry("Undo", "Ctrl+Z")).clicked();
    redo |= ui.add(entry("Redo", "Ctrl+Y")).clicked();
    ui.separator();
    if undo {
        modeler.undo();
    } else if redo {
        modeler.redo();
    } else if let Some(act) = parts(modeler, ui) {
        act(modeler);
    }
}

/// Shows what can be done with the selected parts; what is chosen of it.
pub fn parts(modeler: &Modeler, ui: &mut Ui) -> Option<Act> {
    let (root, selection) = (&modeler.bench.scene().root, modeler.bench.selection());
    let nodes = || selection.iter().filter_map(|path| path.find(root));
    let all = |is: fn(&Node) -> bool| nodes().all(|node| is(node));
    let mut chosen: Option<Act> = None;
    ui.add_enabled_ui(!selection.is_empty(), |ui| {
        let mut item = |ui: &mut Ui, text: &str, keys: &str, act: fn(&mut Modeler)| {
            if ui.add(entry(text, keys)).accessible_name(text).clicked() {
                chosen = Some(Box::new(act));
            }
        };
        item(ui, "Duplicate", "Ctrl+D", Modeler::duplicate_selected);
        item(ui, "Mirror to the other side", "M", Modeler::mirror_selected);
        item(ui, "Put on the ground", "G", Modeler::ground_selected);
        let muted = all(|node| node.muted) && !selection.is_empty();
        item(ui, if muted { "Unmute" } else { "Mute" }, "Ctrl+M", Modeler::mute_selected);
        let drawn_on = all(|node| node.construction) && !selection.is_empty();
        let word = if drawn_on { "Part of the solid" } else { "Only to draw on" };
        item(ui, word, "", Modeler::construct_selected);
        item(ui, "Put together", "Ctrl+G", |m| m.group_selected(blobtree::Operator::Union));
        item(ui, "Select the parent", "P", Modeler::select_parent);
        item(ui, "Remove", "Delete", Modeler::remove_selected);
        ui.menu_button("Put into", |ui| {
            for (name, operator) in operators() {
                if ui.button(name).clicked() {
                    chosen = Some(Box::new(move |m| m.group_selected(operator)));
                }
            }
        });
        let wrapper = nodes().next().filter(|node| selection.len() == 1 && node.children().len() == 1);
        if let (Some(_), [path]) = (wrapper, selection)
            && ui.button("Take out of here").clicked()
        {
            let path: NodePath = path.clone();
            chosen = Some(Box::new(move |m| {
                m.apply(Command::Unwrap { path });
            }));
        }
    });
    if chosen.is_some() {
        ui.close();
    }
    chosen
}
