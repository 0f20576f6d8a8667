//! Drawings by many people, from the shared folder.

use sketch::stroke::{DoodleChoice, FileFormat, Stroke, read};
use std::path::Path;

/// Every `step`th drawing, with the name of its file and its number there from 1, in the order of both.
pub fn every(step: usize) -> Vec<(String, Vec<Stroke>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/doodles");
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{} is needed: {error}", folder.display()));
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "ndjson"));
    files.sort();
    let mut lines = Vec::new();
    for path in files {
        let bytes = std::fs::read(&path).expect("a readable file");
        let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let own = bytes.split(|b| *b == b'\n').filter(|line| !line.is_empty()).enumerate();
        lines.extend(own.map(|(i, line)| (format!("{name} {}", i + 1), line.to_vec())));
    }
    let strokes = |line: &[u8]| read(line, FileFormat::Doodles, &DoodleChoice::default()).expect("a doodle");
    lines.into_iter().step_by(step).map(|(name, line)| (name, strokes(&line))).collect()
}
