//! Dragging in the tree, by the names that are on the screen.

mod common;

use blobtree::build::{Build as _, point, union};
use blobtree::{Node, NodePath};
use common::*;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

/// Balls with names, some in a group.
fn balls() -> Screen {
    let mut screen = screen(None);
    let ball = |x: f32, name: &str| point([x, 0., 9.], 5.).named(name);
    let group = union([ball(20., "four"), ball(30., "five")]).named("group");
    put(
        &mut screen,
        union([ball(-20., "one"), ball(-10., "two"), ball(0., "three"), ball(10., "rest"), group]),
    );
    screen
}

fn outline(node: &Node) -> String {
    let below: Vec<String> = node.children().iter().map(|child| outline(child)).collect();
    match (&node.name, below.is_empty()) {
        (Some(name), true) => name.clone(),
        (name, _) => format!("{}({})", name.clone().unwrap_or_default(), below.join(" ")),
    }
}

fn drag_onto(screen: &mut Screen, from: &str, to: &str) {
    let [from, to] = [from, to].map(|name| screen.get_by_role_and_label(Role::Button, name).rect().center());
    drag(screen, from, to - from);
}

#[test]
fn all_selected_parts_are_dragged_in_one_step_and_others_alone() {
    let mut screen = balls();
    screen.state_mut().select_all([NodePath(vec![0]), NodePath(vec![2])]);
    settle(&mut screen);
    drag_onto(&mut screen, "three", "group");
    let after = |screen: &Screen| outline(&screen.state().bench.scene().root);
    assert_eq!(after(&screen), "(two rest group(four five one three))");
    assert_eq!(screen.state().bench.document().undo_names().count(), 1);
    assert_eq!(screen.state().bench.selection(), [NodePath(vec![2, 2]), NodePath(vec![2, 3])]);
    // The last child of a group goes to its end with others.
    screen.state_mut().select_all([NodePath(vec![0]), NodePath(vec![2, 3])]);
    settle(&mut screen);
    drag_onto(&mut screen, "three", "group");
    assert_eq!(after(&screen), "(rest group(four five one two three))");
    screen.state_mut().undo();
    screen.state_mut().select(None);
    settle(&mut screen);
    // What is not selected moves alone.
    drag_onto(&mut screen, "two", "four");
    assert_eq!(after(&screen), "(rest group(four two five one three))");
    screen.state_mut().undo();
    screen.state_mut().undo();
    assert_eq!(after(&screen), "(one two three rest group(four five))");
}

#[test]
fn nodes_that_show_in_the_tree_have_pictures() {
    let mut screen = balls();
    // The root, four balls, and the group with two.
    let drawn = |screen: &Screen| screen.state().pictures_in_tree();
    assert_eq!(drawn(&screen), 8);
    press(&mut screen, "Panels");
    assert_eq!(drawn(&screen), 0);
    press(&mut screen, "Panels");
    assert_eq!(drawn(&screen), 8);
}

#[test]
fn what_is_dropped_on_itself_or_below_itself_stays() {
    let mut screen = balls();
    let before = outline(&screen.state().bench.scene().root);
    screen.state_mut().select_all([NodePath(vec![0]), NodePath(vec![4])]);
    settle(&mut screen);
    drag_onto(&mut screen, "one", "group");
    drag_onto(&mut screen, "group", "four");
    assert_eq!(outline(&screen.state().bench.scene().root), before);
}
