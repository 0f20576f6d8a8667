//! Exact slices of a mesh: for every layer, the regions of the plane that are solid in the layer's middle.
//!
//! Reach for [`Slices::new`] when something is asked of layers: whether they hold each other up, how large they
//! are, what they look like. It takes any mesh. A place is solid where the mesh winds around it a positive number
//! of times, so bodies that overlap count once and inner voids are empty; a mesh that faces inward as a whole is
//! turned round. Outlines that do not close are left out and told.
//!
//! Polygons live on a fixed-point grid of about a nanometre, the same for all layers of a part, so that what
//! coincides in the mesh coincides exactly in the slices. Not done here: repairing, infill, tool paths.

mod chain;
pub(crate) mod clip;
mod cut;
mod error;
pub(crate) mod grid;
pub(crate) mod outline;
mod planes;
pub(crate) mod rect;
mod watch;

pub use error::{MOST_CROSSINGS, MOST_LAYERS, SliceError, WIDEST_MM};
pub use planes::{Bottom, Planes};
pub(crate) use watch::Tally;
pub use watch::Watch;

use crate::LayerHeight;
use chain::{Loops, chain};
use clip::{Clipper, Region};
use cut::{CHUNK, Cutter};
use glam::DVec2;
use grid::{Grid, Point};
use mesh::Mesh;
use rayon::prelude::*;

/// A part cut into layers.
#[derive(Clone, Debug)]
pub struct Slices {
    /// Where it was cut.
    pub planes: Planes,
    /// From the bottom up, one for each plane.
    pub layers: Vec<Layer>,
    pub(crate) grid: Grid,
}

/// One layer, as it is in the middle of its height.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    pub(crate) regions: Vec<Region>,
    /// Where outlines begin that do not close, mm.
    pub open: Vec<DVec2>,
}

impl Slices {
    /// Slices a mesh.
    ///
    /// - **Promises:** every place is right to 2⁻²⁰ mm for parts up to 512 mm wide; the same slices for any number
    ///   of threads. A vertex on a plane counts as above it.
    /// - **Errors:** [`SliceError`]: nothing to slice, coordinates that are not finite, or more than memory is set
    ///   aside for.
    /// - **Cost:** O(n + c log c) for c crossings of triangles and planes, besides the filling of crossing outlines.
    pub fn new(mesh: &Mesh, height: LayerHeight, bottom: Bottom, watch: &Watch) -> Result<Self, SliceError> {
        check(mesh)?;
        let bounds = mesh.bounds();
        let planes = Planes::new(&bounds, height, bottom)?;
        let grid = Grid::over(&bounds)?;
        let layers = cut(mesh, &planes.heights, grid, watch, filled(&grid))?;
        Ok(Self { planes, layers, grid })
    }

    /// The regions of a layer, as rings of places in mm: each region's outline counter-clockwise, then its holes
    /// clockwise. Nothing for a layer that does not exist.
    pub fn regions(&self, layer: usize) -> impl Iterator<Item = Vec<Vec<DVec2>>> + '_ {
        let regions = self.layers.get(layer).into_iter().flat_map(|layer| &layer.regions);
        regions.map(|region| {
            region.iter().map(|ring| ring.iter().map(|&p| self.grid.place(p)).collect()).collect()
        })
    }

    /// Area of a layer, mm².
    pub fn area(&self, layer: usize) -> f64 {
        self.grid.square_mm(self.layers.get(layer).map_or(0.0, |layer| clip::total(&layer.regions)))
    }

    /// Volume of all layers, mm³.
    pub fn volume(&self) -> f64 {
        (0..self.layers.len()).map(|layer| self.area(layer)).sum::<f64>() * self.planes.layer_height
    }
}

impl Layer {
    /// How many connected regions it has.
    pub fn region_count(&self) -> usize {
        self.regions.len()
    }
}

/// The regions of a mesh at one height, with their grid.
///
/// Errors: as [`Slices::new`].
pub(crate) fn slice_at(mesh: &Mesh, height: f64) -> Result<(Grid, Layer), SliceError> {
    check(mesh)?;
    let grid = Grid::over(&mesh.bounds())?;
    let mut layers = cut(mesh, &[height], grid, &Watch::default(), filled(&grid))?;
    Ok((grid, layers.pop().unwrap_or_default()))
}

fn check(mesh: &Mesh) -> Result<(), SliceError> {
    let corners = mesh.triangles.iter().map(|&t| mesh.corners(t));
    let broken = corners.clone().position(|c| c.is_some_and(|c| !c.iter().all(|p| p.is_finite())));
    match broken {
        Some(triangle) => Err(SliceError::NotFinite { triangle }),
        None if corners.flatten().next().is_none() => Err(SliceError::Empty),
        None => Ok(()),
    }
}

/// Cuts a mesh at these heights; `finish` makes of a plane's loops, with the solid on their left, what is kept of them.
fn cut<T: Send>(
    mesh: &Mesh,
    planes: &[f64],
    grid: Grid,
    watch: &Watch,
    finish: impl Fn(&mut Clipper, Loops) -> T + Sync,
) -> Result<Vec<T>, SliceError> {
    let cutter = Cutter::new(mesh, planes, grid)?;
    let inward = mesh.volume() < 0.0;
    let tally = Tally::new(watch, cutter.chunks());
    let chunk = |clipper: &mut Clipper, chunk: usize| {
        if watch.is_cancelled() {
            return Err(SliceError::Cancelled);
        }
        let mut layer = |crossings: &Vec<cut::Crossing>| {
            let mut loops = chain(crossings);
            if inward {
                loops.closed.iter_mut().for_each(|points| points.reverse());
            }
            finish(clipper, loops)
        };
        let layers: Vec<T> = cutter.cut(chunk).iter().map(&mut layer).collect();
        tally.step();
        Ok(layers)
    };
    let chunks: Result<Vec<Vec<T>>, _> =
        (0..cutter.chunks()).into_par_iter().map_init(Clipper::new, chunk).collect();
    let mut layers = Vec::with_capacity(cutter.chunks() * CHUNK);
    layers.extend(chunks?.into_iter().flatten());
    Ok(layers)
}

/// Fills the loops of a plane.
fn filled(grid: &Grid) -> impl Fn(&mut Clipper, Loops) -> Layer {
    |clipper, loops| {
        let open = loops.open.iter().map(|&p: &Point| grid.place(p)).collect();
        Layer { regions: clipper.fill(&loops.closed), open }
    }
}

#[cfg(test)]
mod tests;
