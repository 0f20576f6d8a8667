//! What can be wrong with a file of strokes, and where.

use super::{MAX_FILE_BYTES, MAX_SAMPLES, MAX_STROKES, STROKES_VERSION};
use blobtree::TextPosition;
use std::fmt;

/// Why strokes cannot be had from a file, and where it goes wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The place in the file, if there is one.
    pub at: Option<TextPosition>,
    /// What is wrong there.
    pub problem: ReadProblem,
}

/// What is wrong with a file of strokes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// There is nothing in it.
    #[error("the file is empty; it should hold strokes as JSON, an SVG picture, or doodles as ndjson")]
    Empty,
    /// It is none of the known kinds.
    #[error("not a drawing that Trullo knows: strokes as JSON, an SVG picture, or doodles as ndjson")]
    UnknownFormat,
    /// It is a scene, not a drawing.
    #[error("this is a scene, not a drawing; it can be meshed as it is")]
    Scene,
    /// It is too long.
    #[error("larger than {} MiB, the most that a drawing may be", MAX_FILE_BYTES >> 20)]
    TooLarge,
    /// The bytes are not text.
    #[error("not text in UTF-8")]
    NotUtf8,
    /// It is not JSON, or does not say what strokes are.
    #[error("{0}")]
    Json(String),
    /// It says that it is something else.
    #[error("not strokes: `format` is {0}, not \"trullo-strokes\"")]
    OtherFormat(String),
    /// It is from a newer Trullo.
    #[error("version {0} of the strokes format is not {STROKES_VERSION}, the one that this Trullo reads")]
    OtherVersion(u64),
    /// It is not XML.
    #[error("not XML: {0}")]
    Xml(String),
    /// It is XML but no SVG picture.
    #[error("not an SVG picture: {0}")]
    Svg(String),
    /// There are no outlines in the picture.
    #[error("the picture has no outlines; text must be converted to paths, and photographs hold none")]
    NoOutlines,
    /// Too many strokes.
    #[error(
        "{0} strokes, more than {MAX_STROKES}, the most that a drawing may have; is this a map or a text?"
    )]
    TooManyStrokes(usize),
    /// Too many samples.
    #[error("more than {MAX_SAMPLES} samples, the most that a drawing may have")]
    TooManySamples,
    /// There are fewer doodles than asked for.
    #[error("there is no doodle {0}; the file has {1}, counted from 0")]
    NoSuchDoodle(usize, usize),
    /// No doodle has this key.
    #[error("no doodle in the file has the key {0}")]
    NoSuchKey(String),
    /// The coordinates of a doodle's stroke do not pair up.
    #[error("stroke {stroke} of the doodle has {lists}; each stroke is two lists of equal length, x and y")]
    Unpaired {
        /// The stroke, counted from 0.
        stroke: usize,
        /// What it has.
        lists: String,
    },
}

impl std::error::Error for ReadError {}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(at) = self.at {
            write!(f, "line {}, column {}: ", at.line, at.column)?;
        }
        self.problem.fmt(f)
    }
}

impl From<ReadProblem> for ReadError {
    fn from(problem: ReadProblem) -> Self {
        Self { at: None, problem }
    }
}

/// What serde_json says, in our terms; `line` is the line that the text begins on, less one.
pub(super) fn json(error: &serde_json::Error, line: usize) -> ReadError {
    let said = error.to_string();
    // The place goes in front, where all our errors have it.
    let said = said.split(" at line ").next().unwrap_or_default().to_owned();
    let at = TextPosition { line: line + error.line(), column: error.column() };
    ReadError { at: (error.line() > 0).then_some(at), problem: ReadProblem::Json(said) }
}

/// The line and column `offset` bytes into the text.
pub(super) fn position(text: &[u8], offset: usize) -> TextPosition {
    let before = &text[..offset.min(text.len())];
    let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
    TextPosition { line, column: String::from_utf8_lossy(&before[line_start..]).chars().count() + 1 }
}
