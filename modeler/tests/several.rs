//! Several parts at once: selected, moved, copied, put together and taken away.

mod common;

use blobtree::build::{Build as _, point, union};
use blobtree::{Aabb, NodePath, Shape};
use common::*;
use egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use glam::Vec3;

const PLACES: [[f32; 3]; 3] = [[-30., 0., 20.], [0., 0., 20.], [30., 0., 20.]];

/// Three balls beside each other.
fn balls() -> Screen {
    let mut screen = screen(None);
    let ball = |i: usize, name: &str| point(PLACES[i], 10.).named(name);
    put(&mut screen, union([ball(0, "Left"), ball(1, "Middle"), ball(2, "Right")]));
    screen.state_mut().look_from(modeler::camera::Side::Front);
    settle(&mut screen);
    screen
}

/// Taps with a key held.
fn tap(screen: &mut Screen, at: Pos2, modifiers: Modifiers) {
    screen.event(egui::Event::ModifiersChanged(modifiers));
    screen.event(egui::Event::PointerMoved(at));
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        screen.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
    }
    screen.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    settle(screen);
}

fn paths(texts: &[&str]) -> Vec<NodePath> {
    texts.iter().map(|text| text.parse().expect("a path")).collect()
}

fn selected(screen: &Screen) -> Vec<NodePath> {
    screen.state().bench.selection().to_vec()
}

fn bounds(screen: &Screen) -> Aabb {
    screen.state().solid().expect("a solid").bounds
}

/// The names of the parts below the root.
fn names(screen: &Screen) -> Vec<String> {
    let root = &screen.state().bench.scene().root;
    root.children().iter().map(|node| node.name.clone().unwrap_or_else(|| node.type_name().into())).collect()
}

/// A place of the view with nothing below it.
fn nowhere(screen: &Screen) -> Pos2 {
    screen.get_by_label("Model view").rect().left_bottom() + vec2(300.0, -20.0)
}

#[test]
fn shift_and_taps_select_several_parts_and_a_tap_beside_them_selects_nothing() {
    let mut screen = balls();
    let at = |screen: &Screen, i: usize| seen(screen, PLACES[i]);
    let place = at(&screen, 0);
    tap(&mut screen, place, Modifiers::NONE);
    let place = at(&screen, 2);
    tap(&mut screen, place, Modifiers::SHIFT);
    assert_eq!(selected(&screen), paths(&["/0", "/2"]));
    assert!(screen.query_by_label("2 parts selected").is_some());
    let place = at(&screen, 1);
    tap(&mut screen, place, Modifiers::COMMAND);
    assert_eq!(selected(&screen).len(), 3);
    // The handles are in the middle of all, so the middle ball is let go in the tree.
    let row = screen.get_by_role_and_label(egui::accesskit::Role::Button, "Middle").rect().center();
    tap(&mut screen, row, Modifiers::COMMAND);
    assert_eq!(selected(&screen), paths(&["/0", "/2"]));
    let place = nowhere(&screen);
    tap(&mut screen, place, Modifiers::SHIFT);
    assert_eq!(selected(&screen).len(), 2, "a slip while more is selected");
    tap(&mut screen, place, Modifiers::NONE);
    assert!(selected(&screen).is_empty());
}

#[test]
fn with_a_pen_alone_parts_are_selected_by_striking_through_them() {
    let mut screen = balls();
    press(&mut screen, "Select");
    let (from, to) = (seen(&screen, [-45., 0., 22.]), seen(&screen, [12., 0., 22.]));
    draw(&mut screen, (0..=30).map(|i| from.lerp(to, i as f32 / 30.0)));
    assert_eq!(selected(&screen), paths(&["/0", "/1"]));
    assert!(screen.state().pad.is_empty(), "nothing was drawn");
    let place = seen(&screen, PLACES[2]);
    draw(&mut screen, [place]);
    assert_eq!(selected(&screen).len(), 3);
    draw(&mut screen, [place]);
    assert_eq!(selected(&screen), paths(&["/0", "/1"]));
    screen.key_press(Key::Escape);
    settle(&mut screen);
    assert!(selected(&screen).is_empty());
}

#[test]
fn handles_move_turn_and_size_all_selected_parts_about_their_middle_as_one_step() {
    let mut screen = balls();
    let before = bounds(&screen);
    screen.state_mut().select_all(paths(&["/0", "/2"]));
    settle(&mut screen);
    // The square sizes about the middle of both, which is in the ball between them.
    let middle = seen(&screen, PLACES[1]);
    let square = middle + 0.62 * 84.0 * vec2(1.0, -1.0);
    drag(&mut screen, square, 0.5 * (square - middle));
    let sized = bounds(&screen);
    assert!((sized.size().x / before.size().x - 1.5).abs() < 0.02, "{before:?} to {sized:?}");
    assert!((sized.center() - before.center()).length() < 0.5, "{sized:?}");
    assert_eq!(screen.state().bench.document().undo_names().count(), 1);
    press(&mut screen, "Undo");
    // The ring about y faces the eye: a quarter turn puts one above the other.
    let ring = middle + vec2(-58.0, 0.0);
    let quarter = (0..=10).map(|i| {
        let angle = std::f32::consts::FRAC_PI_2 * i as f32 / 10.0;
        middle + 58.0 * vec2(-angle.cos(), -angle.sin())
    });
    draw(&mut screen, std::iter::once(ring).chain(quarter));
    let turned = bounds(&screen);
    assert!((turned.size().z - before.size().x).abs() < 1.0, "{before:?} to {turned:?}");
    press(&mut screen, "Undo");
    screen.key_combination_modifiers(Modifiers::NONE, &[Key::G]);
    settle(&mut screen);
    let heights: Vec<f32> = screen
        .state()
        .bench
        .scene()
        .root
        .children()
        .iter()
        .map(|node| blobtree::solid_box(&blobtree::Tree::new(node)).min.z)
        .collect();
    assert!(heights[0].abs() < 0.2 && heights[1] > 9.0 && heights[2].abs() < 0.2, "{heights:?}");
    assert_eq!(screen.state().bench.document().undo_names().count(), 1);
}

#[test]
fn all_selected_parts_are_copied_muted_put_together_and_removed_in_one_step_each() {
    let mut screen = balls();
    screen.state_mut().select_all(paths(&["/0", "/2"]));
    settle(&mut screen);
    press(&mut screen, "Duplicate");
    assert_eq!(names(&screen), ["Left", "Left", "Middle", "Right", "Right"]);
    assert_eq!(selected(&screen), paths(&["/1", "/4"]));
    press(&mut screen, "Mute");
    let muted = |screen: &Screen| -> Vec<bool> {
        screen.state().bench.scene().root.children().iter().map(|node| node.muted).collect()
    };
    assert_eq!(muted(&screen), [false, true, false, false, true]);
    press(&mut screen, "Unmute");
    press(&mut screen, "Put together");
    assert_eq!(names(&screen), ["Left", "union", "Middle", "Right"]);
    assert_eq!(selected(&screen), paths(&["/1"]));
    let group = screen.state().bench.selected_node().expect("a group").clone();
    assert!(matches!(&group.shape, Shape::Operator(_, children) if children.len() == 2));
    screen.state_mut().select_all(paths(&["/1/0", "/1/1", "/3"]));
    settle(&mut screen);
    screen.key_press(Key::P);
    settle(&mut screen);
    assert_eq!(selected(&screen), paths(&["/"]), "what holds all of them");
    screen.state_mut().select_all(paths(&["/0", "/1", "/3"]));
    settle(&mut screen);
    press(&mut screen, "Remove");
    assert_eq!(names(&screen), ["Middle"]);
    assert_eq!(screen.state().bench.document().undo_names().count(), 5);
    for _ in 0..5 {
        press(&mut screen, "Undo");
    }
    assert_eq!(names(&screen), ["Left", "Middle", "Right"]);
}

#[test]
fn the_whole_model_is_mirrored_if_all_of_it_is_selected() {
    let mut screen = screen(None);
    put(&mut screen, union([point([20., 0., 10.], 10.)]).subtract(point([24., 0., 10.], 4.)));
    screen.state_mut().select(Some(NodePath::default()));
    screen.state_mut().mirror_selected();
    settle(&mut screen);
    let both = bounds(&screen);
    assert!((both.min.x + 30.0).abs() < 0.1 && (both.max.x - 30.0).abs() < 0.1, "{both:?}");
    assert_eq!(
        (screen.state().bench.document().undo_names().count(), selected(&screen)),
        (1, paths(&["/1"]))
    );
}

#[test]
fn several_parts_are_mirrored_together() {
    let mut screen = balls();
    screen.state_mut().select_all(paths(&["/1", "/2"]));
    screen.key_press(Key::Delete);
    settle(&mut screen);
    let left = [point([-30., 0., 20.], 6.), point([-20., 0., 30.], 4.)];
    put(&mut screen, union(left));
    screen.state_mut().select_all(paths(&["/0", "/1"]));
    settle(&mut screen);
    press(&mut screen, "Mirror to the other side");
    let both = bounds(&screen);
    assert!((both.min.x + both.max.x).abs() < 0.3 && both.max.x > 35.0, "{both:?}");
    assert_eq!(screen.state().bench.document().undo_names().count(), 1);
}

#[test]
fn what_is_dragged_near_the_bed_or_the_mirror_plane_rests_there_unless_it_is_let_free() {
    let mut screen = balls();
    screen.state_mut().select_all(paths(&["/2"]));
    settle(&mut screen);
    let mm = |screen: &Screen| {
        let rect = screen.get_by_label("Model view").rect();
        let view = screen.state().camera.view(glam::Vec2::new(rect.width(), rect.height()));
        view.mm_per_px(view.depth(Vec3::from(PLACES[2])))
    };
    let points = 1.0 / mm(&screen);
    let from = seen(&screen, PLACES[2]);
    // Down to the bed and to the middle, but not quite.
    let by = points * vec2(-29.5, 9.5);
    let middle_of = |screen: &Screen| {
        let node = &screen.state().bench.scene().root.children()[2];
        blobtree::solid_box(&blobtree::Tree::new(node)).center()
    };
    // While it is held there, it says where it rests.
    screen.hover_at(from);
    screen.drag_at(from);
    screen.step();
    screen.hover_at(from + by);
    screen.run_steps(2);
    assert_eq!(screen.state().rests_on(), ["on the mirror plane, x = 0", "on the bed, z = 0"]);
    // And while the hand holds still, the model becomes fine.
    settle(&mut screen);
    screen.drop_at(from + by);
    settle(&mut screen);
    assert!(screen.state().rests_on().is_empty());
    assert!(middle_of(&screen).distance(Vec3::new(0.0, 0.0, 10.0)) < 0.2, "{}", middle_of(&screen));
    // Its lowest point was at z = 10.
    let moved = screen.state().bench.scene().root.children()[2].clone();
    let Shape::Warp(blobtree::Warp::Transform(moved), _) = &moved.shape else { panic!("{moved:?}") };
    assert!((moved.translate.z + 10.0).abs() < 0.005, "{}", moved.translate);
    press(&mut screen, "Undo");
    press(&mut screen, "View");
    press(&mut screen, "Snap while dragging");
    screen.key_press(Key::Escape);
    settle(&mut screen);
    screen.state_mut().select_all(paths(&["/2"]));
    settle(&mut screen);
    drag(&mut screen, from, by);
    assert!((middle_of(&screen).x - 0.5).abs() < 0.2, "{}", middle_of(&screen));
}

#[test]
fn the_part_under_the_pointer_in_the_view_is_known_to_the_tree() {
    let mut screen = balls();
    let place = seen(&screen, PLACES[2]);
    screen.hover_at(place);
    settle(&mut screen);
    assert_eq!(screen.state().pointed(), Some(&paths(&["/2"])[0]));
    let place = nowhere(&screen);
    screen.hover_at(place);
    settle(&mut screen);
    assert_eq!(screen.state().pointed(), None);
}

#[test]
fn seams_are_made_where_parts_meet_and_only_if_they_are_wanted() {
    let mut screen = screen(None);
    let ball = |x: f32| point([x, 0., 10.], 10.);
    put(&mut screen, blobtree::build::blend([ball(-8.), ball(8.)]));
    let seams = |screen: &Screen| screen.state().seams().0.len();
    assert!(seams(&screen) > 100, "{}", seams(&screen));
    press(&mut screen, "View");
    press(&mut screen, "Seams between parts");
    assert_eq!(seams(&screen), 0);
}
