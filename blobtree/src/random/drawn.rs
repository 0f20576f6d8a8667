//! Drawings and their templates without the sketch room: strokes are closed polygons, distances exact.

use crate::falloff::Falloff;
use crate::scene::{MeshReference, SceneSources};
use crate::sketched::{Drawing, DrawnPoint, DrawnStroke, FieldImage, Template};
use fastrand::Rng;
use glam::Vec2;
use mesh::MeshDistance;
use std::f32::consts::TAU;
use std::sync::Arc;

/// Samples along the longer side of a template; bricks of tests see about as much.
const PIXELS: usize = 64;
/// Edges that turn by more than this make a corner.
const CORNER: f32 = 0.7;

/// Solves drawings as polygons, and knows no meshes: a stand-in for the sketch room in tests and benches.
#[derive(Clone, Copy, Debug, Default)]
pub struct PolygonSources;

impl SceneSources for PolygonSources {
    fn mesh(&mut self, _: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        Err("mesh files are not read here".into())
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        polygon_template(drawing, falloff, PIXELS).map(Arc::new)
    }
}

/// The exact distance from the polygons that the strokes make, filled even-odd.
///
/// - **In:** `falloff` as the node says, mm; `pixels` along the longer side of the image.
/// - **Errors:** nothing is enclosed.
/// - **Cost:** pixels² · points.
pub fn polygon_template(drawing: &Drawing, falloff: Option<f32>, pixels: usize) -> Result<Template, String> {
    let contours: Vec<Vec<Vec2>> =
        drawing.strokes.iter().map(|stroke| stroke.points.iter().map(|p| p.at).collect()).collect();
    let depth = |at: Vec2| -distance(&contours, at);
    let rough = Grid::around(&contours, 0.0, pixels.min(64));
    let deepest = rough.places().map(depth).fold(0.0f32, f32::max);
    if deepest.is_nan() || deepest <= 1e-3 {
        return Err("it encloses nothing".into());
    }
    let width = falloff.unwrap_or(1.05 * Falloff::of_depth(deepest).width());
    let grid = Grid::around(&contours, width, pixels);
    let depth = grid.places().map(depth).fold(deepest, f32::max);
    let pressed = drawing.strokes.iter().flat_map(|stroke| &stroke.points).any(|p| p.pressure < 1.0);
    let image = |f: &dyn Fn(Vec2) -> f32| {
        FieldImage::new(grid.origin, grid.pixel, grid.size, grid.places().map(f).collect())
            .map_err(|e| e.to_string())
    };
    let distances = image(&|at| distance(&contours, at))?;
    Ok(Template {
        bulge: distances.bulge(depth),
        distance: distances,
        pressure: if pressed { Some(image(&|at| nearest_pressure(drawing, at))?) } else { None },
        falloff: width,
        depth,
        corners: contours.iter().flat_map(|contour| corners(contour)).collect(),
        contours,
    })
}

/// The places of an image's samples.
struct Grid {
    origin: Vec2,
    pixel: f32,
    size: [usize; 2],
}

impl Grid {
    /// Around the contours and `margin`, and three samples more.
    fn around(contours: &[Vec<Vec2>], margin: f32, pixels: usize) -> Self {
        let mut points = contours.iter().flatten().copied();
        let first = points.next().unwrap_or(Vec2::ZERO);
        let (min, max) = points.fold((first, first), |(min, max), p| (min.min(p), max.max(p)));
        let (min, max) = (min - margin, max + margin);
        let pixel = ((max - min).max_element() / (pixels.max(16) - 7) as f32).max(1e-4);
        let samples = ((max - min) / pixel).ceil();
        Self { origin: min - 3.0 * pixel, pixel, size: [samples.x as usize + 7, samples.y as usize + 7] }
    }

    fn places(&self) -> impl Iterator<Item = Vec2> + '_ {
        let place = |i: usize| Vec2::new((i % self.size[0]) as f32, (i / self.size[0]) as f32);
        (0..self.size[0] * self.size[1]).map(move |i| self.origin + self.pixel * place(i))
    }
}

/// Signed distance to the polygons' edges, below 0 inside.
fn distance(contours: &[Vec<Vec2>], at: Vec2) -> f32 {
    let (mut nearest, mut inside) = (f32::INFINITY, false);
    for contour in contours {
        let mut from = contour.last().copied().unwrap_or(at);
        for &to in contour {
            let along = to - from;
            let t = ((at - from).dot(along) / along.length_squared().max(1e-20)).clamp(0.0, 1.0);
            nearest = nearest.min(at.distance(from + along * t));
            if (from.y > at.y) != (to.y > at.y) && at.x < from.x + (at.y - from.y) / along.y * along.x {
                inside = !inside;
            }
            from = to;
        }
    }
    if inside { -nearest } else { nearest }
}

fn corners(contour: &[Vec2]) -> impl Iterator<Item = Vec2> + '_ {
    let count = contour.len();
    let at = move |i: usize| contour[i % count];
    let is_sharp = move |i: &usize| (at(i + 1) - at(*i)).angle_to(at(i + 2) - at(i + 1)).abs() > CORNER;
    (0..count).filter(is_sharp).map(move |i| at(i + 1))
}

fn nearest_pressure(drawing: &Drawing, at: Vec2) -> f32 {
    let points = drawing.strokes.iter().flat_map(|stroke| &stroke.points);
    let weighed = points.map(|p| (1.0 / (0.1 + p.at.distance_squared(at)), p.pressure));
    let (weights, sum) = weighed.fold((0.0, 0.0), |(w, s), (weight, p)| (w + weight, s + weight * p));
    if weights > 0.0 { sum / weights } else { 1.0 }
}

/// A stroke through these points.
pub fn stroke(points: impl IntoIterator<Item = Vec2>) -> DrawnStroke {
    let point = |at| DrawnPoint { at, pressure: 1.0, smoothing: 0.0 };
    DrawnStroke { points: points.into_iter().map(point).collect() }
}

/// A star-shaped outline, now and then with a hole, or drawn with pressure.
pub(super) fn drawing(rng: &mut Rng) -> Drawing {
    let center = Vec2::new(rng.f32() - 0.5, rng.f32() - 0.5) * 20.0;
    let (count, size, round) = (rng.usize(4..24), 6.0 + 24.0 * rng.f32(), rng.f32());
    let radii: Vec<f32> =
        (0..count).map(|_| size * (round + (1.0 - round) * (0.4 + 0.6 * rng.f32()))).collect();
    let ring = |share: f32| {
        let at = |(i, r): (usize, &f32)| center + share * r * Vec2::from_angle(TAU * i as f32 / count as f32);
        stroke(radii.iter().enumerate().map(at))
    };
    let mut strokes = vec![ring(1.0)];
    if rng.u32(..4) == 0 {
        strokes.push(ring(0.4));
    }
    if rng.u32(..3) == 0 {
        strokes.iter_mut().flat_map(|stroke| &mut stroke.points).for_each(|p| p.pressure = rng.f32());
    }
    Drawing { strokes, ..Drawing::default() }
}
