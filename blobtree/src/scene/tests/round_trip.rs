//! Writing and reading give back what was there.

use super::{ALL_TYPES, file, read};
use crate::build::{Build, point, union};
use crate::node::{Node, NodeRef, Shape};
use crate::primitive::Primitive;
use crate::random::{PolygonSources, RandomTree};
use crate::scene::{MeshReference, NoSources, Scene, SceneSources};
use crate::sketched::{Drawing, Template};
use glam::Vec3;
use mesh::MeshDistance;
use std::collections::HashMap;
use std::sync::Arc;

/// For each node in depth-first order, the position at which the same allocation came first.
fn sharing(scene: &Scene) -> Vec<usize> {
    fn visit(node: &NodeRef, seen: &mut HashMap<*const Node, usize>, out: &mut Vec<usize>) {
        let position = out.len();
        out.push(*seen.entry(Arc::as_ptr(node)).or_insert(position));
        node.children().iter().for_each(|child| visit(child, seen, out));
    }
    let (mut seen, mut out) = (HashMap::new(), Vec::new());
    visit(&scene.root, &mut seen, &mut out);
    scene.definitions.values().for_each(|node| visit(node, &mut seen, &mut out));
    out
}

#[test]
fn random_scenes_come_back_equal_and_share_the_same_nodes() {
    for seed in 0..400 {
        let mut random = RandomTree::new(seed);
        random.drawn = seed % 2 == 0;
        let scene = Scene::new(random.tree()).titled(format!("seed \"{seed}\""));
        let text = scene.to_text().expect("random scenes are legal");
        let back = read(&text).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        assert_eq!((&back.title, &back.root), (&scene.title, &scene.root), "seed {seed}");
        // The written definitions were not there before, so only the trees are compared.
        let trees = |scene: &Scene| sharing(&Scene::new(scene.root.clone()));
        assert_eq!(trees(&back), trees(&scene), "seed {seed}");
        assert_eq!(back.to_text().as_ref(), Ok(&text), "seed {seed}");
    }
}

#[test]
fn a_scene_with_everything_comes_back_word_for_word_except_for_defaults_and_layout() {
    let scene = read(ALL_TYPES).expect("the file is legal");
    let text = scene.to_text().expect("what was read can be written");
    let words = |text: &str| text.split_whitespace().collect::<String>();
    assert_eq!(words(&text), words(ALL_TYPES));
    let back = read(&text).expect("what was written can be read");
    assert_eq!(back, scene);
    assert_eq!(sharing(&back), sharing(&scene));
}

#[test]
fn definitions_keep_their_names_even_unused_or_twice_for_one_node() {
    let text = r#"{"format": "trullo", "version": 1, "define": {
        "b": {"type": "union", "children": [{"use": "z"}]},
        "z": {"type": "point", "center": [0, 0, 0], "radius": 1},
        "a": {"use": "z"}}, "root": {"use": "z"}}"#;
    let scene = read(text).expect("legal");
    assert!(Arc::ptr_eq(&scene.root, &scene.definitions["a"]));
    let back = read(&scene.to_text().expect("legal")).expect("legal");
    assert_eq!(back, scene);
    assert_eq!(sharing(&back), sharing(&scene));
}

#[test]
fn shared_nodes_are_written_once_under_names_of_their_own() {
    let leg = point([0., 0., 0.], 3.).named("leg").into_shared();
    let other = point([0., 9., 0.], 3.).named("leg").into_shared();
    let scene = Scene::new(union([leg.clone(), other.clone(), leg, other]));
    let text = scene.to_text().expect("legal");
    let expected = r#"{
  "format": "trullo",
  "version": 1,
  "define": {
    "leg": {"type": "point", "name": "leg", "center": [0, 0, 0], "radius": 3},
    "leg 2": {"type": "point", "name": "leg", "center": [0, 9, 0], "radius": 3}
  },
  "root": {
    "type": "union",
    "children": [{"use": "leg"}, {"use": "leg 2"}, {"use": "leg"}, {"use": "leg 2"}]
  }
}
"#;
    assert_eq!(text, expected);
}

#[test]
fn numbers_come_back_bit_by_bit_and_short() {
    let seed = 7;
    let mut rng = fastrand::Rng::with_seed(seed);
    let exact = [0.1, 1.0, 1e5, 1e-3, 16_777_216.0 / 1000.0, 0.3, 99_999.99, 5e-3_f32.next_up()];
    let random = std::iter::repeat_with(|| 10_f32.powf(rng.f32() * 8.0 - 3.0)).take(20_000);
    for radius in exact.into_iter().chain(random) {
        let text = Scene::new(point([0., 0., -radius], radius)).to_text().expect("legal");
        let back = read(&text).expect("legal");
        let Shape::Primitive(Primitive::Point(point)) = &back.root.shape else { panic!("it is a point") };
        assert_eq!(point.radius.to_bits(), radius.to_bits(), "seed {seed}: {radius:?} in {text}");
        assert_eq!(point.center.z.to_bits(), (-radius).to_bits(), "seed {seed}: {radius:?} in {text}");
    }
    let text = Scene::new(point([0.1, 2.0, -3e-5], 1e5)).to_text().expect("legal");
    assert!(text.contains(r#""center": [0.1, 2, -3e-5], "radius": 100000"#), "{text}");
}

#[test]
fn a_byte_order_mark_and_any_white_space_are_welcome() {
    let text = format!("\u{feff}\r\n\t{}\r\n", file(r#"{"type": "union", "children": []}"#));
    assert!(read(&text).is_ok());
    assert!(Scene::read(text.as_bytes(), &mut NoSources).is_ok());
}

/// A box for every file name but one, and how often it was asked.
struct Boxes {
    asked: Vec<String>,
}

impl SceneSources for Boxes {
    fn template(&mut self, _: &Drawing, _: Option<f32>) -> Result<Arc<Template>, String> {
        Err("there are no drawings here".into())
    }

    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        self.asked.push(reference.file.clone());
        if reference.file == "gone.stl" {
            return Err("there is no such file".into());
        }
        let mesh = mesh::shapes::cuboid(Vec3::ZERO, Vec3::splat(10.0));
        Ok(Arc::new(MeshDistance::new(&mesh).expect("a box is a fine mesh")))
    }
}

#[test]
fn each_mesh_file_is_asked_for_once_and_missing_ones_are_told() {
    let node = |name: &str, falloff: f32| {
        format!(
            r#"{{"type": "mesh", "file": "{name}", "sha256": "{}", "falloff": {falloff}}}"#,
            "0a".repeat(32)
        )
    };
    let text = |last: &str| {
        let nodes = [node("a.stl", 2.0), node("b.stl", 2.0), node("a.stl", 3.5), last.into()];
        file(&format!(r#"{{"type": "union", "children": [{}]}}"#, nodes.join(", ")))
    };
    let mut boxes = Boxes { asked: vec![] };
    let legal = text(&node("b.stl", 2.0));
    let scene = Scene::from_bytes(legal.as_bytes(), &mut boxes).expect("legal");
    assert_eq!(boxes.asked, ["a.stl", "b.stl"]);
    let written = scene.to_text().expect("legal");
    let back = Scene::from_bytes(written.as_bytes(), &mut boxes).expect("legal");
    assert_eq!(back, scene);

    let missing = text(&node("gone.stl", 2.0));
    let error = Scene::from_bytes(missing.as_bytes(), &mut boxes).expect_err("it is gone").to_string();
    assert!(error.ends_with("node /3: mesh `gone.stl`: there is no such file"), "{error}");
    let bad_hash = file(r#"{"type": "mesh", "file": "a.stl", "sha256": "0A"}"#);
    let error = Scene::from_bytes(bad_hash.as_bytes(), &mut boxes).expect_err("a short hash").to_string();
    assert!(error.ends_with("node /: `sha256` is 0A, not 64 lower-case hexadecimal digits"), "{error}");
}

/// Solves drawings as polygons and counts them.
struct Counted {
    solved: usize,
}

impl SceneSources for Counted {
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        PolygonSources.mesh(reference)
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        self.solved += 1;
        PolygonSources.template(drawing, falloff)
    }
}

#[test]
fn equal_drawings_are_solved_once_for_each_falloff_and_shared() {
    let node = |rest: &str, x: f32| {
        format!(r#"{{{rest}, "drawing": {{"strokes": [{{"points": [[0, 0], [{x}, 0], [0, 5]]}}]}}}}"#)
    };
    let text = file(&format!(
        r#"{{"type": "union", "children": [{}, {}, {}, {}]}}"#,
        node(r#""type": "inflation""#, 5.0),
        node(r#""type": "sweep", "length": 4"#, 5.0),
        node(r#""type": "sweep", "length": 4, "falloff": 2"#, 5.0),
        node(r#""type": "revolution""#, 6.0),
    ));
    let mut counted = Counted { solved: 0 };
    let scene = Scene::from_bytes(text.as_bytes(), &mut counted).expect("legal");
    assert_eq!(counted.solved, 3);
    let mut children = scene.root.children().iter();
    let mut next = || children.next().map(|child| child.shape.clone());
    let (Some(Shape::Primitive(Primitive::Inflation(a))), Some(Shape::Primitive(Primitive::LinearSweep(b)))) =
        (next(), next())
    else {
        panic!("an inflation and a sweep")
    };
    assert!(Arc::ptr_eq(&a.template.0, &b.template.0) && Arc::ptr_eq(&a.drawing, &b.drawing));
    let Err(error) = Scene::from_bytes(text.as_bytes(), &mut NoSources) else { panic!("nothing solves it") };
    assert!(error.to_string().ends_with("node /0: the drawing: drawings are not read here"), "{error}");
}
