//! The program as a user runs it: what it prints, what it writes, how it ends.

mod common;

use common::{Folder, SNOWMAN, assert_failed, json_of};
use serde_json::Value;

#[test]
fn eval_tells_value_gradient_side_and_the_nodes_that_decide() {
    let folder = Folder::with_scene("ball.trullo", SNOWMAN);
    let out =
        folder.trullo(&["eval", "ball.trullo", "--at", "0,20,10", "--at", "-10,0,10", "--explain", "--json"]);
    assert_eq!(out.status.code(), Some(0));
    let points = json_of(&out)["points"].clone();
    assert_eq!(points[0]["inside"], false);
    let value = points[1]["value"].as_f64().expect("a number");
    assert!((value - 0.5).abs() < 1e-4, "a ball's surface is where its radius says: {value}");
    assert!(points[1]["gradient"][0].as_f64().expect("a number") > 0.0, "fields grow inwards");
    let nodes = points[1]["nodes"].as_array().expect("a list");
    let deciding = |n: &&Value| n["decides"] == true && n["type"] == "point";
    assert_eq!(nodes.iter().find(deciding).expect("one decides")["name"], "body");
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_modeler_says_what_to_do() {
    let folder = Folder::with_scene("ball.trullo", SNOWMAN);
    for arguments in [&[][..], &["ball.trullo"]] {
        let mut command = folder.command(arguments);
        for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(display);
        }
        let out = command.output().expect("it runs");
        assert_failed(&out, "run Trullo in a desktop session");
    }
}

#[test]
fn tree_lists_every_node_with_its_box() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let out = folder.trullo(&["tree", "s.trullo", "--json"]);
    let json = json_of(&out);
    let ids: Vec<&str> =
        json["nodes"].as_array().expect("a list").iter().filter_map(|n| n["id"].as_str()).collect();
    assert_eq!(ids, ["/", "/0", "/1"]);
    let low = json["nodes"][1]["box"]["min"][0].as_f64().expect("a number");
    assert!((-10.5..=-10.0).contains(&low), "the ball of 10 mm begins at {low}");
    let text = String::from_utf8(folder.trullo(&["tree", "s.trullo"]).stdout).expect("text");
    assert!(text.contains("/0 point \"body\""), "{text}");
}

#[test]
fn mesh_writes_a_ball_of_the_right_volume_in_every_format() {
    let ball = r#"{"format": "trullo", "version": 1, "root": {"type": "point", "center": [0, 0, 10], "radius": 10}}"#;
    let folder = Folder::with_scene("ball.trullo", ball);
    for format in ["stl", "obj", "ply", "3mf"] {
        let name = format!("ball.{format}");
        let out =
            folder.trullo(&["mesh", "ball.trullo", "-o", &name, "--cells", "64", "--json", "--timings"]);
        assert_eq!(out.status.code(), Some(0), "{format}");
        let json = json_of(&out);
        let volume = json["volume_mm3"].as_f64().expect("a number");
        assert!((volume / (4000.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3, "{format}: {volume}");
        for stage in ["read_ms", "mesh_ms", "write_ms", "total_ms"] {
            assert!(json["timings"][stage].as_f64().is_some_and(|ms| ms >= 0.0), "{format}: {stage}");
        }
        let checked = json_of(&folder.trullo(&["check", &name, "--json"]));
        assert_eq!([&checked["closed"], &checked["solid"]], [true, true], "{format}");
    }
}

#[test]
fn a_3mf_file_gives_the_scene_back_and_opens_as_one() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    assert_eq!(folder.trullo(&["mesh", "s.trullo", "-o", "s.3mf", "--cells", "24"]).status.code(), Some(0));
    assert_eq!(folder.trullo(&["convert", "s.3mf", "back.trullo"]).status.code(), Some(0));
    assert_eq!(folder.trullo(&["convert", "s.trullo", "same.trullo"]).status.code(), Some(0));
    assert_eq!(folder.read("back.trullo"), folder.read("same.trullo"));
    let value = |scene| folder.trullo(&["eval", scene, "--at", "1,2,3"]).stdout;
    assert_eq!(value("s.3mf"), value("s.trullo"));
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    for (verb, out) in [("mesh", "3mf"), ("render", "png")] {
        let size = if verb == "mesh" { ["--cells", "48"] } else { ["--size", "160x120"] };
        for threads in ["1", "2"] {
            let name = format!("{threads}.{out}");
            let all = [&[verb, "s.trullo", "-o", &name, "--threads", threads], &size[..]].concat();
            assert_eq!(folder.trullo(&all).status.code(), Some(0), "{verb}");
        }
        assert!(folder.read(&format!("1.{out}")) == folder.read(&format!("2.{out}")), "{verb} differs");
    }
}

#[test]
fn convert_scales_to_a_height_and_refuses_what_is_not_closed() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "24"]);
    let out = folder.trullo(&["convert", "s.stl", "s.obj", "--height", "50"]);
    assert_eq!(out.status.code(), Some(0));
    let top = json_of(&folder.trullo(&["check", "s.obj", "--json"]))["box"].clone();
    let height = top["max"][2].as_f64().expect("a number") - top["min"][2].as_f64().expect("a number");
    assert!((height - 50.0).abs() < 1e-3, "{height}");

    let open = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid t\n";
    folder.write("open.stl", open);
    let out = folder.trullo(&["convert", "open.stl", "open.obj"]);
    assert_failed(&out, "open.stl: not written, because the mesh is not closed");
    assert!(!folder.has("open.obj"));
    let checked = folder.trullo(&["check", "open.stl", "--json"]);
    assert_eq!(checked.status.code(), Some(1));
    assert_eq!(json_of(&checked)["findings"][0]["fault"], "BoundaryEdge");
}

#[test]
fn simplified_meshes_are_smaller_and_still_solid() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let triangles = |more: &[&str]| {
        let out =
            folder.trullo(&[&["mesh", "s.trullo", "-o", "s.stl", "--cells", "40", "--json"], more].concat());
        json_of(&out)["triangles"].as_u64().expect("a count")
    };
    let (full, simple) = (triangles(&[]), triangles(&["--simplify", "0.1"]));
    assert!(simple * 2 < full, "{full} became {simple}");
    assert_eq!(json_of(&folder.trullo(&["check", "s.stl", "--json"]))["closed"], true);
}

#[test]
fn repeated_work_reports_one_set_of_timings() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let out = folder.trullo(&["eval", "s.trullo", "--at", "0,0,0", "--repeat", "5", "--timings", "--json"]);
    assert!(json_of(&out)["timings"]["total_ms"].is_number());
}
