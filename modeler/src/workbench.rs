//! The document on the table: its file, its journal, what is selected, and the one way to change it.

use crate::journal::{Journal, JournalError, Recovered};
use crate::several;
use blobtree::build::union;
use blobtree::{
    Change, Command, CommandError, Document, JournalEntry, Node, NodePath, NodeRef, Scene, SceneError,
};
use std::path::{Path, PathBuf};

/// A document being worked on.
#[derive(Debug)]
pub struct Workbench {
    document: Document,
    /// Where everything done is written first; none if that is not possible or not wanted.
    journal: Option<Journal>,
    /// The folder for journals, if one is wanted.
    sessions: Option<PathBuf>,
    /// A journal that could not be gone on with. What it holds is kept until another one holds more.
    broken: Option<Journal>,
    /// The user's file, if there is one.
    file: Option<PathBuf>,
    /// The scene as it was opened or saved.
    saved: Scene,
    /// The selected nodes, sorted; always ones that are there, and none below another one.
    selection: Vec<NodePath>,
    /// What is shown instead of the document while something is dragged.
    preview: Option<Scene>,
}

/// What became of something that was to be done.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// It cannot be carried out; nothing has changed.
    #[error("{0}")]
    Command(#[from] CommandError),
    /// It was carried out, but cannot be kept: a crash would lose it. Whatever is done next tries again.
    #[error("what you do can no longer be protected against a crash ({0}); save your work")]
    Journal(Box<JournalError>),
}

impl From<JournalError> for EditError {
    fn from(error: JournalError) -> Self {
        Self::Journal(Box::new(error))
    }
}

impl Workbench {
    /// A table with a scene on it. `sessions` is the folder for its journal; without one it has none.
    ///
    /// The second value says why there is no journal although one was wanted. Errors: an illegal scene.
    pub fn new(
        scene: Scene,
        file: Option<PathBuf>,
        sessions: Option<&Path>,
    ) -> Result<(Self, Option<JournalError>), SceneError> {
        let document = Document::new(scene.clone())?;
        let journal =
            sessions.map(|sessions| Journal::begin(sessions, &scene, file.as_deref(), false)).transpose();
        let (journal, error) = match journal {
            Ok(journal) => (journal, None),
            Err(error) => (None, Some(error)),
        };
        let bench = Self {
            document,
            journal,
            sessions: sessions.map(Path::to_path_buf),
            broken: None,
            file,
            saved: scene,
            selection: Vec::new(),
            preview: None,
        };
        Ok((bench, error))
    }

    /// A table with what was brought back from a session that was left behind in `sessions`; not saved.
    pub fn recovered(recovered: Recovered, file: Option<PathBuf>, sessions: Option<&Path>) -> Self {
        let Recovered { document, journal, .. } = recovered;
        Self {
            document,
            journal: Some(journal),
            sessions: sessions.map(Path::to_path_buf),
            broken: None,
            file,
            saved: Scene::new(empty()),
            selection: Vec::new(),
            preview: None,
        }
    }

    /// The scene of an empty page: a union of nothing.
    pub fn empty_page() -> Scene {
        Scene::new(empty())
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The scene as it is.
    pub fn scene(&self) -> &Scene {
        self.document.scene()
    }

    /// The scene as it is to be shown: with what is being dragged.
    pub fn shown(&self) -> &Scene {
        self.preview.as_ref().unwrap_or(self.document.scene())
    }

    /// Whether something is being dragged.
    pub fn is_dragged(&self) -> bool {
        self.preview.is_some()
    }

    /// The user's file, if there is one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Whether anything was done since the scene was opened or saved, and not undone.
    pub fn is_unsaved(&self) -> bool {
        let now = self.scene();
        !NodeRef::ptr_eq(&now.root, &self.saved.root) || now.title != self.saved.title
    }

    /// Whether everything done is on disk.
    pub fn is_protected(&self) -> bool {
        self.journal.is_some()
    }

    /// The selected node, if it is exactly one.
    pub fn selected(&self) -> Option<&NodePath> {
        match &self.selection[..] {
            [only] => Some(only),
            _ => None,
        }
    }

    /// All selected nodes, in the order of the tree.
    pub fn selection(&self) -> &[NodePath] {
        &self.selection
    }

    /// The selected node, if it is exactly one.
    pub fn selected_node(&self) -> Option<&NodeRef> {
        self.selected()?.find(&self.scene().root)
    }

    /// Selects a node; one that is not there, and `None` select nothing.
    pub fn select(&mut self, path: Option<NodePath>) {
        self.select_all(path);
    }

    /// Selects these nodes; those that are not there, and those below others are left out.
    pub fn select_all(&mut self, paths: impl IntoIterator<Item = NodePath>) {
        self.selection.clear();
        for path in paths {
            let is_known = self.selection.contains(&path);
            if !is_known && path.find(&self.scene().root).is_some() {
                several::toggle(&mut self.selection, path);
            }
        }
    }

    /// Selects a node with those that are selected, or no longer.
    pub fn select_too(&mut self, path: NodePath) {
        if path.find(&self.scene().root).is_some() {
            several::toggle(&mut self.selection, path);
        }
    }

    /// Does something: writes it to the journal, then carries it out. What is being dragged is let go.
    pub fn act(&mut self, entry: JournalEntry) -> Result<Option<Change>, EditError> {
        self.preview = None;
        if let JournalEntry::Command(command) = &entry {
            // What cannot be carried out must not be in the journal.
            self.document.preview(command.clone())?;
        }
        let written =
            self.journal.as_mut().map_or(Ok(()), |journal| journal.add(&entry, self.document.scene()));
        let change = self.document.repeat(entry)?;
        let selection = std::mem::take(&mut self.selection);
        self.select_all(selection);
        if let Err(error) = written {
            self.broken = self.journal.take();
            self.protect().map_err(|_| error)?;
        } else if self.journal.is_none() {
            // The disk may still be full; the user knows.
            let _ = self.protect();
        }
        Ok(change)
    }

    /// Begins another journal with the scene as it is, if one is wanted.
    ///
    /// Errors: a folder that cannot be written.
    fn protect(&mut self) -> Result<(), JournalError> {
        let Some(sessions) = &self.sessions else { return Ok(()) };
        let file = self.file.as_deref();
        self.journal = Some(Journal::begin(sessions, self.document.scene(), file, self.is_unsaved())?);
        if let Some(broken) = self.broken.take() {
            broken.end();
        }
        Ok(())
    }

    /// Carries out a command; see [`Self::act`].
    pub fn apply(&mut self, command: Command) -> Result<Option<Change>, EditError> {
        self.act(JournalEntry::Command(command))
    }

    /// Shows what a command would do, without doing it; `None` shows the document again.
    ///
    /// Errors: a command that cannot be carried out; then the document is shown.
    pub fn drag(&mut self, command: Option<Command>) -> Result<(), CommandError> {
        self.preview = None;
        self.preview = command.map(|command| self.document.preview(command)).transpose()?;
        Ok(())
    }

    /// The scene, or an earlier one if it is no longer `as_it_is`, was saved to this file, which is the user's from now
    /// on.
    pub fn saved_as(&mut self, file: PathBuf, as_it_is: bool) {
        self.saved = if as_it_is { self.scene().clone() } else { Scene::new(empty()) };
        self.file = Some(file);
    }

    /// The scene is in no file, but this is the one that it may be saved as.
    pub fn will_be_in(&mut self, file: PathBuf) {
        self.file = Some(file);
    }

    /// The scene is in no file, whatever [`Self::file`] says it may be saved as.
    pub fn never_saved(&mut self) {
        self.saved = Scene::new(empty());
    }

    /// Begins another journal, with the scene as it is: what the one so far says is no longer true of its files.
    ///
    /// Errors: a folder that cannot be written; then nothing is protected.
    pub fn begin_journal(&mut self) -> Result<(), JournalError> {
        self.broken = self.journal.take().or(self.broken.take());
        self.protect()
    }

    /// Takes the document off the table: it is saved, or not wanted.
    pub fn close(self) {
        for journal in self.journal.into_iter().chain(self.broken) {
            journal.end();
        }
    }
}

fn empty() -> Node {
    union(Vec::<Node>::new())
}
