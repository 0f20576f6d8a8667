//! The bar above: files, undo, the pen's tools, and how the model is shown.

use super::edit;
use super::recent;
use crate::dialog::{Dialog, Then};
use crate::lesson::Lesson;
use crate::modeler::Modeler;
use crate::settings::{Habit, OVERHANGS, SCALES, Theme, Tool};
use crate::stage::Look;
use egui::{Button, ScrollArea, Ui, Widget as _};

/// Bars narrower than this have narrower buttons, so that more of them stand on a line, points.
const ROOMY: f32 = 880.0;

/// Between a menu and the lower edge of the window, points.
const MARGIN: f32 = 16.0;

/// Shows it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui, has_panels: bool) {
    ui.horizontal_wrapped(|ui| {
        let beside = if ui.available_width() < ROOMY { 6.0 } else { 9.0 };
        ui.spacing_mut().button_padding = egui::vec2(beside, 5.0);
        menu(ui, "File", |ui| files(modeler, ui));
        menu(ui, "Edit", |ui| edit::show(modeler, ui));
        menu(ui, "View", |ui| view(modeler, ui));
        ui.separator();
        let undo = modeler.bench.document().undo_names().next().map(str::to_owned);
        let can_undo = undo.is_some() || !modeler.pad.is_empty();
        let help = undo.map_or_else(|| "Undo the last stroke".into(), |name| format!("Undo: {name}"));
        if ui.add_enabled(can_undo, Button::new("Undo")).on_hover_text(help).clicked() {
            modeler.undo();
        }
        let redo = modeler.bench.document().redo_names().next().map(|name| format!("Redo: {name}"));
        let button = ui.add_enabled(redo.is_some(), Button::new("Redo"));
        if button.on_hover_text(redo.unwrap_or_default()).clicked() {
            modeler.redo();
        }
        ui.separator();
        for tool in Tool::ALL {
            let button = Button::selectable(modeler.settings.tool == tool, tool.name()).ui(ui);
            if button.on_hover_text(tool.help()).clicked() {
                modeler.settings.tool = tool;
            }
        }
        ui.separator();
        if ui.button("Export").on_hover_text("Write a mesh for printing (Ctrl+E)").clicked() {
            Dialog::begin_export(modeler);
        }
        if ui.button("Lessons").on_hover_text("Three short lessons on your own page").clicked() {
            modeler.lesson = Some(Lesson::FIRST);
        }
        let panels = ui.add(Button::selectable(has_panels, "Panels"));
        if panels.on_hover_text("Parts and parameters at the sides of the view, or more room").clicked() {
            modeler.view.panels = Some(!has_panels);
        }
        if ui.button("?").on_hover_text("Keys and gestures").clicked() {
            modeler.dialog = Some(Dialog::Help);
        }
    });
}

/// A menu that can be scrolled where the window is too low for it.
fn menu(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    ui.menu_button(title, |ui| {
        let height = (ui.ctx().content_rect().bottom() - ui.cursor().top() - MARGIN).max(MARGIN);
        ScrollArea::vertical().max_height(height).show(ui, content);
    });
}

/// A line of a menu, with its keys if it has some.
pub(super) fn entry<'a>(text: &'a str, keys: &'a str) -> Button<'a> {
    let button = Button::new(text);
    if keys.is_empty() { button } else { button.shortcut_text(keys) }
}

/// A line of the menu that is always there.
fn item(modeler: &mut Modeler, ui: &mut Ui, text: &str, keys: &str, run: fn(&mut Modeler)) {
    if ui.add(entry(text, keys)).clicked() {
        run(modeler);
        ui.close();
    }
}

fn files(modeler: &mut Modeler, ui: &mut Ui) {
    item(modeler, ui, "New page", "Ctrl+N", Dialog::begin_new);
    item(modeler, ui, "Examples…", "", |m| m.dialog = Some(Dialog::Examples));
    item(modeler, ui, "Open…", "Ctrl+O", Dialog::begin_open);
    if !modeler.kept.recent.is_empty() {
        ui.menu_button("Open again", |ui| recent::menu(modeler, ui));
    }
    item(modeler, ui, "Add…", "", Dialog::begin_add);
    ui.separator();
    item(modeler, ui, "Save", "Ctrl+S", |m| Dialog::begin_save(m, false, None));
    item(modeler, ui, "Save as…", "Ctrl+Shift+S", |m| Dialog::begin_save(m, true, None));
    item(modeler, ui, "Export…", "Ctrl+E", Dialog::begin_export);
    ui.separator();
    item(modeler, ui, "Quit", "", |m| Dialog::begin(m, Then::Quit));
}

fn view(modeler: &mut Modeler, ui: &mut Ui) {
    let mut has_lens = modeler.lens.is_some();
    let lens = ui.checkbox(&mut has_lens, "Field lens");
    if lens.on_hover_text("A plane through the model that shows the field and who makes it (L)").changed() {
        modeler.toggle_lens();
    }
    ui.separator();
    let settings = &mut modeler.settings;
    for look in Look::ALL {
        ui.radio_value(&mut settings.look, look, look.name());
    }
    ui.separator();
    ui.checkbox(&mut settings.shows_overhang, "Tint overhangs");
    let label = ui.label("leaning out by more than");
    let angle = egui::DragValue::new(&mut settings.overhang).range(OVERHANGS).suffix("°").ui(ui);
    angle.labelled_by(label.id);
    ui.checkbox(&mut settings.shows_seams, "Seams between parts")
        .on_hover_text("Lines where parts meet: teal blended, orange cut, violet shared, blue side by side");
    ui.checkbox(&mut settings.shows_ground, "Ground and printer's room");
    ui.checkbox(&mut settings.snaps, "Snap while dragging").on_hover_text(
        "Parts come to rest on the bed, in the middle, and on whole steps; Ctrl lets them free",
    );
    ui.checkbox(&mut settings.left_handed, "For left-handed people");
    ui.separator();
    ui.menu_button("Mouse", |ui| {
        for habit in Habit::ALL {
            ui.radio_value(&mut settings.habit, habit, habit.name());
        }
    });
    ui.menu_button("Light and dark", |ui| {
        for theme in Theme::ALL {
            ui.radio_value(&mut settings.theme, theme, theme.name());
        }
    });
    let label = ui.label("Size of everything");
    let scale = egui::DragValue::new(&mut settings.scale).range(SCALES).speed(0.01);
    scale.ui(ui).labelled_by(label.id);
}
