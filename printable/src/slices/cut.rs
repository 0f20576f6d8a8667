//! Where planes cross triangles.

use super::error::{MOST_CROSSINGS, SliceError};
use super::grid::{Grid, Point};
use glam::{DVec3, Vec3};
use mesh::Mesh;

/// Layers that one thread cuts at a time.
pub(crate) const CHUNK: usize = 8;

/// One triangle cut by one plane: a piece of outline with the solid on its left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// The edge of the mesh where it begins; the next piece begins on the edge where this one ends.
    pub(crate) from: u64,
    /// The edge where it ends.
    pub(crate) to: u64,
    /// Where it begins.
    pub(crate) start: Point,
}

/// A mesh with the triangles that each run of [`CHUNK`] planes crosses.
pub(crate) struct Cutter<'a> {
    mesh: &'a Mesh,
    /// Heights of the planes, ascending, mm.
    planes: &'a [f64],
    grid: Grid,
    /// Where each chunk's triangles begin in `triangles`, and where the last one's end.
    starts: Vec<usize>,
    triangles: Vec<u32>,
}

impl<'a> Cutter<'a> {
    /// All vertices in use must be finite.
    ///
    /// Errors: [`SliceError::TooDetailed`].
    pub(crate) fn new(mesh: &'a Mesh, planes: &'a [f64], grid: Grid) -> Result<Self, SliceError> {
        let mut starts = vec![0; planes.len().div_ceil(CHUNK) + 1];
        let mut crossings = 0;
        for span in spans(mesh, planes) {
            crossings += span.len() as u64;
            chunks_of(&span).for_each(|chunk| starts[chunk + 1] += 1);
        }
        if crossings > MOST_CROSSINGS {
            return Err(SliceError::TooDetailed { crossings });
        }
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut triangles = vec![0; starts[starts.len() - 1]];
        for (t, span) in (0u32..).zip(spans(mesh, planes)) {
            for chunk in chunks_of(&span) {
                triangles[next[chunk]] = t;
                next[chunk] += 1;
            }
        }
        Ok(Self { mesh, planes, grid, starts, triangles })
    }

    /// The crossings of each plane of a chunk, in the order of their triangles.
    pub(crate) fn cut(&self, chunk: usize) -> Vec<Vec<Crossing>> {
        let first = chunk * CHUNK;
        let planes = &self.planes[first..self.planes.len().min(first + CHUNK)];
        let mut layers = vec![Vec::new(); planes.len()];
        for &t in &self.triangles[self.starts[chunk]..self.starts[chunk + 1]] {
            let triangle = self.mesh.triangles[t as usize];
            let corners = triangle.map(|v| self.mesh.positions[v as usize]);
            let span = span(corners, planes);
            for (layer, &z) in layers[span.clone()].iter_mut().zip(&planes[span]) {
                layer.push(crossing(triangle, corners, z, &self.grid));
            }
        }
        layers
    }

    /// Runs of planes.
    pub(crate) fn chunks(&self) -> usize {
        self.starts.len() - 1
    }
}

/// The planes that each triangle crosses.
fn spans<'a>(mesh: &'a Mesh, planes: &'a [f64]) -> impl Iterator<Item = std::ops::Range<usize>> + 'a {
    mesh.triangles.iter().map(|&t| mesh.corners(t).map_or(0..0, |corners| span(corners, planes)))
}

/// The planes that a triangle crosses: those with a corner below and a corner not below.
fn span(corners: [Vec3; 3], planes: &[f64]) -> std::ops::Range<usize> {
    let not_above = |p: Vec3| planes.partition_point(|&z| z <= f64::from(p.z));
    let [a, b, c] = corners.map(not_above);
    a.min(b).min(c)..a.max(b).max(c)
}

fn chunks_of(span: &std::ops::Range<usize>) -> std::ops::Range<usize> {
    if span.is_empty() { 0..0 } else { span.start / CHUNK..(span.end - 1) / CHUNK + 1 }
}

/// A corner on the plane counts as above it. So each triangle has two edges that cross the plane or none, and
/// outlines close wherever the mesh does.
fn crossing(triangle: [u32; 3], corners: [Vec3; 3], z: f64, grid: &Grid) -> Crossing {
    let above = corners.map(|p| f64::from(p.z) >= z);
    let (mut from, mut to, mut start) = (0, 0, Point::ZERO);
    for i in 0..3 {
        let j = (i + 1) % 3;
        if above[i] && !above[j] {
            from = edge(triangle[i], triangle[j]);
            start = grid.point(meet([(triangle[i], corners[i]), (triangle[j], corners[j])], z));
        } else if !above[i] && above[j] {
            to = edge(triangle[i], triangle[j]);
        }
    }
    Crossing { from, to, start }
}

fn edge(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// Where an edge meets the plane; the same, bit for bit, whichever of its triangles asks.
fn meet(mut ends: [(u32, Vec3); 2], z: f64) -> glam::DVec2 {
    ends.sort_unstable_by_key(|&(vertex, _)| vertex);
    let [a, b]: [DVec3; 2] = ends.map(|(_, p)| p.as_dvec3());
    a.truncate().lerp(b.truncate(), (z - a.z) / (b.z - a.z))
}
