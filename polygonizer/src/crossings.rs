//! Where the surface crosses a brick's lattice edges, and how it lies there.

use blobtree::{BRICK, BRICK_SAMPLES, ISO, Sample, Sampler};
use glam::Vec3;

use crate::grid::{Grid, Site, corner, is_inside, sample_index};
use crate::patches::edge_start;
use crate::place::{Batch, outward};
use crate::qef::Plane;

/// Rounds of the search along an edge. Two do for most; a kink may take five.
const ROUNDS: usize = 7;

/// A face that seems to be crossed this close to an end of what is left of the edge (as a share of the edge) is
/// taken to be: nearer to a box's edge than that, the field there may only tell of the other face, along which
/// there is no crossing to be found.
const AT_END: f32 = 0.001;

/// A crossed lattice edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    start: Vec3,
    axis: u8,
    /// The place along the edge that was sampled last, and the ends of what is left of the edge around it.
    t: f32,
    bracket: [f32; 2],
    start_is_inside: bool,
    /// From `t` to the surface along the edge, if the field is linear, as a share of the edge.
    miss: f32,
    /// The surface here.
    pub plane: Plane,
    /// The smooth piece of the field here, see [`Sample::piece`].
    piece: u32,
    wanted: bool,
    has_tried_end: bool,
}

impl Crossing {
    fn point(&self, spacing: f32) -> Vec3 {
        let mut point = self.start;
        point[usize::from(self.axis)] += self.t * spacing;
        point
    }

    fn take(&mut self, sample: &Sample, spacing: f32) {
        let side = usize::from(is_inside(sample.value) != self.start_is_inside);
        self.bracket[side] = self.t;
        self.miss = (ISO - sample.value) / (sample.gradient[usize::from(self.axis)] * spacing);
        let next = self.t + self.miss;
        if self.bracket.iter().any(|end| (next - end).abs() <= AT_END) {
            (self.t, self.miss) = (next, 0.0);
        }
        self.plane = Plane { point: self.point(spacing), normal: outward(sample) };
        self.piece = sample.piece;
    }

    /// Goes on to where the field seems to lead. If that is away from what is left of the edge, the crossing is on
    /// another face, which the far end may be on however near the crossing is to it.
    fn advance(&mut self) {
        let [low, high] = self.bracket;
        let next = self.t + self.miss;
        self.t = if low < next && next < high {
            next
        } else if !self.has_tried_end {
            self.has_tried_end = true;
            if self.t - low < high - self.t { high } else { low }
        } else {
            low.midpoint(high)
        };
    }

    /// Whether the sampled point may be further than `tolerance` edges from the crossing. So it is if the
    /// field there leads away from what is left of the edge: then the crossing is on another face.
    pub fn is_off(&self, tolerance: f32) -> bool {
        let leads_away = !(self.bracket[0]..=self.bracket[1]).contains(&(self.t + self.miss));
        leads_away || self.miss.abs() > tolerance
    }
}

/// All crossings of a brick. Reused.
pub(crate) struct Crossings {
    /// Number of the crossing on each lattice edge, by axis and first sample; stale where there is none.
    number_of: Box<[u16; 3 * BRICK_SAMPLES]>,
    all: Vec<Crossing>,
    open: Vec<u16>,
}

impl Default for Crossings {
    fn default() -> Self {
        Self { number_of: Box::new([0; 3 * BRICK_SAMPLES]), all: Vec::new(), open: Vec::new() }
    }
}

impl Crossings {
    /// Finds the crossings of `grid` and samples them where a linear field would have them.
    pub fn find(&mut self, sampler: &mut dyn Sampler, grid: &Grid, batch: &mut Batch) {
        self.all.clear();
        batch.points.clear();
        for z in 0..BRICK {
            for y in 0..BRICK {
                for axis in 0..3 {
                    for x in grid.crossed_edges(axis, y, z) {
                        self.add(grid, axis, [x, y, z], batch);
                    }
                }
            }
        }
        let samples = batch.sample(sampler);
        for (crossing, sample) in self.all.iter_mut().zip(samples) {
            crossing.take(sample, grid.brick.spacing);
        }
    }

    fn add(&mut self, grid: &Grid, axis: usize, at: [usize; 3], batch: &mut Batch) {
        self.number_of[axis * BRICK_SAMPLES + sample_index(at)] = self.all.len() as u16;
        let crossing = Crossing {
            start: grid.point(at),
            axis: axis as u8,
            t: grid.linear_crossing(at, axis),
            bracket: [0.0, 1.0],
            start_is_inside: is_inside(grid.value(at)),
            miss: 0.0,
            plane: Plane { point: Vec3::ZERO, normal: Vec3::ZERO },
            piece: 0,
            wanted: false,
            has_tried_end: false,
        };
        batch.points.push(crossing.point(grid.brick.spacing));
        self.all.push(crossing);
    }

    /// The crossings of a site.
    pub fn of(&self, site: Site) -> impl Iterator<Item = &Crossing> {
        site.crossed_edges().map(move |edge| &self.all[self.number(site, edge)])
    }

    /// Whether all crossings of a site are known to lie on one smooth piece.
    pub fn are_one_piece(&self, site: Site) -> bool {
        let mut pieces = self.of(site).map(|crossing| crossing.piece);
        pieces.next().is_some_and(|first| first != 0 && pieces.all(|piece| piece == first))
    }

    fn number(&self, site: Site, edge: usize) -> usize {
        let start = sample_index(corner(site.cell, edge_start(edge)));
        usize::from(self.number_of[edge / 4 * BRICK_SAMPLES + start])
    }

    /// Brings the crossings of `sites` to within `tolerance` edges of the surface.
    pub fn refine(
        &mut self,
        sampler: &mut dyn Sampler,
        sites: impl Iterator<Item = Site>,
        spacing: f32,
        tolerance: f32,
        batch: &mut Batch,
    ) {
        self.open.clear();
        for site in sites {
            for edge in site.crossed_edges() {
                let number = self.number(site, edge);
                let crossing = &mut self.all[number];
                if !crossing.wanted && crossing.is_off(tolerance) {
                    crossing.wanted = true;
                    self.open.push(number as u16);
                }
            }
        }
        for _ in 0..ROUNDS {
            if self.open.is_empty() {
                return;
            }
            batch.points.clear();
            for &number in &self.open {
                let crossing = &mut self.all[usize::from(number)];
                crossing.advance();
                batch.points.push(crossing.point(spacing));
            }
            let mut samples = batch.sample(sampler).iter();
            let all = &mut self.all;
            self.open.retain(|&number| {
                let crossing = &mut all[usize::from(number)];
                crossing.take(samples.next().expect("one sample per open crossing"), spacing);
                crossing.is_off(tolerance)
            });
        }
    }
}
