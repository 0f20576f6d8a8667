//! Ctrl-C at any moment: exit code 3, and no half-written file.
#![cfg(unix)]

mod common;

use common::{Folder, SNOWMAN};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn an_interrupted_command_ends_soon_with_three_and_writes_nothing() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    // Far too fine to be done soon, were it allowed at all.
    let mut child = folder
        .command(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "1500"])
        .stderr(Stdio::null())
        .spawn()
        .expect("the program is built");
    std::thread::sleep(Duration::from_millis(400));
    let start = Instant::now();
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.is_ok_and(|status| status.success()));
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(3));
    assert!(start.elapsed() < Duration::from_secs(3), "{:?}", start.elapsed());
    assert_eq!(folder.names(), ["s.trullo"]);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let mut child = folder
        .command(&["tree", "s.trullo", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program is built");
    drop(child.stdout.take());
    let out = child.wait_with_output().expect("it ends");
    assert_eq!(out.status.code(), Some(0));
    assert!(out.stderr.is_empty(), "{}", common::text_of(&out.stderr));
}
