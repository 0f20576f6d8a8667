//! `trullo slice`: the layers of a shape as pictures.

use crate::cli::{LayerKind, SliceArgs};
use crate::failure::Failure;
use crate::input::{self, Input, Prefer};
use crate::job::Job;
use crate::layer_files::{self, LayerFiles};
use crate::output::{Report, check_writable, counted, number};
use crate::{folder, meshing, slicing};
use printable::slices::Slices;

/// Slices the input and writes one SVG file, or a folder with a file for each layer.
///
/// Errors: an input that cannot be read, meshed or sliced, or that has too many layers or too large ones; an output
/// that cannot be written.
pub fn run(args: &SliceArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let one_file = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    match one_file {
        true if args.kind != LayerKind::Svg => {
            return Err(Failure::of(&args.output, "an .svg file; for --as png name a folder"));
        }
        true => check_writable(&args.output)?,
        false => folder::check_new(&args.output)?,
    }
    let mesh = match input::open(&args.input, args.shape.reading.height, Prefer::Mesh, job, &mut report)? {
        Input::Mesh(loaded) => loaded.mesh,
        Input::Scene(scene) => {
            meshing::mesh_scene(&args.input, &scene, &args.shape.resolution, args.shape.constraint, job)?.mesh
        }
    };
    let slices = slicing::slice(&mesh, args.layer_height, args.bed.into(), job)?;
    let slices = slices.map_err(|e| Failure::of(&args.input, e))?;
    if one_file {
        let svg = job.stage("draw", |watch| {
            layer_files::whole_svg(&slices, watch).map_err(|e| e.about(&args.input))
        })?;
        job.write(&args.output, svg.as_bytes())?;
    } else {
        let files = LayerFiles::new(&slices, args.kind, args.pixel).map_err(|e| e.about(&args.input))?;
        job.write_folder(&args.output, files.count(), &|layer| files.file(layer))?;
    }
    tell(&mut report, args, &slices);
    Ok(report)
}

fn tell(report: &mut Report, args: &SliceArgs, slices: &Slices) {
    let open: usize = slices.layers.iter().map(|layer| layer.open.len()).sum();
    if open > 0 {
        let outlines = counted(open, "outline");
        report.notices.push(format!(
            "{}: {outlines} left out, because the mesh is open there; `trullo check` says where",
            args.input.display()
        ));
    }
    report.put("output", args.output.display().to_string());
    report.put("layer_height_mm", number(args.layer_height.mm()));
    report.put("volume_mm3", slices.volume());
    report.put("open_outlines", open);
    let layers = slices.planes.heights.iter().zip(&slices.layers).enumerate().map(|(k, (&z, layer))| {
        serde_json::json!({ "z": z, "area_mm2": slices.area(k), "regions": layer.region_count() })
    });
    report.put("layers", layers.collect::<Vec<_>>());
    report.line(format!(
        "{}: {} of {} mm, {:.1} mm³",
        args.output.display(),
        counted(slices.layers.len(), "layer"),
        args.layer_height.mm(),
        slices.volume(),
    ));
}
