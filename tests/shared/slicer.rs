//! A real slicer opens what is exported, without repairing it.

use crate::{examples, trullo};
use std::process::Command;

/// What `prusa-slicer --info` says of a file.
fn slicer_info(path: &std::path::Path) -> String {
    let output = Command::new("prusa-slicer").arg("--info").arg(path).output();
    let output = output.expect("Debian's package prusa-slicer is installed");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
fn exported_examples_open_in_a_slicer_without_repair() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for scene in examples() {
        let out = folder.path().join("out.3mf");
        let made = trullo([
            "mesh".as_ref(),
            scene.as_os_str(),
            "-o".as_ref(),
            out.as_os_str(),
            "--cells".as_ref(),
            "64".as_ref(),
        ]);
        assert!(made.status.success(), "{}: {}", scene.display(), String::from_utf8_lossy(&made.stderr));
        let info = slicer_info(&out);
        assert!(info.contains("manifold = yes"), "{}: {info}", scene.display());
        let repair = [
            "repaired",
            "open_edges",
            "edges_fixed",
            "degenerate_facets",
            "facets_removed",
            "facets_reversed",
            "backwards_edges",
        ];
        for word in repair {
            let line = info.lines().find(|line| line.contains(word));
            assert!(line.is_none_or(|line| line.trim_end().ends_with("= 0")), "{}: {info}", scene.display());
        }
    }
}
