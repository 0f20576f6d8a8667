//! The documents and examples beside the code say what the code does.

use super::{file, read};
use crate::node::{NodeRef, Shape};
use crate::primitive::Primitive;
use crate::scene::{TYPE_NAMES, scene_schema};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Fails if the file differs from `expected`; with `UPDATE_PUBLISHED=1`, writes it instead.
fn compare(path: &Path, expected: &str) {
    if std::env::var_os("UPDATE_PUBLISHED").is_some() {
        fs::write(path, expected).expect("the repository is writable");
    }
    let found = fs::read_to_string(path).unwrap_or_default();
    assert!(found == expected, "{} is not up to date: run the tests with UPDATE_PUBLISHED=1", path.display());
}

fn format_page() -> String {
    fs::read_to_string(repository().join("docs/scene-format.md")).expect("the page is there")
}

#[test]
fn the_published_schema_is_the_one_that_the_code_makes() {
    let text = serde_json::to_string_pretty(&scene_schema()).expect("JSON") + "\n";
    compare(&repository().join("docs/scene.schema.json"), &text);
}

#[test]
fn schema_and_reader_know_the_same_types_and_fields() {
    let schema = scene_schema();
    let nodes = schema.pointer("/$defs/node/anyOf").and_then(Value::as_array).expect("a list of nodes");
    let titles: Vec<&str> = nodes.iter().filter_map(|node| node["title"].as_str()).collect();
    assert_eq!(titles, TYPE_NAMES.into_iter().chain(["use"]).collect::<Vec<_>>());
    for node in &nodes[..TYPE_NAMES.len()] {
        let title = &node["title"];
        let fields = node["properties"].as_object().expect("an object");
        // A node with a field too many is told which fields there are.
        let warped = if fields.contains_key("child") {
            r#""child": {"type": "sum", "children": []},"#
        } else if fields.contains_key("children") {
            r#""children": [],"#
        } else {
            ""
        };
        let message =
            read(&file(&format!("{{\"type\": {title}, {warped} \"no\": 1}}"))).expect_err("too many");
        let message = message.to_string();
        let (_, legal) = message.split_once("there is no field `no` here, but ").expect("the usual message");
        let legal: BTreeSet<&str> = legal.split(", ").collect();
        assert_eq!(legal, fields.keys().map(String::as_str).collect(), "{title}");
    }
}

#[test]
fn the_page_on_the_format_names_every_type_and_field() {
    let page = format_page();
    for name in TYPE_NAMES {
        assert!(page.contains(&format!("`{name}`")), "{name} is not described");
    }
    let schema = scene_schema();
    let nodes = schema.pointer("/$defs/node/anyOf").and_then(Value::as_array).expect("a list of nodes");
    let fields =
        nodes.iter().filter_map(|node| node["properties"].as_object()).flat_map(|fields| fields.keys());
    for field in fields {
        assert!(page.contains(&format!("`{field}`")), "the field {field} is not described");
    }
}

#[test]
fn the_json_on_the_page_can_be_read() {
    let page = format_page();
    let mut blocks = 0;
    for block in page.split("```json\n").skip(1) {
        let (json, _) = block.split_once("```").expect("the block ends");
        let text = if json.contains("\"format\"") { json.to_owned() } else { file(json) };
        // A mesh needs its file, which is not here.
        match read(&text) {
            Ok(_) => {}
            Err(e) => assert!(e.to_string().contains("mesh files are not read here"), "{e} in\n{json}"),
        }
        blocks += 1;
    }
    assert!(blocks > TYPE_NAMES.len() / 2, "only {blocks} blocks");
}

#[test]
fn every_example_is_read_and_written_as_it_is() {
    let folders = ["examples", "examples/sculpted"].map(|folder| repository().join(folder));
    let mut names = BTreeSet::new();
    for entry in folders.into_iter().flat_map(|folder| fs::read_dir(folder).expect("the examples are there"))
    {
        let path = entry.expect("readable").path();
        if path.extension().is_some_and(|extension| extension == "trullo") {
            let scene = read(&fs::read_to_string(&path).expect("readable"));
            let scene = scene.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert!(scene.title.is_some(), "{} has no title", path.display());
            compare(&path, &scene.to_text().expect("what was read can be written"));
            names.insert(path.file_stem().expect("a name").to_string_lossy().into_owned());
        }
    }
    for name in [
        "bracket",
        "chess-pawn",
        "dice",
        "dog-head",
        "forest",
        "pumpkin",
        "shaun",
        "snowman",
        "twisted-vase",
        "two-blobs",
        "wrench",
    ] {
        assert!(names.contains(name), "the example {name} is missing");
    }
}

#[test]
fn the_forest_has_a_thousand_blobs() {
    fn points(node: &NodeRef) -> usize {
        let own = usize::from(matches!(node.shape, Shape::Primitive(Primitive::Point(_))));
        own + node.children().iter().map(points).sum::<usize>()
    }
    let text = fs::read_to_string(repository().join("examples/forest.trullo")).expect("readable");
    assert_eq!(points(&read(&text).expect("legal").root), 1000);
}
