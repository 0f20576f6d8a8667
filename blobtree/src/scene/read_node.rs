//! From JSON values to nodes.

use super::check::{Size, numbers};
use super::error::SceneProblem;
use super::journal::{self, Before};
use super::locate::Step;
use super::parameters::{self, FieldFault, described};
use super::read::Fault;
use super::{MAX_DEPTH, MAX_NODES, MeshReference, SceneSources, TYPE_NAMES};
use crate::document::NewShape;
use crate::imported::ImportedMesh;
use crate::node::{Node, NodeRef, Shape};
use crate::operator::{Operator, Sharpness};
use crate::primitive::{Drawn, Primitive};
use crate::sketched::{Drawing, Template};
use crate::support_free::{BrushStroke, BrushTip, SupportFree};
use crate::warp::Warp;
use mesh::MeshDistance;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

type Fields = Map<String, Value>;

/// The fields that every node may have.
const COMMON: [&str; 5] = ["type", "name", "color", "muted", "construction"];
/// Those and what all nodes with one child have.
const ONE_CHILD: [&str; 6] = ["child", "type", "name", "color", "muted", "construction"];
/// The one that a shape without a node has, too.
const BARE: [&str; 1] = ["type"];

/// Reads nodes, knowing the definitions read so far.
pub(super) struct NodeReader<'a> {
    sources: &'a mut dyn SceneSources,
    /// What nodes may refer to, if it is more than definitions.
    before: Option<Before<'a>>,
    /// Whether what was loaded and solved for it is known here.
    has_recalled: bool,
    /// By file and hash.
    loaded: BTreeMap<(String, String), Arc<MeshDistance>>,
    /// The drawings read so far, by falloff, with their templates.
    solved: Vec<(Option<f32>, Arc<Drawing>, Arc<Template>)>,
    definitions: BTreeMap<String, (NodeRef, Size)>,
    /// From the top of the file to the value being read.
    steps: Vec<Step>,
}

/// What a node's type says about the rest of its fields.
enum Kind {
    Primitive,
    Operator(Operator),
    Warp,
    SupportFree,
}

impl<'a> NodeReader<'a> {
    pub(super) fn new(sources: &'a mut dyn SceneSources) -> Self {
        let (loaded, solved, definitions) = (BTreeMap::new(), Vec::new(), BTreeMap::new());
        Self { sources, before: None, has_recalled: false, loaded, solved, definitions, steps: Vec::new() }
    }

    /// Reads nodes that come to a scene.
    pub(super) fn after(before: Before<'a>, sources: &'a mut dyn SceneSources) -> Self {
        Self { before: Some(before), ..Self::new(sources) }
    }

    /// Reads a definition; those that it uses must have been read.
    pub(super) fn define(&mut self, name: String, value: Value) -> Result<(), Fault> {
        self.steps = vec![Step::key("define"), Step::key(&name)];
        let node = self.node(value, 1)?;
        self.definitions.insert(name, node);
        Ok(())
    }

    /// Reads the tree at these steps.
    pub(super) fn read_from(&mut self, steps: Vec<Step>, value: Value) -> Result<NodeRef, Fault> {
        self.steps = steps;
        Ok(self.node(value, 1)?.0)
    }

    pub(super) fn into_definitions(self) -> BTreeMap<String, NodeRef> {
        self.definitions.into_iter().map(|(name, (node, _))| (name, node)).collect()
    }

    /// Reads what a node is apart from its children.
    pub(super) fn read_shape(&mut self, steps: Vec<Step>, value: Value) -> Result<NewShape, Fault> {
        self.steps = steps;
        let shown = described(&value);
        let Value::Object(mut fields) = value else {
            return Err(self.fault(parameters::wrong("the shape", shown, "an object with `type`")));
        };
        let (type_name, kind) = self.kind(&mut fields)?;
        let shape = match kind {
            Kind::Primitive => NewShape::Primitive(self.primitive(&type_name, &mut fields, &BARE)?),
            Kind::Operator(operator) => {
                let own = operator.sharpness().map(|_| "sharpness");
                let legal: Vec<&str> = own.into_iter().chain(BARE).collect();
                parameters::nothing_left(&fields, &legal).map_err(|fault| self.fault_in(fault))?;
                NewShape::Operator(operator)
            }
            Kind::Warp => NewShape::Warp(self.warp(&type_name, &mut fields, &BARE)?),
            Kind::SupportFree => NewShape::SupportFree(self.rule(&mut fields, &BARE, 1)?),
        };
        let mut node = Node::new(journal::childless(shape));
        self.complete(&mut node)?;
        Ok(NewShape::from(&node.shape))
    }

    fn fault(&self, problem: SceneProblem) -> Fault {
        Fault { steps: self.steps.clone(), problem }
    }

    fn fault_in(&self, (steps, problem): FieldFault) -> Fault {
        Fault { steps: self.steps.iter().cloned().chain(steps).collect(), problem }
    }

    fn at<T>(
        &mut self,
        steps: &[Step],
        read: impl FnOnce(&mut Self) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        let depth = self.steps.len();
        self.steps.extend_from_slice(steps);
        let done = read(self)?;
        self.steps.truncate(depth);
        Ok(done)
    }

    /// `depth` is 1 at the root.
    fn node(&mut self, value: Value, depth: usize) -> Result<(NodeRef, Size), Fault> {
        let shown = described(&value);
        let Value::Object(mut fields) = value else {
            return Err(self.fault(parameters::wrong("the node", shown, "an object with `type` or `use`")));
        };
        let (node, size) = if let Some(name) = fields.remove("use") {
            self.used(&name, &fields)?
        } else if let Some((before, path)) = self.before.zip(fields.remove("kept")) {
            self.kept(before, &path, &fields)?
        } else {
            let (node, size) = self.fresh(&mut fields, depth)?;
            (NodeRef::new(node), size)
        };
        if depth - 1 + size.height > MAX_DEPTH {
            return Err(self.fault(SceneProblem::TooDeep));
        }
        if size.nodes > MAX_NODES {
            return Err(self.fault(SceneProblem::TooManyNodes));
        }
        Ok((node, size))
    }

    /// A node that is written elsewhere.
    fn used(&self, name: &Value, others: &Fields) -> Result<(NodeRef, Size), Fault> {
        parameters::nothing_left(others, &["use"]).map_err(|fault| self.fault_in(fault))?;
        let at_use = |problem| self.fault_in((vec![Step::key("use")], problem));
        let Some(name) = name.as_str() else {
            return Err(at_use(parameters::wrong("use", described(name), "the name of a definition")));
        };
        let found = self.definitions.get(name).cloned();
        found.or_else(|| self.before.and_then(|before| before.definition(name))).ok_or_else(|| {
            at_use(parameters::unknown("definition", name, self.definitions.keys().map(String::as_str)))
        })
    }

    /// A node that stands in the tree before a command.
    fn kept(&self, before: Before, path: &Value, others: &Fields) -> Result<(NodeRef, Size), Fault> {
        parameters::nothing_left(others, &["kept"]).map_err(|fault| self.fault_in(fault))?;
        let found = path.as_str().and_then(|text| text.parse().ok()).and_then(|path| before.kept(&path));
        found.ok_or_else(|| {
            let expected = "the path of a node that is there before";
            self.fault_in((vec![Step::key("kept")], parameters::wrong("kept", described(path), expected)))
        })
    }

    /// A node that is written here.
    fn fresh(&mut self, fields: &mut Fields, depth: usize) -> Result<(Node, Size), Fault> {
        if depth > MAX_DEPTH {
            return Err(self.fault(SceneProblem::TooDeep));
        }
        let mut node = self.common(fields)?;
        let (type_name, kind) = self.kind(fields)?;
        let (shape, size) = match kind {
            Kind::Primitive => {
                (Shape::Primitive(self.primitive(&type_name, fields, &COMMON)?), Size::over([].into_iter()))
            }
            Kind::Operator(operator) => {
                let (children, size) = self.children(fields, depth)?;
                let own = operator.sharpness().map(|_| "sharpness");
                let legal: Vec<&str> = own.into_iter().chain(["children"]).chain(COMMON).collect();
                parameters::nothing_left(fields, &legal).map_err(|fault| self.fault_in(fault))?;
                (Shape::Operator(operator, children), size)
            }
            Kind::Warp => {
                let child = self.only_child(fields, "the node that is warped")?;
                let warp = self.warp(&type_name, fields, &ONE_CHILD)?;
                let (child, size) = self.at(&[Step::key("child")], |reader| reader.node(child, depth + 1))?;
                (Shape::Warp(warp, child), Size::over([size].into_iter()))
            }
            Kind::SupportFree => {
                let child = self.only_child(fields, "the node that is to print without supports")?;
                let rule = self.rule(fields, &ONE_CHILD, depth)?;
                let (child, size) = self.at(&[Step::key("child")], |reader| reader.node(child, depth + 1))?;
                (Shape::SupportFree(rule, child), Size::over([size].into_iter()))
            }
        };
        node.shape = shape;
        self.complete(&mut node)?;
        Ok((node, size))
    }

    /// Checks the node's own numbers, and solves its drawing if it has one.
    fn complete(&mut self, node: &mut Node) -> Result<(), Fault> {
        numbers(node).map_err(|problem| {
            let field = match &problem {
                SceneProblem::Parameter(e) => vec![Step::key(e.field.split('.').next().unwrap_or_default())],
                _ => vec![],
            };
            self.fault_in((field, problem))
        })?;
        if let Shape::Primitive(primitive) = &mut node.shape
            && let Some(drawn) = primitive.drawn()
        {
            self.solve(drawn)?;
        }
        Ok(())
    }

    /// Takes over what was loaded and solved for the scene before, once it is needed.
    fn recall(&mut self) {
        let Some(before) = self.before.filter(|_| !self.has_recalled) else { return };
        self.has_recalled = true;
        let (loaded, solved) = (&mut self.loaded, &mut self.solved);
        before.sources(
            |mesh| {
                loaded.insert((mesh.file.clone(), mesh.sha256.clone()), mesh.distance.clone());
            },
            |drawn| solved.push((drawn.falloff, drawn.drawing.clone(), drawn.template.clone())),
        );
    }

    /// Gives a drawn primitive, whose numbers are legal, its template. Equal drawings become one.
    fn solve(&mut self, drawn: Drawn) -> Result<(), Fault> {
        self.recall();
        let Drawn { drawing, falloff, template } = drawn;
        let known = self.solved.iter().find(|(width, known, _)| *width == falloff && known == drawing);
        if let Some((_, known, solved)) = known {
            (*drawing, *template) = (known.clone(), solved.clone());
            return Ok(());
        }
        *template = self
            .sources
            .template(drawing, falloff)
            .map_err(|reason| self.fault_in((vec![Step::key("drawing")], SceneProblem::Drawing(reason))))?;
        self.solved.push((falloff, drawing.clone(), template.clone()));
        Ok(())
    }

    /// A node with the fields that every node may have, still without a shape.
    fn common(&self, fields: &mut Fields) -> Result<Node, Fault> {
        let in_here = |fault| self.fault_in(fault);
        let mut node = Node::new(Shape::Operator(Operator::Union, Vec::new()));
        node.name = parameters::take(fields, "name", "a text").map_err(in_here)?;
        node.color = parameters::color(fields).map_err(in_here)?;
        node.muted = parameters::take(fields, "muted", "true or false").map_err(in_here)?.unwrap_or(false);
        let construction = parameters::take(fields, "construction", "true or false").map_err(in_here)?;
        node.construction = construction.unwrap_or(false);
        Ok(node)
    }

    fn kind(&self, fields: &mut Fields) -> Result<(String, Kind), Fault> {
        let in_here = |fault| self.fault_in(fault);
        let value =
            parameters::need(fields, "type", "what the node is, such as \"point\"").map_err(in_here)?;
        let at_type = |problem| self.fault_in((vec![Step::key("type")], problem));
        let Value::String(name) = value else {
            return Err(at_type(parameters::wrong(
                "type",
                described(&value),
                "a node type such as \"point\"",
            )));
        };
        let kind = match name.as_str() {
            "union" => Kind::Operator(Operator::Union),
            "intersection" => Kind::Operator(Operator::Intersection),
            "difference" => Kind::Operator(Operator::Difference),
            "blend" => Kind::Operator(Operator::Blend(self.sharpness(fields)?)),
            "blend_intersection" => Kind::Operator(Operator::BlendIntersection(self.sharpness(fields)?)),
            "blend_difference" => Kind::Operator(Operator::BlendDifference(self.sharpness(fields)?)),
            "sum" => Kind::Operator(Operator::Sum),
            "gradient_blend" => Kind::Operator(Operator::GradientBlend),
            "transform" | "affine" | "taper" | "twist" | "bend" => Kind::Warp,
            "support_free" => Kind::SupportFree,
            other if TYPE_NAMES.contains(&other) => Kind::Primitive,
            other => return Err(at_type(parameters::unknown("node type", other, TYPE_NAMES.into_iter()))),
        };
        Ok((name, kind))
    }

    fn sharpness(&self, fields: &mut Fields) -> Result<Sharpness, Fault> {
        let given =
            parameters::take(fields, "sharpness", "a number").map_err(|fault| self.fault_in(fault))?;
        given.map_or(Ok(Sharpness::DEFAULT), |s| {
            Sharpness::new(s).map_err(|e| self.fault_in((vec![Step::key("sharpness")], e.into())))
        })
    }

    fn children(&mut self, fields: &mut Fields, depth: usize) -> Result<(Vec<NodeRef>, Size), Fault> {
        let expected = "a list of nodes, which may be empty";
        let value = parameters::need(fields, "children", expected).map_err(|fault| self.fault_in(fault))?;
        let Value::Array(values) = value else {
            let problem = parameters::wrong("children", described(&value), expected);
            return Err(self.fault_in((vec![Step::key("children")], problem)));
        };
        let mut children = Vec::with_capacity(values.len());
        let mut sizes = Vec::with_capacity(values.len());
        for (index, value) in values.into_iter().enumerate() {
            let steps = [Step::key("children"), Step::Index(index)];
            let (child, size) = self.at(&steps, |reader| reader.node(value, depth + 1))?;
            children.push(child);
            sizes.push(size);
        }
        Ok((children, Size::over(sizes.into_iter())))
    }

    /// The value of a node's only child, taken out.
    fn only_child(&self, fields: &mut Fields, expected: &str) -> Result<Value, Fault> {
        parameters::need(fields, "child", expected).map_err(|fault| self.fault_in(fault))
    }

    fn warp(&self, type_name: &str, fields: &mut Fields, others: &[&str]) -> Result<Warp, Fault> {
        let fields = std::mem::take(fields);
        let warp = match type_name {
            "transform" => parameters::all(fields, others).map(Warp::Transform),
            "affine" => parameters::all(fields, others).map(Warp::Affine),
            "taper" => parameters::all(fields, others).map(Warp::Taper),
            "twist" => parameters::all(fields, others).map(Warp::Twist),
            _ => parameters::all(fields, others).map(Warp::Bend),
        };
        warp.map_err(|fault| self.fault_in(fault))
    }

    /// `depth` is that of the node.
    fn rule(&mut self, fields: &mut Fields, others: &[&str], depth: usize) -> Result<SupportFree, Fault> {
        let strokes = match fields.remove("strokes") {
            None => Vec::new(),
            Some(Value::Array(strokes)) => {
                let read = |(n, stroke)| {
                    let steps = [Step::key("strokes"), Step::Index(n)];
                    self.at(&steps, |reader| reader.stroke(stroke, depth + 1)).map(Arc::new)
                };
                strokes.into_iter().enumerate().map(read).collect::<Result<_, _>>()?
            }
            Some(other) => {
                let problem = parameters::wrong("strokes", described(&other), "a list of brush strokes");
                return Err(self.fault_in((vec![Step::key("strokes")], problem)));
            }
        };
        let others: Vec<&str> = others.iter().copied().chain(["strokes"]).collect();
        let rule = parameters::all(std::mem::take(fields), &others);
        Ok(SupportFree { strokes, ..rule.map_err(|fault| self.fault_in(fault))? })
    }

    /// Reads a brush stroke at these steps.
    pub(super) fn read_stroke(&mut self, steps: Vec<Step>, value: Value) -> Result<BrushStroke, Fault> {
        self.steps = steps;
        let stroke = self.stroke(value, 1)?;
        stroke.check("stroke").map_err(|e| self.fault(e.into()))?;
        Ok(stroke)
    }

    /// `depth` is that of its tip.
    fn stroke(&mut self, value: Value, depth: usize) -> Result<BrushStroke, Fault> {
        let shown = described(&value);
        let Value::Object(mut fields) = value else {
            return Err(self.fault(parameters::wrong("the stroke", shown, "an object with `brush`")));
        };
        let expected = "\"ball\", \"cube\", \"cylinder\" or a node";
        let tip = match fields.remove("tip") {
            None => BrushTip::Ball,
            Some(Value::String(name)) => BrushTip::named(&name).ok_or_else(|| {
                let problem = parameters::unknown("brush tip", &name, BrushTip::NAMES.into_iter());
                self.fault_in((vec![Step::key("tip")], problem))
            })?,
            Some(Value::Object(node)) => {
                let read = |reader: &mut Self| reader.node(Value::Object(node), depth);
                BrushTip::Shape(self.at(&[Step::key("tip")], read)?.0)
            }
            Some(other) => {
                let problem = parameters::wrong("tip", described(&other), expected);
                return Err(self.fault_in((vec![Step::key("tip")], problem)));
            }
        };
        let stroke: BrushStroke = parameters::all(fields, &["tip"]).map_err(|fault| self.fault_in(fault))?;
        Ok(BrushStroke { tip, ..stroke })
    }

    fn primitive(
        &mut self,
        type_name: &str,
        fields: &mut Fields,
        others: &[&str],
    ) -> Result<Primitive, Fault> {
        let fields = std::mem::take(fields);
        let primitive = match type_name {
            "point" => parameters::all(fields, others).map(Primitive::Point),
            "segment" => parameters::all(fields, others).map(Primitive::Segment),
            "polyline" => parameters::all(fields, others).map(Primitive::Polyline),
            "disc" => parameters::all(fields, others).map(Primitive::Disc),
            "polygon" => parameters::all(fields, others).map(Primitive::Polygon),
            "box" => parameters::all(fields, others).map(Primitive::Box),
            "cylinder" => parameters::all(fields, others).map(Primitive::Cylinder),
            "cone" => parameters::all(fields, others).map(Primitive::Cone),
            "torus" => parameters::all(fields, others).map(Primitive::Torus),
            "ellipsoid" => parameters::all(fields, others).map(Primitive::Ellipsoid),
            "half_space" => parameters::all(fields, others).map(Primitive::HalfSpace),
            "inflation" => parameters::all(fields, others).map(Primitive::Inflation),
            "sweep" => parameters::all(fields, others).map(Primitive::LinearSweep),
            "revolution" => parameters::all(fields, others).map(Primitive::Revolution),
            "path_sweep" => parameters::all(fields, others).map(Primitive::PathSweep),
            _ => {
                let reference = parameters::all(fields, others).map_err(|fault| self.fault_in(fault))?;
                return self.mesh(reference).map(Primitive::Mesh);
            }
        };
        primitive.map_err(|fault| self.fault_in(fault))
    }

    fn mesh(&mut self, reference: MeshReference) -> Result<ImportedMesh, Fault> {
        self.recall();
        let key = (reference.file.clone(), reference.sha256.clone());
        let distance = match self.loaded.get(&key) {
            Some(distance) => distance.clone(),
            None => {
                let distance = self.sources.mesh(&reference).map_err(|reason| {
                    let problem =
                        SceneProblem::Mesh { file: super::error::shortened(&reference.file), reason };
                    self.fault_in((vec![Step::key("file")], problem))
                })?;
                self.loaded.insert(key, distance.clone());
                distance
            }
        };
        let MeshReference { file, sha256, falloff } = reference;
        Ok(ImportedMesh { file, sha256, falloff, distance })
    }
}
