//! What drawings by many people are first offered to become.
//!
//! `cargo test -p sketch --features shared --test doodle_suggestions -- --nocapture`. Needs `../shared/doodles`.

use blobtree::{Node, NodeRef, Operator, Shape};
use glam::{Vec2, Vec3};
use sketch::Solver;
use sketch::stroke::{DoodleChoice, FileFormat, Sketch, read};
use sketch::suggest::{Icon, Projection, Request, View, suggest};
use std::collections::BTreeMap;
use std::path::Path;

/// Every how manieth drawing is judged.
const SAMPLE: usize = 43;

/// Every `SAMPLE`th of the drawings in the shared folder, with their names.
fn drawings() -> Vec<(String, Sketch)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/doodles");
    let entries = std::fs::read_dir(folder).expect("a readable folder");
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
    let sketch = |(name, line): (String, Vec<u8>)| {
        let strokes = read(&line, FileFormat::Doodles, &DoodleChoice::default()).expect("a doodle");
        (name, Sketch::from_strokes(&strokes))
    };
    lines.into_iter().step_by(SAMPLE).map(sketch).collect()
}

#[test]
fn doodles_on_an_empty_bed_are_offered_to_be_blown_up_before_all_else() {
    let root: NodeRef = Node::new(Shape::Operator(Operator::Union, Vec::new())).into();
    let projection = Projection::Orthographic { mm_per_px: 0.25 };
    let view = View::look_at(Vec3::new(0.0, -100.0, 0.0), Vec3::ZERO, Vec2::splat(256.0), projection);
    let mut first: BTreeMap<Option<Icon>, Vec<String>> = BTreeMap::new();
    for (name, sketch) in drawings() {
        let request = Request { sketch: &sketch, view, root: &root, selected: None, depth: None };
        let seen = suggest(&request, &Solver);
        assert_eq!(seen.suggestions.is_empty(), seen.no_outline.is_some(), "{name}");
        first.entry(seen.suggestions.first().map(|s| s.icon)).or_default().push(name);
    }
    let of = |icon: Option<Icon>| first.get(&icon).map_or(0, Vec::len);
    let outlines: usize = first.values().map(Vec::len).sum::<usize>() - of(None);
    let inflated = of(Some(Icon::Inflate));
    println!("{inflated} of {outlines} drawings with an outline are first offered to be blown up");
    assert!(outlines > 90 && inflated * 20 >= outlines * 19, "{inflated} of {outlines}: {first:#?}");
}
