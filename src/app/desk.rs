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
use mesh::io::Format;
use modeler::desk::{Bake, Desk, ExportOptions, Opened, Purpose};
use modeler::errand::{Undone, Watch};
use printable::Rebaker;
use sketch::stroke::{self, DoodleChoice, Sketch};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex, PoisonError};

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
    browsing: Mutex<Option<Receiver<Option<PathBuf>>>>,
}

/// Does work that a verb does, and tells `watch` how far it is.
fn work<T>(watch: &Watch, work: impl FnOnce(&mut Job) -> Result<T, Failure>) -> Result<T, Undone> {
    let (mut timings, cancel, told) = (Timings::default(), watch.cancel.clone(), watch.clone());
    let meter = Meter::telling(move |stage, share| told.report(in_words(stage), share));
    work(&mut Job::new(&mut timings, &meter, &cancel)).map_err(undone)
}

fn undone(failure: Failure) -> Undone {
    match failure {
        Failure::Interrupted => Undone::Stopped,
        Failure::Input(what) => Undone::Failed(what),
    }
}

/// What a stage does, for somebody who waits for it.
fn in_words(stage: &str) -> &str {
    match stage {
        "read" => "reading",
        "compile" | "size" => "measuring",
        "constrain" => "making it support-free",
        "mesh" => "making the mesh",
        "simplify" => "leaving out triangles",
        "materials" => "telling materials apart",
        "verify" => "checking it",
        "encode" | "write" => "writing",
        other => other,
    }
}

impl Desk for Files {
    fn open(&self, path: &Path, watch: &Watch) -> Result<Opened, Undone> {
        let is_drawing = path.extension().and_then(|e| e.to_str()).is_some_and(|extension| {
            ["svg", "json", "ndjson"].iter().any(|drawing| extension.eq_ignore_ascii_case(drawing))
        });
        if is_drawing {
            return drawing(path).map(Opened::Drawing).map_err(undone);
        }
        work(watch, |job| {
            let mut report = Report::default();
            let loaded = match input::open(path, None, Prefer::Scene, job, &mut report)? {
                Input::Scene(scene) => return Ok(Opened::Scene(scene, report.notices)),
                Input::Mesh(loaded) => loaded,
            };
            let folder = path.parent().unwrap_or(Path::new(""));
            let mesh =
                job.stage("measure", |_| input::imported_mesh(path, &loaded.mesh, Some(folder), FALLOFF))?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let scene = Scene::new(union([primitive(Primitive::Mesh(mesh)).named(name)]));
            Ok(Opened::Mesh(scene, report.notices))
        })
    }

    fn sources<'a>(&'a self, file: Option<&'a Path>) -> Box<dyn SceneSources + 'a> {
        Box::new(Beside(file.unwrap_or(Path::new(""))))
    }

    fn export(
        &self,
        scene: &Scene,
        path: &Path,
        options: &ExportOptions,
        watch: &Watch,
    ) -> Result<String, Undone> {
        let cell = options.cell_mm.map(f64::from);
        let resolution = ResolutionArgs { cell, cells: None };
        work(watch, |job| {
            let format = meshing::format_of_output(path)?;
            output::check_writable(path)?;
            let mut meshed = meshing::mesh_scene(path, scene, &resolution, ConstraintArgs::default(), job)?;
            if options.tolerance_mm > 0.0 {
                let tolerance = f64::from(options.tolerance_mm);
                meshed.mesh = meshing::simplified(&meshed.mesh, tolerance, job)?;
            }
            let mut attachments = input::attachments(path, scene)?;
            if !options.carries_scene {
                attachments.scene = None;
            }
            let as_text = options.as_text && format == Format::Stl;
            let format = if as_text { Format::StlAscii } else { format };
            let moved = f64::from(options.tolerance_mm);
            attachments.materials = meshed.materials(&scene.root, format, moved, job)?;
            meshing::write_mesh_as(path, path, &meshed.mesh, format, &attachments, job)?;
            let triangles = output::counted(meshed.mesh.triangles.len(), "triangle");
            Ok(format!(
                "Exported {}: {triangles}, cells of {} mm",
                path.display(),
                output::short(meshed.cell_mm)
            ))
        })
    }

    fn browse(&self, purpose: Purpose, folder: Option<&Path>, wake: Arc<dyn Fn() + Send + Sync>) -> bool {
        let (sender, receiver) = mpsc::channel();
        let dialog = match purpose {
            Purpose::Open | Purpose::Add => rfd::FileDialog::new().add_filter(
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
        let dialog = match folder {
            Some(folder) => dialog.set_directory(folder),
            None => dialog,
        };
        *self.browsing.lock().unwrap_or_else(PoisonError::into_inner) = Some(receiver);
        let browse = move || {
            let picks = matches!(purpose, Purpose::Open | Purpose::Add);
            let file = if picks { dialog.pick_file() } else { dialog.save_file() };
            // Nobody waits any more if the modeler has ended.
            let _ = sender.send(file);
            wake();
        };
        std::thread::Builder::new().name("files".into()).spawn(browse).is_ok()
    }

    fn browsed(&self) -> Option<Option<PathBuf>> {
        let mut browsing = self.browsing.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = browsing.as_ref()?.try_recv().ok()?;
        *browsing = None;
        Some(answer)
    }

    fn bake(&self) -> Option<Bake> {
        Some(Box::new(|root, bakes, cancel| bakes.bake(root, &Rebaker::with_cancel(cancel)).is_ok()))
    }

    fn examples(&self) -> &'static [(&'static str, &'static str)] {
        &EXAMPLES
    }
}

/// The strokes of a drawing's file.
fn drawing(path: &Path) -> Result<Sketch, Failure> {
    let bytes = input::read_whole(path, stroke::MAX_FILE_BYTES)?;
    let format = stroke::detect(&bytes, Some(path)).map_err(|e| Failure::of(path, e))?;
    let strokes = stroke::read(&bytes, format, &DoodleChoice::default()).map_err(|e| Failure::of(path, e))?;
    Ok(Sketch::from_strokes(&strokes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn a_press_of_stop_is_heard_at_any_moment_of_an_export() {
        let (_, text) = EXAMPLES[6];
        let vase = Scene::from_bytes(text.as_bytes(), &mut Beside(Path::new(""))).expect("legal");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("vase.3mf");
        let options = ExportOptions { cell_mm: Some(0.3), ..ExportOptions::default() };
        let export = |watch: &Watch| Files::default().export(&vase, &path, &options, watch);
        let start = Instant::now();
        export(&Watch::default()).expect("there is room");
        let whole = start.elapsed();
        std::fs::remove_file(&path).expect("it was written");
        for share in [0.1, 0.4, 0.6, 0.75, 0.9] {
            let (watch, stopped) = (Watch::default(), Mutex::new(None::<Instant>));
            let result = std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(whole.mul_f64(share));
                    *stopped.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
                    watch.cancel.cancel();
                });
                let result = export(&watch);
                // It may have been quicker this time, and be done before it was to stop.
                let stopped = *stopped.lock().unwrap_or_else(PoisonError::into_inner);
                let deaf = stopped.map_or(Duration::ZERO, |stopped| stopped.elapsed());
                assert!(deaf < Duration::from_millis(500), "not heard for {deaf:?} at {share}");
                result
            });
            if result.is_err() {
                assert_eq!((result, path.exists()), (Err(Undone::Stopped), false), "at {share}");
            }
            let _ = std::fs::remove_file(&path);
        }
    }
}
