//! Where upright lines through the centres of voxels cross a mesh.

use super::GridShape;
use glam::Vec3;
use mesh::Mesh;
use robust::{Coord, orient2d};

/// The crossings of one row of columns: by how much the winding number changes before each voxel.
///
/// Each column counts as a line through the centres, moved aside by infinitely little, so it meets no edge and no
/// corner: a closed mesh gives closed columns, however its triangles lie.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    width: usize,
    layers: usize,
    /// Of layer z and column x at `z · width + x`.
    changes: Vec<i32>,
}

impl Columns {
    pub fn new(shape: &GridShape) -> Self {
        let [width, _, layers] = shape.voxels;
        Self { width, layers, changes: vec![0; width * layers] }
    }

    /// How the winding numbers of layer z differ from those of the layer below.
    pub fn changes(&self, z: usize) -> &[i32] {
        &self.changes[z * self.width..][..self.width]
    }

    /// Finds the crossings of row y with these triangles.
    pub fn cross(&mut self, shape: &GridShape, y: usize, triangles: impl Iterator<Item = [Vec3; 3]>) {
        self.changes.fill(0);
        for corners in triangles {
            self.add(shape, y, corners);
        }
    }

    fn add(&mut self, shape: &GridShape, y: usize, corners: [Vec3; 3]) {
        let xs = corners.map(|p| shape.in_voxels(p).x);
        // A voxel more on either side than needed, against rounding; the exact test follows.
        let first = (xs.into_iter().fold(f32::INFINITY, f32::min) - 1.5).max(0.0) as usize;
        let end =
            (xs.into_iter().fold(f32::NEG_INFINITY, f32::max) + 1.5).clamp(0.0, self.width as f32) as usize;
        for x in first..end {
            let column = shape.center([x, y, 0]);
            if let Some((height, up)) = crossing(corners, column) {
                let above = f64::from(height) / f64::from(shape.size.height()) - 0.5;
                let z = (above.floor() + 1.0).max(0.0);
                if z < self.layers as f64 {
                    self.changes[z as usize * self.width + x] += if up { -1 } else { 1 };
                }
            }
        }
    }
}

/// The height at which an upright line crosses a triangle, and whether the triangle faces up.
fn crossing(corners: [Vec3; 3], column: Vec3) -> Option<(f32, bool)> {
    let [a, b, c] = corners;
    let sides = [(b, c), (c, a), (a, b)].map(|(from, to)| side(from, to, column));
    let up = sides.iter().all(|&(left, _)| left);
    if !up && sides.iter().any(|&(left, _)| left) {
        return None;
    }
    let total: f64 = sides.iter().map(|&(_, area)| area).sum();
    let height: f64 = sides.iter().zip(corners).map(|(&(_, area), corner)| area * f64::from(corner.z)).sum();
    // A triangle seen edge on has no inside, but its area may round to nothing.
    (total != 0.0).then_some(((height / total) as f32, up))
}

/// Whether the column lies to the left of a side seen from above, and twice the area between them. A column on the
/// line counts as moved by an infinitely small amount along x, and a far smaller one along y.
fn side(from: Vec3, to: Vec3, column: Vec3) -> (bool, f64) {
    let flat = |p: Vec3| Coord { x: f64::from(p.x), y: f64::from(p.y) };
    let area = orient2d(flat(from), flat(to), flat(column));
    let left = if area != 0.0 {
        area > 0.0
    } else if from.y != to.y {
        from.y > to.y
    } else {
        to.x > from.x
    };
    (left, area)
}

/// Triangles by the bands of rows that they may cross.
#[derive(Debug)]
pub(super) struct Bands {
    triangles: Vec<Vec<u32>>,
}

/// Rows in a band.
pub(super) const BAND: usize = 16;

impl Bands {
    pub fn new(mesh: &Mesh, shape: &GridShape) -> Self {
        let rows = shape.voxels[1];
        let mut triangles = vec![Vec::new(); rows.div_ceil(BAND)];
        for (id, corners) in (0..=u32::MAX).zip(mesh.triangles.iter().map(|&t| mesh.corners(t))) {
            let Some(corners) = corners else { continue };
            let ys = corners.map(|p| shape.in_voxels(p).y);
            let first = (ys.into_iter().fold(f32::INFINITY, f32::min) - 1.5).clamp(0.0, rows as f32) as usize;
            let end =
                (ys.into_iter().fold(f32::NEG_INFINITY, f32::max) + 1.5).clamp(0.0, rows as f32) as usize;
            for band in triangles.iter_mut().take(end.div_ceil(BAND)).skip(first / BAND) {
                band.push(id);
            }
        }
        Self { triangles }
    }

    /// The corners of all triangles that may cross this row.
    pub fn of_row<'a>(&'a self, mesh: &'a Mesh, y: usize) -> impl Iterator<Item = [Vec3; 3]> + 'a {
        self.triangles[y / BAND].iter().filter_map(|&id| mesh.corners(mesh.triangles[id as usize]))
    }
}
