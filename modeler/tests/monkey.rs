//! A monkey at the modeler: random input, seeded. Nothing may panic, memory stays bounded, frames stay quick.
//!
//! `TRULLO_MONKEY` says for how many seconds, once for each of [`SEEDS`] seeds; a few without it.

mod common;

use common::*;
use egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchDeviceId, TouchId,
    TouchPhase,
};
use egui::{Role, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use fastrand::Rng;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How many monkeys there are, one after the other.
const SEEDS: u64 = 5;

/// How long each plays if nobody says, seconds.
const SHORT: f64 = 1.5;

/// More than this is a leak, or a document out of bounds, bytes.
const MOST_MEMORY: u64 = 2 << 30;

/// A frame that takes longer is no answer to a hand. Machines that run tests are busy.
const LONGEST_FRAME: Duration = Duration::from_secs(4);

const KEYS: [Key; 24] = [
    Key::Z,
    Key::Y,
    Key::N,
    Key::O,
    Key::S,
    Key::E,
    Key::D,
    Key::P,
    Key::F,
    Key::T,
    Key::V,
    Key::M,
    Key::G,
    Key::Delete,
    Key::Escape,
    Key::Enter,
    Key::Questionmark,
    Key::Tab,
    Key::Space,
    Key::Num0,
    Key::Num3,
    Key::ArrowDown,
    Key::ArrowUp,
    Key::Backspace,
];

/// A monkey with its hand on the screen.
struct Monkey {
    rng: Rng,
    size: Vec2,
    files: Vec<PathBuf>,
    worst: Duration,
    /// Which of its plays it is at.
    doing: u32,
}

impl Monkey {
    fn place(&mut self) -> Pos2 {
        pos2(self.rng.f32() * self.size.x, self.rng.f32() * self.size.y)
    }

    /// A frame with these events.
    fn frame(&mut self, screen: &mut Screen, events: impl IntoIterator<Item = Event>) {
        screen.input_mut().events.extend(events);
        let began = Instant::now();
        screen.step();
        self.worst = self.worst.max(began.elapsed());
    }

    fn button(at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
        Event::PointerButton { pos: at, button, pressed, modifiers }
    }

    fn modifiers(&mut self) -> Modifiers {
        let mut modifiers = Modifiers::NONE;
        if self.rng.u32(..3) == 0 {
            modifiers |= Modifiers::COMMAND | Modifiers::CTRL;
        }
        if self.rng.u32(..4) == 0 {
            modifiers |= Modifiers::SHIFT;
        }
        modifiers
    }

    /// Does something.
    fn play(&mut self, screen: &mut Screen) {
        self.doing = self.rng.u32(..22);
        match self.doing {
            0..=5 => self.stroke(screen),
            6..=9 => self.tap(screen),
            10 | 11 => self.key(screen),
            12 => self.wheel(screen),
            13 | 14 => self.touch(screen),
            15 => self.text(screen),
            16 => {
                self.size = vec2(300.0 + self.rng.f32() * 1500.0, 200.0 + self.rng.f32() * 1000.0);
                screen.set_size(self.size);
                self.frame(screen, []);
            }
            17 => {
                let file = self.files[self.rng.usize(..self.files.len())].clone();
                screen.input_mut().dropped_files.push(Arc::new(Dropped(file)));
                self.frame(screen, []);
            }
            18 => {
                let focused = self.rng.bool();
                self.frame(screen, [Event::PointerGone, Event::WindowFocused(focused)]);
            }
            // The sketch becomes what is likeliest.
            19 => {
                for _ in 0..40 {
                    self.frame(screen, []);
                    std::thread::sleep(Duration::from_millis(2));
                }
                self.press(screen, Key::Enter, Modifiers::NONE);
            }
            20 => self.press(screen, Key::Escape, Modifiers::NONE),
            // The threads behind get a little time.
            _ => {
                for _ in 0..10 {
                    self.frame(screen, []);
                    std::thread::sleep(Duration::from_millis(4));
                }
            }
        }
    }

    /// A stroke, round or wild, sometimes with another button, sometimes left in the air.
    fn stroke(&mut self, screen: &mut Screen) {
        let (middle, radius) = (self.place(), 10.0 + self.rng.f32() * 200.0);
        let [turns, bend, wild] = [self.rng.f32() * 2.2, self.rng.f32() * 5.0, self.rng.f32()];
        let wild = if wild < 0.2 { 300.0 * wild } else { 0.0 };
        let button = *self.rng.choice(&[PointerButton::Primary; 5]).unwrap_or(&PointerButton::Primary);
        let button = if self.rng.u32(..6) == 0 { PointerButton::Secondary } else { button };
        let modifiers = self.modifiers();
        let steps = 3 + self.rng.u32(..60);
        for step in 0..=steps {
            let angle = std::f32::consts::TAU * turns * step as f32 / steps as f32;
            let radius = radius * (1.0 + 0.3 * (bend * angle).sin());
            let shaken = vec2(self.rng.f32() - 0.5, self.rng.f32() - 0.5) * wild;
            let at = middle + radius * vec2(angle.cos(), angle.sin()) + shaken;
            let moved = Event::PointerMoved(at);
            match step {
                0 => self.frame(screen, [moved, Self::button(at, button, true, modifiers)]),
                _ if step == steps && self.rng.u32(..20) > 0 => {
                    self.frame(screen, [moved, Self::button(at, button, false, modifiers)]);
                }
                _ => self.frame(screen, [moved]),
            }
        }
    }

    fn tap(&mut self, screen: &mut Screen) {
        // On something to be pressed, or anywhere.
        let roles = [Role::Button, Role::Button, Role::CheckBox, Role::SpinButton, Role::ComboBox];
        let role = roles[self.rng.usize(..roles.len())];
        let places: Vec<Pos2> = screen.query_all_by_role(role).map(|node| node.rect().center()).collect();
        let at = match self.rng.choice(&places) {
            Some(&place) if self.rng.u32(..3) > 0 => place,
            _ => self.place(),
        };
        let button = if self.rng.u32(..5) == 0 { PointerButton::Secondary } else { PointerButton::Primary };
        let modifiers = self.modifiers();
        self.frame(screen, [Event::PointerMoved(at)]);
        self.frame(screen, [Self::button(at, button, true, modifiers)]);
        self.frame(screen, [Self::button(at, button, false, modifiers)]);
    }

    fn key(&mut self, screen: &mut Screen) {
        let key = KEYS[self.rng.usize(..KEYS.len())];
        let modifiers = self.modifiers();
        self.press(screen, key, modifiers);
    }

    fn press(&mut self, screen: &mut Screen, key: Key, modifiers: Modifiers) {
        for pressed in [true, false] {
            self.frame(screen, [Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }]);
        }
    }

    fn wheel(&mut self, screen: &mut Screen) {
        let (at, modifiers) = (self.place(), self.modifiers());
        let delta = vec2(self.rng.f32() - 0.5, self.rng.f32() - 0.5) * 400.0;
        let (unit, phase, source) = (MouseWheelUnit::Point, TouchPhase::Move, MouseWheelSource::Unknown);
        let wheel = Event::MouseWheel { unit, delta, phase, modifiers, source };
        let zoom = Event::Zoom(0.3 + 2.0 * self.rng.f32());
        self.frame(screen, [Event::PointerMoved(at), wheel]);
        if self.rng.bool() {
            self.frame(screen, [zoom]);
        }
    }

    /// One to three fingers, which need not be lifted in order, or at all.
    fn touch(&mut self, screen: &mut Screen) {
        let fingers = 1 + self.rng.u64(..3);
        let places: Vec<Pos2> = (0..fingers).map(|_| self.place()).collect();
        let force = self.rng.bool().then(|| self.rng.f32());
        let event = |finger: u64, phase, pos| Event::Touch {
            device_id: TouchDeviceId(1),
            id: TouchId(finger),
            phase,
            pos,
            force,
        };
        for (finger, &at) in (0..).zip(&places) {
            self.frame(screen, [event(finger, TouchPhase::Start, at)]);
        }
        for _ in 0..self.rng.u32(..20) {
            let by = vec2(self.rng.f32() - 0.5, self.rng.f32() - 0.5) * 60.0;
            let moved: Vec<Event> =
                (0..).zip(&places).map(|(finger, &at)| event(finger, TouchPhase::Move, at + by)).collect();
            self.frame(screen, moved);
        }
        let end = if self.rng.u32(..5) == 0 { TouchPhase::Cancel } else { TouchPhase::End };
        for (finger, &at) in (0..).zip(&places) {
            self.frame(screen, [event(finger, end, at)]);
        }
    }

    fn text(&mut self, screen: &mut Screen) {
        // Letters that the fonts have: the harness takes others for a mistake of ours.
        let words = ["12.5", "-1e9", "ball", "NaN", "äßç", "0", "x.trullo", "999999999999"];
        let word = words[self.rng.usize(..words.len())];
        self.frame(screen, [Event::Text(word.into())]);
        if self.rng.bool() {
            self.press(screen, Key::Enter, Modifiers::NONE);
        }
    }
}

/// What is on the table, in numbers.
fn tree(screen: &Screen) -> String {
    let (mut nodes, mut deepest) = (0, 0);
    let mut waiting = vec![(screen.state().bench.scene().root.clone(), 0)];
    while let Some((node, depth)) = waiting.pop() {
        nodes += 1;
        deepest = deepest.max(depth);
        waiting.extend(node.children().iter().map(|child| (child.clone(), depth + 1)));
    }
    format!("{nodes} nodes in {deepest} levels")
}

/// The memory of this process, bytes; 0 where nobody says.
fn memory() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    statm.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or_default() * 4096
}

/// Files to be dropped: sound ones, and ones that are not.
fn files(folder: &Path) -> Vec<PathBuf> {
    let files: [(&str, &[u8]); 7] = [
        ("snowman.trullo", include_bytes!("../../examples/snowman.trullo")),
        ("dog.trullo", include_bytes!("../../examples/dog-head.trullo")),
        ("broken.trullo", b"{\"format\": \"trullo\", \"version\": 1, \"root\": {\"type\": \"pint\"}}"),
        ("strokes.json", b"[[[0,0],[40,0],[40,30],[0,30],[0,0]]]"),
        ("nothing.json", b""),
        ("noise.stl", &[7; 300]),
        ("ball.svg", b"<svg xmlns='http://www.w3.org/2000/svg'><circle r='9'/></svg>"),
    ];
    let mut paths = vec![folder.join("not there.trullo"), folder.to_path_buf()];
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).expect("there is room");
        paths.push(folder.join(name));
    }
    paths
}

#[test]
fn nothing_that_a_monkey_does_ends_or_stalls_the_modeler() {
    let seconds = std::env::var("TRULLO_MONKEY").ok().and_then(|text| text.parse().ok()).unwrap_or(SHORT);
    let folder = tempfile::tempdir().expect("a folder");
    // Names that it types end here.
    let dropped = files(folder.path());
    std::env::set_current_dir(folder.path()).expect("it is there");
    for seed in 1..=SEEDS {
        println!("seed {seed}");
        let mut monkey = Monkey {
            rng: Rng::with_seed(seed),
            size: vec2(1280.0, 800.0),
            files: dropped.clone(),
            worst: Duration::ZERO,
            doing: 0,
        };
        let mut screen = screen(Some(folder.path().join("sessions")));
        let (began, mut most) = (Instant::now(), 0);
        let mut plays = 0;
        while began.elapsed().as_secs_f64() < seconds {
            monkey.play(&mut screen);
            plays += 1;
            most = most.max(memory());
            assert!(most < MOST_MEMORY, "seed {seed}: {} MiB after {plays} plays", most >> 20);
            assert!(
                monkey.worst < LONGEST_FRAME,
                "seed {seed}: a frame of {:?} after {plays} plays, the last of kind {}; {}",
                monkey.worst,
                monkey.doing,
                tree(&screen)
            );
        }
        let document = screen.state().bench.document();
        println!(
            "  {plays} plays, {}, {} steps in the history, worst frame {:.0} ms, {} MiB at most",
            tree(&screen),
            document.undo_names().count(),
            monkey.worst.as_secs_f64() * 1e3,
            most >> 20
        );
    }
}
