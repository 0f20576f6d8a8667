//! One node's cache: bricks of samples in the node's own space.

use super::certificate::{self, Cells};
use super::interpolation::{BRICK_CELLS, CELLS, SAMPLES, SIDE, Samples};
use super::pages::{Budget, Found, Pages};
use crate::eval::{Crease, Tree, TreeSampler};
use crate::field::{Aabb, Brick, Field, Sample, Sampler};
use crate::leaf::Frame;
use glam::Vec3;
use std::sync::Arc;

/// Lattices of a cache, each twice as fine as the one before: most of a field is smooth enough for the first.
pub(super) const LEVELS: usize = 2;

/// Cells along each side of a brick, as lattice indices count.
const STEP: i32 = CELLS as i32;

/// A node's samples, filled lazily by whichever thread asks first; the values do not depend on which.
#[derive(Debug)]
pub(crate) struct NodeCache {
    /// The node's subtree, in its own space and without caches.
    pub exact: Tree,
    /// Distance of neighbouring samples at the finest level, mm; twice that at the next, and so on. The lattices
    /// are anchored at the origin, not at the node's box, so that edits do not shift them.
    pub spacing: f32,
    /// From coarse to fine: what a level cannot tell is asked of the next.
    levels: [Pages; LEVELS],
}

/// What a cache knows of a brick: depends on the brick's place alone.
#[derive(Debug)]
pub(crate) enum CacheBrick {
    /// The field is 0.
    Empty,
    /// Interpolation is nowhere accurate.
    Exact,
    /// It is in these cells.
    Samples { certified: Cells, samples: Box<Samples> },
}

/// A cache at its place in a tree.
#[derive(Debug)]
pub(crate) struct CacheSite {
    pub cache: Arc<NodeCache>,
    /// From the space of evaluation to the node's own.
    pub frame: Frame,
    /// Tells the caches of a tree apart.
    pub number: u32,
}

impl NodeCache {
    pub fn new(exact: Tree, spacing: f32, budget: Arc<Budget>) -> Self {
        let support = exact.support();
        let levels = std::array::from_fn(|level| {
            let spacing = level_spacing(spacing, level);
            let brick_of = |p: Vec3| Self::brick_of(Self::cell_of((p / spacing).to_array()));
            Pages::new(brick_of(support.min), brick_of(support.max), budget.clone())
        });
        Self { exact, spacing, levels }
    }

    /// Takes over what `older` knows of bricks that do not touch `changed`, in the node's space.
    pub fn inherit(&mut self, older: &Self, changed: &Aabb) {
        if older.spacing != self.spacing {
            return;
        }
        for (level, (own, older)) in self.levels.iter_mut().zip(&older.levels).enumerate() {
            let spacing = level_spacing(self.spacing, level);
            own.inherit(older, |low, high| region(low, high, spacing).overlaps(changed));
        }
    }

    /// The lattice cell of a place in units of the spacing.
    pub fn cell_of(place: [f32; 3]) -> [i32; 3] {
        place.map(|x| x.floor() as i32)
    }

    /// The brick of a cell.
    pub fn brick_of(cell: [i32; 3]) -> [i32; 3] {
        cell.map(|c| c.div_euclid(STEP))
    }

    /// The cell's place in its brick.
    pub fn place_in_brick(cell: [i32; 3]) -> [usize; 3] {
        cell.map(|c| c.rem_euclid(STEP) as usize)
    }

    /// Distance of neighbouring samples at a level, mm.
    #[inline(always)]
    pub fn level_spacing(&self, level: usize) -> f32 {
        level_spacing(self.spacing, level)
    }

    /// The brick with this key at this level; `fill` makes it where it is not known.
    pub fn brick(&self, level: usize, key: [i32; 3], fill: impl FnOnce() -> CacheBrick) -> Found<'_> {
        self.levels[level].brick(key, fill)
    }

    /// What belongs in the brick with this key at this level, by a sampler of [`Self::exact`].
    pub fn fill(&self, level: usize, key: [i32; 3], sampler: &mut TreeSampler) -> CacheBrick {
        let spacing = self.level_spacing(level);
        let bound = sampler.enter(region(key, key, spacing));
        let content = if bound.hi <= 0.0 {
            CacheBrick::Empty
        } else if sampler.crease() == Crease::Sharp {
            CacheBrick::Exact
        } else {
            sampled(key, spacing, sampler)
        };
        sampler.leave();
        content
    }
}

/// The box of all samples of the bricks with keys from `low` to `high`.
fn region(low: [i32; 3], high: [i32; 3], spacing: f32) -> Aabb {
    Aabb {
        min: Brick::lattice_point(low.map(|k| k * STEP - 1), spacing),
        max: Brick::lattice_point(high.map(|k| (k + 1) * STEP + 1), spacing),
    }
}

/// Samples of the brick with this key, and where they may stand in for the field.
fn sampled(key: [i32; 3], spacing: f32, sampler: &mut TreeSampler) -> CacheBrick {
    let points: [Vec3; SAMPLES] = std::array::from_fn(|at| {
        let at = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
        Brick::lattice_point(std::array::from_fn(|a| key[a] * STEP + at[a] as i32 - 1), spacing)
    });
    let mut samples = Box::new([0.0; SAMPLES]);
    let mut even = Cells::ALL;
    if sampler.crease() == Crease::Faceted {
        let mut slopes = vec![Sample::default(); SAMPLES];
        sampler.samples(&points, &mut slopes);
        samples.iter_mut().zip(&slopes).for_each(|(value, slope)| *value = slope.value);
        even = certificate::even_cells(&slopes, spacing);
    } else {
        sampler.values(&points, &mut *samples);
    }
    let tolerances = certificate::tolerances(&samples, sampler.crease());
    let hopeful = even.and(certificate::hopeful_cells(&samples, &tolerances));
    if hopeful.is_empty() {
        return CacheBrick::Exact;
    }
    let middles: [Vec3; BRICK_CELLS] = std::array::from_fn(|cell| {
        let cell = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
        let low = cell[0] + SIDE * (cell[1] + SIDE * cell[2]) + 1 + SIDE + SIDE * SIDE;
        points[low].midpoint(points[low + 1 + SIDE + SIDE * SIDE])
    });
    let mut values = [0.0; BRICK_CELLS];
    sampler.values(&middles, &mut values);
    let certified = hopeful.and(certificate::accurate_cells(&samples, &values, &tolerances));
    if certified.is_empty() { CacheBrick::Exact } else { CacheBrick::Samples { certified, samples } }
}

fn level_spacing(finest: f32, level: usize) -> f32 {
    finest * (1 << (LEVELS - 1 - level)) as f32
}
