//! Windows of all sizes: nothing hides what it is about, and all can be reached.

mod common;

use common::*;
use egui::{Rect, vec2};
use egui_kittest::kittest::Queryable as _;

/// Points; small screens whose things are twice as large are among them.
const SIZES: [egui::Vec2; 6] = [
    vec2(500.0, 400.0),
    vec2(640.0, 400.0),
    vec2(800.0, 600.0),
    vec2(960.0, 540.0),
    vec2(1280.0, 800.0),
    vec2(1920.0, 1080.0),
];

const BAR: [&str; 13] = [
    "File",
    "Edit",
    "View",
    "Undo",
    "Redo",
    "Draw",
    "Select",
    "Erase",
    "Turn",
    "Move view",
    "Export",
    "Lessons",
    "Panels",
];

fn screen_of_size(size: egui::Vec2, left_handed: bool) -> Screen {
    screen_of(size, TestDesk, None, |modeler| modeler.settings.left_handed = left_handed)
}

fn around(places: impl Iterator<Item = egui::Pos2>) -> Rect {
    let mut all = Rect::NOTHING;
    places.for_each(|place| all.extend_with(place));
    all
}

#[test]
fn suggestions_hide_neither_the_stroke_nor_the_model_in_windows_of_all_sizes() {
    let hands = SIZES.into_iter().zip([false, true, false, true, true, false]);
    for (size, left_handed) in hands.chain([(SIZES[2], true), (SIZES[4], false)]) {
        let case = format!("{size:?}, left-handed {left_handed}");
        let mut screen = screen_of_size(size, left_handed);
        let at = middle(&screen);
        draw(&mut screen, circle(at, 80.0));
        press(&mut screen, "Inflate");
        screen.key_press(egui::Key::Escape);
        // Once with room beside it, once with the view full of it.
        for by in [1.0, 2.4] {
            let view = screen.get_by_label("Model view").rect();
            let room = glam::Vec2::new(view.width(), view.height());
            screen.state_mut().camera.zoom(by, 0.5 * room, room);
            settle(&mut screen);
            draw(&mut screen, circle(at + vec2(20.0, 0.0), 60.0));
            let corners = screen.state().solid().expect("a ball").corners.clone();
            let corners: Vec<_> = corners.iter().step_by(50).map(|corner| corner.position).collect();
            let model = around(corners.into_iter().map(|at| seen(&screen, at)));
            let stroke = Rect::from_center_size(at + vec2(20.0, 0.0), vec2(120.0, 120.0));
            let rects = ["Grow", "Draw on", "Inflate"].map(|name| screen.get_by_label(name).rect());
            for rect in rects {
                let hides = rect.intersects(stroke) || rect.intersects(model.intersect(view).shrink(1.0));
                assert!(!hides, "{case}, {by} times as large: {rect:?} over {stroke:?} or {model:?}");
            }
            let window = Rect::from_min_size(egui::Pos2::ZERO, size);
            assert!(window.contains_rect(rects[0]), "{case}: {:?}", rects[0]);
            screen.key_press(egui::Key::Escape);
            settle(&mut screen);
        }
    }
}

#[test]
fn a_stroke_across_a_suggestion_below_the_view_presses_it() {
    let mut screen = screen_of_size(vec2(500.0, 400.0), false);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 60.0));
    let button = screen.get_by_label("Make thick").rect();
    let (from, to) = (button.center() - vec2(0.0, 60.0), button.center() + vec2(0.0, 60.0));
    draw(&mut screen, (0..=24).map(|i| from.lerp(to, i as f32 / 24.0)));
    assert_eq!(screen.state().bench.scene().root.children()[0].type_name(), "sweep");
}

#[test]
fn the_bar_is_whole_in_windows_of_all_sizes_and_panels_come_and_go() {
    for size in SIZES {
        let mut screen = screen_of_size(size, false);
        let window = Rect::from_min_size(egui::Pos2::ZERO, size);
        let rects = BAR.map(|name| screen.get_by_label(name).rect());
        for (i, rect) in rects.iter().enumerate() {
            assert!(window.contains_rect(*rect), "{size:?}: {} is at {rect:?}", BAR[i]);
            let over = rects[..i].iter().position(|other| other.shrink(0.5).intersects(*rect));
            assert_eq!(over.map(|other| BAR[other]), None, "{size:?}: {} is over it", BAR[i]);
        }
        let narrow = |screen: &Screen| screen.get_by_label("Model view").rect().width();
        let before = narrow(&screen);
        let had_panels = screen.query_by_label("Parts").is_some();
        press(&mut screen, "Panels");
        assert_eq!(screen.query_by_label("Parts").is_some(), !had_panels, "{size:?}");
        assert_eq!(narrow(&screen) > before, had_panels, "{size:?}");
    }
}

#[test]
fn windows_too_small_for_anything_are_no_mistake() {
    let mut screen = screen_with_snowman();
    screen.key_press(egui::Key::L);
    settle(&mut screen);
    assert!(screen.query_by_label("Field lens").is_some());
    for side in [700.0, 120.0, 40.0, 5.0, 1.0, 700.0] {
        screen.set_size(vec2(side, 0.7 * side));
        settle(&mut screen);
        screen.state_mut().notices.warn("A long sentence that has room on hardly any of these screens.");
        settle(&mut screen);
    }
    assert!(screen.query_by_label("Field lens").is_some());
    for side in [700.0, 40.0, 1.0] {
        let screen = screen_of_size(vec2(side, side), false);
        assert!(side < 700.0 || screen.query_by_label("An empty page").is_some());
    }
}
