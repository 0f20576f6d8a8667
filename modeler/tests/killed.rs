//! Nothing is lost: a modeler that is killed at any moment comes back as it was last shown.
//!
//! `TRULLO_KILLS` says how often it is tried; a few times without it.

mod common;

use blobtree::random::RandomTree;
use blobtree::{Color, Command, JournalEntry, Node, NodePath, NodeRef, Operator, Scene, Sharpness};
use common::*;
use egui::{Key, Modifiers};
use fastrand::Rng;
use modeler::desk::Desk as _;
use modeler::journal::LeftBehind;
use modeler::variants::{Variants, Vary};
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// The folder in which the process edits that is to be killed.
const FOLDER: &str = "TRULLO_KILLED_IN";

/// Its seed.
const SEED: &str = "TRULLO_KILLED_SEED";

/// How many times it is killed, if nobody says.
const FEW: u64 = 8;

/// The longest that it lives after its first frame, ms.
const LONGEST: u64 = 2500;

/// What a document is, in one word: its scene, and how far it can be undone and redone.
fn state(scene: &Scene, undo: usize, redo: usize) -> String {
    use std::hash::{DefaultHasher, Hash as _, Hasher as _};
    let mut hasher = DefaultHasher::new();
    scene.to_text().expect("legal").hash(&mut hasher);
    format!("{:016x}/{undo}/{redo}", hasher.finish())
}

fn state_of(variants: &Variants) -> String {
    let document = variants.document();
    state(&variants.whole(), document.undo_names().count(), document.redo_names().count())
}

/// The process that edits, and says in a file what it is about to do and what it shows.
#[test]
#[ignore = "is the process that the other tests kill"]
fn editor() {
    let (Ok(folder), Ok(seed)) = (std::env::var(FOLDER), std::env::var(SEED)) else { return };
    let (folder, seed) = (Path::new(&folder), seed.parse().expect("a number"));
    let mut told = File::create(folder.join("told")).expect("a file");
    let mut screen = screen(Some(folder.join("sessions")));
    let (mut rng, mut trees) = (Rng::with_seed(seed), RandomTree::new(seed));
    trees.depth = 3;
    let mut tell =
        |word: &str, state: &str| told.write_all(format!("{word} {state}\n").as_bytes()).expect("room");
    tell("shown", &state_of(screen.state().bench.variants()));
    // More than there is time for.
    for step in 0..100_000 {
        match rng.u32(..12) {
            0 => undo_or_redo(&mut screen, true, &mut tell),
            1 => undo_or_redo(&mut screen, false, &mut tell),
            2 if step % 3 == 0 => sketch(&mut screen, &mut rng, &mut tell),
            3 => {
                // Saving must neither change nor lose anything.
                assert!(save(&mut screen, folder.join("saved.trullo")));
                tell("saved", &state_of(screen.state().bench.variants()));
            }
            4 => {
                let vary = vary(&mut rng, screen.state().bench.variants());
                let mut next = screen.state().bench.variants().clone();
                if next.vary(vary.clone()).is_ok() {
                    tell("next", &state_of(&next));
                    screen.state_mut().vary(vary);
                }
            }
            _ => {
                let command = command(&mut rng, &mut trees, &screen.state().bench.scene().root);
                about_to(&screen, &command, &mut tell);
                screen.state_mut().act(JournalEntry::Command(command));
            }
        }
        screen.step();
        tell("shown", &state_of(screen.state().bench.variants()));
    }
}

/// Something that the panel of variants might do.
fn vary(rng: &mut Rng, variants: &Variants) -> Vary {
    let names: Vec<&str> = variants.all().map(|(name, ..)| name).collect();
    let name = names[rng.usize(..names.len())].to_owned();
    match rng.u32(..5) {
        0 | 1 => Vary::Keep { name: variants.free_name() },
        2 => Vary::Switch { name },
        3 => Vary::Remove { name },
        _ => Vary::Rename { name, to: format!("renamed {}", rng.u32(..9)) },
    }
}

/// Says what the document will be after a command, if it can be carried out.
fn about_to(screen: &Screen, command: &Command, tell: &mut impl FnMut(&str, &str)) {
    let mut variants = screen.state().bench.variants().clone();
    if variants.repeat(JournalEntry::Command(command.clone())).is_ok() {
        tell("next", &state_of(&variants));
    }
}

fn undo_or_redo(screen: &mut Screen, undo: bool, tell: &mut impl FnMut(&str, &str)) {
    let mut variants = screen.state().bench.variants().clone();
    if let Ok(Some(_)) = variants.repeat(if undo { JournalEntry::Undo } else { JournalEntry::Redo }) {
        tell("next", &state_of(&variants));
    }
    screen.key_press_modifiers(Modifiers::COMMAND, if undo { Key::Z } else { Key::Y });
}

/// A circle becomes the first of its suggestions.
fn sketch(screen: &mut Screen, rng: &mut Rng, tell: &mut impl FnMut(&str, &str)) {
    let at = middle(screen) + egui::vec2(rng.f32() * 200.0 - 100.0, rng.f32() * 100.0 - 50.0);
    draw(screen, circle(at, 30.0 + 60.0 * rng.f32()));
    let found = screen.state().pad.expectations.as_ref().and_then(|found| found.suggestions.first().cloned());
    if let Some(first) = found {
        about_to(screen, &first.command, tell);
        screen.key_press(Key::Enter);
    }
}

/// A command that a panel might give.
fn command(rng: &mut Rng, trees: &mut RandomTree, root: &NodeRef) -> Command {
    let mut paths = vec![NodePath::default()];
    let mut at = 0;
    while at < paths.len() {
        let path = paths[at].clone();
        let children = path.find(root).map_or(0, |node| node.children().len());
        paths.extend((0..children).map(|index| path.child(index)));
        at += 1;
    }
    let path = paths[rng.usize(..paths.len())].clone();
    let new = || -> Node { Node::new(trees.leaf().shape) };
    match rng.u32(..9) {
        0 => Command::SetName { path, name: Some(format!("part {}", rng.u32(..100))) },
        1 => Command::SetColor { path, color: Some(Color([rng.u8(..), rng.u8(..), rng.u8(..)])) },
        2 => Command::SetMuted { path, muted: rng.bool() },
        3 => Command::WrapInOperator { path, operator: Operator::Blend(Sharpness::DEFAULT) },
        4 => Command::Remove { path },
        5 => Command::Move { from: path, parent: NodePath::default(), index: 0 },
        6 => Command::Unwrap { path },
        _ => Command::Insert { parent: NodePath::default(), index: 0, node: { new }().into() },
    }
}

/// A process that edits in `folder`.
fn start(folder: &Path, seed: u64) -> Child {
    std::process::Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "editor", "--ignored", "--test-threads=1"])
        .env(FOLDER, folder)
        .env(SEED, seed.to_string())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a process")
}

/// What is brought back from a folder, and whether anything was.
fn brought_back(folder: &Path, seed: u64) -> Option<Variants> {
    let mut left = LeftBehind::all(&folder.join("sessions"));
    assert!(left.len() <= 1, "seed {seed}: {} sessions", left.len());
    let desk = TestDesk;
    let recovered = left.pop()?.recover(&mut *desk.sources(None));
    let recovered = recovered.unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    assert_eq!(recovered.lost, None, "seed {seed}");
    Some(recovered.variants)
}

/// The state before the last step, but for what could be done again then.
fn before_last_step(variants: &Variants) -> Option<String> {
    let mut before = variants.clone();
    before.repeat(JournalEntry::Undo).ok()??;
    Some(without_redo(&state_of(&before)).to_owned())
}

fn without_redo(state: &str) -> &str {
    state.rsplit_once('/').map_or(state, |(rest, _)| rest)
}

#[test]
fn a_modeler_killed_at_any_moment_comes_back_as_it_was_last_shown() {
    let kills = std::env::var("TRULLO_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(FEW);
    let (mut exact, mut ahead, mut steps) = (0, 0, 0);
    for seed in 0..kills {
        let folder = tempfile::tempdir().expect("a folder");
        let mut process = start(folder.path(), seed);
        let told = folder.path().join("told");
        let until = Instant::now() + Duration::from_secs(60);
        while fs::metadata(&told).map_or(0, |told| told.len()) == 0 {
            assert!(Instant::now() < until, "seed {seed}: it never begins");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(Rng::with_seed(seed).u64(..1000 * LONGEST)));
        assert!(process.try_wait().expect("it is ours").is_none(), "seed {seed}: it ended by itself");
        process.kill().expect("it runs");
        process.wait().expect("it is ours");
        let text = fs::read_to_string(&told).expect("it was written");
        let lines: Vec<[&str; 2]> =
            text.lines().filter_map(|line| line.split_once(' ')).map(|(word, state)| [word, state]).collect();
        let last = lines.iter().rposition(|[word, _]| *word == "shown").expect("a first frame");
        let next = lines[last..].iter().rev().find(|[word, _]| *word == "next").map(|[_, state]| *state);
        let shown = lines[last][1];
        steps += lines.iter().filter(|[word, _]| *word == "shown").count();
        // Without a session, nothing was done yet.
        let back = brought_back(folder.path(), seed);
        let state = back.as_ref().map_or_else(|| lines[0][1].to_owned(), state_of);
        // A circle may meet a knob or a suggestion on its way, and do more than it was drawn for: one step that can
        // be undone.
        let is_a_step_further =
            || back.as_ref().and_then(before_last_step).is_some_and(|before| before == without_redo(shown));
        match state {
            state if state == shown => exact += 1,
            state if Some(&*state) == next || is_a_step_further() => ahead += 1,
            state => panic!("seed {seed}: {state} came back, {shown} was shown, {next:?} was next"),
        }
        if let Ok(bytes) = fs::read(folder.path().join("saved.trullo")) {
            let desk = TestDesk;
            let saved = Scene::from_bytes(&bytes, &mut *desk.sources(None));
            saved.unwrap_or_else(|e| panic!("seed {seed}: the user's file: {e}"));
        }
    }
    println!("{kills} kills after {steps} frames: {exact} as last shown, {ahead} a step further");
    assert_eq!(exact + ahead, kills);
}
