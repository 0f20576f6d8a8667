//! The JSON Schema of scene files, from the same structs that read them.

use super::{MeshReference, TYPE_NAMES, VERSION};
use crate::primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, Segment, Torus,
};
use crate::sketched::{Inflation, LinearSweep, PathSweep, Revolution};
use crate::support_free::{BrushStroke, BrushTip, SupportFree};
use crate::warp::{AffineMap, Bend, Taper, Transform, Twist};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

/// The JSON Schema (draft 2020-12) of scene files, for editors that complete and check while typing.
///
/// It knows fields, types and single ranges; what relates fields to each other, only reading finds.
pub fn scene_schema() -> Value {
    let mut nodes: Vec<Value> = TYPE_NAMES.iter().map(|name| node(name)).collect();
    nodes.push(json!({
        "title": "use",
        "description": "A part from `define`, shared with every other place that uses it.",
        "type": "object",
        "properties": { "use": { "description": "The name of the definition.", "type": "string" } },
        "required": ["use"],
        "additionalProperties": false,
    }));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Trullo scene",
        "description": "A tree of solids. Millimetres, degrees, z up; the print bed is z = 0.",
        "type": "object",
        "properties": {
            "format": { "description": "Says that this is a scene.", "const": "trullo" },
            "version": { "description": "The version of the format.", "const": VERSION },
            "title": { "description": "What the scene is called.", "type": "string" },
            "define": {
                "description": "Parts by name, for `use`.",
                "type": "object",
                "additionalProperties": { "$ref": "#/$defs/node" },
            },
            "root": { "$ref": "#/$defs/node" },
        },
        "required": ["format", "version", "root"],
        "additionalProperties": false,
        "$defs": { "node": { "anyOf": nodes } },
    })
}

fn node(name: &str) -> Value {
    let (description, mut own, mut required) = match name {
        "point" => parameters::<Point>(),
        "segment" => parameters::<Segment>(),
        "polyline" => parameters::<Polyline>(),
        "disc" => parameters::<Disc>(),
        "polygon" => parameters::<Polygon>(),
        "box" => parameters::<Cuboid>(),
        "cylinder" => parameters::<Cylinder>(),
        "cone" => parameters::<Cone>(),
        "torus" => parameters::<Torus>(),
        "ellipsoid" => parameters::<Ellipsoid>(),
        "half_space" => parameters::<HalfSpace>(),
        "mesh" => parameters::<MeshReference>(),
        "inflation" => parameters::<Inflation>(),
        "sweep" => parameters::<LinearSweep>(),
        "revolution" => parameters::<Revolution>(),
        "path_sweep" => parameters::<PathSweep>(),
        "transform" => parameters::<Transform>(),
        "affine" => parameters::<AffineMap>(),
        "taper" => parameters::<Taper>(),
        "twist" => parameters::<Twist>(),
        "bend" => parameters::<Bend>(),
        "support_free" => parameters::<SupportFree>(),
        _ => operator(name),
    };
    if matches!(name, "transform" | "affine" | "taper" | "twist" | "bend" | "support_free") {
        own.insert("child".into(), json!({ "$ref": "#/$defs/node" }));
        required.push("child".into());
    }
    if name == "support_free" {
        own.insert("strokes".into(), strokes());
    }
    required.insert(0, "type".into());
    let mut properties = common();
    properties.insert("type".into(), json!({ "const": name }));
    properties.extend(own);
    json!({
        "title": name,
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// The list of brush strokes, whose tips may be nodes.
fn strokes() -> Value {
    let (description, mut properties, required) = parameters::<BrushStroke>();
    let tip = json!({
        "description": "The tip, of radius 1 mm around the origin: a ball if left out.",
        "anyOf": [{ "enum": BrushTip::NAMES }, { "$ref": "#/$defs/node" }],
        "default": "ball",
    });
    properties.insert("tip".into(), tip);
    json!({
        "description": "Brush strokes, done one after the other to what the mode has made.",
        "type": "array",
        "items": {
            "description": description,
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        },
        "default": [],
    })
}

/// The fields that every node may have.
fn common() -> Map<String, Value> {
    let fields = json!({
        "name": { "description": "What the user calls it.", "type": "string" },
        "color": {
            "description": "Its colour on screen, inherited by children without one.",
            "type": "string",
            "pattern": "^#[0-9a-fA-F]{6}$",
        },
        "muted": { "description": "Left out, as if it were not there.", "type": "boolean", "default": false },
        "construction": {
            "description": "Seen and drawn on, but not part of the solid.",
            "type": "boolean",
            "default": false,
        },
    });
    match fields {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

type NodeFields = (String, Map<String, Value>, Vec<Value>);

/// Description, properties and required ones of a struct.
fn parameters<T: JsonSchema>() -> NodeFields {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let schema = SchemaGenerator::new(settings).into_root_schema_for::<T>();
    let text = schema.get("description").and_then(Value::as_str).unwrap_or_default().to_owned();
    let properties = schema.get("properties").and_then(Value::as_object).cloned().unwrap_or_default();
    let required = schema.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
    (text, properties, required)
}

fn operator(name: &str) -> NodeFields {
    let description = match name {
        "union" => "All children together.",
        "intersection" => "What all children have in common.",
        "difference" => "The first child without the others.",
        "blend" => "All children, flowing into each other.",
        "blend_intersection" => "What all children have in common, with soft edges.",
        "blend_difference" => "The first child without the others, with soft edges.",
        "sum" => "All children, flowing into each other as widely as they can.",
        _ => "All children, flowing into each other only where their surfaces meet at an angle.",
    };
    let mut properties = Map::new();
    let children = json!({
        "description": "The nodes that are combined, in order.",
        "type": "array",
        "items": { "$ref": "#/$defs/node" },
    });
    properties.insert("children".into(), children);
    if name.starts_with("blend") {
        let sharpness = json!({
            "description": "The larger, the tighter the blend; 1 is the sum.",
            "type": "number",
            "minimum": 1,
            "maximum": 64,
            "default": 2,
        });
        properties.insert("sharpness".into(), sharpness);
    }
    (description.into(), properties, vec!["children".into()])
}
