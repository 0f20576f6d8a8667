//! What lines enclose, however they cross: the silhouette of the painted and filled drawing.

use super::chains::Chain;
use super::holders::Holders;
use super::line::Sample;
use super::polygon;
use super::raster::Raster;
use glam::DVec2;

/// Cells along the longer side of the painted lines.
const CELLS: usize = 256;
/// Half widths of the pens that are tried, in extents: gaps of twice that are closed.
pub(super) const PENS: [f64; 4] = [0.006, 0.012, 0.025, 0.04];
/// Pens for lines that enclose nothing otherwise.
pub(super) const WIDE_PENS: [f64; 3] = [0.06, 0.08, 0.11];
/// A pen will do if the rooms it encloses are this share of those of the widest one: at 0.6 the trunk of a tree is
/// lost to a small leak, at 1 a wide pen fills the bays between fingers.
const ENOUGH: f64 = 0.75;
/// Necks narrower than twice this part, in extents: lobes that only touch where a line crosses itself.
const NECK: f64 = 0.01;
/// Pieces below this share of the largest are slivers between lines drawn twice.
const SLIVER: f64 = 0.015;
/// Least area that is an outline, over the square of the extent.
const LEAST_AREA: f64 = 0.004;

/// The outline of what lines enclose.
pub(super) struct Silhouette {
    pub samples: Vec<Sample>,
    /// The same evenly, without the lines' own samples: rougher, but where lines were drawn twice less entangled.
    pub plain: Vec<Sample>,
    /// The same with necks as wide as they were filled, if both their sides lie along one line.
    pub wide: Vec<Sample>,
    /// The same as it was filled, without a crossing.
    pub filled: Vec<Sample>,
    /// The strokes that it runs along.
    pub strokes: Vec<usize>,
}

/// The outlines of what the chains and bridges enclose together.
///
/// The narrowest pen that encloses most of what a wide one does is taken. **Cost:** as the cells, a few ms.
pub(super) fn silhouettes(chains: &[&Chain], bridges: &[[DVec2; 2]], pens: &[f64]) -> Vec<Silhouette> {
    let paths: Vec<Vec<DVec2>> =
        chains.iter().map(|chain| chain.path()).chain(bridges.iter().map(|b| b.to_vec())).collect();
    let all: Vec<DVec2> = paths.concat();
    let (least, most) = polygon::bounds(&all);
    let extent = (most - least).max_element();
    if extent.is_nan() || extent <= 0. {
        return Vec::new();
    }
    let widest = pens.iter().copied().fold(0., f64::max);
    let raster = Raster::over(least, most, CELLS, (widest + 2. * NECK) * extent);
    let mut painted = vec![false; raster.count()];
    for path in &paths {
        raster.paint(path, |cell| painted[cell] = true);
    }
    let from_lines = raster.distances(|i| painted[i]);
    // Rooms are what no pen touches: as large for each pen that does not leak.
    let rooms = |pen: f64| {
        let outside = raster.outside(|i| from_lines[i] > pen * extent);
        let room = |&i: &usize| !outside[i] && from_lines[i] > widest * extent;
        ((0..raster.count()).filter(room).count(), outside)
    };
    let most = rooms(widest);
    let enough = ENOUGH * most.0 as f64;
    let mut narrower = pens.iter().filter(|&&pen| pen < widest).map(|&pen| (pen, rooms(pen)));
    let (pen, (_, outside)) =
        narrower.find(|(_, (room, _))| *room as f64 >= enough).unwrap_or((widest, most));
    let chosen = Filled::with(&raster, &outside, pen * extent, NECK * extent);
    if chosen.area < LEAST_AREA * extent * extent {
        return Vec::new();
    }
    let holders = Holders::of(chains, bridges, 3. * NECK * extent);
    let largest = chosen.pieces.iter().map(|p| polygon::area(p)).fold(0., f64::max);
    let pieces = chosen.pieces.iter().filter(|piece| polygon::area(piece) > SLIVER * largest);
    let mut found: Vec<Silhouette> = pieces
        .map(|piece| holders.snap(piece, 2.5 * NECK * extent))
        .filter(|s| s.plain.len() > 8 && s.samples.len() > 2)
        .collect();
    for silhouette in &mut found {
        // Edges know the first stroke of their chain; the others come with it.
        let along =
            chains.iter().filter(|c| c.strokes.first().is_some_and(|s| silhouette.strokes.contains(s)));
        silhouette.strokes = along.flat_map(|chain| chain.strokes.iter().copied()).collect();
    }
    found
}

struct Filled {
    pieces: Vec<Vec<DVec2>>,
    area: f64,
}

impl Filled {
    /// Everything that cannot be reached from outside past a pen, pulled back to the lines and a neck's width.
    fn with(raster: &Raster, outside: &[bool], pen: f64, neck: f64) -> Self {
        let depth = raster.distances(|i| outside[i]);
        let pieces = raster.contours(&depth, pen + neck);
        let area = pieces.iter().map(|piece| polygon::area(piece)).sum();
        Self { pieces, area }
    }
}
