//! Holes that go through everything, by the names that are on the screen.

mod common;

use blobtree::{LinearSweep, Primitive, Shape};
use common::*;
use egui::vec2;
use egui_kittest::kittest::Queryable as _;

fn hole(screen: &Screen) -> LinearSweep {
    let node = screen.state().bench.selected_node().expect("the hole is selected").clone();
    let Shape::Primitive(Primitive::LinearSweep(sweep)) = &node.shape else { panic!("{node:?}") };
    sweep.clone()
}

#[test]
fn a_hole_goes_through_everything_or_as_deep_as_one_says() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 110.0));
    press(&mut screen, "Inflate");
    // Its handles would be in the way.
    screen.key_press(egui::Key::Escape);
    draw(&mut screen, circle(at + vec2(20.0, 0.0), 30.0));
    press(&mut screen, "Cut a hole");
    assert!(screen.state().selected_cut().is_some_and(modeler::cutting::Cut::is_through));
    // A length that says no more than that is not shown, neither in the panel nor in the view.
    assert!(screen.query_by_label("Length").is_none());
    assert!(screen.state().knobs().iter().all(|(text, _)| !text.starts_with("Thickness")));
    let before = hole(&screen);
    press(&mut screen, "Through everything");
    let blind = hole(&screen);
    assert!(screen.query_by_label("Length").is_some());
    assert!(blind.length < 0.6 * before.length, "{} to {}", before.length, blind.length);
    // It still begins before the surface, where it was drawn, and ends within the ball.
    let ends = |sweep: &LinearSweep| [0.5, -0.5].map(|half| sweep.offset + half * sweep.length);
    let ([near, far], [_, beyond]) = (ends(&blind), ends(&before));
    assert!(
        near > 0.0 && far < 0.0 && far > beyond + 0.3 * before.length,
        "{near} to {far}, {beyond} before"
    );
    press(&mut screen, "Through everything");
    let again = hole(&screen);
    assert!(screen.state().selected_cut().is_some_and(modeler::cutting::Cut::is_through));
    assert!(again.length > 1.8 * blind.length);
    press(&mut screen, "Undo");
    assert_eq!(hole(&screen), blind);
}
