//! How long a user waits, by the modeler's own trace: medians and worst of 200.
//!
//! `cargo bench -p modeler --bench latency [-- COUNT]`. The window's part, painting, is missing here: run the program
//! with `--trace FILE` for that. Every answer is checked: a suggestion must become a solid, a drag must move one.

#[path = "../tests/common/mod.rs"]
mod common;

use blobtree::{NodePath, Scene};
use common::*;
use egui::{Key, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use modeler::trace::Trace;
use serde_json::Value;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A hundred nodes: a figure of blended parts.
const CHARACTER: &str = include_str!("../../benches/scenes/character100.trullo");

/// A frame on a screen with 60 of them in a second.
const FRAME: Duration = Duration::from_micros(16_667);

/// What is written down, kept in memory.
#[derive(Clone, Default)]
struct Paper(Arc<Mutex<Vec<u8>>>);

impl Write for Paper {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Paper {
    fn lines(&self) -> Vec<Value> {
        let written = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let lines = written.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        lines.map(|line| serde_json::from_slice(line).expect("JSON")).collect()
    }

    /// One number of all lines that wait for this.
    fn all(&self, what: &str, number: &str) -> Vec<f64> {
        let lines = self.lines();
        let ours = lines.iter().filter(|line| line["what"] == what);
        ours.filter_map(|line| line[number].as_f64()).collect()
    }
}

fn tell(name: &str, mut numbers: Vec<f64>) {
    numbers.sort_by(f64::total_cmp);
    if numbers.is_empty() {
        println!("{name:<46} none");
        return;
    }
    let at = |share: f64| numbers[((numbers.len() - 1) as f64 * share).round() as usize];
    println!(
        "{name:<46} median {:7.2} ms   95 % {:7.2} ms   worst {:7.2} ms   of {}",
        at(0.5),
        at(0.95),
        at(1.0),
        numbers.len()
    );
}

/// A frame with these events, at its time on a screen; other threads have the rest of it.
fn frame(screen: &mut Screen, events: impl IntoIterator<Item = egui::Event>) {
    let began = Instant::now();
    let mut input = std::mem::take(screen.input_mut());
    input.events.extend(events);
    *screen.input_mut() = input;
    screen.step();
    std::thread::sleep(FRAME.saturating_sub(began.elapsed()));
}

fn wait(screen: &mut Screen, what: &str, until: impl Fn(&Screen) -> bool) {
    let latest = Instant::now() + Duration::from_secs(60);
    while !until(screen) {
        assert!(Instant::now() < latest, "no {what}");
        frame(screen, []);
    }
}

fn button(at: Pos2, pressed: bool) -> egui::Event {
    let modifiers = egui::Modifiers::NONE;
    egui::Event::PointerButton { pos: at, button: egui::PointerButton::Primary, pressed, modifiers }
}

/// An outline with bays and capes, another one for each number.
fn outline(middle: Pos2, number: usize) -> Vec<Pos2> {
    let lobes = 2.0 + (number % 5) as f32;
    (0..=90)
        .map(|i| {
            let angle = std::f32::consts::TAU * i as f32 / 90.0;
            let radius = 110.0 + 22.0 * (lobes * angle + number as f32).sin();
            middle + radius * vec2(angle.cos(), angle.sin())
        })
        .collect()
}

fn main() {
    let count = std::env::args().filter_map(|word| word.parse().ok()).next().unwrap_or(200);
    strokes(count);
    drags(count);
    frames(count);
}

/// From strokes to solids, each on an empty page.
fn strokes(count: usize) {
    let paper = Paper::default();
    let mut screen = screen(None);
    screen.state_mut().trace = Some(Trace::new(Box::new(paper.clone())));
    let at = middle(&screen);
    for number in 0..count {
        let line = outline(at, number);
        frame(&mut screen, [egui::Event::PointerMoved(line[0])]);
        frame(&mut screen, [button(line[0], true)]);
        // Pens say where they are more often than screens show it.
        for places in line[1..].chunks(4) {
            frame(&mut screen, places.iter().map(|place| egui::Event::PointerMoved(*place)));
        }
        frame(&mut screen, [button(line[line.len() - 1], false)]);
        wait(&mut screen, "suggestion", |screen| {
            screen.state().pad.expectations.as_ref().is_some_and(|found| !found.suggestions.is_empty())
        });
        screen.key_press(Key::Enter);
        frame(&mut screen, []);
        wait(&mut screen, "solid", |screen| {
            screen.state().solid().is_some_and(|solid| !solid.corners.is_empty())
        });
        screen.state_mut().put(modeler::workbench::Workbench::empty_page(), None);
        settle(&mut screen);
    }
    println!("a stroke of 90 places on an empty page, taken as its first suggestion");
    tell("  pen to stroke", paper.all("pen_to_stroke", "ms"));
    let [asked, made] = ["stroke_to_suggestions", "choice_to_solid"].map(|what| paper.all(what, "ms"));
    assert!(asked.len() >= count && made.len() >= count, "{} and {} answers", asked.len(), made.len());
    tell("  stroke to suggestions", asked.clone());
    tell("  choice to solid", made.clone());
    tell("  stroke to solid, without the choice", asked.iter().zip(&made).map(|(a, b)| a + b).collect());
    let [asked, made] =
        ["stroke_to_suggestions", "choice_to_solid"].map(|what| paper.all(what, "geometry_ms"));
    tell("  stroke to solid, its geometry", asked.iter().zip(&made).map(|(a, b)| a + b).collect());
}

/// One of a hundred nodes is dragged.
fn drags(count: usize) {
    let paper = Paper::default();
    let mut screen = screen(None);
    let scene = Scene::from_bytes(CHARACTER.as_bytes(), &mut blobtree::NoSources).expect("a scene");
    screen.state_mut().put(scene, None);
    settle(&mut screen);
    let (path, from) = handle(&mut screen);
    frame(&mut screen, [egui::Event::PointerMoved(from)]);
    frame(&mut screen, [button(from, true)]);
    screen.state_mut().trace = Some(Trace::new(Box::new(paper.clone())));
    let before = screen.state().selected_box().expect("it is somewhere").center();
    for step in 0.. {
        let at = from + vec2(40.0 * (0.11 * step as f32).sin(), 30.0 * (0.07 * step as f32).sin());
        frame(&mut screen, [egui::Event::PointerMoved(at)]);
        if paper.all("drag_to_solid", "ms").len() >= count {
            break;
        }
        assert!(step < 50 * count, "nothing follows");
    }
    assert_ne!(screen.state().selected_box().expect("it is somewhere").center(), before, "{path} stays");
    println!("one of 100 nodes is dragged, 60 places a second");
    tell("  drag to solid", paper.all("drag_to_solid", "ms"));
    tell("  drag to solid, its geometry", paper.all("drag_to_solid", "geometry_ms"));
    tell("  frames meanwhile", paper.all("frame", "ms"));
}

/// Selects a part whose middle handle is free, and says where that is.
fn handle(screen: &mut Screen) -> (NodePath, Pos2) {
    let root = screen.state().bench.scene().root.clone();
    let mut paths = vec![NodePath::default()];
    let mut leaves = Vec::new();
    while let Some(path) = paths.pop() {
        let node = path.find(&root).expect("it is there");
        paths.extend((0..node.children().len()).map(|index| path.child(index)));
        if node.children().is_empty() {
            leaves.push(path);
        }
    }
    let middle_leaf = leaves[leaves.len() / 2].clone();
    screen.state_mut().select(Some(middle_leaf.clone()));
    screen.run_steps(3);
    let rect = screen.get_by_label("Model view").rect();
    let view = screen.state().camera.view(glam::Vec2::new(rect.width(), rect.height()));
    let center = screen.state().selected_box().expect("it is somewhere").center();
    let place = view.screen_from_model(center).expect("before the eye");
    (middle_leaf, rect.min + vec2(place.x, place.y))
}

/// Frames while the fine solid of a hundred nodes is made again and again.
fn frames(count: usize) {
    let paper = Paper::default();
    let mut screen = screen(None);
    screen.state_mut().trace = Some(Trace::new(Box::new(paper.clone())));
    let computing = |paper: &Paper| -> Vec<f64> {
        let lines = paper.lines();
        let busy = lines.iter().filter(|line| line["what"] == "frame" && line["computing"] == true);
        busy.filter_map(|line| line["ms"].as_f64()).collect()
    };
    let latest = Instant::now() + Duration::from_secs(300);
    while computing(&paper).len() < count {
        assert!(Instant::now() < latest, "nothing is computed");
        // Read anew, so that nothing of it is known from before.
        let scene = Scene::from_bytes(CHARACTER.as_bytes(), &mut blobtree::NoSources).expect("a scene");
        screen.state_mut().put(scene, None);
        frame(&mut screen, []);
        wait(&mut screen, "fine solid", |screen| screen.state().is_at_rest());
    }
    println!("frames while 100 nodes become fine");
    tell("  frames", computing(&paper));
}
