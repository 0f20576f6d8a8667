//! `trullo support-free` as a user runs it.

mod common;

use common::{Folder, assert_failed, json_of};
use serde_json::Value;
use std::io::{Cursor, Read};

/// A box of 10 × 8 × 6 mm whose underside is at this height, mm.
fn a_box(bottom: f32) -> String {
    let middle = bottom + 3.0;
    format!(
        r#"{{"format": "trullo", "version": 1, "root":
            {{"type": "box", "center": [0, 0, {middle}], "size": [10, 8, 6]}}}}"#
    )
}

fn number(json: &Value, key: &str) -> f64 {
    json[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {json:#}"))
}

#[test]
fn drop_puts_the_lowest_point_of_a_scene_on_the_bed() {
    for bottom in [7.5, 0.0, -2.25] {
        let folder = Folder::with_scene("box.trullo", &a_box(bottom));
        let out = folder.trullo(&[
            "support-free",
            "box.trullo",
            "-o",
            "b.stl",
            "--drop",
            "--json",
            "--cell",
            "0.5",
        ]);
        assert_eq!(out.status.code(), Some(0), "{bottom}: {out:?}");
        let json = json_of(&out);
        assert!((number(&json, "dropped_mm") - f64::from(bottom)).abs() < 1e-3, "{json:#}");
        assert_eq!(json["cut_at_bed"], false);
        let volume = number(&json, "volume_mm3");
        assert!((volume - 480.0).abs() < 1.0, "{bottom}: {volume} mm³ are left of 480");
        // In a scene, the shape is moved below the rule, and can still be changed.
        let out = folder.trullo(&["support-free", "box.trullo", "-o", "b.trullo", "--drop"]);
        assert_eq!(out.status.code(), Some(0), "{bottom}: {out:?}");
        let scene: Value = serde_json::from_slice(&folder.read("b.trullo")).expect("a scene is JSON");
        assert_eq!(scene["root"]["type"], "support_free");
        let below = &scene["root"]["child"];
        let moved = below["translate"][2].as_f64().unwrap_or(0.0);
        assert!((moved + f64::from(bottom)).abs() < 1e-3, "{scene:#}");
        assert_eq!(below["type"], if bottom == 0.0 { "box" } else { "transform" });
        // Once on the bed, there is nothing to drop.
        let out = folder.trullo(&["support-free", "b.trullo", "-o", "c.trullo", "--drop", "--json"]);
        assert_eq!(number(&json_of(&out), "dropped_mm"), 0.0);
    }
}

#[test]
fn who_floats_above_the_bed_or_lies_below_it_is_told_of_drop() {
    for bottom in [7.5, -20.0] {
        let folder = Folder::with_scene("box.trullo", &a_box(bottom));
        let out = folder.trullo(&["support-free", "box.trullo", "-o", "b.stl", "--cell", "0.5"]);
        assert_failed(&out, "--drop puts its lowest point there");
        assert!(!folder.has("b.stl"));
    }
    let folder = Folder::with_scene("box.trullo", &a_box(-2.0));
    let out = folder.trullo(&["support-free", "box.trullo", "-o", "b.stl", "--cell", "0.5"]);
    let notes = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(notes.contains("cut there; --drop puts its lowest point on the bed"), "{notes}");
}

#[test]
fn a_shape_that_grows_is_cut_at_the_bed_only_if_it_reaches_below() {
    for (bottom, cut) in [(4.0, false), (0.0, false), (-2.0, true)] {
        let folder = Folder::with_scene("box.trullo", &a_box(bottom));
        let out = folder.trullo(&["support-free", "box.trullo", "-o", "b.trullo", "--operator", "grow"]);
        let notes = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(notes.contains("below the bed"), cut, "bottom at {bottom}: {notes}");
    }
}

/// A post of 4 mm with a bar of 24 mm on top, in a node of this mode.
fn a_letter_t(mode: &str) -> String {
    format!(
        r#"{{"format": "trullo", "version": 1, "root": {{"type": "support_free", "mode": "{mode}", "child":
        {{"type": "union", "children": [
            {{"type": "box", "center": [0, 0, 8], "size": [4, 4, 16]}},
            {{"type": "box", "center": [0, 0, 18], "size": [24, 4, 4]}}]}}}}}}"#
    )
}

/// How far outside a letter T a place is, mm; negative inside.
fn outside_t([x, y, z]: [f64; 3]) -> f64 {
    let outside_box = |middle: f64, half: [f64; 3]| {
        let beyond = [x.abs() - half[0], y.abs() - half[1], (z - middle).abs() - half[2]];
        let most = beyond.into_iter().fold(f64::MIN, f64::max);
        let squares: f64 = beyond.iter().map(|b| b.max(0.0).powi(2)).sum();
        if most > 0.0 { squares.sqrt() } else { most }
    };
    outside_box(8.0, [2.0, 2.0, 8.0]).min(outside_box(18.0, [12.0, 2.0, 2.0]))
}

/// The model of a 3MF file, as text.
fn model_of(file: Vec<u8>) -> String {
    let mut archive = zip::ZipArchive::new(Cursor::new(file)).expect("it is a zip file");
    let mut text = String::new();
    archive.by_name("3D/3dmodel.model").expect("the model").read_to_string(&mut text).expect("it is text");
    text
}

/// The numbers in an element's attributes.
fn numbers(element: &str) -> Vec<f64> {
    element.split('"').skip(1).step_by(2).map(|text| text.parse().expect("a number")).collect()
}

/// The middles of the triangles, each with what it is made of.
fn triangles_of(model: &str) -> Vec<([f64; 3], u32)> {
    let elements = |name: &str| {
        let start = format!("<{name} ");
        model.lines().filter(move |line| line.starts_with(&start)).map(numbers).collect::<Vec<_>>()
    };
    let vertices = elements("vertex");
    let triangle = |corners: Vec<f64>| {
        let middle = |a: usize| corners[..3].iter().map(|c| vertices[*c as usize][a]).sum::<f64>() / 3.0;
        ([middle(0), middle(1), middle(2)], corners.get(4).map_or(0, |number| *number as u32))
    };
    elements("triangle").into_iter().map(triangle).collect()
}

#[test]
fn what_has_grown_is_of_its_own_material_in_a_3mf_file_and_nothing_else_is() {
    let folder = Folder::with_scene("t.trullo", &a_letter_t("grow"));
    folder.write("off.trullo", a_letter_t("off"));
    for arguments in [
        &["mesh", "t.trullo", "-o", "t.3mf", "--certify"][..],
        &["support-free", "off.trullo", "-o", "t.3mf", "--operator", "grow"],
        &["mesh", "t.trullo", "-o", "t.3mf", "--simplify", "0.02"],
    ] {
        let out = folder.trullo(arguments);
        assert_eq!(out.status.code(), Some(0), "{out:?}");
        let model = model_of(folder.read("t.3mf"));
        let names: Vec<&str> =
            model.split("<base name=\"").skip(1).map(|rest| rest.split('"').next().unwrap_or("")).collect();
        assert_eq!(names, ["model", "grown"]);
        let triangles = triangles_of(&model);
        let mut grown = 0;
        for (middle, material) in &triangles {
            let [x, y, z] = *middle;
            let outside = outside_t(*middle);
            match material {
                1 => assert!(z < 16.0 && x.abs() > 2.0 && y.abs() < 2.0 && outside > 0.0, "{middle:?}"),
                _ => assert!(outside < 0.1, "{middle:?} is {outside} mm outside"),
            }
            grown += material;
        }
        assert!(grown as usize > triangles.len() / 5, "{grown} of {}", triangles.len());
        // It is read back as any other, and its certificate holds.
        let check = folder.trullo(&["check", "t.3mf", "--json"]);
        assert_eq!(check.status.code(), Some(0), "{check:?}");
        let certified = arguments.contains(&"--certify");
        assert_eq!(json_of(&check)["certificate"]["holds"] == true, certified, "{check:?}");
    }
}

#[test]
fn what_a_stroke_added_is_of_its_material_in_a_3mf_file() {
    let scene = r#"{"format": "trullo", "version": 1, "root": {"type": "support_free",
        "child": {"type": "box", "center": [0, 0, 5], "size": [20, 20, 10]}, "strokes": [
            {"brush": "add_trim", "radius": 2, "places": [[-6, 0, 10]]},
            {"brush": "add_trim", "radius": 2, "material": 3, "places": [[6, 0, 10]]}]}}"#;
    let folder = Folder::with_scene("s.trullo", scene);
    let out = folder.trullo(&["convert", "s.trullo", "s.3mf"]);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    let model = model_of(folder.read("s.3mf"));
    assert!(model.contains("<base name=\"material 3\"") && model.matches("<base ").count() == 2, "{out:?}");
    let mut count = 0;
    for ([x, y, z], material) in triangles_of(&model) {
        let above = (z - 10.0).max(0.0);
        match material {
            0 => assert!(above < 0.15 || x < 0.0, "{x} {y} {z}"),
            _ => assert!(above > 0.0 && (x - 6.0).hypot(y).hypot(above) < 2.05, "{x} {y} {z}"),
        }
        count += material;
    }
    assert!(count > 500, "{count}");
}

/// A box with strokes over it.
fn stroked(strokes: &str) -> String {
    format!(
        r#"{{"format": "trullo", "version": 1, "root": {{"type": "support_free", "strokes": [{strokes}],
            "child": {{"type": "box", "center": [0, 0, 6], "size": [12, 10, 12]}}}}}}"#
    )
}

#[test]
fn strokes_of_nonsense_are_refused_in_words() {
    let many = format!("{}[0, 0, 11]", "[0, 0, 11],".repeat(60_000));
    let dabs = format!(r#"{{"brush": "add_trim", "radius": 2, "places": [{many}]}}"#);
    for (strokes, told) in [
        (r#"{"brush": "add_trim", "radius": NaN, "places": [[0, 0, 1]]}"#, "not JSON"),
        (r#"{"brush": "add_trim", "radius": 1, "places": [[0, 1e999, 1]]}"#, "number out of range"),
        (r#"{"brush": "add_trim", "radius": 1, "places": [[1e30, 0, 1]]}"#, "not three coordinates"),
        (r#"{"brush": "add_trim", "radius": 1e9, "places": [[0, 0, 1]]}"#, "not 0.05 to 100 mm"),
        (r#"{"brush": "add_trim", "radius": 1, "places": []}"#, "not a list of 1 to"),
        (
            r#"{"brush": "remove_trim", "radius": 0.05, "spacing": 0.05, "places": [[-90000, 0, 5], [90000, 0, 5]]}"#,
            "not at most 100000",
        ),
        (&format!("{dabs}, {dabs}"), "not at most 100000"),
    ] {
        let folder = Folder::with_scene("s.trullo", &stroked(strokes));
        let out = folder.trullo(&["support-free", "s.trullo", "-o", "o.trullo"]);
        assert_eq!(out.status.code(), Some(2), "{told}: {out:?}");
        let words = String::from_utf8_lossy(&out.stderr);
        assert!(words.contains(told), "{told}: {words}");
    }
}

#[test]
fn strokes_that_hardly_touch_anything_are_ordinary() {
    for brush in ["add_trim", "remove_trim", "remove_preserve", "add_grow", "smooth_trim"] {
        let stroke = |rest: &str| format!(r#"{{"brush": "{brush}", {rest}}}"#);
        let strokes = [
            stroke(r#""radius": 2, "spacing": 0.05, "places": [[0, 0, 11], [0, 0, 11], [0, 0, 11]]"#),
            stroke(r#""radius": 0.05, "places": [[0, 0, 12], [6, 5, 12]]"#),
            stroke(r#""radius": 2, "strength": 0, "places": [[0, 0, 11]]"#),
            stroke(r#""radius": 3, "places": [[0, 0, -1], [0, 0, -50]]"#),
            stroke(r#""radius": 2, "tip": {"type": "union", "children": []}, "places": [[0, 0, 11]]"#),
            stroke(r#""radius": 20, "light_radius": 0.1, "pressures": [0], "places": [[0, 0, 12]]"#),
        ];
        let folder = Folder::with_scene("s.trullo", &stroked(&strokes.join(", ")));
        let out = folder.trullo(&["support-free", "s.trullo", "-o", "o.trullo"]);
        assert_eq!(out.status.code(), Some(0), "{brush}: {out:?}");
    }
}

#[test]
fn a_3mf_file_of_one_material_does_not_speak_of_materials() {
    let folder = Folder::with_scene("t.trullo", &a_letter_t("trim"));
    folder.write("grow.trullo", a_letter_t("grow"));
    for arguments in
        [&["mesh", "t.trullo", "-o", "t.3mf"][..], &["mesh", "grow.trullo", "-o", "t.3mf", "--no-constraint"]]
    {
        let out = folder.trullo(arguments);
        assert_eq!(out.status.code(), Some(0), "{out:?}");
        let model = model_of(folder.read("t.3mf"));
        assert!(!model.contains("basematerials") && !model.contains("pid="), "{arguments:?}");
    }
}

#[test]
fn why_tells_what_was_changed_at_a_place_in_words_and_in_json() {
    // In a node that is switched off.
    let scene = &a_letter_t("off");
    let folder = Folder::with_scene("t.trullo", scene);
    let arguments = ["support-free", "t.trullo", "-o", "out.trullo", "--why", "10,0,18", "--why", "0,0,-3"];
    let out = folder.trullo(&arguments);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let taken = "10,0,18: taken away: overhang: the surface below it, at 10,0,16, leans out by ";
    assert!(text.contains(taken) && text.contains("° from the vertical, more than 45°"), "{text}");
    assert!(text.contains("0,0,-3: nothing was changed here; empty, as drawn"), "{text}");
    let json = json_of(&folder.trullo(&[&arguments[..], &["--json"]].concat()));
    let answer = &json["why"][0];
    assert_eq!([&answer["drawn"], &answer["solid"]], [true, false], "{answer:#}");
    let change = &answer["changes"][0];
    assert_eq!([&change["node"], &change["change"], &change["cause"]], ["/", "taken", "overhang"]);
    assert!(number(change, "lean_degrees") > 85.0, "{change:#}");
    assert_eq!(json["why"][1]["changes"], Value::Array(Vec::new()));
    // What grows says for which place, also in a mesh.
    let json = json_of(&folder.trullo(&[
        "support-free",
        "t.trullo",
        "-o",
        "t.stl",
        "--operator",
        "grow",
        "--why",
        "6,0,15",
        "--json",
    ]));
    let change = &json["why"][0]["changes"][0];
    assert_eq!([&change["change"], &change["cause"]], ["added", "grown"], "{json:#}");
    let held = change["holds"][2].as_f64().expect("a place");
    assert!((16.0..16.3).contains(&held), "{change:#}");
}

#[test]
fn why_names_the_stroke_of_a_node_within_the_scene() {
    let scene = r#"{"format": "trullo", "version": 1, "root": {"type": "support_free",
        "child": {"type": "box", "center": [0, 0, 5], "size": [20, 20, 10]}, "strokes": [
            {"brush": "add_trim", "radius": 2, "places": [[-6, 0, 10]]},
            {"brush": "remove_trim", "radius": 2, "places": [[6, 0, 10]]}]}}"#;
    let folder = Folder::with_scene("s.trullo", scene);
    let out = folder.trullo(&["support-free", "s.trullo", "-o", "out.trullo", "--why", "6,0,9.5", "--json"]);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    let change = &json_of(&out)["why"][0]["changes"][0].clone();
    assert_eq!(change["told"], "stroke 2 (remove_trim) took it away", "{change:#}");
    assert_eq!([&change["node"], &change["brush"]], ["/0", "remove_trim"]);
    assert_eq!(change["stroke"], 2);
}

#[test]
fn a_shape_that_is_all_brush_strokes_has_cells_as_high_as_a_layer() {
    let scene = r#"{"format": "trullo", "version": 1, "root": {
        "type": "support_free",
        "strokes": [{"brush": "add_trim", "radius": 3, "places": [[0, 0, 2]]}],
        "child": {"type": "union", "children": []}}}"#;
    let folder = Folder::with_scene("ball.trullo", scene);
    for verb in ["mesh", "support-free"] {
        let out = folder.trullo(&[verb, "ball.trullo", "-o", "ball.stl", "--json"]);
        assert_eq!(out.status.code(), Some(0), "{verb}: {out:?}");
        let json = json_of(&out);
        assert!((number(&json, "cell_mm") - 0.25).abs() < 1e-6, "{verb}: {json:#}");
        assert!(number(&json, "volume_mm3") > 50.0, "{verb}: {json:#}");
    }
}
