//! What comes out: reports and errors on the terminal, files on the disk.

use crate::failure::Failure;
use crate::timings::Timings;
use blobtree::{Aabb, write_atomically};
use glam::{DVec3, Vec3};
use polygonizer::Cancel;
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Held while a file is put in place, so that nothing ends the program in between.
pub static WRITING: Mutex<()> = Mutex::new(());

/// What a verb found out.
#[derive(Debug, Default)]
pub struct Report {
    /// For people.
    pub text: String,
    /// For programs: the members of one object.
    pub json: Map<String, Value>,
    /// What the user may want to know about the input.
    pub notices: Vec<String>,
    /// Whether a check found something.
    pub found: bool,
}

impl Report {
    /// Adds a member for programs.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        self.json.insert(key.into(), value.into());
    }

    /// Adds all that another report says.
    pub fn append(&mut self, other: Self) {
        self.text.push_str(&other.text);
        self.json.extend(other.json);
        self.notices.extend(other.notices);
        self.found |= other.found;
    }

    /// Adds a line for people.
    pub fn line(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }
}

/// How reports are shown.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// As JSON.
    pub json: bool,
    /// With the timings.
    pub timings: bool,
    /// Without notices.
    pub quiet: bool,
}

/// Prints a report on stdout, and its notices on stderr.
pub fn show(mut report: Report, timings: &Timings, style: Style) {
    if style.json {
        if style.timings {
            report.put("timings", timings.to_json());
        }
        if !report.notices.is_empty() {
            report.json.insert("notices".into(), report.notices.into());
        }
        print(&format!("{:#}\n", Value::Object(report.json)));
        return;
    }
    if !style.quiet {
        for notice in &report.notices {
            complain(&format!("note: {notice}\n"));
        }
    }
    if style.timings {
        report.text.push_str(&timings.to_text());
    }
    print(&report.text);
}

/// Prints why there is no report: on stderr, and as JSON on stdout if that was asked for.
pub fn show_failure(message: &str, json: bool) {
    if json {
        show_failure_as_json(message);
    }
    complain(&format!("error: {message}\n"));
}

/// Prints what went wrong as JSON on stdout.
pub fn show_failure_as_json(message: &str) {
    print(&format!("{:#}\n", json!({ "error": message })));
}

/// Writes to stdout. A reader that has gone away has seen enough, so that is no error.
fn print(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Writes to stderr; where even that fails there is nobody left to tell.
fn complain(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Errors: a picture whose name does not end in `.png`.
pub fn check_is_png(path: &Path) -> Result<(), Failure> {
    match path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        true => Ok(()),
        false => Err(Failure::of(path, "the name must end in .png, the only format for pictures")),
    }
}

/// Whether a file could be written at `path`, found out before long work begins. Leaves no trace.
///
/// Errors: a folder that is not there or not writable, or a target that is not a file.
pub fn check_writable(path: &Path) -> Result<(), Failure> {
    match std::fs::metadata(path) {
        Ok(existing) if !existing.is_file() => {
            return Err(Failure::of(path, "not a file, so it cannot be written over; choose another name"));
        }
        _ => {}
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => {
            let what = format!("cannot be written: its folder {}: {}", folder.display(), told(&error));
            Err(Failure::of(path, what))
        }
    }
}

/// Puts a whole file in place at once, or leaves everything as it was.
///
/// Errors: what the system says; [`Failure::Interrupted`] if `cancel` was used before it began.
pub fn write_file(path: &Path, content: &[u8], cancel: &Cancel) -> Result<(), Failure> {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    if cancel.is_cancelled() {
        return Err(Failure::Interrupted);
    }
    write_atomically(path, content, 0).map_err(|e| Failure::Input(e.to_string()))
}

/// What the system says, without its error number.
pub fn told(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// A number with no more digits than its `f32` needs.
pub fn number(value: f32) -> Value {
    value.to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

/// Three numbers with no more digits than needed.
pub fn vector(v: Vec3) -> Value {
    v.to_array().map(number).to_vec().into()
}

/// Three numbers in full.
pub fn long_vector(v: DVec3) -> Value {
    v.to_array().to_vec().into()
}

/// A box by its two corners; null if empty.
pub fn aabb(b: &Aabb) -> Value {
    if b.is_empty() { Value::Null } else { json!({ "min": vector(b.min), "max": vector(b.max) }) }
}

/// `n things`, or `1 thing`.
pub fn counted(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// A number with about four digits.
pub fn short(value: f32) -> String {
    let digits = (3 - value.abs().log10().floor().clamp(-6.0, 3.0) as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}
