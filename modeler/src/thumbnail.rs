//! Small pictures of solids, drawn by the processor: of what a sketch might become, and of files.

use blobtree::{BakeStore, NodeRef, Palette, Tree, solid_box};
use egui::{Color32, ColorImage};
use glam::{Vec2, Vec3};
use polygonizer::{Cancel, CellSize, Options, Surface};
use sketch::suggest::View;

/// Cells along the longest side: enough for a picture of some fifty pixels.
const CELLS: f32 = 30.0;

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

/// How much of the picture stays free around the solid, as a share of it.
const MARGIN: f32 = 0.06;

/// The solid of a tree as it is seen in `view`, as large as it fits into a picture of this size, pixels; what is
/// beside it is transparent.
///
/// `None` if there is nothing to see, or if it was cancelled. **Cost:** that of a surface of 30 cells.
pub fn picture(root: &NodeRef, view: &View, size: [usize; 2], cancel: &Cancel) -> Option<ColorImage> {
    let tree = Tree::new(root);
    let longest = solid_box(&tree).size().max_element();
    if !(longest.is_finite() && longest > 0.0) {
        return None;
    }
    let cell = CellSize::from_mm((longest / CELLS).max(1e-3)).ok()?;
    let options = Options { cancel: Some(cancel), ..Options::default() };
    let surface = Surface::build(&tree, cell, &options).ok()?;
    let (mesh, normals) = (surface.mesh(), surface.normals());
    let colors = Palette::new(root, &BakeStore::new()).painter().colors(&mesh.positions);
    let key = (-view.forward + 0.9 * view.up - 0.6 * view.right()).normalize_or(Vec3::Z);
    let corners: Vec<Corner> = (0..mesh.positions.len())
        .map(|i| {
            let light = 0.62 * normals[i].dot(key).max(0.0) + 0.30 + 0.10 * normals[i].z;
            Corner {
                at: view.screen_from_model(mesh.positions[i]).unwrap_or(Vec2::NAN),
                depth: view.depth(mesh.positions[i]),
                color: Vec3::from_array(colors[i].map(|c| (f32::from(c) / 255.0).powf(2.2))) * light,
            }
        })
        .collect();
    let mut canvas = Canvas::new(size, &corners)?;
    for triangle in &mesh.triangles {
        canvas.fill(triangle.map(|i| &corners[i as usize]));
    }
    Some(canvas.image())
}

/// A corner of a triangle on the way to the picture.
struct Corner {
    /// Pixels of the view.
    at: Vec2,
    /// Before the eye, mm.
    depth: f32,
    /// Lit, linear.
    color: Vec3,
}

struct Canvas {
    size: [usize; 2],
    /// From the view to samples.
    scale: f32,
    offset: Vec2,
    depth: Vec<f32>,
    color: Vec<Vec3>,
}

impl Canvas {
    /// One into which all corners fit; `None` without corners before the eye.
    fn new(size: [usize; 2], corners: &[Corner]) -> Option<Self> {
        let size = size.map(|pixels| pixels * SAMPLES);
        let seen = || corners.iter().map(|corner| corner.at).filter(|at| at.is_finite());
        let lo = seen().fold(Vec2::INFINITY, Vec2::min);
        let hi = seen().fold(Vec2::NEG_INFINITY, Vec2::max);
        let whole = Vec2::new(size[0] as f32, size[1] as f32);
        let scale = ((1.0 - 2.0 * MARGIN) * whole / (hi - lo)).min_element();
        let count = size[0] * size[1];
        (scale.is_finite() && scale > 0.0).then(|| Self {
            size,
            scale,
            offset: 0.5 * whole - 0.5 * (lo + hi) * scale,
            depth: vec![f32::INFINITY; count],
            color: vec![Vec3::ZERO; count],
        })
    }

    fn fill(&mut self, triangle: [&Corner; 3]) {
        let [a, b, c] = triangle.map(|corner| corner.at * self.scale + self.offset);
        let area = (b - a).perp_dot(c - a);
        // Seen from its edge, or behind the eye.
        if area.is_nan() || area.abs() <= 1e-6 {
            return;
        }
        let lo = a.min(b).min(c).floor().max(Vec2::ZERO);
        let hi = a.max(b).max(c).ceil().min(Vec2::new(self.size[0] as f32, self.size[1] as f32));
        for y in lo.y as usize..hi.y as usize {
            for x in lo.x as usize..hi.x as usize {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let shares = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)]
                    .map(|part| part / area);
                if shares.iter().any(|share| *share < 0.0) {
                    continue;
                }
                let mean =
                    |f: fn(&Corner) -> f32| -> f32 { (0..3).map(|i| shares[i] * f(triangle[i])).sum() };
                let depth = mean(|corner| corner.depth);
                let at = y * self.size[0] + x;
                if depth < self.depth[at] {
                    self.depth[at] = depth;
                    self.color[at] = (0..3).map(|i| shares[i] * triangle[i].color).sum();
                }
            }
        }
    }

    fn image(&self) -> ColorImage {
        let [width, height] = self.size.map(|samples| samples / SAMPLES);
        let pixel = |x: usize, y: usize| {
            let samples = (0..SAMPLES * SAMPLES)
                .map(|i| (SAMPLES * y + i / SAMPLES) * self.size[0] + SAMPLES * x + i % SAMPLES);
            let (mut color, mut covered) = (Vec3::ZERO, 0.0);
            for at in samples.filter(|at| self.depth[*at].is_finite()) {
                color += self.color[at];
                covered += 1.0;
            }
            let [r, g, b] = (color / f32::max(covered, 1.0))
                .to_array()
                .map(|c| (255.0 * c.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8);
            let share = 255.0 * covered / (SAMPLES * SAMPLES) as f32;
            Color32::from_rgba_unmultiplied(r, g, b, share.round() as u8)
        };
        let pixels = (0..width * height).map(|at| pixel(at % width, at / width)).collect();
        ColorImage::new([width, height], pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Side};
    use blobtree::build::{Build as _, point, union};

    #[test]
    fn a_ball_is_a_disc_that_fills_the_picture_and_is_lit_from_above() {
        let root: NodeRef = union([point([0., 0., 10.], 10.)]).into();
        let mut camera = Camera::default();
        camera.look_from(Side::Front);
        let view = camera.view(Vec2::new(400.0, 300.0));
        let picture = picture(&root, &view, [60, 40], &Cancel::new()).expect("a ball");
        let covered: f32 = picture.pixels.iter().map(|pixel| f32::from(pixel.a()) / 255.0).sum();
        let radius = 0.5 * (1.0 - 2.0 * MARGIN) * 40.0;
        let disc = std::f32::consts::PI * radius * radius;
        assert!((covered / disc - 1.0).abs() < 0.03, "{covered} of {disc}");
        let at = |x: usize, y: usize| u32::from(picture.pixels[y * 60 + x].g());
        assert!(at(30, 8) > at(30, 32) + 30, "{} above, {} below", at(30, 8), at(30, 32));
    }

    #[test]
    fn what_is_before_hides_what_is_behind() {
        let front = point([0., -10., 10.], 5.).colored("#ff0000");
        let root: NodeRef = union([front, point([0., 10., 10.], 5.).colored("#0000ff")]).into();
        let mut camera = Camera::default();
        camera.look_from(Side::Front);
        let picture =
            picture(&root, &camera.view(Vec2::splat(300.0)), [40, 40], &Cancel::new()).expect("balls");
        let [r, _, b, _] = picture.pixels[20 * 40 + 20].to_array();
        assert!(r > 2 * b, "red {r}, blue {b}");
    }

    #[test]
    fn there_is_no_picture_of_nothing() {
        let root = crate::workbench::Workbench::empty_page().root;
        let view = Camera::default().view(Vec2::splat(300.0));
        assert!(picture(&root, &view, [40, 40], &Cancel::new()).is_none());
    }
}
