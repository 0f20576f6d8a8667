//! The document on the table: its file, its journal, what is selected, and the one way to change it.

use crate::journal::{Journal, JournalError, Recovered};
use crate::several;
use crate::variants::{Variants, Vary, VaryError};
use blobtree::build::union;
use blobtree::{
    Change, Command, CommandError, Document, JournalEntry, Node, NodePath, NodeRef, Scene, SceneError,
};
use std::path::{Path, PathBuf};

/// A document being worked on.
#[derive(Debug)]
pub struct Workbench {
    variants: Variants,
    /// Where everything done is written first; none if that is not possible or not wanted.
    journal: Option<Journal>,
    /// The folder for journals, if one is wanted.
    sessions: Option<PathBuf>,
    /// A journal that could not be gone on with. What it holds is kept until another one holds more.
    broken: Option<Journal>,
    /// The user's file, if there is one.
    file: Option<PathBuf>,
    /// What was opened or saved; none if it is in no file.
    saved: Option<Snapshot>,
    /// The selected nodes, sorted; always ones that are there, and none below another one.
    selection: Vec<NodePath>,
    /// What is shown instead of the document while something is dragged, and the command that makes it.
    preview: Option<(Command, Scene)>,
}

/// What is in a file, by the addresses of the roots of all variants.
#[derive(Clone, Debug)]
pub struct Snapshot {
    title: Option<String>,
    roots: Vec<(String, NodeRef)>,
}

impl PartialEq for Snapshot {
    fn eq(&self, other: &Self) -> bool {
        let same =
            |((a, x), (b, y)): (&(String, NodeRef), &(String, NodeRef))| a == b && NodeRef::ptr_eq(x, y);
        self.title == other.title
            && self.roots.len() == other.roots.len()
            && self.roots.iter().zip(&other.roots).all(same)
    }
}

/// What became of something that was to be done.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// It cannot be carried out; nothing has changed.
    #[error("{0}")]
    Command(#[from] CommandError),
    /// It cannot be done to variants; nothing has changed.
    #[error("{0}")]
    Vary(#[from] VaryError),
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
        let variants = Variants::of(scene.clone())?;
        let journal =
            sessions.map(|sessions| Journal::begin(sessions, &scene, file.as_deref(), false)).transpose();
        let (journal, error) = match journal {
            Ok(journal) => (journal, None),
            Err(error) => (None, Some(error)),
        };
        let mut bench = Self {
            variants,
            journal,
            sessions: sessions.map(Path::to_path_buf),
            broken: None,
            file,
            saved: None,
            selection: Vec::new(),
            preview: None,
        };
        bench.saved = Some(bench.snapshot());
        Ok((bench, error))
    }

    /// A table with what was brought back from a session that was left behind in `sessions`; not saved.
    pub fn recovered(recovered: Recovered, file: Option<PathBuf>, sessions: Option<&Path>) -> Self {
        let Recovered { variants, journal, .. } = recovered;
        Self {
            variants,
            journal: Some(journal),
            sessions: sessions.map(Path::to_path_buf),
            broken: None,
            file,
            saved: None,
            selection: Vec::new(),
            preview: None,
        }
    }

    /// The scene of an empty page: a union of nothing.
    pub fn empty_page() -> Scene {
        Scene::new(empty())
    }

    /// The document in hand.
    pub fn document(&self) -> &Document {
        self.variants.document()
    }

    /// The document with those that are kept beside it.
    pub fn variants(&self) -> &Variants {
        &self.variants
    }

    /// The scene as it is.
    pub fn scene(&self) -> &Scene {
        self.variants.document().scene()
    }

    /// The scene as it is to be shown: with what is being dragged.
    pub fn shown(&self) -> &Scene {
        self.preview.as_ref().map_or(self.scene(), |(_, scene)| scene)
    }

    /// Whether something is being dragged.
    pub fn is_dragged(&self) -> bool {
        self.preview.is_some()
    }

    /// What is being dragged: the command that would do it.
    pub fn dragged(&self) -> Option<&Command> {
        self.preview.as_ref().map(|(command, _)| command)
    }

    /// The user's file, if there is one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Whether anything was done since the scene was opened or saved, and not undone.
    pub fn is_unsaved(&self) -> bool {
        self.saved.as_ref() != Some(&self.snapshot())
    }

    /// The document as it is now.
    pub fn snapshot(&self) -> Snapshot {
        let roots = self.variants.all().map(|(name, root, _)| (name.to_owned(), root.clone())).collect();
        Snapshot { title: self.scene().title.clone(), roots }
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
            self.variants.document().preview(command.clone())?;
        }
        let written = self
            .journal
            .as_mut()
            .map_or(Ok(()), |journal| journal.add(&entry, self.variants.document().scene()));
        let change = self.variants.repeat(entry)?;
        let selection = std::mem::take(&mut self.selection);
        self.select_all(selection);
        self.keep(written)?;
        Ok(change)
    }

    /// Does something to variants: writes it to the journal, and carries it out.
    pub fn vary(&mut self, vary: Vary) -> Result<(), EditError> {
        self.preview = None;
        // What cannot be carried out must not be in the journal.
        let mut variants = self.variants.clone();
        variants.vary(vary.clone())?;
        let written = self.journal.as_mut().map_or(Ok(()), |journal| journal.add_vary(&vary));
        self.variants = variants;
        self.select(None);
        self.keep(written)
    }

    /// Sees to it that what was done is protected, if it could not be `written`.
    fn keep(&mut self, written: Result<(), JournalError>) -> Result<(), EditError> {
        if let Err(error) = written {
            self.broken = self.journal.take();
            self.protect().map_err(|_| error)?;
        } else if self.journal.is_none() {
            // The disk may still be full; the user knows.
            let _ = self.protect();
        }
        Ok(())
    }

    /// Begins another journal with the scene as it is, if one is wanted.
    ///
    /// Errors: a folder that cannot be written.
    fn protect(&mut self) -> Result<(), JournalError> {
        let Some(sessions) = &self.sessions else { return Ok(()) };
        let file = self.file.as_deref();
        self.journal = Some(Journal::begin(sessions, &self.variants.whole(), file, self.is_unsaved())?);
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
        // A hand that holds still changes nothing, so that what is shown may become fine.
        if matches!((&self.preview, &command), (Some((known, _)), Some(command)) if known == command) {
            return Ok(());
        }
        self.preview = None;
        let document = self.variants.document();
        let shown = command.map(|command| Ok((command.clone(), document.preview(command)?)));
        self.preview = shown.transpose()?;
        Ok(())
    }

    /// What was saved is in this file, which is the user's from now on.
    pub fn saved_as(&mut self, file: PathBuf, saved: Snapshot) {
        (self.saved, self.file) = (Some(saved), Some(file));
    }

    /// Names meshes that are named from one folder from another; whether that changed anything.
    ///
    /// Errors: a mesh or a folder that is not there; then nothing has changed.
    pub fn rename_meshes(&mut self, from: &Path, to: &Path) -> std::io::Result<bool> {
        self.variants.rename_meshes(from, to)
    }

    /// The scene is in no file, but this is the one that it may be saved as.
    pub fn will_be_in(&mut self, file: PathBuf) {
        self.file = Some(file);
    }

    /// The scene is in no file, whatever [`Self::file`] says it may be saved as.
    pub fn never_saved(&mut self) {
        self.saved = None;
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
