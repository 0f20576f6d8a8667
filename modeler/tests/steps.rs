//! One gesture is one step of the history, however many places, letters and colours there were on the way.

mod common;

use blobtree::NodePath;
use blobtree::build::{Build as _, point, union};
use common::*;
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable as _;

/// Two balls, the first of them selected.
fn two_balls() -> Screen {
    let mut screen = screen(None);
    put(
        &mut screen,
        union([point([-12., 0., 9.], 9.).named("left"), point([12., 0., 9.], 9.).named("right")]),
    );
    screen.state_mut().select(Some(NodePath(vec![0])));
    settle(&mut screen);
    screen
}

fn steps(screen: &Screen) -> usize {
    screen.state().bench.document().undo_names().count()
}

/// The colour of a part: of the document, and as it is shown.
fn colors(screen: &Screen, part: usize) -> [Option<[u8; 3]>; 2] {
    let bench = &screen.state().bench;
    [bench.scene(), bench.shown()].map(|scene| scene.root.children()[part].color.map(|color| color.0))
}

/// Drags through the hues of the palette, and says what was seen before the hand let go.
fn drag_through_colors(screen: &mut Screen) -> Vec<Option<[u8; 3]>> {
    screen.get_by_role_and_label(Role::Button, "Colour").click();
    screen.run_steps(4);
    let from = screen.get_by_role_and_label(Role::Slider, "Hue").rect().left_center() + vec2(10.0, 0.0);
    screen.hover_at(from);
    screen.drag_at(from);
    let mut seen = Vec::new();
    for i in 1..=8 {
        let at = from + vec2(10.0 * i as f32, 0.0);
        screen.hover_at(at);
        screen.run_steps(2);
        seen.push(colors(screen, 0)[1]);
    }
    assert_eq!((steps(screen), colors(screen, 0)[0]), (0, None), "nothing is done before the hand lets go");
    screen.drop_at(from + vec2(80.0, 0.0));
    settle(screen);
    seen.dedup();
    seen
}

#[test]
fn a_drag_in_the_colour_picker_is_one_step() {
    let mut screen = two_balls();
    let seen = drag_through_colors(&mut screen);
    assert!(seen.len() > 3, "the model shows the colours on the way: {seen:?}");
    assert_eq!((steps(&screen), colors(&screen, 0)[0]), (1, seen.last().copied().flatten()));
    screen.state_mut().undo();
    assert_eq!((steps(&screen), colors(&screen, 0)), (0, [None, None]));
}

#[test]
fn a_colour_of_the_palette_is_one_step() {
    let mut screen = two_balls();
    screen.get_by_role_and_label(Role::Button, "Colour").click();
    screen.run_steps(4);
    screen.get_by_label("dark blue").click();
    settle(&mut screen);
    let [red, _, blue] = colors(&screen, 0)[0].expect("it has a colour");
    assert!(blue > 2 * red && steps(&screen) == 1, "{red} {blue}");
}

#[test]
fn several_parts_get_their_colour_in_one_step() {
    let mut screen = two_balls();
    screen.state_mut().select_all([NodePath(vec![0]), NodePath(vec![1])]);
    settle(&mut screen);
    drag_through_colors(&mut screen);
    let [left, right] = [0, 1].map(|part| colors(&screen, part)[0]);
    assert!(left.is_some() && left == right);
    assert_eq!(steps(&screen), 1);
}

#[test]
fn a_name_is_one_step_however_many_letters_it_has() {
    let mut screen = two_balls();
    screen.get_by_label("Name").focus();
    screen.run_steps(2);
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::A]);
    for letter in ["m", "o", "o", "n"] {
        screen.event(egui::Event::Text(letter.into()));
        screen.run_steps(2);
    }
    assert_eq!(steps(&screen), 0);
    screen.key_press(Key::Enter);
    settle(&mut screen);
    assert_eq!(screen.state().bench.scene().root.children()[0].name.as_deref(), Some("moon"));
    assert_eq!(steps(&screen), 1);
}
