//! From a scene to a mesh that may be written, and from a mesh to a file.

use crate::cli::{ConstraintArgs, ResolutionArgs};
use crate::failure::Failure;
use crate::job::{Job, Watch};
use crate::resolution::cell_size;
use crate::stoppable::Stoppable;
use crate::{constraint, materials};
use blobtree::{BakeStore, Node, NodeRef, Scene, Tree, solid_box};
use mesh::io::{Attachments, Format, TriangleMaterials};
use mesh::{Fault, Mesh, SelfIntersections, Validity, simplify};
use polygonizer::{CellSize, Options, Surface};
use std::io::Cursor;
use std::path::Path;

/// A scene's mesh.
#[derive(Debug)]
pub struct Meshed {
    /// The mesh.
    pub mesh: Mesh,
    /// The cell size used, mm.
    pub cell_mm: f32,
    /// How many support-free nodes were left as drawn.
    pub unconstrained: usize,
    /// The bakes of its support-free nodes.
    pub bakes: BakeStore,
}

impl Meshed {
    /// What the triangles are made of, for files that can say it; the mesh was simplified by up to `tolerance` mm.
    ///
    /// Errors: [`Failure::Interrupted`].
    pub fn materials(
        &self,
        root: &NodeRef,
        format: Format,
        tolerance: f64,
        job: &mut Job,
    ) -> Result<Option<TriangleMaterials>, Failure> {
        match format {
            Format::ThreeMf => {
                materials::of_mesh(root, &self.bakes, &self.mesh, self.cell_mm, tolerance as f32, job)
            }
            _ => Ok(None),
        }
    }
}

/// Meshes a scene. Stages "compile", "size", "constrain" and "mesh".
///
/// Errors: a support-free node that cannot be baked; and as [`cell_of`] and [`mesh_tree`].
pub fn mesh_scene(
    path: &Path,
    scene: &Scene,
    resolution: &ResolutionArgs,
    constraint: ConstraintArgs,
    job: &mut Job,
) -> Result<Meshed, Failure> {
    let drawn = job.stage("compile", |_| Ok(Tree::new(&scene.root)))?;
    if constraint.no_constraint || drawn.unconstrained() == 0 {
        let cell =
            job.stage("size", |_| cell_size(resolution, &drawn).map_err(|e| Failure::of_meshing(path, e)))?;
        return mesh_tree(path, &drawn, cell, job);
    }
    let cell = cell_of(path, &scene.root, &drawn, resolution, job)?;
    let bakes = constraint::bakes(path, &scene.root, constraint, Some(cell), job)?;
    let tree = job.stage("compile", |_| Ok(bakes.compile(&scene.root)))?;
    Ok(Meshed { bakes, ..mesh_tree(path, &tree, cell, job)? })
}

/// The cell size for a scene whose tree, as drawn, is `drawn`: the one that was asked for; else the usual one, but no
/// wider than a layer of a support-free node is high, as coarser meshes leave ledges. Stage "size".
///
/// Errors: a size that no cell can have.
pub fn cell_of(
    path: &Path,
    root: &Node,
    drawn: &Tree,
    resolution: &ResolutionArgs,
    job: &mut Job,
) -> Result<CellSize, Failure> {
    let failed = |e| Failure::of_meshing(path, e);
    job.stage("size", |_| {
        let cell = cell_size(resolution, drawn).map_err(failed)?;
        match constraint::finest_layer(root) {
            Some(layer) if resolution.cell.is_none() && resolution.cells.is_none() => {
                // Of a shape that is all brush strokes, nothing is drawn.
                let usual = if solid_box(drawn).is_empty() { layer } else { cell.mm() };
                CellSize::from_mm(usual.min(layer)).map_err(failed)
            }
            _ => Ok(cell),
        }
    })
}

/// Meshes a compiled scene, with no bakes in the answer. Stage "mesh".
///
/// Errors: a cell size that is too small for the shape; a shape without any solid.
pub fn mesh_tree(path: &Path, tree: &Tree, cell: CellSize, job: &mut Job) -> Result<Meshed, Failure> {
    let failed = |e| Failure::of_meshing(path, e);
    job.stage("mesh", |watch| {
        let progress = |share| watch.report(share);
        let options = Options { cancel: Some(watch.cancel), progress: Some(&progress), ..Options::default() };
        let mesh = Surface::build(tree, cell, &options).map_err(failed)?.mesh();
        if mesh.triangles.is_empty() {
            let what = format!(
                "the scene has no solid at a cell size of {} mm: it is empty, muted, or finer than that",
                cell.mm()
            );
            return Err(Failure::of(path, what));
        }
        let (cell_mm, unconstrained) = (cell.mm(), tree.unconstrained());
        Ok(Meshed { mesh, cell_mm, unconstrained, bakes: BakeStore::new() })
    })
}

/// The format that the name of an output file asks for.
///
/// Errors: a name that asks for none.
pub fn format_of_output(path: &Path) -> Result<Format, Failure> {
    Format::from_path(path).ok_or_else(|| {
        Failure::of(path, "the name must end in .stl, .obj, .ply or .3mf, which says the format to write")
    })
}

/// The mesh with fewer triangles: its surface has moved by no more than `tolerance` mm. Stage "simplify".
///
/// Errors: [`Failure::Interrupted`].
pub fn simplified(mesh: &Mesh, tolerance: f64, job: &mut Job) -> Result<Mesh, Failure> {
    job.stage("simplify", |watch| {
        simplify(mesh, tolerance, &|| watch.cancel.is_cancelled()).ok_or(Failure::Interrupted)
    })
}

/// Writes a mesh if it is closed, edge-manifold and oriented, in the format that the name says. Stages "verify",
/// "encode" and "write".
///
/// Errors: a mesh that is not, with what is wrong; a file that cannot be written. Then nothing was written.
pub fn write_mesh(
    source: &Path,
    output: &Path,
    mesh: &Mesh,
    attachments: &Attachments,
    job: &mut Job,
) -> Result<(), Failure> {
    write_mesh_as(source, output, mesh, format_of_output(output)?, attachments, job)
}

/// The same in any format.
///
/// Errors: as [`write_mesh`].
pub fn write_mesh_as(
    source: &Path,
    output: &Path,
    mesh: &Mesh,
    format: Format,
    attachments: &Attachments,
    job: &mut Job,
) -> Result<(), Failure> {
    job.stage("verify", |watch| verify(source, mesh, watch))?;
    let bytes = job.stage("encode", |watch| {
        let mut bytes = Stoppable::new(Cursor::new(Vec::new()), watch.cancel);
        mesh::io::write(&mut bytes, mesh, format, attachments).map_err(|e| Failure::of(output, e))?;
        Ok(bytes.into_inner().into_inner())
    })?;
    job.write(output, &bytes)
}

/// Errors: a mesh that does not bound a solid; [`Failure::Interrupted`].
fn verify(source: &Path, mesh: &Mesh, watch: &Watch) -> Result<(), Failure> {
    let cancelled = || watch.cancel.is_cancelled();
    let is_closed = mesh.is_closed_manifold_unless(&cancelled).ok_or(Failure::Interrupted)?;
    if is_closed && mesh.volume() > 0.0 {
        return Ok(());
    }
    let validity = mesh.validity(SelfIntersections::Skip);
    let problems = problems(&validity);
    if problems.is_empty() {
        return Ok(());
    }
    let what = format!(
        "not written, because the mesh is not closed, edge-manifold and oriented: {}; repair it first",
        problems.join(", ")
    );
    Err(Failure::of(source, what))
}

/// What keeps a mesh from being written: each fault with its count and first place.
fn problems(validity: &Validity) -> Vec<String> {
    let serious = Fault::ALL.into_iter().filter(|&fault| is_serious(fault) && validity.count(fault) > 0);
    let told = serious.map(|fault| {
        let place = validity.findings().find(|finding| finding.fault == fault).map(|f| f.place);
        let place =
            place.map_or(String::new(), |p| format!(" (the first at {:.3}, {:.3}, {:.3})", p.x, p.y, p.z));
        format!("{} × {fault}{place}", validity.count(fault))
    });
    told.collect()
}

/// Whether a fault keeps a mesh from being the boundary of a solid; slicers put up with the others.
pub fn is_serious(fault: Fault) -> bool {
    !matches!(fault, Fault::ZeroArea | Fault::UnusedVertex | Fault::NonManifoldVertex | Fault::RedundantBody)
}
