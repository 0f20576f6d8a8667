//! However broken a file is, every verb ends soon, in little memory, and in words.

#![cfg(target_os = "linux")]

#[path = "broken_files/breakage.rs"]
mod breakage;
mod common;

use breakage::{Broken, all};
use common::{Folder, text_of};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// All that a process may map, so that its peak in memory is less: 500 MB.
const MEMORY_KIB: u32 = 500_000_000 / 1024;
/// Processor time for one file; beyond it the system ends the program. Unlike time on the clock, other work on
/// the machine does not use it up.
const CPU_SECONDS: u32 = 2;
/// On the clock, on a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(10);

const VERBS: [&str; 7] = ["eval", "tree", "mesh", "check", "convert", "render", "slice"];

/// What came of some of the files.
#[derive(Default)]
struct Tally {
    /// Files that every verb refused.
    refused: usize,
    slowest: (Duration, String),
}

#[test]
fn three_hundred_broken_files_end_in_an_error_that_names_the_file() {
    let folder = Folder::new();
    let files = all(&folder);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut tally = Tally::default();
        while let Some(file) = files.get(next.fetch_add(1, Ordering::Relaxed)) {
            let outcomes = VERBS.map(|verb| {
                let (was_refused, took) = try_file(&folder, file, verb);
                if took > tally.slowest.0 {
                    tally.slowest = (took, format!("{verb} {}", file.name));
                }
                was_refused
            });
            tally.refused += usize::from(outcomes == [true; VERBS.len()]);
        }
        tally
    };
    let tallies = std::thread::scope(|scope| {
        let workers = [(); 2].map(|()| scope.spawn(work));
        workers.map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    let refused: usize = tallies.iter().map(|tally| tally.refused).sum();
    let slowest = tallies.map(|tally| tally.slowest).into_iter().max();
    println!("{} files, {refused} of them refused by every verb; the slowest: {slowest:?}", files.len());
    assert!(refused >= 300, "only {refused} of {} were refused", files.len());
    let left: Vec<String> = folder.names().into_iter().filter(|name| name.starts_with("out-")).collect();
    assert!(left.is_empty(), "left over: {left:?}");
}

/// Runs a verb on a file and judges how it ended: whether the file was refused, and how long that took.
fn try_file(folder: &Folder, file: &Broken, verb: &str) -> (bool, Duration) {
    let name = file.name.as_str();
    let format = match verb {
        "render" => "png",
        "slice" => "svg",
        _ => "stl",
    };
    let out = format!("out-{verb}-{name}.{format}");
    let rest: &[&str] = match verb {
        "eval" => &["--at", "0,0,5", "--explain"],
        "mesh" => &["-o", &out, "--cells", "16"],
        "convert" => &[&out, "--cells", "16"],
        "render" => &["-o", &out, "--size", "64x48"],
        "check" => &["--cells", "16"],
        "slice" => &["-o", &out, "--cells", "16"],
        _ => &[],
    };
    let args = [&[verb, name, "-q", "--threads", "1"], rest].concat();
    let start = Instant::now();
    let output = folder.limited(&args, MEMORY_KIB, CPU_SECONDS);
    let took = start.elapsed();

    let said = text_of(&output.stderr);
    let what =
        format!("trullo {verb} {name}: {:?}, {}", output.status, said.chars().take(2000).collect::<String>());
    assert!(!said.contains("panicked"), "{what}");
    assert!(took < PATIENCE, "{took:?}: {what}");
    let code = output.status.code();
    match code {
        Some(2) => {
            assert!(said.starts_with(&format!("error: {name}: ")), "{what}");
            assert!(said.ends_with('\n') && said.lines().count() == 1 && said.len() < 1000, "{what}");
            assert!(!folder.has(&out), "{what}");
        }
        Some(0 | 1) => {
            assert!(file.may_be_legal, "{what}");
            // Some verbs write nothing.
            let _ = std::fs::remove_file(folder.path(&out));
        }
        _ => panic!("{what}"),
    }
    (code == Some(2), took)
}
