//! What was done to a document, as text: one line for each thing, so that it can be done again.

use super::{Change, Command, CommandError, Document};
use crate::scene::{Scene, SceneError, SceneSources, journal};

/// One thing done to a document. A scene and all entries since, in order, are a document with its history.
///
/// ```
/// use blobtree::build::{point, union};
/// use blobtree::{Command, Document, JournalEntry, NoSources, NodePath, Scene};
///
/// let scene = Scene::new(union([point([0., 0., 5.], 5.)]));
/// let entry = JournalEntry::Command(Command::SetMuted { path: NodePath::default().child(0), muted: true });
/// let line = entry.to_line(&scene)?;
/// assert_eq!(line, r#"{"format":"trullo-journal","version":1,"do":"set_muted","path":"/0","muted":true}"#);
///
/// let mut document = Document::new(scene)?;
/// let again = JournalEntry::from_line(line.as_bytes(), document.scene(), &mut NoSources)?;
/// assert_eq!(again, entry);
/// document.repeat(again).expect("it could be done the first time");
/// assert!(document.scene().root.children()[0].muted);
/// # Ok::<(), blobtree::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum JournalEntry {
    /// A command was carried out.
    Command(Command),
    /// A step was taken back.
    Undo,
    /// A step that was taken back was taken again.
    Redo,
}

impl JournalEntry {
    /// The entry as JSON on one line, without a line break. `docs/scene-format.md` says what it looks like.
    ///
    /// - **In:** `scene` is the document's before the entry. Nodes of a command that stand in it, or are among
    ///   its definitions, are written as references to them; all others in full.
    /// - **Promises:** [`Self::from_line`] with an equal scene gives an equal entry back, bit by bit, and its
    ///   command shares the same nodes with the scene.
    /// - **Errors:** a command with nodes or parameters that no document allows.
    /// - **Cost:** linear in the text, and one walk over the scene for commands that bring nodes along.
    pub fn to_line(&self, scene: &Scene) -> Result<String, SceneError> {
        journal::write(self, scene)
    }

    /// Reads an entry.
    ///
    /// - **In:** `scene` is the document's before the entry. What it has loaded and solved, `sources` are not
    ///   asked for again.
    /// - **Promises:** nodes and parameters are legal by themselves; whether the command can be carried out is
    ///   for the document to say.
    /// - **Errors:** as [`Scene::from_bytes`], with the same limits; places are those in the line.
    /// - **Cost:** linear in the text; with drawings or meshes, one walk over the scene.
    pub fn from_line(line: &[u8], scene: &Scene, sources: &mut dyn SceneSources) -> Result<Self, SceneError> {
        journal::read(line, scene, sources)
    }
}

impl Document {
    /// Does what the entry says: [`Self::apply`], [`Self::undo`] or [`Self::redo`]. `None` if there was nothing
    /// to be undone or redone.
    ///
    /// Errors: as [`Self::apply`].
    pub fn repeat(&mut self, entry: JournalEntry) -> Result<Option<Change>, CommandError> {
        match entry {
            JournalEntry::Command(command) => self.apply(command).map(Some),
            JournalEntry::Undo => Ok(self.undo()),
            JournalEntry::Redo => Ok(self.redo()),
        }
    }
}
