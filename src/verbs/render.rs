//! `trullo render`: a picture of a scene or mesh.

use crate::cli::RenderArgs;
use crate::constraint;
use crate::failure::Failure;
use crate::input::{self, Input, Prefer};
use crate::job::Job;
use crate::output::{Report, check_is_png, check_writable};
use crate::render::{self, Settings, Subject};
use blobtree::BakeStore;

/// Draws the input and writes a PNG file.
///
/// Errors: an input that cannot be read or has nothing to see, a file that cannot be written.
pub fn run(args: &RenderArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    check_is_png(&args.output)?;
    check_writable(&args.output)?;
    let input = input::open(&args.input, args.reading.height, Prefer::Scene, job, &mut report)?;
    let bakes = match &input {
        Input::Scene(scene) => constraint::bakes(&args.input, &scene.root, args.constraint, None, job)?,
        Input::Mesh(_) => BakeStore::new(),
    };
    let subject = match &input {
        Input::Scene(scene) => Subject::Scene(&scene.root, &bakes),
        Input::Mesh(loaded) => Subject::Mesh(&loaded.mesh),
    };
    let settings = Settings { view: args.view, size: args.size, background: args.background };
    let pixels = render::picture(&subject, &settings, job)?;
    let pixels =
        pixels.ok_or_else(|| Failure::of(&args.input, "there is no solid to see: it is empty or muted"))?;
    let bytes =
        job.stage("encode", |_| render::png(&pixels, args.size).map_err(|e| Failure::of(&args.output, e)))?;
    job.write(&args.output, &bytes)?;
    let [width, height] = args.size;
    report.put("output", args.output.display().to_string());
    report.put("width", width);
    report.put("height", height);
    report.line(format!("{}: {width} × {height} pixels", args.output.display()));
    Ok(report)
}
