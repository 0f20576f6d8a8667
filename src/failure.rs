//! Why a command could not be carried out.

use polygonizer::PolygonizeError;
use std::fmt::Display;
use std::path::Path;

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The input, or what was asked for, is not possible: place, what is wrong, what would be right.
    #[error("{0}")]
    Input(String),
    /// Somebody asked to stop. Nothing was written.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

impl Failure {
    /// Something wrong with a file.
    pub fn of(file: &Path, what: impl Display) -> Self {
        Self::Input(format!("{}: {what}", file.display()))
    }

    /// What stopped meshing the scene in `file`.
    pub fn of_meshing(file: &Path, error: PolygonizeError) -> Self {
        match error {
            PolygonizeError::Cancelled => Self::Interrupted,
            other => Self::of(file, other),
        }
    }

    /// The program's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Interrupted => 3,
        }
    }
}
