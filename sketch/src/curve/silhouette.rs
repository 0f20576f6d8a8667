//! What lines enclose, however they cross: the silhouette of the painted and filled drawing.

use super::chains::Chain;
use super::line::Sample;
use super::polygon;
use super::raster::Raster;
use glam::DVec2;

/// Cells along the longer side of the painted lines.
const CELLS: usize = 384;
/// Half widths of the pens that are tried, in extents: gaps of twice that are closed.
pub(super) const PENS: [f64; 4] = [0.006, 0.012, 0.025, 0.04];
/// Pens for lines that enclose nothing otherwise.
pub(super) const WIDE_PENS: [f64; 3] = [0.06, 0.08, 0.11];
/// A pen will do if it encloses this share of what the widest one does.
const ENOUGH: f64 = 0.6;
/// Necks narrower than twice this part, in extents: lobes that only touch where a line crosses itself.
const NECK: f64 = 0.01;
/// Pieces below this share of the largest are slivers between lines drawn twice.
const SLIVER: f64 = 0.015;
/// Least area that is an outline, over the square of the extent.
const LEAST_AREA: f64 = 0.004;
/// What a place counts where no line was found to hold it.
const WEIGHT_OF_A_GAP: f64 = 1e-2;

/// The outline of what lines enclose.
pub(super) struct Silhouette {
    pub samples: Vec<Sample>,
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
    let filled = |pen: f64| Filled::with(&raster, &from_lines, pen * extent, NECK * extent);
    let most_filled = filled(widest);
    let enough = (ENOUGH * most_filled.area).max(LEAST_AREA * extent * extent);
    let narrower =
        pens.iter().filter(|&&pen| pen < widest).map(|&pen| filled(pen)).find(|f| f.area >= enough);
    let chosen = narrower.unwrap_or(most_filled);
    if chosen.area < enough {
        return Vec::new();
    }
    let holders = Holders::of(chains, bridges, 3. * NECK * extent);
    let largest = chosen.pieces.iter().map(|p| polygon::area(p)).fold(0., f64::max);
    let pieces = chosen.pieces.iter().filter(|piece| polygon::area(piece) > SLIVER * largest);
    let mut found: Vec<Silhouette> = pieces
        .map(|piece| holders.snap(piece, 2.5 * NECK * extent))
        .filter(|s| s.samples.len() > 8)
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
    fn with(raster: &Raster, from_lines: &[f64], pen: f64, neck: f64) -> Self {
        let outside = raster.outside(|i| from_lines[i] > pen);
        let depth = raster.distances(|i| outside[i]);
        let pieces = raster.contours(&depth, pen + neck);
        let area = pieces.iter().map(|piece| polygon::area(piece)).sum();
        Self { pieces, area }
    }
}

/// An edge of a painted line.
struct Edge {
    ends: [Sample; 2],
    /// None for bridges.
    stroke: Option<usize>,
}

/// The edges of all lines, by place.
struct Holders {
    edges: Vec<Edge>,
    origin: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
}

impl Holders {
    fn of(chains: &[&Chain], bridges: &[[DVec2; 2]], reach: f64) -> Self {
        let mut edges = Vec::new();
        for chain in chains {
            let closing = chain.samples.first().filter(|_| chain.closed);
            let all: Vec<Sample> = chain.samples.iter().chain(closing).copied().collect();
            edges.extend(
                all.windows(2)
                    .map(|pair| Edge { ends: [pair[0], pair[1]], stroke: chain.strokes.first().copied() }),
            );
        }
        edges.extend(bridges.iter().map(|bridge| Edge {
            ends: bridge.map(|at| Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0. }),
            stroke: None,
        }));
        let places: Vec<DVec2> = edges.iter().flat_map(|edge| edge.ends.map(|end| end.at)).collect();
        let (least, most) = polygon::bounds(&places);
        let size = ((most - least) / reach).floor();
        let (columns, rows) = (size.x as usize + 1, size.y as usize + 1);
        let mut holders = Self {
            edges,
            origin: least,
            cell: reach,
            columns,
            rows,
            cells: vec![Vec::new(); columns * rows],
        };
        for k in 0..holders.edges.len() {
            let [a, b] = holders.edges[k].ends.map(|end| holders.cell_of(end.at));
            for y in a[1].min(b[1])..=a[1].max(b[1]) {
                for x in a[0].min(b[0])..=a[0].max(b[0]) {
                    holders.cells[y * columns + x].push(k as u32);
                }
            }
        }
        holders
    }

    fn cell_of(&self, at: DVec2) -> [usize; 2] {
        let cell = ((at - self.origin) / self.cell).floor().max(DVec2::ZERO);
        [(cell.x as usize).min(self.columns - 1), (cell.y as usize).min(self.rows - 1)]
    }

    /// The nearest place on a line within a reach of at most the cells' size, and its stroke.
    fn nearest(&self, at: DVec2, reach: f64) -> Option<(Sample, Option<usize>)> {
        let [x, y] = self.cell_of(at);
        let mut best: Option<(f64, Sample, Option<usize>)> = None;
        for row in y.saturating_sub(1)..=(y + 1).min(self.rows - 1) {
            for column in x.saturating_sub(1)..=(x + 1).min(self.columns - 1) {
                for &k in &self.cells[row * self.columns + column] {
                    let Edge { ends: [a, b], stroke } = self.edges[k as usize];
                    let along = b.at - a.at;
                    let share = ((at - a.at).dot(along) / along.length_squared().max(1e-30)).clamp(0., 1.);
                    let place = a.at + share * along;
                    let far = place.distance(at);
                    if far <= reach && best.is_none_or(|(least, ..)| far < least) {
                        let smoothing = a.smoothing + share * (b.smoothing - a.smoothing);
                        let weight = a.weight.min(b.weight);
                        best = Some((far, Sample { at: place, weight, smoothing }, stroke));
                    }
                }
            }
        }
        best.map(|(_, sample, stroke)| (sample, stroke))
    }

    /// Moves a piece's outline onto the lines that hold it.
    fn snap(&self, piece: &[DVec2], reach: f64) -> Silhouette {
        let mut samples: Vec<Sample> = Vec::with_capacity(piece.len());
        let mut strokes: Vec<usize> = Vec::new();
        for &at in piece {
            let free = (Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0. }, None);
            let (sample, stroke) = self.nearest(at, reach).unwrap_or(free);
            strokes.extend(stroke);
            if samples.last().is_none_or(|last| last.at.distance(sample.at) > 1e-4) {
                samples.push(sample);
            }
        }
        strokes.sort_unstable();
        strokes.dedup();
        Silhouette { samples, strokes }
    }
}
