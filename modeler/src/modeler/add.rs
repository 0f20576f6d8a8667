//! Putting what was read beside the model.

use super::files::{folder_of, free_name};
use super::{Fetched, Modeler};
use crate::meshes;
use crate::workbench::EditError;
use blobtree::build::{Build as _, union};
use blobtree::{Aabb, Command, Node, NodePath, NodeRef, Operator, Shape, Tree, solid_box};
use glam::Vec3;

/// How far from the model a new part is put, mm.
const GAP: f32 = 5.0;

impl Modeler {
    /// Puts what was read beside the model, in one step.
    pub(crate) fn add(&mut self, fetched: Fetched) {
        let from = folder_of(&fetched.path);
        let has_meshes = meshes::any(&fetched.scene.root);
        // A page that is in no file can only name meshes once it is clear in which folder it will be.
        let goes_beside = has_meshes && self.bench.file().is_none();
        let to = if goes_beside { from.clone() } else { self.folder() };
        let scene = match meshes::moved(&fetched.scene, &from, &to) {
            Ok(scene) => scene,
            Err(error) => {
                return self.notices.warn(format!("Not added: {}: {error}", fetched.path.display()));
            }
        };
        let name = fetched.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let node = beside(&self.bench.scene().root, part(&scene.root, name));
        if goes_beside {
            self.bench.will_be_in(free_name(&fetched.path));
            if let Err(error) = self.bench.begin_journal() {
                self.notices.warn(EditError::from(error).to_string());
            }
        }
        let (command, path) = added(&self.bench.scene().root, node);
        if self.apply(command) {
            self.select(Some(path));
            self.camera.show(self.bounds().union(&self.selected_bounds()));
        }
    }

    /// Around the solid of what is selected, measured anew, mm.
    fn selected_bounds(&self) -> Aabb {
        let alone = self.bench.selected().and_then(|path| path.find_alone(&self.bench.scene().root));
        alone.map_or(Aabb::EMPTY, |alone| solid_box(&Tree::new(&alone)))
    }
}

/// A scene as one part, under a name if it has none.
fn part(root: &NodeRef, name: String) -> NodeRef {
    let only = match (&root.shape, root.children()) {
        (Shape::Operator(Operator::Union, _), [only]) if root.name.is_none() => only,
        _ => root,
    };
    match only.name {
        Some(_) => only.clone(),
        None => Node { name: Some(name), ..(**only).clone() }.into(),
    }
}

/// The part moved to the right of the model, on the same floor; where it was if there is no model.
fn beside(model: &NodeRef, part: NodeRef) -> NodeRef {
    let [there, own] = [model, &part].map(|root| solid_box(&Tree::new(root)));
    if there.is_empty() || own.is_empty() {
        return part;
    }
    let by =
        Vec3::new(there.max.x + GAP - own.min.x, there.center().y - own.center().y, there.min.z - own.min.z);
    let name = part.name.clone();
    let moved = part.translate(by.to_array());
    Node { name, ..moved }.into()
}

/// What adds a node to a tree, and where it is then.
pub(crate) fn added(root: &NodeRef, node: NodeRef) -> (Command, NodePath) {
    let top = NodePath::default();
    match &root.shape {
        Shape::Operator(Operator::Union, children) => {
            let index = children.len();
            (Command::Insert { parent: top.clone(), index, node }, top.child(index))
        }
        _ => {
            let both = union([(**root).clone(), (*node).clone()]);
            (Command::Replace { path: top.clone(), node: both.into() }, top.child(1))
        }
    }
}
