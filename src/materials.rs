//! What the triangles of a scene's mesh are made of.

use crate::failure::Failure;
use crate::job::Job;
use blobtree::{BakeStore, GROWN_MATERIAL, Materials, NodeRef, STONE};
use glam::Vec3;
use mesh::Mesh;
use mesh::io::{Material, TriangleMaterials};
use rayon::prelude::*;

/// Triangles that are looked at together.
const TOGETHER: usize = 256;

/// How far below its middle a triangle is asked what it is made of, in cells: meshes are nearer to curved surfaces.
const BELOW: f32 = 0.25;

/// Colours of other materials than the shape's, one after the other.
const COLORS: [[u8; 3]; 6] =
    [[217, 119, 54], [62, 125, 168], [104, 150, 73], [160, 92, 150], [205, 172, 60], [120, 120, 120]];

/// What each triangle of the mesh of a scene is made of; none if all is of the shape's own material. In cells of
/// `cell_mm`, simplified by up to `moved_mm`. Stage "materials" if there are others.
///
/// Errors: [`Failure::Interrupted`].
pub fn of_mesh(
    root: &NodeRef,
    bakes: &BakeStore,
    mesh: &Mesh,
    cell_mm: f32,
    moved_mm: f32,
    job: &mut Job,
) -> Result<Option<TriangleMaterials>, Failure> {
    let materials = Materials::new(root, bakes);
    if materials.is_plain() {
        return Ok(None);
    }
    let depth = BELOW * cell_mm + moved_mm;
    job.stage("materials", |watch| {
        let chunks = mesh.triangles.par_chunks(TOGETHER);
        let found = chunks.map_init(
            || materials.finder(),
            |finder, triangles| {
                watch.go_on()?;
                let places: Vec<Vec3> = triangles.iter().map(|corners| below(mesh, corners, depth)).collect();
                Ok(finder.materials(&places))
            },
        );
        let found: Vec<Vec<u8>> = found.collect::<Result<_, Failure>>()?;
        Ok(numbered(&found.concat()))
    })
}

/// A place so far below the middle of a triangle.
fn below(mesh: &Mesh, corners: &[u32; 3], depth: f32) -> Vec3 {
    let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
    let outwards = (b - a).cross(c - a).normalize_or_zero();
    (a + b + c) / 3.0 - outwards * depth
}

/// The materials that occur, with 0 whether it does or not; none if no other does.
fn numbered(of_triangles: &[u8]) -> Option<TriangleMaterials> {
    let mut kinds: Vec<u8> = (0..=u8::MAX).filter(|kind| of_triangles.contains(kind)).collect();
    if kinds.iter().all(|kind| *kind == 0) {
        return None;
    }
    if kinds[0] != 0 {
        kinds.insert(0, 0);
    }
    let number = |kind: &u8| kinds.iter().position(|known| known == kind).unwrap_or(0) as u32;
    let of_triangles = of_triangles.iter().map(number).collect();
    Some(TriangleMaterials { materials: kinds.into_iter().map(material).collect(), of_triangles })
}

/// How a material is called and shown.
fn material(kind: u8) -> Material {
    let name = match kind {
        0 => "model".to_owned(),
        GROWN_MATERIAL => "grown".to_owned(),
        other => format!("material {other}"),
    };
    let color = match kind {
        0 => STONE.0,
        other => COLORS[(usize::from(other) - 1) % COLORS.len()],
    };
    Material { name, color }
}
