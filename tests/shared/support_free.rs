//! What `trullo support-free` writes, judged by an independent program: the table in docs/support-free.md.

use crate::{examples, shared, trullo};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Models, taken 50 mm high.
const MODELS: [&str; 6] = ["bunny", "kitten", "armadillo", "horse", "hand", "duck"];

/// The first doodle of each kind, taken 40 mm large.
const DOODLES: [&str; 20] = [
    "star", "cactus", "sheep", "teapot", "owl", "whale", "moon", "car", "tooth", "guitar", "leaf", "skull",
    "hand", "bat", "crown", "pants", "face", "lion", "swan", "bear",
];

/// All inputs: what they are called, the file, and further arguments.
fn inputs(folder: &Path) -> Vec<(String, PathBuf, &'static [&'static str])> {
    let name = |path: &Path| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let mut inputs: Vec<_> =
        examples().into_iter().map(|path| (name(&path), path, &[] as &'static [&'static str])).collect();
    for model in MODELS {
        let path = shared(&format!("models/{model}.stl"));
        inputs.push((model.to_owned(), path, &["--height", "50", "--drop"]));
    }
    for doodle in DOODLES {
        let scene = folder.join(format!("{doodle}.trullo"));
        let drawing = shared(&format!("doodles/{doodle}.ndjson"));
        let arguments: [&OsStr; 6] = [
            "sketch".as_ref(),
            drawing.as_ref(),
            "-o".as_ref(),
            scene.as_ref(),
            "--size".as_ref(),
            "40".as_ref(),
        ];
        assert!(trullo(arguments).status.success(), "{doodle}");
        inputs.push((format!("drawn {doodle}"), scene, &[]));
    }
    inputs
}

/// What the referee says of a mesh at 0.25 mm and 45°; it runs in the interpreter in `TRULLO_PYTHON`.
fn judged(mesh: &Path, folder: &Path) -> Value {
    let python = std::env::var("TRULLO_PYTHON").unwrap_or_else(|_| "python3".into());
    let report = folder.join("report.json");
    let arguments: [&OsStr; 7] = [
        mesh.as_ref(),
        "-l".as_ref(),
        "0.25".as_ref(),
        "-t".as_ref(),
        "45".as_ref(),
        "--json".as_ref(),
        report.as_ref(),
    ];
    let status = Command::new(python).arg(shared("tools/print_check.py")).args(arguments).output();
    assert!(status.expect("Python runs").status.code().is_some_and(|code| code < 2), "{}", mesh.display());
    serde_json::from_str(&std::fs::read_to_string(report).expect("readable")).expect("JSON")
}

/// Prints the table in docs/support-free.md:
/// `cargo test --features shared --test shared support_free -- --ignored --nocapture`, with an interpreter that has
/// the referee's packages in `TRULLO_PYTHON`; `TRULLO_ONLY=dice,bunny` takes some inputs only.
#[test]
#[ignore = "takes an hour and needs Python packages"]
fn support_free_shapes_print_in_the_eyes_of_an_independent_program() {
    let folder = tempfile::tempdir().expect("there is room for tests");
    let only = std::env::var("TRULLO_ONLY").unwrap_or_default();
    let only: Vec<&str> = only.split(',').filter(|name| !name.is_empty()).collect();
    let mut fail = Vec::new();
    for (name, path, further) in inputs(folder.path()) {
        if !only.is_empty() && !only.contains(&name.as_str()) {
            continue;
        }
        for operator in ["trim", "grow"] {
            let out = folder.path().join("out.stl");
            let arguments: [&OsStr; 7] = [
                "support-free".as_ref(),
                path.as_ref(),
                "-o".as_ref(),
                out.as_ref(),
                "--operator".as_ref(),
                operator.as_ref(),
                "--json".as_ref(),
            ];
            let made = trullo(arguments.into_iter().chain(further.iter().map(OsStr::new)));
            let made: Value = serde_json::from_slice(&made.stdout).expect("JSON");
            let Some(taken) = made["removed_mm3"].as_f64() else {
                println!("| {name} | {operator} | all | | | | |");
                continue;
            };
            let report = judged(&out, folder.path());
            let (support, verdict) = (&report["support"], &report["verdict"]);
            let area = |key: &str| support["unsupported_mm2"][key].as_f64().expect("a number");
            println!(
                "| {name} | {operator} | {taken:.0}, {:.0} | {:.2}, {:.2} | {} | {} | {} |",
                made["added_mm3"].as_f64().expect("a number"),
                area("total"),
                area("max_layer"),
                support["islands"],
                verdict["strict"],
                verdict["practical"],
            );
            if verdict["practical"] != true {
                fail.push(format!("{name}, {operator}"));
            }
        }
    }
    assert!(fail.is_empty(), "these do not print: {fail:?}");
}
