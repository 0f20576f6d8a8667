//! Voxels of a mesh.

use super::bits::{Block, Row, for_width};
use super::columns::{BAND, Bands, Columns};
use super::{GridShape, VoxelError, VoxelGrid, VoxelSize};
use blobtree::Aabb;
use mesh::{Mesh, MeshDistance};
use rayon::prelude::*;

impl VoxelGrid {
    /// The inside of a mesh, wherever it lies above the bed.
    ///
    /// - **Which side:** of a closed and oriented mesh, a voxel is solid if upright lines find its centre wrapped at
    ///   least once, which is exact; bodies that overlap are one. Of any other, a voxel is solid if the generalised
    ///   winding number is above one half, so holes are closed where they look closed from within. Along each upright
    ///   line that number is looked at beside all crossings and in every 16th voxel between; where two looks in a row
    ///   agree, so does what is between them. A mesh turned inside out is turned back.
    /// - **Promises:** the same for any number of threads.
    /// - **Errors:** more than [`MAX_VOXELS`](super::MAX_VOXELS) along a side; no inside; more than half a layer below
    ///   the bed; nothing on the bed; corners that are missing or not finite.
    pub fn from_mesh(mesh: &Mesh, size: VoxelSize) -> Result<Self, VoxelError> {
        let closed = mesh.positions.iter().all(|p| p.is_finite()) && mesh.is_closed_manifold();
        let distance = if closed { None } else { Some(MeshDistance::new(mesh)?) };
        let bounds = distance.as_ref().map_or_else(|| mesh.bounds(), MeshDistance::bounds);
        if bounds.min.z < -0.5 * size.height() {
            return Err(VoxelError::BelowBed { by: -bounds.min.z });
        }
        let mut grid = Self::new(GridShape::covering(Aabb { min: bounds.min, max: bounds.max }, size)?);
        for_width!(grid.solid.words, W => fill::<W>(mesh, distance.as_ref(), &mut grid));
        grid.on_the_bed()
    }
}

/// Voxels from one look at the winding number to the next.
const LOOK: usize = 16;

/// Fills the grid row by row, in bands on all threads.
fn fill<const W: usize>(mesh: &Mesh, distance: Option<&MeshDistance>, grid: &mut VoxelGrid) {
    let shape = grid.shape;
    let [_, ny, nz] = shape.voxels;
    let bands = Bands::new(mesh, &shape);
    let outward = mesh.volume() >= 0.0;
    // The rows of each band, from one layer to the next.
    let rows: Vec<Vec<Row<W>>> = (0..ny.div_ceil(BAND))
        .into_par_iter()
        .map_init(
            || Columns::new(&shape),
            |columns, band| {
                let range = band * BAND..((band + 1) * BAND).min(ny);
                let mut rows = vec![[0; W]; range.len() * nz];
                for (n, y) in range.clone().enumerate() {
                    columns.cross(&shape, y, bands.of_row(mesh, y));
                    let row_of = |z: usize| z * range.len() + n;
                    match distance {
                        None => wrapped(columns, outward, |z, row| rows[row_of(z)] = row, nz),
                        Some(distance) => {
                            let mut set = |x: usize, z: usize| rows[row_of(z)][x / 64] |= 1 << (x % 64);
                            looked_at(columns, distance, &shape, y, &mut set);
                        }
                    }
                }
                rows
            },
        )
        .collect();
    for (z, layer) in grid.solid.layers.iter_mut().enumerate() {
        let mut block = Block::<W>::default();
        for rows in &rows {
            let height = rows.len() / nz;
            block.rows.extend_from_slice(&rows[z * height..][..height]);
        }
        block.tighten();
        layer.set(&block);
    }
}

/// The rows of voxels that the mesh wraps at least once.
fn wrapped<const W: usize>(
    columns: &Columns,
    outward: bool,
    mut set: impl FnMut(usize, Row<W>),
    layers: usize,
) {
    let mut winding = vec![0i32; columns.changes(0).len()];
    for z in 0..layers {
        let mut row = [0; W];
        for (x, (winding, change)) in winding.iter_mut().zip(columns.changes(z)).enumerate() {
            *winding += change;
            let inside = if outward { *winding > 0 } else { *winding < 0 };
            row[x / 64] |= u64::from(inside) << (x % 64);
        }
        set(z, row);
    }
}

/// Sets the voxels of a row whose winding number is above one half.
fn looked_at(
    columns: &Columns,
    distance: &MeshDistance,
    shape: &GridShape,
    y: usize,
    set: &mut impl FnMut(usize, usize),
) {
    let [nx, _, nz] = shape.voxels;
    for x in 0..nx {
        let inside = |z: usize| distance.winding_number(shape.center([x, y, z])) > 0.5;
        let mut first = 0;
        while first < nz {
            let end = (first + 1..nz).find(|&z| columns.changes(z)[x] != 0).unwrap_or(nz);
            let mut last = (first, inside(first));
            for z in (first + LOOK..end - 1).step_by(LOOK).chain([end - 1]) {
                let look = (z, inside(z));
                if look.1 == last.1 {
                    (last.0..if look.1 { z + 1 } else { last.0 }).for_each(|z| set(x, z));
                } else {
                    (last.0..=z).filter(|&z| inside(z)).for_each(|z| set(x, z));
                }
                last = look;
            }
            first = end;
        }
    }
}
