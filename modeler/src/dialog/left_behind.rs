//! What to do with sessions that were left behind.

use super::Dialog;
use crate::journal::LeftBehind;
use crate::modeler::Modeler;
use egui::Ui;

/// Asks.
pub fn show(modeler: &mut Modeler, ui: &mut Ui, mut sessions: Vec<LeftBehind>) -> Option<Dialog> {
    ui.label("Trullo ended before this work was saved. Nothing of it is lost.");
    let (mut back, mut away) = (None, None);
    super::scrolled(ui, |ui| {
        for (i, session) in sessions.iter().enumerate() {
            ui.horizontal_wrapped(|ui| {
                let name = session
                    .file
                    .as_ref()
                    .and_then(|file| file.file_name())
                    .map(|name| name.to_string_lossy());
                let name = name.unwrap_or_else(|| "A new page".into());
                ui.label(format!("{name}, {} steps, {}", session.steps, ago(session)));
                if ui.button("Bring back").clicked() {
                    back = Some(i);
                }
                if ui.button("Throw away").clicked() {
                    away = Some(i);
                }
            });
        }
    });
    if let Some(i) = back {
        modeler.bring_back(sessions.remove(i));
        return None;
    }
    if let Some(i) = away {
        sessions.remove(i).forget();
    }
    let later = ui.button("Decide later").clicked();
    (!sessions.is_empty() && !later).then_some(Dialog::LeftBehind(sessions))
}

fn ago(session: &LeftBehind) -> String {
    match session.last.elapsed().map_or(0, |ago| ago.as_secs() / 60) {
        0 => "just now".into(),
        1 => "a minute ago".into(),
        minutes @ 2..=119 => format!("{minutes} minutes ago"),
        minutes @ 120..=2879 => format!("{} hours ago", minutes / 60),
        minutes => format!("{} days ago", minutes / 1440),
    }
}
