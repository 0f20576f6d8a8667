//! Real drawings through the program, as a user runs it: sketch, mesh, check.

use crate::common::{Folder, json_of, text_of};
use crate::doodles;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Every how manieth drawing is tried.
const SAMPLE: usize = 107;

/// The solids that a drawing can become, in turn. A sweep along a path is the library's.
const KINDS: [&str; 3] = ["inflate", "revolve", "sweep"];

/// Seconds of processor time in which a drawing must have become a scene.
const SKETCH_SECONDS: u32 = 1;

/// The same for its mesh and its check: nothing may hang.
const OTHER_SECONDS: u32 = 20;

/// Memory that is plenty, KiB.
const MEMORY: u32 = 4 << 20;

/// All that may be said of a drawing without an outline.
const REASONS: [&str; 4] = ["nothing is drawn", "only dots", "does not close", "go there and back"];

/// Takes one drawing through the program.
///
/// Errors: why there is no outline; panics on anything else.
fn through(
    folder: &Folder,
    name: &str,
    drawings: &Path,
    line: usize,
    kind: &str,
) -> Result<(), &'static str> {
    let path = drawings.to_str().expect("a plain path");
    let [line, scene, mesh] = [line.to_string(), format!("{name}.trullo"), format!("{name}.3mf")];
    let args = ["sketch", path, "--doodle", &line, "--as", kind, "-o", &scene, "--threads", "1"];
    let out = folder.limited(&args, MEMORY, SKETCH_SECONDS);
    let said = text_of(&out.stderr);
    if out.status.code() == Some(2) {
        assert!(!folder.has(&scene), "{name}: a scene is written though it is refused");
        return Err(REASONS
            .into_iter()
            .find(|r| said.contains(r))
            .unwrap_or_else(|| panic!("{name}: {said}")));
    }
    assert_eq!(out.status.code(), Some(0), "{name} as {kind}, {SKETCH_SECONDS} s of processor time: {said}");
    let out = folder.limited(&["mesh", &scene, "-o", &mesh], MEMORY, OTHER_SECONDS);
    assert_eq!(out.status.code(), Some(0), "{name} as {kind}: {}", text_of(&out.stderr));
    let out = folder.limited(&["check", &mesh, "--json"], MEMORY, OTHER_SECONDS);
    let checked = json_of(&out);
    for sound in ["closed", "edge_manifold", "oriented"] {
        assert_eq!(checked[sound], true, "{name} as {kind} is not {sound}: {checked}");
    }
    assert!(checked["volume_mm3"].as_f64().is_some_and(|v| v > 0.0), "{name} as {kind}: {checked}");
    Ok(())
}

#[test]
fn drawings_go_through_sketch_mesh_and_check_or_are_refused_with_a_reason() {
    let lines = |path: PathBuf| {
        let text = std::fs::read(&path).expect("a readable file");
        let count = text.split(|b| *b == b'\n').filter(|line| !line.is_empty()).count();
        (1..=count).map(move |line| (path.clone(), line))
    };
    let sampled: Vec<(PathBuf, usize)> =
        doodles::files().into_iter().flat_map(lines).step_by(SAMPLE).collect();
    assert!(sampled.len() >= 40, "only {} drawings", sampled.len());
    let (folder, next) = (Folder::new(), AtomicUsize::new(0));
    let work = || {
        let mut refused: Vec<&str> = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some((path, line)) = sampled.get(i) else { return refused };
            let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
            let name = format!("{stem}-{line}");
            refused.extend(through(&folder, &name, path, *line, KINDS[i % KINDS.len()]).err());
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let refused: Vec<&str> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("every drawing passes")).collect()
    });
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    refused.iter().for_each(|reason| *reasons.entry(*reason).or_default() += 1);
    println!("{} drawings, refused: {reasons:?}", sampled.len());
    assert!(refused.len() * 10 <= sampled.len(), "{reasons:?}");
}
