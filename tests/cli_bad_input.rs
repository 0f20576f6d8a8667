//! What the program says to input that is not right.

mod common;

use common::{Folder, SNOWMAN, assert_failed, json_of, text_of};

#[test]
fn files_that_cannot_be_opened_are_named_with_the_reason() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.trullo")).expect("the folder is ours");
    folder.write("empty.trullo", "");
    folder.write("empty.stl", "");
    folder.write("text.txt", "hello");
    for (name, words) in [
        ("none.trullo", "none.trullo: cannot be read: No such file"),
        ("folder.trullo", "folder.trullo: a folder, not a file"),
        ("empty.trullo", "empty.trullo: the file is empty"),
        ("empty.stl", "empty.stl: the file is empty"),
        ("text.txt", "text.txt: neither a scene (.trullo) nor a mesh"),
    ] {
        assert_failed(&folder.trullo(&["check", name]), words);
    }
}

#[test]
fn a_pipe_is_refused_rather_than_waited_for() {
    let folder = Folder::new();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.stl")).status();
    if made.is_ok_and(|status| status.success()) {
        assert_failed(&folder.trullo(&["check", "pipe.stl"]), "not an ordinary file");
    }
}

#[test]
fn errors_in_scenes_come_with_file_line_and_node() {
    let folder = Folder::with_scene("s.trullo", &SNOWMAN.replace("\"radius\": 5", "\"radius\": -5"));
    let out = folder.trullo(&["eval", "s.trullo", "--at", "0,0,0", "--json"]);
    assert_failed(&out, "s.trullo: line 3, column ");
    let error = json_of(&out)["error"].as_str().expect("a text").to_owned();
    assert!(error.contains("node /1") && error.contains("`radius` is -5"), "{error}");
}

#[test]
fn truncated_files_fail_at_every_length_without_panic() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "12"]);
    folder.trullo(&["mesh", "s.trullo", "-o", "s.3mf", "--cells", "12"]);
    for name in ["s.trullo", "s.stl", "s.3mf"] {
        let whole = folder.read(name);
        let extension = name.rsplit('.').next().expect("it has one");
        for tenth in 0..10 {
            let cut = format!("cut.{extension}");
            folder.write(&cut, &whole[..whole.len() * tenth / 10]);
            assert_failed(&folder.trullo(&["check", &cut]), &cut);
        }
    }
}

#[test]
fn garbage_is_refused_under_every_name() {
    let folder = Folder::new();
    let garbage: Vec<u8> = (0..5000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for name in ["g.trullo", "g.stl", "g.obj", "g.ply", "g.3mf"] {
        folder.write(name, &garbage);
        assert_failed(&folder.trullo(&["check", name]), name);
    }
    let mut counts = vec![0; 84];
    counts[80..].fill(255);
    folder.write("huge.stl", &counts);
    assert_failed(&folder.trullo(&["check", "huge.stl"]), "huge.stl");
}

#[test]
fn a_mesh_in_a_scene_is_found_beside_it_and_must_be_the_same() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let scene = |hash: &str| {
        format!(
            r#"{{"format": "trullo", "version": 1, "root": {{"type": "mesh", "file": "s.stl", "sha256": "{hash}"}}}}"#
        )
    };
    folder.write("m.trullo", scene(&"0".repeat(64)));
    assert_failed(&folder.trullo(&["tree", "m.trullo"]), "s.stl: cannot be read");
    folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "16"]);
    let out = folder.trullo(&["tree", "m.trullo"]);
    assert_failed(&out, "has changed: its SHA-256 is ");
    let said = text_of(&out.stderr);
    let hash = said.split("SHA-256 is ").nth(1).and_then(|rest| rest.get(..64)).expect("it is told");
    folder.write("m.trullo", scene(hash));
    let out = folder.trullo(&["eval", "m.trullo", "--at", "0,0,10", "--json"]);
    assert_eq!(json_of(&out)["points"][0]["inside"], true);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    std::fs::create_dir(folder.path("taken.stl")).expect("the folder is ours");
    assert_failed(&folder.trullo(&["mesh", "s.trullo", "-o", "taken.stl"]), "taken.stl: not a file");
    assert_failed(&folder.trullo(&["mesh", "s.trullo", "-o", "no/such/s.stl"]), "cannot be written");
    assert_failed(&folder.trullo(&["mesh", "s.trullo", "-o", "s.step"]), "must end in .stl");
    assert_failed(&folder.trullo(&["render", "s.trullo", "-o", "s.jpg"]), "must end in .png");
    assert_eq!(folder.names(), ["s.trullo", "taken.stl"]);
}

#[test]
fn usage_errors_end_with_two_and_help_with_nought() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    for wrong in [
        &[][..],
        &["fly"],
        &["eval", "s.trullo"],
        &["eval", "s.trullo", "--at", "1,2"],
        &["eval", "s.trullo", "--at", "nan,0,0"],
        &["mesh", "s.trullo", "-o", "s.stl", "--cell", "1", "--cells", "2"],
        &["mesh", "s.trullo", "-o", "s.stl", "--cell", "0"],
        &["check", "s.trullo", "--threads", "0"],
        &["render", "s.trullo", "-o", "s.png", "--size", "1x1"],
        &["check", "s.trullo", "--layer-height", "0"],
        &["check", "s.trullo", "--layer-height", "NaN"],
        &["check", "s.trullo", "--max-overhang", "85"],
        &["slice", "s.trullo", "-o", "s.svg", "--layer-height", "inf"],
        &["slice", "s.trullo", "-o", "s.svg", "--as", "png"],
    ] {
        assert_eq!(folder.trullo(wrong).status.code(), Some(2), "{wrong:?}");
    }
    let out = folder.trullo(&["eval", "s.trullo", "--at", "1,2", "--json"]);
    assert!(json_of(&out)["error"].as_str().is_some_and(|e| e.contains("three numbers")));
    for verb in ["eval", "tree", "mesh", "convert", "render", "check", "slice"] {
        let out = folder.trullo(&[verb, "--help"]);
        assert_eq!(out.status.code(), Some(0), "{verb}");
        assert!(text_of(&out.stdout).contains("Example: trullo "), "{verb}");
    }
}

#[test]
fn scenes_and_meshes_are_not_taken_for_each_other() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "12"]);
    assert_failed(
        &folder.trullo(&["mesh", "s.stl", "-o", "t.stl"]),
        "a mesh (binary STL), not a scene; `trullo convert`",
    );
    assert_failed(&folder.trullo(&["convert", "s.stl", "t.trullo"]), "carries no scene");
    assert_failed(&folder.trullo(&["check", "s.trullo", "--height", "5"]), "--height scales meshes only");
    let empty = r#"{"format": "trullo", "version": 1, "root": {"type": "union", "children": []}}"#;
    folder.write("empty.trullo", empty);
    assert_failed(&folder.trullo(&["mesh", "empty.trullo", "-o", "t.stl"]), "no solid");
    assert_failed(&folder.trullo(&["render", "empty.trullo", "-o", "t.png"]), "no solid");
}
