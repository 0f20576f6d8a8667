//! From a line to its entry.

use super::{Before, FORMAT, WORDS};
use crate::document::{Command, JournalEntry, NewShape};
use crate::node::{Color, NodePath, NodeRef};
use crate::scene::error::SceneProblem;
use crate::scene::locate::Step;
use crate::scene::parameters::{self, described};
use crate::scene::read::{Fault, define_all, header, located, parsed};
use crate::scene::read_node::NodeReader;
use crate::scene::{Scene, SceneError, SceneSources};
use crate::support_free::BrushStroke;
use serde_json::{Map, Value};
use std::sync::Arc;

/// See [`JournalEntry::from_line`].
pub(crate) fn read(
    line: &[u8],
    scene: &Scene,
    sources: &mut dyn SceneSources,
) -> Result<JournalEntry, SceneError> {
    let (text, value) = parsed(line)?;
    entry(value, scene, sources).map_err(|fault| located(text, fault))
}

fn entry(value: Value, scene: &Scene, sources: &mut dyn SceneSources) -> Result<JournalEntry, Fault> {
    let shown = described(&value);
    let Value::Object(mut fields) = value else {
        let problem = parameters::wrong("the line", shown, "an object with `format`, `version` and `do`");
        return Err(Fault { steps: vec![], problem });
    };
    header(&mut fields, FORMAT)?;
    let word = word(&mut fields)?;
    if word == "together" {
        return together(&mut fields, scene, sources).map(Command::Together).map(JournalEntry::Command);
    }
    let mut line = Line { fields, reader: NodeReader::after(Before(scene), sources) };
    Ok(JournalEntry::Command(match word {
        "undo" => return Ok(JournalEntry::Undo),
        "redo" => return Ok(JournalEntry::Redo),
        "insert" => {
            Command::Insert { parent: line.path("parent")?, index: line.index()?, node: line.node()? }
        }
        "remove" => Command::Remove { path: line.path("path")? },
        "replace" => Command::Replace { path: line.path("path")?, node: line.node()? },
        "move" => {
            Command::Move { from: line.path("from")?, parent: line.path("parent")?, index: line.index()? }
        }
        "wrap" => line.wrap()?,
        "unwrap" => Command::Unwrap { path: line.path("path")? },
        "set_shape" => Command::SetShape { path: line.path("path")?, shape: line.shape()? },
        "add_stroke" => Command::AddStroke { path: line.path("path")?, stroke: line.stroke()? },
        "remove_stroke" => Command::RemoveStroke { path: line.path("path")?, index: line.index()? },
        "set_name" => Command::SetName { path: line.path("path")?, name: line.text("name")? },
        "set_color" => Command::SetColor { path: line.path("path")?, color: line.color()? },
        "set_muted" => Command::SetMuted { path: line.path("path")?, muted: line.sign("muted")? },
        "set_construction" => {
            Command::SetConstruction { path: line.path("path")?, construction: line.sign("construction")? }
        }
        _ => Command::SetTitle { title: line.text("title")? },
    }))
}

/// Commands, each as the line that it has by itself.
fn together(
    fields: &mut Map<String, Value>,
    scene: &Scene,
    sources: &mut dyn SceneSources,
) -> Result<Vec<Command>, Fault> {
    let expected = "a list of commands, each an object as on a line by itself";
    let value = parameters::need(fields, "commands", expected)?;
    let Value::Array(lines) = value else {
        let problem = parameters::wrong("commands", described(&value), expected);
        return Err(Fault { steps: vec![Step::key("commands")], problem });
    };
    let command = |(index, line): (usize, Value)| {
        let within = |steps| [vec![Step::key("commands"), Step::Index(index)], steps].concat();
        let shown = described(&line);
        match entry(line, scene, sources) {
            Ok(JournalEntry::Command(command)) => Ok(command),
            Ok(JournalEntry::Undo | JournalEntry::Redo) => {
                let problem = parameters::wrong("commands", shown, "commands only, no undo and no redo");
                Err(Fault { steps: within(Vec::new()), problem })
            }
            Err(Fault { steps, problem }) => Err(Fault { steps: within(steps), problem }),
        }
    };
    lines.into_iter().enumerate().map(command).collect()
}

/// The word that says what was done; the other fields are ones that belong to it.
fn word(fields: &mut Map<String, Value>) -> Result<&'static str, Fault> {
    let expected = "what was done, such as \"insert\"";
    let value = parameters::need(fields, "do", expected)?;
    let at_do = |problem| Fault { steps: vec![Step::key("do")], problem };
    let Some(said) = value.as_str() else {
        return Err(at_do(parameters::wrong("do", described(&value), expected)));
    };
    let Some((word, own)) = WORDS.into_iter().find(|(word, _)| *word == said) else {
        return Err(at_do(parameters::unknown("command", said, WORDS.into_iter().map(|(word, _)| word))));
    };
    match fields.keys().find(|field| !own.contains(&field.as_str())) {
        None => Ok(word),
        Some(field) => {
            let legal: Vec<&str> =
                ["format", "version", "do"].into_iter().chain(own.iter().copied()).collect();
            Err(parameters::unknown_field(field, &legal).into())
        }
    }
}

/// The fields of a line that were not yet read.
struct Line<'a> {
    fields: Map<String, Value>,
    reader: NodeReader<'a>,
}

impl Line<'_> {
    fn need<T: serde::de::DeserializeOwned>(&mut self, field: &str, expected: &str) -> Result<T, Fault> {
        let missing = || SceneProblem::Missing { field: field.into(), expected: expected.into() };
        parameters::take(&mut self.fields, field, expected)?
            .ok_or_else(|| Fault { steps: vec![], problem: missing() })
    }

    fn path(&mut self, field: &str) -> Result<NodePath, Fault> {
        let expected = "a node's path, such as \"/0/2\"";
        let text: String = self.need(field, expected)?;
        text.parse().map_err(|_| {
            let problem = parameters::wrong(field, described(&text.into()), expected);
            Fault { steps: vec![Step::key(field)], problem }
        })
    }

    fn index(&mut self) -> Result<usize, Fault> {
        self.need("index", "a whole number from 0 on")
    }

    fn sign(&mut self, field: &str) -> Result<bool, Fault> {
        self.need(field, "true or false")
    }

    fn text(&mut self, field: &str) -> Result<Option<String>, Fault> {
        Ok(parameters::take(&mut self.fields, field, "a text")?)
    }

    fn color(&mut self) -> Result<Option<Color>, Fault> {
        Ok(parameters::color(&mut self.fields)?)
    }

    fn node(&mut self) -> Result<NodeRef, Fault> {
        let define = self.fields.remove("define").unwrap_or_else(|| Map::new().into());
        define_all(define, &mut self.reader)?;
        let node = parameters::need(&mut self.fields, "node", "the node, an object with `type`")?;
        self.reader.read_from(vec![Step::key("node")], node)
    }

    fn shape(&mut self) -> Result<NewShape, Fault> {
        let shape =
            parameters::need(&mut self.fields, "shape", "what the node becomes, an object with `type`")?;
        self.reader.read_shape(vec![Step::key("shape")], shape)
    }

    fn stroke(&mut self) -> Result<Arc<BrushStroke>, Fault> {
        let stroke = parameters::need(&mut self.fields, "stroke", "the stroke, an object with `brush`")?;
        self.reader.read_stroke(vec![Step::key("stroke")], stroke).map(Arc::new)
    }

    fn wrap(&mut self) -> Result<Command, Fault> {
        let path = self.path("path")?;
        match self.shape()? {
            NewShape::Operator(operator) => Ok(Command::WrapInOperator { path, operator }),
            NewShape::Warp(warp) => Ok(Command::WrapInWarp { path, warp }),
            NewShape::SupportFree(rule) => Ok(Command::WrapInSupportFree { path, rule }),
            NewShape::Primitive(primitive) => {
                let found = format!("a {}", primitive.type_name());
                let problem = parameters::wrong("shape", found, "an operator, a warp or a support_free");
                Err(Fault { steps: vec![Step::key("shape")], problem })
            }
        }
    }
}
