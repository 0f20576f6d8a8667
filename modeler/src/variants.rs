//! States of a document side by side, each with its own history; one of them is in hand.
//!
//! In a scene file they are definitions whose names begin with `variant/`; the one in hand is the one that the root uses.

use crate::meshes;
use blobtree::{Command, CommandError, Document, JournalEntry, NodeRef, Scene, SceneError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// The beginning of the names of definitions that are variants.
const MARK: &str = "variant/";

/// Most variants of a document.
pub const MOST: usize = 50;

/// Longest name, characters.
const LONGEST: usize = 60;

/// Something done to variants, as the journal has it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "variant", rename_all = "snake_case", deny_unknown_fields)]
pub enum Vary {
    /// What is in hand stays as it is, under its name; the work goes on in a copy with this name.
    Keep {
        /// The new name.
        name: String,
    },
    /// Another one is taken in hand.
    Switch {
        /// Its name.
        name: String,
    },
    /// One gets another name.
    Rename {
        /// The old one.
        name: String,
        /// The new one.
        to: String,
    },
    /// One that is not in hand is thrown away, with its history.
    Remove {
        /// Its name.
        name: String,
    },
}

/// Why something cannot be done to variants.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VaryError {
    /// There is none of this name.
    #[error("there is no variant {0:?}")]
    NoSuch(String),
    /// A name that cannot be used.
    #[error(
        "a variant's name has 1 to {LONGEST} characters and is no other variant's; {0:?} is not possible"
    )]
    Name(String),
    /// There are too many.
    #[error("a document has at most {MOST} variants; remove one first")]
    TooMany,
    /// It is in hand.
    #[error("the variant {0:?} is in hand; take another one first")]
    InHand(String),
}

/// A state of the document.
#[derive(Clone, Debug)]
struct Variant {
    name: String,
    document: Document,
}

/// All of them. There is always one in hand; a single one has no need of a name.
#[derive(Clone, Debug)]
pub struct Variants {
    list: Vec<Variant>,
    now: usize,
}

impl Variants {
    /// The variants that a scene holds.
    ///
    /// Errors: as [`Document::new`].
    pub fn of(scene: Scene) -> Result<Self, SceneError> {
        let is_variant = |name: &str| name.starts_with(MARK);
        let (mut list, mut now) = (Vec::new(), None);
        let plain: BTreeMap<String, NodeRef> = scene
            .definitions
            .iter()
            .filter(|(name, _)| !is_variant(name))
            .map(|(name, node)| (name.clone(), node.clone()))
            .collect();
        let plain = Arc::new(plain);
        for (name, root) in scene.definitions.iter().filter(|(name, _)| is_variant(name)).take(MOST) {
            if NodeRef::ptr_eq(root, &scene.root) {
                now = Some(list.len());
            }
            let scene = Scene { title: scene.title.clone(), definitions: plain.clone(), root: root.clone() };
            list.push(Variant { name: name[MARK.len()..].into(), document: Document::new(scene)? });
        }
        let now = match now {
            Some(now) => now,
            None => {
                let scene = Scene { definitions: plain, ..scene };
                list.push(Variant { name: String::new(), document: Document::new(scene)? });
                list.len() - 1
            }
        };
        let mut variants = Self { list, now };
        if variants.list.len() > 1 && variants.name().is_empty() {
            variants.list[now].name = variants.free_name();
        }
        Ok(variants)
    }

    /// The scene in hand with all the others, as a file has it.
    pub fn whole(&self) -> Scene {
        let scene = self.document().scene().clone();
        if self.list.len() == 1 {
            return scene;
        }
        let mut definitions = (*scene.definitions).clone();
        let named =
            |variant: &Variant| (format!("{MARK}{}", variant.name), variant.document.scene().root.clone());
        definitions.extend(self.list.iter().map(named));
        Scene { definitions: Arc::new(definitions), ..scene }
    }

    /// The document in hand.
    pub fn document(&self) -> &Document {
        &self.list[self.now].document
    }

    /// The name of the one in hand; empty if it has none.
    pub fn name(&self) -> &str {
        &self.list[self.now].name
    }

    /// The names and the roots of all, in their order, and whether each is in hand.
    pub fn all(&self) -> impl Iterator<Item = (&str, &NodeRef, bool)> {
        self.list
            .iter()
            .enumerate()
            .map(|(place, Variant { name, document })| (&**name, &document.scene().root, place == self.now))
    }

    /// A name that none has yet.
    pub fn free_name(&self) -> String {
        let mut names = (self.list.len() + 1..).map(|number| format!("Variant {number}"));
        names.find(|name| self.find(name).is_none()).unwrap_or_default()
    }

    /// Does something to the document in hand.
    ///
    /// Errors: as [`Document::repeat`].
    pub fn repeat(&mut self, entry: JournalEntry) -> Result<Option<blobtree::Change>, CommandError> {
        self.list[self.now].document.repeat(entry)
    }

    /// Names meshes that are named from one folder from another; whether that changed anything.
    ///
    /// Errors: a mesh or a folder that is not there; then nothing has changed.
    pub fn rename_meshes(&mut self, from: &Path, to: &Path) -> io::Result<bool> {
        let renamed = |variant: &Variant| meshes::renamed(&variant.document.scene().root, from, to);
        let all: Vec<Vec<Command>> = self.list.iter().map(renamed).collect::<io::Result<_>>()?;
        let renames = all.iter().any(|commands| !commands.is_empty());
        for (variant, commands) in self.list.iter_mut().zip(all) {
            for command in commands {
                variant.document.apply(command).map_err(io::Error::other)?;
            }
        }
        Ok(renames)
    }

    /// Does something to variants.
    ///
    /// Errors: what cannot be done; then nothing has changed.
    pub fn vary(&mut self, vary: Vary) -> Result<(), VaryError> {
        match vary {
            Vary::Keep { name } => {
                self.check_name(&name)?;
                if self.list.len() >= MOST {
                    return Err(VaryError::TooMany);
                }
                if self.name().is_empty() {
                    let first = "Variant 1".to_owned();
                    self.list[self.now].name = if name == first { "The first".into() } else { first };
                }
                let document = self.document().clone();
                self.now += 1;
                self.list.insert(self.now, Variant { name, document });
            }
            Vary::Switch { name } => self.now = self.place(name)?,
            Vary::Rename { name, to } => {
                let place = self.place(name)?;
                self.check_name(&to)?;
                self.list[place].name = to;
            }
            Vary::Remove { name } => {
                let place = self.place(name.clone())?;
                if place == self.now {
                    return Err(VaryError::InHand(name));
                }
                self.list.remove(place);
                self.now -= usize::from(place < self.now);
            }
        }
        Ok(())
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.list.iter().position(|variant| variant.name == name)
    }

    fn place(&self, name: String) -> Result<usize, VaryError> {
        self.find(&name).ok_or(VaryError::NoSuch(name))
    }

    fn check_name(&self, name: &str) -> Result<(), VaryError> {
        let fits = (1..=LONGEST).contains(&name.chars().count()) && self.find(name).is_none();
        fits.then_some(()).ok_or_else(|| VaryError::Name(name.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{point, union};
    use blobtree::{NoSources, NodePath};

    fn names(variants: &Variants) -> Vec<&str> {
        variants.all().map(|(name, ..)| name).collect()
    }

    fn keep(name: &str) -> Vary {
        Vary::Keep { name: name.into() }
    }

    #[test]
    fn variants_go_into_a_scene_and_come_out_of_its_text_with_the_same_one_in_hand() {
        let scene = Scene::new(union([point([0., 0., 5.], 5.)])).titled("Balls");
        let mut variants = Variants::of(scene.clone()).expect("legal");
        assert_eq!(variants.whole(), scene);
        variants.vary(keep("Two")).expect("a name");
        let node = point([9., 0., 5.], 5.).into();
        let insert = Command::Insert { parent: NodePath::default(), index: 1, node };
        variants.repeat(JournalEntry::Command(insert)).expect("possible");
        variants.vary(keep("Three")).expect("a name");
        variants.vary(Vary::Switch { name: "Two".into() }).expect("it is there");
        let text = variants.whole().to_text().expect("legal");
        let back = Scene::from_bytes(text.as_bytes(), &mut NoSources).expect("legal");
        let back = Variants::of(back).expect("legal");
        assert_eq!(back.name(), "Two");
        // What variants share has become a definition; nothing else has changed.
        let [back_scene, scene] = [&back, &variants].map(|variants| variants.document().scene());
        assert_eq!((&back_scene.title, &back_scene.root), (&scene.title, &scene.root));
        let counts = |name: &str| {
            let (_, root, _) = back.all().find(|(known, ..)| *known == name).expect("it is there");
            root.children().len()
        };
        assert_eq!(["Variant 1", "Two", "Three"].map(counts), [1, 2, 2]);
    }

    #[test]
    fn what_cannot_be_done_is_refused_and_changes_nothing() {
        let mut variants = Variants::of(Scene::new(union([point([0., 0., 5.], 5.)]))).expect("legal");
        variants.vary(keep("Two")).expect("a name");
        let refused = [
            keep("Two"),
            keep(""),
            keep(&"x".repeat(61)),
            Vary::Switch { name: "None".into() },
            Vary::Remove { name: "Two".into() },
            Vary::Rename { name: "Two".into(), to: "Variant 1".into() },
        ];
        for vary in refused {
            assert!(variants.vary(vary.clone()).is_err(), "{vary:?}");
            assert_eq!((names(&variants), variants.name()), (vec!["Variant 1", "Two"], "Two"));
        }
        variants.vary(Vary::Remove { name: "Variant 1".into() }).expect("it is not in hand");
        assert_eq!((names(&variants), variants.name()), (vec!["Two"], "Two"));
    }
}
