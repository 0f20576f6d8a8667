//! What the modeler asks of the program around it: files.

use blobtree::{BakeStore, NodeRef, Scene, SceneSources};
use polygonizer::Cancel;
use sketch::stroke::Sketch;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Makes support-free nodes print without supports, for the view: fills the store for a tree; whether it could. It runs
/// in the background, and stops when it is cancelled.
pub type Bake = Box<dyn FnMut(&NodeRef, &mut BakeStore, &Cancel) -> bool + Send>;

/// What a file turned out to be.
#[derive(Debug)]
pub enum Opened {
    /// A scene, to be worked on; with what was noticed.
    Scene(Scene, Vec<String>),
    /// A mesh as the only part of a scene that is in no file yet: the scene, the file beside the mesh that it may be
    /// saved as, and what was noticed.
    Mesh(Scene, PathBuf, Vec<String>),
    /// A drawing: strokes in pixels.
    Drawing(Sketch),
}

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be opened: a scene, a mesh or a drawing.
    Open,
    /// To be written: the scene.
    Save,
    /// To be written: the mesh.
    Export,
}

/// Whoever opens and writes files.
pub trait Desk {
    /// Opens a scene, a mesh or a drawing.
    ///
    /// Errors: in words for the user, with the file and the place in it.
    fn open(&mut self, path: &Path) -> Result<Opened, String>;

    /// What scenes need to be read: meshes beside `file`, and the solver of drawings.
    fn sources<'a>(&'a mut self, file: Option<&'a Path>) -> Box<dyn SceneSources + 'a>;

    /// Writes the mesh of a scene, in cells of this size or one that fits the shape; returns what was written, in words.
    ///
    /// Errors: in words for the user. Then nothing was written.
    fn export(&mut self, scene: &Scene, path: &Path, cell_mm: Option<f32>) -> Result<String, String>;

    /// Lets the user choose a file in the system's own window, beside the running modeler; whether there is such a
    /// window.
    fn browse(&mut self, purpose: Purpose, wake: Arc<dyn Fn() + Send + Sync>) -> bool;

    /// The file that was chosen since the last look; `Some(None)` if none was.
    fn browsed(&mut self) -> Option<Option<PathBuf>>;

    /// What makes support-free nodes so in the view. By default they are shown as drawn.
    fn bake(&self) -> Option<Bake> {
        None
    }

    /// The scenes of the gallery: their titles and their texts.
    fn examples(&self) -> &[(&'static str, &'static str)];
}
