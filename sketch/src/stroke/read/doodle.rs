//! Doodles: one JSON object a line, with `drawing`, a list of strokes, each a list of x and a list of y, and
//! perhaps a list of times in milliseconds.

use super::error::{ReadError, ReadProblem, json};
use crate::stroke::{PenSample, Stroke};
use serde::Deserialize;
use serde_json::Value;

/// Which doodle of a file is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DoodleChoice {
    /// The one on this line, counted from 0; empty lines do not count.
    Index(usize),
    /// The one with this `key_id`.
    Key(String),
}

impl Default for DoodleChoice {
    fn default() -> Self {
        Self::Index(0)
    }
}

#[derive(Deserialize)]
struct Doodle {
    drawing: Vec<Vec<Vec<f32>>>,
}

/// The strokes of the chosen doodle. Errors: as [`super::read`].
pub(super) fn strokes(text: &str, choice: &DoodleChoice) -> Result<Vec<Stroke>, ReadError> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let found = match choice {
        DoodleChoice::Index(index) => lines.clone().nth(*index),
        DoodleChoice::Key(key) => lines.find(|(_, line)| has_key(line, key)),
    };
    let Some((number, line)) = found else {
        return Err(match choice {
            DoodleChoice::Index(index) => {
                let count = text.lines().filter(|line| !line.trim().is_empty()).count();
                ReadProblem::NoSuchDoodle(*index, count).into()
            }
            DoodleChoice::Key(key) => ReadProblem::NoSuchKey(key.clone()).into(),
        });
    };
    let doodle: Doodle = serde_json::from_str(line).map_err(|error| json(&error, number))?;
    let at = Some(blobtree::TextPosition { line: number + 1, column: 1 });
    let strokes = doodle.drawing.iter().enumerate().map(|(i, lists)| stroke(i, lists));
    strokes.collect::<Result<_, _>>().map_err(|problem| ReadError { at, problem })
}

/// Whether a line's doodle has this key, written as text or as a number.
fn has_key(line: &str, key: &str) -> bool {
    #[derive(Deserialize)]
    struct Head {
        key_id: Value,
    }
    // Most lines do not have the key's letters at all.
    line.contains(key)
        && serde_json::from_str::<Head>(line).is_ok_and(|head| match head.key_id {
            Value::String(id) => id == key,
            Value::Number(id) => id.as_u64().is_some_and(|id| key.parse() == Ok(id)),
            _ => false,
        })
}

fn stroke(number: usize, lists: &[Vec<f32>]) -> Result<Stroke, ReadProblem> {
    let unpaired = || {
        let lengths: Vec<String> = lists.iter().take(4).map(|list| list.len().to_string()).collect();
        let lists = format!("{} lists, of {} numbers", lists.len(), lengths.join(" and "));
        ReadProblem::Unpaired { stroke: number, lists }
    };
    let (xs, ys, times) = match lists {
        [xs, ys] => (xs, ys, None),
        [xs, ys, times] => (xs, ys, Some(times)),
        _ => return Err(unpaired()),
    };
    if xs.len() != ys.len() || times.is_some_and(|times| times.len() != xs.len()) {
        return Err(unpaired());
    }
    let sample = |i: usize| PenSample {
        x: xs[i],
        y: ys[i],
        time: times.map(|times| times[i] / 1000.0),
        pressure: 1.0,
        tilt: [0.0; 2],
    };
    Ok(Stroke { samples: (0..xs.len()).map(sample).collect(), eraser: false })
}
