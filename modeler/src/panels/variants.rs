//! States of the document side by side: to be switched between, and to take parts from.

use super::title;
use crate::modeler::Modeler;
use crate::portraits::SIZE;
use crate::variants::Vary;
use blobtree::NodeRef;
use egui::{Button, CollapsingHeader, Image, TextEdit, Ui, vec2};

/// The width of a picture, points.
const WIDE: f32 = 56.0;

/// What the user wants of them.
enum Wish {
    Vary(Vary),
    Take(NodeRef),
}

/// Shows them.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let mut wish = None;
    CollapsingHeader::new("Variants").default_open(false).show(ui, |ui| {
        let variants: Vec<(String, NodeRef, bool)> = modeler
            .bench
            .variants()
            .all()
            .map(|(name, root, is_now)| (name.to_owned(), root.clone(), is_now))
            .collect();
        if variants.len() == 1 {
            ui.weak("Keep the model as it is, and try something else in a copy.");
        } else {
            let roots: Vec<NodeRef> = variants.iter().map(|(_, root, _)| root.clone()).collect();
            let pictures = modeler.portraits(&roots, ui.ctx());
            for ((name, root, is_now), picture) in variants.iter().zip(pictures) {
                ui.push_id(name, |ui| {
                    ui.horizontal(|ui| {
                        let size = vec2(WIDE, WIDE * SIZE[1] as f32 / SIZE[0] as f32);
                        match picture {
                            Some(texture) => ui.add(Image::new((texture.id(), size))),
                            None => ui.allocate_response(size, egui::Sense::hover()),
                        };
                        ui.vertical(|ui| wish = wish.take().or(variant(ui, name, root, *is_now)));
                    });
                });
            }
        }
        let new = ui.button("New variant").on_hover_text("Keeps this one as it is, and goes on in a copy");
        if new.clicked() {
            wish = Some(Wish::Vary(Vary::Keep { name: modeler.bench.variants().free_name() }));
        }
    });
    match wish {
        Some(Wish::Vary(vary)) => modeler.vary(vary),
        Some(Wish::Take(node)) => take(modeler, node),
        None => {}
    }
}

fn variant(ui: &mut Ui, name: &str, root: &NodeRef, is_now: bool) -> Option<Wish> {
    let mut wish = None;
    if is_now {
        let id = ui.scope_id().with("name");
        let mut text = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| name.into());
        let field =
            ui.add(TextEdit::singleline(&mut text).desired_width(130.0)).accessible_name("Variant's name");
        if field.lost_focus() && text != name {
            wish = Some(Wish::Vary(Vary::Rename { name: name.into(), to: text.clone() }));
        }
        if field.has_focus() {
            ui.data_mut(|data| data.insert_temp(id, text));
        } else {
            ui.data_mut(|data| data.remove::<String>(id));
        }
        ui.weak("in hand");
        return wish;
    }
    if ui.add(Button::new(name)).on_hover_text("Take this one in hand").clicked() {
        wish = Some(Wish::Vary(Vary::Switch { name: name.into() }));
    }
    ui.horizontal(|ui| {
        ui.menu_button("Take a part", |ui| {
            for part in root.children() {
                if ui.button(title(part)).clicked() {
                    wish = Some(Wish::Take(part.clone()));
                    ui.close();
                }
            }
        });
        let remove = ui.small_button("Remove").on_hover_text("Throw this variant away, with its history");
        if remove.clicked() {
            wish = Some(Wish::Vary(Vary::Remove { name: name.into() }));
        }
    });
    wish
}

/// Puts a part of another variant among those of this one.
fn take(modeler: &mut Modeler, node: NodeRef) {
    let root = &modeler.bench.scene().root;
    let (command, path) = crate::modeler::added(root, node);
    if modeler.apply(command) {
        modeler.select(Some(path));
    }
}
