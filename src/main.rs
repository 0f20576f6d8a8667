//! Trullo, the program: opens the modeler's window, or reads arguments, opens files, asks the other rooms, and shows what
//! they say.

mod app;
mod certificate;
mod cli;
mod constraint;
mod drawing;
mod failure;
mod field_picture;
mod folder;
mod input;
mod job;
mod layer_files;
mod materials;
mod meshing;
mod output;
mod preview;
mod print_report;
mod progress;
mod render;
mod resolution;
mod slicing;
mod stoppable;
mod timings;
mod verbs;

use clap::Parser;
use cli::{Cli, Verb};
use failure::Failure;
use job::Job;
use output::{Report, Style};
use polygonizer::Cancel;
use progress::Meter;
use std::path::Path;
use std::process::ExitCode;
use std::sync::PoisonError;
use std::time::Duration;
use timings::Timings;

/// Trees are walked by recursion; as deep as scenes may be, this is plenty.
const STACK_BYTES: usize = 32 << 20;

/// How long an interrupted command gets to end by itself.
const GRACE: Duration = Duration::from_millis(300);

fn main() -> ExitCode {
    let verb = match Cli::try_parse() {
        Ok(Cli { verb: Some(verb), .. }) => verb,
        Ok(Cli { file, trace, .. }) => return model(file.as_deref(), trace.as_deref()),
        Err(error) => return usage(&error),
    };
    let common = verb.common();
    match run_in_pool(&verb) {
        Ok((report, timings)) => {
            let code = u8::from(report.found);
            output::show(
                report,
                &timings,
                Style { json: common.json, timings: common.timings, quiet: common.quiet },
            );
            ExitCode::from(code)
        }
        Err(failure) => {
            output::show_failure(&failure.to_string(), common.json);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Opens the window.
fn model(file: Option<&Path>, trace: Option<&Path>) -> ExitCode {
    match app::run(file, app::state(), trace) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::show_failure(&failure.to_string(), false);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Shows help, or what is wrong with the arguments.
fn usage(error: &clap::Error) -> ExitCode {
    // A terminal that is gone needs no help.
    let _ = error.print();
    if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
        let message = error.to_string();
        output::show_failure_as_json(message.trim_start_matches("error: ").trim_end());
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

fn run_in_pool(verb: &Verb) -> Result<(Report, Timings), Failure> {
    let cancel = Cancel::new();
    stop_when_asked(&cancel)?;
    let threads = verb.common().threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES).build();
    let pool = pool.map_err(|e| Failure::Input(format!("--threads: {e}; try fewer")))?;
    pool.install(|| run(verb, &cancel))
}

/// Does the work as often as asked for and keeps the last report.
fn run(verb: &Verb, cancel: &Cancel) -> Result<(Report, Timings), Failure> {
    let common = verb.common();
    let meter = Meter::new(!common.quiet && !common.json);
    let mut timings = Timings::default();
    let mut report = Report::default();
    for _ in 0..common.repeat {
        report = timings.round(|timings| {
            let mut job = Job::new(timings, &meter, cancel);
            match verb {
                Verb::Eval(args) => verbs::eval::run(args, &mut job),
                Verb::Tree(args) => verbs::tree::run(args, &mut job),
                Verb::Mesh(args) => verbs::mesh::run(args, &mut job),
                Verb::SupportFree(args) => verbs::support_free::run(args, &mut job),
                Verb::Sketch(args) => verbs::sketch::run(args, &mut job),
                Verb::Convert(args) => verbs::convert::run(args, &mut job),
                Verb::Render(args) => verbs::render::run(args, &mut job),
                Verb::Check(args) => verbs::check::run(args, &mut job),
                Verb::Slice(args) => verbs::slice::run(args, &mut job),
            }
        })?;
    }
    Ok((report, timings))
}

/// On Ctrl-C, asks the work to stop; if it does not soon, ends the program between two files.
fn stop_when_asked(cancel: &Cancel) -> Result<(), Failure> {
    let cancel = cancel.clone();
    let handler = move || {
        cancel.cancel();
        std::thread::sleep(GRACE);
        let _writing = output::WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        output::show_failure(&Failure::Interrupted.to_string(), false);
        std::process::exit(i32::from(Failure::Interrupted.exit_code()));
    };
    ctrlc::set_handler(handler).map_err(|e| Failure::Input(format!("cannot listen for Ctrl-C: {e}")))
}
