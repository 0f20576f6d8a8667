//! `trullo sketch`: drawings become the solids of a scene.

use crate::cli::{ConstraintArgs, SketchArgs, SolidKind};
use crate::drawing::{self, Drawn, Solid};
use crate::failure::Failure;
use crate::job::Job;
use crate::output::{Report, check_writable, counted};
use crate::verbs::mesh;
use crate::{field_picture, input, meshing, preview};
use blobtree::build::{Build, blend, union};
use blobtree::{Node, Scene, SketchPlane, Tree};
use glam::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// Room between drawings that are put in a row, as a share of the size of one.
const ROOM: f64 = 0.1;

/// Reads drawings, makes a solid of each, and writes a scene or a mesh, and a preview if asked for.
///
/// Errors: a drawing that cannot be read, or has no outline where one is needed; files that cannot be written.
pub fn run(args: &SketchArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    check_request(args)?;
    let opened = args.drawings.iter().map(|path| drawing::open(path, args, job));
    let drawn: Vec<Drawn> = opened.collect::<Result<_, _>>()?;
    if let Some(path) = &args.preview {
        let picture = job.stage("preview", |_| preview::png(path, &drawn))?;
        job.write(path, &picture)?;
        report.put("preview", path.display().to_string());
        report.line(format!("{}: strokes and curves of {}", path.display(), counted(drawn.len(), "drawing")));
    }
    if args.output.is_none() && args.field.is_none() {
        report.put("drawings", drawn.iter().map(|d| told(d, None)).collect::<Vec<_>>());
        return Ok(report);
    }
    let mut solids = Vec::new();
    for (i, one) in drawn.iter().enumerate() {
        let kind = args.kinds.get(i).or(args.kinds.last()).copied().unwrap_or_default();
        let place = args.places.get(i).copied().unwrap_or_else(|| in_a_row(args, i));
        let solid = one.solid(kind, args, place, job)?;
        report.notices.extend(notice(one, &solid));
        solids.push(solid);
    }
    let parts = drawn.iter().zip(&solids).map(|(one, solid)| told(one, Some(solid)));
    report.put("drawings", parts.collect::<Vec<_>>());
    if let Some(path) = &args.field {
        let place = args.places.first().copied().unwrap_or_else(|| in_a_row(args, 0));
        let plane = SketchPlane { origin: place, ..SketchPlane::default() };
        let tree = Tree::new(&solids[0].node);
        let picture = job.stage("field", |_| field_picture::png(path, &tree, &plane))?;
        job.write(path, &picture)?;
        report.put("field", path.display().to_string());
        report.line(format!("{}: the field in the drawing's plane", path.display()));
    }
    if let Some(output) = &args.output {
        write(args, output, solids, job, &mut report)?;
    }
    Ok(report)
}

/// Whether the files can be written and the lists are as long as they should be.
fn check_request(args: &SketchArgs) -> Result<(), Failure> {
    let drawings = counted(args.drawings.len(), "drawing");
    if !args.places.is_empty() && args.places.len() != args.drawings.len() {
        let found = counted(args.places.len(), "place");
        return Err(Failure::Input(format!("--place: {found} for {drawings}; give one for each, in order")));
    }
    if args.kinds.len() > 1 && args.kinds.len() != args.drawings.len() {
        let found = counted(args.kinds.len(), "kind");
        return Err(Failure::Input(format!(
            "--as: {found} for {drawings}; give one, or one for each, in order"
        )));
    }
    for picture in args.preview.iter().chain(&args.field) {
        if !picture.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            return Err(Failure::of(picture, "the name must end in .png, the only format for pictures"));
        }
        check_writable(picture)?;
    }
    if let Some(output) = &args.output {
        if !is_scene(output) {
            meshing::format_of_output(output).map_err(|_| {
                let what =
                    "the name must end in .trullo for a scene, or in .stl, .obj, .ply or .3mf for a mesh";
                Failure::of(output, what)
            })?;
        }
        check_writable(output)?;
    }
    Ok(())
}

fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"))
}

/// Where a drawing without a place of its own stands.
fn in_a_row(args: &SketchArgs, index: usize) -> Vec3 {
    let middle = (args.drawings.len() - 1) as f64 / 2.0;
    Vec3::new(((index as f64 - middle) * (1.0 + ROOM) * args.size) as f32, 0.0, 0.0)
}

/// What a user may want to know about a drawing.
fn notice(drawn: &Drawn, solid: &Solid) -> Option<String> {
    let strokes = counted(solid.left_out, "stroke");
    let are = if solid.left_out == 1 { "is" } else { "are" };
    (solid.left_out > 0)
        .then(|| format!("{}: {strokes} {are} no part of the outline and left out", drawn.path.display()))
}

/// A drawing for programs.
fn told(drawn: &Drawn, solid: Option<&Solid>) -> Value {
    let [low, high] = drawn.bounds();
    let contours = drawn.curve().map_or(&[][..], |curve| &curve.contours);
    let holes = contours.iter().filter(|contour| contour.is_hole()).count();
    let corners: usize = contours.iter().map(|contour| contour.corners.len()).sum();
    let mut told = json!({
        "file": drawn.path.display().to_string(),
        "strokes": drawn.drawing.strokes.len(),
        "outlines": contours.len() - holes,
        "holes": holes,
        "corners": corners,
        "width_mm": high.x - low.x,
        "height_mm": high.y - low.y,
    });
    if let Some(reason) = drawn.no_outline() {
        told["no_outline"] = reason.to_string().into();
    }
    if let Some(solid) = solid {
        told["as"] = solid.kind.name().into();
        told["left_out"] = solid.left_out.into();
    }
    told
}

/// Writes the scene, or its mesh.
fn write(
    args: &SketchArgs,
    output: &Path,
    solids: Vec<Solid>,
    job: &mut Job,
    report: &mut Report,
) -> Result<(), Failure> {
    let kinds: Vec<SolidKind> = solids.iter().map(|solid| solid.kind).collect();
    let named = args.drawings.iter().zip(solids).map(|(path, solid)| match path.file_stem() {
        Some(stem) => solid.node.named(stem.to_string_lossy()),
        None => solid.node,
    });
    let parts: Vec<Node> = named.collect();
    let title = args.drawings[0].file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let root = match (parts.len(), args.blend) {
        (1, _) => parts.into_iter().next().expect("there is one"),
        (_, true) => blend(parts),
        (_, false) => union(parts),
    };
    let scene = Scene { title, ..Scene::new(root) };
    if is_scene(output) {
        let text = job.stage("encode", |_| scene.to_text().map_err(|e| Failure::of(output, e)))?;
        job.write(output, text.as_bytes())?;
        report.put("output", output.display().to_string());
        report.line(format!("{}: {}", output.display(), made(&kinds)));
        return Ok(());
    }
    let meshed =
        meshing::mesh_scene(&args.drawings[0], &scene, &args.resolution, ConstraintArgs::default(), job)?;
    let attachments = input::attachments(output, &scene)?;
    meshing::write_mesh(&args.drawings[0], output, &meshed.mesh, &attachments, job)?;
    mesh::tell(report, output, &meshed);
    Ok(())
}

/// How many solids of each kind, in words.
fn made(kinds: &[SolidKind]) -> String {
    let all = [SolidKind::Inflate, SolidKind::Sweep, SolidKind::Revolve, SolidKind::Line];
    let counts = all.map(|kind| (kinds.iter().filter(|k| **k == kind).count(), kind.name()));
    let told = counts.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} × {name}"));
    format!("{} ({})", counted(kinds.len(), "solid"), told.collect::<Vec<_>>().join(", "))
}
