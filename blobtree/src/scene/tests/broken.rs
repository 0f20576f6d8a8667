//! However broken a file is, reading it ends soon and in words.

use super::{ALL_TYPES, file, read};
use crate::build::{Build, point};
use crate::node::{NodeRef, Shape};
use crate::operator::Operator;
use crate::random::RandomTree;
use crate::scene::{MAX_DEPTH, MAX_FILE_BYTES, NoSources, Scene, SceneProblem};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Reads, and fails if that takes long.
fn problem(text: impl AsRef<[u8]>) -> Option<SceneProblem> {
    let start = Instant::now();
    let result = Scene::from_bytes(text.as_ref(), &mut NoSources);
    // None takes half a second; the rest is room for machines with other work.
    assert!(start.elapsed() < Duration::from_secs(10), "took {:?}", start.elapsed());
    result.err().map(|e| {
        assert!(e.to_string().len() < 2000, "a long message: {e}");
        e.problem
    })
}

#[test]
fn files_cut_off_at_each_percent_are_refused() {
    for text in [ALL_TYPES.to_owned(), Scene::new(RandomTree::new(3).tree()).to_text().expect("legal")] {
        let text = text.trim_end();
        for percent in 0..100 {
            let cut = &text.as_bytes()[..text.len() * percent / 100];
            assert!(problem(cut).is_some(), "{percent} % of the file");
        }
    }
}

#[test]
fn flipped_bits_give_an_error_or_a_legal_scene() {
    let seed = 11;
    let mut rng = fastrand::Rng::with_seed(seed);
    for _ in 0..3000 {
        let mut bytes = ALL_TYPES.as_bytes().to_vec();
        for _ in 0..rng.usize(1..=3) {
            let at = rng.usize(..bytes.len());
            bytes[at] ^= 1 << rng.u32(..8);
        }
        if let Ok(scene) = Scene::from_bytes(&bytes, &mut NoSources) {
            assert_eq!(scene.check(), Ok(()), "seed {seed}");
        }
    }
}

#[test]
fn every_value_of_a_wrong_type_or_size_gives_an_error_or_a_legal_scene() {
    let whole: Value = serde_json::from_str(ALL_TYPES).expect("JSON");
    let wrong = [
        json!(null),
        json!(true),
        json!(-1),
        json!(1e39),
        json!(1e300),
        json!(0),
        json!(u64::MAX),
        json!("x"),
        json!([]),
        json!([1, 2]),
        json!([[[[]]]]),
        json!({}),
        json!({"use": "leg"}),
        json!({"type": "union", "children": {}}),
    ];
    let (mut tried, mut refused) = (0, 0);
    for pointer in pointers(&whole) {
        for value in &wrong {
            let mut broken = whole.clone();
            *broken.pointer_mut(&pointer).expect("it leads to a value") = value.clone();
            tried += 1;
            match read(&broken.to_string()) {
                Ok(scene) => assert_eq!(scene.check(), Ok(()), "{value} at {pointer}"),
                Err(e) => {
                    refused += 1;
                    assert!(e.at.is_some(), "no place for {value} at {pointer}: {e}");
                }
            }
        }
    }
    assert!(tried > 2000 && refused * 10 > tried * 7, "{refused} of {tried} refused");
}

/// JSON pointers to all values within.
fn pointers(value: &Value) -> Vec<String> {
    let below = |key: &str, value: &Value| {
        let key = key.replace('~', "~0").replace('/', "~1");
        pointers(value).into_iter().map(move |rest| format!("/{key}{rest}")).collect::<Vec<_>>()
    };
    let mut all = vec![String::new()];
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| all.extend(below(key, value))),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, value)| all.extend(below(&i.to_string(), value)));
        }
        _ => {}
    }
    all
}

#[test]
fn nesting_is_limited_in_brackets_in_nodes_and_through_definitions() {
    for brackets in ["[", "{\"a\":", "[{\"root\":"] {
        assert_eq!(problem(brackets.repeat(10_000)), Some(SceneProblem::TooDeep));
        assert_eq!(problem(brackets.repeat(1_000_000)), Some(SceneProblem::TooDeep));
    }
    let nested = |depth: usize| {
        let leaf = r#"{"type": "union", "children": []}"#;
        let open = r#"{"type": "union", "children": ["#.repeat(depth - 1);
        format!("{open}{leaf}{}", "]}".repeat(depth - 1))
    };
    assert_eq!(problem(file(&nested(MAX_DEPTH))), None);
    assert_eq!(problem(file(&nested(MAX_DEPTH + 1))), Some(SceneProblem::TooDeep));
    assert_eq!(problem(file(&nested(10_000))), Some(SceneProblem::TooDeep));
    let through = |depth| {
        let wrapped = nested(100).replace(r#"{"type": "union", "children": []}"#, r#"{"use": "a"}"#);
        let a = nested(depth);
        format!(r#"{{"format": "trullo", "version": 1, "define": {{"a": {a}}}, "root": {wrapped}}}"#)
    };
    assert_eq!(problem(through(MAX_DEPTH - 99)), None);
    assert_eq!(problem(through(MAX_DEPTH - 98)), Some(SceneProblem::TooDeep));
}

#[test]
fn a_tree_that_nobody_could_read_again_is_not_written() {
    let mut node: NodeRef = point([0., 0., 0.], 1.).into();
    for _ in 1..MAX_DEPTH {
        node = node.translate([1., 0., 0.]).into();
    }
    assert!(Scene::new(node.clone()).to_text().is_ok());
    let deeper = Scene::new(node.translate([1., 0., 0.]));
    assert_eq!(deeper.to_text().map_err(|e| e.problem), Err(SceneProblem::TooDeep));
    let nan = Scene::new(point([0., f32::NAN, 0.], 1.)).to_text().expect_err("NaN is no place");
    assert!(nan.to_string().starts_with("node /: `center` is Vec3(0.0, NaN, 0.0)"), "{nan}");
}

#[test]
fn a_million_nodes_are_too_many_written_out_or_shared() {
    let nodes = r#"{"type":"union","children":[]},"#.repeat(1_000_000);
    let text = file(&format!(r#"{{"type": "union", "children": [{}]}}"#, nodes.trim_end_matches(',')));
    assert_eq!(problem(text), Some(SceneProblem::TooManyObjects));
    let numbers = file(&format!("[{}0]", "0,".repeat(10_000_000)));
    assert_eq!(problem(numbers), Some(SceneProblem::TooManyObjects));
    assert_eq!(problem(vec![b' '; MAX_FILE_BYTES + 1]), Some(SceneProblem::TooLarge));

    // Thirty doublings: a billion nodes from a screenful of text.
    let doubled: Vec<String> = (1..30)
        .map(|i| {
            format!(r#""{i}": {{"type": "sum", "children": [{{"use": "{0}"}}, {{"use": "{0}"}}]}}"#, i - 1)
        })
        .collect();
    let text = format!(
        r#"{{"format": "trullo", "version": 1, "define": {{"0": {{"type": "point", "center": [0, 0, 0], "radius": 1}},
        {}}}, "root": {{"use": "29"}}}}"#,
        doubled.join(",\n")
    );
    assert_eq!(problem(text), Some(SceneProblem::TooManyNodes));
    let mut node: NodeRef = point([0., 0., 0.], 1.).into();
    for _ in 0..60 {
        node = crate::build::operator(Operator::Sum, [node.clone(), node]).into();
    }
    assert_eq!(Scene::new(node).check().map_err(|e| e.problem), Err(SceneProblem::TooManyNodes));
}

#[test]
fn long_chains_and_circles_of_definitions_end_without_a_stack_overflow() {
    let chain = |last: &str| {
        let links: Vec<String> = (1..100_000).map(|i| format!(r#""{i}": {{"use": "{}"}}"#, i - 1)).collect();
        format!(
            r#"{{"format": "trullo", "version": 1, "define": {{"0": {last}, {}}}, "root": {{"use": "99999"}}}}"#,
            links.join(",")
        )
    };
    assert_eq!(problem(chain(r#"{"type": "union", "children": []}"#)), None);
    assert!(matches!(problem(chain(r#"{"use": "99999"}"#)), Some(SceneProblem::Cycle(_))));
    assert!(matches!(problem(chain(r#"{"use": "0"}"#)), Some(SceneProblem::Cycle(_))));
}

#[test]
fn bytes_that_are_no_text_and_files_that_are_empty_are_refused() {
    assert_eq!(problem(""), Some(SceneProblem::Empty));
    assert_eq!(problem(" \n\t"), Some(SceneProblem::Empty));
    assert_eq!(problem([0xff, 0xfe, 0, 0]), Some(SceneProblem::NotUtf8));
    assert!(matches!(problem([0; 100]), Some(SceneProblem::Syntax(_))));
    let seed = 5;
    let mut rng = fastrand::Rng::with_seed(seed);
    for length in 0..300 {
        let bytes: Vec<u8> = (0..length).map(|_| b"{}[]\":,\\0e-\nu"[rng.usize(..13)]).collect();
        assert!(problem(&bytes).is_some(), "seed {seed}: {:?}", String::from_utf8_lossy(&bytes));
    }
}

#[test]
fn a_reader_without_end_and_one_that_fails_are_errors() {
    let endless = Scene::read(std::io::repeat(b' '), &mut NoSources).expect_err("it never ends");
    assert_eq!(endless.problem, SceneProblem::TooLarge);
    let folder = std::fs::File::open(std::env::temp_dir()).expect("there is a folder for temporary files");
    let failed = Scene::read(folder, &mut NoSources).expect_err("a folder has no text");
    assert!(matches!(failed.problem, SceneProblem::Unreadable(_)));
}

#[test]
fn nodes_that_are_wrong_deep_down_are_named_by_their_path() {
    let bad = point([0., 0., 0.], -1.);
    let root = crate::build::union([point([0., 0., 0.], 1.), bad.translate([1., 0., 0.])]);
    assert!(matches!(root.shape, Shape::Operator(..)));
    let error = Scene::new(root).check().expect_err("the radius is negative");
    assert_eq!(error.to_string(), "node /1/0: `radius` is -1.0, not 0.001 to 100000 mm");
}
