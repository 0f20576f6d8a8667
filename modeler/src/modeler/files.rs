//! How documents come to the table and go from it: files, sessions, and the end. Whatever may take long is an errand.

use super::Modeler;
use crate::desk::Opened;
use crate::dialog::{Dialog, Then};
use crate::errand::{Kind, Undone, Watch};
use crate::journal::{LeftBehind, Recovered};
use crate::variants::Variants;
use crate::workbench::{EditError, Snapshot, Workbench};
use blobtree::{Aabb, DEFAULT_OLDER_VERSIONS, Scene, write_atomically};
use std::path::{Path, PathBuf};

/// What is to become of a file that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// It takes the table.
    Instead,
    /// It is put beside the model.
    Beside,
    /// It takes the table if that is empty; else the user is asked.
    Ask,
}

/// Something that may take the table.
#[derive(Debug)]
pub enum Newcomer {
    /// A scene.
    Scene {
        /// The scene.
        scene: Scene,
        /// The file that it is in, or may be saved as.
        file: Option<PathBuf>,
        /// The file that it was read from.
        origin: Option<PathBuf>,
        /// Whether it is in that file as it is.
        is_saved: bool,
    },
    /// What was brought back, and the file that was worked on.
    Recovered(Box<Recovered>, Option<PathBuf>),
}

/// A scene or a mesh that was read.
#[derive(Debug)]
pub struct Fetched {
    /// The scene, or one with the mesh as its only part; it names its meshes from the folder of `path`.
    pub(super) scene: Scene,
    /// The file.
    pub(super) path: PathBuf,
    /// Whether it is a scene of the user's, which may be written again.
    is_scene: bool,
    notices: Vec<String>,
}

impl Fetched {
    /// The file's name.
    pub fn name(&self) -> String {
        name(&self.path)
    }
}

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

    /// Puts on the table what may take it.
    pub(crate) fn take_in(&mut self, newcomer: Newcomer) {
        match newcomer {
            Newcomer::Scene { scene, file, origin, is_saved } => {
                origin.into_iter().for_each(|origin| self.kept.remember(&origin, &scene.root));
                self.put(scene, file);
                if !is_saved {
                    self.bench.never_saved();
                }
            }
            Newcomer::Recovered(recovered, file) => {
                if let Some(reason) = &recovered.lost {
                    self.notices.warn(format!("The last steps could not be brought back: {reason}"));
                }
                let bench = Workbench::recovered(*recovered, file, self.sessions.as_deref());
                std::mem::replace(&mut self.bench, bench).close();
                self.changed_document();
            }
        }
    }

    fn changed_document(&mut self) {
        self.documents += 1;
        self.errands.stop_reading();
        self.pad.clear();
        (self.form, self.hovered, self.solid, self.asked) = (None, None, None, None);
        self.solids.forget();
        self.view.shows_new = true;
        self.camera.show(Aabb::EMPTY);
    }

    /// Reads a file: a scene or a mesh becomes what `how` says, a drawing becomes a sketch.
    pub fn fetch(&mut self, path: PathBuf, how: How) {
        let (desk, kind) = (self.desk.clone(), if how == How::Beside { Kind::Add } else { Kind::Open });
        self.errands.begin(kind, format!("Opening {}", name(&path)), move |watch| {
            let opened = desk.open(&path, watch);
            Box::new(move |modeler| modeler.fetched(path, how, opened))
        });
    }

    fn fetched(&mut self, path: PathBuf, how: How, opened: Result<Opened, Undone>) {
        let (scene, notices, is_scene) = match opened {
            Ok(Opened::Scene(scene, notices)) => (scene, notices, true),
            Ok(Opened::Mesh(scene, notices)) => (scene, notices, false),
            Ok(Opened::Drawing(sketch)) => {
                self.pad.put(sketch, &self.camera.view(self.view.screen));
                return self.think();
            }
            Err(undone) => return self.undone("Not opened", undone),
        };
        let fetched = Fetched { scene, path, is_scene, notices };
        let is_empty = self.bench.scene().root.children().is_empty();
        match how {
            How::Beside => self.add(fetched),
            How::Ask if !is_empty => self.dialog = Some(Dialog::Arrival(Box::new(fetched))),
            How::Instead | How::Ask => self.open_instead(fetched),
        }
    }

    /// Puts what was read on the table, if nothing is lost by it.
    pub(crate) fn open_instead(&mut self, fetched: Fetched) {
        let Fetched { scene, path, is_scene, notices } = fetched;
        notices.into_iter().for_each(|notice| self.notices.tell(notice));
        let is_saved = is_scene && path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"));
        let origin = Some(path.clone());
        let file = match is_scene {
            true => is_saved.then(|| path.clone()),
            false => Some(free_name(&path)),
        };
        let newcomer = Newcomer::Scene { scene, file, origin, is_saved: is_scene };
        Dialog::begin(self, Then::Put(Box::new(newcomer)));
    }

    /// Opens an example, by its place in the gallery.
    pub fn open_example(&mut self, place: usize) {
        let Some((title, text)) = self.desk.examples().get(place).copied() else { return };
        let desk = self.desk.clone();
        self.errands.begin(Kind::Open, format!("Opening {title}"), move |_| {
            let read = Scene::from_bytes(text.as_bytes(), &mut *desk.sources(None));
            Box::new(move |modeler| match read {
                Ok(scene) => {
                    let newcomer = Newcomer::Scene { scene, file: None, origin: None, is_saved: true };
                    Dialog::begin(modeler, Then::Put(Box::new(newcomer)));
                }
                Err(error) => modeler.notices.warn(error.to_string()),
            })
        });
    }

    /// Does again what was done in a session that was left behind.
    pub(crate) fn bring_back(&mut self, session: LeftBehind) {
        let desk = self.desk.clone();
        self.errands.begin(Kind::Open, "Bringing back what you made", move |_| {
            let file = session.file.clone();
            let recovered = session.recover(&mut *desk.sources(file.as_deref()));
            Box::new(move |modeler| match recovered {
                Ok(recovered) => {
                    let newcomer = Newcomer::Recovered(Box::new(recovered), file);
                    Dialog::begin(modeler, Then::Put(Box::new(newcomer)));
                }
                Err(error) => modeler.notices.warn(error.to_string()),
            })
        });
    }

    /// Tells why something was not done.
    fn undone(&mut self, what: &str, undone: Undone) {
        match undone {
            Undone::Stopped => self.notices.tell(format!("{what}: stopped.")),
            Undone::Failed(why) => self.notices.warn(format!("{what}: {why}")),
        }
    }

    /// Saves the document to a file, which is the user's when that is done; then goes on.
    pub fn save_to(&mut self, file: PathBuf, then: Option<Then>) {
        let (variants, from, document) = (self.bench.variants().clone(), self.folder(), self.documents);
        let snapshot = self.bench.snapshot();
        self.errands.begin(Kind::Save, format!("Saving {}", name(&file)), move |watch| {
            let root = variants.document().scene().root.clone();
            let saved = save(variants, &from, &file, watch);
            Box::new(move |modeler| match saved {
                Ok(()) => {
                    modeler.notices.tell("Saved.");
                    modeler.kept.remember(&file, &root);
                    if modeler.documents == document {
                        modeler.saved(snapshot, file);
                        then.into_iter().for_each(|then| Dialog::begin(modeler, then));
                    }
                }
                Err(undone) => modeler.undone("Not saved", undone),
            })
        });
    }

    /// The document, as it was then, is in the file now; and so are the names of its meshes.
    fn saved(&mut self, then: Snapshot, file: PathBuf) {
        let is_same = then == self.bench.snapshot();
        let renames = self.bench.rename_meshes(&self.folder(), &folder_of(&file)).unwrap_or_else(|error| {
            self.notices.warn(format!("A mesh of the scene is no longer there: {error}"));
            false
        });
        self.bench.saved_as(file, if is_same { self.bench.snapshot() } else { then });
        if renames && let Err(error) = self.bench.begin_journal() {
            self.notices.warn(EditError::from(error).to_string());
        }
    }

    /// The folder from which the document names its meshes.
    pub(super) fn folder(&self) -> PathBuf {
        self.bench.file().map(folder_of).unwrap_or_default()
    }

    /// The folder where the user worked last, if it is known.
    pub(crate) fn last_folder(&self) -> Option<PathBuf> {
        let folder = self.bench.file().and_then(Path::parent).or_else(|| self.kept.folder())?;
        Some(folder.to_path_buf()).filter(|folder| !folder.as_os_str().is_empty())
    }

    /// Opens a file with the first frame.
    pub fn begin_with(&mut self, file: PathBuf) {
        self.waiting = Some(file);
    }

    /// Takes in files that were dropped on the window: a single one may take the table.
    pub fn dropped(&mut self, files: Vec<PathBuf>) {
        let how = if files.len() == 1 { How::Ask } else { How::Beside };
        files.into_iter().for_each(|file| self.fetch(file, how));
    }

    /// Ends, if nothing is lost by it: see [`Self::quits`].
    pub fn quit(&mut self) {
        if !matches!(self.dialog, Some(Dialog::Writing(Then::Quit))) {
            Dialog::begin(self, Then::Quit);
        }
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
    pub fn export_to(&mut self, path: PathBuf) {
        let (desk, scene, options) = (self.desk.clone(), self.bench.variants().whole(), self.settings.export);
        self.errands.begin(Kind::Export, format!("Exporting {}", name(&path)), move |watch| {
            let written = desk.export(&scene, &path, &options, watch);
            Box::new(move |modeler| match written {
                Ok(written) => modeler.notices.tell(written),
                Err(undone) => modeler.undone("Not exported", undone),
            })
        });
    }

    /// Takes in what errands have brought. What may ask something waits for the answer to what is asked.
    pub(super) fn receive(&mut self) {
        for arrive in self.errands.arrived(self.dialog.is_some()) {
            arrive(self);
        }
    }
}

/// Writes variants that name their meshes from one folder to a file that may be in another.
fn save(mut variants: Variants, from: &Path, file: &Path, watch: &Watch) -> Result<(), Undone> {
    watch.report("writing", None);
    let failed = |error: &dyn std::fmt::Display| Undone::Failed(error.to_string());
    variants
        .rename_meshes(from, &folder_of(file))
        .map_err(|e| failed(&format!("a mesh of the scene, or the folder, is not there: {e}")))?;
    let text =
        variants.whole().to_text().map_err(|e| failed(&format!("the scene cannot be written: {e}")))?;
    if watch.cancel.is_cancelled() {
        return Err(Undone::Stopped);
    }
    write_atomically(file, text.as_bytes(), DEFAULT_OLDER_VERSIONS).map_err(|e| failed(&e))
}

/// A file's name, for the user.
fn name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

/// The folder that a file is in.
pub(super) fn folder_of(file: &Path) -> PathBuf {
    file.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The scene's file beside a mesh: none that is there already.
pub(super) fn free_name(mesh: &Path) -> PathBuf {
    let name = mesh.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2..).map(|number| format!("{name} {number}.trullo"));
    let mut names =
        std::iter::once(format!("{name}.trullo")).chain(numbered).map(|name| mesh.with_file_name(name));
    names.find(|file| !file.exists()).unwrap_or_else(|| mesh.with_extension("trullo"))
}
