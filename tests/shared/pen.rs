//! Drawings played with the pen in the modeler become what `trullo sketch` makes of their files.

use crate::doodles::files;
use crate::trullo;
use blobtree::{Command, DrawingsBy, Field, NodeRef, Primitive, Scene, SceneSources, Shape, Tree};
use eframe::egui::{self, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2, vec2};
use glam::{Vec2, Vec3};
use modeler::Modeler;
use modeler::camera::Camera;
use modeler::desk::{Desk, ExportOptions, Opened, Purpose};
use modeler::errand::{Undone, Watch};
use modeler::stage::NoStage;
use sketch::stroke::{DoodleChoice, FileFormat, Sketch, Stroke, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How many drawings with an outline are played: the first of each of as many files.
const DRAWINGS: usize = 100;

/// The larger side of a drawing, mm, as the command line has it. On the screen, a point is a pixel of the file.
const MM: f32 = 60.0;

/// So many have the very strokes of their files; in the others, something drawn is taken for a gesture, such as hair for
/// a scribble that rubs out.
const ALIKE: usize = 97;

/// So many become the same solid. Strokes that differ in a millionth of a millimetre are solved differently now and then.
const SAME_SOLIDS: usize = 95;

/// Solids are the same if they differ in less than this share.
const SAME: f32 = 0.01;

/// How fast the hand is, points a second.
const SPEED: f32 = 150.0;

/// No files at all.
struct NoDesk;

impl Desk for NoDesk {
    fn open(&self, _: &Path, _: &Watch) -> Result<Opened, Undone> {
        Err(Undone::Failed("no files here".into()))
    }

    fn sources<'a>(&'a self, _: Option<&'a Path>) -> Box<dyn SceneSources + 'a> {
        Box::new(DrawingsBy(sketch::solve))
    }

    fn export(&self, _: &Scene, _: &Path, _: &ExportOptions, _: &Watch) -> Result<String, Undone> {
        Err(Undone::Failed("no files here".into()))
    }

    fn browse(&self, _: Purpose, _: Option<&Path>, _: Arc<dyn Fn() + Send + Sync>) -> bool {
        false
    }

    fn browsed(&self) -> Option<Option<PathBuf>> {
        None
    }

    fn examples(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }
}

/// A modeler with a hand at it.
struct Hand {
    ctx: egui::Context,
    modeler: Modeler,
    time: f64,
    /// From places of the view to places of the screen.
    corner: egui::Vec2,
    /// The size of the view.
    view: Vec2,
}

impl Hand {
    fn new() -> Self {
        let modeler = Modeler::new(Box::new(NoDesk), None, Arc::new(|| ())).expect("threads");
        let mut hand = Self {
            ctx: egui::Context::default(),
            modeler,
            time: 0.0,
            corner: egui::Vec2::ZERO,
            view: Vec2::ZERO,
        };
        hand.frame(vec![]);
        hand.frame(vec![]);
        // A short stroke in the middle says where the view is.
        let at = pos2(640.0, 400.0);
        let line = [at, at + vec2(30.0, 4.0), at + vec2(60.0, -9.0)];
        hand.press(line[0]);
        let seen = hand.modeler.pad.current().expect("it draws").samples[0].place();
        hand.corner = at - pos2(seen.x, seen.y);
        for at in line {
            hand.frame(vec![Event::PointerMoved(at)]);
        }
        hand.lift(line[2]);
        hand.view = hand.modeler.pad.drawn_in().expect("a stroke").screen;
        hand
    }

    fn frame(&mut self, events: Vec<Event>) {
        let screen = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0));
        let input =
            RawInput { screen_rect: Some(screen), time: Some(self.time), events, ..Default::default() };
        let modeler = &mut self.modeler;
        let mut output = self.ctx.run_ui(input, |ui| modeler.ui(ui, &mut NoStage));
        // Nobody paints.
        output.textures_delta.clear();
    }

    fn press(&mut self, at: Pos2) {
        self.frame(vec![Event::PointerMoved(at), Self::button(at, true)]);
    }

    fn lift(&mut self, at: Pos2) {
        self.frame(vec![Self::button(at, false)]);
    }

    fn button(at: Pos2, pressed: bool) -> Event {
        let modifiers = Modifiers::NONE;
        Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers }
    }

    /// An empty page, seen from the front as the command line sees a drawing that is so large on the screen, points.
    fn new_page(&mut self, larger_side: f32) {
        self.modeler.put(modeler::workbench::Workbench::empty_page(), None);
        let mut camera = Camera { perspective: false, azimuth: 0.0, elevation: 0.0, ..Camera::default() };
        camera.target = Vec3::ZERO;
        camera.distance *= MM / larger_side / camera.mm_per_px(self.view);
        self.modeler.camera = camera;
        self.frame(vec![]);
    }

    /// Draws a stroke whose places are in points around the middle of the view.
    fn stroke(&mut self, places: &[Vec2]) {
        let at = |place: Vec2| {
            let p = 0.5 * self.view + place;
            pos2(p.x, p.y) + self.corner
        };
        let line: Vec<Pos2> = places.iter().map(|place| at(*place)).collect();
        self.press(line[0]);
        for two in line.windows(2) {
            self.time += f64::from(two[0].distance(two[1]) / SPEED);
            self.frame(vec![Event::PointerMoved(two[1])]);
        }
        self.time += 0.02;
        self.lift(line[line.len() - 1]);
        // The hand goes to the next stroke.
        self.time += 0.4;
    }

    /// Waits for suggestions and takes the one that makes a node of this type; the node.
    fn choose(&mut self, type_name: &str) -> Result<NodeRef, String> {
        let until = Instant::now() + Duration::from_secs(60);
        while self.modeler.pad.expectations.is_none() {
            if Instant::now() > until || self.modeler.pad.is_empty() {
                return Err(format!("{} strokes on the pad", self.modeler.pad.sketch().strokes.len()));
            }
            std::thread::sleep(Duration::from_millis(1));
            self.frame(vec![]);
        }
        let found = self.modeler.pad.expectations.as_ref().expect("it is there");
        let made = |command: &Command| match command {
            Command::Insert { node, .. } => Some(node.type_name() == type_name),
            _ => None,
        };
        let names: Vec<&str> = found.suggestions.iter().map(|suggestion| suggestion.name).collect();
        let place = found.suggestions.iter().position(|suggestion| made(&suggestion.command) == Some(true));
        let place = place.ok_or_else(|| format!("no {type_name} in {names:?}: {:?}", found.no_outline))?;
        self.modeler.choose(place);
        Ok(self.modeler.bench.scene().root.children()[0].clone())
    }
}

/// The strokes of a file's first drawing, in points: the middle of its lowest edge at the origin; and its larger side.
fn strokes(file: &Path) -> (Vec<Stroke>, f32) {
    let bytes = std::fs::read(file).expect("a readable file");
    let strokes = read(&bytes, FileFormat::Doodles, &DoodleChoice::default()).expect("a sound file");
    let sketch = Sketch::from_strokes(&strokes);
    let [lo, hi] = sketch.bounds().expect("some strokes");
    let origin = Vec2::new(0.5 * (lo.x + hi.x), hi.y);
    let moved = |stroke: &Stroke| Stroke::through(stroke.places().map(|place| place - origin));
    (strokes.iter().map(moved).collect(), (hi - lo).max_element())
}

/// How much of two solids only one of them has, as a share of both: by a lattice around them, up to 60 mm from the
/// origin.
fn difference(a: &NodeRef, b: &NodeRef) -> f32 {
    let (a, b) = (Tree::new(a), Tree::new(b));
    let places = (0..80).flat_map(|x| (0..20).flat_map(move |y| (0..80).map(move |z| [x, y, z])));
    let at =
        |[x, y, z]: [u16; 3]| Vec3::new(f32::from(x) - 39.5, 2.0 * f32::from(y) - 19.0, f32::from(z) - 9.5);
    let (mut one, mut both) = (0, 0);
    for place in places.map(at) {
        match [a.value(place) >= 0.5, b.value(place) >= 0.5] {
            [true, true] => both += 1,
            [false, false] => {}
            _ => one += 1,
        }
    }
    one as f32 / (one + both).max(1) as f32
}

/// Whether a stroke is a tap of the pen, which selects.
fn is_dot(stroke: &Stroke) -> bool {
    let first = stroke.places().next().unwrap_or_default();
    stroke.places().all(|place| place.distance(first) < 4.0)
}

/// How far the strokes on the pad are from those of the file, points; a reason if they are others.
fn apart(pad: &Sketch, strokes: &[Stroke], middle: Vec2) -> Result<f32, String> {
    let wanted = Sketch::from_strokes(strokes.iter().filter(|stroke| !is_dot(stroke)));
    let counts = |sketch: &Sketch| -> Vec<usize> {
        sketch.strokes.iter().map(|stroke| stroke.samples.len()).collect()
    };
    if counts(pad) != counts(&wanted) {
        return Err(format!("strokes of {:?} places instead of {:?}", counts(pad), counts(&wanted)));
    }
    let pairs = pad.places().zip(wanted.places());
    Ok(pairs.map(|(a, b)| (a - middle).distance(b)).fold(0.0, f32::max))
}

#[test]
fn a_hundred_drawings_played_with_the_pen_are_the_scenes_of_the_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut hand = Hand::new();
    let (mut drawn, mut same, mut others) = (0, 0, Vec::new());
    let mut played = 0;
    for file in &files() {
        if played == DRAWINGS {
            break;
        }
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let output = folder.path().join("scene.trullo");
        let args = ["sketch".as_ref(), file.as_os_str(), "-o".as_ref(), output.as_os_str(), "-q".as_ref()];
        let written = trullo(args);
        if !written.status.success() {
            continue;
        }
        let bytes = std::fs::read(&output).expect("it was written");
        let scene = Scene::from_bytes(&bytes, &mut DrawingsBy(sketch::solve)).expect("a legal scene");
        let root = &scene.root;
        let is_wrapped = matches!(root.shape, Shape::Operator(..)) && root.children().len() == 1;
        let wanted = if is_wrapped { root.children()[0].clone() } else { root.clone() };
        if !matches!(wanted.shape, Shape::Primitive(Primitive::Inflation(_))) {
            // A drawing without an outline.
            continue;
        }
        played += 1;
        let (strokes, larger_side) = strokes(file);
        hand.new_page(larger_side);
        for stroke in &strokes {
            hand.stroke(&stroke.places().collect::<Vec<_>>());
        }
        match apart(hand.modeler.pad.sketch(), &strokes, 0.5 * hand.view) {
            Ok(small) if small < 1e-3 => drawn += 1,
            Ok(large) => others.push(format!("{name}: places up to {large} points away")),
            Err(reason) => others.push(format!("{name}: {reason}")),
        }
        match hand.choose(wanted.type_name()) {
            Ok(made) => match difference(&wanted, &made) {
                small if small < SAME => same += 1,
                large => others.push(format!("{name}: {:.1} % differ", 100.0 * large)),
            },
            Err(reason) => others.push(format!("{name}: {reason}")),
        }
    }
    let told = format!("{drawn} are drawn alike, {same} are the same solids; others:\n{}", others.join("\n"));
    println!("{told}");
    assert_eq!(played, DRAWINGS, "drawings with an outline");
    assert!(drawn >= ALIKE && same >= SAME_SOLIDS, "{told}");
}
