//! Lines of journals: the parts of scene files, put together to say what was done to a document.
//!
//! A line is an object with `format`, `version` (that of the scene format, whose nodes it holds), `do`, and the
//! fields of what was done. What is said of scene files holds for it, too. Nodes may refer to the scene before:
//! by `use` to its definitions, and by `kept` to the nodes of its tree.

mod before;
mod read;
mod write;

use crate::document::NewShape;
use crate::node::{Node, Shape};
use crate::operator::Operator;
pub(super) use before::Before;
pub(crate) use read::read;
pub(crate) use write::write;

/// The word by which a line says what it is.
const FORMAT: &str = "trullo-journal";

/// A shape as a line holds it; where it has children, with none that matter.
pub(super) fn childless(shape: NewShape) -> Shape {
    let nothing = || Node::new(Shape::Operator(Operator::Union, Vec::new())).into();
    match shape {
        NewShape::Primitive(primitive) => Shape::Primitive(primitive),
        NewShape::Operator(operator) => Shape::Operator(operator, Vec::new()),
        NewShape::Warp(warp) => Shape::Warp(warp, nothing()),
        NewShape::SupportFree(rule) => Shape::SupportFree(rule, nothing()),
    }
}

/// What can be done, each with its own fields.
const WORDS: [(&str, &[&str]); 17] = [
    ("insert", &["parent", "index", "define", "node"]),
    ("remove", &["path"]),
    ("replace", &["path", "define", "node"]),
    ("move", &["from", "parent", "index"]),
    ("wrap", &["path", "shape"]),
    ("unwrap", &["path"]),
    ("set_shape", &["path", "shape"]),
    ("add_stroke", &["path", "stroke"]),
    ("remove_stroke", &["path", "index"]),
    ("set_name", &["path", "name"]),
    ("set_color", &["path", "color"]),
    ("set_muted", &["path", "muted"]),
    ("set_construction", &["path", "construction"]),
    ("set_title", &["title"]),
    ("together", &["commands"]),
    ("undo", &[]),
    ("redo", &[]),
];

#[cfg(test)]
mod tests;
