//! The fields of one JSON object, taken out and told apart from fields that do not belong there.

use super::error::{SceneProblem, nearest, shortened};
use super::locate::Step;
use crate::checks::ParameterError;
use crate::node::Color;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use serde_path_to_error::{Path, Segment};

/// A problem with a field: the steps from the object to it, and what is wrong there.
pub(super) type FieldFault = (Vec<Step>, SceneProblem);

/// Takes a field out, if it is there.
///
/// Errors: a value of another type than `expected` says.
pub(super) fn take<T: DeserializeOwned>(
    map: &mut Map<String, Value>,
    field: &str,
    expected: &str,
) -> Result<Option<T>, FieldFault> {
    let Some(value) = map.remove(field) else { return Ok(None) };
    let shown = described(&value);
    match serde_json::from_value(value) {
        Ok(value) => Ok(Some(value)),
        Err(_) => Err((vec![Step::key(field)], wrong(field, shown, expected))),
    }
}

/// Takes a field out that must be there.
///
/// Errors: a value of another type than `expected` says, or none.
pub(super) fn need(map: &mut Map<String, Value>, field: &str, expected: &str) -> Result<Value, FieldFault> {
    map.remove(field)
        .ok_or_else(|| (vec![], SceneProblem::Missing { field: field.into(), expected: expected.into() }))
}

/// Takes a node's colour out, if it has one.
///
/// Errors: something that is no colour.
pub(super) fn color(map: &mut Map<String, Value>) -> Result<Option<Color>, FieldFault> {
    let expected = "a text like \"#ff8800\"";
    let Some(text) = take::<String>(map, "color", expected)? else { return Ok(None) };
    text.parse().map(Some).map_err(|_| {
        let shown = described(&text.into());
        (vec![Step::key("color")], wrong("color", shown, "a colour like \"#ff8800\""))
    })
}

/// Errors: a field is left over. `legal` are those that would be right.
pub(super) fn nothing_left(map: &Map<String, Value>, legal: &[&str]) -> Result<(), FieldFault> {
    map.keys().next().map_or(Ok(()), |field| Err(unknown_field(field, legal)))
}

/// A field that does not belong there. `legal` are those that would be right.
pub(super) fn unknown_field(field: &str, legal: &[&str]) -> FieldFault {
    let legal = if legal.is_empty() { "none".into() } else { legal.join(", ") };
    (vec![Step::key(field)], SceneProblem::UnknownField { field: shortened(field), legal })
}

/// The whole object as the parameters of a node. `others` are fields that were legal but taken before.
///
/// Errors: the first field that is missing, of a wrong type, or does not belong there.
pub(super) fn all<T: DeserializeOwned>(map: Map<String, Value>, others: &[&str]) -> Result<T, FieldFault> {
    let value = Value::Object(map);
    serde_path_to_error::deserialize(&value).map_err(|error| fault(&value, &error, others))
}

pub(super) fn wrong(field: &str, value: String, expected: &str) -> SceneProblem {
    SceneProblem::Parameter(ParameterError { field: field.into(), value, expected: expected.into() })
}

/// A value as shown in messages: short, with what kind of value it is.
pub(super) fn described(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(_) | Value::Number(_) => value.to_string(),
        Value::String(text) => format!("the text \"{}\"", shortened(text)),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".into(),
    }
}

/// Tells serde's errors in our terms.
fn fault(
    value: &Value,
    error: &serde_path_to_error::Error<serde_json::Error>,
    others: &[&str],
) -> FieldFault {
    let steps = steps(error.path());
    let message = error.inner().to_string();
    let field = error.path().to_string();
    let backticked = || message.split('`').nth(1).unwrap_or_default().to_owned();
    let problem = if message.starts_with("missing field") {
        let name = backticked();
        let field = if steps.is_empty() { name } else { format!("{field}.{name}") };
        SceneProblem::Missing { field, expected: "the node needs it".into() }
    } else if message.starts_with("unknown field") {
        let legal = message.split_once("expected ").map_or("", |(_, legal)| legal);
        let mut legal = legal.trim_start_matches("one of ").replace(" or ", ", ").replace('`', "");
        if steps.len() == 1 {
            legal = format!("{legal}, {}", others.join(", "));
        }
        SceneProblem::UnknownField { field: shortened(&backticked()), legal }
    } else {
        let expected = message.rsplit_once("expected ").map_or(&*message, |(_, expected)| expected);
        let shown = at(value, &steps).map_or_else(|| shortened(&message), described);
        wrong(&field, shown, &in_our_words(expected))
    };
    (steps, problem)
}

fn steps(path: &Path) -> Vec<Step> {
    path.iter()
        .filter_map(|segment| match segment {
            Segment::Seq { index } => Some(Step::Index(*index)),
            Segment::Map { key } => Some(Step::key(key)),
            Segment::Enum { .. } | Segment::Unknown => None,
        })
        .collect()
}

fn at<'a>(value: &'a Value, steps: &[Step]) -> Option<&'a Value> {
    steps.iter().try_fold(value, |value, step| match step {
        Step::Key(key) => value.get(key),
        Step::Index(index) => value.get(index),
    })
}

/// What serde expected, as a user would say it.
fn in_our_words(expected: &str) -> String {
    match expected {
        "f32" => "a number".into(),
        "a sequence of 2 f32 values" => "two numbers, like [0, 10]".into(),
        "a sequence of 3 f32 values" => "three numbers, like [0, 0, 10]".into(),
        "fewer elements in array" => "a shorter list".into(),
        "a string" => "a text".into(),
        "a sequence" => "a list".into(),
        "an array of length 3" => "a list of 3".into(),
        "an array of length 4" => "a list of 4".into(),
        _ if expected.starts_with("struct ") => "an object".into(),
        _ if expected.starts_with("string or map") || expected.starts_with("variant") => "a text".into(),
        _ => expected.replace('`', "").replace("one of ", ""),
    }
}

/// An unknown word, with what was probably meant.
pub(super) fn unknown<'a>(
    what: &'static str,
    found: &str,
    legal: impl Iterator<Item = &'a str> + Clone,
) -> SceneProblem {
    SceneProblem::Unknown { what, found: shortened(found), nearest: nearest(found, legal) }
}
