//! `trullo convert`: from one file format to another.

use crate::cli::ConvertArgs;
use crate::failure::Failure;
use crate::input::{self, Input, Prefer};
use crate::job::Job;
use crate::meshing;
use crate::output::{Report, check_writable, counted};
use crate::verbs::mesh::tell;
use blobtree::Scene;
use mesh::io::Loaded;

/// Reads a mesh or scene and writes it in the format that the output's name asks for.
///
/// Errors: an input that cannot be read or is no solid, a file that cannot be written.
pub fn run(args: &ConvertArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let to_scene = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"));
    if !to_scene {
        meshing::format_of_output(&args.output)?;
    }
    check_writable(&args.output)?;
    let prefer = if to_scene { Prefer::Scene } else { Prefer::Mesh };
    match input::open(&args.input, args.shape.reading.height, prefer, job, &mut report)? {
        Input::Scene(scene) if to_scene => write_scene(args, &scene, job, &mut report)?,
        Input::Scene(scene) => {
            let meshed =
                meshing::mesh_scene(&args.input, &scene, &args.shape.resolution, args.shape.constraint, job)?;
            let mut attachments = input::attachments(&args.input, &scene)?;
            let format = meshing::format_of_output(&args.output)?;
            attachments.materials = meshed.materials(&scene.root, format, 0.0, job)?;
            meshing::write_mesh(&args.input, &args.output, &meshed.mesh, &attachments, job)?;
            tell(&mut report, &args.output, &meshed);
        }
        Input::Mesh(_) if to_scene => {
            let what = "carries no scene, so there is none to write; only 3MF files that Trullo made do";
            return Err(Failure::of(&args.input, what));
        }
        Input::Mesh(loaded) => write_mesh(args, &loaded, job, &mut report)?,
    }
    Ok(report)
}

fn write_scene(args: &ConvertArgs, scene: &Scene, job: &mut Job, report: &mut Report) -> Result<(), Failure> {
    let text = job.stage("encode", |_| scene.to_text().map_err(|e| Failure::of(&args.input, e)))?;
    job.write(&args.output, text.as_bytes())?;
    report.put("output", args.output.display().to_string());
    report.line(format!("{}: the scene of {}", args.output.display(), args.input.display()));
    Ok(())
}

fn write_mesh(
    args: &ConvertArgs,
    loaded: &Loaded,
    job: &mut Job,
    report: &mut Report,
) -> Result<(), Failure> {
    if args.shape.resolution.cell.is_some() || args.shape.resolution.cells.is_some() {
        let what = "a mesh, which keeps its triangles; --cell and --cells are for scenes";
        return Err(Failure::of(&args.input, what));
    }
    meshing::write_mesh(&args.input, &args.output, &loaded.mesh, &loaded.attachments, job)?;
    report.put("output", args.output.display().to_string());
    report.put("input_format", loaded.format.to_string());
    report.put("vertices", loaded.mesh.positions.len());
    report.put("triangles", loaded.mesh.triangles.len());
    let triangles = counted(loaded.mesh.triangles.len(), "triangle");
    report.line(format!("{}: {triangles} from {}", args.output.display(), loaded.format));
    Ok(())
}
