//! What the document promises.

use super::{
    Command, CommandError, DEFAULT_OLDER_VERSIONS, Document, HISTORY_LIMIT, NewShape, write_atomically,
};
use crate::build::{Build, point, union};
use crate::node::{Color, Node, NodePath, NodeRef, Shape};
use crate::operator::{Operator, Sharpness};
use crate::primitive::{Point, Primitive};
use crate::random::RandomTree;
use crate::scene::Scene;
use crate::support_free::{BrushKind, BrushStroke, SupportFree};
use crate::warp::{Transform, Warp};
use fastrand::Rng;
use glam::Vec3;
use std::fs;
use std::path::Path;
use std::sync::Arc;

fn path(text: &str) -> NodePath {
    text.parse().expect("a path")
}

fn document() -> Document {
    let named = |name: &str| point([0., 0., 0.], 1.).named(name);
    let group = union([named("b"), named("c"), named("d")]).named("group");
    let root = union([named("a"), group, named("e").translate([1., 0., 0.])]);
    Document::new(Scene::new(root)).expect("legal")
}

/// The tree as text: names, with children in brackets.
fn outline(node: &Node) -> String {
    let name = node.name.clone().unwrap_or_else(|| node.type_name().into());
    if node.children().is_empty() {
        return name;
    }
    let children: Vec<String> = node.children().iter().map(|child| outline(child)).collect();
    format!("{name}({})", children.join(" "))
}

fn after(command: Command) -> Result<String, CommandError> {
    let mut document = document();
    document.apply(command)?;
    Ok(outline(&document.scene().root))
}

#[test]
fn commands_do_what_they_say() {
    let new = || NodeRef::from(point([0., 0., 0.], 1.).named("new"));
    let cases = [
        (
            Command::Insert { parent: path("/1"), index: 3, node: new() },
            "union(a group(b c d new) transform(e))",
        ),
        (
            Command::Insert { parent: path("/"), index: 0, node: new() },
            "union(new a group(b c d) transform(e))",
        ),
        (Command::Remove { path: path("/1/1") }, "union(a group(b d) transform(e))"),
        (Command::Replace { path: path("/2/0"), node: new() }, "union(a group(b c d) transform(new))"),
        (Command::Replace { path: path("/"), node: new() }, "new"),
        (
            Command::WrapInOperator { path: path("/0"), operator: Operator::Sum },
            "union(sum(a) group(b c d) transform(e))",
        ),
        (
            Command::WrapInWarp { path: path("/"), warp: Warp::Transform(Transform::default()) },
            "transform(union(a group(b c d) transform(e)))",
        ),
        (Command::Unwrap { path: path("/2") }, "union(a group(b c d) e)"),
        (
            Command::SetShape { path: path("/"), shape: NewShape::Operator(Operator::Sum) },
            "sum(a group(b c d) transform(e))",
        ),
        (
            Command::SetName { path: path("/1/2"), name: Some("x".into()) },
            "union(a group(b c x) transform(e))",
        ),
    ];
    for (command, expected) in cases {
        assert_eq!(after(command.clone()).as_deref(), Ok(expected), "{command:?}");
    }
}

#[test]
fn a_moved_node_stands_in_front_of_the_child_that_was_named() {
    let cases = [
        ("/0", "/1", 0, "union(group(a b c d) transform(e))"),
        ("/0", "/1", 3, "union(group(b c d a) transform(e))"),
        ("/1/0", "/", 0, "union(b a group(c d) transform(e))"),
        ("/1/0", "/", 3, "union(a group(c d) transform(e) b)"),
        ("/1/0", "/1", 3, "union(a group(c d b) transform(e))"),
        ("/1/2", "/1", 0, "union(a group(d b c) transform(e))"),
        ("/1/0", "/1", 1, "union(a group(b c d) transform(e))"),
        ("/0", "/", 2, "union(group(b c d) a transform(e))"),
    ];
    for (from, parent, index, expected) in cases {
        let command = Command::Move { from: path(from), parent: path(parent), index };
        assert_eq!(after(command).as_deref(), Ok(expected), "{from} to {parent} at {index}");
    }
}

#[test]
fn illegal_commands_are_told_and_change_nothing() {
    let new = NodeRef::from(point([0., 0., 0.], 1.));
    let bad = NodeRef::from(point([0., 0., 0.], -1.));
    let mut deep = new.clone();
    for _ in 0..254 {
        deep = deep.translate([1., 0., 0.]).into();
    }
    let ball = |radius| Primitive::Point(Point { center: Vec3::ZERO, radius, falloff: None });
    let cases = [
        (Command::Remove { path: path("/7") }, "there is no node at /7"),
        (Command::Remove { path: path("/0/0") }, "there is no node at /0/0"),
        (Command::Remove { path: path("/") }, "/ is the root or the only child that its parent can have"),
        (
            Command::Remove { path: path("/2/0") },
            "/2/0 is the root or the only child that its parent can have",
        ),
        (
            Command::Insert { parent: path("/0"), index: 0, node: new.clone() },
            "the point at /0 cannot have further children",
        ),
        (
            Command::Insert { parent: path("/2"), index: 0, node: new.clone() },
            "the transform at /2 cannot have further children",
        ),
        (
            Command::Insert { parent: path("/1"), index: 4, node: new },
            "place 4 is beyond the 3 children of /1",
        ),
        (
            Command::Insert { parent: path("/1"), index: 0, node: bad },
            "not possible: node /1/0: `radius` is -1.0, not 0.001 to 100000 mm",
        ),
        (Command::Insert { parent: path("/1"), index: 0, node: deep }, "not possible: node /1/0/0/0"),
        (
            Command::Move { from: path("/1"), parent: path("/1"), index: 0 },
            "/1 cannot be moved to /1, which is part of it",
        ),
        (Command::Move { from: path("/"), parent: path("/1"), index: 0 }, "/ cannot be moved to /1"),
        (
            Command::Move { from: path("/0"), parent: path("/1"), index: 4 },
            "place 4 is beyond the 3 children",
        ),
        (
            Command::Move { from: path("/2/0"), parent: path("/1"), index: 0 },
            "/2/0 is the root or the only child that its parent can have",
        ),
        (Command::Move { from: path("/0"), parent: path("/2"), index: 0 }, "the transform at /1 cannot have"),
        (Command::Unwrap { path: path("/1") }, "the node at /1 has 3 children, so it cannot be unwrapped"),
        (
            Command::SetShape { path: path("/1"), shape: NewShape::Primitive(ball(1.0)) },
            "the union at /1 cannot become a point; replace it instead",
        ),
        (
            Command::SetShape { path: path("/0"), shape: NewShape::Primitive(ball(f32::NAN)) },
            "not possible: node /0: `radius` is NaN",
        ),
        (
            Command::AddStroke { path: path("/1"), stroke: stroke(1.0) },
            "the union at /1 has no brush strokes; only a support_free node has",
        ),
        (Command::RemoveStroke { path: path("/9"), index: 0 }, "there is no node at /9"),
    ];
    for (command, expected) in cases {
        let mut document = document();
        let before = document.scene().clone();
        let error = document.apply(command.clone()).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error} instead of {expected}");
        assert!(Arc::ptr_eq(&document.scene().root, &before.root), "{command:?}");
        assert!(document.undo().is_none(), "{command:?}");
    }
}

fn stroke(radius: f32) -> Arc<BrushStroke> {
    Arc::new(BrushStroke::new(BrushKind::RemoveTrim, radius, [[0., 0., 5.]]))
}

#[test]
fn brush_strokes_come_and_go_in_a_support_free_node_and_undo_gives_back_the_same_node() {
    let child: NodeRef = point([0., 0., 5.], 5.).into();
    let root = child.clone().support_free(SupportFree::default());
    let mut document = Document::new(Scene::new(root)).expect("legal");
    let at = path("/");
    let first = document.scene().clone();
    document.apply(Command::AddStroke { path: at.clone(), stroke: stroke(1.0) }).expect("there is a node");
    document.apply(Command::AddStroke { path: at.clone(), stroke: stroke(2.0) }).expect("there is a node");
    let radii = |scene: &Scene| match &scene.root.shape {
        Shape::SupportFree(rule, _) => rule.strokes.iter().map(|s| s.radius).collect::<Vec<_>>(),
        _ => panic!("it is still a support-free node"),
    };
    assert_eq!(radii(document.scene()), [1.0, 2.0]);
    assert!(Arc::ptr_eq(&document.scene().root.children()[0], &child), "the child is another one");
    let text = document.scene().to_text().expect("legal");
    document.apply(Command::RemoveStroke { path: at.clone(), index: 0 }).expect("there is one");
    assert_eq!(radii(document.scene()), [2.0]);
    let error = document.apply(Command::RemoveStroke { path: at.clone(), index: 1 }).expect_err("only one");
    assert_eq!(error.to_string(), "there is no stroke 1 among the 1 of /; they count from 0");
    let error = document.apply(Command::AddStroke { path: at, stroke: stroke(-1.0) }).expect_err("illegal");
    assert_eq!(error.to_string(), "not possible: node /: `strokes[1].radius` is -1.0, not 0.05 to 100 mm");
    document.undo();
    assert_eq!(document.scene().to_text().expect("legal"), text);
    document.undo();
    document.undo();
    assert!(Arc::ptr_eq(&document.scene().root, &first.root));
}

#[test]
fn an_edit_shares_everything_that_it_did_not_touch() {
    let mut document = document();
    let change = document.apply(Command::SetMuted { path: path("/1/1"), muted: true }).expect("legal");
    let [before, after] = [&change.before, &change.after];
    for same in ["/0", "/1/0", "/1/2", "/2"] {
        let at = |root| path(same).find(root).expect("still there").clone();
        assert!(Arc::ptr_eq(&at(before), &at(after)), "{same}");
    }
    assert!(path("/1/1").find(after).expect("still there").muted);
}

#[test]
fn only_the_named_place_of_a_shared_node_changes() {
    let leg = point([0., 0., 0.], 1.).into_shared();
    let mut document = Document::new(Scene::new(union([leg.clone(), leg.clone()]))).expect("legal");
    document.apply(Command::SetMuted { path: path("/0"), muted: true }).expect("legal");
    let children = document.scene().root.children();
    assert!(children[0].muted && Arc::ptr_eq(&children[1], &leg));
}

#[test]
fn commands_that_change_nothing_leave_no_step() {
    let mut document = document();
    let same = document.scene().root.children()[0].clone();
    for command in [
        Command::SetMuted { path: path("/0"), muted: false },
        Command::SetName { path: path("/0"), name: Some("a".into()) },
        Command::SetColor { path: path("/1"), color: None },
        Command::SetShape { path: path("/1"), shape: NewShape::Operator(Operator::Union) },
        Command::SetTitle { title: None },
        Command::Replace { path: path("/0"), node: same },
        Command::Move { from: path("/0"), parent: path("/"), index: 1 },
    ] {
        let change = document.apply(command.clone()).expect("legal");
        assert!(Arc::ptr_eq(&change.before, &change.after), "{command:?}");
        assert_eq!(document.undo_names().count(), 0, "{command:?}");
    }
}

#[test]
fn commands_done_together_are_one_step_and_all_or_none_is_done() {
    let mut document = document();
    let before = document.scene().root.clone();
    let together = Command::Together(vec![
        Command::Remove { path: path("/1/2") },
        Command::Move { from: path("/1/0"), parent: path("/"), index: 0 },
        // By now the group is one place further on.
        Command::SetName { path: path("/2"), name: Some("rest".into()) },
    ]);
    document.apply(together).expect("all can be done");
    assert_eq!(outline(&document.scene().root), "union(b a rest(c) transform(e))");
    assert_eq!(document.undo_names().collect::<Vec<_>>(), ["Remove d and 2 more"]);
    document.undo();
    assert!(NodeRef::ptr_eq(&document.scene().root, &before));
    let half =
        Command::Together(vec![Command::Remove { path: path("/0") }, Command::Remove { path: path("/7") }]);
    assert_eq!(document.apply(half).map(|_| ()), Err(CommandError::NoSuchNode(path("/7"))));
    assert!(NodeRef::ptr_eq(&document.scene().root, &before));
}

#[test]
fn steps_have_names_for_the_history() {
    let mut document = document();
    document.apply(Command::SetMuted { path: path("/0"), muted: true }).expect("legal");
    document.apply(Command::SetTitle { title: Some("T".into()) }).expect("legal");
    document.apply(Command::Remove { path: path("/1") }).expect("legal");
    assert_eq!(document.undo_names().collect::<Vec<_>>(), ["Remove group", "Change title", "Mute a"]);
    assert_eq!(document.undo().map(|change| change.name).as_deref(), Some("Remove group"));
    assert_eq!(document.undo().map(|change| change.name).as_deref(), Some("Change title"));
    assert_eq!(document.scene().title, None);
    assert_eq!(document.redo_names().collect::<Vec<_>>(), ["Change title", "Remove group"]);
    assert_eq!(document.redo().map(|change| change.name).as_deref(), Some("Change title"));
    document.apply(Command::SetMuted { path: path("/0"), muted: false }).expect("legal");
    assert!(document.redo().is_none(), "a new command forgets what was undone");
}

#[test]
fn what_a_hand_does_to_the_place_of_a_part_is_named_by_that() {
    let mut document = document();
    let place = |x: f32, turned: f32, size: f32| Transform {
        translate: Vec3::new(x, 0.0, 0.0),
        rotate_degrees: Vec3::new(0.0, 0.0, turned),
        scale: Vec3::splat(size),
    };
    let wrap = Command::WrapInWarp { path: path("/0"), warp: Warp::Transform(place(2.0, 0.0, 1.0)) };
    document.apply(wrap).expect("legal");
    for (x, turned, size) in [(3.0, 0.0, 1.0), (4.0, 15.0, 1.0), (5.0, 15.0, 2.0)] {
        let shape = NewShape::Warp(Warp::Transform(place(x, turned, size)));
        document.apply(Command::SetShape { path: path("/0"), shape }).expect("legal");
    }
    assert_eq!(document.undo_names().collect::<Vec<_>>(), ["Size a", "Turn a", "Move a", "Move a"]);
}

#[test]
fn a_node_that_joins_another_is_named_by_what_it_does() {
    for (joined, name) in [
        (Operator::Union, "Add lid"),
        (Operator::Difference, "Cut lid out"),
        (Operator::Blend(Sharpness::DEFAULT), "Blend with lid"),
    ] {
        let mut document = document();
        let lid: NodeRef = point([0., 0., 9.], 2.).named("lid").into();
        let root = document.scene().root.clone();
        let both = Node::new(Shape::Operator(joined, vec![root, lid.clone()])).into();
        document.apply(Command::Replace { path: path("/"), node: both }).expect("legal");
        document
            .apply(Command::Replace { path: path("/1"), node: lid.translate([1., 0., 0.]).into() })
            .expect("legal");
        assert_eq!(document.undo_names().collect::<Vec<_>>(), ["Change lid", name]);
    }
}

/// Any command on a tree, legal or not.
fn random_command(rng: &mut Rng, trees: &mut RandomTree, root: &NodeRef) -> Command {
    let mut at = || {
        let (mut node, mut path) = (root, NodePath::default());
        while !node.children().is_empty() && rng.u32(..4) != 0 {
            let index = rng.usize(..node.children().len());
            node = &node.children()[index];
            path = path.child(index);
        }
        path
    };
    let (path, parent) = (at(), at());
    let index = rng.usize(..4);
    match rng.u32(..18) {
        0..3 => Command::Insert { parent, index, node: trees.leaf().into() },
        3 => Command::Remove { path },
        4 => Command::Replace { path, node: trees.leaf().into() },
        5..7 => Command::Move { from: path, parent, index },
        7 => Command::WrapInOperator { path, operator: trees.operator() },
        8 => Command::WrapInWarp { path, warp: trees.warp() },
        9 => Command::Unwrap { path },
        10 => Command::SetShape { path, shape: NewShape::Primitive(trees.primitive()) },
        11 => Command::SetShape { path, shape: NewShape::Operator(trees.operator()) },
        12 => Command::SetName { path, name: rng.bool().then(|| format!("n{}", rng.u32(..9))) },
        13 => Command::WrapInSupportFree { path, rule: trees.rule() },
        14 | 15 => Command::AddStroke { path, stroke: Arc::new(trees.stroke()) },
        16 => Command::RemoveStroke { path, index: 0 },
        _ => Command::SetColor { path, color: Some(Color([rng.u8(..), 0, 0])) },
    }
}

#[test]
fn a_thousand_random_commands_are_undone_and_redone_to_the_very_same_nodes() {
    for seed in 0..4 {
        let (mut rng, mut trees) = (Rng::with_seed(seed), RandomTree::new(seed));
        let mut document = Document::new(Scene::new(trees.tree())).expect("random trees are legal");
        let mut states = vec![(document.scene().clone(), document.scene().to_text().expect("legal"))];
        let mut refused = 0;
        while states.len() <= 1000 {
            let command = random_command(&mut rng, &mut trees, &document.scene().root);
            let (last, text) = states.last().expect("never empty");
            match document.apply(command) {
                Ok(change) if Arc::ptr_eq(&change.before, &change.after) => {}
                Ok(change) => {
                    assert!(Arc::ptr_eq(&change.before, &last.root), "seed {seed}");
                    states.push((document.scene().clone(), document.scene().to_text().expect("legal")));
                }
                Err(_) => {
                    refused += 1;
                    assert_eq!(document.scene().to_text().as_ref(), Ok(text), "seed {seed}");
                }
            }
        }
        assert!(refused > 0, "seed {seed}: no illegal command was tried");
        for (scene, text) in states.iter().rev() {
            assert!(Arc::ptr_eq(&document.scene().root, &scene.root), "seed {seed}");
            assert_eq!(document.scene().to_text().as_ref(), Ok(text), "seed {seed}");
            document.undo();
        }
        assert!(document.undo().is_none());
        for (scene, _) in &states {
            assert!(Arc::ptr_eq(&document.scene().root, &scene.root), "seed {seed}");
            document.redo();
        }
        assert!(document.redo().is_none());
    }
}

#[test]
fn the_history_forgets_its_oldest_steps_first() {
    let mut document = document();
    for i in 0..HISTORY_LIMIT + 5 {
        document.apply(Command::SetMuted { path: path("/0"), muted: i % 2 == 0 }).expect("legal");
    }
    assert_eq!(std::iter::from_fn(|| document.undo()).count(), HISTORY_LIMIT);
}

/// The names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn saving_keeps_the_three_last_versions_and_no_temporary_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.trullo");
    let mut document = document();
    let mut texts = Vec::new();
    for i in 0..6 {
        document.apply(Command::SetTitle { title: Some(format!("version {i}")) }).expect("legal");
        document.save(&file).expect("the folder is writable");
        texts.insert(0, document.scene().to_text().expect("legal"));
    }
    let expected = ["scene.trullo", "scene.trullo~1", "scene.trullo~2", "scene.trullo~3"];
    assert_eq!(names(folder.path()), expected);
    assert_eq!(expected.len(), DEFAULT_OLDER_VERSIONS + 1);
    for (name, text) in expected.iter().zip(&texts) {
        assert_eq!(&fs::read_to_string(folder.path().join(name)).expect("saved"), text, "{name}");
    }
}

#[test]
fn a_save_that_fails_leaves_all_as_it_was() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let target = folder.path().join("taken");
    fs::create_dir(&target).expect("writable");
    let error = write_atomically(&target, b"new", 3).expect_err("it is a folder").to_string();
    assert!(
        error.ends_with("taken` is not a file, so it cannot be written over; choose another name"),
        "{error}"
    );
    let error = write_atomically(&folder.path().join("none/scene.trullo"), b"new", 3).expect_err("no folder");
    assert!(error.to_string().contains("creating a file in its folder"), "{error}");
    let error = write_atomically(&folder.path().join("x".repeat(300)), b"new", 3).expect_err("a long name");
    assert!(error.to_string().contains("cannot be saved"), "{error}");
    assert_eq!(names(folder.path()), ["taken"]);

    // An older version that is in the way and cannot be removed: the file itself must stay.
    let file = folder.path().join("scene.trullo");
    write_atomically(&file, b"old", 0).expect("writable");
    let older = folder.path().join("scene.trullo~1");
    fs::create_dir(&older).expect("writable");
    let error = write_atomically(&file, b"new", 1).expect_err("a folder is in the way").to_string();
    assert!(error.contains("keeping the older version"), "{error}");
    assert_eq!(fs::read(&file).expect("still there"), b"old");
    assert_eq!(names(folder.path()), ["scene.trullo", "scene.trullo~1", "taken"]);
}

#[test]
#[cfg(unix)]
fn a_folder_that_cannot_be_written_is_told_unless_the_user_may_do_anything() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.trullo");
    write_atomically(&file, b"old", 3).expect("writable");
    let allow =
        |mode| fs::set_permissions(folder.path(), fs::Permissions::from_mode(mode)).expect("our folder");
    allow(0o555);
    let result = write_atomically(&file, b"new", 3);
    allow(0o755);
    let content = fs::read(&file).expect("still there");
    match result {
        Ok(()) => assert_eq!(content, b"new", "this user is above permissions"),
        Err(error) => {
            assert!(error.to_string().contains("creating a file in its folder"), "{error}");
            assert_eq!((content.as_slice(), names(folder.path()).len()), (&b"old"[..], 1));
        }
    }
}

#[test]
#[cfg(unix)]
fn permissions_and_links_survive_a_save() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (file, link) = (folder.path().join("scene.trullo"), folder.path().join("link"));
    write_atomically(&file, b"1", 3).expect("writable");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).expect("our file");
    std::os::unix::fs::symlink(&file, &link).expect("writable");
    write_atomically(&link, b"2", 3).expect("writable");
    assert!(fs::symlink_metadata(&link).expect("still there").is_symlink());
    assert_eq!(fs::read(&file).expect("still there"), b"2");
    assert_eq!(fs::metadata(&file).expect("still there").permissions().mode() & 0o777, 0o640);
}

#[test]
fn a_document_refuses_an_illegal_scene() {
    let bad = Node::new(Shape::Operator(Operator::Union, vec![point([0., 0., 0.], 0.).into()]));
    assert!(Document::new(Scene::new(bad)).is_err());
}
