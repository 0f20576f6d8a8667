//! From an entry to its line.

use super::{FORMAT, childless};
use crate::document::{Command, JournalEntry, NewShape};
use crate::node::{Node, NodePath, NodeRef, Shape};
use crate::scene::check::{measure, numbers};
use crate::scene::write::{Bare, Definitions, Names, Referred, text_of};
use crate::scene::{Scene, SceneError, SceneProblem, VERSION, bounds};
use crate::support_free::BrushStroke;

/// See [`JournalEntry::to_line`].
pub(crate) fn write(entry: &JournalEntry, scene: &Scene) -> Result<String, SceneError> {
    match entry {
        JournalEntry::Command(command) => line(command, scene),
        JournalEntry::Undo => Ok(text_of(&Line::of("undo"))),
        JournalEntry::Redo => Ok(text_of(&Line::of("redo"))),
    }
}

fn line(command: &Command, scene: &Scene) -> Result<String, SceneError> {
    if let Command::AddStroke { stroke, .. } = command {
        stroke.check("stroke").map_err(SceneProblem::from)?;
    }
    let (line, with) = match command {
        Command::Together(commands) => return together(commands, scene),
        other => parts(other),
    };
    let text = match with {
        With::Nothing => text_of(&line),
        With::Shape(shape) => {
            let node = Node::new(shape);
            numbers(&node)?;
            text_of(&Line { shape: Some(Bare(&node)), ..line })
        }
        With::Node(node) => {
            measure(node)?;
            let names = Names::beside(scene, node);
            text_of(&Line {
                define: names.definitions(),
                node: Some(Referred { node, names: &names }),
                ..line
            })
        }
    };
    bounds::check(&text)?;
    Ok(text)
}

/// Each of the commands as the line that it has by itself.
fn together(commands: &[Command], scene: &Scene) -> Result<String, SceneError> {
    let lines = commands.iter().map(|command| line(command, scene)).collect::<Result<Vec<_>, _>>()?;
    let head = text_of(&Line::of("together"));
    let text = format!("{},\"commands\":[{}]}}", head.trim_end_matches('}'), lines.join(","));
    bounds::check(&text)?;
    Ok(text)
}

/// What a command brings along beside plain values.
enum With<'a> {
    Nothing,
    Shape(Shape),
    Node(&'a NodeRef),
}

fn parts(command: &Command) -> (Line<'_>, With<'_>) {
    let plain = |line| (line, With::Nothing);
    match command {
        Command::Insert { parent, index, node } => {
            let line = Line { parent: Some(parent.to_string()), index: Some(*index), ..Line::of("insert") };
            (line, With::Node(node))
        }
        Command::Remove { path } => plain(Line::at("remove", path)),
        Command::Replace { path, node } => (Line::at("replace", path), With::Node(node)),
        Command::Move { from, parent, index } => plain(Line {
            from: Some(from.to_string()),
            parent: Some(parent.to_string()),
            index: Some(*index),
            ..Line::of("move")
        }),
        Command::WrapInOperator { path, operator } => {
            (Line::at("wrap", path), With::Shape(childless(NewShape::Operator(*operator))))
        }
        Command::WrapInWarp { path, warp } => {
            (Line::at("wrap", path), With::Shape(childless(NewShape::Warp(warp.clone()))))
        }
        Command::WrapInSupportFree { path, rule } => {
            (Line::at("wrap", path), With::Shape(childless(NewShape::SupportFree(rule.clone()))))
        }
        Command::Unwrap { path } => plain(Line::at("unwrap", path)),
        Command::SetShape { path, shape } => {
            (Line::at("set_shape", path), With::Shape(childless(shape.clone())))
        }
        Command::AddStroke { path, stroke } => {
            plain(Line { stroke: Some(&**stroke), ..Line::at("add_stroke", path) })
        }
        Command::RemoveStroke { path, index } => {
            plain(Line { index: Some(*index), ..Line::at("remove_stroke", path) })
        }
        Command::SetName { path, name } => {
            plain(Line { name: name.as_deref(), ..Line::at("set_name", path) })
        }
        Command::SetColor { path, color } => {
            plain(Line { color: color.map(|color| color.to_string()), ..Line::at("set_color", path) })
        }
        Command::SetMuted { path, muted } => {
            plain(Line { muted: Some(*muted), ..Line::at("set_muted", path) })
        }
        Command::SetConstruction { path, construction } => {
            plain(Line { construction: Some(*construction), ..Line::at("set_construction", path) })
        }
        Command::Together(_) => unreachable!("its line is made of lines"),
        Command::SetTitle { title } => plain(Line { title: title.as_deref(), ..Line::of("set_title") }),
    }
}

/// The fields of all lines, in the order in which they are written.
#[derive(Default, serde::Serialize)]
struct Line<'a> {
    format: &'static str,
    version: u64,
    r#do: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    index: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    muted: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    construction: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    title: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shape: Option<Bare<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stroke: Option<&'a BrushStroke>,
    #[serde(skip_serializing_if = "Option::is_none")]
    define: Option<Definitions<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    node: Option<Referred<'a>>,
}

impl Line<'_> {
    fn of(word: &'static str) -> Self {
        Self { format: FORMAT, version: VERSION, r#do: word, ..Self::default() }
    }

    fn at(word: &'static str, path: &NodePath) -> Self {
        Self { path: Some(path.to_string()), ..Self::of(word) }
    }
}
