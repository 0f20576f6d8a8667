//! Files worked on lately, with their pictures.

use crate::kept::PICTURE;
use crate::modeler::{How, Modeler};
use egui::{Button, Grid, Image, Ui, vec2};
use std::path::PathBuf;

/// The width of a picture on the welcome page, points.
const WIDE: f32 = 92.0;

/// The width of one in the menu, points.
const NARROW: f32 = 44.0;

/// Most on the welcome page, and how many side by side.
const WELCOME: [usize; 2] = [6, 3];

/// As a menu.
pub fn menu(modeler: &mut Modeler, ui: &mut Ui) {
    let mut chosen = None;
    for place in 0..modeler.kept.recent.len() {
        chosen = chosen.or(file(modeler, ui, place, NARROW));
    }
    let gone: Vec<PathBuf> = modeler
        .kept
        .recent
        .iter()
        .filter(|recent| !recent.is_there)
        .map(|recent| recent.file.clone())
        .collect();
    if !gone.is_empty() {
        ui.separator();
        if ui.button("Forget those that are gone").clicked() {
            gone.iter().for_each(|file| modeler.kept.forget(file));
        }
    }
    open(modeler, ui, chosen);
}

/// The latest, on the welcome page.
pub fn welcome(modeler: &mut Modeler, ui: &mut Ui) {
    let [most, columns] = WELCOME;
    let count = modeler.kept.recent.len().min(most);
    if count == 0 {
        return;
    }
    ui.label("Go on with");
    let mut chosen = None;
    Grid::new("recent").spacing([6.0, 6.0]).show(ui, |ui| {
        for place in 0..count {
            chosen = chosen.take().or(file(modeler, ui, place, WIDE));
            if (place + 1) % columns == 0 {
                ui.end_row();
            }
        }
    });
    open(modeler, ui, chosen);
}

fn open(modeler: &mut Modeler, ui: &Ui, chosen: Option<PathBuf>) {
    if let Some(file) = chosen {
        modeler.fetch(file, How::Instead);
        ui.close();
    }
}

/// A button for a file, grey if that is gone; the file, if it was pressed.
fn file(modeler: &mut Modeler, ui: &mut Ui, place: usize, width: f32) -> Option<PathBuf> {
    let recent = &mut modeler.kept.recent[place];
    let size = vec2(width, width * PICTURE[1] as f32 / PICTURE[0] as f32);
    let texture = recent.texture(ui.ctx()).map(|texture| Image::new((texture.id(), size)));
    let name = recent.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_wide = width == WIDE;
    let response = ui.add_enabled_ui(recent.is_there, |ui| {
        if is_wide {
            ui.vertical(|ui| {
                let button = match texture {
                    Some(image) => ui.add(Button::image(image)),
                    None => ui.add_sized(size, Button::new("")),
                };
                ui.set_max_width(size.x + 8.0);
                ui.add(egui::Label::new(egui::RichText::new(&name).small()).truncate());
                button
            })
            .inner
        } else {
            match texture {
                Some(image) => ui.add(Button::image_and_text(image, &name)),
                None => ui.button(&name),
            }
        }
    });
    let button = response.inner.on_hover_text(recent.file.display().to_string());
    let button = button.on_disabled_hover_text(format!("{} is gone", recent.file.display()));
    let is_enabled = recent.is_there;
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_enabled, &name));
    button.clicked().then(|| recent.file.clone())
}
