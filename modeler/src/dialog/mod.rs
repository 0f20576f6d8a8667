//! What is asked of the user: names of files, what to do with unsaved work, and help.

mod arrival;
mod files;
mod left_behind;

use crate::desk::Purpose;
use crate::help;
use crate::journal::LeftBehind;
use crate::modeler::{Fetched, Modeler, Newcomer};
use egui::{Align2, Key, ScrollArea, Ui, Window};
use std::path::PathBuf;

/// Room above and below what is scrolled, points.
const AROUND: f32 = 180.0;

/// A question, or something to read.
#[derive(Debug)]
pub enum Dialog {
    /// The name of a file.
    File {
        /// What it is for.
        purpose: Purpose,
        /// What was typed.
        text: String,
        /// What comes after, if it is done.
        then: Option<Then>,
    },
    /// What to do with unsaved work, and what comes after.
    Unsaved(Then),
    /// A file is still being written, and what comes after.
    Writing(Then),
    /// Whether something is added to what is there, or takes its place.
    Arrival(Box<Fetched>),
    /// What to do with sessions that were left behind.
    LeftBehind(Vec<LeftBehind>),
    /// The scenes to begin with.
    Examples,
    /// Keys and gestures.
    Help,
}

/// What comes after a decision about unsaved work.
#[derive(Debug)]
pub enum Then {
    /// A new page.
    New,
    /// Something else takes the table.
    Put(Box<Newcomer>),
    /// The end.
    Quit,
}

impl Dialog {
    /// Asks for a file to be opened.
    pub fn begin_open(modeler: &mut Modeler) {
        modeler.dialog =
            Some(Self::File { purpose: Purpose::Open, text: in_folder(modeler, ""), then: None });
    }

    /// Asks for a file to be added.
    pub fn begin_add(modeler: &mut Modeler) {
        modeler.dialog = Some(Self::File { purpose: Purpose::Add, text: in_folder(modeler, ""), then: None });
    }

    /// Goes to a new page, if nothing is lost by it.
    pub fn begin_new(modeler: &mut Modeler) {
        Self::begin(modeler, Then::New);
    }

    /// Saves, and asks for a name if there is none or another one is wanted; goes on when it is saved.
    pub fn begin_save(modeler: &mut Modeler, under_another_name: bool, then: Option<Then>) {
        match modeler.bench.file().map(PathBuf::from) {
            Some(file) if !under_another_name => modeler.save_to(file, then),
            file => {
                let text = file
                    .map_or_else(|| in_folder(modeler, "model.trullo"), |file| file.display().to_string());
                modeler.dialog = Some(Self::File { purpose: Purpose::Save, text, then });
            }
        }
    }

    /// Asks for the name of the exported file, and how it is written.
    pub fn begin_export(modeler: &mut Modeler) {
        let file = modeler.bench.file().map(|file| file.with_extension("3mf").display().to_string());
        let text = file.unwrap_or_else(|| in_folder(modeler, "model.3mf"));
        modeler.dialog = Some(Self::File { purpose: Purpose::Export, text, then: None });
    }

    /// Does what puts the document off the table; waits for files that are being written, and asks first if something
    /// is unsaved.
    pub fn begin(modeler: &mut Modeler, then: Then) {
        let is_last = matches!(then, Then::Quit);
        if is_last && modeler.errands.is_writing() || modeler.errands.is_saving() {
            modeler.dialog = Some(Self::Writing(then));
        } else if modeler.bench.is_unsaved() {
            modeler.dialog = Some(Self::Unsaved(then));
        } else {
            go_on(modeler, then);
        }
    }

    fn title(&self) -> &'static str {
        match self {
            Self::File { purpose: Purpose::Open, .. } => "Open",
            Self::File { purpose: Purpose::Add, .. } => "Add to the model",
            Self::File { purpose: Purpose::Save, .. } => "Save",
            Self::File { purpose: Purpose::Export, .. } => "Export for printing",
            Self::Unsaved(_) => "Keep what you made?",
            Self::Writing(_) => "One moment",
            Self::Arrival(_) => "Add it, or open it?",
            Self::LeftBehind(_) => "Something was not saved",
            Self::Examples => "Examples",
            Self::Help => "Keys and gestures",
        }
    }
}

/// A name in the folder where the user worked last, else in that of the program, so that it is clear where it is.
fn in_folder(modeler: &Modeler, name: &str) -> String {
    let path = match modeler.last_folder() {
        Some(folder) => folder.join(name),
        None => std::path::absolute(name).unwrap_or_else(|_| name.into()),
    };
    path.display().to_string()
}

/// Shows the question and does what is answered.
pub fn show(modeler: &mut Modeler, ui: &mut Ui) {
    files::take_browsed(modeler);
    let Some(dialog) = modeler.dialog.take() else { return };
    let window = Window::new(dialog.title())
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, -40.0]);
    let mut kept = Some(dialog);
    window.show(ui.ctx(), |ui| {
        let escaped = ui.input(|input| input.key_pressed(Key::Escape));
        let dialog = kept.take().filter(|dialog| !escaped || matches!(dialog, Dialog::LeftBehind(_)));
        kept = dialog.and_then(|dialog| match dialog {
            Dialog::File { purpose, text, then } => files::show(modeler, ui, purpose, text, then),
            Dialog::Unsaved(then) => unsaved(modeler, ui, then),
            Dialog::Writing(then) => writing(modeler, ui, then),
            Dialog::Arrival(fetched) => arrival::show(modeler, ui, fetched),
            Dialog::LeftBehind(sessions) => left_behind::show(modeler, ui, sessions),
            Dialog::Examples => examples(modeler, ui),
            Dialog::Help => help::show(ui).then_some(Dialog::Help),
        });
    });
    if modeler.dialog.is_none() {
        modeler.dialog = kept;
    }
}

/// Content that can be scrolled where the window is too low for it.
pub(crate) fn scrolled(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let height = (ui.ctx().content_rect().height() - AROUND).max(100.0);
    ScrollArea::vertical().max_height(height).show(ui, content);
}

fn unsaved(modeler: &mut Modeler, ui: &mut Ui, then: Then) -> Option<Dialog> {
    ui.label("There are changes that are in no file yet.");
    ui.horizontal(|ui| {
        if ui.button("Save").clicked() {
            Dialog::begin_save(modeler, false, Some(then));
        } else if ui.button("Throw away").clicked() {
            go_on(modeler, then);
        } else if !ui.button("Cancel").clicked() {
            return Some(Dialog::Unsaved(then));
        }
        None
    })
    .inner
}

fn writing(modeler: &mut Modeler, ui: &mut Ui, then: Then) -> Option<Dialog> {
    if !modeler.errands.is_writing() {
        Dialog::begin(modeler, then);
        return None;
    }
    let what: Vec<String> = modeler.errands.told().map(|(title, _)| title.to_owned()).collect();
    ui.label(format!("{}. This goes on as soon as that is done.", what.join(", ")));
    let (stops, stays) = ui
        .horizontal(|ui| {
            ui.spinner();
            (ui.button("Stop it and go on").clicked(), ui.button("Stay here").clicked())
        })
        .inner;
    if stops {
        modeler.errands.stop_everything();
    }
    (!stays).then_some(Dialog::Writing(then))
}

/// Does what was to come after.
pub(crate) fn go_on(modeler: &mut Modeler, then: Then) {
    match then {
        Then::New => modeler.put(crate::workbench::Workbench::empty_page(), None),
        Then::Put(newcomer) => modeler.take_in(*newcomer),
        Then::Quit => modeler.view.quits = true,
    }
}

fn examples(modeler: &mut Modeler, ui: &mut Ui) -> Option<Dialog> {
    let mut chosen = None;
    scrolled(ui, |ui| {
        for (i, (title, _)) in modeler.desk.examples().iter().enumerate() {
            if ui.add_sized([300.0, 26.0], egui::Button::new(*title)).clicked() {
                chosen = Some(i);
            }
        }
    });
    if let Some(i) = chosen {
        modeler.open_example(i);
        return None;
    }
    (!ui.button("Cancel").clicked()).then_some(Dialog::Examples)
}
