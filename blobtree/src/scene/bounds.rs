//! Limits that are checked on the bare text, before anything is built from it.

use super::error::{SceneError, SceneProblem, TextPosition};
use super::{MAX_DEPTH, MAX_FILE_BYTES, MAX_OBJECTS};

/// Deepest nesting of brackets: two for each node, and some for the scene and the parameters.
const MAX_BRACKETS: usize = 2 * MAX_DEPTH + 8;
/// Most values in a file: each object may hold some, and each value costs memory while reading.
const MAX_VALUES: usize = 10 * MAX_OBJECTS;

/// Errors: a text with more bytes, brackets within brackets, objects or values than any legal scene has.
///
/// Cost: one pass, no memory. The text need not be JSON.
pub(super) fn check(text: &str) -> Result<(), SceneError> {
    if text.len() > MAX_FILE_BYTES {
        return Err(SceneProblem::TooLarge.into());
    }
    let (mut depth, mut objects, mut values) = (0_usize, 0_usize, 0_usize);
    let (mut in_string, mut escaped) = (false, false);
    for (offset, byte) in text.bytes().enumerate() {
        if in_string {
            (in_string, escaped) = (escaped || byte != b'"', !escaped && byte == b'\\');
            continue;
        }
        match byte {
            b'"' => in_string = true,
            b'{' | b'[' => (depth, objects) = (depth + 1, objects + usize::from(byte == b'{')),
            b'}' | b']' => depth = depth.saturating_sub(1),
            b',' => values += 1,
            _ => continue,
        }
        let problem = if depth > MAX_BRACKETS {
            SceneProblem::TooDeep
        } else if objects > MAX_OBJECTS || values > MAX_VALUES {
            SceneProblem::TooManyObjects
        } else {
            continue;
        };
        return Err(SceneError {
            at: Some(TextPosition::of_offset(text.as_bytes(), offset)),
            node: None,
            problem,
        });
    }
    Ok(())
}
