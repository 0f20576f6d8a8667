//! The print check against exact answers and an independent program.

use crate::models::files;
use crate::{shared, trullo};
use serde_json::Value;
use std::path::Path;

fn json_at(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("readable")).expect("JSON")
}

fn check(path: &Path) -> Value {
    let output = trullo(["check".as_ref(), path.as_os_str(), "--json".as_ref()]);
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn shapes_with_known_answers_get_them() {
    let known = json_at(&shared("models/known/known.json"));
    let shapes = known["shapes"].as_object().expect("shapes by name");
    assert!(shapes.len() >= 15);
    for (name, expected) in shapes {
        let report = check(&shared(&format!("models/known/{name}.stl")));
        let print = &report["print"];
        let close = |what: &str, found: f64, key: &str| {
            let expected = number(&expected[key]);
            let room = 0.05f64.max(0.01 * expected);
            assert!((found - expected).abs() <= room, "{name}: {what} is {found}, not {expected}");
        };
        close("the volume", number(&report["volume_mm3"]), "volume_mm3");
        close("the unsupported area", number(&print["unsupported_mm2"]), "unsupported_mm2");
        let steep = number(&print["steep_mm2"]["outside"]) + number(&print["steep_mm2"]["inside"]);
        close("the steep area", steep, "steep_mm2");
        let voids = print["voids"].as_array().expect("a list");
        close("the voids' volume", voids.iter().map(|void| number(&void["volume_mm3"])).sum(), "void_mm3");
        assert_eq!(voids.len(), expected["voids"].as_u64().expect("a count") as usize, "{name}");
        assert_eq!(print["islands"], expected["islands"], "{name}");
        assert_eq!(print["printable"], expected["practical"], "{name}");
        assert_eq!(print["support_free"], expected["strict"], "{name}");
    }
}

/// Slow, as the referee takes seconds for each model: `cargo test --features shared --test shared -- --ignored`, with
/// the interpreter that has its packages in `TRULLO_PYTHON`.
#[test]
#[ignore = "takes minutes and needs Python packages"]
fn real_and_broken_models_are_judged_as_an_independent_program_judges_them() {
    let python = std::env::var("TRULLO_PYTHON").unwrap_or_else(|_| "python3".into());
    let folder = tempfile::tempdir().expect("there is room for tests");
    for path in files("models").into_iter().chain(files("models/nasty")) {
        let report = folder.path().join("report.json");
        let referee = std::process::Command::new(&python)
            .arg(shared("tools/print_check.py"))
            .args([path.as_os_str(), "--json".as_ref(), report.as_os_str()])
            .output()
            .expect("Python runs");
        let referee = match referee.status.code() {
            Some(0 | 1) => json_at(&report),
            // It cannot read the file either.
            _ => continue,
        };
        let found = check(&path);
        // What is not in millimetres or not read at all is another test's business.
        let Some(print) = found.get("print") else { continue };
        let name = path.display();
        for (ours, theirs) in [
            ("unsupported_mm2", &referee["support"]["unsupported_mm2"]["total"]),
            ("worst_layer_mm2", &referee["support"]["unsupported_mm2"]["max_layer"]),
            ("wide_mm2", &referee["support"]["wide_mm2"]["total"]),
        ] {
            let (found, theirs) = (number(&print[ours]), number(theirs));
            assert!(
                (found - theirs).abs() <= 0.05f64.max(0.01 * theirs),
                "{name}: {ours} {found}, not {theirs}"
            );
        }
        assert_eq!(print["islands"], referee["support"]["islands"], "{name}");
        assert_eq!(print["layer_count"], referee["size"]["layers"], "{name}");
    }
}
