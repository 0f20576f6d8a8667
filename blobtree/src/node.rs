//! The tree itself: immutable nodes, shared between versions of a scene.

use crate::operator::Operator;
use crate::primitive::Primitive;
use crate::support_free::SupportFree;
use crate::warp::Warp;
use std::sync::Arc;

/// A shared node. Two that are the same allocation are the same node, with the same caches.
pub type NodeRef = Arc<Node>;

/// A node of the tree. Never changed once built: an edit makes new nodes along the path to the root.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What the user calls it.
    pub name: Option<String>,
    /// Its colour on screen; children without one inherit it.
    pub color: Option<Color>,
    /// Left out of its parent, as if it were not there.
    pub muted: bool,
    /// Seen and drawn on, but not part of the solid.
    pub construction: bool,
    /// What it is.
    pub shape: Shape,
}

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A solid without children.
    Primitive(Primitive),
    /// A combination of children.
    Operator(Operator, Vec<NodeRef>),
    /// A child in a deformed space.
    Warp(Warp, NodeRef),
    /// A child, changed so that it prints without supports.
    SupportFree(SupportFree, NodeRef),
}

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub [u8; 3]);

impl Node {
    /// A plain node of this shape: unnamed, uncoloured, heard and printed.
    pub fn new(shape: Shape) -> Self {
        Self { name: None, color: None, muted: false, construction: false, shape }
    }

    /// The children, in order; none for a primitive.
    pub fn children(&self) -> &[NodeRef] {
        match &self.shape {
            Shape::Primitive(_) => &[],
            Shape::Operator(_, children) => children,
            Shape::Warp(_, child) | Shape::SupportFree(_, child) => std::slice::from_ref(child),
        }
    }

    /// Whether the node takes part in the solid.
    pub fn is_heard(&self) -> bool {
        !self.muted && !self.construction
    }

    /// Whether it is support-free or stands above a node that is, so that its field depends on a bake.
    pub(crate) fn holds_support_free(&self) -> bool {
        self.is_heard()
            && (matches!(self.shape, Shape::SupportFree(..))
                || self.children().iter().any(|child| child.holds_support_free()))
    }

    /// The node below these warps, the outermost first.
    pub(crate) fn under(self: &NodeRef, warps: &[NodeRef]) -> NodeRef {
        warps.iter().rev().fold(self.clone(), |inner, warp| match &warp.shape {
            Shape::Warp(warp, _) => Self::new(Shape::Warp(warp.clone(), inner)).into(),
            _ => inner,
        })
    }

    /// The name in scene files and on screen of what the node is.
    pub fn type_name(&self) -> &'static str {
        match &self.shape {
            Shape::Primitive(primitive) => primitive.type_name(),
            Shape::Operator(operator, _) => operator.type_name(),
            Shape::Warp(warp, _) => warp.type_name(),
            Shape::SupportFree(..) => "support_free",
        }
    }
}

/// Where a node stands: the child indices on the way from the root. Shown as `/0/2`; `/` is the root.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodePath(pub Vec<usize>);

impl NodePath {
    /// The path of this node's child number `index`.
    pub fn child(&self, index: usize) -> Self {
        Self(self.0.iter().copied().chain([index]).collect())
    }

    /// The path of the parent; `None` for the root.
    pub fn parent(&self) -> Option<Self> {
        let (_, rest) = self.0.split_last()?;
        Some(Self(rest.to_vec()))
    }

    /// The node there, seen from `root`.
    pub fn find<'a>(&self, root: &'a NodeRef) -> Option<&'a NodeRef> {
        self.0.iter().try_fold(root, |node, &index| node.children().get(index))
    }

    /// The node there by itself, heard and solid, where it stands in the root's space: with the warps above it, and
    /// nothing beside it.
    pub fn find_alone(&self, root: &NodeRef) -> Option<NodeRef> {
        let heard = Node { muted: false, construction: false, ..(**self.find(root)?).clone() };
        let above = (0..self.0.len()).rev().filter_map(|len| Self(self.0[..len].to_vec()).find(root));
        Some(above.fold(heard.into(), |below, node| match &node.shape {
            Shape::Warp(warp, _) => Node::new(Shape::Warp(warp.clone(), below)).into(),
            _ => below,
        }))
    }
}

impl std::fmt::Display for NodePath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() {
            return f.write_str("/");
        }
        self.0.iter().try_for_each(|index| write!(f, "/{index}"))
    }
}

/// A text that is not a node path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a node path; one looks like /0/2, and / is the root")]
pub struct NodePathError(String);

impl std::str::FromStr for NodePath {
    type Err = NodePathError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || NodePathError(text.into());
        let rest = text.strip_prefix('/').ok_or_else(wrong)?;
        if rest.is_empty() {
            return Ok(Self::default());
        }
        rest.split('/').map(|index| index.parse().map_err(|_| wrong())).collect::<Result<_, _>>().map(Self)
    }
}
