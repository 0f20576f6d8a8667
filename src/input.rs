//! Opening what the user names: scenes, meshes, and the meshes that scenes refer to.

use crate::failure::Failure;
use crate::job::{Job, Watch};
use crate::output::{self, Report};
use crate::stoppable::Stoppable;
use blobtree::{Drawing, ImportedMesh, MeshReference, Scene, SceneSources, Template};
use mesh::io::{Attachments, Format, Loaded, ReadLimits};
use mesh::{Mesh, MeshDistance};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::{Component, Path};
use std::sync::Arc;

/// Bytes looked at to tell what a file is.
const BEGINNING: u64 = 1024;

/// What a file holds.
#[derive(Debug)]
pub enum Input {
    /// A scene.
    Scene(Scene),
    /// A mesh, and what came with it.
    Mesh(Loaded),
}

/// What to take from a 3MF file that holds both a mesh and the scene it was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prefer {
    /// The scene, which can be edited.
    Scene,
    /// The mesh, which is what prints.
    Mesh,
}

/// Opens a scene or a mesh, and tells `report` what was noticed. Stage "read".
///
/// - **In:** `height` scales a mesh to this height, mm.
/// - **Errors:** whatever is neither, with the place; a height for a scene.
pub fn open(
    path: &Path,
    height: Option<f64>,
    prefer: Prefer,
    job: &mut Job,
    report: &mut Report,
) -> Result<Input, Failure> {
    let input = job.stage("read", |watch| read(path, prefer, watch))?;
    match input {
        Input::Scene(_) if height.is_some() => {
            Err(Failure::of(path, "a scene, which has its own size; --height scales meshes only"))
        }
        Input::Scene(scene) => Ok(Input::Scene(scene)),
        Input::Mesh(mut loaded) => {
            report.notices.extend(loaded.notices.iter().map(|n| format!("{}: {n}", path.display())));
            if let Some(height) = height {
                scale(path, &mut loaded.mesh, height)?;
            }
            Ok(Input::Mesh(loaded))
        }
    }
}

/// Opens a scene, also from a 3MF file that carries one. Stage "read".
///
/// Errors: as [`open`], and a mesh without a scene.
pub fn open_scene(path: &Path, job: &mut Job) -> Result<Scene, Failure> {
    match job.stage("read", |watch| read(path, Prefer::Scene, watch))? {
        Input::Scene(scene) => Ok(scene),
        Input::Mesh(loaded) => {
            let what = format!(
                "a mesh ({}), not a scene; `trullo convert`, `check` and `render` take meshes",
                loaded.format
            );
            Err(Failure::of(path, what))
        }
    }
}

fn read(path: &Path, prefer: Prefer, watch: &Watch) -> Result<Input, Failure> {
    let mut file = open_file(path).map_err(|what| Failure::of(path, what))?;
    let Some(format) = format_of(path, &mut file).map_err(|what| Failure::of(path, what))? else {
        return read_scene(path, file).map(Input::Scene);
    };
    let file = Stoppable::new(file, watch.cancel);
    let mut loaded =
        mesh::io::read(file, format, &ReadLimits::default()).map_err(|e| Failure::of(path, e))?;
    match &loaded.attachments.scene {
        Some(text) if prefer == Prefer::Scene => {
            let scene = Scene::from_bytes(text, &mut Beside(path))
                .map_err(|e| Failure::of(path, format!("the scene in this 3MF file: {e}")))?;
            Ok(Input::Scene(scene))
        }
        _ => {
            loaded.attachments.title = loaded.attachments.title.take().filter(|title| !title.is_empty());
            Ok(Input::Mesh(loaded))
        }
    }
}

fn read_scene(path: &Path, file: File) -> Result<Scene, Failure> {
    Scene::read(BufReader::new(file), &mut Beside(path)).map_err(|e| Failure::of(path, e))
}

/// The content of a file of at most `limit` bytes.
///
/// Errors: a file that cannot be read or is larger.
pub fn read_whole(path: &Path, limit: usize) -> Result<Vec<u8>, Failure> {
    let file = open_file(path).map_err(|what| Failure::of(path, what))?;
    let mut bytes = Vec::new();
    // One byte more than legal, so that a file which is too large is told from one that just fits.
    file.take(limit as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| Failure::of(path, format!("cannot be read: {}", output::told(&e))))?;
    if bytes.len() > limit {
        return Err(Failure::of(path, format!("larger than {} MiB, the most that is read", limit >> 20)));
    }
    Ok(bytes)
}

/// Opens an ordinary file: others, such as pipes, might never end.
fn open_file(path: &Path) -> Result<File, String> {
    let unreadable = |e: io::Error| format!("cannot be read: {}", output::told(&e));
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err("a folder, not a file; name a scene or a mesh in it".into());
    }
    if !metadata.is_file() {
        return Err("not an ordinary file; only those are read".into());
    }
    File::open(path).map_err(unreadable)
}

/// The format of a mesh, or none for a scene: what the content says, else the name.
fn format_of(path: &Path, file: &mut File) -> Result<Option<Format>, String> {
    let mut beginning = Vec::new();
    let length = file.metadata().and_then(|metadata| {
        file.by_ref().take(BEGINNING).read_to_end(&mut beginning)?;
        file.rewind()?;
        Ok(metadata.len())
    });
    let length = length.map_err(|e| format!("cannot be read: {}", output::told(&e)))?;
    let named_scene = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"));
    let looks_like_scene = beginning.trim_ascii_start().starts_with(b"{");
    match Format::sniff(&beginning, length).or_else(|| Format::from_path(path)) {
        _ if named_scene && looks_like_scene => Ok(None),
        Some(format) if !looks_like_scene => Ok(Some(format)),
        _ if named_scene || looks_like_scene => Ok(None),
        _ if beginning.is_empty() => Err("the file is empty".into()),
        _ => Err("neither a scene (.trullo) nor a mesh (.stl, .obj, .ply, .3mf)".into()),
    }
}

fn scale(path: &Path, mesh: &mut Mesh, height: f64) -> Result<(), Failure> {
    let scaled = mesh.fit_height(height).filter(|_| mesh.positions.iter().all(|p| p.is_finite()));
    scaled
        .map(drop)
        .ok_or_else(|| Failure::of(path, format!("flat, so it cannot be scaled to a height of {height} mm")))
}

/// Finds the meshes that a scene names, beside the scene's file, and solves its drawings.
pub struct Beside<'a>(pub &'a Path);

impl SceneSources for Beside<'_> {
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        let name = Path::new(&reference.file);
        if name.components().any(|part| matches!(part, Component::Prefix(_) | Component::RootDir)) {
            return Err("a scene names its meshes relative to its own folder".into());
        }
        let path = self.0.parent().unwrap_or(Path::new("")).join(name);
        let told = |what: String| format!("{}: {what}", path.display());
        let mut file = open_file(&path).map_err(told)?;
        let limits = ReadLimits::default();
        let found = sha256(&mut file, limits.max_bytes).map_err(|e| told(output::told(&e)))?;
        if found != reference.sha256 {
            return Err(told(format!("has changed: its SHA-256 is {found} now, not {}", reference.sha256)));
        }
        let format = format_of(&path, &mut file).map_err(told)?;
        let format = format.ok_or_else(|| told("a scene, where a mesh is needed".into()))?;
        let loaded = mesh::io::read(file, format, &limits).map_err(|e| told(e.to_string()))?;
        MeshDistance::new(&loaded.mesh).map(Arc::new).map_err(|e| told(e.to_string()))
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        sketch::solve(drawing, falloff).map_err(|reason| reason.to_string())
    }
}

/// The hash of a whole file, which is rewound; of its first `limit` bytes if it is longer.
fn sha256(file: &mut File, limit: u64) -> io::Result<String> {
    let mut hash = Sha256::new();
    let mut reader = BufReader::with_capacity(1 << 16, file.by_ref().take(limit));
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            break;
        }
        hash.update(bytes);
        let used = bytes.len();
        reader.consume(used);
    }
    file.rewind()?;
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// A mesh that was read from `path`, as a primitive of a scene whose file is in `folder`.
///
/// Errors: a mesh without triangles, a file that is gone, or none that can be named from the folder.
pub fn imported_mesh(
    path: &Path,
    mesh: &Mesh,
    folder: Option<&Path>,
    falloff: f32,
) -> Result<ImportedMesh, Failure> {
    let distance = MeshDistance::new(mesh).map(Arc::new).map_err(|e| Failure::of(path, e))?;
    let mut file = open_file(path).map_err(|what| Failure::of(path, what))?;
    let hash = sha256(&mut file, ReadLimits::default().max_bytes);
    let sha256 = hash.map_err(|e| Failure::of(path, output::told(&e)))?;
    let file = match folder {
        Some(folder) => MeshReference::way(folder, path).map_err(|e| Failure::of(path, output::told(&e)))?,
        None => path.display().to_string(),
    };
    Ok(ImportedMesh { file, sha256, falloff, distance })
}

/// What a 3MF file made from `scene` carries beside the mesh.
///
/// Errors: a scene that cannot be written, which none that was read is.
pub fn attachments(path: &Path, scene: &Scene) -> Result<Attachments, Failure> {
    let text = scene.to_text().map_err(|e| Failure::of(path, e))?;
    Ok(Attachments { title: scene.title.clone(), scene: Some(text.into_bytes()), ..Attachments::default() })
}
