//! `trullo check` and `trullo slice`: findings in words and numbers, certificates, layers as files.

mod common;

use common::{Folder, SNOWMAN, assert_failed, json_of, text_of};

/// A table: a leg of 6 × 6 × 10 mm and a top of 20 × 20 × 2 mm.
const TABLE: &str = r#"{"format": "trullo", "version": 1, "root": {"type": "union", "children": [
    {"type": "box", "center": [0, 0, 5], "size": [6, 6, 10]},
    {"type": "box", "center": [0, 0, 11], "size": [20, 20, 2]}
]}}"#;

/// A post, with no face where cells of half a millimetre meet.
const POST: &str = r#"{"format": "trullo", "version": 1, "root":
    {"type": "box", "center": [0.1, 0.2, 6.2], "size": [10, 10, 12]}}"#;

#[test]
fn what_hangs_is_told_with_its_layer_and_place() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let out = folder.trullo(&["check", "table.trullo", "--cell", "0.5"]);
    assert_eq!(out.status.code(), Some(1));
    let said = text_of(&out.stdout);
    assert!(said.contains("problem         layer 40, z = 10.1"), "{said}");
    assert!(
        said.contains(" mm² hangs in the air, up to ") && said.contains("not without supports"),
        "{said}"
    );

    let out = json_of(&folder.trullo(&["check", "table.trullo", "--cell", "0.5", "--json"]));
    assert_eq!([&out["solid"], &out["ok"], &out["print"]["support_free"]], [true, false, false]);
    let held = 36.0 + 24.0 * 0.26 + std::f64::consts::PI * 0.26 * 0.26;
    let unsupported = out["print"]["unsupported_mm2"].as_f64().expect("a number");
    assert!((unsupported - (400.0 - held)).abs() < 1.0, "{unsupported}");
    let finding = &out["print"]["findings"][0];
    assert_eq!(finding["kind"], "hangs");
    assert_eq!(finding["layer"], 40);
    assert_eq!(out["print"]["layers"][0]["layer"], 40);
}

#[test]
fn layer_height_and_overhang_are_the_users() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let area = |more: &[&str]| {
        let out = folder.trullo(&[&["check", "table.trullo", "--cell", "0.5", "--json"], more].concat());
        json_of(&out)["print"]["unsupported_mm2"].as_f64().expect("a number")
    };
    let held = |reach: f64| 36.0 + 24.0 * reach + std::f64::consts::PI * reach * reach;
    let reach = 60f64.to_radians().tan() + 0.01;
    assert!((area(&["--layer-height", "1", "--max-overhang", "60"]) - (400.0 - held(reach))).abs() < 1.0);
    let out = folder.trullo(&["check", "table.trullo", "--max-overhang", "80"]);
    assert!(text_of(&out.stderr).contains("not 20° to 70°; 45° suits most printers"));
    let out = folder.trullo(&["check", "table.trullo", "--layer-height", "9"]);
    assert!(text_of(&out.stderr).contains("not 0.02 to 2 mm; 0.2 mm suits most printers"));
}

#[test]
fn a_certificate_holds_for_its_file_and_for_no_other() {
    let folder = Folder::with_scene("post.trullo", POST);
    let mesh =
        ["mesh", "post.trullo", "-o", "post.3mf", "--cell", "0.5", "--certify", "--max-overhang", "50"];
    let out = folder.trullo(&[&mesh[..], &["--json"]].concat());
    assert_eq!(out.status.code(), Some(0), "{}", text_of(&out.stderr));
    assert_eq!(json_of(&out)["certified"], true);
    let out = folder.trullo(&["check", "post.3mf"]);
    let said = text_of(&out.stdout);
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("certificate     holds") && said.contains("overhangs to 50°"), "{said}");
    // Another rule does not change what the certificate is asked.
    let out = json_of(&folder.trullo(&["check", "post.3mf", "--layer-height", "0.4", "--json"]));
    assert_eq!(out["certificate"]["holds"], true);
    assert_eq!(out["print"]["layer_height_mm"], 0.4);

    // The same certificate on a part of another size.
    assert_eq!(folder.trullo(&["convert", "post.3mf", "tall.3mf", "--height", "14"]).status.code(), Some(0));
    let out = folder.trullo(&["check", "tall.3mf"]);
    let said = text_of(&out.stdout);
    assert_eq!(out.status.code(), Some(1), "{said}");
    assert!(
        said.contains("the certificate does not hold: it speaks of 48 layers, the part has 56"),
        "{said}"
    );
}

#[test]
fn what_needs_supports_gets_no_certificate_and_other_formats_cannot_carry_one() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let out =
        folder.trullo(&["mesh", "table.trullo", "-o", "table.3mf", "--cell", "0.5", "--certify", "--json"]);
    assert_eq!(out.status.code(), Some(1));
    assert_eq!(json_of(&out)["certified"], false);
    assert!(folder.has("table.3mf"));
    assert_eq!(json_of(&folder.trullo(&["check", "table.3mf", "--json"])).get("certificate"), None);
    let out = folder.trullo(&["mesh", "table.trullo", "-o", "table.stl", "--certify"]);
    assert_failed(&out, "only .3mf files carry certificates");
    assert!(!folder.has("table.stl"));
}

#[test]
fn overhangs_are_drawn_in_colour() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let out = folder.trullo(&["check", "table.trullo", "--cell", "0.5", "--picture", "table.png"]);
    assert_eq!(out.status.code(), Some(1), "{}", text_of(&out.stderr));
    let decoder = png::Decoder::new(std::io::Cursor::new(folder.read("table.png")));
    let mut reader = decoder.read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("fits")];
    reader.next_frame(&mut pixels).expect("a picture");
    let red = pixels.chunks_exact(3).filter(|p| p[0] > 90 && p[2] < p[0] / 3).count();
    assert!(red > 20_000, "{red} pixels show that the top hangs");
    assert_failed(&folder.trullo(&["check", "table.trullo", "--picture", "table.jpg"]), "must end in .png");
}

#[test]
fn layers_become_one_svg_file_with_a_group_for_each() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let slice =
        ["slice", "table.trullo", "-o", "table.svg", "--cell", "0.5", "--layer-height", "1", "--json"];
    let out = folder.trullo(&slice);
    assert_eq!(out.status.code(), Some(0), "{}", text_of(&out.stderr));
    let report = json_of(&out);
    let areas: Vec<f64> =
        report["layers"].as_array().expect("a list").iter().filter_map(|l| l["area_mm2"].as_f64()).collect();
    assert_eq!(areas.len(), 12);
    let expected = |layer: usize| if layer < 10 { 36.0 } else { 400.0 };
    assert!(
        areas.iter().enumerate().all(|(k, area)| (area - expected(k)).abs() < 0.005 * expected(k)),
        "{areas:?}"
    );
    let svg = text_of(&folder.read("table.svg"));
    assert_eq!(svg.matches("<g id=\"layer-").count(), 12);
    assert!(svg.contains("data-z=\"11.5000\"") && svg.ends_with("</svg>\n"), "{svg}");
    let first = folder.read("table.svg");
    folder.trullo(&[&slice[..], &["--threads", "1"]].concat());
    assert!(first == folder.read("table.svg"), "the number of threads changes no byte");
}

#[test]
fn layers_become_a_new_folder_of_pictures() {
    let folder = Folder::with_scene("table.trullo", TABLE);
    let slice =
        ["slice", "table.trullo", "-o", "layers", "--cell", "0.5", "--layer-height", "1", "--as", "png"];
    assert_eq!(folder.trullo(&slice).status.code(), Some(0));
    for (layer, area) in [("layers/layer-00000.png", 36.0), ("layers/layer-00011.png", 400.0)] {
        let decoder = png::Decoder::new(std::io::Cursor::new(folder.read(layer)));
        let mut reader = decoder.read_info().expect("a picture");
        let mut pixels = vec![0; reader.output_buffer_size().expect("fits")];
        reader.next_frame(&mut pixels).expect("a picture");
        let white: f64 = pixels.iter().map(|&p| f64::from(p) / 255.0).sum();
        assert!((white * 0.01 - area).abs() < 0.02 * area, "{layer}: {}", white * 0.01);
    }
    assert_failed(&folder.trullo(&slice), "a folder with something in it");
    assert_eq!(folder.names(), ["layers", "table.trullo"]);
    let svg = ["slice", "table.trullo", "-o", "outlines", "--cell", "1", "--layer-height", "2"];
    assert_eq!(folder.trullo(&svg).status.code(), Some(0));
    assert!(folder.has("outlines/layer-00005.svg"));
}

#[test]
fn what_is_too_much_to_slice_is_refused_and_leaves_nothing() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    assert_eq!(folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "12"]).status.code(), Some(0));
    let far = ["slice", "s.stl", "-o", "out", "--height", "900000"];
    assert_failed(&folder.trullo(&far), "layers of 0.25 mm are more than 100000");
    let fine = ["slice", "s.stl", "-o", "out", "--as", "png", "--pixel", "0.001"];
    assert_failed(&folder.trullo(&fine), "take a --pixel of");
    let out = folder.trullo(&["check", "s.stl", "--height", "900000", "--json"]);
    assert_eq!(out.status.code(), Some(1));
    assert!(
        json_of(&out)["print"]["error"].as_str().is_some_and(|e| e.contains("unit")),
        "{}",
        text_of(&out.stdout)
    );
    assert_eq!(folder.names(), ["s.stl", "s.trullo"]);
}
