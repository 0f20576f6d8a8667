//! The template field of a curve: a smoothed signed distance as an image.
//!
//! [`solve`] fits a thin-plate spline to the signed distance of a curve, on the curve itself, on contours of the
//! distance and on its skeleton, and samples it once. The kinks of the true distance, which would show as creases
//! where a swept solid blends with others, are gone, but for those at the corners of the curve, which are kept.

mod blend;
mod bulge;
mod constraints;
mod contours;
mod exact;
mod levels;
mod outline;
mod pressure;
mod samples;

use crate::curve::Curve;
use crate::thin_plate::{FitError, Grid};
use blobtree::{FieldImage, ParameterError, Template};
use constraints::Subject;
use exact::Exact;
use glam::{DVec2, Vec2};
use levels::Levels;
use outline::Outline;
use samples::Samples;

/// How a template is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Samples along the longer side of a drawing with ordinary detail, 16 to 2,048. Without any detail a quarter
    /// suffices; fine detail gets up to half as many again.
    pub pixels: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { pixels: 512 }
    }
}

/// Why a curve has no template.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoTemplate {
    /// No contour with an inside.
    #[error("the curve encloses nothing; draw a closed outline with some room in it")]
    Empty,
    /// A coordinate that is not finite, or beyond ±1e9 mm.
    #[error("contour {contour} has a point that is not finite or too far away; keep within ±1e9 mm")]
    BadPoint {
        /// Which contour, counted from 0.
        contour: usize,
    },
    /// More points than can be handled.
    #[error("the curve has {found} points, more than {most}; thin them out")]
    TooManyPoints {
        /// Points of all contours.
        found: usize,
        /// What is allowed.
        most: usize,
    },
    /// More contours and corners than can be handled.
    #[error("the curve has {found} contours and corners, more than {most}; draw fewer at a time")]
    TooManyParts {
        /// Contours and corners together.
        found: usize,
        /// What is allowed.
        most: usize,
    },
    /// A falloff that is not a length above 0, or is so wide that the image cannot show the drawing.
    #[error("the falloff is {falloff} mm; for a drawing of this size it must be above 0 and up to {most} mm")]
    Falloff {
        /// As asked for, mm.
        falloff: f32,
        /// The widest, mm.
        most: f32,
    },
    /// The image cannot be stored: the drawing is too small or too far away for its numbers.
    #[error("the field cannot be stored as an image: {0}")]
    Image(#[from] ParameterError),
    /// The spline has no solution.
    #[error("the distance to the curve cannot be fitted: {0}")]
    Fit(#[from] FitError),
}

/// Most points of a curve, and most contours and corners.
const MOST_POINTS: usize = 20_000;
const MOST_PARTS: usize = 1000;

/// Widest falloff, as a multiple of the drawing's size: the drawing still spans 32 pixels.
const WIDEST_FALLOFF: f64 = 18.0;

/// Most samples of an image.
const MOST_SAMPLES: f64 = 8e5;

/// Samples of the images in which contours are traced and the depth is sought, along the curve's longer side.
const COARSE: f64 = 64.0;

/// Solves the template of a curve with the default [`Options`]; see [`solve_with`].
pub fn solve(curve: &Curve, falloff: Option<f32>, pressure: &[(DVec2, f32)]) -> Result<Template, NoTemplate> {
    solve_with(curve, falloff, pressure, &Options::default())
}

/// Solves the template of a curve.
///
/// - **In:** the curve in mm; the width of the falloff in mm, or none for 1.2017 times the depth, with which the
///   field reaches 1 at the deepest place; how hard the pen pressed, by place in mm.
/// - **Promises:** the zero contour of the image lies within 0.3 % of the drawing's size, and a pixel, of the
///   curve; beyond the falloff, the distance is nowhere below it; everywhere it is within 40 % of the true one,
///   0.15 % of the drawing's size, and a pixel. Any number of threads gives the same bytes.
/// - **Cost:** O(points · pixels) at worst; about 0.05 s for an ordinary shape.
/// - **Source:** Schmidt & Wyvill 2011, §11.3.3. **Departs:** corners are kept by ridges beside the spline; the
///   spline also keeps to the skeleton and is corrected where it is off; the image is as fine as the drawing.
pub fn solve_with(
    curve: &Curve,
    falloff: Option<f32>,
    pressure: &[(DVec2, f32)],
    options: &Options,
) -> Result<Template, NoTemplate> {
    check(curve)?;
    let curve = &usable(curve)?;
    let points = || curve.contours.iter().flat_map(|contour| &contour.points).copied();
    let (low, high) = (points().fold(DVec2::MAX, DVec2::min), points().fold(DVec2::MIN, DVec2::max));
    let size = (high - low).max_element();
    let most = (WIDEST_FALLOFF * size) as f32;
    if let Some(falloff) = falloff.filter(|falloff| !(*falloff > 0.0 && *falloff <= most)) {
        return Err(NoTemplate::Falloff { falloff, most });
    }
    let outline = Outline::new(curve);
    let samples = Samples::new(curve, size);
    let depth = deepest(&outline, &samples, low, high);
    if depth.partial_cmp(&(1e-6 * size)) != Some(std::cmp::Ordering::Greater) {
        return Err(NoTemplate::Empty);
    }
    let levels = Levels::new(depth, falloff.map(f64::from));
    let grid = covering(low, high, levels.falloff, pixel(&samples, low, high, levels.falloff, options));
    let exact = &Exact::new(&outline, grid, levels.falloff);
    let fitted = Subject { outline: &outline, samples: &samples, levels: &levels, size, exact }.fit()?;
    let distance = image(&grid, blend::samples(&fitted, exact, &levels, size))?;
    let pressure =
        pressure::image(pressure, &grid).map(|(grid, samples)| image(&grid, samples)).transpose()?;
    let contours = curve.contours.iter().map(|c| c.points.iter().map(|p| p.as_vec2()).collect::<Vec<Vec2>>());
    Ok(Template {
        bulge: bulge::bulge(&distance, &exact.samples, depth as f32, levels.falloff as f32)?,
        distance,
        pressure,
        falloff: levels.falloff as f32,
        depth: depth as f32,
        contours: contours.collect(),
        corners: samples.corners.iter().map(|corner| corner.at.as_vec2()).collect(),
    })
}

fn image(grid: &Grid, samples: Vec<f32>) -> Result<FieldImage, ParameterError> {
    FieldImage::new(grid.origin.as_vec2(), grid.pixel as f32, grid.size, samples)
}

fn check(curve: &Curve) -> Result<(), NoTemplate> {
    let found = curve.contours.iter().map(|contour| contour.points.len()).sum();
    if found > MOST_POINTS {
        return Err(NoTemplate::TooManyPoints { found, most: MOST_POINTS });
    }
    let good = |p: &DVec2| p.is_finite() && p.abs().max_element() <= 1e9;
    if let Some(contour) = curve.contours.iter().position(|c| !c.points.iter().all(good)) {
        return Err(NoTemplate::BadPoint { contour });
    }
    let found = curve.contours.iter().map(|contour| 1 + contour.corners.len()).sum();
    if found > MOST_PARTS {
        return Err(NoTemplate::TooManyParts { found, most: MOST_PARTS });
    }
    Ok(())
}

/// The contours with an extent, without repeated points; corners told anew.
fn usable(curve: &Curve) -> Result<Curve, NoTemplate> {
    let mut contours = Vec::new();
    for contour in &curve.contours {
        let mut kept = crate::curve::Contour::default();
        for (i, &p) in contour.points.iter().enumerate() {
            if kept.points.last() != Some(&p) {
                kept.points.push(p);
            }
            if contour.corners.binary_search(&i).is_ok()
                && kept.corners.last() != Some(&(kept.points.len() - 1))
            {
                kept.corners.push(kept.points.len() - 1);
            }
        }
        while kept.points.len() > 1 && kept.points.last() == kept.points.first() {
            kept.points.pop();
        }
        kept.corners.retain(|&i| i < kept.points.len());
        if kept.points.len() >= 3 {
            contours.push(kept);
        }
    }
    if contours.is_empty() { Err(NoTemplate::Empty) } else { Ok(Curve { contours, ..Curve::default() }) }
}

/// The grid of this pixel over a box and `beyond` on all sides, and two pixels more.
fn covering(low: DVec2, high: DVec2, beyond: f64, pixel: f64) -> Grid {
    // As the image holds them.
    let pixel = f64::from(pixel as f32);
    let origin = (low - beyond - 2.5 * pixel).as_vec2().as_dvec2();
    let count = ((high + beyond + 2.5 * pixel - origin) / pixel).ceil();
    Grid { origin, pixel, size: [count.x as usize + 1, count.y as usize + 1] }
}

/// The pixel that the drawing's detail asks for: a third of the room beside all but the tightest twentieth of
/// the curve, and a sixteenth of the falloff, within what the options allow.
fn pixel(samples: &Samples, low: DVec2, high: DVec2, falloff: f64, options: &Options) -> f64 {
    let size = (high - low).max_element();
    let usual = options.pixels.clamp(16, 2048) as f64;
    let mut rooms: Vec<f64> = samples.samples.iter().map(|s| s.room[0].min(s.room[1])).collect();
    rooms.sort_unstable_by(f64::total_cmp);
    let tight = rooms.get(rooms.len() / 20).copied().unwrap_or(size);
    let least = if samples.corners.is_empty() { 0.25 } else { 0.5 };
    let for_detail = (3.0 * size / tight).clamp(least * usual, 1.5 * usual);
    // With fewer than 16 pixels across the falloff, the margin at its end would show in the gradient.
    let for_falloff = (16.0 * size / falloff).min(usual);
    let wanted = size / for_detail.max(for_falloff);
    // Between ordinary and fine only what is left of the most samples.
    let extent = high - low + 2.0 * falloff;
    wanted.max((extent.element_product() / MOST_SAMPLES).sqrt()).max(extent.max_element() / 4096.0)
}

/// The largest distance inside.
fn deepest(outline: &Outline, samples: &Samples, low: DVec2, high: DVec2) -> f64 {
    let grid = covering(low, high, 0.0, (high - low).max_element() / COARSE);
    let centre = |s: &samples::Sample| s.normal.map(|normal| s.at - s.room[0] * normal);
    Exact::new(outline, grid, 0.0).deepest(outline, samples.samples.iter().filter_map(centre))
}

#[cfg(test)]
mod tests;
