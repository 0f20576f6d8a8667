//! The parameters of the selected node: its name, its colour, how it is combined, and all its numbers.

use super::color;
use super::several;
use super::tree::{operators, title};
use crate::cutting::Cut;
use crate::form::{Field, Form, Kind, numbers};
use crate::modeler::Modeler;
use blobtree::{Color, Command, NewShape, NodePath, NodeRef, Shape};
use egui::{ComboBox, DragValue, Grid, Response, TextEdit, Ui};
use serde_json::{Value, json};

/// How far a field is dragged for its value to change by a hundredth of itself, points.
const SPEED: f64 = 0.01;

/// What a field wants: a value to be shown while it is dragged, or to be kept.
struct Wish {
    field: usize,
    value: Value,
    is_final: bool,
}

/// Does what was shown while a name was typed or a colour was looked for, as soon as that has come to an end: each is
/// one step, however many letters and colours there were on the way.
pub fn finish(modeler: &mut Modeler, ui: &Ui) {
    let is_named = |command: &Command| matches!(command, Command::SetName { .. });
    let Some(command) = modeler.bench.dragged() else { return };
    let goes_on = match command {
        command if is_named(command) => ui.ctx().text_edit_focused(),
        command if colors(command) => ui.input(|input| input.pointer.any_down()),
        _ => true,
    };
    if !goes_on {
        let command = command.clone();
        modeler.apply(command);
    }
}

/// Whether a command gives parts a colour.
fn colors(command: &Command) -> bool {
    match command {
        Command::SetColor { .. } => true,
        Command::Together(commands) => commands.iter().all(colors),
        _ => false,
    }
}

/// Shows them.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let Some(path) = modeler.bench.selected().cloned() else {
        if modeler.bench.selection().is_empty() {
            ui.strong("Nothing selected");
            ui.weak("Tap a part of the model, or choose one in the tree.");
        } else {
            several::show(modeler, ui);
        }
        return;
    };
    let Some(node) = path.find(&modeler.bench.shown().root).cloned() else { return };
    ui.strong(title(&node));
    let (tried, mut command) = about(ui, &node, &path);
    command = command.or_else(|| combined(modeler, ui, &path));
    command = command.or_else(|| cut(modeler, ui));
    if let Some(command) = tried {
        modeler.try_out(command, false);
    }
    refresh_form(modeler, &path);
    let is_through = modeler.selected_cut().is_some_and(Cut::is_through);
    let wish = modeler.form.as_ref().and_then(|(_, form)| fields(ui, form, is_through));
    if let Some(command) = command {
        modeler.apply(command);
    }
    if let Some(wish) = wish {
        grant(modeler, wish);
    }
}

/// Name, colour, and whether it is heard: what is to be shown while it goes on, see [`finish`], and what is to be done.
fn about(ui: &mut Ui, node: &NodeRef, path: &NodePath) -> (Option<Command>, Option<Command>) {
    let (mut tried, mut command) = (None, None);
    Grid::new("about").num_columns(2).show(ui, |ui| {
        let label = ui.label("Name");
        let mut name = node.name.clone().unwrap_or_default();
        let field = ui.add(TextEdit::singleline(&mut name).desired_width(150.0)).labelled_by(label.id);
        if field.changed() {
            let name = Some(name).filter(|name| !name.is_empty());
            tried = Some(Command::SetName { path: path.clone(), name });
        }
        ui.end_row();
        let label = ui.label("Colour");
        ui.horizontal(|ui| {
            let color = node.color.unwrap_or(blobtree::STONE).0;
            if let Some(color) = color::choose(ui, label.id, color) {
                tried = Some(Command::SetColor { path: path.clone(), color: Some(Color(color)) });
            }
            if node.color.is_some()
                && ui.button("Inherit").on_hover_text("Take the colour of what is around").clicked()
            {
                command = Some(Command::SetColor { path: path.clone(), color: None });
            }
        });
        ui.end_row();
        ui.label("");
        let mut heard = !node.muted;
        if ui.checkbox(&mut heard, "Takes part").changed() {
            command = Some(Command::SetMuted { path: path.clone(), muted: !heard });
        }
        ui.end_row();
    });
    (tried, command)
}

/// How the selected operator, else the one above the selected node, combines.
fn combined(modeler: &Modeler, ui: &mut Ui, path: &NodePath) -> Option<Command> {
    let root = &modeler.bench.scene().root;
    let is_operator =
        |path: &NodePath| path.find(root).is_some_and(|node| matches!(node.shape, Shape::Operator(..)));
    let path = Some(path.clone()).filter(is_operator).or_else(|| path.parent().filter(is_operator))?;
    let node = path.find(root)?;
    let Shape::Operator(now, _) = &node.shape else { return None };
    let mut command = None;
    ui.horizontal(|ui| {
        let label = ui.label("Combined");
        let same = |a: &blobtree::Operator| std::mem::discriminant(a) == std::mem::discriminant(now);
        let text = operators().into_iter().find(|(_, operator)| same(operator)).map_or("", |(name, _)| name);
        let combo = ComboBox::from_id_salt("combined").selected_text(text).width(170.0);
        let combo = combo.show_ui(ui, |ui| {
            for (name, operator) in operators() {
                if ui.selectable_label(same(&operator), name).clicked() && !same(&operator) {
                    command =
                        Some(Command::SetShape { path: path.clone(), shape: NewShape::Operator(operator) });
                }
            }
        });
        combo.response.labelled_by(label.id);
    });
    command
}

/// Whether a hole goes through everything.
fn cut(modeler: &Modeler, ui: &mut Ui) -> Option<Command> {
    let path = crate::view::primitive_at(&modeler.bench.shown().root, modeler.bench.selected()?)?;
    let cut = modeler.selected_cut()?;
    let mut through = cut.is_through();
    let switch = ui.checkbox(&mut through, "Through everything");
    let help = "Off: the hole ends in the middle, and its length can be set";
    let shape = NewShape::Primitive(cut.going(through));
    switch.on_hover_text(help).changed().then_some(Command::SetShape { path, shape })
}

/// Makes the form anew if the node has changed.
fn refresh_form(modeler: &mut Modeler, path: &NodePath) {
    let shown = modeler.bench.shown();
    let is_of = |(root, form): &(NodeRef, Form)| NodeRef::ptr_eq(root, &shown.root) && form.path() == path;
    if !modeler.form.as_ref().is_some_and(is_of) {
        modeler.form = Form::of(shown, path).map(|form| (shown.root.clone(), form));
    }
}

/// All fields; without those that mean nothing to a hole through everything.
fn fields(ui: &mut Ui, form: &Form, is_through: bool) -> Option<Wish> {
    let mut wish = None;
    Grid::new("fields").num_columns(2).striped(true).show(ui, |ui| {
        let means_something = |field: &Field| !(is_through && ["Length", "Offset"].contains(&&*field.label));
        for (index, field) in form.fields.iter().enumerate().filter(|(_, field)| means_something(field)) {
            let label = ui.label(&field.label).on_hover_text(&field.help);
            ui.vertical(|ui| {
                if let Some((value, is_final)) = editor(ui, field, &label) {
                    wish = Some(Wish { field: index, value, is_final });
                }
            });
            ui.end_row();
        }
    });
    wish
}

/// The control for a field: a new value, and whether it is the last one of a drag.
fn editor(ui: &mut Ui, field: &Field, label: &Response) -> Option<(Value, bool)> {
    let mut wish = None;
    match &field.kind {
        Kind::Number { min, max } => {
            ui.horizontal(|ui| {
                if field.value.is_null() && field.is_optional && field.usual.is_null() {
                    ui.weak("by itself");
                    if ui.button("Set").on_hover_text(&field.help).clicked() {
                        wish = Some((json!(min.max(5.0).min(*max)), true));
                    }
                    return;
                }
                let mut number = field.value.as_f64().or(field.usual.as_f64()).unwrap_or_default();
                let response = ui.add(drag(&mut number, field.unit).range(*min..=*max)).labelled_by(label.id);
                wish = changed(&response, || json!(number));
                if field.is_optional && !field.value.is_null() && ui.button("Reset").clicked() {
                    wish = Some((Value::Null, true));
                }
            });
        }
        Kind::Vector(size) => {
            let now = if field.value.is_null() { &field.usual } else { &field.value };
            let mut all = numbers(now, *size);
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                for axis in 0..*size {
                    let name = format!("{} {}", field.label, ["x", "y", "z"][axis]);
                    let mut number = all[axis];
                    let response = ui.add(drag(&mut number, "")).accessible_name(name);
                    all[axis] = number;
                    wish = wish.take().or_else(|| changed(&response, || json!(all)));
                }
            });
        }
        Kind::Choice(words) => {
            let now = field.value.as_str().or(field.usual.as_str()).unwrap_or("by itself");
            let combo = ComboBox::from_id_salt(&field.label).selected_text(now).show_ui(ui, |ui| {
                for word in words {
                    if ui.selectable_label(word == now, word).clicked() {
                        wish = Some((json!(word), true));
                    }
                }
            });
            combo.response.labelled_by(label.id);
        }
    }
    wish
}

fn drag<'a>(number: &'a mut f64, unit: &'a str) -> DragValue<'a> {
    let speed = (number.abs() * SPEED).clamp(0.01, 10.0);
    DragValue::new(number).speed(speed).max_decimals(3).suffix(unit)
}

/// What a control says that was dragged or typed into.
fn changed(response: &Response, value: impl FnOnce() -> Value) -> Option<(Value, bool)> {
    let is_final = response.drag_stopped() || response.lost_focus();
    (response.changed() || is_final && response.drag_stopped()).then(|| (value(), !response.dragged()))
}

fn grant(modeler: &mut Modeler, wish: Wish) {
    let Some((_, form)) = &modeler.form else { return };
    let Some(field) = form.fields.get(wish.field) else { return };
    let file = modeler.bench.file().map(std::path::PathBuf::from);
    let command = {
        let sources = &mut *modeler.desk.sources(file.as_deref());
        form.with(field, wish.value, modeler.bench.shown(), sources)
    };
    match command {
        Ok(command) => modeler.try_out(command, wish.is_final),
        Err(error) => modeler.notices.tell(error.to_string()),
    }
}
