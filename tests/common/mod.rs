//! A folder to run the program in.

// Each test file uses its own part of this.
#![allow(dead_code)]

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A ball of 10 mm on the bed with a smaller, orange one on it.
pub const SNOWMAN: &str = r##"{"format": "trullo", "version": 1, "title": "Two balls", "root": {"type": "union", "children": [
    {"type": "point", "name": "body", "center": [0, 0, 10], "radius": 10},
    {"type": "point", "color": "#ff8000", "center": [0, 0, 23], "radius": 5}
]}}"##;

/// A folder of its own, gone at the end.
pub struct Folder(TempDir);

impl Folder {
    /// An empty one.
    pub fn new() -> Self {
        Self(TempDir::new().expect("there is room for tests"))
    }

    /// One with a file in it.
    pub fn with_scene(name: &str, text: &str) -> Self {
        let folder = Self::new();
        folder.write(name, text);
        folder
    }

    /// The path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Makes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("the folder is ours");
    }

    /// What a file holds.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Whether a file is there.
    pub fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// The names of all that is there.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder is ours");
        let mut names: Vec<String> = entries.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
        names.sort();
        names
    }

    /// What the program answers within so much memory and processor time.
    pub fn limited(&self, args: &[&str], memory_kib: u32, cpu_seconds: u32) -> Output {
        let trullo = self.command(args);
        let limits = format!("ulimit -v {memory_kib}; ulimit -t {cpu_seconds}; exec \"$@\"");
        Command::new("sh")
            .args(["-c", &limits, "sh"])
            .arg(trullo.get_program())
            .args(trullo.get_args())
            .current_dir(trullo.get_current_dir().expect("it runs in the folder"))
            .output()
            .expect("there is a shell")
    }

    /// The program, about to run here.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trullo"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    /// Runs the program here to its end.
    pub fn trullo(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the program is built")
    }
}

/// What the program printed, as JSON.
pub fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e} in {:?}, {:?}", text_of(&output.stdout), text_of(&output.stderr)))
}

/// Output as text.
pub fn text_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// That the program said no: exit code 2, one `error:` with these words, nothing on stdout, no panic.
pub fn assert_failed(output: &Output, words: &str) {
    let said = text_of(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.starts_with("error: ") && said.contains(words), "`{words}` is not in: {said}");
    assert!(!said.contains("panicked"), "{said}");
}
