//! What lines enclose, however they cross: the silhouette of the painted and filled drawing.

use super::chains::Chain;
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
/// Edges of thinned out strokes longer than this, in extents, lead from one place of the pen to the next one far away,
const LONG_EDGE: f64 = 0.015;
/// and what is between counts less.
const WEIGHT_ON_THE_WAY: f64 = 0.02;
/// What a place counts where no line was found to hold it.
const WEIGHT_OF_A_GAP: f64 = 1e-2;

/// The outline of what lines enclose.
pub(super) struct Silhouette {
    pub samples: Vec<Sample>,
    /// The same evenly, without the ends of long edges: rougher, but where lines were drawn twice less entangled.
    pub plain: Vec<Sample>,
    /// The same as it was filled, without a crossing.
    pub filled: Vec<DVec2>,
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
        .map(|piece| holders.snap(piece, 2.5 * NECK * extent, LONG_EDGE * extent))
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
    fn with(raster: &Raster, outside: &[bool], pen: f64, neck: f64) -> Self {
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
            ends: bridge.map(|at| Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0., sparse: false }),
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

    /// The nearest place on a line within a reach of at most the cells' size, and the number of its edge.
    fn nearest(&self, at: DVec2, reach: f64) -> Option<(Sample, usize)> {
        let [x, y] = self.cell_of(at);
        let mut best: Option<(f64, Sample, usize)> = None;
        for row in y.saturating_sub(1)..=(y + 1).min(self.rows - 1) {
            for column in x.saturating_sub(1)..=(x + 1).min(self.columns - 1) {
                for &k in &self.cells[row * self.columns + column] {
                    let Edge { ends: [a, b], .. } = self.edges[k as usize];
                    let along = b.at - a.at;
                    let share = ((at - a.at).dot(along) / along.length_squared().max(1e-30)).clamp(0., 1.);
                    let place = a.at + share * along;
                    let far = place.distance(at);
                    if far <= reach && best.is_none_or(|(least, ..)| far < least) {
                        let smoothing = a.smoothing + share * (b.smoothing - a.smoothing);
                        let weight = a.weight.min(b.weight);
                        best = Some((
                            far,
                            Sample { at: place, weight, smoothing, sparse: a.sparse },
                            k as usize,
                        ));
                    }
                }
            }
        }
        best.map(|(_, sample, edge)| (sample, edge))
    }

    /// Moves a piece's outline onto the lines that hold it. The ends of long edges become samples, and what is
    /// between them counts little.
    fn snap(&self, piece: &[DVec2], reach: f64, long: f64) -> Silhouette {
        let mut samples: Vec<Sample> = Vec::with_capacity(piece.len());
        let mut strokes: Vec<usize> = Vec::new();
        let mut put = |sample: Sample| {
            if samples.last().is_none_or(|last| last.at.distance(sample.at) > 1e-4) {
                samples.push(sample);
            }
        };
        let free = |at| Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0., sparse: false };
        let held: Vec<Option<(Sample, usize)>> = piece.iter().map(|&at| self.nearest(at, reach)).collect();
        let even = piece.iter().zip(&held).map(|(&at, holder)| holder.map_or(free(at), |(sample, _)| sample));
        let mut plain: Vec<Sample> = even.map(|sample| Sample { sparse: false, ..sample }).collect();
        plain.dedup_by(|next, last| next.at.distance(last.at) <= 1e-4);
        let is_long = |edge: &Edge| edge.ends[0].sparse && edge.ends[0].at.distance(edge.ends[1].at) > long;
        for (i, (&at, holder)) in piece.iter().zip(&held).enumerate() {
            let Some((sample, k)) = *holder else {
                put(free(at));
                continue;
            };
            let edge = &self.edges[k];
            strokes.extend(edge.stroke);
            let before = held[(i + held.len() - 1) % held.len()].filter(|(_, other)| *other != k);
            if let Some((_, other)) = before {
                let other = &self.edges[other];
                let shared = (is_long(edge) || is_long(other)).then(|| edge.meets(other)).flatten();
                shared
                    .filter(|shared| shared.at.distance(sample.at) < 2. * reach)
                    .into_iter()
                    .for_each(&mut put);
            }
            let at_an_end = edge.ends.iter().any(|end| end.at.distance(sample.at) < 1e-4);
            let on_the_way = is_long(edge) && !at_an_end;
            put(Sample {
                weight: if on_the_way { WEIGHT_ON_THE_WAY * sample.weight } else { sample.weight },
                ..sample
            });
        }
        strokes.sort_unstable();
        strokes.dedup();
        Silhouette { samples, plain, filled: piece.to_vec(), strokes }
    }
}

impl Edge {
    /// The end that both edges have, or where they cross.
    fn meets(&self, other: &Self) -> Option<Sample> {
        let shared = self.ends.into_iter().find(|a| other.ends.iter().any(|b| a.at == b.at));
        shared.or_else(|| {
            let [a, b] = [self, other].map(|edge| edge.ends.map(|end| end.at));
            let (share, _) = polygon::crossing((a[0], a[1]), (b[0], b[1]))?;
            Some(Sample { at: a[0].lerp(a[1], share), ..self.ends[0] })
        })
    }
}
