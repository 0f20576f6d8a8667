//! Drawings by thousands of people become closed meshes, or there is a reason why not.

use crate::shared;
use blobtree::{Node, Primitive, Shape, SketchPlane, Tree};
use mesh::{Mesh, SelfIntersections};
use polygonizer::{CellSize, Options, Surface};
use sketch::curve::NoOutline;
use sketch::solid::Outline;
use sketch::stroke::{DoodleChoice, FileFormat, Placement, Sketch, Standing, read};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Larger side of a drawing, mm, and cells across the solid: what the command line does by default.
const SIZE: f32 = 60.0;
const CELLS: u32 = 128;

/// Every how manieth drawing is tried; all with `TRULLO_SWEEP=full`.
const SAMPLE: usize = 43;

/// Nothing may hang. The goal is a second of processor time; this bears a slow machine.
const PATIENCE: Duration = Duration::from_secs(4);

/// What became of a drawing.
struct Fate {
    name: String,
    result: Result<Option<String>, NoOutline>,
    took: Duration,
}

/// The files of drawings, by name.
pub fn files() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(shared("doodles")).expect("a readable folder");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "ndjson"))
        .collect();
    files.sort();
    files
}

/// The mesh of a drawing that was blown up.
fn inflated(bytes: &[u8], index: usize) -> Result<Mesh, NoOutline> {
    let strokes = read(bytes, FileFormat::Doodles, &DoodleChoice::Index(index)).expect("a sound file");
    let sketch = Sketch::from_strokes(&strokes);
    let drawing = Arc::new(Placement::of_size(&sketch, SIZE, Standing::OnGround).drawing(&sketch));
    let template = sketch::solve(&drawing, None)?;
    let outline = Outline { drawing, plane: SketchPlane::default(), template };
    let node = Node::new(Shape::Primitive(Primitive::Inflation(outline.inflation())));
    let cell = CellSize::across(SIZE, CELLS).expect("an ordinary size");
    let surface = Surface::build(&Tree::new(&node), cell, &Options::default());
    Ok(surface.expect("an ordinary shape").mesh())
}

/// What keeps a mesh from being the boundary of a solid.
fn fault(mesh: &Mesh) -> Option<String> {
    if mesh.triangles.is_empty() {
        return Some("no triangles".into());
    }
    let is_sound = mesh.is_closed_manifold() && mesh.volume() > 0.0;
    (!is_sound).then(|| format!("{:?}", mesh.validity(SelfIntersections::Skip)))
}

/// What this thread has had of a processor, which other work on the machine does not lengthen.
fn processor_time() -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux tells");
    let nanoseconds = text.split_whitespace().next().and_then(|first| first.parse().ok());
    Duration::from_nanos(nanoseconds.expect("the first number is the time on a processor"))
}

fn fate(name: String, bytes: &[u8], index: usize) -> Fate {
    let start = processor_time();
    let result = inflated(bytes, index).map(|mesh| fault(&mesh));
    Fate { name, result, took: processor_time() - start }
}

#[test]
fn doodles_become_closed_meshes_or_say_why_not() {
    let step = if std::env::var("TRULLO_SWEEP").is_ok_and(|sweep| sweep == "full") { 1 } else { SAMPLE };
    let drawings: Vec<(String, Arc<Vec<u8>>, usize)> = files()
        .into_iter()
        .flat_map(|path| {
            let bytes = Arc::new(std::fs::read(&path).expect("a readable file"));
            let count = bytes.split(|b| *b == b'\n').filter(|line| !line.is_empty()).count();
            let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            (0..count).map(move |i| (format!("{name} {}", i + 1), bytes.clone(), i))
        })
        .step_by(step)
        .collect();
    assert!(drawings.len() * step > 4000, "only {} drawings", drawings.len());
    // One thread for each drawing, so that times are those of one core.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let alone = |drawings: &[(String, Arc<Vec<u8>>, usize)]| -> Vec<Fate> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        pool.install(|| drawings.iter().map(|(name, bytes, i)| fate(name.clone(), bytes, *i)).collect())
    };
    let mut fates: Vec<Fate> = std::thread::scope(|scope| {
        let shares = drawings.chunks(drawings.len().div_ceil(cores));
        let workers: Vec<_> = shares.map(|share| scope.spawn(move || alone(share))).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("no drawing panics")).collect()
    });
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    for reason in fates.iter().filter_map(|fate| fate.result.as_ref().err()) {
        let words: String = reason.to_string().chars().take_while(|c| !c.is_ascii_digit()).collect();
        *reasons.entry(words).or_default() += 1;
    }
    let outlines = fates.iter().filter(|fate| fate.result.is_ok()).count();
    let bad: Vec<String> = fates
        .iter()
        .filter_map(|fate| Some(format!("{}: {}", fate.name, fate.result.as_ref().ok()?.as_ref()?)))
        .collect();
    fates.sort_by_key(|fate| fate.took);
    let (median, worst) = (&fates[fates.len() / 2], fates.last().expect("some drawings"));
    println!(
        "{outlines} of {} drawings have an outline; {} of their meshes are unsound",
        fates.len(),
        bad.len()
    );
    println!("without an outline: {reasons:#?}");
    println!("median {:?}, worst {:?} ({})", median.took, worst.took, worst.name);
    assert!(bad.len() * 20 <= outlines, "{bad:#?}");
    assert!(outlines * 10 >= fates.len() * 9, "{reasons:#?}");
    assert!(worst.took < PATIENCE, "{} took {:?}", worst.name, worst.took);
}
