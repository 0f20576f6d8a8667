//! What can be done to a scene.

use crate::node::{Color, Node, NodePath, NodeRef, Shape};
use crate::operator::Operator;
use crate::scene::SceneError;
use crate::support_free::{BrushStroke, SupportFree};
use crate::warp::{Transform, Warp};
use std::sync::Arc;

/// One edit. Every path and index means the tree as it is before the edit.
///
/// A node that is shared changes only at the place that the path names.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Command {
    /// Puts a node among the children of an operator.
    Insert {
        /// The operator.
        parent: NodePath,
        /// The new node's place among the children; their number for the end.
        index: usize,
        /// The new node.
        node: NodeRef,
    },
    /// Takes a node away, with all below it.
    Remove {
        /// A child of an operator.
        path: NodePath,
    },
    /// Puts another node in a node's place.
    Replace {
        /// The old node.
        path: NodePath,
        /// The new node.
        node: NodeRef,
    },
    /// Moves a node, with all below it, among the children of an operator.
    Move {
        /// The node, a child of an operator.
        from: NodePath,
        /// The operator: not the node itself nor below it.
        parent: NodePath,
        /// The child in front of which the node goes; the number of children for the end.
        index: usize,
    },
    /// Puts an operator in a node's place, with the node as its only child.
    WrapInOperator {
        /// The node.
        path: NodePath,
        /// The operator.
        operator: Operator,
    },
    /// Puts a warp in a node's place, with the node as its child.
    WrapInWarp {
        /// The node.
        path: NodePath,
        /// The warp.
        warp: Warp,
    },
    /// Puts a support-free node in a node's place, with the node as its child.
    WrapInSupportFree {
        /// The node.
        path: NodePath,
        /// What is asked of it.
        rule: SupportFree,
    },
    /// Puts a node's only child in its place.
    Unwrap {
        /// A warp, a support-free node, or an operator with one child.
        path: NodePath,
    },
    /// Gives a node other parameters or makes it another primitive, operator or warp; its children stay.
    SetShape {
        /// The node.
        path: NodePath,
        /// What it becomes.
        shape: NewShape,
    },
    /// Adds a brush stroke after those that a support-free node has.
    AddStroke {
        /// The support-free node.
        path: NodePath,
        /// The stroke.
        stroke: Arc<BrushStroke>,
    },
    /// Takes a brush stroke out of those of a support-free node; later ones are done without it.
    RemoveStroke {
        /// The support-free node.
        path: NodePath,
        /// Which, from 0 on.
        index: usize,
    },
    /// Names a node, or takes its name away.
    SetName {
        /// The node.
        path: NodePath,
        /// The name.
        name: Option<String>,
    },
    /// Colours a node, or lets it inherit again.
    SetColor {
        /// The node.
        path: NodePath,
        /// The colour.
        color: Option<Color>,
    },
    /// Mutes a node or lets it be heard.
    SetMuted {
        /// The node.
        path: NodePath,
        /// Whether it is left out.
        muted: bool,
    },
    /// Makes a node a construction node or part of the solid.
    SetConstruction {
        /// The node.
        path: NodePath,
        /// Whether it is for construction only.
        construction: bool,
    },
    /// Several commands, one after the other, as one step; each means the tree that the one before it has left.
    /// Nothing is done unless all of them can be.
    Together(Vec<Command>),
    /// Names the scene.
    SetTitle {
        /// The title; none for an untitled scene.
        title: Option<String>,
    },
}

/// What a node becomes, apart from its children.
#[derive(Clone, Debug, PartialEq)]
pub enum NewShape {
    /// A primitive, in place of a primitive.
    Primitive(crate::primitive::Primitive),
    /// An operator, in place of an operator.
    Operator(Operator),
    /// A warp, in place of a warp.
    Warp(Warp),
    /// A support-free node, in place of one.
    SupportFree(SupportFree),
}

/// Why a command cannot be carried out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// The path leads nowhere.
    #[error("there is no node at {0}")]
    NoSuchNode(NodePath),
    /// Children can be added to operators only.
    #[error("the {type_name} at {path} cannot have further children; only operators can")]
    NotAnOperator {
        /// The node.
        path: NodePath,
        /// What it is.
        type_name: &'static str,
    },
    /// The node must stay where it is.
    #[error("{0} is the root or the only child that its parent can have; replace it instead")]
    CannotBeTaken(NodePath),
    /// There are fewer children.
    #[error("place {index} is beyond the {len} children of {parent}")]
    BeyondTheEnd {
        /// The operator.
        parent: NodePath,
        /// The place asked for.
        index: usize,
        /// How many children it has.
        len: usize,
    },
    /// A node would become its own descendant.
    #[error("{from} cannot be moved to {parent}, which is part of it")]
    IntoItself {
        /// The node.
        from: NodePath,
        /// The new parent.
        parent: NodePath,
    },
    /// There is not exactly one child to put in the node's place.
    #[error("the node at {path} has {len} children, so it cannot be unwrapped; only a node with one can")]
    NotAWrapper {
        /// The node.
        path: NodePath,
        /// How many children it has.
        len: usize,
    },
    /// The children do not fit the new shape.
    #[error("the {type_name} at {path} cannot become a {wanted}; replace it instead")]
    OtherKind {
        /// The node.
        path: NodePath,
        /// What it is.
        type_name: &'static str,
        /// What it was to become.
        wanted: &'static str,
    },
    /// Only support-free nodes have brush strokes.
    #[error("the {type_name} at {path} has no brush strokes; only a support_free node has")]
    NotSupportFree {
        /// The node.
        path: NodePath,
        /// What it is.
        type_name: &'static str,
    },
    /// There are fewer strokes.
    #[error("there is no stroke {index} among the {len} of {path}; they count from 0")]
    NoSuchStroke {
        /// The node.
        path: NodePath,
        /// The number asked for.
        index: usize,
        /// How many there are.
        len: usize,
    },
    /// The tree would not be legal.
    #[error("not possible: {0}")]
    Illegal(SceneError),
}

impl NewShape {
    pub(super) fn type_name(&self) -> &'static str {
        match self {
            Self::Primitive(primitive) => primitive.type_name(),
            Self::Operator(operator) => operator.type_name(),
            Self::Warp(warp) => warp.type_name(),
            Self::SupportFree(_) => "support_free",
        }
    }
}

impl Command {
    /// The command's name for the history, seen on the tree before it: "Move head".
    pub fn name(&self, root: &NodeRef) -> String {
        let at = |path: &NodePath| path.find(root).map_or_else(|| "node".into(), |node| called(node));
        match self {
            Self::Insert { node, .. } => format!("Add {}", called(node)),
            Self::Remove { path } => format!("Remove {}", at(path)),
            Self::Replace { path, node } => {
                let old = path.find(root);
                let joined = old.and_then(|old| joining(old, node));
                joined.unwrap_or_else(|| match (at(path), called(node)) {
                    (old, new) if old == new => format!("Change {old}"),
                    (old, new) => format!("Replace {old} by {new}"),
                })
            }
            Self::Move { from, .. } => format!("Move {} in the tree", at(from)),
            Self::WrapInOperator { path, operator } => {
                format!("Put {} into {}", at(path), operator.type_name())
            }
            Self::WrapInWarp { path, warp: Warp::Transform(to) } => {
                format!("{} {}", placed(&Transform::default(), to), at(path))
            }
            Self::WrapInWarp { path, warp } => format!("Put {} into {}", at(path), warp.type_name()),
            Self::WrapInSupportFree { path, .. } => format!("Make {} support-free", at(path)),
            Self::Unwrap { path } => format!("Unwrap {}", at(path)),
            Self::SetShape { path, shape } => match path.find(root) {
                Some(node) if node.type_name() != shape.type_name() => {
                    format!("Turn {} into {}", called(node), shape.type_name())
                }
                node => match (node.map(|node| &node.shape), shape) {
                    (Some(Shape::Warp(Warp::Transform(from), _)), NewShape::Warp(Warp::Transform(to))) => {
                        format!("{} {}", placed(from, to), at(path))
                    }
                    _ => format!("Change {}", at(path)),
                },
            },
            Self::AddStroke { path, stroke } => {
                format!("Brush {} ({})", at(path), stroke.brush.name().replace('_', " "))
            }
            Self::RemoveStroke { path, .. } => format!("Take a brush stroke from {}", at(path)),
            Self::SetName { path, name: Some(name) } => format!("Name {} {name}", at(path)),
            Self::SetName { path, name: None } => format!("Take the name from {}", at(path)),
            Self::SetColor { path, .. } => format!("Colour {}", at(path)),
            Self::SetMuted { path, muted: true } => format!("Mute {}", at(path)),
            Self::SetMuted { path, muted: false } => format!("Unmute {}", at(path)),
            Self::SetConstruction { path, construction: true } => format!("Make {} construction", at(path)),
            Self::SetConstruction { path, construction: false } => format!("Make {} solid", at(path)),
            Self::Together(commands) => match &commands[..] {
                [] => "Nothing".into(),
                [only] => only.name(root),
                [first, rest @ ..] => format!("{} and {} more", first.name(root), rest.len()),
            },
            Self::SetTitle { .. } => "Change title".into(),
        }
    }
}

/// What an operator is called that takes a node's place with the node as its first child and one more.
fn joining(old: &NodeRef, node: &NodeRef) -> Option<String> {
    let Shape::Operator(operator, children) = &node.shape else { return None };
    let [first, new] = &children[..] else { return None };
    NodeRef::ptr_eq(first, old).then(|| match operator {
        Operator::Union => format!("Add {}", called(new)),
        Operator::Difference | Operator::BlendDifference(_) => format!("Cut {} out", called(new)),
        Operator::Intersection | Operator::BlendIntersection(_) => format!("Keep what is in {}", called(new)),
        Operator::Blend(_) | Operator::GradientBlend | Operator::Sum => format!("Blend with {}", called(new)),
    })
}

/// What a change of place is called. Turning and sizing about a point move, too.
fn placed(from: &Transform, to: &Transform) -> &'static str {
    if from.rotate_degrees != to.rotate_degrees {
        "Turn"
    } else if from.scale != to.scale {
        "Size"
    } else {
        "Move"
    }
}

/// A node's name, else its type; a warp without a name is called after what it bends.
fn called(node: &Node) -> String {
    let mut node = node;
    while let (None, Shape::Warp(_, below)) = (&node.name, &node.shape) {
        node = below;
    }
    node.name.clone().unwrap_or_else(|| node.type_name().replace('_', " "))
}

/// The shape without the children.
impl From<&Shape> for NewShape {
    fn from(shape: &Shape) -> Self {
        match shape {
            Shape::Primitive(primitive) => Self::Primitive(primitive.clone()),
            Shape::Operator(operator, _) => Self::Operator(*operator),
            Shape::Warp(warp, _) => Self::Warp(warp.clone()),
            Shape::SupportFree(rule, _) => Self::SupportFree(rule.clone()),
        }
    }
}
