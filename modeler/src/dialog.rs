//! What is asked of the user: names of files, what to do with unsaved work, and help.

use crate::desk::Purpose;
use crate::journal::LeftBehind;
use crate::keys::BINDINGS;
use crate::modeler::Modeler;
use crate::workbench::Workbench;
use blobtree::Scene;
use egui::{Align2, Grid, Key, Ui, Window};
use std::path::PathBuf;
use std::sync::Arc;

/// A question, or something to read.
#[derive(Debug)]
pub enum Dialog {
    /// The name of a file.
    File {
        /// What it is for.
        purpose: Purpose,
        /// What was typed.
        text: String,
    },
    /// What to do with unsaved work, and what comes after.
    Unsaved(Then),
    /// What to do with sessions that were left behind.
    LeftBehind(Vec<LeftBehind>),
    /// The scenes to begin with.
    Examples,
    /// Keys and gestures.
    Help,
}

/// What comes after a decision about unsaved work.
#[derive(Clone, Debug, PartialEq)]
pub enum Then {
    /// A new page.
    New,
    /// Another file.
    Open(PathBuf),
    /// An example, by its place in the gallery.
    Example(usize),
    /// The end.
    Quit,
}

/// Strokes that are commands.
const GESTURES: [(&str, &str); 6] = [
    ("Scribble over a stroke", "rub it out"),
    ("Scribble over what is selected", "remove it"),
    ("Circle twice around a stroke", "make it smoother"),
    ("Quick stroke to the left", "undo"),
    ("Line straight up", "select the parent"),
    ("Stroke across a button", "press it"),
];

impl Dialog {
    /// Asks for a file to be opened.
    pub fn open() -> Self {
        Self::File { purpose: Purpose::Open, text: String::new() }
    }

    /// Goes to a new page, if nothing is lost by it.
    pub fn begin_new(modeler: &mut Modeler) {
        Self::begin(modeler, Then::New);
    }

    /// Saves, and asks for a name if there is none or another one is wanted.
    pub fn begin_save(modeler: &mut Modeler, under_another_name: bool) {
        match modeler.bench.file().map(PathBuf::from) {
            Some(file) if !under_another_name => {
                modeler.save_to(file);
            }
            file => {
                let text = file.map_or("model.trullo".into(), |file| file.display().to_string());
                modeler.dialog = Some(Self::File { purpose: Purpose::Save, text });
            }
        }
    }

    /// Asks for the name of the exported file.
    pub fn begin_export(modeler: &mut Modeler) {
        let file = modeler.bench.file().map(|file| file.with_extension("3mf").display().to_string());
        let text = file.unwrap_or_else(|| "model.3mf".into());
        modeler.dialog = Some(Self::File { purpose: Purpose::Export, text });
    }

    /// Does what puts the document off the table; asks first if something is unsaved.
    pub fn begin(modeler: &mut Modeler, then: Then) {
        if modeler.bench.is_unsaved() {
            modeler.dialog = Some(Self::Unsaved(then));
        } else {
            go_on(modeler, then);
        }
    }
}

/// Shows the question and does what is answered.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    if let Some(Some(file)) = modeler.desk.browsed()
        && let Some(Dialog::File { purpose, .. }) = modeler.dialog
    {
        modeler.dialog = None;
        take_file(modeler, purpose, file);
    }
    let Some(dialog) = modeler.dialog.take() else { return };
    let title = match &dialog {
        Dialog::File { purpose: Purpose::Open, .. } => "Open",
        Dialog::File { purpose: Purpose::Save, .. } => "Save",
        Dialog::File { purpose: Purpose::Export, .. } => "Export for printing",
        Dialog::Unsaved(_) => "Keep what you made?",
        Dialog::LeftBehind(_) => "Something was not saved",
        Dialog::Examples => "Examples",
        Dialog::Help => "Keys and gestures",
    };
    let window =
        Window::new(title).collapsible(false).resizable(false).anchor(Align2::CENTER_CENTER, [0.0, -40.0]);
    let mut kept = Some(dialog);
    window.show(ui.ctx(), |ui| {
        let escaped = ui.input(|input| input.key_pressed(Key::Escape));
        let dialog = kept.take().filter(|dialog| !escaped || matches!(dialog, Dialog::LeftBehind(_)));
        kept = dialog.and_then(|dialog| match dialog {
            Dialog::File { purpose, text } => file(modeler, ui, purpose, text),
            Dialog::Unsaved(then) => unsaved(modeler, ui, then),
            Dialog::LeftBehind(sessions) => left_behind(modeler, ui, sessions),
            Dialog::Examples => examples(modeler, ui),
            Dialog::Help => help(ui),
        });
    });
    if modeler.dialog.is_none() {
        modeler.dialog = kept;
    }
}

fn file(modeler: &mut Modeler, ui: &mut Ui, purpose: Purpose, mut text: String) -> Option<Dialog> {
    let what = match purpose {
        Purpose::Open => {
            "A scene (.trullo), a mesh (.stl, .obj, .ply, .3mf) or a drawing (.svg, .json, .ndjson)"
        }
        Purpose::Save => "The scene's file (.trullo)",
        Purpose::Export => "The mesh's file (.3mf, .stl, .obj or .ply; .3mf carries the scene along)",
    };
    let label = ui.label(what);
    let field = ui.add(egui::TextEdit::singleline(&mut text).desired_width(460.0)).labelled_by(label.id);
    let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    let word = match purpose {
        Purpose::Open => "Open",
        Purpose::Save => "Save",
        Purpose::Export => "Export",
    };
    let mut stays = true;
    ui.horizontal(|ui| {
        if (ui.button(word).clicked() || entered) && !text.trim().is_empty() {
            stays = false;
            take_file(modeler, purpose, PathBuf::from(text.trim()));
        }
        if ui.button("Browse…").clicked() {
            let ctx = ui.ctx().clone();
            if !modeler.desk.browse(purpose, Arc::new(move || ctx.request_repaint())) {
                modeler.notices.tell("This system has no window for files; type the name.");
            }
        }
        stays &= !ui.button("Cancel").clicked();
    });
    stays.then_some(Dialog::File { purpose, text })
}

fn take_file(modeler: &mut Modeler, purpose: Purpose, mut file: PathBuf) {
    match purpose {
        Purpose::Open => Dialog::begin(modeler, Then::Open(file)),
        Purpose::Save => {
            if file.extension().is_none() {
                file.set_extension("trullo");
            }
            modeler.save_to(file);
        }
        Purpose::Export => {
            if file.extension().is_none() {
                file.set_extension("3mf");
            }
            modeler.export_to(&file);
        }
    }
}

fn unsaved(modeler: &mut Modeler, ui: &mut Ui, then: Then) -> Option<Dialog> {
    ui.label("There are changes that are in no file yet.");
    let mut next = Some(Dialog::Unsaved(then.clone()));
    ui.horizontal(|ui| {
        if ui.button("Save").clicked() {
            next = None;
            Dialog::begin_save(modeler, false);
            if !modeler.bench.is_unsaved() {
                go_on(modeler, then.clone());
            }
        }
        if ui.button("Throw away").clicked() {
            next = None;
            go_on(modeler, then.clone());
        }
        if ui.button("Cancel").clicked() {
            next = None;
        }
    });
    next
}

fn go_on(modeler: &mut Modeler, then: Then) {
    match then {
        Then::New => modeler.put(Workbench::empty_page(), None),
        Then::Open(file) => modeler.open(&file),
        Then::Example(index) => {
            let Some((_, text)) = modeler.desk.examples().get(index).copied() else { return };
            let scene = Scene::from_bytes(text.as_bytes(), &mut *modeler.desk.sources(None));
            match scene {
                Ok(scene) => modeler.put(scene, None),
                Err(error) => modeler.notices.warn(error.to_string()),
            }
        }
        Then::Quit => modeler.view.quits = true,
    }
}

fn left_behind(modeler: &mut Modeler, ui: &mut Ui, mut sessions: Vec<LeftBehind>) -> Option<Dialog> {
    ui.label("Trullo ended before this work was saved. Nothing of it is lost.");
    let (mut back, mut away) = (None, None);
    for (i, session) in sessions.iter().enumerate() {
        ui.horizontal(|ui| {
            let name =
                session.file.as_ref().and_then(|file| file.file_name()).map(|name| name.to_string_lossy());
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
    if let Some(i) = back {
        let session = sessions.remove(i);
        let file = session.file.clone();
        let recovered = session.recover(&mut *modeler.desk.sources(file.as_deref()));
        match recovered {
            Ok(recovered) => {
                if let Some(reason) = &recovered.lost {
                    modeler.notices.warn(format!("The last steps could not be brought back: {reason}"));
                }
                modeler.put_recovered(recovered, file);
                return None;
            }
            Err(error) => modeler.notices.warn(error.to_string()),
        }
    } else if let Some(i) = away {
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

fn examples(modeler: &mut Modeler, ui: &mut Ui) -> Option<Dialog> {
    let mut chosen = None;
    for (i, (title, _)) in modeler.desk.examples().iter().enumerate() {
        if ui.add_sized([300.0, 26.0], egui::Button::new(*title)).clicked() {
            chosen = Some(i);
        }
    }
    if let Some(i) = chosen {
        Dialog::begin(modeler, Then::Example(i));
        return None;
    }
    (!ui.button("Cancel").clicked()).then_some(Dialog::Examples)
}

fn help(ui: &mut Ui) -> Option<Dialog> {
    ui.strong("With the pen");
    Grid::new("gestures").num_columns(2).striped(true).show(ui, |ui| {
        for (gesture, meaning) in GESTURES {
            ui.label(gesture);
            ui.label(meaning);
            ui.end_row();
        }
    });
    ui.separator();
    ui.strong("With the keyboard");
    Grid::new("keys").num_columns(4).striped(true).show(ui, |ui| {
        for pair in BINDINGS.chunks(2) {
            for binding in pair {
                ui.label(ui.ctx().format_shortcut(&binding.shortcut));
                ui.label(binding.help);
            }
            ui.end_row();
        }
    });
    (!ui.button("Close").clicked()).then_some(Dialog::Help)
}
