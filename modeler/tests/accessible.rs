//! Every control on every screen has a name, and can be reached with the keyboard alone.

mod common;

use blobtree::NodePath;
use common::*;
use egui::accessibility::is_input;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::collections::BTreeMap;

/// The controls that can be used now: what they are called, by what egui knows them by.
fn controls(screen: &Screen) -> BTreeMap<u64, String> {
    let nodes = screen.root().children_recursive().map(|node| node.accesskit_node());
    let usable = nodes.filter(|node| is_input(node.role()) && !node.is_hidden() && !node.is_disabled());
    let named = |node: egui_kittest::kittest::AccessKitNode<'_>| {
        let name = node.label().unwrap_or_default();
        (node.locate().0.0, format!("{:?} {name:?}", node.role()))
    };
    usable.map(named).collect()
}

/// What Tab comes by until it has been everywhere.
fn reached(screen: &mut Screen, steps: usize) -> Vec<u64> {
    (0..steps)
        .filter_map(|_| {
            screen.key_press(Key::Tab);
            screen.run_steps(1);
            screen.ctx.memory(|memory| memory.focused()).map(|id| id.value())
        })
        .collect()
}

/// All controls of a screen have names, and Tab comes by all of them.
fn check(screen: &mut Screen, what: &str) {
    let unnamed = screen.unnamed_widgets();
    assert!(unnamed.is_empty(), "{what}: without a name are {unnamed:#?}");
    let all = controls(screen);
    assert!(all.len() > 5, "{what}: {all:?}");
    let reached = reached(screen, all.len() + 30);
    let missed: Vec<&String> =
        all.iter().filter(|(id, _)| !reached.contains(id)).map(|(_, name)| name).collect();
    assert!(missed.is_empty(), "{what}: Tab does not come by {missed:#?}");
    screen.ctx.memory_mut(|memory| memory.stop_text_input());
    screen.run_steps(1);
}

#[test]
fn the_empty_page_and_the_lessons_can_be_used_without_a_hand_on_a_mouse() {
    let mut screen = screen(None);
    check(&mut screen, "the empty page");
    press(&mut screen, "Show me how");
    check(&mut screen, "a lesson");
}

#[test]
fn suggestions_can_be_used_without_a_hand_on_a_mouse() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    check(&mut screen, "suggestions");
    screen.get_by_label("Make thick").focus();
    screen.run_steps(1);
    screen.key_press(Key::Space);
    settle(&mut screen);
    assert_eq!(screen.state().bench.scene().root.children()[0].type_name(), "sweep");
}

#[test]
fn the_parts_and_their_numbers_can_be_used_without_a_hand_on_a_mouse() {
    let mut screen = screen_with_snowman();
    check(&mut screen, "a scene");
    let mut waiting = vec![NodePath::default()];
    let mut kinds = Vec::new();
    while let Some(path) = waiting.pop() {
        let node = path.find(&screen.state().bench.scene().root).expect("it is there").clone();
        waiting.extend((0..node.children().len()).map(|child| path.child(child)));
        if kinds.contains(&node.type_name()) {
            continue;
        }
        kinds.push(node.type_name());
        screen.state_mut().select(Some(path));
        settle(&mut screen);
        check(&mut screen, node.type_name());
    }
    assert!(kinds.len() > 3, "{kinds:?}");
    screen.state_mut().select_all([NodePath(vec![0, 0]), NodePath(vec![0, 1])]);
    settle(&mut screen);
    check(&mut screen, "several parts");
}

#[test]
fn menus_open_and_everything_in_them_is_reached_by_the_keyboard() {
    let mut screen = screen_with_snowman();
    screen.state_mut().select(Some(NodePath(vec![0])));
    settle(&mut screen);
    for (menu, item) in
        [("File", "Examples…"), ("Edit", "Put on the ground"), ("View", "Seams between parts")]
    {
        screen.get_by_label(menu).focus();
        screen.run_steps(1);
        screen.key_press(Key::Space);
        screen.run_steps(3);
        assert!(screen.query_by_label(item).is_some(), "{menu} does not open");
        check(&mut screen, menu);
        screen.key_press(Key::Escape);
        screen.run_steps(3);
        assert!(screen.query_by_label(item).is_none(), "{menu} does not close");
    }
}

#[test]
fn questions_and_the_lens_can_be_used_without_a_hand_on_a_mouse() {
    let mut screen = screen_with_snowman();
    let keys = [
        (Key::O, Modifiers::COMMAND, "Open"),
        (Key::S, Modifiers::COMMAND, "Save"),
        (Key::E, Modifiers::COMMAND, "Export for printing"),
        (Key::Questionmark, Modifiers::NONE, "Keys and gestures"),
    ];
    for (key, modifiers, what) in keys {
        screen.key_press_modifiers(modifiers, key);
        settle(&mut screen);
        assert!(screen.query_all_by_label(what).next().is_some(), "{what} is not asked");
        check(&mut screen, what);
        screen.state_mut().dialog = None;
        settle(&mut screen);
    }
    screen.state_mut().toggle_lens();
    settle(&mut screen);
    check(&mut screen, "the lens");
}

#[test]
fn a_part_is_chosen_moved_and_copied_with_the_keyboard_alone() {
    let mut screen = screen_with_snowman();
    let row = screen.get_all_by_role(egui::accesskit::Role::Button).count();
    assert!(row > 10);
    screen.get_by_label("nose").focus();
    screen.run_steps(1);
    screen.key_press(Key::Space);
    settle(&mut screen);
    let before = screen.state().selected_box().expect("the nose");
    // Keys alone belong to the control that has the focus, until Escape lets go of it.
    screen.key_press(Key::Escape);
    settle(&mut screen);
    assert!(screen.state().selected_box().is_some(), "Escape only leaves the row");
    screen.key_press(Key::ArrowRight);
    settle(&mut screen);
    let after = screen.state().selected_box().expect("the nose");
    assert!((after.center() - before.center()).length() > 0.5, "{before:?} {after:?}");
    screen.key_press_modifiers(Modifiers::COMMAND, Key::D);
    settle(&mut screen);
    assert_eq!(screen.state().bench.document().undo_names().count(), 2);
}

#[test]
fn the_help_tells_of_every_key_once() {
    let mut screen = screen(None);
    screen.key_press(Key::Questionmark);
    settle(&mut screen);
    for binding in &modeler::keys::BINDINGS {
        assert!(screen.query_all_by_label(binding.help).next().is_some(), "{} is missing", binding.help);
        let same = |other: &&modeler::keys::Binding| other.shortcut == binding.shortcut;
        assert_eq!(modeler::keys::BINDINGS.iter().filter(same).count(), 1, "{}", binding.help);
    }
    for tool in modeler::settings::Tool::ALL {
        let has_key =
            modeler::keys::BINDINGS.iter().any(|binding| binding.shortcut.logical_key == tool.key());
        assert!(has_key, "{} has no key", tool.name());
    }
}
