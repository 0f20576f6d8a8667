//! Pictures of a field in a plane: the view of whoever wants to see why a blend bulges, or what a template looks like.

use crate::field::{Aabb, Field, ISO, Sample};
use crate::sketched::SketchPlane;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Pixels along each side of the tiles for which a field is specialised.
const TILE: usize = 16;

/// Between the lines of equal value; every half is on the surface.
const STEP: f32 = 0.1;

/// How wide lines are, pixels: those of equal value, and the surface.
const LINE: f32 = 1.1;
const SURFACE: f32 = 2.6;

/// Where a value changes less than this from a pixel to the next, there is no thin line: it would be a blot.
const FLAT: f32 = 0.002;

/// The colours of nothing, of the solid's middle, and of lines, sRGB.
const NOTHING: [f32; 3] = [251.0, 250.0, 246.0];
const FULL: [f32; 3] = [47.0, 125.0, 225.0];
const INK: [f32; 3] = [27.0, 27.0, 31.0];

/// Which part of a plane a picture shows, and how finely.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// The plane.
    pub plane: SketchPlane,
    /// The lower left corner of the picture in the plane, mm.
    pub low: Vec2,
    /// The side of a pixel, mm.
    pub pixel: f32,
    /// Width and height, pixels.
    pub size: [usize; 2],
}

impl FieldPicture {
    /// The part of a plane that sees all of `region`, with so many pixels along its longer side; `None` for an empty or
    /// infinite one.
    pub fn framing(region: &Aabb, plane: &SketchPlane, pixels: usize) -> Option<Self> {
        let corners = region.corners().map(|corner| plane.project(corner).0);
        let (low, high) = corners.iter().fold((corners[0], corners[0]), |(l, h), &p| (l.min(p), h.max(p)));
        let pixel = (high - low).max_element() / pixels as f32;
        if region.is_empty() || !pixel.is_finite() || pixel <= 0.0 {
            return None;
        }
        let count = |length: f32| ((length / pixel).ceil().max(1.0) as usize).min(pixels + 1);
        let size = [count(high.x - low.x), count(high.y - low.y)];
        Some(Self { plane: *plane, low, pixel, size })
    }

    /// Its corners in space, mm: lower left, lower right, upper right, upper left.
    pub fn corners(&self) -> [Vec3; 4] {
        let [width, height] = self.size.map(|n| n as f32 * self.pixel);
        let offsets = [Vec2::ZERO, Vec2::new(width, 0.0), Vec2::new(width, height), Vec2::new(0.0, height)];
        offsets.map(|offset| self.plane.point(self.low + offset))
    }

    /// The picture, rows from the top, three bytes a pixel (sRGB): white where the field is 0, blue where it is 1, with
    /// a thin line at every tenth and a bold one on the surface.
    ///
    /// Cost: one evaluation with gradient a pixel, of what reaches the pixel's tile. Runs on the current rayon pool.
    pub fn paint(&self, field: &dyn Field) -> Vec<u8> {
        let [width, height] = self.size;
        let mut pixels = vec![0; 3 * width * height];
        pixels.par_chunks_mut(3 * width * TILE).enumerate().for_each(|(strip, pixels)| {
            let mut sampler = field.sampler();
            let rows = pixels.len() / (3 * width);
            let (mut places, mut samples) = (Vec::new(), Vec::new());
            for left in (0..width).step_by(TILE) {
                let columns = TILE.min(width - left);
                places.clear();
                for row in 0..rows {
                    places.extend((0..columns).map(|column| self.place(left + column, strip * TILE + row)));
                }
                samples.clear();
                samples.resize(places.len(), Sample::default());
                sampler.enter(Aabb::of_points(places.iter().copied()));
                sampler.samples(&places, &mut samples);
                sampler.leave();
                for (row, samples) in samples.chunks_exact(columns).enumerate() {
                    let first = 3 * (row * width + left);
                    let row = pixels[first..first + 3 * columns].chunks_exact_mut(3);
                    for (pixel, sample) in row.zip(samples) {
                        pixel.copy_from_slice(&color(sample.value, sample.gradient.length() * self.pixel));
                    }
                }
            }
        });
        pixels
    }

    /// The middle of a pixel, mm.
    fn place(&self, column: usize, row: usize) -> Vec3 {
        let up = (self.size[1] - row) as f32 - 0.5;
        self.plane.point(self.low + self.pixel * Vec2::new(column as f32 + 0.5, up))
    }
}

/// The colour of a value that changes by `slope` from a pixel to the next.
fn color(value: f32, slope: f32) -> [u8; 3] {
    let nearest = (value / STEP).round() * STEP;
    let off = |level: f32| (value - level).abs() / slope.max(1e-6);
    let cover = |level: f32, wide: f32| (0.5 * wide + 0.5 - off(level)).clamp(0.0, 1.0);
    let line = if nearest > 0.5 * STEP && slope > FLAT { 0.35 * cover(nearest, LINE) } else { 0.0 };
    let ink = line.max(cover(ISO, SURFACE));
    let share = value.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let paper = NOTHING[i] + (FULL[i] - NOTHING[i]) * share;
        (paper + (INK[i] - paper) * ink).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tree;
    use crate::build::point;

    #[test]
    fn a_ball_is_a_dark_ring_of_its_radius_around_blue() {
        let radius = 10.0;
        let tree = Tree::new(&point([0.0; 3], radius));
        let framed = FieldPicture::framing(&tree.support(), &SketchPlane::default(), 301).expect("a ball");
        let [width, height] = framed.size;
        assert_eq!((width, height), (301, 301));
        let pixels = framed.paint(&tree);
        let at = |x: f32, z: f32| {
            let cell = (Vec2::new(x, z) - framed.low) / framed.pixel;
            let (column, row) = (cell.x as usize, height - 1 - cell.y as usize);
            let first = 3 * (row * width + column);
            [pixels[first], pixels[first + 1], pixels[first + 2]]
        };
        assert_eq!(at(0.0, 0.0), FULL.map(|c| c as u8));
        for angle in [0.0_f32, 1.0, 2.5, 4.0] {
            let [x, z] = [radius * angle.cos(), radius * angle.sin()];
            assert!(at(x, z).iter().all(|c| *c < 60), "no line at {x}, {z}: {:?}", at(x, z));
            assert!(at(0.9 * x, 0.9 * z)[0] > 60, "{:?}", at(0.9 * x, 0.9 * z));
        }
        let corner = tree.support().max * 0.99;
        assert_eq!(at(corner.x, corner.z), NOTHING.map(|c| c as u8));
    }

    #[test]
    fn nothing_has_no_picture() {
        let plane = SketchPlane::default();
        assert_eq!(FieldPicture::framing(&Aabb::EMPTY, &plane, 100), None);
        let endless = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        assert_eq!(FieldPicture::framing(&endless, &plane, 100), None);
    }
}
