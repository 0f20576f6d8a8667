//! Real models and broken ones.

use crate::{shared, trullo};
use serde_json::Value;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The meshes in a folder of the shared data.
pub fn files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(shared(folder)).expect("readable");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        ["stl", "obj", "ply", "3mf"].contains(&extension)
    });
    paths.sort();
    assert!(!paths.is_empty(), "no meshes in {folder}");
    paths
}

#[test]
fn every_model_is_a_sound_solid_of_the_volume_in_the_manifest() {
    let manifest = std::fs::read_to_string(shared("models/manifest.json")).expect("readable");
    let manifest: Value = serde_json::from_str(&manifest).expect("JSON");
    for path in files("models") {
        let output = trullo(["check".as_ref(), path.as_os_str(), "--json".as_ref()]);
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(report["solid"], true, "{}: {report}", path.display());
        let name = path.file_name().and_then(|name| name.to_str()).expect("a plain name");
        let expected = volume_in(&manifest, name);
        let measured = report["volume_mm3"].as_f64().expect("a volume") / 1000.0;
        assert!(
            (measured - expected).abs() < 0.002 * expected,
            "{name}: {measured} instead of {expected} cm³"
        );
    }
}

/// The manifest's volume of a model, cm³.
fn volume_in(manifest: &Value, name: &str) -> f64 {
    let models = manifest["models"].as_array().expect("a list of models");
    let entry = models.iter().find(|entry| entry["file"] == name);
    entry
        .and_then(|entry| entry["volume_cm3"].as_f64())
        .unwrap_or_else(|| panic!("{name} is not in the manifest"))
}

#[test]
fn no_broken_file_takes_the_program_down() {
    for path in files("models/nasty").into_iter().chain(files("models/known")) {
        let start = Instant::now();
        let output = trullo(["check".as_ref(), path.as_os_str(), "--json".as_ref()]);
        let code = output.status.code();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(code, Some(0..=2)), "{}: {code:?} {said}", path.display());
        assert!(!said.contains("panicked"), "{}: {said}", path.display());
        assert!(start.elapsed() < Duration::from_secs(10), "{}: {:?}", path.display(), start.elapsed());
        assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok(), "{}", path.display());
    }
}
