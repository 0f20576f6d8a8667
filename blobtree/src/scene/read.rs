//! From bytes to a scene: the text, the JSON, the header, the definitions.

use super::error::{SceneError, SceneProblem, TextPosition};
use super::locate::{self, Step};
use super::parameters::{self, FieldFault, described};
use super::read_node::NodeReader;
use super::strict::Strict;
use super::{Scene, SceneSources, VERSION, bounds, definitions};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::sync::Arc;

/// Something wrong at the value to which `steps` lead from the top of the file.
#[derive(Debug)]
pub(super) struct Fault {
    pub steps: Vec<Step>,
    pub problem: SceneProblem,
}

impl From<FieldFault> for Fault {
    fn from((steps, problem): FieldFault) -> Self {
        Self { steps, problem }
    }
}

/// The word by which a scene file says what it is.
const FORMAT: &str = "trullo";

/// Brings a file of version n + 1 up to version n + 2, for n its place in [`MIGRATIONS`].
type Migration = fn(&mut Map<String, Value>);

/// One step for each version before the newest.
const MIGRATIONS: [Migration; VERSION as usize - 1] = [];

/// See [`Scene::from_bytes`].
pub(super) fn scene(bytes: &[u8], sources: &mut dyn SceneSources) -> Result<Scene, SceneError> {
    let (text, value) = parsed(bytes)?;
    from_value(value, sources).map_err(|fault| located(text, fault))
}

/// The JSON value in the bytes, and the text of which it was read.
pub(super) fn parsed(bytes: &[u8]) -> Result<(&str, Value), SceneError> {
    if bytes.len() > super::MAX_FILE_BYTES {
        return Err(SceneProblem::TooLarge.into());
    }
    let text = text(bytes)?;
    bounds::check(text)?;
    Ok((text, json(text)?))
}

/// The fault with its place in the text.
pub(super) fn located(text: &str, fault: Fault) -> SceneError {
    SceneError {
        at: Some(locate::position(text, &fault.steps)),
        node: locate::node_label(&fault.steps),
        problem: fault.problem,
    }
}

fn text(bytes: &[u8]) -> Result<&str, SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|e| SceneError {
        at: Some(TextPosition::of_offset(bytes, e.valid_up_to())),
        node: None,
        problem: SceneProblem::NotUtf8,
    })?;
    // Some editors put a byte order mark before everything.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() { Err(SceneProblem::Empty.into()) } else { Ok(text) }
}

/// The caller has checked the nesting, so recursion stays shallow.
fn json(text: &str) -> Result<Value, SceneError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    deserializer.disable_recursion_limit();
    let value = Strict::deserialize(&mut deserializer).and_then(|value| deserializer.end().map(|()| value));
    value.map(|Strict(value)| value).map_err(|e| {
        let message = e.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let line = text.lines().nth(e.line().saturating_sub(1)).unwrap_or_default();
        // serde_json counts bytes, and the line's break as column 0 of the next.
        let before = line.as_bytes().get(..e.column().saturating_sub(1)).unwrap_or(line.as_bytes());
        let column = String::from_utf8_lossy(before).chars().count() + 1;
        let at = TextPosition { line: e.line().max(1), column };
        SceneError { at: Some(at), node: None, problem: SceneProblem::Syntax(message.into()) }
    })
}

fn from_value(value: Value, sources: &mut dyn SceneSources) -> Result<Scene, Fault> {
    let shown = described(&value);
    let Value::Object(mut file) = value else {
        let problem = parameters::wrong("the file", shown, "an object with `format`, `version` and `root`");
        return Err(Fault { steps: vec![], problem });
    };
    let version = header(&mut file, FORMAT)?;
    // A version before the newest is at least 1, so the index is in range.
    MIGRATIONS.iter().skip(version as usize - 1).for_each(|migrate| migrate(&mut file));
    let title = parameters::take(&mut file, "title", "a text")?;
    let define = file.remove("define").unwrap_or_else(|| Map::new().into());
    let root = parameters::need(&mut file, "root", "the tree, an object with `type`")?;
    parameters::nothing_left(&file, &["format", "version", "title", "define", "root"])?;

    let mut reader = NodeReader::new(sources);
    define_all(define, &mut reader)?;
    let root = reader.read_from(vec![Step::key("root")], root)?;
    Ok(Scene { title, definitions: Arc::new(reader.into_definitions()), root })
}

/// The version, which is one that can be read, of a file of this format.
pub(super) fn header(file: &mut Map<String, Value>, wanted: &'static str) -> Result<u64, Fault> {
    let at = |field: &str, problem| Fault { steps: vec![Step::key(field)], problem };
    let is = if wanted == FORMAT { "a scene file" } else { "a line of a journal" };
    let format = parameters::need(file, "format", &format!("{is} says \"format\": \"{wanted}\""))?;
    if format.as_str() != Some(wanted) {
        let found = described(&format);
        let problem =
            if wanted == FORMAT { SceneProblem::NotTrullo(found) } else { SceneProblem::NotJournal(found) };
        return Err(at("format", problem));
    }
    let version = parameters::need(file, "version", &format!("the newest is \"version\": {VERSION}"))?;
    match version.as_u64() {
        Some(found @ 1..=VERSION) => Ok(found),
        Some(found) if found > VERSION => Err(at("version", SceneProblem::NewerVersion(found))),
        _ => {
            let expected = format!("a whole number from 1 to {VERSION}");
            Err(at("version", parameters::wrong("version", described(&version), &expected)))
        }
    }
}

/// Reads all definitions.
pub(super) fn define_all(define: Value, reader: &mut NodeReader) -> Result<(), Fault> {
    let shown = described(&define);
    let Value::Object(mut define) = define else {
        let problem = parameters::wrong("define", shown, "an object of named nodes");
        return Err(Fault { steps: vec![Step::key("define")], problem });
    };
    for name in definitions::in_order(&define)? {
        if let Some(value) = define.remove(&name) {
            reader.define(name, value)?;
        }
    }
    Ok(())
}
