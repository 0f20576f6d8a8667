//! The line below: what is on the table, and what is going on.

use crate::modeler::Modeler;
use egui::{Layout, Ui};

/// Shows it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let name = modeler.bench.file().and_then(|file| file.file_name()).map(|name| name.to_string_lossy());
        let mark = if modeler.bench.is_unsaved() { " (not saved)" } else { "" };
        ui.label(format!("{}{mark}", name.unwrap_or_else(|| "New page".into())));
        if !modeler.bench.is_protected() {
            ui.colored_label(ui.visuals().warn_fg_color, "not protected against a crash");
        }
        if modeler.solid().is_some_and(|solid| solid.unconstrained > 0) {
            ui.weak("support-free parts are still shown as drawn");
        }
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
            let Some(solid) = modeler.solid() else { return };
            let size = solid.bounds.size();
            if !solid.bounds.is_empty() {
                ui.label(format!("{:.1} × {:.1} × {:.1} mm", size.x, size.y, size.z));
                let triangles = solid.corners.len() / 3;
                ui.weak(format!("{triangles} triangles in {:.0} ms", solid.took.as_secs_f64() * 1e3));
            }
            if !modeler.is_at_rest() {
                ui.spinner();
            }
        });
    });
}
