//! `trullo support-free`: a scene or mesh becomes one that prints without supports.

mod why;

use crate::cli::{ConstraintArgs, SupportFreeArgs, SupportOperator};
use crate::constraint;
use crate::failure::Failure;
use crate::input::{self, Input, Prefer};
use crate::job::Job;
use crate::meshing::{self, Meshed};
use crate::output::{Report, check_writable, number, short};
use crate::verbs::mesh::tell;
use blobtree::build::{Build, primitive};
use blobtree::{Aabb, Bake, BakeStore, Field, ISO, Node, NodeRef, Primitive, Scene, SupportFree, Tree};
use glam::Vec3;
use mesh::Mesh;
use std::path::Path;

/// How far the field of a mesh reaches beyond its surface, in layers: far enough to be cut smoothly.
const FALLOFF_LAYERS: f32 = 8.0;

/// Most places along a side at which the field is looked at.
const MOST_ALONG: f32 = 512.0;

/// Makes a scene or mesh support-free and writes a scene or a mesh.
///
/// Errors: an input that cannot be read, a shape of which nothing is left, a file that cannot be written.
pub fn run(args: &SupportFreeArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let to_scene = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"));
    if !to_scene {
        meshing::format_of_output(&args.output).map_err(|_| {
            let what = "the name must end in .trullo for a scene, or in .stl, .obj, .ply or .3mf for a mesh";
            Failure::of(&args.output, what)
        })?;
    }
    check_writable(&args.output)?;
    let rule = SupportFree {
        mode: args.operator.into(),
        overhang_degrees: args.max_overhang,
        layer_height: args.layer_height,
        bed: 0.0,
        strokes: Vec::new(),
    };
    rule.check().map_err(|e| Failure::Input(e.to_string()))?;
    let scene = match input::open(&args.input, None, Prefer::Scene, job, &mut report)? {
        Input::Scene(scene) => constrained_scene(args, rule, scene, job, &mut report)?,
        Input::Mesh(loaded) => {
            let node = mesh_node(args, &loaded.mesh, to_scene, job, &mut report)?;
            Scene { title: loaded.attachments.title, ..Scene::new(node.support_free(rule)) }
        }
    };
    let kept = ConstraintArgs { no_constraint: false };
    let cell = match to_scene {
        true => None,
        false => {
            let drawn = job.stage("compile", |_| Ok(Tree::new(&scene.root)))?;
            Some(meshing::cell_of(&args.input, &scene.root, &drawn, &args.resolution, job)?)
        }
    };
    let bakes = constraint::bakes(&args.input, &scene.root, kept, cell, job)?;
    tell_bake(args, &bakes, &scene.root, &mut report);
    why::tell(&args.input, &scene.root, &bakes, &args.why, job, &mut report)?;
    let Some(cell) = cell else {
        let text = job.stage("encode", |_| scene.to_text().map_err(|e| Failure::of(&args.input, e)))?;
        job.write(&args.output, text.as_bytes())?;
        report.put("output", args.output.display().to_string());
        report.line(format!("{}: the support-free scene", args.output.display()));
        return Ok(report);
    };
    let tree = job.stage("compile", |_| Ok(bakes.compile(&scene.root)))?;
    let meshed = meshing::mesh_tree(&args.input, &tree, cell, job).map_err(|failure| match failure {
        Failure::Interrupted => failure,
        Failure::Input(_) => nothing_left(args, &bakes, &scene.root).unwrap_or(failure),
    })?;
    let meshed = Meshed { bakes, ..meshed };
    let mut attachments = match &args.input {
        path if is_scene(path) => input::attachments(path, &scene)?,
        _ => mesh::io::Attachments { title: scene.title.clone(), ..Default::default() },
    };
    let format = meshing::format_of_output(&args.output)?;
    attachments.materials = meshed.materials(&scene.root, format, 0.0, job)?;
    meshing::write_mesh(&args.input, &args.output, &meshed.mesh, &attachments, job)?;
    tell(&mut report, &args.output, &meshed);
    Ok(report)
}

fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trullo"))
}

/// The scene below the rule, on the bed if that was asked for.
///
/// Errors: a height; to be dropped, a scene without any solid.
fn constrained_scene(
    args: &SupportFreeArgs,
    rule: SupportFree,
    scene: Scene,
    job: &mut Job,
    report: &mut Report,
) -> Result<Scene, Failure> {
    if args.height.is_some() {
        let what = "a scene, which has its own size; --height is for meshes";
        return Err(Failure::of(&args.input, what));
    }
    let lowest = if args.drop { lowest_point(args, &scene.root, job)? } else { 0.0 };
    if args.drop {
        tell_drop(lowest, report);
    }
    let root = match lowest {
        0.0 => scene.root.clone().support_free(rule),
        _ => scene.root.clone().translate(Vec3::new(0.0, 0.0, -lowest)).support_free(rule),
    };
    Ok(Scene { root: root.into(), ..scene })
}

/// How high the lowest point of the scene's solid is, mm, in tenths of a micrometre: that of its mesh in the cells that
/// were asked for, with the support-free nodes that it holds kept. 0 if it is nearer to the bed than a micrometre, which
/// is less than meshes are exact to.
fn lowest_point(args: &SupportFreeArgs, root: &NodeRef, job: &mut Job) -> Result<f32, Failure> {
    let tree = constraint::compile(&args.input, root, ConstraintArgs { no_constraint: false }, job)?;
    let cell = meshing::cell_of(&args.input, root, &tree, &args.resolution, job)?;
    let lowest = meshing::mesh_tree(&args.input, &tree, cell, job)?.mesh.bounds().min.z;
    Ok(if lowest.abs() < 1e-3 { 0.0 } else { (1e4 * lowest).round() / 1e4 })
}

/// How far the shape was moved to the bed.
fn tell_drop(lowest: f32, report: &mut Report) {
    report.put("dropped_mm", number(lowest));
    report.line(match lowest {
        0.0 => "drop: its lowest point is on the bed already".to_owned(),
        above if above > 0.0 => format!("drop: lowered by {} mm to the bed", short(above)),
        below => format!("drop: raised by {} mm to the bed", short(-below)),
    });
}

/// The mesh as a node, at the height and place that were asked for.
fn mesh_node(
    args: &SupportFreeArgs,
    mesh: &Mesh,
    to_scene: bool,
    job: &mut Job,
    report: &mut Report,
) -> Result<Node, Failure> {
    let folder = to_scene.then(|| args.output.parent().unwrap_or(Path::new("")));
    let imported = job.stage("import", |_| {
        input::imported_mesh(&args.input, mesh, folder, FALLOFF_LAYERS * args.layer_height)
    })?;
    let bounds = mesh.bounds();
    let tall = f64::from(bounds.size().z);
    let scale = match args.height {
        Some(height) if tall > 0.0 && height.is_finite() => (height / tall) as f32,
        Some(height) => {
            let what = format!("flat, so it cannot be scaled to a height of {height} mm");
            return Err(Failure::of(&args.input, what));
        }
        None => 1.0,
    };
    // The falloff is scaled, too.
    let imported = blobtree::ImportedMesh { falloff: imported.falloff / scale, ..imported };
    let mut node = primitive(Primitive::Mesh(imported));
    if scale != 1.0 {
        node = node.scale([scale; 3]);
    }
    let lowest = bounds.min.z * scale;
    if args.drop {
        tell_drop(lowest, report);
    }
    Ok(if args.drop && lowest != 0.0 { node.translate(Vec3::new(0.0, 0.0, -lowest)) } else { node })
}

/// What was taken away and added.
fn tell_bake(args: &SupportFreeArgs, bakes: &BakeStore, root: &NodeRef, report: &mut Report) {
    let nothing = Bake::default();
    let bake = bakes.of(root).map_or(&nothing, |bake| bake);
    report.put("operator", args.operator.name());
    report.put("max_overhang_degrees", number(args.max_overhang));
    report.put("layer_height_mm", number(args.layer_height));
    report.put("removed_mm3", bake.removed_mm3);
    report.put("added_mm3", bake.added_mm3);
    // Grown matter always goes on below the bed; the shape may not.
    let grows = args.operator == SupportOperator::Grow;
    let cut_at_bed = bake.cut_at_bed && (!grows || reaches_below_bed(args, bakes, root));
    report.put("cut_at_bed", cut_at_bed);
    report.line(format!(
        "{}: {:.1} mm³ taken away, {:.1} mm³ added",
        args.operator.name(),
        bake.removed_mm3,
        bake.added_mm3
    ));
    if cut_at_bed {
        let remedy = if args.drop { "" } else { "; --drop puts its lowest point on the bed" };
        report.notices.push(format!("the shape reaches below the bed z = 0 and was cut there{remedy}"));
    }
}

/// Whether the shape that was made support-free is solid half a layer below the bed, at places a layer apart, or at
/// [`MOST_ALONG`] along a side.
fn reaches_below_bed(args: &SupportFreeArgs, bakes: &BakeStore, root: &NodeRef) -> bool {
    let drawn = root.children().first().map(|child| bakes.compile(child));
    let Some(drawn) = drawn else { return false };
    let support = drawn.support();
    let below = -0.5 * args.layer_height;
    if support.is_empty() || support.min.z > below {
        return false;
    }
    let plane = Aabb { min: support.min.with_z(below), max: support.max.with_z(below) };
    let mut sampler = drawn.sampler();
    if sampler.enter(plane).hi < ISO {
        return false;
    }
    let count = |length: f32| (length / args.layer_height).ceil().clamp(1.0, MOST_ALONG) as usize;
    let (width, depth) = (count(plane.size().x), count(plane.size().y));
    let share = |n: usize, count: usize| (n as f32 + 0.5) / count as f32;
    let mut values = vec![0.0; width];
    (0..depth).any(|y| {
        let place = |x: usize| plane.min + plane.size() * Vec3::new(share(x, width), share(y, depth), 0.0);
        let places: Vec<Vec3> = (0..width).map(place).collect();
        sampler.values(&places, &mut values);
        values.iter().any(|value| *value >= ISO)
    })
}

/// The reason if all of a shape was taken away.
fn nothing_left(args: &SupportFreeArgs, bakes: &BakeStore, root: &NodeRef) -> Option<Failure> {
    let bake = bakes.of(root)?;
    let what =
        "nothing is left: no part of the shape stands on the bed z = 0; --drop puts its lowest point there";
    (bake.removed_mm3 > 0.0 || bake.cut_at_bed).then(|| Failure::of(&args.input, what))
}
