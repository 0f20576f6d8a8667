//! The document: a scene, its history, and the only way to change it.
//!
//! A scene is never changed in place. A command makes a new root that shares all it can with the old one, so
//! that undo and redo give back the very same allocations and every cache that hangs on them is still warm.

mod apply;
mod command;
mod journal;
mod save;

use crate::node::NodeRef;
use crate::scene::{Scene, SceneError};
pub use command::{Command, CommandError, NewShape};
pub use journal::JournalEntry;
pub use save::{DEFAULT_OLDER_VERSIONS, SaveError, write_atomically};
use std::collections::VecDeque;
use std::path::Path;

/// Most steps that can be undone; the oldest are forgotten first. A drawing that was solved takes about half a MiB, and
/// each step may keep one.
pub const HISTORY_LIMIT: usize = 1000;

/// A scene being edited, with its history.
#[derive(Clone, Debug)]
pub struct Document {
    /// All states that undo and redo can reach, oldest first. Never empty.
    states: VecDeque<State>,
    /// Which of them is now.
    now: usize,
}

#[derive(Clone, Debug)]
struct State {
    /// The name of the command that led here; empty for the first state.
    made_by: String,
    scene: Scene,
}

/// What a step did. Nodes outside the changed places are the same allocations in both trees, so comparing
/// addresses from the roots down finds what changed.
#[derive(Clone, Debug)]
pub struct Change {
    /// The step's name for the history, such as "Move head".
    pub name: String,
    /// The root before; the same allocation as `after` if the tree did not change.
    pub before: NodeRef,
    /// The root after.
    pub after: NodeRef,
}

impl Document {
    /// A document without history.
    ///
    /// Errors: a scene that [`Scene::check`] refuses.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        scene.check()?;
        Ok(Self { states: VecDeque::from([State { made_by: String::new(), scene }]), now: 0 })
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.states[self.now].scene
    }

    /// Carries out a command. What could be redone is forgotten. A command that leaves all as it is makes no
    /// step in the history.
    ///
    /// - **Promises:** the scene stays one that [`Scene::check`] allows.
    /// - **Errors:** a command that cannot be carried out; then nothing has changed.
    /// - **Cost:** the nodes on the way to the changed place, with their lists of children; and, unless only
    ///   a name, a colour or a sign changes, one walk over the different nodes of the tree.
    pub fn apply(&mut self, command: Command) -> Result<Change, CommandError> {
        let name = command.name(&self.scene().root);
        let before = self.scene().root.clone();
        let scene = apply::apply(self.scene(), command)?;
        let change = Change { name: name.clone(), before, after: scene.root.clone() };
        if change.before_is_after() && scene.title == self.scene().title {
            return Ok(change);
        }
        self.states.truncate(self.now + 1);
        self.states.push_back(State { made_by: name, scene });
        if self.states.len() > HISTORY_LIMIT + 1 {
            self.states.pop_front();
        }
        self.now = self.states.len() - 1;
        Ok(change)
    }

    /// What [`Self::apply`] would make of the scene, without a step in the history: for what is still being dragged.
    ///
    /// Errors and cost: as [`Self::apply`].
    pub fn preview(&self, command: Command) -> Result<Scene, CommandError> {
        apply::apply(self.scene(), command)
    }

    /// Goes back one step; `None` at the first.
    pub fn undo(&mut self) -> Option<Change> {
        let to = self.now.checked_sub(1)?;
        Some(self.go_to(to, self.now))
    }

    /// Goes forward again one step that was undone; `None` at the last.
    pub fn redo(&mut self) -> Option<Change> {
        let to = self.now + 1;
        (to < self.states.len()).then(|| self.go_to(to, to))
    }

    /// The names of the steps that undo would take back, the next one first.
    pub fn undo_names(&self) -> impl Iterator<Item = &str> {
        self.states.range(1..=self.now).rev().map(|state| &*state.made_by)
    }

    /// The names of the steps that redo would take, the next one first.
    pub fn redo_names(&self) -> impl Iterator<Item = &str> {
        self.states.range(self.now + 1..).map(|state| &*state.made_by)
    }

    /// Saves the scene, keeping [`DEFAULT_OLDER_VERSIONS`] older versions of the file.
    ///
    /// Errors: as [`Scene::to_text`] and [`write_atomically`]; then the file is as it was.
    pub fn save(&self, path: &Path) -> Result<(), SaveError> {
        write_atomically(path, self.scene().to_text()?.as_bytes(), DEFAULT_OLDER_VERSIONS)
    }

    fn go_to(&mut self, to: usize, named: usize) -> Change {
        let before = self.scene().root.clone();
        self.now = to;
        Change { name: self.states[named].made_by.clone(), before, after: self.scene().root.clone() }
    }
}

impl Change {
    fn before_is_after(&self) -> bool {
        NodeRef::ptr_eq(&self.before, &self.after)
    }
}

#[cfg(test)]
mod tests;
