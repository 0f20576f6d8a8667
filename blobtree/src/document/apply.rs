//! How commands make new scenes from old ones.

use super::command::{Command, CommandError, NewShape};
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::scene::{Scene, measure};
use crate::support_free::BrushStroke;
use std::sync::Arc;

/// The scene after the command. Errors: as [`super::Document::apply`].
pub(super) fn apply(scene: &Scene, command: Command) -> Result<Scene, CommandError> {
    let root = &scene.root;
    let may_be_illegal = matches!(
        command,
        Command::Insert { .. }
            | Command::Replace { .. }
            | Command::Move { .. }
            | Command::WrapInOperator { .. }
            | Command::WrapInWarp { .. }
            | Command::WrapInSupportFree { .. }
            | Command::SetShape { .. }
            | Command::AddStroke { .. }
    );
    let new_root = match command {
        Command::Insert { parent, index, node } => insert(root, &parent, index, node)?,
        Command::Remove { path } => take(root, &path)?.0,
        Command::Replace { path, node } => edit(root, &path, |_| Ok(node))?,
        Command::Move { from, parent, index } => move_to(root, &from, parent, index)?,
        Command::WrapInOperator { path, operator } => {
            edit(root, &path, |node| Ok(Node::new(Shape::Operator(operator, vec![node.clone()])).into()))?
        }
        Command::WrapInWarp { path, warp } => {
            edit(root, &path, |node| Ok(Node::new(Shape::Warp(warp, node.clone())).into()))?
        }
        Command::WrapInSupportFree { path, rule } => {
            edit(root, &path, |node| Ok(Node::new(Shape::SupportFree(rule, node.clone())).into()))?
        }
        Command::Unwrap { path } => edit(root, &path, |node| match node.children() {
            [child] => Ok(child.clone()),
            children => Err(CommandError::NotAWrapper { path: path.clone(), len: children.len() }),
        })?,
        Command::SetShape { path, shape } => edit(root, &path, |node| {
            change(node, Node { shape: reshaped(node, shape, &path)?, ..(**node).clone() })
        })?,
        Command::AddStroke { path, stroke } => edit_strokes(root, &path, |strokes| {
            strokes.push(stroke);
            Ok(())
        })?,
        Command::RemoveStroke { path, index } => edit_strokes(root, &path, |strokes| {
            let len = strokes.len();
            if index >= len {
                return Err(CommandError::NoSuchStroke { path: path.clone(), index, len });
            }
            strokes.remove(index);
            Ok(())
        })?,
        Command::SetName { path, name } => {
            edit(root, &path, |node| change(node, Node { name, ..(**node).clone() }))?
        }
        Command::SetColor { path, color } => {
            edit(root, &path, |node| change(node, Node { color, ..(**node).clone() }))?
        }
        Command::SetMuted { path, muted } => {
            edit(root, &path, |node| change(node, Node { muted, ..(**node).clone() }))?
        }
        Command::SetConstruction { path, construction } => {
            edit(root, &path, |node| change(node, Node { construction, ..(**node).clone() }))?
        }
        Command::Together(commands) => {
            return commands.into_iter().try_fold(scene.clone(), |scene, command| apply(&scene, command));
        }
        Command::SetTitle { title } => return Ok(Scene { title, ..scene.clone() }),
    };
    if may_be_illegal && !NodeRef::ptr_eq(&new_root, root) {
        measure(&new_root).map_err(CommandError::Illegal)?;
    }
    Ok(Scene { root: new_root, ..scene.clone() })
}

/// The tree with another node at `path`; the same root if `to` gives back the same node.
fn edit(
    root: &NodeRef,
    path: &NodePath,
    to: impl FnOnce(&NodeRef) -> Result<NodeRef, CommandError>,
) -> Result<NodeRef, CommandError> {
    let mut way = vec![root];
    for &index in &path.0 {
        let next = way.last().and_then(|node| node.children().get(index));
        way.push(next.ok_or_else(|| CommandError::NoSuchNode(path.clone()))?);
    }
    let old = way.pop().expect("the way begins with the root");
    let mut new = to(old)?;
    if NodeRef::ptr_eq(&new, old) {
        return Ok(root.clone());
    }
    for (node, &index) in way.into_iter().zip(&path.0).rev() {
        let mut copy = (**node).clone();
        match &mut copy.shape {
            Shape::Operator(_, children) => children[index] = new,
            Shape::Warp(_, child) | Shape::SupportFree(_, child) => *child = new,
            Shape::Primitive(_) => {
                unreachable!("the way goes through children, which primitives do not have")
            }
        }
        new = copy.into();
    }
    Ok(new)
}

/// The new node, or the old one if they are equal.
///
/// Comparing the children costs little: they are the same allocations, which are equal at a glance.
fn change(old: &NodeRef, new: Node) -> Result<NodeRef, CommandError> {
    let same_children =
        old.children().iter().map(NodeRef::as_ptr).eq(new.children().iter().map(NodeRef::as_ptr));
    let same = same_children
        && (&old.name, old.color, old.muted, old.construction)
            == (&new.name, new.color, new.muted, new.construction)
        && NewShape::from(&old.shape) == NewShape::from(&new.shape);
    Ok(if same { old.clone() } else { new.into() })
}

fn reshaped(node: &Node, wanted: NewShape, path: &NodePath) -> Result<Shape, CommandError> {
    match (&node.shape, wanted) {
        (Shape::Primitive(_), NewShape::Primitive(primitive)) => Ok(Shape::Primitive(primitive)),
        (Shape::Operator(_, children), NewShape::Operator(operator)) => {
            Ok(Shape::Operator(operator, children.clone()))
        }
        (Shape::Warp(_, child), NewShape::Warp(warp)) => Ok(Shape::Warp(warp, child.clone())),
        (Shape::SupportFree(_, child), NewShape::SupportFree(rule)) => {
            Ok(Shape::SupportFree(rule, child.clone()))
        }
        (_, wanted) => Err(CommandError::OtherKind {
            path: path.clone(),
            type_name: node.type_name(),
            wanted: wanted.type_name(),
        }),
    }
}

/// The tree with other brush strokes of the support-free node at `path`.
fn edit_strokes(
    root: &NodeRef,
    path: &NodePath,
    to: impl FnOnce(&mut Vec<Arc<BrushStroke>>) -> Result<(), CommandError>,
) -> Result<NodeRef, CommandError> {
    edit(root, path, |node| {
        let mut copy = (**node).clone();
        let Shape::SupportFree(rule, _) = &mut copy.shape else {
            return Err(CommandError::NotSupportFree { path: path.clone(), type_name: node.type_name() });
        };
        to(&mut rule.strokes)?;
        Ok(copy.into())
    })
}

/// The tree with other children of the operator at `path`.
fn edit_children(
    root: &NodeRef,
    path: &NodePath,
    to: impl FnOnce(&mut Vec<NodeRef>) -> Result<(), CommandError>,
) -> Result<NodeRef, CommandError> {
    edit(root, path, |node| {
        let mut copy = (**node).clone();
        let Shape::Operator(_, children) = &mut copy.shape else {
            return Err(CommandError::NotAnOperator { path: path.clone(), type_name: node.type_name() });
        };
        to(children)?;
        Ok(copy.into())
    })
}

fn insert(root: &NodeRef, parent: &NodePath, index: usize, node: NodeRef) -> Result<NodeRef, CommandError> {
    edit_children(root, parent, |children| {
        if index > children.len() {
            return Err(CommandError::BeyondTheEnd { parent: parent.clone(), index, len: children.len() });
        }
        children.insert(index, node);
        Ok(())
    })
}

/// The tree without the node at `path`, and that node.
fn take(root: &NodeRef, path: &NodePath) -> Result<(NodeRef, NodeRef), CommandError> {
    let node = path.find(root).ok_or_else(|| CommandError::NoSuchNode(path.clone()))?;
    let taken = path.parent().and_then(|parent| {
        let in_operator = matches!(parent.find(root)?.shape, Shape::Operator(..));
        in_operator.then_some((parent, *path.0.last()?))
    });
    let (parent, index) = taken.ok_or_else(|| CommandError::CannotBeTaken(path.clone()))?;
    let rest = edit_children(root, &parent, |children| {
        children.remove(index);
        Ok(())
    })?;
    Ok((rest, node.clone()))
}

fn move_to(
    root: &NodeRef,
    from: &NodePath,
    mut parent: NodePath,
    mut index: usize,
) -> Result<NodeRef, CommandError> {
    let new_parent = parent.find(root).ok_or_else(|| CommandError::NoSuchNode(parent.clone()))?;
    let len = new_parent.children().len();
    if parent.0.starts_with(&from.0) {
        return Err(CommandError::IntoItself { from: from.clone(), parent });
    }
    if index > len {
        return Err(CommandError::BeyondTheEnd { parent, index, len });
    }
    let (without, node) = take(root, from)?;
    let (&gone, old_parent) = from.0.split_last().expect("the root cannot be taken");
    if parent.0 == old_parent {
        if index == gone || index == gone + 1 {
            return Ok(root.clone());
        }
        index -= usize::from(index > gone);
    } else if parent.0.starts_with(old_parent) {
        // The way to the new parent leads through a sibling that may have moved up.
        let sibling = &mut parent.0[old_parent.len()];
        *sibling -= usize::from(*sibling > gone);
    }
    insert(&without, &parent, index, node)
}
