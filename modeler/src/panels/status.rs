//! The line below: what is on the table, and what is going on.

use crate::errand::{Progress, STOPPING};
use crate::modeler::Modeler;
use egui::{Button, Layout, ProgressBar, Ui};
use std::time::Duration;

/// How often progress is shown anew.
const TICK: Duration = Duration::from_millis(100);

/// The width of a bar, points.
const BAR: f32 = 110.0;

/// The least width of a window in which all is on one line, points.
const ONE_LINE: f32 = 880.0;

/// The room that the size of the model takes, and that with the number of triangles, points.
const SIZE: f32 = 170.0;
const SIZE_AND_TRIANGLES: f32 = 350.0;

/// Shows it; in narrow windows as two lines, if something is being read or written.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    let is_wide = ui.available_width() >= ONE_LINE;
    if !is_wide && !modeler.errands.is_empty() {
        ui.horizontal_wrapped(|ui| errands(modeler, ui));
    }
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
        if let Some(solid) = modeler.solid().filter(|solid| solid.is_coarsened) {
            ui.weak(format!("shown in cells of {:.2} mm", solid.cell)).on_hover_text(
                "In smaller ones, as usual for this size, there would be too many triangles to turn it quickly. \
                 Exports are as fine as you say.",
            );
        }
        if is_wide {
            errands(modeler, ui);
        }
        let room = ui.available_width();
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
            let Some(solid) = modeler.solid() else { return };
            let size = solid.bounds.size();
            if !solid.bounds.is_empty() && room > SIZE {
                ui.label(format!("{:.1} × {:.1} × {:.1} mm", size.x, size.y, size.z));
            }
            if !solid.bounds.is_empty() && room > SIZE_AND_TRIANGLES {
                let triangles = solid.corners.len() / 3;
                ui.weak(format!("{triangles} triangles in {:.0} ms", solid.took.as_secs_f64() * 1e3));
            }
            if modeler.errands.is_empty() && !modeler.is_at_rest() {
                ui.spinner();
            }
        });
    });
}

/// What is being read and written, how far that is, and how it is stopped.
fn errands(modeler: &mut Modeler, ui: &mut Ui) {
    let mut stopped = None;
    for (i, (title, Progress { step, share })) in modeler.errands.told().enumerate() {
        ui.separator();
        let text = if step.is_empty() { format!("{title}…") } else { format!("{title}: {step}…") };
        let label = ui.label(text);
        match share {
            Some(share) => {
                ui.add(ProgressBar::new(share).desired_width(BAR).show_percentage()).labelled_by(label.id);
            }
            None => {
                ui.spinner();
            }
        }
        if ui.add_enabled(step != STOPPING, Button::new("Stop").small()).clicked() {
            stopped = Some(i);
        }
        ui.ctx().request_repaint_after(TICK);
    }
    if let Some(stopped) = stopped {
        modeler.errands.stop(stopped);
    }
}
