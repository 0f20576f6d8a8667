//! `trullo sketch` as a user runs it: drawings in, scenes and meshes and previews out.

mod common;

use common::{Folder, assert_failed, json_of};
use std::f64::consts::PI;
use std::fmt::Write;

/// A circle with a hole half as wide.
const RING: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">
  <circle cx="50" cy="50" r="40" fill="none" stroke="black"/>
  <circle cx="50" cy="50" r="20" fill="none" stroke="black"/>
</svg>"#;

/// A bow that does not close.
const BOW: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">
  <path d="M 0 0 C 30 20 60 20 100 0" fill="none" stroke="black"/>
</svg>"#;

/// One stroke through these places, as Trullo writes strokes.
fn strokes(places: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut samples = String::new();
    for (x, y) in places {
        let comma = if samples.is_empty() { "" } else { "," };
        write!(samples, r#"{comma}{{"x":{x},"y":{y}}}"#).expect("text");
    }
    format!(r#"{{"format":"trullo-strokes","version":1,"strokes":[{{"samples":[{samples}]}}]}}"#)
}

/// A circle drawn with this many samples, pixels.
fn circle(samples: usize) -> String {
    strokes((0..=samples).map(|i| {
        let angle = 2.0 * PI * i as f64 / samples as f64;
        (300.0 + 200.0 * angle.cos(), 300.0 + 200.0 * angle.sin())
    }))
}

/// The volume of a mesh that `check` takes for a solid.
fn volume(folder: &Folder, mesh: &str) -> f64 {
    let checked = json_of(&folder.trullo(&["check", mesh, "--json"]));
    assert_eq!(checked["solid"], true, "{mesh}: {checked}");
    checked["volume_mm3"].as_f64().expect("a number")
}

#[track_caller]
fn assert_near(value: f64, expected: f64, share: f64) {
    assert!((value / expected - 1.0).abs() < share, "{value}, not {expected}");
}

#[test]
fn a_drawn_circle_becomes_a_ball_a_coin_and_a_ball_turned_round() {
    let folder = Folder::with_scene("circle.json", &circle(100));
    let ball = 4.0 / 3.0 * PI * 1000.0;
    for (kind, expected) in [("inflate", ball), ("revolve", ball), ("sweep", PI * 100.0 * 10.0)] {
        let out = folder.trullo(&["sketch", "circle.json", "-o", "c.trullo", "--as", kind, "--size", "20"]);
        assert_eq!(out.status.code(), Some(0), "{kind}: {}", String::from_utf8_lossy(&out.stderr));
        let out = folder.trullo(&["mesh", "c.trullo", "-o", "c.stl", "--cells", "64"]);
        assert_eq!(out.status.code(), Some(0), "{kind}: {}", String::from_utf8_lossy(&out.stderr));
        assert_near(volume(&folder, "c.stl"), expected, 0.01);
    }
}

#[test]
fn a_mesh_is_written_at_once_and_stages_are_timed() {
    let folder = Folder::with_scene("ring.svg", RING);
    let args = ["sketch", "ring.svg", "-o", "ring.3mf", "--as", "sweep", "--thickness", "6", "--size", "40"];
    let out = folder.trullo(&[&args[..], &["--cells", "64", "--json", "--timings"]].concat());
    let json = json_of(&out);
    assert_eq!(out.status.code(), Some(0), "{json}");
    assert_near(volume(&folder, "ring.3mf"), PI * (20.0 * 20.0 - 10.0 * 10.0) * 6.0, 0.01);
    assert_eq!(json["drawings"][0]["outlines"], 1);
    assert_eq!(json["drawings"][0]["holes"], 1);
    for stage in ["read_ms", "clean_ms", "curve_ms", "template_ms", "mesh_ms", "write_ms", "total_ms"] {
        assert!(json["timings"][stage].as_f64().is_some_and(|ms| ms >= 0.0), "{stage}: {json}");
    }
    let filled = folder.trullo(&[&args[..], &["--fill-holes", "--cells", "64"]].concat());
    assert_eq!(filled.status.code(), Some(0));
    assert_near(volume(&folder, "ring.3mf"), PI * 20.0 * 20.0 * 6.0, 0.01);
    let back = folder.trullo(&["convert", "ring.3mf", "ring.trullo"]);
    assert_eq!(
        back.status.code(),
        Some(0),
        "the strokes ride along: {}",
        String::from_utf8_lossy(&back.stderr)
    );
}

#[test]
fn several_drawings_stand_where_they_are_told_to() {
    let folder = Folder::with_scene("c.json", &circle(60));
    let args = ["sketch", "c.json", "c.json", "-o", "two.trullo", "--size", "10"];
    let out = folder.trullo(&[&args[..], &["--place", "-20,0,0", "--place", "20,5,0"]].concat());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let inside = |at: &str| {
        json_of(&folder.trullo(&["eval", "two.trullo", "--at", at, "--json"]))["points"][0]["inside"] == true
    };
    assert!(inside("-20,0,5") && inside("20,5,5") && !inside("0,0,5"));
    assert!(inside("-20,0,0.1") && !inside("-20,0,-0.1"), "drawings stand on their place");
    assert_failed(&folder.trullo(&[&args[..], &["--place", "0,0,0"]].concat()), "give one for each");
}

#[test]
fn a_line_that_does_not_close_becomes_a_tube_or_is_refused() {
    let folder = Folder::with_scene("bow.svg", BOW);
    let out = folder.trullo(&["sketch", "bow.svg", "-o", "bow.stl", "--cells", "64", "--json"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    assert_eq!(json_of(&out)["drawings"][0]["as"], "line");
    assert!(volume(&folder, "bow.stl") > 0.0);
    let refused = folder.trullo(&["sketch", "bow.svg", "-o", "bow.trullo", "--as", "inflate"]);
    assert_failed(&refused, "does not close");
    assert!(!folder.has("bow.trullo"), "nothing is written when there is no outline");
}

#[test]
fn a_preview_shows_strokes_and_curve() {
    let folder = Folder::with_scene("ring.svg", RING);
    let out = folder.trullo(&["sketch", "ring.svg", "--preview", "ring.png"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let png = folder.read("ring.png");
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut pixels).expect("pixels");
    let width = frame.width as usize;
    let row = &pixels[3 * width * (frame.height as usize / 2)..][..3 * width];
    let dark = row.chunks_exact(3).filter(|rgb| rgb.iter().all(|c| *c < 90)).count();
    assert!((4..=40).contains(&dark), "the middle row crosses four thin dark curves: {dark} dark pixels");
}

#[test]
fn drawings_that_are_broken_or_empty_are_refused_with_a_reason() {
    let folder = Folder::new();
    let cases: [(&str, &str, &str); 8] = [
        ("empty.svg", "", "empty"),
        ("none.svg", r#"<svg xmlns="http://www.w3.org/2000/svg"/>"#, ""),
        ("cut.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M 0", "cut.svg"),
        ("none.json", r#"{"format":"trullo-strokes","version":1,"strokes":[]}"#, "nothing is drawn"),
        ("new.json", r#"{"format":"trullo-strokes","version":7,"strokes":[]}"#, "version"),
        ("odd.json", r#"{"format":"trullo-strokes","version":1,"strokes":[],"colour":1}"#, "colour"),
        ("odd.ndjson", r#"{"drawing":[[[0,1],[0]]]}"#, "line 1"),
        ("notes.txt", "buy milk", "notes.txt"),
    ];
    for (name, text, expected) in cases {
        folder.write(name, text);
        let out = folder.trullo(&["sketch", name, "-o", "out.trullo", "--as", "inflate"]);
        assert_failed(&out, expected);
        assert!(!folder.has("out.trullo"), "{name}");
    }
    folder.write("dot.json", strokes([(5.0, 5.0)]));
    assert_failed(&folder.trullo(&["sketch", "dot.json", "-o", "out.trullo", "--as", "sweep"]), "dots");
    assert_failed(&folder.trullo(&["sketch", "dot.json", "-o", "out.txt"]), ".trullo");
}
