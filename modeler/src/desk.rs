//! What the modeler asks of the program around it: files.

use crate::errand::{Undone, Watch};
use blobtree::{BakeStore, NodeRef, Scene, SceneSources};
use polygonizer::Cancel;
use serde::{Deserialize, Serialize};
use sketch::stroke::Sketch;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Makes support-free nodes print without supports, for the view: fills the store for a tree; whether it could. It runs
/// in the background, and stops when it is cancelled.
pub type Bake = Box<dyn FnMut(&NodeRef, &mut BakeStore, &Cancel) -> bool + Send>;

/// What a file turned out to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Opened {
    /// A scene, to be worked on; with what was noticed.
    Scene(Scene, Vec<String>),
    /// A mesh as the only part of a scene that is in no file yet, and that names it from the mesh's folder; with what
    /// was noticed.
    Mesh(Scene, Vec<String>),
    /// A drawing: strokes in pixels.
    Drawing(Sketch),
}

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be opened: a scene, a mesh or a drawing.
    Open,
    /// To be added to what is there: a scene, a mesh or a drawing.
    Add,
    /// To be written: the scene.
    Save,
    /// To be written: the mesh.
    Export,
}

/// How a mesh is written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExportOptions {
    /// How wide a cell is, mm: details smaller than that can get lost. Without it, one that fits the shape.
    pub cell_mm: Option<f32>,
    /// How far the surface may move when triangles are left out, mm; 0 keeps all.
    pub tolerance_mm: f32,
    /// Whether STL is written as text.
    pub as_text: bool,
    /// Whether 3MF carries the scene along, so that it can be opened again and changed.
    pub carries_scene: bool,
}

impl ExportOptions {
    /// How wide cells may be, mm.
    pub const CELLS: RangeInclusive<f32> = 0.01..=10.0;

    /// How far a surface may move, mm.
    pub const TOLERANCES: RangeInclusive<f32> = 0.0..=1.0;
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { cell_mm: None, tolerance_mm: 0.0, as_text: false, carries_scene: true }
    }
}

/// Whoever opens and writes files. Long work is called on threads of its own, tells the [`Watch`] how far it is, and
/// stops when that is cancelled.
pub trait Desk: Send + Sync {
    /// Opens a scene, a mesh or a drawing.
    ///
    /// Errors: in words for the user, with the file and the place in it.
    fn open(&self, path: &Path, watch: &Watch) -> Result<Opened, Undone>;

    /// What scenes need to be read: meshes beside `file`, and the solver of drawings.
    fn sources<'a>(&'a self, file: Option<&'a Path>) -> Box<dyn SceneSources + 'a>;

    /// Writes the mesh of a scene, in the format that the name says; returns what was written, in words.
    ///
    /// Errors: in words for the user. Then nothing was written.
    fn export(
        &self,
        scene: &Scene,
        path: &Path,
        options: &ExportOptions,
        watch: &Watch,
    ) -> Result<String, Undone>;

    /// Lets the user choose a file in the system's own window, which begins in a folder, beside the running modeler;
    /// whether there is such a window. By default there is none.
    fn browse(&self, _purpose: Purpose, _folder: Option<&Path>, _wake: Arc<dyn Fn() + Send + Sync>) -> bool {
        false
    }

    /// The file that was chosen since the last look; `Some(None)` if none was.
    fn browsed(&self) -> Option<Option<PathBuf>> {
        None
    }

    /// What makes support-free nodes so in the view. By default they are shown as drawn.
    fn bake(&self) -> Option<Bake> {
        None
    }

    /// The scenes of the gallery: their titles and their texts.
    fn examples(&self) -> &'static [(&'static str, &'static str)];
}
