//! A modeler driven as a person would: by what is on the screen.

// Each test file uses its own part of this.
#![allow(dead_code)]

use blobtree::{DrawingsBy, Scene, SceneSources};
use egui::{Pos2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use modeler::Modeler;
use modeler::desk::{Desk, ExportOptions, Opened};
use modeler::errand::{Undone, Watch};
use modeler::stage::NoStage;
use sketch::stroke::{DoodleChoice, FileFormat, Sketch, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Files without a disk, but for scenes; drawings are solved as the program does.
#[derive(Debug, Default)]
pub struct TestDesk;

impl Desk for TestDesk {
    fn open(&self, path: &Path, _: &Watch) -> Result<Opened, Undone> {
        let failed = |why: String| Undone::Failed(format!("{}: {why}", path.display()));
        let bytes = std::fs::read(path).map_err(|e| failed(e.to_string()))?;
        if path.extension().is_some_and(|extension| extension == "json") {
            let strokes = read(&bytes, FileFormat::Strokes, &DoodleChoice::default())
                .map_err(|e| failed(e.to_string()))?;
            return Ok(Opened::Drawing(Sketch::from_strokes(&strokes)));
        }
        let scene = Scene::from_bytes(&bytes, &mut DrawingsBy(sketch::solve));
        let scene = scene.map_err(|e| failed(e.to_string()))?;
        Ok(Opened::Scene(scene, Vec::new()))
    }

    fn sources<'a>(&'a self, _: Option<&'a Path>) -> Box<dyn SceneSources + 'a> {
        Box::new(DrawingsBy(sketch::solve))
    }

    fn export(&self, _: &Scene, path: &Path, _: &ExportOptions, _: &Watch) -> Result<String, Undone> {
        Ok(format!("Exported {}.", path.display()))
    }

    fn examples(&self) -> &'static [(&'static str, &'static str)] {
        const SNOWMAN: &str = include_str!("../../../examples/snowman.trullo");
        &[("Snowman", SNOWMAN)]
    }
}

/// A modeler on a screen without pixels.
pub type Screen = Harness<'static, Modeler>;

/// One with an empty page.
pub fn screen(sessions: Option<PathBuf>) -> Screen {
    screen_with(sessions, |_| ())
}

/// One that begins as `prepare` says.
pub fn screen_with(sessions: Option<PathBuf>, prepare: impl FnOnce(&mut Modeler)) -> Screen {
    screen_at(TestDesk, sessions, prepare)
}

/// One with these files.
pub fn screen_at(
    desk: impl Desk + 'static,
    sessions: Option<PathBuf>,
    prepare: impl FnOnce(&mut Modeler),
) -> Screen {
    screen_of(vec2(1280.0, 800.0), desk, sessions, prepare)
}

/// One of this size, points.
pub fn screen_of(
    size: egui::Vec2,
    desk: impl Desk + 'static,
    sessions: Option<PathBuf>,
    prepare: impl FnOnce(&mut Modeler),
) -> Screen {
    let mut modeler = Modeler::new(Box::new(desk), sessions, Arc::new(|| ())).expect("threads");
    prepare(&mut modeler);
    let builder = Harness::builder().with_size(size);
    let mut screen =
        builder.build_ui_state(|ui, modeler: &mut Modeler| modeler.ui(ui, &mut NoStage), modeler);
    settle(&mut screen);
    screen
}

/// Lets frames pass until the background threads have nothing more to show.
pub fn settle(screen: &mut Screen) {
    let until = Instant::now() + Duration::from_secs(120);
    screen.run_steps(3);
    while !screen.state().is_at_rest() {
        assert!(Instant::now() < until, "it never comes to rest");
        std::thread::sleep(Duration::from_millis(5));
        screen.step();
    }
    screen.run_steps(2);
}

/// Saves to a file; whether that could be done.
pub fn save(screen: &mut Screen, file: impl Into<PathBuf>) -> bool {
    let file = file.into();
    screen.state_mut().save_to(file.clone(), None);
    settle(screen);
    screen.state().bench.file() == Some(&*file) && !screen.state().bench.is_unsaved()
}

/// The middle of the model view.
pub fn middle(screen: &Screen) -> Pos2 {
    screen.get_by_label("Model view").rect().center()
}

/// Draws a line with the pen.
pub fn draw(screen: &mut Screen, line: impl IntoIterator<Item = Pos2>) {
    let mut line = line.into_iter();
    let first = line.next().expect("a place to begin at");
    screen.hover_at(first);
    screen.drag_at(first);
    screen.step();
    let mut last = first;
    for place in line {
        screen.hover_at(place);
        last = place;
    }
    screen.drop_at(last);
    screen.step();
    settle(screen);
}

/// A closed circle.
pub fn circle(middle: Pos2, radius: f32) -> impl Iterator<Item = Pos2> {
    (0..=64).map(move |i| {
        let angle = std::f32::consts::TAU * i as f32 / 64.0;
        pos2(middle.x + radius * angle.cos(), middle.y + radius * angle.sin())
    })
}

/// Presses what has this name.
pub fn press(screen: &mut Screen, name: &str) {
    screen.get_by_label(name).click();
    settle(screen);
}

/// Puts a scene on the table.
pub fn put(screen: &mut Screen, root: impl Into<blobtree::NodeRef>) {
    screen.state_mut().put(Scene::new(root), None);
    settle(screen);
}

/// Where a place of the model is on the screen.
pub fn seen(screen: &Screen, place: impl Into<glam::Vec3>) -> Pos2 {
    let rect = screen.get_by_label("Model view").rect();
    let view = screen.state().camera.view(glam::Vec2::new(rect.width(), rect.height()));
    let at = view.screen_from_model(place.into()).expect("before the eye");
    rect.min + vec2(at.x, at.y)
}

/// Drags with the pen from one place to another, in steps, while the model follows.
pub fn drag(screen: &mut Screen, from: Pos2, by: egui::Vec2) {
    draw(screen, (0..=10).map(|i| from + by * (i as f32 / 10.0)));
}

/// Lets frames pass until something is so.
pub fn until(screen: &mut Screen, is_so: impl Fn(&Screen) -> bool) {
    let end = Instant::now() + Duration::from_secs(60);
    while !is_so(screen) {
        assert!(Instant::now() < end, "it never is");
        screen.step();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// A file that is dropped on the window.
#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

/// A screen with two balls, the second one grown out of the first, in the middle of the view; and that middle.
pub fn screen_with_two_balls() -> (Screen, Pos2) {
    let mut screen = screen(None);
    let at = middle(&screen);
    draw(&mut screen, circle(at, 110.0));
    press(&mut screen, "Inflate");
    draw(&mut screen, circle(at + vec2(110.0, 0.0), 60.0));
    press(&mut screen, "Grow");
    (screen, at)
}

/// A screen with the snowman of the gallery on the table.
pub fn screen_with_snowman() -> Screen {
    let mut screen = screen(None);
    press(&mut screen, "File");
    press(&mut screen, "Examples…");
    press(&mut screen, "Snowman");
    screen
}
