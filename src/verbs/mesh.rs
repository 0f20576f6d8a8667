//! `trullo mesh`: a scene becomes a mesh file.

use crate::cli::MeshArgs;
use crate::failure::Failure;
use crate::job::Job;
use crate::meshing::{self, Meshed};
use crate::output::{Report, check_writable, counted, number, vector};
use crate::{certificate, constraint, input, output};
use mesh::io::Format;
use serde_json::json;
use std::path::Path;

/// Meshes a scene and writes the mesh.
///
/// Errors: a scene that cannot be read or meshed, a file that cannot be written.
pub fn run(args: &MeshArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let format = meshing::format_of_output(&args.output)?;
    if args.certify && format != Format::ThreeMf {
        return Err(Failure::of(&args.output, "only .3mf files carry certificates; --certify needs one"));
    }
    check_writable(&args.output)?;
    let scene = input::open_scene(&args.scene, job)?;
    let mut meshed = meshing::mesh_scene(&args.scene, &scene, &args.resolution, args.constraint, job)?;
    if let Some(tolerance) = args.simplify {
        meshed.mesh = meshing::simplified(&meshed.mesh, tolerance, job)?;
    }
    let mut attachments = input::attachments(&args.scene, &scene)?;
    let moved = args.simplify.unwrap_or(0.0);
    attachments.materials = meshed.materials(&scene.root, format, moved, job)?;
    let mut certified = Report::default();
    if args.certify {
        let (mesh, rule) = (&meshed.mesh, &args.rule);
        certificate::certify(&args.scene, mesh, rule, &mut attachments, &mut certified, job)?;
    }
    meshing::write_mesh(&args.scene, &args.output, &meshed.mesh, &attachments, job)?;
    tell(&mut report, &args.output, &meshed);
    report.append(certified);
    Ok(report)
}

/// What was written.
pub fn tell(report: &mut Report, output: &Path, meshed: &Meshed) {
    let mesh = &meshed.mesh;
    let (bounds, volume, area) = (mesh.bounds(), mesh.volume(), mesh.area());
    let size = bounds.size();
    if meshed.unconstrained > 0 {
        report.notices.push(constraint::UNCONSTRAINED.into());
    }
    report.put("output", output.display().to_string());
    report.put("cell_mm", number(meshed.cell_mm));
    report.put("vertices", mesh.positions.len());
    report.put("triangles", mesh.triangles.len());
    report.put("volume_mm3", volume);
    report.put("area_mm2", area);
    report.put("box", json!({ "min": vector(bounds.min), "max": vector(bounds.max) }));
    report.line(format!(
        "{}: {}, {:.1} × {:.1} × {:.1} mm, {:.1} mm³, cells of {} mm",
        output.display(),
        counted(mesh.triangles.len(), "triangle"),
        size.x,
        size.y,
        size.z,
        volume,
        output::short(meshed.cell_mm),
    ));
}
