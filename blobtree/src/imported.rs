//! The imported-mesh primitive: a reference to a file, and what was read from it.

use crate::checks::{Checked, ParameterError, length};
use mesh::MeshDistance;
use std::sync::Arc;

/// A triangle mesh from a file, kept by reference so that scenes stay small.
#[derive(Clone, Debug)]
pub struct ImportedMesh {
    /// The file as named in the scene, relative to it.
    pub file: String,
    /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits.
    pub sha256: String,
    /// How far the influence reaches beyond the surface, mm.
    pub falloff: f32,
    /// What was read from the file.
    pub distance: Arc<MeshDistance>,
}

/// Equal when they name the same file with the same content and falloff.
impl PartialEq for ImportedMesh {
    fn eq(&self, other: &Self) -> bool {
        (&self.file, &self.sha256, self.falloff) == (&other.file, &other.sha256, other.falloff)
    }
}

impl Checked for ImportedMesh {
    fn check(&self) -> Result<(), ParameterError> {
        length("falloff", self.falloff)?;
        if self.sha256.len() != 64 || !self.sha256.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')) {
            return Err(ParameterError::new("sha256", &self.sha256, "64 lower-case hexadecimal digits"));
        }
        Ok(())
    }
}
