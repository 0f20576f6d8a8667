//! A disk that is full or may not be written: a message, and the work still there.
#![cfg(target_os = "linux")]

mod common;

use blobtree::build::point;
use blobtree::{Command, JournalEntry, NodePath, Scene};
use common::*;
use modeler::desk::Desk as _;
use modeler::journal::LeftBehind;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder in which the process works whose disk is full.
const FOLDER: &str = "TRULLO_FULL_DISK";

/// What is put on the table, one after the other.
fn ball(number: usize) -> JournalEntry {
    let node = point([number as f32, 0.0, 5.0], 5.0).into();
    JournalEntry::Command(Command::Insert { parent: NodePath::default(), index: 0, node })
}

fn balls(screen: &Screen) -> usize {
    screen.state().bench.scene().root.children().len()
}

fn told(screen: &Screen, word: &str) -> bool {
    screen.state().notices.texts().any(|text| text.contains(word))
}

/// The process whose files may have 4 KiB.
#[test]
#[ignore = "is the process for which the disk is full"]
fn cramped() {
    let Ok(folder) = std::env::var(FOLDER).map(PathBuf::from) else { return };
    let mut screen = screen(Some(folder.join("sessions")));
    let file = folder.join("mine.trullo");
    screen.state_mut().act(ball(0));
    assert!(save(&mut screen, &file), "one ball fits");
    let mine = fs::read(&file).expect("it is there");
    let mut number = 1;
    while !told(&screen, "can no longer be protected against a crash") {
        assert!(number < 500, "the disk is never full");
        assert!(screen.state_mut().act(ball(number)), "what is done is done");
        number += 1;
        screen.step();
    }
    // The work goes on, is all there, and can be taken back.
    for _ in 0..20 {
        assert!(screen.state_mut().act(ball(number)));
        number += 1;
        screen.step();
    }
    assert_eq!(balls(&screen), number);
    screen.state_mut().undo();
    assert_eq!(balls(&screen), number - 1);
    assert!(!screen.state().bench.is_protected());
    // The user's file is the one before, whole.
    while save(&mut screen, &file) {
        screen.state_mut().act(ball(number));
        number += 1;
        assert!(number < 1000, "everything can be saved");
    }
    assert!(told(&screen, "Not saved"));
    assert!(fs::read(&file).expect("it is there").starts_with(&mine[..20]));
    let whole = Scene::from_bytes(&fs::read(&file).expect("it is there"), &mut *TestDesk.sources(None));
    assert!(!whole.expect("a whole scene").root.children().is_empty());
    fs::write(folder.join("passed"), "").expect("nothing fits everywhere");
}

#[test]
fn a_full_disk_is_told_and_costs_nothing_that_was_done() {
    let folder = tempfile::tempdir().expect("a folder");
    // Bytes beyond the limit are an error of the write, as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 4; exec \"$0\" --exact cramped --ignored --test-threads=1";
    let output = std::process::Command::new("bash")
        .args(["-c", script])
        .arg(std::env::current_exe().expect("this test"))
        .env(FOLDER, folder.path())
        .output()
        .expect("bash");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(folder.path().join("passed").exists(), "{said}");
    // What was protected comes back.
    let left = LeftBehind::all(&folder.path().join("sessions"));
    let best = left.into_iter().max_by_key(|session| session.steps).expect("a session");
    let recovered = best.recover(&mut *TestDesk.sources(None)).expect("it is sound");
    assert_eq!(recovered.lost, None);
    assert!(recovered.variants.document().scene().root.children().len() > 3);
}

#[test]
fn folders_that_cannot_be_written_are_told_and_the_work_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a file");
    fs::write(&file, "no folder").expect("there is room");
    let mut screen = screen(Some(file.join("sessions")));
    assert!(told(&screen, "can no longer be protected"));
    screen.state_mut().act(ball(0));
    for nowhere in [file.join("mine.trullo"), Path::new("/proc/mine.trullo").into()] {
        assert!(!save(&mut screen, &nowhere));
        let name = nowhere.display().to_string();
        assert!(told(&screen, &name), "{:?}", screen.state().notices.texts().collect::<Vec<_>>());
    }
    assert!(screen.state().bench.is_unsaved() && balls(&screen) == 1);
    screen.state_mut().act(ball(1));
    assert_eq!(balls(&screen), 2);
}

#[test]
fn work_is_protected_again_as_soon_as_the_disk_has_room() {
    let folder = tempfile::tempdir().expect("a folder");
    let sessions = folder.path().join("sessions");
    fs::write(&sessions, "no folder").expect("there is room");
    let mut screen = screen(Some(sessions.clone()));
    screen.state_mut().act(ball(0));
    fs::remove_file(&sessions).expect("it is there");
    screen.state_mut().act(ball(1));
    assert!(screen.state().bench.is_protected() && told(&screen, "protected against a crash again"));
    let scene = screen.state().bench.scene().clone();
    drop(screen);
    // Nothing more was done in the new session, and still it is offered.
    let left = LeftBehind::all(&sessions).pop().expect("it was left behind");
    let recovered = left.recover(&mut *TestDesk.sources(None)).expect("it is sound");
    assert_eq!(recovered.variants.document().scene(), &scene);
}
