//! The names of files, and how meshes are written.

use super::{Dialog, Then};
use crate::desk::{ExportOptions, Purpose};
use crate::modeler::{How, Modeler};
use egui::{Checkbox, DragValue, Grid, Key, Ui};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The width of the field for a name, points.
const WIDTH: f32 = 460.0;

/// What is around it in a narrow window, points.
const MARGINS: f32 = 60.0;

/// The formats of meshes: their endings, and what they are good for.
const FORMATS: [(&str, &str); 4] = [
    ("3mf", "For slicers; it has a unit, and carries the scene along"),
    ("stl", "For everything that prints; triangles alone, millimetres"),
    ("obj", "For other modelers; text"),
    ("ply", "For programs that measure and scan"),
];

/// Takes the file that was chosen in the system's window, if one was.
pub fn take_browsed(modeler: &mut Modeler) {
    if let Some(Some(file)) = modeler.desk.browsed()
        && let Some(Dialog::File { purpose, then, .. }) =
            modeler.dialog.take_if(|dialog| matches!(dialog, Dialog::File { .. }))
    {
        take(modeler, purpose, file, then);
    }
}

/// Asks for a name.
pub fn show(
    modeler: &mut Modeler,
    ui: &mut Ui,
    purpose: Purpose,
    mut text: String,
    then: Option<Then>,
) -> Option<Dialog> {
    let (what, word) = match purpose {
        Purpose::Open => {
            ("A scene (.trullo), a mesh (.stl, .obj, .ply, .3mf) or a drawing (.svg, .json, .ndjson)", "Open")
        }
        Purpose::Add => ("A scene (.trullo), a mesh (.stl, .obj, .ply, .3mf) or a drawing", "Add"),
        Purpose::Save => ("The scene's file (.trullo)", "Save"),
        Purpose::Export => ("The mesh's file", "Export"),
    };
    let label = ui.label(what);
    let field = ui
        .add(
            egui::TextEdit::singleline(&mut text)
                .desired_width(WIDTH.min(ui.ctx().content_rect().width() - MARGINS)),
        )
        .labelled_by(label.id);
    let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if purpose == Purpose::Export {
        formats(ui, &mut text);
        options(ui, &mut modeler.settings.export, &ending(&text));
    }
    let (mut taken, mut stays) = (entered, true);
    ui.horizontal(|ui| {
        taken |= ui.button(word).clicked();
        if ui.button("Browse…").clicked() {
            let ctx = ui.ctx().clone();
            let folder = modeler.last_folder();
            if !modeler.desk.browse(purpose, folder.as_deref(), Arc::new(move || ctx.request_repaint())) {
                modeler.notices.tell("This system has no window for files; type the name.");
            }
        }
        stays = !ui.button("Cancel").clicked();
    });
    if taken && !text.trim().is_empty() {
        take(modeler, purpose, PathBuf::from(text.trim()), then);
        return None;
    }
    stays.then_some(Dialog::File { purpose, text, then })
}

fn ending(text: &str) -> String {
    Path::new(text.trim()).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// The format is the ending of the name.
fn formats(ui: &mut Ui, text: &mut String) {
    let now = ending(text);
    ui.horizontal(|ui| {
        for (format, help) in FORMATS {
            let name = format.to_uppercase();
            if ui.radio(now == format, name).on_hover_text(help).clicked() {
                *text = Path::new(text.trim()).with_extension(format).display().to_string();
            }
        }
    });
}

fn options(ui: &mut Ui, options: &mut ExportOptions, format: &str) {
    Grid::new("options").num_columns(2).show(ui, |ui| {
        let label = ui.label("Fineness").on_hover_text("How wide a cell is: smaller details can get lost");
        ui.horizontal(|ui| {
            let mut fits = options.cell_mm.is_none();
            if ui.checkbox(&mut fits, "As the shape needs it").changed() {
                options.cell_mm = (!fits).then_some(0.25);
            }
            if let Some(cell) = &mut options.cell_mm {
                let drag = DragValue::new(cell).range(ExportOptions::CELLS).speed(0.005).suffix(" mm");
                ui.add(drag).labelled_by(label.id);
            }
        });
        ui.end_row();
        let label = ui
            .label("Fewer triangles")
            .on_hover_text("Leaves out triangles while the surface moves by no more than this; 0 keeps all");
        let drag = DragValue::new(&mut options.tolerance_mm)
            .range(ExportOptions::TOLERANCES)
            .speed(0.001)
            .custom_formatter(|mm, _| if mm > 0.0 { format!("{mm:.3} mm") } else { "keep all".into() });
        ui.add(drag).labelled_by(label.id);
        ui.end_row();
        match format {
            "3mf" => {
                ui.label("");
                ui.add(Checkbox::new(&mut options.carries_scene, "Carry the scene along"))
                    .on_hover_text("So that the file can be opened here and changed");
                ui.end_row();
            }
            "stl" => {
                ui.label("");
                ui.add(Checkbox::new(&mut options.as_text, "As text"))
                    .on_hover_text("Five times as large; for programs that read nothing else");
                ui.end_row();
            }
            _ => {}
        }
    });
}

fn take(modeler: &mut Modeler, purpose: Purpose, mut file: PathBuf, then: Option<Then>) {
    match purpose {
        Purpose::Open => modeler.fetch(file, How::Instead),
        Purpose::Add => modeler.fetch(file, How::Beside),
        Purpose::Save => {
            if file.extension().is_none() {
                file.set_extension("trullo");
            }
            modeler.save_to(file, then);
        }
        Purpose::Export => {
            if file.extension().is_none() {
                file.set_extension("3mf");
            }
            modeler.export_to(file);
        }
    }
}
