//! Pens beyond the mouse, the palm beside them, and hands that draw with the left.

mod common;

use common::*;
use egui::{Event, Pos2, TouchDeviceId, TouchId, TouchPhase, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use modeler::pen::PenState;

/// A pen near the screen.
const NEAR: PenState = PenState {
    is_near: true,
    at: None,
    pressure: Some(0.25),
    tilt: [30.0, -10.0],
    eraser: false,
    barrel: false,
};

fn strokes(screen: &Screen) -> Vec<usize> {
    screen.state().pad.sketch().strokes.iter().map(|stroke| stroke.samples.len()).collect()
}

#[test]
fn the_eraser_end_rubs_out_whatever_the_tool_is_and_over_handles_too() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 100.0));
    let before: usize = strokes(&screen).iter().sum();
    press(&mut screen, "Turn");
    screen.state().pen.tell(PenState { eraser: true, ..NEAR });
    draw(&mut screen, (-20..=20).map(|i| at + vec2(100.0, 3.0 * i as f32)));
    let after: usize = strokes(&screen).iter().sum();
    assert!(after < before, "{before} to {after}");
    // The other end draws again.
    press(&mut screen, "Draw");
    screen.state().pen.tell(NEAR);
    draw(&mut screen, circle(at, 30.0));
    assert!(strokes(&screen).iter().sum::<usize>() > after);
}

#[test]
fn how_hard_the_pen_presses_and_how_it_leans_is_kept_with_the_stroke() {
    let mut screen = screen(None);
    let at = middle(&screen);
    screen.state().pen.tell(NEAR);
    draw(&mut screen, circle(at, 100.0));
    let sketch = screen.state().pad.sketch();
    let pens: Vec<_> = sketch.strokes.iter().flat_map(|stroke| &stroke.samples).map(|s| s.pen).collect();
    assert!(pens.len() > 20 && pens.iter().all(|pen| (pen.pressure, pen.tilt) == (0.25, [30.0, -10.0])));
}

#[test]
fn a_slow_frame_that_hears_of_many_places_at_once_knows_how_hard_each_was_pressed() {
    let mut screen = screen(None);
    let at = middle(&screen);
    let places: Vec<Pos2> = (0..20).map(|i| at + vec2(8.0 * i as f32, 0.0)).collect();
    let press = |i: usize| 0.1 + i as f32 / 40.0;
    for (i, place) in places.iter().enumerate() {
        screen.state().pen.tell(PenState { at: Some(*place), pressure: Some(press(i)), ..NEAR });
    }
    let mut events = vec![Event::PointerMoved(places[0]), button(places[0], true)];
    events.extend(places.iter().map(|place| Event::PointerMoved(*place)));
    events.push(button(places[19], false));
    screen.input_mut().events.extend(events);
    screen.step();
    let sketch = screen.state().pad.sketch();
    let pressures: Vec<f32> = sketch.strokes[0].samples.iter().map(|sample| sample.pen.pressure).collect();
    assert_eq!(pressures, (0..20).map(press).collect::<Vec<_>>());
}

#[test]
fn with_the_button_on_its_side_held_the_pen_turns_the_model() {
    let mut screen = screen(None);
    let at = middle(&screen);
    let before = screen.state().camera.azimuth;
    screen.state().pen.tell(PenState { barrel: true, ..NEAR });
    drag(&mut screen, at, vec2(80.0, 0.0));
    assert!((screen.state().camera.azimuth - before).abs() > 5.0);
    assert!(screen.state().pad.is_empty());
}

fn touch(phase: TouchPhase, pos: Pos2) -> Event {
    Event::Touch { device_id: TouchDeviceId(1), id: TouchId(7), phase, pos, force: None }
}

fn button(pos: Pos2, pressed: bool) -> Event {
    let button = egui::PointerButton::Primary;
    Event::PointerButton { pos, button, pressed, modifiers: egui::Modifiers::NONE }
}

#[test]
fn a_palm_that_lies_down_while_the_pen_draws_changes_nothing() {
    let mut screen = screen(None);
    let at = middle(&screen);
    let palm = at + vec2(150.0, 120.0);
    let line: Vec<Pos2> = circle(at, 90.0).collect();
    let mut frame = |events: Vec<Event>| {
        screen.input_mut().events.extend(events);
        screen.step();
    };
    frame(vec![Event::PointerMoved(line[0]), button(line[0], true)]);
    for (i, place) in line.iter().enumerate() {
        // As the platform plays a mouse after the first finger.
        let mut events = match i {
            10 => vec![touch(TouchPhase::Start, palm), Event::PointerMoved(palm), button(palm, true)],
            20 => vec![touch(TouchPhase::Move, palm), Event::PointerMoved(palm)],
            40 => vec![touch(TouchPhase::End, palm), button(palm, false), Event::PointerGone],
            _ => vec![],
        };
        events.push(Event::PointerMoved(*place));
        frame(events);
    }
    frame(vec![button(line[line.len() - 1], false)]);
    settle(&mut screen);
    assert_eq!(strokes(&screen).len(), 1);
    let [lo, hi] = screen.state().pad.sketch().bounds().expect("a circle");
    assert!((hi - lo).distance(glam::Vec2::splat(180.0)) < 2.0, "{lo} to {hi}");
}

#[test]
fn a_palm_that_lies_down_before_the_pen_draws_nothing() {
    let mut screen = screen(None);
    let at = middle(&screen);
    let palm = at + vec2(150.0, 120.0);
    screen.run_steps(4);
    screen.input_mut().events.extend([
        touch(TouchPhase::Start, palm),
        Event::PointerMoved(palm),
        button(palm, true),
    ]);
    screen.step();
    screen
        .input_mut()
        .events
        .extend([touch(TouchPhase::Move, palm + vec2(9.0, 0.0)), Event::PointerMoved(palm + vec2(9.0, 0.0))]);
    screen.step();
    assert!(screen.state().pad.current().is_some(), "until then it is a finger");
    draw(&mut screen, circle(at, 90.0));
    let [lo, hi] = screen.state().pad.sketch().bounds().expect("a circle");
    assert_eq!(strokes(&screen).len(), 1);
    assert!((hi - lo).distance(glam::Vec2::splat(180.0)) < 2.0, "{lo} to {hi}");
}

#[test]
fn for_left_handed_people_panels_views_and_suggestions_are_on_the_other_side() {
    let mut screen = screen(None);
    press(&mut screen, "View");
    press(&mut screen, "For left-handed people");
    screen.key_press(egui::Key::Escape);
    settle(&mut screen);
    let view = screen.get_by_label("Model view").rect();
    let at = view.center();
    draw(&mut screen, circle(at, 90.0));
    let x = |screen: &Screen, name: &str| screen.get_by_label(name).rect().center().x;
    assert!(x(&screen, "Inflate") < at.x - 90.0);
    assert!(x(&screen, "Corner") < view.left() + 120.0);
    assert!(x(&screen, "Parts") > view.right());
    assert!(x(&screen, "Nothing selected") < view.left());
    assert!(view.contains(pos2(x(&screen, "Inflate"), at.y)));
}
