//! Triangles to samples: which one every ray meets first.

use super::buffer::{Buffer, Frame, Kind, Sample};
use super::camera::Camera;
use super::paint::Paint;
use crate::failure::Failure;
use crate::job::Watch;
use glam::{Vec2, Vec3};
use mesh::Mesh;
use rayon::prelude::*;

/// Rows drawn by one thread at a time.
const BAND: usize = 32;
/// Faces that meet at a smaller angle are shaded as one smooth surface: cosine of 38°.
const SMOOTH: f32 = 0.788;
/// At a vertex with more triangles than this, faces are shaded flat; comparing all pairs would take too long.
const MOST_AROUND: usize = 64;

/// A mesh with a unit normal for each corner of each triangle, world space.
#[derive(Debug)]
pub struct Shaded<'a> {
    mesh: &'a Mesh,
    normals: Vec<[Vec3; 3]>,
}

impl<'a> Shaded<'a> {
    /// Finds the normals: smooth except across sharp edges. All indices must exist.
    pub fn new(mesh: &'a Mesh) -> Self {
        let corner = |v: u32| mesh.positions[v as usize];
        let face = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            (b - a).cross(c - a)
        };
        // The length of a face's normal is twice its area, which is its weight.
        let faces: Vec<Vec3> = mesh.triangles.par_iter().map(face).collect();
        let around = Around::new(mesh);
        let corners = mesh.triangles.par_iter().zip(&faces).map(|(triangle, &own)| {
            let unit = own.normalize_or_zero();
            triangle.map(|v| {
                let beside = around.triangles(v);
                if beside.len() > MOST_AROUND {
                    return unit;
                }
                let faces = beside.iter().map(|&t| faces[t as usize]);
                let smooth = faces.filter(|n| n.dot(unit) > SMOOTH * n.length()).sum::<Vec3>();
                smooth.try_normalize().unwrap_or(unit)
            })
        });
        Self { mesh, normals: corners.collect() }
    }

    /// Draws the mesh as `camera` sees it.
    ///
    /// Errors: [`Failure::Interrupted`].
    pub fn draw(
        &self,
        camera: &Camera,
        paint: Paint,
        frame: Frame,
        watch: &Watch,
    ) -> Result<Buffer, Failure> {
        let points: Vec<Vec3> = self.mesh.positions.par_iter().map(|&p| camera.point_from_world(p)).collect();
        let places: Vec<[f32; 2]> = points.par_iter().map(|&p| frame.place_of(p)).collect();
        let bands = self.bands(&places, frame);
        let mut buffer = Buffer::new(frame);
        let rows = buffer.samples.par_chunks_mut(frame.columns * BAND).zip(&bands).enumerate();
        rows.for_each(|(band, (samples, triangles))| {
            for &t in triangles.iter().take_while(|_| watch.go_on().is_ok()) {
                let corners = self.mesh.triangles[t as usize].map(|v| v as usize);
                let spot = Spot::new(corners.map(|v| places[v]), corners.map(|v| points[v].z));
                let normals = self.normals[t as usize].map(|n| camera.direction_from_world(n));
                let color = paint.of(corners.map(|v| self.mesh.positions[v]));
                spot.draw(normals, color, band * BAND, frame, samples);
            }
        });
        watch.go_on()?;
        Ok(buffer)
    }

    /// The triangles that touch each band of rows, in order.
    fn bands(&self, places: &[[f32; 2]], frame: Frame) -> Vec<Vec<u32>> {
        let count = frame.rows.div_ceil(BAND);
        let mut bands = vec![Vec::new(); count];
        for (t, triangle) in (0u32..).zip(&self.mesh.triangles) {
            let rows = triangle.map(|v| places[v as usize][1]);
            let (top, bottom) =
                (rows.into_iter().fold(f32::MAX, f32::min), rows.into_iter().fold(f32::MIN, f32::max));
            if bottom >= 0.0 && top < frame.rows as f32 {
                let last = (bottom as usize / BAND).min(count - 1);
                bands[top.max(0.0) as usize / BAND..=last].iter_mut().for_each(|band| band.push(t));
            }
        }
        bands
    }
}

/// The triangles at each vertex.
#[derive(Debug)]
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut triangles = vec![0; 3 * mesh.triangles.len()];
        for (t, triangle) in (0u32..).zip(&mesh.triangles) {
            for &v in triangle {
                triangles[next[v as usize] as usize] = t;
                next[v as usize] += 1;
            }
        }
        Self { starts, triangles }
    }

    fn triangles(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.triangles[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// A triangle in the picture.
struct Spot {
    places: [Vec2; 3],
    depths: [f32; 3],
    /// Twice the area, negative for a triangle that faces the viewer, as rows run down.
    doubled: f32,
}

impl Spot {
    fn new(places: [[f32; 2]; 3], depths: [f32; 3]) -> Self {
        let places = places.map(Vec2::from_array);
        let doubled = (places[1] - places[0]).perp_dot(places[2] - places[0]);
        Self { places, depths, doubled }
    }

    /// Draws itself into the band of rows that begins at `first_row`.
    fn draw(
        &self,
        normals: [Vec3; 3],
        color: [u8; 3],
        first_row: usize,
        frame: Frame,
        samples: &mut [Sample],
    ) {
        if self.doubled == 0.0 || !self.doubled.is_finite() {
            return;
        }
        let [a, b, c] = self.places;
        let (low, high) = (a.min(b).min(c).ceil(), a.max(b).max(c).floor());
        let columns = low.x.max(0.0) as usize..((high.x + 1.0).max(0.0) as usize).min(frame.columns);
        let end = first_row + samples.len() / frame.columns;
        let rows = (low.y.max(0.0) as usize).max(first_row)..((high.y + 1.0).max(0.0) as usize).min(end);
        let front = self.doubled < 0.0;
        for row in rows {
            for column in columns.clone() {
                let p = Vec2::new(column as f32, row as f32);
                let shares = [[b, c], [c, a], [a, b]].map(|[from, to]| beside(from, to, p) / self.doubled);
                if shares.iter().any(|&share| share < 0.0) {
                    continue;
                }
                let depth = (0..3).map(|i| shares[i] * self.depths[i]).sum::<f32>();
                let sample = &mut samples[(row - first_row) * frame.columns + column];
                if depth > sample.depth {
                    let normal = (0..3).map(|i| shares[i] * normals[i]).sum::<Vec3>();
                    *sample = match front {
                        true => Sample::new(depth, normal, color, Kind::Surface),
                        false => Sample::new(depth, -normal, color, Kind::Inside),
                    };
                }
            }
        }
    }
}

/// Twice the area of the triangle of an edge and a point: exactly opposite for the opposite edge, so that no ray
/// slips through between neighbours.
fn beside(from: Vec2, to: Vec2, p: Vec2) -> f32 {
    if (from.x, from.y) <= (to.x, to.y) { (to - from).perp_dot(p - from) } else { -beside(to, from, p) }
}
