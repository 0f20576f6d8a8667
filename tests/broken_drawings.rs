//! However odd a drawing is, `trullo sketch` ends soon, in little memory, with a solid or a reason.

#![cfg(target_os = "linux")]

mod common;

use common::{Folder, text_of};
use std::fmt::Write;

/// What a process may map, so that its peak in memory is less: 700 MB.
const MEMORY_KIB: u32 = 700_000_000 / 1024;
/// Processor time for one drawing; beyond it the system ends the program.
const CPU_SECONDS: u32 = 2;

/// What matrix products map besides, of which they only touch what they need: a space of twice the largest cache.
fn space_of_products_kib() -> u32 {
    let caches = (0..8).filter_map(|i| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{i}/size");
        std::fs::read_to_string(path).ok()?.trim().strip_suffix('K')?.parse::<u32>().ok()
    });
    2 * caches.max().unwrap_or(0)
}

/// One stroke through these places, as Trullo writes strokes.
fn strokes(places: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut samples = String::new();
    for (x, y) in places {
        let comma = if samples.is_empty() { "" } else { "," };
        write!(samples, "{comma}[{x},{y}]").expect("text");
    }
    format!(r#"{{"format":"trullo-strokes","version":1,"strokes":[{{"samples":[{samples}]}}]}}"#)
}

fn picture(body: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 600 600">{body}</svg>"#)
}

/// A circle of this many samples.
fn circle(count: u32) -> String {
    strokes((0..=count).map(|i| (f64::from(i) / f64::from(count) * std::f64::consts::TAU).sin_cos()))
}

/// Parts of which each is used twice by the next.
fn doubled(times: usize) -> String {
    let mut parts = String::from(r#"<path id="a0" d="M0 0h9v9z"/>"#);
    for i in 1..=times {
        let used = format!("<use href=\"#a{}\"/>", i - 1).repeat(2);
        write!(parts, "<g id=\"a{i}\">{used}</g>").expect("text");
    }
    picture(&format!("<defs>{parts}</defs><use href=\"#a{times}\"/>"))
}

/// Odd drawings by name, with the word that the program says of them; none where there is a solid.
fn drawings() -> Vec<(&'static str, String, Option<&'static str>)> {
    let scribble = (0..40_000).map(|i| f64::from(i) * 0.1);
    let scribble = scribble.map(|t| (300.0 + 290.0 * (t * 1.61).sin(), 300.0 + 290.0 * (t * 0.7).cos()));
    let squares: String =
        (0..3600).map(|i| format!("<path d=\"M{} {}h8v8h-8z\"/>", i % 60 * 10, i / 60 * 10)).collect();
    let arrows = format!(
        "<marker id=\"m\">{}</marker><polyline points=\"{}\" marker-mid=\"url(#m)\"/>",
        "<path d=\"M0 0h1v1z\"/>".repeat(200),
        (0..20_000).map(|i| format!("{},{} ", i % 97, i % 89)).collect::<String>(),
    );
    vec![
        ("nothing.json", strokes([]), Some("nothing is drawn")),
        ("dot.json", strokes([(5.0, 5.0)]), Some("dots")),
        ("two.json", strokes([(5.0, 5.0), (9.0, 5.0)]), Some("")),
        ("same.json", strokes([(5.0, 5.0); 1000]), Some("dots")),
        ("nan.json", circle(90).replacen("[0,1]", "[NaN,1]", 1), Some("nan.json")),
        ("infinite.json", circle(90).replacen("[0,1]", "[1e999,1]", 1), Some("infinite.json")),
        ("far.json", circle(90).replacen("[0,1]", "[1e38,1]", 1), None),
        ("bow-tie.json", strokes([(0., 0.), (90., 60.), (90., 0.), (0., 60.), (0., 0.)]), None),
        ("scribble.json", strokes(scribble), None),
        ("million.json", circle(1_000_000), None),
        ("squares.svg", picture(&squares), None),
        ("arrows.svg", picture(&arrows), None),
        ("doubled.svg", doubled(30), Some("reused parts")),
        ("cut.svg", picture("")[..40].to_owned(), Some("not XML")),
        ("cut.ndjson", r#"{"drawing":[[[0,1"#.into(), Some("cut.ndjson")),
    ]
}

#[test]
fn odd_drawings_become_solids_or_are_refused_with_a_reason_in_two_seconds() {
    let folder = Folder::new();
    let memory_kib = MEMORY_KIB + space_of_products_kib();
    for (name, text, expected) in drawings() {
        folder.write(name, text);
        let args = ["sketch", name, "-o", "out.trullo", "--as", "inflate", "--threads", "1"];
        let output = folder.limited(&args, memory_kib, CPU_SECONDS);
        let said = text_of(&output.stderr);
        let what = format!("{name}: {:?}, {said}", output.status);
        assert!(!said.contains("panicked"), "{what}");
        match expected {
            Some(words) => {
                assert_eq!(output.status.code(), Some(2), "{what}");
                assert!(said.starts_with("error: ") && said.contains(words), "{what}");
                assert!(!folder.has("out.trullo"), "{what}");
            }
            None => {
                assert_eq!(output.status.code(), Some(0), "{what}");
                std::fs::remove_file(folder.path("out.trullo")).expect("it was written");
            }
        }
    }
}
