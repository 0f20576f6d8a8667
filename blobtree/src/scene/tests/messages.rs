//! Messages say where, what is wrong with which value, and what would be right.

use super::{file, read};

/// The message for a file with this root, without the place in the text.
fn about(root: &str) -> String {
    let message = read(&file(root)).expect_err(root).to_string();
    let at = message.find("node ").unwrap_or_else(|| panic!("no node in: {message}"));
    message[at..].to_owned()
}

fn whole(text: &str) -> String {
    read(text).expect_err(text).to_string()
}

#[test]
fn a_value_in_the_middle_of_a_file_is_found_by_line_column_and_node() {
    let text = "{\"format\": \"trullo\", \"version\": 1, \"define\": {\n\"leg\": {\"type\": \"sum\", \"children\": [\n \
                {\"type\": \"point\", \"center\": [0, 0, \"é\"],\n \"radius\": 1}]}},\n\"root\": {\"use\": \"leg\"}}";
    assert_eq!(
        whole(text),
        "line 3, column 37: node define.leg/0: `center[2]` is the text \"é\", not a number"
    );
    let text = file(r#"{"type": "twist", "degrees_per_mm": 3, "child": {"type": "sum", "children": [3]}}"#);
    let message = whole(&text);
    assert!(message.ends_with("node /0/0: `the node` is 3, not an object with `type` or `use`"), "{message}");
}

#[test]
fn wrong_parameters_are_told_with_what_would_be_right() {
    let cases = [
        (
            r#"{"type": "point", "center": [0, 0, 0], "radius": -5}"#,
            "`radius` is -5.0, not 0.001 to 100000 mm",
        ),
        (
            r#"{"type": "point", "center": [0, 0, 0], "radius": 1e39}"#,
            "`radius` is inf, not 0.001 to 100000 mm",
        ),
        (r#"{"type": "point", "center": [0, 0, 0], "radius": null}"#, "`radius` is null, not a number"),
        (
            r#"{"type": "point", "center": [0, 0], "radius": 1}"#,
            "`center` is a list of 2, not three numbers, like [0, 0, 10]",
        ),
        (
            r#"{"type": "point", "center": [0, 0, 0, 0], "radius": 1}"#,
            "`center` is a list of 4, not a shorter list",
        ),
        (r#"{"type": "point", "center": [0, 0, 0]}"#, "`radius` is missing: the node needs it"),
        (
            r#"{"type": "point", "center": [0, 0, 0], "radius": 1, "colour": "red"}"#,
            "there is no field `colour` here, but center, radius, falloff, type, name, color, muted, construction",
        ),
        (
            r#"{"type": "sum", "children": [], "sharpness": 2}"#,
            "there is no field `sharpness` here, but children, type, name, color, muted, construction",
        ),
        (r#"{"type": "blend", "children": [], "sharpness": 0.5}"#, "`sharpness` is 0.5, not 1 to 64"),
        (
            r#"{"type": "blend", "children": {}}"#,
            "`children` is an object, not a list of nodes, which may be empty",
        ),
        (r#"{"type": "blend"}"#, "`children` is missing: a list of nodes, which may be empty"),
        (r#"{"type": "pont"}"#, "node type `pont` is not known; did you mean `point`?"),
        (r#"{"type": "halfspace"}"#, "node type `halfspace` is not known; did you mean `half_space`?"),
        (r#"{"type": 7}"#, "`type` is 7, not a node type such as \"point\""),
        (r#"{"children": []}"#, "`type` is missing: what the node is, such as \"point\""),
        (
            r#"{"type": "sum", "children": [], "color": "red"}"#,
            "`color` is the text \"red\", not a colour like \"#ff8800\"",
        ),
        (r#"{"type": "sum", "children": [], "muted": 1}"#, "`muted` is 1, not true or false"),
        (r#"{"use": "leg"}"#, "definition `leg` is not known"),
        (r#"{"use": "leg", "name": "left"}"#, "there is no field `name` here, but use"),
        (r#"{"type": "twist", "degrees_per_mm": 1}"#, "`child` is missing: the node that is warped"),
        (
            r#"{"type": "twist", "axis": "w", "degrees_per_mm": 1, "child": {"type": "sum", "children": []}}"#,
            "`axis` is the text \"w\", not x, y, z",
        ),
        (
            r#"{"type": "polyline", "points": [{"at": [0, 0, 0]}]}"#,
            "`points[0].radius` is missing: the node needs it",
        ),
        (
            r#"{"type": "mesh", "file": "bunny.stl", "sha256": "00"}"#,
            "mesh `bunny.stl`: mesh files are not read here",
        ),
        (r#"{"type": "inflation", "drawing": {"strokes": []}}"#, "the drawing: it encloses nothing"),
        (
            r#"{"type": "sweep", "length": 2, "drawing": {"strokes": [{"points": [[0]]}]}}"#,
            "`drawing.strokes[0].points[0]` is a list of 1, not [x, y], [x, y, pressure] or [x, y, pressure, smoothing]",
        ),
        (
            r#"{"type": "revolution", "drawing": {"strokes": [{"points": [[0, 2e5]]}]}}"#,
            "`drawing.strokes.points` is Vec2(0.0, 200000.0), not two coordinates of -100000 to 100000 mm",
        ),
        (
            r#"{"type": "inflation", "plane": {"up": [2, 0, 0]}, "drawing": {"strokes": []}}"#,
            "`plane.up` is Vec3(2.0, 0.0, 0.0), not a direction other than `plane.right`",
        ),
        (
            r#"{"type": "path_sweep", "path": [[1, 2, 3], [1, 2, 3]], "drawing": {"strokes": []}}"#,
            "`path` is points all in one place, not at least two places",
        ),
    ];
    for (root, expected) in cases {
        assert_eq!(about(root), format!("node /: {expected}"), "{root}");
    }
    let long = about(r#"{"type": "ballon"}"#);
    assert!(
        long.starts_with("node /: node type `ballon` is not known; the known ones are point, segment"),
        "{long}"
    );
}

#[test]
fn files_of_another_kind_or_version_are_told_so() {
    let union = r#"{"type": "union", "children": []}"#;
    let cases = [
        ("", "the file is empty; a scene begins with {\"format\": \"trullo\", \"version\": 1, \"root\": …"),
        (
            "[]",
            "line 1, column 1: `the file` is a list of 0, not an object with `format`, `version` and `root`",
        ),
        ("{}", "line 1, column 1: `format` is missing: a scene file says \"format\": \"trullo\""),
        (
            r#"{"format": "gltf"}"#,
            "line 1, column 12: not a scene: `format` is the text \"gltf\", not \"trullo\"",
        ),
        (r#"{"format": "trullo"}"#, "line 1, column 1: `version` is missing: the newest is \"version\": 1"),
        (
            r#"{"format": "trullo", "version": 7, "later": []}"#,
            "line 1, column 33: version 7 of the format is newer than 1, the newest that this Trullo reads",
        ),
        (
            r#"{"format": "trullo", "version": 0}"#,
            "line 1, column 33: `version` is 0, not a whole number from 1 to 1",
        ),
        (
            r#"{"format": "trullo", "version": 1}"#,
            "line 1, column 1: `root` is missing: the tree, an object with `type`",
        ),
        (
            "{\"format\":\n \"trullo\", \"format\": 1}",
            "line 2, column 19: not JSON: `format` is given twice in one object",
        ),
        ("{\"format\": \n NaN}", "line 2, column 2: not JSON: expected value"),
        ("{\"format\": \"ö\", 1e999]", "line 1, column 17: not JSON: key must be a string"),
        ("{\"a\": 1e999}", "line 1, column 11: not JSON: number out of range"),
        ("{\"a\": [1,\n", "line 2, column 1: not JSON: EOF while parsing a value"),
        ("{\"a\": 1} x", "line 1, column 10: not JSON: trailing characters"),
    ];
    for (text, expected) in cases {
        assert_eq!(whole(text), expected, "{text}");
    }
    let extra = format!(r#"{{"format": "trullo", "version": 1, "author": "me", "root": {union}}}"#);
    assert_eq!(
        whole(&extra),
        "line 1, column 46: there is no field `author` here, but format, version, title, define, root"
    );
    let circle = r#"{"format": "trullo", "version": 1, "root": {"use": "a"}, "define": {
        "a": {"type": "union", "children": [{"use": "b"}]},
        "b": {"type": "union", "children": [{"use": "c"}, {"use": "a"}]}, "c": {"use": "d"}}}"#;
    assert_eq!(
        whole(circle),
        "line 2, column 14: node define.a: definitions use each other in a circle: a uses b uses a"
    );
}
