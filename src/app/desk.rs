//! The modeler's files: opened and written as the verbs of the command line do it.

use crate::cli::{ConstraintArgs, ResolutionArgs};
use crate::failure::Failure;
use crate::input::{self, Beside, Input, Prefer};
use crate::job::Job;
use crate::meshing;
use crate::output::{self, Report};
use crate::progress::Meter;
use crate::timings::Timings;
use blobtree::build::{Build as _, primitive, union};
use blobtree::{Primitive, Scene, SceneSources};
use modeler::desk::{Bake, Desk, Opened, Purpose};
use polygonizer::Cancel;
use printable::Rebaker;
use sketch::stroke::{self, DoodleChoice, Sketch};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};

/// The scenes of the gallery.
const EXAMPLES: [(&str, &str); 8] = [
    ("Snowman", include_str!("../../examples/snowman.trullo")),
    ("Dog's head", include_str!("../../examples/dog-head.trullo")),
    ("Chess pawn", include_str!("../../examples/chess-pawn.trullo")),
    ("Dice", include_str!("../../examples/dice.trullo")),
    ("Bracket", include_str!("../../examples/bracket.trullo")),
    ("Wrench", include_str!("../../examples/wrench.trullo")),
    ("Twisted vase", include_str!("../../examples/twisted-vase.trullo")),
    ("Two blobs at growing distance", include_str!("../../examples/two-blobs.trullo")),
];

/// How far the influence of a mesh reaches beyond its surface, mm, as the scene format has it.
const FALLOFF: f32 = 5.0;

/// Files on this computer.
#[derive(Debug, Default)]
pub struct Files {
    browsing: Option<Receiver<Option<PathBuf>>>,
}

/// Does work that a verb does, without telling how far it is.
fn work<T>(work: impl FnOnce(&mut Job) -> Result<T, Failure>) -> Result<T, String> {
    let (mut timings, meter, cancel) = (Timings::default(), Meter::new(false), Cancel::new());
    work(&mut Job::new(&mut timings, &meter, &cancel)).map_err(|failure| failure.to_string())
}

impl Desk for Files {
    fn open(&mut self, path: &Path) -> Result<Opened, String> {
        let is_drawing = path.extension().and_then(|e| e.to_str()).is_some_and(|extension| {
            ["svg", "json", "ndjson"].iter().any(|drawing| extension.eq_ignore_ascii_case(drawing))
        });
        if is_drawing {
            return drawing(path).map(Opened::Drawing).map_err(|failure| failure.to_string());
        }
        let mut report = Report::default();
        let input = work(|job| input::open(path, None, Prefer::Scene, job, &mut report))?;
        let loaded = match input {
            Input::Scene(scene) => return Ok(Opened::Scene(scene, report.notices)),
            Input::Mesh(loaded) => loaded,
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let mesh = input::imported_mesh(path, &loaded.mesh, Some(folder), FALLOFF);
        let mesh = mesh.map_err(|failure| failure.to_string())?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let scene = Scene::new(union([primitive(Primitive::Mesh(mesh)).named(&*name)]));
        Ok(Opened::Mesh(scene, free_name(folder, &name), report.notices))
    }

    fn sources<'a>(&'a mut self, file: Option<&'a Path>) -> Box<dyn SceneSources + 'a> {
        Box::new(Beside(file.unwrap_or(Path::new(""))))
    }

    fn export(&mut self, scene: &Scene, path: &Path, cell_mm: Option<f32>) -> Result<String, String> {
        let resolution = ResolutionArgs { cell: cell_mm.map(f64::from), cells: None };
        work(|job| {
            meshing::format_of_output(path)?;
            output::check_writable(path)?;
            let meshed = meshing::mesh_scene(path, scene, &resolution, ConstraintArgs::default(), job)?;
            let attachments = input::attachments(path, scene)?;
            meshing::write_mesh(path, path, &meshed.mesh, &attachments, job)?;
            let triangles = output::counted(meshed.mesh.triangles.len(), "triangle");
            Ok(format!("{}: {triangles}, cells of {} mm", path.display(), output::short(meshed.cell_mm)))
        })
    }

    fn browse(&mut self, purpose: Purpose, wake: Arc<dyn Fn() + Send + Sync>) -> bool {
        let (sender, receiver) = mpsc::channel();
        let dialog = match purpose {
            Purpose::Open => rfd::FileDialog::new().add_filter(
                "Scenes, meshes and drawings",
                &["trullo", "3mf", "stl", "obj", "ply", "svg", "json", "ndjson"],
            ),
            Purpose::Save => {
                rfd::FileDialog::new().add_filter("Scenes", &["trullo"]).set_file_name("model.trullo")
            }
            Purpose::Export => rfd::FileDialog::new()
                .add_filter("Meshes", &["3mf", "stl", "obj", "ply"])
                .set_file_name("model.3mf"),
        };
        self.browsing = Some(receiver);
        let browse = move || {
            let file = if purpose == Purpose::Open { dialog.pick_file() } else { dialog.save_file() };
            // Nobody waits any more if the modeler has ended.
            let _ = sender.send(file);
            wake();
        };
        std::thread::Builder::new().name("files".into()).spawn(browse).is_ok()
    }

    fn browsed(&mut self) -> Option<Option<PathBuf>> {
        let answer = self.browsing.as_ref()?.try_recv().ok()?;
        self.browsing = None;
        Some(answer)
    }

    fn bake(&self) -> Option<Bake> {
        Some(Box::new(|root, bakes, cancel| bakes.bake(root, &Rebaker::with_cancel(cancel)).is_ok()))
    }

    fn examples(&self) -> &[(&'static str, &'static str)] {
        &EXAMPLES
    }
}

/// The scene's file beside a mesh: none that is there already.
fn free_name(folder: &Path, name: &str) -> PathBuf {
    let numbered = (2..).map(|number| format!("{name} {number}.trullo"));
    let mut names = std::iter::once(format!("{name}.trullo")).chain(numbered).map(|name| folder.join(name));
    names.find(|file| !file.exists()).unwrap_or_else(|| folder.join(name))
}

/// The strokes of a drawing's file.
fn drawing(path: &Path) -> Result<Sketch, Failure> {
    let bytes = input::read_whole(path, stroke::MAX_FILE_BYTES)?;
    let format = stroke::detect(&bytes, Some(path)).map_err(|e| Failure::of(path, e))?;
    let strokes = stroke::read(&bytes, format, &DoodleChoice::default()).map_err(|e| Failure::of(path, e))?;
    Ok(Sketch::from_strokes(&strokes))
}
