//! A node's parameters as a form: read from the scene format itself, so that whatever a node has can be changed, with
//! the words, units and ranges that the format gives it.

use blobtree::{
    Command, JournalEntry, NewShape, Node, NodePath, Scene, SceneError, SceneSources, scene_schema,
};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::OnceLock;

/// A field of a form.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The way to it from the shape: one name, or two for a part of a compound.
    pub steps: Vec<String>,
    /// What the user reads: "Major radius".
    pub label: String,
    /// What it is, in a sentence.
    pub help: String,
    /// The unit, behind the number: " mm", "°", or nothing.
    pub unit: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What it is now; null where the node does without.
    pub value: Value,
    /// What it is where nothing is said; null if the field must be there.
    pub usual: Value,
    /// Whether it may be absent.
    pub is_optional: bool,
}

/// What a field takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number in a range.
    Number {
        /// The least.
        min: f64,
        /// The greatest.
        max: f64,
    },
    /// Numbers along the axes, two or three.
    Vector(usize),
    /// One of some words.
    Choice(Vec<String>),
}

/// The parameters of one node.
#[derive(Clone, Debug)]
pub struct Form {
    path: NodePath,
    shape: Value,
    /// The fields, in the order of their names.
    pub fields: Vec<Field>,
}

impl Form {
    /// The form of a node in a scene; `None` for a path that leads nowhere.
    ///
    /// **Cost:** that of the node's text, which is long for drawings: make it when the node changes.
    pub fn of(scene: &Scene, path: &NodePath) -> Option<Self> {
        let node: &Node = path.find(&scene.root)?;
        let command = Command::SetShape { path: path.clone(), shape: NewShape::from(&node.shape) };
        let line = JournalEntry::Command(command).to_line(scene).ok()?;
        let shape = serde_json::from_str::<Value>(&line).ok()?.get_mut("shape")?.take();
        let mut fields = Vec::new();
        for (name, described) in fields_of(node.type_name()) {
            collect(&mut fields, &shape, vec![name.clone()], described);
        }
        Some(Self { path: path.clone(), shape, fields })
    }

    /// Where the node stands.
    pub fn path(&self) -> &NodePath {
        &self.path
    }

    /// The command that gives a field another value; null takes it away.
    ///
    /// Errors: a value that the node does not allow, with its range.
    pub fn with(
        &self,
        field: &Field,
        value: Value,
        scene: &Scene,
        sources: &mut dyn SceneSources,
    ) -> Result<Command, SceneError> {
        let mut shape = self.shape.clone();
        put(&mut shape, &field.steps, value);
        let line = json!({
            "format": "trullo-journal", "version": 1,
            "do": "set_shape", "path": self.path.to_string(), "shape": shape,
        });
        match JournalEntry::from_line(line.to_string().as_bytes(), scene, sources)? {
            JournalEntry::Command(command) => Ok(command),
            other => unreachable!("it was a command: {other:?}"),
        }
    }
}

/// Puts a value where the steps lead; null takes away what is there.
fn put(shape: &mut Value, steps: &[String], value: Value) {
    let [first, rest @ ..] = steps else { return };
    let Value::Object(fields) = shape else { return };
    if !rest.is_empty() {
        put(fields.entry(first).or_insert_with(|| json!({})), rest, value);
    } else if value.is_null() {
        fields.remove(first);
    } else {
        fields.insert(first.clone(), value);
    }
}

/// What the format says of each type of node: its own fields.
fn fields_of(type_name: &str) -> impl Iterator<Item = &'static (String, Value)> {
    static TYPES: OnceLock<HashMap<String, Vec<(String, Value)>>> = OnceLock::new();
    let types = TYPES.get_or_init(|| {
        let schema = scene_schema();
        let nodes = schema["$defs"]["node"]["anyOf"].as_array().into_iter().flatten();
        nodes.map(|node| (node["title"].as_str().unwrap_or_default().to_owned(), own_fields(node))).collect()
    });
    types.get(type_name).into_iter().flatten()
}

fn own_fields(node: &Value) -> Vec<(String, Value)> {
    const OTHERS: [&str; 7] = ["type", "name", "color", "muted", "construction", "child", "children"];
    let required = &node["required"];
    let fields = node["properties"].as_object().into_iter().flatten();
    let own = fields.filter(|(name, _)| !OTHERS.contains(&name.as_str()));
    own.map(|(name, described)| (name.clone(), with_need(described, required, name))).collect()
}

/// The description of a field with whether it must be there.
fn with_need(described: &Value, required: &Value, name: &str) -> Value {
    let needed = required.as_array().is_some_and(|names| names.iter().any(|needed| needed == name));
    let mut described = described.as_object().cloned().unwrap_or_default();
    described.insert("needed".into(), needed.into());
    Value::Object(described)
}

/// Adds the field, or those that it is made of. What no form can show, such as strokes and files, is passed over.
fn collect(fields: &mut Vec<Field>, shape: &Value, steps: Vec<String>, described: &Value) {
    if let Some(parts) = described["properties"].as_object().filter(|_| steps.len() == 1) {
        if described.get("strokes").is_some() || parts.contains_key("strokes") {
            return;
        }
        for (name, part) in parts {
            let steps = [&steps[..], std::slice::from_ref(name)].concat();
            collect(fields, shape, steps, &with_need(part, &described["required"], name));
        }
        return;
    }
    let Some(kind) = kind(described) else { return };
    let value = steps.iter().fold(shape, |value, step| &value[step]).clone();
    let help = described["description"].as_str().unwrap_or_default().replace('\n', " ");
    fields.push(Field {
        label: label(&steps),
        unit: unit(&help, steps.last().map_or("", String::as_str)),
        usual: described["default"].clone(),
        is_optional: described["needed"] == false,
        steps,
        help,
        kind,
        value,
    });
}

fn kind(described: &Value) -> Option<Kind> {
    if let Some(words) = words(described) {
        return Some(Kind::Choice(words));
    }
    let is = |name: &str| match &described["type"] {
        Value::String(only) => only == name,
        Value::Array(all) => all.iter().any(|one| one == name),
        _ => false,
    };
    if is("number") {
        let [min, max] = [("minimum", f64::MIN), ("maximum", f64::MAX)]
            .map(|(bound, none)| described[bound].as_f64().unwrap_or(none));
        return Some(Kind::Number { min, max });
    }
    let numbers = is("array") && described["items"]["type"] == "number";
    let size = described["maxItems"].as_u64().filter(|size| numbers && (2..=3).contains(size))?;
    Some(Kind::Vector(size as usize))
}

/// The words that a field may be.
fn words(described: &Value) -> Option<Vec<String>> {
    let alternatives = described["oneOf"].as_array().or_else(|| {
        let any = described["anyOf"].as_array()?;
        any.iter().find_map(|one| one["oneOf"].as_array())
    })?;
    alternatives.iter().map(|one| one["const"].as_str().map(str::to_owned)).collect()
}

/// `["plane", "origin"]` as "Plane origin".
fn label(steps: &[String]) -> String {
    let words = steps.iter().map(|step| step.trim_end_matches("_degrees").replace('_', " "));
    let text = words.collect::<Vec<_>>().join(" ");
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The unit that the description ends its first sentence with.
fn unit(help: &str, name: &str) -> &'static str {
    let first = help.split(". ").next().unwrap_or_default();
    if name.contains("degrees") {
        "°"
    } else if first.contains(", mm") {
        " mm"
    } else {
        ""
    }
}

/// The numbers of a vector; zeros where there are none.
pub fn numbers(value: &Value, size: usize) -> Vec<f64> {
    (0..size).map(|axis| value[axis].as_f64().unwrap_or_default()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, cuboid, point};
    use blobtree::random::RandomTree;
    use blobtree::{NoSources, Primitive, Shape};

    fn scene() -> Scene {
        Scene::new(point([0., 0., 5.], 5.).union(cuboid([20., 0., 5.], [10., 8., 6.])))
    }

    fn field<'a>(form: &'a Form, label: &str) -> &'a Field {
        form.fields.iter().find(|field| field.label == label).unwrap_or_else(|| panic!("{label} in {form:?}"))
    }

    #[test]
    fn a_ball_has_a_centre_a_radius_and_a_falloff_that_may_be_left_to_itself() {
        let scene = scene();
        let form = Form::of(&scene, &NodePath(vec![0])).expect("a node");
        let labels: Vec<&str> = form.fields.iter().map(|field| field.label.as_str()).collect();
        assert_eq!(labels, ["Center", "Falloff", "Radius"]);
        let radius = field(&form, "Radius");
        assert_eq!((radius.value.as_f64(), radius.unit, radius.is_optional), (Some(5.0), " mm", false));
        assert_eq!(radius.kind, Kind::Number { min: 0.001, max: 100_000.0 });
        assert!(field(&form, "Falloff").is_optional && field(&form, "Falloff").value.is_null());
    }

    #[test]
    fn a_changed_field_is_a_command_that_changes_only_that() {
        let scene = scene();
        let form = Form::of(&scene, &NodePath(vec![1])).expect("a node");
        let command =
            form.with(field(&form, "Rounding"), json!(1.5), &scene, &mut NoSources).expect("allowed");
        let Command::SetShape { shape: NewShape::Primitive(Primitive::Box(cuboid)), .. } = command else {
            panic!("{command:?}")
        };
        assert_eq!((cuboid.rounding, cuboid.size.x), (1.5, 10.0));
    }

    #[test]
    fn what_a_node_does_not_allow_is_refused_with_its_range() {
        let scene = scene();
        let form = Form::of(&scene, &NodePath(vec![0])).expect("a node");
        let refused = form.with(field(&form, "Radius"), json!(-1.0), &scene, &mut NoSources);
        assert!(refused.is_err_and(|e| e.to_string().contains("0.001")));
    }

    #[test]
    fn every_kind_of_node_has_a_form_that_gives_it_back() {
        let mut nodes: Vec<_> = (0..40).map(|seed| RandomTree::new(seed).tree()).collect();
        let mut kinds = std::collections::BTreeSet::new();
        while let Some(node) = nodes.pop() {
            nodes.extend(node.children().iter().cloned());
            if matches!(node.shape, Shape::Primitive(Primitive::Mesh(_))) {
                continue;
            }
            kinds.insert(node.type_name());
            let scene = Scene::new((*node).clone());
            let form = Form::of(&scene, &NodePath::default()).expect("a node");
            for field in form.fields.iter().filter(|field| !field.value.is_null()) {
                let command = form.with(field, field.value.clone(), &scene, &mut NoSources).expect("its own");
                let Command::SetShape { shape, .. } = command else { panic!("{command:?}") };
                assert_eq!(shape, NewShape::from(&node.shape), "{}", field.label);
            }
        }
        assert!(kinds.len() >= 24, "{kinds:?}");
    }
}
