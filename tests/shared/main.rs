//! What needs `../shared`: real models, the peers' scenes, and programs that judge what is exported.
//!
//! `cargo test --features shared --test shared`. Fails, and says so, when the data is not there.

mod chain;
#[path = "../common/mod.rs"]
mod common;
mod doodles;
mod models;
mod peer_scenes;
mod pen;
mod print_check;
mod slicer;
mod support_free;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A path below `../shared`, which must exist.
fn shared(below: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(below);
    assert!(
        path.exists(),
        "{} is missing: these tests need the shared data beside the project",
        path.display()
    );
    path
}

/// Runs the program.
fn trullo<I: AsRef<std::ffi::OsStr>>(args: impl IntoIterator<Item = I>) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trullo")).args(args).output().expect("the program was built")
}

/// The examples, by path.
fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = std::fs::read_dir(folder).expect("the examples are in the repository");
    let mut scenes: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|e| e == "trullo"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= 8, "{scenes:?}");
    scenes
}
