//! The promise: what `trullo support-free` writes needs no supports, in the eyes of two independent programs. Writes
//! docs/promise.md.

use crate::{doodles, examples, models, shared, trullo};
use serde_json::Value;
use std::ffi::OsStr;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How many drawings are taken, spread evenly over all there are; another number in `TRULLO_DOODLES`.
const DOODLES: usize = 200;

/// How high models are, mm.
const MODEL_HEIGHT: &str = "50";

/// The larger side of a drawing, mm.
const DOODLE_SIZE: &str = "40";

/// Something to be made support-free.
struct Input {
    name: String,
    path: PathBuf,
    /// The number of the drawing in its file, from 0, if it is one.
    doodle: Option<usize>,
    further: &'static [&'static str],
}

/// What became of an input.
enum Fate {
    /// There is no shape, or nothing is left of it: why.
    Nothing(String),
    /// What the referees say.
    Judged { row: String, strict: bool, practical: bool, slicer_mm3: f64 },
}

fn name_of(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

/// All inputs: the examples, then models and drawings in turn, so that a part of the table is a fair sample, too.
fn inputs() -> Vec<Input> {
    let plain = |path: PathBuf| Input { name: name_of(&path), path, doodle: None, further: &[] };
    let sculpted = |name: &str| {
        plain(Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/sculpted/{name}.trullo")))
    };
    let model = |path| Input { further: &["--height", MODEL_HEIGHT, "--drop"], ..plain(path) };
    let mut inputs: Vec<Input> = examples().into_iter().map(plain).collect();
    inputs.extend(["shaun", "pumpkin"].map(sculpted));
    let models: Vec<Input> = models::files("models").into_iter().map(model).collect();
    let placed = |inputs: Vec<Input>| {
        let share = 1.0 / inputs.len() as f64;
        inputs.into_iter().enumerate().map(move |(i, input)| ((i as f64 + 0.5) * share, input))
    };
    let mut rest: Vec<(f64, Input)> = placed(models).chain(placed(drawings())).collect();
    rest.sort_by(|a, b| a.0.total_cmp(&b.0));
    inputs.extend(rest.into_iter().map(|(_, input)| input));
    inputs
}

/// Drawings, spread evenly over all files.
fn drawings() -> Vec<Input> {
    let wanted = std::env::var("TRULLO_DOODLES").ok().and_then(|n| n.parse().ok()).unwrap_or(DOODLES);
    let drawings: Vec<Input> = doodles::files()
        .into_iter()
        .flat_map(|path| {
            let text = std::fs::read_to_string(&path).expect("readable");
            let count = text.lines().filter(|line| !line.is_empty()).count();
            (0..count).map(move |index| Input {
                name: format!("drawn {} {}", name_of(&path), index + 1),
                path: path.clone(),
                doodle: Some(index),
                further: &[],
            })
        })
        .collect();
    let step = drawings.len().div_ceil(wanted.max(1));
    drawings.into_iter().step_by(step).collect()
}

/// The report of one of the referees on a mesh at 0.25 mm and 45°; they run in the interpreter in `TRULLO_PYTHON`.
fn judged(referee: &str, mesh: &Path, folder: &Path) -> Value {
    let python = std::env::var("TRULLO_PYTHON").unwrap_or_else(|_| "python3".into());
    let report = folder.join("report.json");
    let mut command = Command::new(python);
    command.arg(shared(referee)).arg(mesh).args(["-l", "0.25", "-t", "45", "--json"]).arg(&report);
    let status = command.output().expect("Python runs").status;
    assert!(status.code().is_some(), "{referee}: {}", mesh.display());
    serde_json::from_str(&std::fs::read_to_string(report).expect("readable")).expect("JSON")
}

/// The last line of what a program complained of, without the names of files.
fn complaint(said: &[u8]) -> String {
    let said = String::from_utf8_lossy(said);
    let last = said.lines().last().unwrap_or_default();
    last.rsplit_once(": ").map_or(last, |(_, words)| words).to_owned()
}

/// Makes an input support-free and asks the referees.
fn fate(input: &Input, operator: &str, folder: &Path) -> Fate {
    let mut path = input.path.clone();
    if let Some(index) = input.doodle {
        path = folder.join("drawn.trullo");
        let line = (index + 1).to_string();
        let mut arguments: Vec<&OsStr> = vec!["sketch".as_ref(), input.path.as_ref(), "-o".as_ref()];
        arguments.push(path.as_ref());
        arguments.extend(["--doodle", &line, "--size", DOODLE_SIZE].map(OsStr::new));
        let drawn = trullo(arguments);
        if !drawn.status.success() {
            return Fate::Nothing(complaint(&drawn.stderr));
        }
    }
    let out = folder.join("out.stl");
    let mut arguments: Vec<&OsStr> =
        vec!["support-free".as_ref(), path.as_ref(), "-o".as_ref(), out.as_ref()];
    arguments.extend(["--operator", operator, "--json"].map(OsStr::new));
    arguments.extend(input.further.iter().map(OsStr::new));
    let made = trullo(arguments);
    if !made.status.success() {
        return Fate::Nothing(complaint(&made.stderr));
    }
    let made: Value = serde_json::from_slice(&made.stdout).expect("JSON");
    let report = judged("tools/print_check.py", &out, folder);
    let slicer = judged("tools/slicer_check.py", &out, folder);
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let slicer_mm3 = number(&slicer["runs"][0]["support"]["volume_mm3"]);
    let (support, verdict) = (&report["support"], &report["verdict"]);
    let [strict, practical] = ["strict", "practical"].map(|key| verdict[key] == true);
    let yes = |holds: bool| if holds { "yes" } else { "**no**" };
    let asked = match slicer_mm3 {
        0.0 => "none".to_owned(),
        some if some > 0.0 => format!("**{some:.1}**"),
        _ => "**refused**".to_owned(),
    };
    let row = format!(
        "{:.0}, {:.0} | {:.3}, {:.3} | {} | {} | {} | {asked}",
        number(&made["removed_mm3"]),
        number(&made["added_mm3"]),
        number(&support["unsupported_mm2"]["total"]),
        number(&support["unsupported_mm2"]["max_layer"]),
        support["islands"],
        yes(strict),
        yes(practical),
    );
    Fate::Judged { row, strict, practical, slicer_mm3 }
}

/// Rows so far, and what they come to.
#[derive(Default)]
struct Table {
    rows: String,
    /// Rows with a shape; strict ones, practical ones, ones without supports, and ones that are all of it.
    counts: [usize; 5],
    nothing: usize,
    fail: Vec<String>,
}

impl Table {
    fn add(&mut self, name: &str, operator: &str, fate: &Fate) {
        let words = match fate {
            Fate::Nothing(why) => {
                self.nothing += 1;
                format!("{why} | | | | |")
            }
            Fate::Judged { row, strict, practical, slicer_mm3 } => {
                let content = *slicer_mm3 == 0.0;
                let all = [true, *strict, *practical, content, *strict && content];
                self.counts.iter_mut().zip(all).for_each(|(count, holds)| *count += usize::from(holds));
                if !(*strict && content) {
                    self.fail.push(format!("{name}, {operator}"));
                }
                row.clone()
            }
        };
        let row = format!("| {name} | {operator} | {words} |");
        println!("{row}");
        writeln!(self.rows, "{row}").expect("memory takes it");
    }

    fn text(&self, shapes: [usize; 2]) -> String {
        let [judged, strict, practical, content, both] = self.counts;
        let [done, all] = shapes;
        format!(
            "# The promise, row by row\n\n\
             What `trullo support-free` writes at 45° in layers and cells of 0.25 mm, judged by two programs that share no \
             code with it: a check of exact slices in Python, and PrusaSlicer 2.5, asked for supports wherever 45° \
             are exceeded. How to read it stands in [support-free.md](support-free.md#how-well-it-is-kept). Examples \
             are as large as they are, drawings {DOODLE_SIZE} mm, models {MODEL_HEIGHT} mm high; drawings are spread \
             evenly over all 4,300, `TRULLO_DOODLES` of them or {DOODLES}. Written by\n\n\
             ```sh\n\
             TRULLO_PYTHON=… cargo test --features shared --test shared promise -- --ignored --nocapture\n\
             ```\n\n\
             | of {judged} results, {done} of {all} shapes trimmed and grown | |\n|---|---|\n\
             | strict: at most 0.05 mm² unsupported in all, no islands | {strict} |\n\
             | practical: at most 0.1 mm² in a layer, no islands | {practical} |\n\
             | no supports by the slicer | {content} |\n\
             | strict, and no supports by the slicer | {both} |\n\
             | besides, shapes of which there is nothing, with the reason | {} |\n\n\
             *Taken* and *added* in mm³; *unsupported* in mm², of the whole part and the most in a layer; *slicer*: mm³ of \
             supports.\n\n\
             | shape | operator | taken, added | unsupported, in a layer | islands | strict | practical | slicer |\n\
             |---|---|---|---|---|---|---|---|\n{}",
            self.nothing, self.rows
        )
    }
}

/// Writes docs/promise.md anew after every shape, so that what is done is kept if it is stopped. `TRULLO_ONLY=dice,bunny`
/// takes some inputs only, and writes nothing; `TRULLO_DOODLES=20` takes so many drawings.
#[test]
#[ignore = "takes hours and needs Python packages"]
fn the_promise_is_kept_in_the_eyes_of_two_independent_programs() {
    let folder = tempfile::tempdir().expect("there is room for tests");
    let only = std::env::var("TRULLO_ONLY").unwrap_or_default();
    let only: Vec<&str> = only.split(',').filter(|name| !name.is_empty()).collect();
    let inputs = inputs();
    let mut table = Table::default();
    for (number, input) in inputs.iter().enumerate() {
        if !only.is_empty() && !only.contains(&input.name.as_str()) {
            continue;
        }
        for operator in ["trim", "grow"] {
            table.add(&input.name, operator, &fate(input, operator, folder.path()));
        }
        if only.is_empty() {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/promise.md");
            std::fs::write(path, table.text([number + 1, inputs.len()]))
                .expect("the documents can be written");
        }
    }
    assert!(table.fail.is_empty(), "these do not keep it: {:?}", table.fail);
}
