//! Pictures of a field in a plane: what a template looks like before it becomes a solid.

use crate::failure::Failure;
use crate::render;
use blobtree::{Field, ISO, SketchPlane, Tree};
use glam::Vec2;
use rayon::prelude::*;
use std::path::Path;

/// The longer side of a picture, pixels.
const SIDE: f32 = 800.0;
/// Between the lines of equal value; every half is on the surface.
const STEP: f32 = 0.1;
/// How wide lines are, pixels: those of equal value, and the surface.
const LINE: f32 = 1.1;
const SURFACE: f32 = 2.6;
/// Nothing, the solid's middle, lines, and the surface.
const NOTHING: [f32; 3] = [251.0, 250.0, 246.0];
const FULL: [f32; 3] = [47.0, 125.0, 225.0];
const INK: [f32; 3] = [27.0, 27.0, 31.0];

/// A PNG file of the field of `tree` in `plane`, on all of its support there: white where it is 0, blue where it is
/// 1, with a line at every tenth, a bold one on the surface.
///
/// Errors: a field that is nowhere above 0.
pub fn png(path: &Path, tree: &Tree, plane: &SketchPlane) -> Result<Vec<u8>, Failure> {
    let support = tree.support();
    if support.is_empty() {
        return Err(Failure::of(path, "the field is 0 everywhere, so there is nothing to show"));
    }
    let corners = support.corners().map(|corner| plane.project(corner).0);
    let (low, high) = corners.iter().fold((corners[0], corners[0]), |(l, h), &p| (l.min(p), h.max(p)));
    let pixel = (high - low).max_element() / SIDE;
    let [width, height] =
        [(high.x - low.x) / pixel, (high.y - low.y) / pixel].map(|n| n.ceil().max(1.0) as usize);
    let mut pixels = vec![0; 3 * width * height];
    pixels.par_chunks_exact_mut(3 * width).enumerate().for_each(|(row, pixels)| {
        let y = high.y - (row as f32 + 0.5) * pixel;
        let places: Vec<_> =
            (0..width).map(|x| plane.point(Vec2::new(low.x + (x as f32 + 0.5) * pixel, y))).collect();
        let mut samples = vec![Default::default(); width];
        let mut sampler = tree.sampler();
        sampler.enter(support);
        sampler.samples(&places, &mut samples);
        for (pixels, sample) in pixels.chunks_exact_mut(3).zip(&samples) {
            pixels.copy_from_slice(&color(sample.value, sample.gradient.length() * pixel));
        }
    });
    render::png(&pixels, [width as u32, height as u32]).map_err(|e| Failure::of(path, e))
}

/// The colour of a value that changes by `slope` from a pixel to the next.
fn color(value: f32, slope: f32) -> [u8; 3] {
    let nearest = (value / STEP).round() * STEP;
    let off = |level: f32| (value - level).abs() / slope.max(1e-6);
    let cover = |level: f32, wide: f32| (0.5 * wide + 0.5 - off(level)).clamp(0.0, 1.0);
    let line = if nearest > 0.5 * STEP { 0.35 * cover(nearest, LINE) } else { 0.0 };
    let ink = line.max(cover(ISO, SURFACE));
    let share = value.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let paper = NOTHING[i] + (FULL[i] - NOTHING[i]) * share;
        (paper + (INK[i] - paper) * ink).round() as u8
    })
}
