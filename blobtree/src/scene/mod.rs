//! Scenes and their files: a tree with a title, read from and written to JSON text.
//!
//! Reach for [`Scene::from_bytes`] and [`Scene::to_text`]; what a file looks like is in
//! `docs/scene-format.md`. Nothing here opens a file: bytes come in, text goes out, and [`SceneSources`]
//! answer for the mesh files that a scene names and the drawings that it holds.

mod bounds;
mod check;
mod color;
mod definitions;
mod error;
pub(crate) mod journal;
mod layout;
mod locate;
mod parameters;
mod read;
mod read_node;
mod schema;
mod strict;
mod write;

use crate::imported::ImportedMesh;
use crate::node::NodeRef;
use crate::sketched::{Drawing, Template};
use mesh::MeshDistance;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

pub(crate) use check::measure;
pub use color::ColorError;
pub use error::{SceneError, SceneProblem, TextPosition};
pub use schema::scene_schema;
pub(crate) use write::Whole;

/// The newest version of the file format, and the one that is written.
pub const VERSION: u64 = 1;
/// Largest scene file, bytes.
pub const MAX_FILE_BYTES: usize = 64 << 20;
/// Most JSON objects in a scene file: nodes, and points of polylines and drawings.
pub const MAX_OBJECTS: usize = 250_000;
/// Most nodes in a scene, a shared one counted wherever it stands.
pub const MAX_NODES: u64 = 1_000_000;
/// Most nodes on the way from the root to a leaf, both included.
pub const MAX_DEPTH: usize = 256;

/// The names of all node types in scene files: primitives, operators, warps, and the support-free node.
pub const TYPE_NAMES: [&str; 30] = [
    "point",
    "segment",
    "polyline",
    "disc",
    "polygon",
    "box",
    "cylinder",
    "cone",
    "torus",
    "ellipsoid",
    "half_space",
    "mesh",
    "inflation",
    "sweep",
    "revolution",
    "path_sweep",
    "union",
    "intersection",
    "difference",
    "blend",
    "blend_intersection",
    "blend_difference",
    "sum",
    "gradient_blend",
    "transform",
    "affine",
    "taper",
    "twist",
    "bend",
    "support_free",
];

/// A tree with what a file keeps beside it. Cheap to clone: everything large is shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What the user calls it.
    pub title: Option<String>,
    /// Parts by name. A file writes each once, and whatever is the same allocation refers to it.
    pub definitions: Arc<BTreeMap<String, NodeRef>>,
    /// The tree.
    pub root: NodeRef,
}

impl Scene {
    /// An untitled scene. Legal if [`Self::check`] says so.
    pub fn new(root: impl Into<NodeRef>) -> Self {
        Self { title: None, definitions: Arc::default(), root: root.into() }
    }

    /// The same scene under this title.
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: Some(title.into()), ..self }
    }

    /// Reads the text of a scene file. Nodes that the file shares come back as one allocation.
    ///
    /// - **Promises:** what comes back passes [`Self::check`]; [`Self::to_text`] of it reads back equal.
    /// - **Cost:** linear in the text; at most [`MAX_FILE_BYTES`] and [`MAX_OBJECTS`] are looked at.
    /// - **Errors:** anything that is not a legal scene, with its line, column and node.
    pub fn from_bytes(bytes: &[u8], sources: &mut dyn SceneSources) -> Result<Self, SceneError> {
        read::scene(bytes, sources)
    }

    /// Reads a scene file to its end, but never more than [`MAX_FILE_BYTES`].
    ///
    /// Errors: as [`Self::from_bytes`], and what the reader says.
    pub fn read(input: impl Read, sources: &mut dyn SceneSources) -> Result<Self, SceneError> {
        let mut bytes = Vec::new();
        // One byte more than legal, so that a file which is too large is told from one that just fits.
        let mut input = input.take(MAX_FILE_BYTES as u64 + 1);
        input.read_to_end(&mut bytes).map_err(|e| SceneProblem::Unreadable(e.to_string()))?;
        Self::from_bytes(&bytes, sources)
    }

    /// The text of the scene's file: the same bytes for equal scenes that share alike.
    ///
    /// - **Promises:** [`Self::from_bytes`] reads it back equal, sharing included; writing that gives the same
    ///   text again. Shared nodes without a definition get one.
    /// - **Cost:** linear in the text; each shared node is written once.
    /// - **Errors:** what [`Self::check`] finds, and text that would be too large to be read again.
    pub fn to_text(&self) -> Result<String, SceneError> {
        self.check()?;
        let text = layout::lay_out(&write::compact(self));
        bounds::check(&text)?;
        Ok(text)
    }

    /// The same text on one line, without a line break, for journals.
    ///
    /// Promises, cost and errors: as [`Self::to_text`].
    pub fn to_line(&self) -> Result<String, SceneError> {
        self.check()?;
        let text = write::compact(self);
        bounds::check(&text)?;
        Ok(text)
    }

    /// Whether every number is in its legal range and the tree is neither too deep nor too large.
    ///
    /// Errors: the first node that is not, by its path. Cost: linear in the number of different nodes.
    pub fn check(&self) -> Result<(), SceneError> {
        check::scene(self)
    }
}

/// How a scene file names a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshReference {
    /// The mesh file's path, relative to the scene's folder.
    pub file: String,
    /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits.
    pub sha256: String,
    /// How far the influence reaches beyond the surface, mm. Default: 5.
    #[serde(default = "five")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: f32,
}

fn five() -> f32 {
    5.0
}

impl MeshReference {
    /// The way from a scene's folder to a mesh's file, as [`Self::file`] has it.
    ///
    /// Errors: a file or a folder that is not there.
    pub fn way(folder: &Path, file: &Path) -> io::Result<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let (folder, file) = (folder.canonicalize()?, file.canonicalize()?);
        let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
        let up = folder.components().skip(common).map(|_| "..".to_owned());
        let down = file.components().skip(common).map(|part| part.as_os_str().to_string_lossy().into_owned());
        Ok(up.chain(down).collect::<Vec<_>>().join("/"))
    }
}

impl From<&ImportedMesh> for MeshReference {
    fn from(mesh: &ImportedMesh) -> Self {
        Self { file: mesh.file.clone(), sha256: mesh.sha256.clone(), falloff: mesh.falloff }
    }
}

/// What scenes need from the rooms above to be read.
pub trait SceneSources {
    /// The mesh in the file that `reference` names. Asked once for each file and hash in a scene.
    ///
    /// Errors: why there is none, in words for the user: no such file, another hash, not a mesh.
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String>;

    /// The template of a legal drawing, right as far as `falloff` mm beyond the curve, or as far as the
    /// drawing is deep by the natural falloff. Asked once for equal drawings with equal falloffs in a scene.
    ///
    /// Errors: why there is none, in words for the user: no outline, too small.
    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String>;
}

/// For scenes without meshes and drawings: has none.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSources;

impl SceneSources for NoSources {
    fn mesh(&mut self, _: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        Err("mesh files are not read here".into())
    }

    fn template(&mut self, _: &Drawing, _: Option<f32>) -> Result<Arc<Template>, String> {
        Err("drawings are not read here".into())
    }
}

/// For scenes without meshes: their drawings are solved by this function.
#[derive(Clone, Copy, Debug)]
pub struct DrawingsBy<F>(pub F);

impl<F, E> SceneSources for DrawingsBy<F>
where
    F: FnMut(&Drawing, Option<f32>) -> Result<Arc<Template>, E>,
    E: Display,
{
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        NoSources.mesh(reference)
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        (self.0)(drawing, falloff).map_err(|reason| reason.to_string())
    }
}

#[cfg(test)]
mod tests;
