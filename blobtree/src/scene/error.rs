//! What can be wrong with a scene, and where.

use super::{MAX_DEPTH, MAX_FILE_BYTES, MAX_NODES, MAX_OBJECTS, VERSION};
use crate::checks::ParameterError;
use std::fmt;

/// Why something is not a legal scene, and where it goes wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The place in the text; none for a scene that was not read from text.
    pub at: Option<TextPosition>,
    /// The node, as a path like `/0/2` from the root or `define.leg/1` from a definition.
    pub node: Option<String>,
    /// What is wrong there.
    pub problem: SceneProblem,
}

/// A place in a text, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextPosition {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
}

impl TextPosition {
    /// The place `offset` bytes into `text`, or its end.
    pub(super) fn of_offset(text: &[u8], offset: usize) -> Self {
        let before = &text[..offset.min(text.len())];
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        Self { line, column: String::from_utf8_lossy(&before[line_start..]).chars().count() + 1 }
    }
}

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneProblem {
    /// The bytes could not be had.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// There is no text.
    #[error(
        "the file is empty; a scene begins with {{\"format\": \"trullo\", \"version\": {VERSION}, \"root\": …"
    )]
    Empty,
    /// The text is too long.
    #[error("larger than {} MiB, the most that a scene file may be", MAX_FILE_BYTES >> 20)]
    TooLarge,
    /// The bytes are not text.
    #[error("not text: scene files are JSON in UTF-8")]
    NotUtf8,
    /// The text is not JSON.
    #[error("not JSON: {0}")]
    Syntax(String),
    /// Brackets or nodes are nested too deep.
    #[error("nested more than {MAX_DEPTH} nodes deep")]
    TooDeep,
    /// Too many nodes are written down.
    #[error("more than {MAX_OBJECTS} nodes and points; share repeated parts with `define` and `use`")]
    TooManyObjects,
    /// Shared nodes multiply to too many.
    #[error("more than {MAX_NODES} nodes, shared ones counted wherever they are used")]
    TooManyNodes,
    /// The file says that it is something else.
    #[error("not a scene: `format` is {0}, not \"trullo\"")]
    NotTrullo(String),
    /// The line says that it is something else.
    #[error("not a line of a journal: `format` is {0}, not \"trullo-journal\"")]
    NotJournal(String),
    /// The file is from a newer Trullo.
    #[error("version {0} of the format is newer than {VERSION}, the newest that this Trullo reads")]
    NewerVersion(u64),
    /// A field is needed and not there.
    #[error("`{field}` is missing: {expected}")]
    Missing {
        /// The field.
        field: String,
        /// What should be there.
        expected: String,
    },
    /// A field has a value that it cannot have.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A field that does not exist here.
    #[error("there is no field `{field}` here, but {legal}")]
    UnknownField {
        /// The field.
        field: String,
        /// The fields that do exist.
        legal: String,
    },
    /// A word that is none of the legal ones.
    #[error("{what} `{found}` is not known{nearest}")]
    Unknown {
        /// What it should name, such as "node type".
        what: &'static str,
        /// What it says.
        found: String,
        /// What was probably meant, or the legal words.
        nearest: String,
    },
    /// Definitions use each other in a circle.
    #[error("definitions use each other in a circle: {}", .0.join(" uses "))]
    Cycle(Vec<String>),
    /// A mesh could not be had.
    #[error("mesh `{file}`: {reason}")]
    Mesh {
        /// The file, as named in the scene.
        file: String,
        /// Why not.
        reason: String,
    },
    /// A drawing is no outline of a solid.
    #[error("the drawing: {0}")]
    Drawing(String),
}

impl From<SceneProblem> for SceneError {
    fn from(problem: SceneProblem) -> Self {
        Self { at: None, node: None, problem }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(TextPosition { line, column }) = self.at {
            write!(f, "line {line}, column {column}: ")?;
        }
        if let Some(node) = &self.node {
            write!(f, "node {node}: ")?;
        }
        self.problem.fmt(f)
    }
}

impl std::error::Error for SceneError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.problem {
            SceneProblem::Parameter(e) => Some(e),
            _ => None,
        }
    }
}

/// At most about 60 characters of a text, for showing.
pub(super) fn shortened(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

/// " ; did you mean …?" if one of `legal` is close to `found`, else the list, unless it is long.
pub(super) fn nearest<'a>(found: &str, legal: impl Iterator<Item = &'a str> + Clone) -> String {
    let close = legal.clone().map(|word| (distance(found, word), word)).min();
    match close {
        Some((d, word)) if d <= 1 + word.chars().count() / 4 => format!("; did you mean `{word}`?"),
        Some(_) if legal.clone().count() <= 30 => {
            format!("; the known ones are {}", legal.collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    }
}

/// How many letters must be added, dropped or changed to make `a` into `b`; large for long words.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
