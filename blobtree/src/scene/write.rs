//! From a scene to JSON text without spaces.

use super::{MeshReference, Scene, VERSION};
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, Primitive, Segment, Torus,
};
use crate::sketched::{Inflation, LinearSweep, PathSweep, Revolution};
use crate::support_free::SupportFree;
use crate::warp::{AffineMap, Bend, Taper, Transform, Twist, Warp};
use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use serde_json::ser::Formatter;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::io;

/// The text of a scene that passes its check, as one line.
pub(super) fn compact(scene: &Scene) -> String {
    let names = Names::of(scene);
    let file = File {
        format: "trullo",
        version: VERSION,
        title: scene.title.as_deref(),
        define: names.definitions(),
        root: Referred { node: &scene.root, names: &names },
    };
    text_of(&file)
}

/// A value as JSON on one line, with numbers as files have them.
pub(super) fn text_of(value: &impl Serialize) -> String {
    let mut bytes = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, ShortNumbers);
    value.serialize(&mut serializer).expect("writing to memory works, and every key is a string");
    String::from_utf8(bytes).expect("JSON is UTF-8")
}

#[derive(serde::Serialize)]
struct File<'a> {
    format: &'static str,
    version: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    title: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    define: Option<Definitions<'a>>,
    root: Referred<'a>,
}

/// The names under which nodes are written, apart from where they stand.
pub(super) struct Names<'a> {
    /// By address; the nodes stay alive through the scene. Looked up, never walked through.
    of: HashMap<*const Node, Name>,
    /// What is to be defined.
    all: BTreeMap<String, &'a NodeRef>,
    /// Names that mean something else.
    taken: HashSet<&'a str>,
}

/// By what a node is referred to.
#[derive(Clone)]
enum Name {
    /// Its definition.
    Use(String),
    /// Its place in the tree before a command.
    Kept(NodePath),
}

impl<'a> Names<'a> {
    fn of(scene: &'a Scene) -> Self {
        let mut names = Self { of: HashMap::new(), all: BTreeMap::new(), taken: HashSet::new() };
        for (name, node) in scene.definitions.iter() {
            names.of.entry(address(node)).or_insert_with(|| Name::Use(name.clone()));
            names.all.insert(name.clone(), node);
        }
        let mut seen = HashSet::new();
        let mut counts = HashMap::new();
        for node in std::iter::once(&scene.root).chain(scene.definitions.values()) {
            names.find_shared(node, &mut seen, &mut counts);
        }
        names
    }

    /// The names in a node that a command brings to a scene: those of what stands there already, and of what
    /// the node itself shares.
    pub fn beside(scene: &'a Scene, node: &'a NodeRef) -> Self {
        let taken = scene.definitions.keys().map(String::as_str).collect();
        let mut names = Self { of: HashMap::new(), all: BTreeMap::new(), taken };
        let mut own = HashSet::new();
        collect(node, &mut own);
        names.find_kept(&scene.root, &mut NodePath::default(), &mut own);
        for (name, node) in scene.definitions.iter().filter(|(_, node)| own.contains(&address(node))) {
            names.of.entry(address(node)).or_insert_with(|| Name::Use(name.clone()));
        }
        names.find_shared(node, &mut HashSet::new(), &mut HashMap::new());
        names
    }

    /// The definitions to be written, if there are any.
    pub fn definitions(&self) -> Option<Definitions<'_>> {
        (!self.all.is_empty()).then_some(Definitions(self))
    }

    /// Names those of `wanted` by where they stand below `node`, and takes them out of `wanted`.
    fn find_kept(&mut self, node: &NodeRef, path: &mut NodePath, wanted: &mut HashSet<*const Node>) {
        if wanted.remove(&address(node)) {
            self.of.insert(address(node), Name::Kept(path.clone()));
        }
        for (index, child) in node.children().iter().enumerate() {
            if wanted.is_empty() {
                return;
            }
            path.0.push(index);
            self.find_kept(child, path, wanted);
            path.0.pop();
        }
    }

    /// Names every node that is met a second time.
    fn find_shared(
        &mut self,
        node: &'a NodeRef,
        seen: &mut HashSet<*const Node>,
        counts: &mut HashMap<String, usize>,
    ) {
        if matches!(self.of.get(&address(node)), Some(Name::Kept(_))) {
            return;
        }
        if seen.insert(address(node)) {
            node.children().iter().for_each(|child| self.find_shared(child, seen, counts));
        } else if !self.of.contains_key(&address(node)) {
            let base = node.name.as_deref().unwrap_or(node.type_name());
            let count = counts.entry(base.into()).or_insert(0);
            let name = loop {
                *count += 1;
                let name = if *count == 1 { base.to_owned() } else { format!("{base} {count}") };
                if !self.all.contains_key(&name) && !self.taken.contains(&*name) {
                    break name;
                }
            };
            self.all.insert(name.clone(), node);
            self.of.insert(address(node), Name::Use(name));
        }
    }
}

fn address(node: &NodeRef) -> *const Node {
    std::ptr::from_ref(&**node)
}

/// The addresses of all nodes of a tree.
fn collect(node: &NodeRef, to: &mut HashSet<*const Node>) {
    if to.insert(address(node)) {
        node.children().iter().for_each(|child| collect(child, to));
    }
}

pub(super) struct Definitions<'a>(&'a Names<'a>);

impl Serialize for Definitions<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.all.len()))?;
        for (name, node) in &self.0.all {
            // Of two names for the same node, the second refers to the first.
            if matches!(&self.0.of[&address(node)], Name::Use(first) if first == name) {
                map.serialize_entry(name, &Written { node, names: self.0 })?;
            } else {
                map.serialize_entry(name, &Referred { node, names: self.0 })?;
            }
        }
        map.end()
    }
}

/// A node where it stands: by name if it has one.
pub(super) struct Referred<'a> {
    pub node: &'a NodeRef,
    pub names: &'a Names<'a>,
}

impl Serialize for Referred<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { node, names } = *self;
        match names.of.get(&address(node)) {
            Some(name) => {
                let mut map = serializer.serialize_map(Some(1))?;
                match name {
                    Name::Use(name) => map.serialize_entry("use", name)?,
                    Name::Kept(path) => map.serialize_entry("kept", &path.to_string())?,
                }
                map.end()
            }
            None => Written { node, names }.serialize(serializer),
        }
    }
}

/// A node in full.
struct Written<'a> {
    node: &'a Node,
    names: &'a Names<'a>,
}

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { node, names } = *self;
        let fields = Fields {
            children: match &node.shape {
                Shape::Operator(_, children) => Some(Children { children, names }),
                _ => None,
            },
            child: match &node.shape {
                Shape::Warp(_, child) | Shape::SupportFree(_, child) => Some(Referred { node: child, names }),
                _ => None,
            },
            ..Fields::of(node)
        };
        fields.serialize(serializer)
    }
}

/// A node in full, with all below it, and no names: for what stands in no tree.
pub(crate) struct Whole<'a>(pub &'a NodeRef);

impl Serialize for Whole<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names = Names { of: HashMap::new(), all: BTreeMap::new(), taken: HashSet::new() };
        Written { node: self.0, names: &names }.serialize(serializer)
    }
}

/// A node without its children.
pub(super) struct Bare<'a>(pub &'a Node);

impl Serialize for Bare<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Fields::of(self.0).serialize(serializer)
    }
}

#[derive(serde::Serialize)]
struct Fields<'a> {
    #[serde(rename = "type")]
    type_name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<String>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    muted: bool,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    construction: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    sharpness: Option<f32>,
    #[serde(flatten)]
    parameters: Option<Parameters<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    children: Option<Children<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    child: Option<Referred<'a>>,
}

impl<'a> Fields<'a> {
    /// All but the children.
    fn of(node: &'a Node) -> Self {
        let sharpness = match &node.shape {
            Shape::Operator(operator, _) => operator.sharpness().map(|s| s.get()),
            _ => None,
        };
        Self {
            type_name: node.type_name(),
            name: node.name.as_deref(),
            color: node.color.map(|color| color.to_string()),
            muted: node.muted,
            construction: node.construction,
            sharpness,
            parameters: Parameters::of(node),
            children: None,
            child: None,
        }
    }
}

struct Children<'a> {
    children: &'a [NodeRef],
    names: &'a Names<'a>,
}

impl Serialize for Children<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.children.len()))?;
        for node in self.children {
            list.serialize_element(&Referred { node, names: self.names })?;
        }
        list.end()
    }
}

/// The fields that only this type of node has.
#[derive(serde::Serialize)]
#[serde(untagged)]
enum Parameters<'a> {
    Point(&'a Point),
    Segment(&'a Segment),
    Polyline(&'a Polyline),
    Disc(&'a Disc),
    Polygon(&'a Polygon),
    Box(&'a Cuboid),
    Cylinder(&'a Cylinder),
    Cone(&'a Cone),
    Torus(&'a Torus),
    Ellipsoid(&'a Ellipsoid),
    HalfSpace(&'a HalfSpace),
    Mesh(MeshReference),
    Inflation(&'a Inflation),
    LinearSweep(&'a LinearSweep),
    Revolution(&'a Revolution),
    PathSweep(&'a PathSweep),
    Transform(&'a Transform),
    Affine(&'a AffineMap),
    Taper(&'a Taper),
    Twist(&'a Twist),
    Bend(&'a Bend),
    SupportFree(&'a SupportFree),
}

impl<'a> Parameters<'a> {
    fn of(node: &'a Node) -> Option<Self> {
        Some(match &node.shape {
            Shape::Operator(..) => return None,
            Shape::Primitive(Primitive::Point(p)) => Self::Point(p),
            Shape::Primitive(Primitive::Segment(p)) => Self::Segment(p),
            Shape::Primitive(Primitive::Polyline(p)) => Self::Polyline(p),
            Shape::Primitive(Primitive::Disc(p)) => Self::Disc(p),
            Shape::Primitive(Primitive::Polygon(p)) => Self::Polygon(p),
            Shape::Primitive(Primitive::Box(p)) => Self::Box(p),
            Shape::Primitive(Primitive::Cylinder(p)) => Self::Cylinder(p),
            Shape::Primitive(Primitive::Cone(p)) => Self::Cone(p),
            Shape::Primitive(Primitive::Torus(p)) => Self::Torus(p),
            Shape::Primitive(Primitive::Ellipsoid(p)) => Self::Ellipsoid(p),
            Shape::Primitive(Primitive::HalfSpace(p)) => Self::HalfSpace(p),
            Shape::Primitive(Primitive::Mesh(p)) => Self::Mesh(p.into()),
            Shape::Primitive(Primitive::Inflation(p)) => Self::Inflation(p),
            Shape::Primitive(Primitive::LinearSweep(p)) => Self::LinearSweep(p),
            Shape::Primitive(Primitive::Revolution(p)) => Self::Revolution(p),
            Shape::Primitive(Primitive::PathSweep(p)) => Self::PathSweep(p),
            Shape::Warp(Warp::Transform(w), _) => Self::Transform(w),
            Shape::Warp(Warp::Affine(w), _) => Self::Affine(w),
            Shape::Warp(Warp::Taper(w), _) => Self::Taper(w),
            Shape::Warp(Warp::Twist(w), _) => Self::Twist(w),
            Shape::Warp(Warp::Bend(w), _) => Self::Bend(w),
            Shape::SupportFree(rule, _) => Self::SupportFree(rule),
        })
    }
}

/// Writes numbers with as few digits as read back equal, and whole numbers without a point.
struct ShortNumbers;

impl Formatter for ShortNumbers {
    fn write_f32<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f32) -> io::Result<()> {
        let shortest = format!("{value:?}");
        let short = shortest.strip_suffix(".0").unwrap_or(&shortest);
        // Reading rounds twice, to f64 and then to f32; where that matters, all digits are written.
        let same = short.parse::<f64>().is_ok_and(|read| (read as f32).to_bits() == value.to_bits());
        if same { writer.write_all(short.as_bytes()) } else { write!(writer, "{:?}", f64::from(value)) }
    }
}
