//! Brush strokes in scene files.

use super::{file, read};
use crate::node::Shape;
use crate::support_free::{BrushStroke, BrushTip, MAX_NODE_DABS, SupportFree};

fn node(strokes: &str) -> String {
    file(&format!(
        r#"{{"type": "support_free", "strokes": {strokes}, "child": {{"type": "union", "children": []}}}}"#
    ))
}

fn rule_of(strokes: &str) -> SupportFree {
    let scene = read(&node(strokes)).unwrap_or_else(|e| panic!("{e} in {strokes}"));
    let text = scene.to_text().expect("what was read can be written");
    assert_eq!(read(&text).as_ref(), Ok(&scene), "{text}");
    match &scene.root.shape {
        Shape::SupportFree(rule, _) => rule.clone(),
        other => panic!("{other:?}"),
    }
}

fn refused(strokes: &str) -> String {
    let message = read(&node(strokes)).expect_err(strokes).to_string();
    let at = message.find("node ").unwrap_or_else(|| panic!("no node in: {message}"));
    message[at..].to_owned()
}

#[test]
fn strokes_with_all_their_fields_and_any_tip_are_read_back_as_they_were_written() {
    let rule = rule_of(
        r#"[
            {"brush": "add_trim", "radius": 2, "places": [[0, 0, 1], [3, 0, 1]]},
            {"brush": "remove_preserve", "tip": "cube", "radius": 0.5, "light_radius": 0.1, "strength": 0.25,
             "light_strength": 0, "spacing": 0.3, "material": 2, "grown_material": 7,
             "places": [[0, 0, 1]], "pressures": [0.5]},
            {"brush": "smooth_trim", "radius": 2, "places": [[0, 0, 1]], "tip": {"type": "blend", "children": [
                {"type": "point", "center": [0, 0, 0], "radius": 0.5},
                {"type": "point", "center": [0.5, 0, 0], "radius": 0.5}]}}
        ]"#,
    );
    let [plain, full, shaped]: [&BrushStroke; 3] = std::array::from_fn(|n| &*rule.strokes[n]);
    assert_eq!((plain.tip.clone(), plain.strength, plain.material), (BrushTip::Ball, 1.0, 0));
    assert_eq!((plain.pressure(1), full.pressure(0)), (1.0, 0.5));
    assert_eq!((full.tip.clone(), full.grown_material, full.spacing), (BrushTip::Cube, 7, Some(0.3)));
    assert!(matches!(&shaped.tip, BrushTip::Shape(node) if node.children().len() == 2));
}

#[test]
fn wrong_strokes_are_told_with_their_place_and_what_would_be_right() {
    let cases = [
        ("3", "node /: `strokes` is 3, not a list of brush strokes"),
        ("[3]", "node /: `the stroke` is 3, not an object with `brush`"),
        (
            r#"[{"brush": "glue", "radius": 1, "places": []}]"#,
            "node /: `brush` is the text \"glue\", not add_trim",
        ),
        (r#"[{"brush": "add_trim", "places": [[0, 0, 0]]}]"#, "node /: `radius` is missing"),
        (
            r#"[{"brush": "add_trim", "radius": -1, "places": [[0, 0, 0]]}]"#,
            "node /: `strokes[0].radius` is -1.0, not 0.05 to 100 mm",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": []}]"#,
            "node /: `strokes[0].places` is a list of 0, not a list of 1 to 100000",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": [[0, 0]]}]"#,
            "node /: `places[0]` is a list of 2, not three numbers",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": [[0, 0, 1e9]]}]"#,
            "node /: `strokes[0].places[0]` is Vec3(0.0, 0.0, 1000000000.0), not three coordinates",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": [[0, 0, 1]], "pressures": [1, 1]}]"#,
            "node /: `strokes[0].pressures` is a list of 2, not a list of 1 to 1",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": [[0, 0, 1]], "strength": 2}]"#,
            "node /: `strokes[0].strength` is 2.0, not 0 to 1",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "tip": "bal", "places": [[0, 0, 1]]}]"#,
            "node /: brush tip `bal` is not known; did you mean `ball`?",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "places": [[0, 0, 1]], "tip": {"type": "point"}}]"#,
            "node /: `center` is missing",
        ),
        (
            r#"[{"brush": "add_trim", "radius": 1, "size": 1, "places": [[0, 0, 1]]}]"#,
            "node /: there is no field `size` here, but brush, radius",
        ),
    ];
    for (strokes, expected) in cases {
        let message = refused(strokes);
        assert!(message.starts_with(expected), "{message}\ninstead of\n{expected}");
    }
}

#[test]
fn more_dabs_than_a_node_may_have_are_refused_before_anything_is_made_of_them() {
    let long =
        r#"[{"brush": "add_trim", "radius": 0.1, "spacing": 0.05, "places": [[0, 0, 0], [90000, 0, 0]]}]"#;
    let message = refused(long);
    assert!(message.contains("`strokes` is 18000000 dabs or more, not at most 100000"), "{message}");
    let one = r#"{"brush": "add_trim", "radius": 1, "spacing": 1, "places": [[0, 0, 0], [60000, 0, 0]]}"#;
    assert_eq!(rule_of(&format!("[{one}]")).strokes[0].dabs_at_most(), 60_001);
    assert!(refused(&format!("[{one}, {one}]")).contains(&format!("at most {MAX_NODE_DABS}")));
}
