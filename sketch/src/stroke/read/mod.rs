//! Strokes from files: Trullo's own, SVG pictures, and doodles.

mod doodle;
mod error;
mod json;
mod svg;

pub use doodle::DoodleChoice;
pub use error::{ReadError, ReadProblem};
pub use json::{STROKES_VERSION, write_strokes};

use super::Stroke;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// The largest file that is read, bytes.
pub const MAX_FILE_BYTES: usize = 64 << 20;

/// Most strokes in a file: a hundred times the busiest doodle.
pub const MAX_STROKES: usize = 4096;

/// Most samples in all strokes of a file.
pub const MAX_SAMPLES: usize = 2_000_000;

/// A kind of file that strokes come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Trullo's own strokes, JSON:
    ///
    /// ```json
    /// {"format": "trullo-strokes", "version": 1, "strokes": [
    ///     {"samples": [{"x": 10, "y": 20, "time": 0.01, "pressure": 0.5, "tilt": [10, 0]}, [11, 20.5]]},
    ///     {"samples": [[30, 40], [31, 41, 1.25], [32, 41, 1.26, 0.5]], "eraser": true}
    /// ]}
    /// ```
    ///
    /// Pixels with y down, seconds, pressures from 0 to 1, degrees. A sample is an object, of which only `x` and
    /// `y` are needed, or a short list: x, y, and perhaps time, and perhaps pressure. Other fields are refused.
    Strokes,
    /// An SVG picture: each outline of its paths and shapes is a stroke, transformed as the picture says.
    Svg,
    /// Doodles, one JSON object a line: `drawing` is a list of strokes, each a list of x and a list of y, with y
    /// down, and perhaps a list of times in milliseconds; `key_id` names the doodle. Other fields are ignored.
    Doodles,
}

/// What a file is, by its content; by its name's extension where the content does not tell.
///
/// Errors: [`ReadProblem::UnknownFormat`] if neither tells, and [`ReadProblem::Scene`] for a scene.
pub fn detect(bytes: &[u8], name: Option<&Path>) -> Result<FileFormat, ReadError> {
    #[derive(Deserialize)]
    struct Head {
        format: Option<serde_json::Value>,
        drawing: Option<IgnoredAny>,
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if text.starts_with(b"<") {
        return Ok(FileFormat::Svg);
    }
    if let Some(Ok(head)) = serde_json::Deserializer::from_slice(text).into_iter::<Head>().next() {
        match head {
            Head { format: Some(format), .. } if format == "trullo" => {
                return Err(ReadProblem::Scene.into());
            }
            Head { format: Some(_), .. } => return Ok(FileFormat::Strokes),
            Head { drawing: Some(_), .. } => return Ok(FileFormat::Doodles),
            _ => {}
        }
    }
    let extension = name.and_then(Path::extension).and_then(|e| e.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "svg" => Ok(FileFormat::Svg),
        "ndjson" => Ok(FileFormat::Doodles),
        "json" | "strokes" => Ok(FileFormat::Strokes),
        _ if text.is_empty() => Err(ReadProblem::Empty.into()),
        // Broken JSON is told apart from other things by its reader.
        _ if text.starts_with(b"{") => Ok(FileFormat::Strokes),
        _ => Err(ReadProblem::UnknownFormat.into()),
    }
}

/// The strokes in a file, in pixels with y down, at most [`MAX_STROKES`] of at most [`MAX_SAMPLES`] samples.
///
/// Of a file of doodles, `choice` picks one; other files hold one drawing. Curves of an SVG become lines that
/// leave them by less than 1/4000 of the picture's size. Coordinates are as the file says; [`super::clean()`]
/// takes out what cannot be used.
///
/// Errors: what is wrong, and where; never a panic. **Cost:** linear in the file, which is refused above
/// [`MAX_FILE_BYTES`].
pub fn read(bytes: &[u8], format: FileFormat, choice: &DoodleChoice) -> Result<Vec<Stroke>, ReadError> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(ReadProblem::TooLarge.into());
    }
    let text = std::str::from_utf8(bytes).map_err(|error| ReadError {
        at: Some(error::position(bytes, error.valid_up_to())),
        problem: ReadProblem::NotUtf8,
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        return Err(ReadProblem::Empty.into());
    }
    let strokes = match format {
        FileFormat::Strokes => json::strokes(text)?,
        FileFormat::Svg => svg::strokes(text)?,
        FileFormat::Doodles => doodle::strokes(text, choice)?,
    };
    let samples: usize = strokes.iter().map(|stroke| stroke.samples.len()).sum();
    if strokes.len() > MAX_STROKES {
        return Err(ReadProblem::TooManyStrokes(strokes.len()).into());
    }
    if samples > MAX_SAMPLES {
        return Err(ReadProblem::TooManySamples.into());
    }
    Ok(strokes)
}
