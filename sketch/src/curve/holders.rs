//! The lines that hold an outline which was found on a raster.

use super::chains::{AS_NEAR, Chain};
use super::line::Sample;
use super::polygon;
use super::silhouette::Silhouette;
use glam::DVec2;

/// What a place of a line between two of the pen counts.
const WEIGHT_ON_THE_WAY: f64 = 0.02;
/// What a place counts where no line was found to hold it.
const WEIGHT_OF_A_GAP: f64 = 1e-2;
/// Bridges are held at places so far apart, in reaches of the outline.
const STEP_ON_BRIDGES: f64 = 0.15;
/// Samples nearer to each other than this, in drawing sizes, are one.
const REPETITION: f64 = 1e-4;

/// Parts of an outline that are further apart along it than this, in reaches, have a neck between them if they are
/// closer than this.
const FAR_ALONG: f64 = 2.;
const CLOSE: f64 = 0.5;

/// An edge of a painted line.
struct Edge {
    ends: [Sample; 2],
    /// None for bridges.
    stroke: Option<usize>,
    /// Which of the chains and bridges it is of.
    path: usize,
}

/// The edges of all lines, by place.
pub(super) struct Holders {
    edges: Vec<Edge>,
    origin: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
}

/// What an outline follows for a while: an edge, or nothing, from the place where it comes to it to where it leaves.
struct Visit {
    edge: Option<usize>,
    first: Sample,
    last: Sample,
}

impl Holders {
    pub fn of(chains: &[&Chain], bridges: &[[DVec2; 2]], reach: f64) -> Self {
        let mut edges = Vec::new();
        for (path, chain) in chains.iter().enumerate() {
            let closing = chain.samples.first().filter(|_| chain.closed);
            let all: Vec<Sample> = chain.samples.iter().chain(closing).copied().collect();
            let stroke = chain.strokes.first().copied();
            edges.extend(all.windows(2).map(|pair| Edge { ends: [pair[0], pair[1]], stroke, path }));
        }
        edges.extend(bridges.iter().enumerate().map(|(i, bridge)| Edge {
            ends: bridge.map(|at| Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0., sparse: false }),
            stroke: None,
            path: chains.len() + i,
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
    ///
    /// Of edges that are as near, such as two that share the place, the one that counts most, then the first.
    fn nearest(&self, at: DVec2, reach: f64) -> Option<(Sample, usize)> {
        let mut near: Vec<(f64, usize)> =
            self.around(at).map(|k| (self.edges[k].nearest(at).at.distance(at), k)).collect();
        let least = near.iter().map(|(far, _)| *far).fold(f64::INFINITY, f64::min);
        near.retain(|&(far, _)| far <= reach && far <= least + AS_NEAR);
        let places = near.into_iter().map(|(_, k)| (self.edges[k].nearest(at), k));
        places.max_by(|a, b| a.0.weight.total_cmp(&b.0.weight).then(b.1.cmp(&a.1)))
    }

    /// Edges in the cells around a place; some more than once.
    fn around(&self, at: DVec2) -> impl Iterator<Item = usize> {
        let [x, y] = self.cell_of(at);
        let columns = x.saturating_sub(1)..=(x + 1).min(self.columns - 1);
        let rows = y.saturating_sub(1)..=(y + 1).min(self.rows - 1);
        let cells = rows.flat_map(move |row| columns.clone().map(move |column| row * self.columns + column));
        cells.flat_map(|cell| &self.cells[cell]).map(|&k| k as usize)
    }

    /// Moves a piece's outline onto the lines that hold it: their own samples in order, where they meet, and what is
    /// free between them.
    pub fn snap(&self, piece: &[DVec2], reach: f64) -> Silhouette {
        let free = |at| Sample { at, weight: WEIGHT_OF_A_GAP, smoothing: 0., sparse: false };
        let held: Vec<(Sample, Option<usize>)> = piece
            .iter()
            .map(|&at| self.nearest(at, reach).map_or((free(at), None), |(sample, k)| (sample, Some(k))))
            .collect();
        let mut plain: Vec<Sample> = held.iter().map(|(s, _)| Sample { sparse: false, ..*s }).collect();
        plain.dedup_by(|next, last| next.at.distance(last.at) <= REPETITION);
        let filled: Vec<Sample> = piece.iter().map(|&at| Sample { weight: 1., ..free(at) }).collect();
        let narrow = narrow(piece, &held, reach);
        let wide = (0..piece.len())
            .map(|i| if narrow[i] { filled[i] } else { Sample { sparse: false, ..held[i].0 } });
        let visits = visits(&held);
        let mut samples: Vec<Sample> = Vec::with_capacity(piece.len());
        for (i, visit) in visits.iter().enumerate() {
            let before = &visits[(i + visits.len() - 1) % visits.len()];
            samples.extend(self.from(before, visit, 2. * reach));
            if visit.edge.is_some_and(|k| self.edges[k].stroke.is_none()) {
                samples.extend(visit.on_the_way(STEP_ON_BRIDGES * reach));
            }
        }
        samples.dedup_by(|next, last| next.at.distance(last.at) <= REPETITION);
        let mut strokes: Vec<usize> = visits.iter().filter_map(|v| self.edges[v.edge?].stroke).collect();
        strokes.sort_unstable();
        strokes.dedup();
        Silhouette { samples, plain, wide: wide.collect(), filled, strokes }
    }

    /// What leads from one visit to the next one: the samples between them along a line, or where both edges meet, if
    /// within reach; otherwise where the first one is left and the next one begins.
    fn from(&self, before: &Visit, next: &Visit, reach: f64) -> Vec<Sample> {
        let jump = || {
            let on_the_way = |sample: Sample| Sample { weight: WEIGHT_ON_THE_WAY * sample.weight, ..sample };
            let left = before.edge.map(|_| on_the_way(before.last));
            let reached = if next.edge.is_some() { on_the_way(next.first) } else { next.first };
            left.into_iter().chain([reached]).collect()
        };
        let Some((a, b)) = before.edge.zip(next.edge) else { return jump() };
        if let Some(between) = self.along(a, b, before.last.at, next.first.at, reach) {
            return between;
        }
        let meeting = self.edges[b].meets(&self.edges[a]);
        let near = meeting.filter(|meeting| meeting.at.distance(next.first.at) < reach);
        near.map_or_else(jump, |meeting| vec![meeting])
    }

    /// The samples between two edges of one line, unless it goes further than `reach` on the way.
    fn along(&self, a: usize, b: usize, from: DVec2, to: DVec2, reach: f64) -> Option<Vec<Sample>> {
        if self.edges[a].path != self.edges[b].path {
            return None;
        }
        let mut between: Vec<Sample> =
            (a.min(b) + 1..=a.max(b)).map(|k| self.edges[k].ends[0]).take(self.edges.len()).collect();
        if a > b {
            between.reverse();
        }
        let mut gone = 0.;
        let mut last = from;
        for at in between.iter().map(|sample| sample.at).chain([to]) {
            gone += last.distance(at);
            last = at;
            if gone > reach {
                return None;
            }
        }
        Some(between)
    }
}

/// Which places of an outline would come close to another part of it, were they moved onto their lines.
fn narrow(piece: &[DVec2], held: &[(Sample, Option<usize>)], reach: f64) -> Vec<bool> {
    let n = piece.len();
    let around: f64 = polygon::edges(piece).map(|(a, b)| a.distance(b)).sum();
    let far = (FAR_ALONG * reach * n as f64 / around) as usize;
    let close = |i: usize, j: usize| held[i].0.at.distance(held[j].0.at) < CLOSE * reach;
    (0..n).map(|i| (far..(n + 1).saturating_sub(far)).any(|k| close(i, (i + k) % n))).collect()
}

/// Neighbours held by the same edge taken together, and what is free one by one.
fn visits(held: &[(Sample, Option<usize>)]) -> Vec<Visit> {
    let mut visits: Vec<Visit> = Vec::new();
    for &(sample, edge) in held {
        match visits.last_mut() {
            Some(visit) if edge.is_some() && visit.edge == edge => visit.last = sample,
            _ => visits.push(Visit { edge, first: sample, last: sample }),
        }
    }
    // Around the start of the outline.
    if visits.len() > 1 && visits[0].edge.is_some() && visits[0].edge == visits[visits.len() - 1].edge {
        let first = visits.remove(0);
        if let Some(visit) = visits.last_mut() {
            visit.last = first.last;
        }
    }
    visits
}

impl Visit {
    /// Samples on the way from the first place to the last one, so far apart.
    fn on_the_way(&self, step: f64) -> impl Iterator<Item = Sample> {
        let pieces = (self.first.at.distance(self.last.at) / step).ceil() as usize;
        let place = move |k: usize| self.first.at.lerp(self.last.at, k as f64 / pieces as f64);
        (1..pieces).map(move |k| Sample { at: place(k), ..self.first })
    }
}

impl Edge {
    /// The nearest place on the edge, with what it counts there: at an end, what the end does.
    fn nearest(&self, at: DVec2) -> Sample {
        let [a, b] = self.ends;
        let along = b.at - a.at;
        let share = ((at - a.at).dot(along) / along.length_squared().max(1e-30)).clamp(0., 1.);
        let weight = match share {
            0. => a.weight,
            1. => b.weight,
            _ => a.weight.min(b.weight),
        };
        let smoothing = a.smoothing + share * (b.smoothing - a.smoothing);
        Sample { at: a.at + share * along, weight, smoothing, sparse: a.sparse }
    }

    /// The end of one that the other one has or passes, the one that counts most; or where they cross.
    fn meets(&self, other: &Self) -> Option<Sample> {
        let touches = |end: &Sample, other: &Self| other.nearest(end.at).at.distance(end.at) < AS_NEAR;
        let own = self.ends.into_iter().filter(|end| touches(end, other));
        let touching = own.chain(other.ends.into_iter().filter(|end| touches(end, self)));
        touching.reduce(|a, b| if b.weight > a.weight { b } else { a }).or_else(|| {
            let [a, b] = [self, other].map(|edge| edge.ends.map(|end| end.at));
            let (share, _) = polygon::crossing((a[0], a[1]), (b[0], b[1]))?;
            Some(Sample { at: a[0].lerp(a[1], share), ..self.ends[0] })
        })
    }
}
