//! What a person does from the empty page on, by the names that are on the screen.

mod common;

use blobtree::{NodePath, Operator, Shape};
use common::*;
use egui::{Key, Modifiers, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use modeler::journal::LeftBehind;
use modeler::workbench::Workbench;
use sketch::stroke::{Stroke, write_strokes};

fn types(screen: &Screen) -> Vec<&'static str> {
    screen.state().bench.scene().root.children().iter().map(|node| node.type_name()).collect()
}

#[test]
fn a_drawn_circle_becomes_the_solid_that_is_chosen_for_it() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 120.0));
    for name in ["Inflate", "Make thick", "Turn round"] {
        assert!(screen.query_by_label(name).is_some(), "{name} is not offered");
    }
    press(&mut screen, "Inflate");
    assert_eq!(types(&screen), ["inflation"]);
    assert!(screen.state().pad.is_empty());
    assert_eq!(screen.state().bench.selected(), Some(&NodePath(vec![0])));
    let solid = screen.state().solid().expect("something to see").clone();
    assert!(solid.corners.len() > 3000 && solid.is_fine);
    // As large as it was drawn.
    let size = solid.bounds.size();
    let view = screen.state().camera;
    let rect = screen.get_by_label("Model view").rect();
    let view = view.view(glam::Vec2::new(rect.width(), rect.height()));
    let mm = view.mm_per_px(view.depth(glam::Vec3::ZERO));
    assert!(size.max_element() < 245.0 * mm && size.max_element() > 200.0 * mm, "{size} at {mm} mm a point");
}

#[test]
fn a_second_stroke_across_grows_out_of_the_first_and_a_third_inside_cuts_a_hole() {
    let (mut screen, at) = screen_with_two_balls();
    draw(&mut screen, circle(at - vec2(30.0, 0.0), 30.0));
    press(&mut screen, "Cut a hole");
    let undone = screen.state().bench.document().undo_names().count();
    assert_eq!(undone, 3);
    let before = screen.state().solid().expect("a solid").bounds;
    for _ in 0..3 {
        press(&mut screen, "Undo");
    }
    assert!(types(&screen).is_empty());
    for _ in 0..3 {
        press(&mut screen, "Redo");
    }
    let after = screen.state().solid().expect("a solid").bounds;
    assert!(before.min.distance(after.min) < 1.0 && before.max.distance(after.max) < 1.0);
}

#[test]
fn a_drawing_that_the_modeler_begins_with_fills_the_view_and_may_become_a_solid() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("circle.json");
    let drawn = Stroke::through(circle(pos2(7.0, 9.0), 3.0).map(|p| glam::Vec2::new(p.x, p.y)));
    std::fs::write(&file, write_strokes(&[drawn])).expect("a file");
    let mut screen = screen_with(None, |modeler| modeler.begin_with(file));
    let [lo, hi] = screen.state().pad.sketch().bounds().expect("it is there");
    let rect = screen.get_by_label("Model view").rect();
    assert!(((hi - lo).max_element() / rect.size().min_elem() - 0.75).abs() < 0.01, "{lo} to {hi}");
    press(&mut screen, "Inflate");
    assert_eq!(types(&screen), ["inflation"]);
}

#[test]
fn a_stroke_across_a_suggestion_presses_it() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    let button = screen.get_by_label("Make thick").rect();
    let (from, to) = (button.left_center() - vec2(30.0, 0.0), button.right_center() + vec2(30.0, 0.0));
    draw(&mut screen, (0..=24).map(|i| from.lerp(to, i as f32 / 24.0)));
    assert_eq!(types(&screen), ["sweep"]);
}

#[test]
fn what_is_drawn_with_the_eraser_is_rubbed_out() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 100.0));
    press(&mut screen, "Erase");
    draw(&mut screen, (-20..=20).map(|i| at + vec2(100.0, 3.0 * i as f32)));
    let sketch = screen.state().pad.sketch();
    assert!(sketch.places().all(|p| p.is_finite()) && !sketch.is_empty());
    assert!(screen.query_by_label("Undo").is_some());
    screen.key_press(Key::Escape);
    settle(&mut screen);
    assert!(screen.state().pad.is_empty());
}

#[test]
fn a_tap_selects_the_part_below_it_and_one_beside_selects_nothing() {
    let mut screen = screen_with_snowman();
    assert!(screen.state().solid().is_some_and(|solid| !solid.corners.is_empty()));
    // All of it shows, so the middle of the view is on it.
    let at = middle(&screen);
    draw(&mut screen, [at]);
    assert!(screen.state().bench.selected().is_some());
    let corner = screen.get_by_label("Model view").rect().left_bottom();
    draw(&mut screen, [corner + vec2(30.0, -30.0)]);
    assert_eq!(screen.state().bench.selected(), None);
}

#[test]
fn the_field_lens_tells_what_makes_the_value_under_the_pen() {
    let mut screen = screen_with_snowman();
    screen.key_press(Key::L);
    settle(&mut screen);
    let bar = screen.get_by_label("Lessons").rect().center();
    screen.hover_at(bar);
    settle(&mut screen);
    assert!(screen.query_by_label_contains("Point at a place").is_some());
    let at = middle(&screen);
    screen.hover_at(at);
    settle(&mut screen);
    assert!(screen.query_by_label_contains("here: inside").is_some());
    let told = screen.state().lens.as_ref().and_then(|lens| lens.explained()).expect("told").clone();
    assert!((told.place.y + 1.0).abs() < 0.5 && told.value > 0.5, "{told:?}");
    assert!((told.shares[0].share - 1.0).abs() < 1e-6 && told.shares.len() > 1, "{told:?}");
    // The knob of the lens moves it towards the eye, out of the solid.
    let (text, knob) =
        screen.state().knobs().into_iter().find(|(text, _)| text.starts_with("Lens")).expect("a knob");
    let rect = screen.get_by_label("Model view").rect();
    drag(&mut screen, rect.min + vec2(knob.x, knob.y), vec2(-60.0, 60.0));
    let moved =
        screen.state().knobs().into_iter().find(|(text, _)| text.starts_with("Lens")).expect("a knob");
    assert_ne!(moved.0, text);
    press(&mut screen, "Close");
    assert!(screen.state().lens.is_none());
}

#[test]
fn the_parameters_of_what_is_selected_can_be_typed() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    press(&mut screen, "Make thick");
    let length = screen.get_by_label("Length");
    length.click();
    screen.run_steps(2);
    screen.get_by_label("Length").focus();
    screen.run_steps(2);
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::A]);
    screen.event(egui::Event::Text("25".into()));
    screen.key_press(Key::Enter);
    settle(&mut screen);
    let node = screen.state().bench.selected_node().expect("selected").clone();
    let Shape::Primitive(blobtree::Primitive::LinearSweep(sweep)) = &node.shape else { panic!("{node:?}") };
    assert_eq!(sweep.length, 25.0);
}

#[test]
fn the_knob_beside_a_part_makes_it_thicker() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 60.0));
    press(&mut screen, "Make thick");
    let thickness = |screen: &Screen| {
        let node = screen.state().bench.selected_node().expect("selected").clone();
        let Shape::Primitive(blobtree::Primitive::LinearSweep(sweep)) = &node.shape else {
            panic!("{node:?}")
        };
        sweep.length
    };
    let before = thickness(&screen);
    // Its direction points to the eye, so the knob stands below, to the left of the part's middle.
    let knobs = screen.state().knobs();
    let (name, place) = knobs.first().expect("a knob").clone();
    assert!(name.starts_with("Thickness"), "{name}");
    let knob = screen.get_by_label("Model view").rect().min + vec2(place.x, place.y);
    drag(&mut screen, knob, vec2(-30.0, 30.0));
    let after = thickness(&screen);
    assert!(after > before + 1.0, "{before} to {after}");
    press(&mut screen, "Undo");
    assert_eq!(thickness(&screen), before);
}

#[test]
fn the_knob_below_a_blend_makes_it_sharper() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 100.0));
    press(&mut screen, "Inflate");
    draw(&mut screen, circle(at + vec2(100.0, 0.0), 50.0));
    press(&mut screen, "Grow");
    let sharpness = |screen: &Screen| {
        let mut nodes = vec![screen.state().bench.scene().root.clone()];
        while let Some(node) = nodes.pop() {
            if let Shape::Operator(Operator::Blend(sharpness), _) = &node.shape {
                return sharpness.get();
            }
            nodes.extend(node.children().iter().cloned());
        }
        panic!("no blend")
    };
    let before = sharpness(&screen);
    let knobs = screen.state().knobs();
    let (_, place) = knobs.iter().find(|(name, _)| name.starts_with("Sharpness")).expect("a knob").clone();
    let knob = screen.get_by_label("Model view").rect().min + vec2(place.x, place.y);
    drag(&mut screen, knob, vec2(80.0, 0.0));
    assert!((sharpness(&screen) / before - 2.0).abs() < 0.05, "{before} to {}", sharpness(&screen));
}

#[test]
fn the_plane_of_a_sketch_is_moved_away_before_it_becomes_a_solid() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 60.0));
    let depth = screen.state().pad.expectations.as_ref().expect("suggestions").depth;
    let (name, place) = screen.state().knobs().first().expect("a knob").clone();
    assert_eq!(name, "Nearer or farther");
    let knob = screen.get_by_label("Model view").rect().min + vec2(place.x, place.y);
    drag(&mut screen, knob, vec2(0.0, -50.0));
    let moved = screen.state().pad.expectations.as_ref().expect("suggestions").depth;
    assert!(moved > depth + 1.0, "{depth} to {moved}");
    press(&mut screen, "Inflate");
    let solid = screen.state().solid().expect("a solid").bounds.center();
    let forward = screen.state().camera.view(glam::Vec2::splat(100.0)).forward;
    assert!((solid.dot(forward) - (moved - depth)).abs() < 0.1 * (moved - depth) + 1.0, "{solid}");
}

#[test]
fn a_tree_of_a_hundred_levels_shows_and_can_be_worked_on() {
    let mut screen = screen(None);
    let mut node: blobtree::Node = blobtree::build::point([0., 0., 5.], 5.);
    for level in 0..100_u8 {
        let next = blobtree::build::point([f32::from(level), 0., 5.], 4.);
        node = blobtree::build::blend([blobtree::build::union([node]), blobtree::build::union([next])]);
    }
    screen.state_mut().put(blobtree::Scene::new(node), None);
    settle(&mut screen);
    assert!(screen.get_all_by_label("Blended").count() > 5);
    screen.state_mut().select(Some(NodePath(vec![0; 199])));
    settle(&mut screen);
    assert!(screen.state().bench.selected_node().is_some());
}

#[test]
fn three_lessons_lead_from_the_empty_page_to_a_hole() {
    let mut screen = screen(None);
    press(&mut screen, "Show me how");
    assert!(screen.query_by_label("Lesson 1 of 3: draw").is_some());
    let at = middle(&screen);
    draw(&mut screen, circle(at, 110.0));
    press(&mut screen, "Inflate");
    assert!(screen.query_by_label("Lesson 2 of 3: blend").is_some());
    draw(&mut screen, circle(at + vec2(110.0, 0.0), 60.0));
    press(&mut screen, "Grow");
    assert!(screen.query_by_label("Lesson 3 of 3: cut").is_some());
    draw(&mut screen, circle(at - vec2(30.0, 0.0), 30.0));
    press(&mut screen, "Cut a hole");
    assert!(screen.query_by_label("That is all you need").is_some());
    press(&mut screen, "End lessons");
    assert!(screen.query_by_label("That is all you need").is_none());
}

/// Fingers touch together at these places, for one frame: a quarter of a second here.
fn tap_with(screen: &mut Screen, places: &[egui::Pos2]) {
    let event = |finger: usize, phase| egui::Event::Touch {
        device_id: egui::TouchDeviceId(1),
        id: egui::TouchId(finger as u64),
        phase,
        pos: places[finger],
        force: None,
    };
    for phase in [egui::TouchPhase::Start, egui::TouchPhase::End] {
        screen.input_mut().events.extend((0..places.len()).map(|finger| event(finger, phase)));
        screen.step();
    }
    settle(screen);
}

#[test]
fn a_tap_of_two_fingers_undoes_and_one_of_three_does_again() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    press(&mut screen, "Inflate");
    tap_with(&mut screen, &[at, at + vec2(60.0, 0.0)]);
    assert!(types(&screen).is_empty());
    tap_with(&mut screen, &[at, at + vec2(60.0, 0.0), at + vec2(120.0, 10.0)]);
    assert_eq!(types(&screen), ["inflation"]);
}

#[test]
fn a_part_is_put_on_the_ground_and_mirrored() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at + vec2(120.0, -60.0), 50.0));
    press(&mut screen, "Inflate");
    screen.key_press(Key::G);
    settle(&mut screen);
    let one = screen.state().solid().expect("a solid").bounds;
    assert!(one.min.z.abs() < 0.01 && one.center().x > 5.0, "{one:?}");
    screen.key_press(Key::M);
    settle(&mut screen);
    let both = screen.state().solid().expect("a solid").bounds;
    assert!((both.min.x + one.max.x).abs() < 0.5 && (both.max.x - one.max.x).abs() < 0.5, "{both:?}");
}

/// The pen goes down, or is lifted.
fn button(pos: egui::Pos2, pressed: bool) -> egui::Event {
    let button = egui::PointerButton::Primary;
    egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
}

#[test]
fn a_stroke_that_is_over_a_suggestion_before_the_frame_ends_presses_it() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    let row = screen.get_by_label("Inflate").rect();
    let (from, to) = (row.left_center() - vec2(30.0, 0.0), row.right_center() + vec2(30.0, 0.0));
    for events in [
        vec![egui::Event::PointerMoved(from), button(from, true), egui::Event::PointerMoved(row.center())],
        vec![egui::Event::PointerMoved(to), button(to, false)],
    ] {
        screen.input_mut().events.extend(events);
        screen.step();
    }
    settle(&mut screen);
    assert!(screen.state().pad.is_empty(), "nothing is left of the sketch");
    assert!(screen.state().solid().is_some(), "it became a solid");
}

#[test]
fn strokes_that_a_slow_frame_gets_all_at_once_are_not_lost() {
    let mut screen = screen(None);
    let at = middle(&screen);
    let mut events = vec![egui::Event::PointerMoved(at), egui::Event::PointerMoved(at - vec2(300.0, 0.0))];
    for place in [at - vec2(100.0, 0.0), at + vec2(100.0, 0.0)] {
        let line: Vec<_> = circle(place, 60.0).collect();
        events.push(egui::Event::PointerMoved(line[0]));
        events.push(button(line[0], true));
        events.extend(line.iter().map(|at| egui::Event::PointerMoved(*at)));
        events.push(button(line[line.len() - 1], false));
    }
    screen.input_mut().events.extend(events);
    screen.step();
    settle(&mut screen);
    let sketch = screen.state().pad.sketch();
    assert_eq!(sketch.strokes.len(), 2);
    let [lo, hi] = sketch.bounds().expect("two circles");
    assert!((hi - lo).distance(glam::Vec2::new(320.0, 120.0)) < 2.0, "{lo} to {hi}");
}

#[test]
fn every_suggestion_has_a_picture_of_what_it_makes() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    let until = std::time::Instant::now() + std::time::Duration::from_secs(60);
    let missing = |screen: &Screen| {
        let found = screen.state().pad.expectations.as_ref().expect("suggestions");
        found.pictures.iter().filter(|picture| picture.is_none()).count()
    };
    while missing(&screen) > 0 {
        assert!(std::time::Instant::now() < until, "{} pictures are missing", missing(&screen));
        screen.step();
    }
    let found = screen.state().pad.expectations.as_ref().expect("suggestions");
    assert_eq!(found.pictures.len(), 3);
}

#[test]
fn how_parts_are_combined_can_be_changed_in_place() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 90.0));
    press(&mut screen, "Inflate");
    screen.get_by_label("Combined").click();
    screen.run_steps(2);
    press(&mut screen, "Blended widely");
    assert!(matches!(screen.state().bench.scene().root.shape, Shape::Operator(Operator::Sum, _)));
}

#[test]
fn what_a_killed_modeler_did_is_offered_again_with_its_history() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first = screen(Some(folder.path().into()));
    let at = middle(&first);
    draw(&mut first, circle(at, 100.0));
    press(&mut first, "Inflate");
    press(&mut first, "Undo");
    press(&mut first, "Redo");
    let scene = first.state().bench.scene().to_text().expect("legal");
    // Nothing is closed or saved: that is what a killed process leaves.
    drop(first);
    let left = LeftBehind::all(folder.path());
    assert_eq!(left.iter().map(|session| session.steps).collect::<Vec<_>>(), [3]);
    let mut second = screen(Some(folder.path().into()));
    second.state_mut().dialog = Some(modeler::dialog::Dialog::LeftBehind(left));
    second.run_steps(3);
    press(&mut second, "Bring back");
    assert_eq!(second.state().bench.scene().to_text().expect("legal"), scene);
    assert_eq!(second.state().bench.document().undo_names().count(), 1);
    assert!(second.state().bench.is_unsaved());
}

#[test]
fn saving_gives_a_file_that_opens_as_the_same_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("ball.trullo");
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 100.0));
    press(&mut screen, "Inflate");
    assert!(screen.state().bench.is_unsaved());
    assert!(save(&mut screen, &file));
    assert!(!screen.state().bench.is_unsaved());
    let scene = screen.state().bench.scene().clone();
    screen.state_mut().put(Workbench::empty_page(), None);
    settle(&mut screen);
    screen.state_mut().fetch(file, modeler::How::Instead);
    settle(&mut screen);
    assert_eq!(screen.state().bench.scene(), &scene);
}

#[test]
fn unsaved_work_is_not_lost_by_a_new_page() {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 100.0));
    press(&mut screen, "Inflate");
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::N]);
    screen.run_steps(3);
    press(&mut screen, "Cancel");
    assert_eq!(types(&screen), ["inflation"]);
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::N]);
    screen.run_steps(3);
    press(&mut screen, "Throw away");
    assert!(types(&screen).is_empty());
}
