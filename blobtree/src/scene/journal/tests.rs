//! What journal lines promise.

use crate::build::{Build, point, union};
use crate::document::{Command, Document, JournalEntry, NewShape};
use crate::imported::ImportedMesh;
use crate::node::{Color, NodePath, NodeRef};
use crate::operator::{Operator, Sharpness};
use crate::primitive::Primitive;
use crate::random::{PolygonSources, RandomTree, polygon_template, stroke};
use crate::scene::{MeshReference, NoSources, Scene, SceneProblem, SceneSources};
use crate::sketched::{Drawing, Inflation, SketchPlane, Template};
use crate::support_free::{BrushKind, BrushStroke, SupportFree};
use fastrand::Rng;
use glam::{Vec2, Vec3};
use mesh::{Mesh, MeshDistance};
use std::sync::Arc;

fn path(text: &str) -> NodePath {
    text.parse().expect("a path")
}

/// A tetrahedron, as if read from a file.
fn imported() -> ImportedMesh {
    let positions = [[0., 0., 0.], [10., 0., 0.], [0., 10., 0.], [0., 0., 10.]].map(Vec3::from).to_vec();
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let distance = MeshDistance::new(&Mesh { positions, triangles }).expect("a sound mesh").into();
    ImportedMesh { file: "tetrahedron.stl".into(), sha256: "a".repeat(64), falloff: 2.5, distance }
}

/// Solves drawings, and knows the one mesh.
struct Sources(ImportedMesh);

impl SceneSources for Sources {
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        assert_eq!((&reference.file, &reference.sha256), (&self.0.file, &self.0.sha256));
        Ok(self.0.distance.clone())
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        PolygonSources.template(drawing, falloff)
    }
}

/// Trees of every kind of node.
fn trees(seed: u64) -> RandomTree {
    let mut trees = RandomTree::new(seed);
    (trees.depth, trees.mesh, trees.drawn, trees.support_free) = (5, Some(imported()), true, true);
    trees
}

/// Any place in a tree.
fn place(rng: &mut Rng, root: &NodeRef) -> (NodePath, NodeRef) {
    let (mut node, mut path) = (root, NodePath::default());
    while !node.children().is_empty() && rng.u32(..3) != 0 {
        let index = rng.usize(..node.children().len());
        node = &node.children()[index];
        path = path.child(index);
    }
    (path, node.clone())
}

/// A node that a command may bring along: new, from the tree or its definitions, or of all of these.
fn material(rng: &mut Rng, trees: &mut RandomTree, scene: &Scene) -> NodeRef {
    let kept = place(rng, &scene.root).1;
    match rng.u32(..6) {
        0 => trees.tree(),
        1 => kept,
        2 => union([trees.leaf()]).operator_over([kept.clone(), trees.tree(), kept]),
        3 => scene.definitions.values().next().cloned().unwrap_or(kept),
        4 => {
            let shared: NodeRef = trees.leaf().into();
            union([trees.leaf()]).operator_over([shared.clone(), kept, shared])
        }
        _ => trees.leaf().into(),
    }
}

/// An operator over these children, whatever it was over before.
trait OperatorOver {
    fn operator_over(self, children: impl IntoIterator<Item = NodeRef>) -> NodeRef;
}

impl OperatorOver for crate::node::Node {
    fn operator_over(mut self, children: impl IntoIterator<Item = NodeRef>) -> NodeRef {
        self.shape = crate::node::Shape::Operator(Operator::Union, children.into_iter().collect());
        self.into()
    }
}

/// Any entry, legal or not.
fn random_entry(rng: &mut Rng, trees: &mut RandomTree, scene: &Scene) -> JournalEntry {
    let (path, node) = place(rng, &scene.root);
    let (parent, index) = (place(rng, &scene.root).0, rng.usize(..4));
    JournalEntry::Command(match rng.u32(..26) {
        0 | 1 => return JournalEntry::Undo,
        2 => return JournalEntry::Redo,
        3..6 => Command::Insert { parent, index, node: material(rng, trees, scene) },
        6 => Command::Remove { path },
        7..9 => Command::Replace { path, node: material(rng, trees, scene) },
        9 => Command::Move { from: path, parent, index },
        10 => Command::WrapInOperator { path, operator: trees.operator() },
        11 => Command::WrapInWarp { path, warp: trees.warp() },
        12 => Command::Unwrap { path },
        13 => Command::SetShape { path, shape: NewShape::Primitive(trees.primitive()) },
        14 => Command::SetShape { path, shape: NewShape::from(&node.shape) },
        15 => Command::SetName { path, name: rng.bool().then(|| "n \"\n\u{1}é".to_owned()) },
        16 => Command::SetColor { path, color: rng.bool().then(|| Color([rng.u8(..), 7, 0])) },
        17 => Command::SetMuted { path, muted: rng.bool() },
        18 => Command::SetConstruction { path, construction: rng.bool() },
        19 => Command::WrapInSupportFree { path, rule: trees.rule() },
        20 | 21 => Command::AddStroke { path, stroke: Arc::new(trees.stroke()) },
        22 => Command::RemoveStroke { path, index },
        23 | 24 => {
            let insert = Command::Insert { parent, index, node: material(rng, trees, scene) };
            Command::Together(vec![insert, Command::SetName { path, name: Some("both".into()) }])
        }
        _ => Command::SetTitle { title: rng.bool().then(|| format!("t{}", rng.u32(..9))) },
    })
}

/// The text of the scene, with the names of the steps that could be undone and redone.
fn state(document: &Document) -> (String, Vec<String>, Vec<String>) {
    let names = |names: &mut dyn Iterator<Item = &str>| names.map(str::to_owned).collect();
    let text = document.scene().to_text().expect("documents are legal");
    (text, names(&mut document.undo_names()), names(&mut document.redo_names()))
}

#[test]
fn random_journals_read_line_by_line_give_the_same_documents_with_their_history() {
    let (mut longest, mut refused) = (0, 0);
    for seed in 0..12 {
        let (mut rng, mut trees) = (Rng::with_seed(seed), trees(seed));
        let definitions = [("part one".to_owned(), trees.tree()), ("union".to_owned(), trees.leaf().into())];
        let scene = Scene {
            definitions: Arc::new(definitions.into_iter().collect()),
            ..Scene::new(union([trees.tree()]).operator_over([trees.tree(), trees.tree()]))
        };
        let first = scene.to_line().expect("random scenes are legal");
        let mut sources = Sources(imported());
        let mut opened = || {
            let scene = Scene::from_bytes(first.as_bytes(), &mut sources).expect("it was written by us");
            Document::new(scene).expect("what was read is legal")
        };
        let (mut document, mut copy) = (opened(), opened());
        let mut done = 0;
        while done < 60 {
            let entry = random_entry(&mut rng, &mut trees, document.scene());
            let line = entry.to_line(document.scene()).expect("random nodes are legal");
            assert!(!line.contains('\n'), "seed {seed}: {line}");
            longest = longest.max(line.len());
            if document.repeat(entry.clone()).is_err() {
                refused += 1;
                continue;
            }
            let back = JournalEntry::from_line(line.as_bytes(), copy.scene(), &mut sources)
                .unwrap_or_else(|e| panic!("seed {seed}: {e} in {line}"));
            assert_eq!(back, entry, "seed {seed}: {line}");
            assert_eq!(back.to_line(copy.scene()).as_ref(), Ok(&line), "seed {seed}");
            copy.repeat(back).unwrap_or_else(|e| panic!("seed {seed}: {e} in {line}"));
            assert_eq!(state(&copy), state(&document), "seed {seed}: after {line}");
            done += 1;
        }
        while document.undo().is_some() {
            copy.undo();
            assert_eq!(state(&copy), state(&document), "seed {seed}: undone");
        }
    }
    assert!(refused > 0 && longest > 1000, "{refused} entries refused, {longest} bytes at most");
}

#[test]
fn every_entry_has_the_line_that_the_format_describes() {
    let ball: NodeRef = point([0., 0., 0.], 1.).into();
    let scene = Scene::new(union([point([0., 0., 0.], 2.).named("a"), point([9., 0., 0.], 2.)]));
    let kept = scene.root.children()[0].clone();
    let twice = union([ball.clone(), ball.clone()]);
    let both = union([ball.clone()]).operator_over([kept, ball.clone()]);
    let sharp = Operator::Blend(Sharpness::new(3.0).expect("in range"));
    let (p, at) = (|| path("/1"), path("/"));
    let node = r#"{"type":"point","center":[0,0,0],"radius":1}"#;
    let cases = [
        (
            Command::Insert { parent: at.clone(), index: 2, node: ball },
            format!(r#""do":"insert","parent":"/","index":2,"node":{node}"#),
        ),
        (
            Command::Insert { parent: at, index: 0, node: twice.into() },
            format!(
                r#""do":"insert","parent":"/","index":0,"define":{{"point":{node}}},"node":{{"type":"union","children":[{{"use":"point"}},{{"use":"point"}}]}}"#
            ),
        ),
        (
            Command::Replace { path: p(), node: both },
            format!(
                r#""do":"replace","path":"/1","node":{{"type":"union","children":[{{"kept":"/0"}},{node}]}}"#
            ),
        ),
        (Command::Remove { path: p() }, r#""do":"remove","path":"/1""#.into()),
        (
            Command::Move { from: p(), parent: path("/"), index: 0 },
            r#""do":"move","from":"/1","parent":"/","index":0"#.into(),
        ),
        (
            Command::WrapInOperator { path: p(), operator: sharp },
            r#""do":"wrap","path":"/1","shape":{"type":"blend","sharpness":3}"#.into(),
        ),
        (
            Command::WrapInSupportFree {
                path: p(),
                rule: SupportFree { overhang_degrees: 50., ..SupportFree::default() },
            },
            r#""do":"wrap","path":"/1","shape":{"type":"support_free","overhang_degrees":50}"#.into(),
        ),
        (
            Command::AddStroke {
                path: p(),
                stroke: Arc::new(BrushStroke::new(BrushKind::AddTrim, 2.0, [[0., 0., 1.5]])),
            },
            r#""do":"add_stroke","path":"/1","stroke":{"brush":"add_trim","radius":2,"places":[[0,0,1.5]]}"#
                .into(),
        ),
        (
            Command::RemoveStroke { path: p(), index: 3 },
            r#""do":"remove_stroke","path":"/1","index":3"#.into(),
        ),
        (Command::Unwrap { path: p() }, r#""do":"unwrap","path":"/1""#.into()),
        (Command::SetName { path: p(), name: None }, r#""do":"set_name","path":"/1""#.into()),
        (
            Command::SetColor { path: p(), color: Some(Color([255, 136, 0])) },
            r##""do":"set_color","path":"/1","color":"#ff8800""##.into(),
        ),
        (
            Command::SetConstruction { path: p(), construction: true },
            r#""do":"set_construction","path":"/1","construction":true"#.into(),
        ),
        (Command::SetTitle { title: Some("T".into()) }, r#""do":"set_title","title":"T""#.into()),
        (
            Command::Together(vec![
                Command::SetMuted { path: p(), muted: true },
                Command::Unwrap { path: p() },
            ]),
            r#""do":"together","commands":[{"format":"trullo-journal","version":1,"do":"set_muted","path":"/1","muted":true},{"format":"trullo-journal","version":1,"do":"unwrap","path":"/1"}]"#.into(),
        ),
    ];
    for (command, expected) in cases {
        let line = JournalEntry::Command(command).to_line(&scene).expect("legal");
        assert_eq!(line, format!(r#"{{"format":"trullo-journal","version":1,{expected}}}"#));
    }
    assert_eq!(
        JournalEntry::Undo.to_line(&scene).as_deref(),
        Ok(r#"{"format":"trullo-journal","version":1,"do":"undo"}"#)
    );
}

/// What is said of a line after its format and version.
fn said(rest: &str) -> String {
    let scene = Scene::new(union([point([0., 0., 0.], 2.)]));
    let line = format!(r#"{{"format":"trullo-journal","version":1,{rest}}}"#);
    match JournalEntry::from_line(line.as_bytes(), &scene, &mut NoSources) {
        Err(error) => error.to_string(),
        Ok(entry) => panic!("{line} was read as {entry:?}"),
    }
}

#[test]
fn lines_that_are_wrong_are_refused_with_the_place_and_the_reason() {
    let cases = [
        (r#""do":"explode""#, "line 1, column 45: command `explode` is not known"),
        (r#""do":"undu""#, "line 1, column 45: command `undu` is not known; did you mean `undo`?"),
        (r#""path":"/0""#, "line 1, column 1: `do` is missing: what was done"),
        (r#""do":"remove""#, "line 1, column 1: `path` is missing: a node's path"),
        (r#""do":"remove","path":"0""#, "line 1, column 61: `path` is the text \"0\", not a node's path"),
        (r#""do":"undo","path":"/0""#, "line 1, column 59: there is no field `path` here, but format"),
        (
            r#""do":"remove","path":"/0","node":{}"#,
            "line 1, column 73: node /: there is no field `node` here",
        ),
        (
            r#""do":"insert","parent":"/","index":-1,"node":{}"#,
            "line 1, column 75: `index` is -1, not a whole number from 0 on",
        ),
        (
            r#""do":"replace","path":"/0","node":{"type":"point","center":[0,0,0],"radius":-1}"#,
            "line 1, column 116: node /: `radius` is -1.0, not 0.001 to 100000 mm",
        ),
        (
            r#""do":"replace","path":"/0","node":{"type":"union","children":[{"kept":"/7"}]}"#,
            "line 1, column 110: node /0: `kept` is the text \"/7\", not the path of a node that is there",
        ),
        (
            r#""do":"replace","path":"/0","node":{"kept":"/","muted":true}"#,
            "line 1, column 94: node /: there is no field `muted` here, but kept",
        ),
        (r#""do":"set_shape","path":"/0","shape":{"type":"point","name":"x"}"#, "there is no field `name`"),
        (
            r#""do":"set_shape","path":"/0","shape":{"type":"union","children":[]}"#,
            "`children` here, but type",
        ),
        (
            r#""do":"wrap","path":"/0","shape":{"type":"point","center":[0,0,0],"radius":1}"#,
            "`shape` is a point, not an operator, a warp or a support_free",
        ),
        (r#""do":"set_color","path":"/0","color":"red""#, "`color` is the text \"red\", not a colour"),
        (r#""do":"set_muted","path":"/0","muted":NaN"#, "not JSON"),
        (
            r#""do":"together","commands":[{"format":"trullo-journal","version":1,"do":"undo"}]"#,
            "`commands` is an object, not commands only, no undo and no redo",
        ),
        (
            r#""do":"together","commands":[{"format":"trullo-journal","version":1,"do":"remove","path":"0"}]"#,
            "line 1, column 128: `path` is the text",
        ),
    ];
    for (rest, expected) in cases {
        let error = said(rest);
        assert!(error.contains(expected), "{error} instead of {expected}");
    }
    let read = |line: &str| {
        let scene = Scene::new(point([0., 0., 0.], 2.));
        JournalEntry::from_line(line.as_bytes(), &scene, &mut NoSources).expect_err("it is wrong").problem
    };
    assert_eq!(read(""), SceneProblem::Empty);
    assert_eq!(read(r#"{"format":"trullo-journal","version":2,"do":"x"}"#), SceneProblem::NewerVersion(2));
    assert!(matches!(read(r#"{"format":"trullo","version":1}"#), SceneProblem::NotJournal(_)));
    assert!(matches!(read("[]"), SceneProblem::Parameter(_)));
}

#[test]
fn nodes_too_deep_for_a_scene_are_neither_written_nor_read() {
    let scene = Scene::new(union([point([0., 0., 0.], 2.)]));
    let mut deep: NodeRef = point([0., 0., 0.], 1.).into();
    for _ in 0..crate::scene::MAX_DEPTH {
        deep = deep.translate([1., 0., 0.]).into();
    }
    let insert = |node| JournalEntry::Command(Command::Insert { parent: path("/"), index: 0, node });
    assert_eq!(insert(deep).to_line(&scene).map_err(|e| e.problem), Err(SceneProblem::TooDeep));
    let nan = insert(point([0., 0., 0.], f32::NAN).into());
    assert!(matches!(nan.to_line(&scene).map_err(|e| e.problem), Err(SceneProblem::Parameter(_))));
    let brackets = format!(r#"{{"format":"trullo-journal","version":1,"node":{}"#, "[".repeat(100_000));
    let error = JournalEntry::from_line(brackets.as_bytes(), &scene, &mut NoSources).expect_err("too deep");
    assert_eq!(error.problem, SceneProblem::TooDeep);
}

#[test]
fn what_the_scene_has_solved_and_loaded_is_not_asked_for_again() {
    let drawing = Drawing {
        strokes: vec![stroke([[0., 0.], [9., 0.], [9., 9.]].map(Vec2::from))],
        ..Drawing::default()
    };
    let template = Arc::new(polygon_template(&drawing, None, 16).expect("a polygon"));
    let inflation = Inflation::new(drawing.into(), SketchPlane::default(), template);
    let mesh = Primitive::Mesh(imported());
    let primitives = [Primitive::Inflation(inflation.clone()), mesh.clone()];
    let nodes = primitives.map(|p| crate::node::Node::new(crate::node::Shape::Primitive(p)));
    let scene = Scene::new(union(nodes));
    let thicker = Primitive::Inflation(Inflation { thickness: Some(3.0), ..inflation });
    for primitive in [thicker, mesh] {
        let shape = NewShape::Primitive(primitive);
        let entry = JournalEntry::Command(Command::SetShape { path: path("/0"), shape });
        let line = entry.to_line(&scene).expect("legal");
        let back = JournalEntry::from_line(line.as_bytes(), &scene, &mut NoSources).expect("all is known");
        assert_eq!(back, entry);
    }
}

#[test]
fn the_page_on_the_format_describes_every_word_and_its_journal_can_be_read() {
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene-format.md");
    let page = std::fs::read_to_string(page).expect("the page is there");
    let (_, journals) = page.split_once("## Journals").expect("there is a chapter on them");
    for (word, fields) in super::WORDS {
        for name in fields.iter().chain([&word]) {
            assert!(journals.contains(&format!("`{name}`")), "{name} is not described");
        }
    }
    let (_, example) = journals.split_once("```text\n").expect("there is an example");
    let mut lines = example.lines().take_while(|line| *line != "```");
    let first = lines.next().expect("it begins with a scene");
    let scene = Scene::from_bytes(first.as_bytes(), &mut NoSources).expect("legal");
    assert_eq!(scene.to_line().as_deref(), Ok(first));
    let mut document = Document::new(scene).expect("legal");
    for line in lines {
        let entry = JournalEntry::from_line(line.as_bytes(), document.scene(), &mut NoSources);
        let entry = entry.unwrap_or_else(|e| panic!("{e} in {line}"));
        assert_eq!(entry.to_line(document.scene()).as_deref(), Ok(line));
        document.repeat(entry).expect("it can be done");
    }
    assert_eq!(document.redo_names().count(), 1);
}
