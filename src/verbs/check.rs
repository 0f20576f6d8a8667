//! `trullo check`: is it a solid, does it print without supports, and what does it measure?

use crate::cli::CheckArgs;
use crate::failure::Failure;
use crate::input::{self, Input, Prefer};
use crate::job::Job;
use crate::meshing::{self, is_serious};
use crate::output::{Report, check_is_png, check_writable, counted, long_vector, number, vector};
use crate::render::{self, Settings, Subject, View};
use crate::{certificate, print_report, slicing};
use mesh::io::Attachments;
use mesh::{Body, Fault, Finding, Mesh, SelfIntersections, Validity};
use printable::check::CheckSettings;
use serde_json::{Value, json};
use std::path::Path;

/// Width and height of a picture of overhangs, pixels.
const PICTURE_SIZE: [u32; 2] = [1200, 900];

/// Checks a mesh, or the mesh of a scene.
///
/// Errors: an input that cannot be read or meshed, a picture that cannot be written. What is wrong with the mesh is
/// in the report.
pub fn run(args: &CheckArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    if let Some(picture) = &args.picture {
        check_is_png(picture)?;
        check_writable(picture)?;
    }
    let (mesh, attachments) =
        match input::open(&args.input, args.shape.reading.height, Prefer::Mesh, job, &mut report)? {
            Input::Mesh(loaded) => (loaded.mesh, loaded.attachments),
            Input::Scene(scene) => {
                let meshed = meshing::mesh_scene(
                    &args.input,
                    &scene,
                    &args.shape.resolution,
                    args.shape.constraint,
                    job,
                )?;
                report.put("cell_mm", number(meshed.cell_mm));
                (meshed.mesh, Attachments::default())
            }
        };
    let validity = job.stage("validate", |_| Ok(mesh.validity(SelfIntersections::Search)))?;
    let bodies = job.stage("measure", |_| {
        tell_measures(&mut report, &mesh);
        Ok(mesh.bodies())
    })?;
    tell_bodies(&mut report, &bodies, &validity);
    tell_findings(&mut report, &validity);
    check_print(args, &mesh, &attachments, &mut report, job)?;
    report.put("ok", !report.found);
    Ok(report)
}

/// Checks whether the mesh prints without supports, and whether a certificate says so rightly.
fn check_print(
    args: &CheckArgs,
    mesh: &Mesh,
    attachments: &Attachments,
    report: &mut Report,
    job: &mut Job,
) -> Result<(), Failure> {
    let certificate = certificate::of_file(attachments);
    let claimed = certificate.as_ref().and_then(|certificate| certificate.as_ref().ok());
    let mut settings = certificate::settings(&args.rule, claimed);
    settings.thin_wall_mm = args.thin_wall;
    let check = slicing::check(mesh, &settings, job)?;
    match &check {
        Ok(check) => print_report::tell(report, check),
        Err(error) => {
            report.found = true;
            report.line(format!("problem         not sliced: {error}"));
            report.put("print", json!({ "error": error.to_string() }));
        }
    }
    if let Some(certificate) = &certificate {
        certificate::verify(certificate, mesh, check.as_ref().ok(), report, job)?;
    }
    match &args.picture {
        Some(picture) => draw(args, mesh, &settings, picture, report, job),
        None => Ok(()),
    }
}

/// Draws the mesh from below, tinted by its overhangs.
fn draw(
    args: &CheckArgs,
    mesh: &Mesh,
    settings: &CheckSettings,
    picture: &Path,
    report: &mut Report,
    job: &mut Job,
) -> Result<(), Failure> {
    let subject = Subject::Overhangs(mesh, settings.rule.overhang.radians());
    let look = Settings { view: View::FROM_BELOW, size: PICTURE_SIZE, background: None };
    let pixels = render::picture(&subject, &look, job)?;
    let pixels = pixels.ok_or_else(|| Failure::of(&args.input, "there is nothing to see"))?;
    let bytes =
        job.stage("encode", |_| render::png(&pixels, PICTURE_SIZE).map_err(|e| Failure::of(picture, e)))?;
    job.write(picture, &bytes)?;
    report.put("picture", picture.display().to_string());
    Ok(())
}

fn tell_measures(report: &mut Report, mesh: &Mesh) {
    let (bounds, area) = (mesh.bounds(), mesh.area());
    let size = bounds.size();
    report.put("vertices", mesh.positions.len());
    report.put("triangles", mesh.triangles.len());
    report.put("box", json!({ "min": vector(bounds.min), "max": vector(bounds.max) }));
    report.put("area_mm2", area);
    report.line(format!("triangles       {}", mesh.triangles.len()));
    report.line(format!("size            {:.2} × {:.2} × {:.2} mm", size.x, size.y, size.z));
    report.line(format!("area            {area:.2} mm²"));
    let Some(mass) = mesh.mass() else {
        report.line("volume          none: the mesh encloses nothing");
        report.put("volume_mm3", 0.0);
        report.put("centre_of_mass", Value::Null);
        return;
    };
    let c = mass.centre;
    report.put("volume_mm3", mass.volume);
    report.put("centre_of_mass", long_vector(c));
    let rows: Vec<Value> = (0..3).map(|row| long_vector(mass.inertia.row(row))).collect();
    report.put("inertia_mm5", rows);
    report.line(format!("volume          {:.2} mm³", mass.volume));
    report.line(format!("centre of mass  {:.2}, {:.2}, {:.2}", c.x, c.y, c.z));
}

fn tell_bodies(report: &mut Report, bodies: &[Body], validity: &Validity) {
    let listed = bodies.iter().take(mesh::MOST_PLACES).map(|body| {
        json!({
            "triangles": body.triangles,
            "volume_mm3": body.volume,
            "area_mm2": body.area,
            "box": { "min": vector(body.bounds.min), "max": vector(body.bounds.max) },
            "closed": body.closed,
            "genus": body.genus(),
        })
    });
    report.put("components", listed.collect::<Vec<_>>());
    report.put("component_count", bodies.len());
    report.put("void_count", validity.voids);
    let voids = match validity.voids {
        0 => String::new(),
        n => format!(", {} of them around an inner void", counted(n, "shell")),
    };
    report.line(format!("made of         {}{voids}", counted(bodies.len(), "closed or open part")));
}

fn tell_findings(report: &mut Report, validity: &Validity) {
    let faults: Vec<Fault> = Fault::ALL.into_iter().filter(|&fault| validity.count(fault) > 0).collect();
    let incomplete = validity.crossings.as_ref().is_some_and(|crossings| !crossings.complete);
    report.found = incomplete || faults.iter().any(|&fault| is_serious(fault));
    let first =
        |fault| validity.findings().find(|f| f.fault == fault).map_or(String::new(), Finding::to_string);
    for (&fault, word) in
        faults.iter().map(|fault| (fault, if is_serious(*fault) { "problem" } else { "remark" }))
    {
        report.line(format!("{word:<15} {} × {}", validity.count(fault), first(fault)));
    }
    if incomplete {
        report.line("problem         so many crossing triangles that not all were looked for");
    }
    if !report.found {
        report.line("verdict         closed, edge-manifold, oriented outward, nothing crosses");
    }
    report.put("closed", validity.is_closed());
    report.put("edge_manifold", validity.is_edge_manifold());
    report.put("oriented", validity.is_oriented());
    report.put("solid", !report.found);
    let findings = faults.iter().map(|&fault| {
        let places = validity.findings().filter(|f| f.fault == fault).map(place);
        json!({
            "fault": format!("{fault:?}"),
            "what": fault.to_string(),
            "serious": is_serious(fault),
            "count": validity.count(fault),
            "places": places.collect::<Vec<_>>(),
        })
    });
    report.put("findings", findings.collect::<Vec<_>>());
}

fn place(finding: &Finding) -> Value {
    json!({ "at": vector(finding.place), "what": finding.to_string() })
}
