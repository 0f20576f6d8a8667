//! How documents come to the table and go from it: files, sessions, and the end.

use super::Modeler;
use crate::desk::Opened;
use crate::dialog::{Dialog, Then};
use crate::journal::Recovered;
use crate::workbench::{EditError, Workbench};
use blobtree::{Aabb, Scene};
use std::path::{Path, PathBuf};

impl Modeler {
    /// Puts another document on the table; whoever asks has made sure that nothing is lost.
    pub fn put(&mut self, scene: Scene, file: Option<PathBuf>) {
        match Workbench::new(scene, file, self.sessions.as_deref()) {
            Ok((bench, unprotected)) => {
                std::mem::replace(&mut self.bench, bench).close();
                if let Some(error) = unprotected {
                    self.notices.warn(EditError::from(error).to_string());
                }
                self.changed_document();
            }
            Err(error) => self.notices.warn(error.to_string()),
        }
    }

    /// Puts a document on the table that was brought back.
    pub fn put_recovered(&mut self, recovered: Recovered, file: Option<PathBuf>) {
        let bench = Workbench::recovered(recovered, file, self.sessions.as_deref());
        std::mem::replace(&mut self.bench, bench).close();
        self.changed_document();
    }

    fn changed_document(&mut self) {
        self.pad.clear();
        (self.form, self.hovered, self.solid, self.asked) = (None, None, None, None);
        self.solids.forget();
        self.view.shows_new = true;
        self.camera.show(Aabb::EMPTY);
    }

    /// Opens a file: a scene or a mesh takes the table, a drawing becomes a sketch.
    pub fn open(&mut self, path: &Path) {
        match self.desk.open(path) {
            Ok(Opened::Scene(scene, noticed)) => {
                let is_scene = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"));
                self.put(scene, is_scene.then(|| path.to_path_buf()));
                noticed.into_iter().for_each(|notice| self.notices.tell(notice));
            }
            Ok(Opened::Mesh(scene, file, noticed)) => {
                self.put(scene, Some(file));
                self.bench.never_saved();
                noticed.into_iter().for_each(|notice| self.notices.tell(notice));
            }
            Ok(Opened::Drawing(sketch)) => {
                self.pad.put(sketch, &self.camera.view(self.view.screen));
                self.think();
            }
            Err(error) => self.notices.warn(error),
        }
    }

    /// Saves the document to a file.
    pub fn save_to(&mut self, file: PathBuf) -> bool {
        let Some(renamed) = self.rename_meshes(&file) else { return false };
        if let Err(error) = self.bench.save(file) {
            self.notices.warn(format!("Not saved: {error}"));
            self.go_back(renamed as isize);
            return false;
        }
        self.notices.tell("Saved.");
        if renamed > 0
            && let Err(error) = self.bench.begin_journal()
        {
            self.notices.warn(EditError::from(error).to_string());
        }
        true
    }

    /// Names meshes from the folder that the scene goes to, in so many steps; `None` if one is not there.
    fn rename_meshes(&mut self, file: &Path) -> Option<usize> {
        let folder = |file: &Path| file.parent().map(Path::to_path_buf).unwrap_or_default();
        let from = self.bench.file().map(folder).unwrap_or_default();
        match crate::meshes::renamed(&self.bench.scene().root, &from, &folder(file)) {
            Ok(commands) => Some(commands.into_iter().filter(|command| self.apply(command.clone())).count()),
            Err(error) => {
                self.notices
                    .warn(format!("Not saved: a mesh of the scene, or the folder, is not there: {error}"));
                None
            }
        }
    }

    /// Opens a file with the first frame.
    pub fn begin_with(&mut self, file: PathBuf) {
        self.waiting = Some(file);
    }

    /// Opens a file, if nothing is lost by it.
    pub fn begin_open(&mut self, file: PathBuf) {
        Dialog::begin(self, Then::Open(file));
    }

    /// Ends, if nothing is lost by it: see [`Self::quits`].
    pub fn quit(&mut self) {
        Dialog::begin(self, Then::Quit);
    }

    /// Whether the window may close.
    pub fn quits(&self) -> bool {
        self.view.quits
    }

    /// Takes the document off the table for good; what is unsaved was thrown away by the user.
    pub fn close(&mut self) {
        if self.quits() {
            let (bench, _) =
                Workbench::new(Workbench::empty_page(), None, None).expect("an empty page is legal");
            std::mem::replace(&mut self.bench, bench).close();
        }
    }

    /// The window's title.
    pub fn title(&self) -> String {
        let name = self.bench.file().and_then(Path::file_name).map(|name| name.to_string_lossy());
        let mark = if self.bench.is_unsaved() { "*" } else { "" };
        name.map_or_else(|| format!("Trullo{mark}"), |name| format!("{name}{mark} - Trullo"))
    }

    /// Writes the mesh of the scene.
    pub fn export_to(&mut self, path: &Path) {
        match self.desk.export(self.bench.scene(), path, None) {
            Ok(written) => self.notices.tell(written),
            Err(error) => self.notices.warn(format!("Not exported: {error}")),
        }
    }
}
