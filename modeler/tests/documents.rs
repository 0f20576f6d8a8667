//! Files beside the running modeler: opened, added, saved and exported, by the names that are on the screen.

mod common;

use blobtree::build::{point, union};
use blobtree::{Aabb, Node, NodeRef, Scene, SceneSources, Tree, solid_box};
use common::*;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use modeler::How;
use modeler::desk::{Desk, ExportOptions, Opened};
use modeler::dialog::{Dialog, Then};
use modeler::errand::{Undone, Watch};
use modeler::workbench::Workbench;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Files that take their time: exporting goes on until the gate is open.
struct SlowDesk(Arc<AtomicBool>);

impl Desk for SlowDesk {
    fn open(&self, path: &Path, watch: &Watch) -> Result<Opened, Undone> {
        TestDesk.open(path, watch)
    }

    fn sources<'a>(&'a self, _: Option<&'a Path>) -> Box<dyn SceneSources + 'a> {
        Box::new(blobtree::DrawingsBy(sketch::solve))
    }

    fn export(
        &self,
        _: &Scene,
        path: &Path,
        options: &ExportOptions,
        watch: &Watch,
    ) -> Result<String, Undone> {
        while !self.0.load(Ordering::Relaxed) {
            watch.report("making the mesh", Some(0.25));
            if watch.cancel.is_cancelled() {
                return Err(Undone::Stopped);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        std::fs::write(path, format!("{options:?}")).map_err(|e| Undone::Failed(e.to_string()))?;
        Ok(format!("Exported {}.", path.display()))
    }

    fn examples(&self) -> &'static [(&'static str, &'static str)] {
        TestDesk.examples()
    }
}

/// A screen whose exports wait for the gate.
fn slow() -> (Screen, Arc<AtomicBool>) {
    let gate = Arc::new(AtomicBool::new(false));
    (screen_at(SlowDesk(gate.clone()), None, |_| ()), gate)
}

/// Presses what has this name, without waiting for what comes of it.
fn tap(screen: &mut Screen, name: &str) {
    screen.get_by_label(name).click();
    screen.run_steps(3);
}

/// Types a name into the question for one, in place of what is there.
fn name(screen: &mut Screen, file: &Path) {
    screen.run_steps(2);
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::A]);
    screen.event(egui::Event::Text(file.display().to_string()));
    screen.run_steps(2);
}

fn ball(x: f32, radius: f32) -> Node {
    point([x, 0., radius], radius)
}

fn scene_file(folder: &Path, name: &str, root: Node) -> PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, Scene::new(root).to_text().expect("legal")).expect("there is room");
    file
}

fn parts(screen: &Screen) -> Vec<NodeRef> {
    screen.state().bench.scene().root.children().to_vec()
}

fn place(node: &NodeRef) -> Aabb {
    solid_box(&Tree::new(node))
}

fn told(screen: &Screen, words: &str) -> bool {
    screen.state().notices.texts().any(|text| text.contains(words))
}

/// A screen with an unsaved ball on the table.
fn with_ball(mut screen: Screen) -> Screen {
    screen.state_mut().put(Scene::new(union([ball(0.0, 10.0)])), None);
    screen.state_mut().bench.never_saved();
    settle(&mut screen);
    screen
}

#[test]
fn an_export_shows_how_far_it_is_while_the_work_goes_on_and_can_be_stopped() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("ball.stl");
    let (screen, _gate) = slow();
    let mut screen = with_ball(screen);
    tap(&mut screen, "Export");
    name(&mut screen, &file);
    screen.key_press(Key::Enter);
    until(&mut screen, |screen| screen.query_by_label("Exporting ball.stl: making the mesh…").is_some());
    let bar =
        screen.get_by_role_and_label(egui::Role::ProgressIndicator, "Exporting ball.stl: making the mesh…");
    assert_eq!(bar.accesskit_node().numeric_value(), Some(25.0));
    screen.state_mut().select(Some(blobtree::NodePath(vec![0])));
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::D]);
    until(&mut screen, |screen| parts(screen).len() == 2);
    tap(&mut screen, "Stop");
    until(&mut screen, |screen| told(screen, "Not exported: stopped"));
    assert!(!file.exists());
}

#[test]
fn the_end_waits_for_a_file_that_is_being_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("ball.stl");
    for stops in [false, true] {
        let (screen, gate) = slow();
        let mut screen = with_ball(screen);
        assert!(save(&mut screen, folder.path().join("ball.trullo")));
        screen.state_mut().export_to(file.clone());
        screen.run_steps(2);
        screen.state_mut().quit();
        screen.run_steps(3);
        assert!(!screen.state().quits() && screen.query_by_label("One moment").is_some());
        if stops {
            tap(&mut screen, "Stop it and go on");
        } else {
            gate.store(true, Ordering::Relaxed);
        }
        until(&mut screen, |screen| screen.state().quits());
        assert_eq!(file.exists(), !stops);
        let _ = std::fs::remove_file(&file);
    }
}

#[test]
fn the_mesh_is_written_as_the_question_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let (screen, gate) = slow();
    gate.store(true, Ordering::Relaxed);
    let mut screen = with_ball(screen);
    tap(&mut screen, "Export");
    name(&mut screen, &folder.path().join("ball.3mf"));
    assert!(screen.query_by_label("Carry the scene along").is_some());
    tap(&mut screen, "STL");
    tap(&mut screen, "As text");
    tap(&mut screen, "As the shape needs it");
    screen.get_all_by_label("Export").last().expect("the answer").click();
    settle(&mut screen);
    let written = std::fs::read_to_string(folder.path().join("ball.stl")).expect("written");
    let wanted = ExportOptions { cell_mm: Some(0.25), as_text: true, ..ExportOptions::default() };
    assert_eq!(written, format!("{wanted:?}"));
}

#[test]
fn unsaved_work_is_saved_before_the_next_page_comes() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("kept.trullo");
    let mut screen = with_ball(screen(None));
    screen.key_combination_modifiers(Modifiers::COMMAND, &[Key::N]);
    screen.run_steps(3);
    tap(&mut screen, "Save");
    name(&mut screen, &file);
    screen.key_press(Key::Enter);
    settle(&mut screen);
    assert!(parts(&screen).is_empty() && file.exists());
}

#[test]
fn what_was_done_while_a_file_was_read_is_not_lost() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = scene_file(folder.path(), "two.trullo", union([ball(0.0, 5.0), ball(20.0, 5.0)]));
    let mut screen = with_ball(screen(None));
    screen.state_mut().fetch(file, How::Instead);
    settle(&mut screen);
    assert!(screen.query_by_label("Keep what you made?").is_some());
    tap(&mut screen, "Cancel");
    assert_eq!(parts(&screen).len(), 1);
}

#[test]
fn a_scene_is_added_beside_the_model_in_one_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = scene_file(folder.path(), "Small one.trullo", union([ball(0.0, 4.0)]));
    let mut screen = with_ball(screen(None));
    tap(&mut screen, "File");
    tap(&mut screen, "Add…");
    name(&mut screen, &file);
    screen.key_press(Key::Enter);
    settle(&mut screen);
    let parts_now = parts(&screen);
    let [first, second] = &parts_now[..] else { panic!("{parts_now:?}") };
    let (first, there) = (place(first), place(second));
    assert!(there.min.x > first.max.x + 4.0 && there.min.x < first.max.x + 6.0, "{there:?}");
    assert!((there.min.z - first.min.z).abs() < 0.1);
    let document = screen.state().bench.document();
    assert_eq!(document.undo_names().collect::<Vec<_>>(), ["Add Small one"]);
    assert_eq!(screen.state().bench.selected_node().and_then(|node| node.name.as_deref()), Some("Small one"));
    press(&mut screen, "Undo");
    assert_eq!(parts(&screen).len(), 1);
}

fn drop_on(screen: &mut Screen, files: &[&PathBuf]) {
    for file in files {
        screen.input_mut().dropped_files.push(Arc::new(Dropped((*file).clone())));
    }
    screen.step();
    settle(screen);
}

#[test]
fn what_is_dropped_on_an_empty_page_takes_it_and_on_a_model_the_user_is_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = scene_file(folder.path(), "ball.trullo", union([ball(0.0, 4.0)]));
    let mut screen = screen(None);
    drop_on(&mut screen, &[&file]);
    assert_eq!((parts(&screen).len(), screen.state().bench.file()), (1, Some(&*file)));
    drop_on(&mut screen, &[&file]);
    tap(&mut screen, "Add");
    settle(&mut screen);
    assert_eq!(parts(&screen).len(), 2);
    drop_on(&mut screen, &[&file]);
    tap(&mut screen, "Open instead");
    assert!(screen.query_by_label("Keep what you made?").is_some());
    tap(&mut screen, "Throw away");
    settle(&mut screen);
    assert_eq!(parts(&screen).len(), 1);
    // Several are not asked about.
    drop_on(&mut screen, &[&file, &file]);
    assert_eq!(parts(&screen).len(), 3);
    let places: Vec<Aabb> = parts(&screen).iter().map(place).collect();
    assert!(places[1].min.x > places[0].max.x && places[2].min.x > places[1].max.x, "{places:?}");
}

#[test]
fn a_drawing_that_is_dropped_on_a_model_becomes_a_sketch_and_nothing_is_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("square.json");
    let corners = [[0., 0.], [40., 0.], [40., 30.], [0., 30.], [0., 0.]].map(glam::Vec2::from);
    let drawn = sketch::stroke::write_strokes(&[sketch::stroke::Stroke::through(corners)]);
    std::fs::write(&file, drawn).expect("there is room");
    let mut screen = with_ball(screen(None));
    drop_on(&mut screen, &[&file]);
    let said: Vec<&str> = screen.state().notices.texts().collect();
    assert!(screen.state().dialog.is_none() && !screen.state().pad.is_empty(), "{said:?}");
    assert_eq!(parts(&screen).len(), 1);
    // It fills the view, so it goes across the ball.
    let found = screen.state().pad.expectations.as_ref().expect("suggestions");
    assert!(!found.suggestions.is_empty());
}

#[test]
fn a_later_file_takes_the_place_of_one_that_is_still_being_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let one = scene_file(folder.path(), "one.trullo", union([ball(0.0, 4.0)]));
    let two = scene_file(folder.path(), "two.trullo", union([ball(0.0, 4.0), ball(9.0, 4.0)]));
    let mut screen = screen(None);
    screen.state_mut().fetch(one, How::Instead);
    screen.state_mut().fetch(two.clone(), How::Instead);
    settle(&mut screen);
    assert_eq!(screen.state().bench.file(), Some(&*two));
    // And a new page puts away what is added to the old one.
    screen.state_mut().fetch(two, How::Beside);
    Dialog::begin(screen.state_mut(), Then::New);
    settle(&mut screen);
    assert_eq!(screen.state().bench.scene(), &Workbench::empty_page());
}
