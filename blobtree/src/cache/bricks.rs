//! One node's cache: bricks of samples in the node's own space.

use crate::eval::Tree;
use crate::field::{Aabb, Brick, Field};
use crate::leaf::Frame;
use crate::scalar::{Scalar, Slope, Triple};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock, RwLock};

/// Cells along each side of a brick: few, so that a lone question fills little.
const CELLS: i32 = 4;

/// Samples along each side of a brick; neighbours share a layer.
const SIDE: usize = CELLS as usize + 1;

/// Samples of a brick, x fastest.
type Samples = [f32; SIDE * SIDE * SIDE];

/// Largest estimated error of a brick's interpolation. The estimate misses what happens between samples;
/// the field is promised to stay within 0.01.
const TOLERANCE: f32 = 0.004;

/// Interpolated places are all on one piece.
const CACHED_PIECE: u32 = 0x5eed_cace;

/// Most bricks that one cache keeps: some 200 MiB. Where there are more, evaluation is exact.
const MOST_BRICKS: usize = 1 << 18;

/// A node's samples, filled lazily by whichever thread asks first; the values do not depend on which.
#[derive(Debug)]
pub(crate) struct NodeCache {
    /// The node's subtree, in its own space and without caches.
    pub exact: Tree,
    /// Distance of neighbouring samples, mm. The lattice is anchored at the origin, not at the node's box, so
    /// that edits do not shift it.
    pub spacing: f32,
    bricks: RwLock<HashMap<[i32; 3], Slot>>,
}

/// What a cache knows of a brick.
#[derive(Debug)]
pub(crate) enum CacheBrick {
    /// The field is 0.
    Empty,
    /// Interpolation is accurate.
    Smooth(Box<Samples>),
    /// It is not.
    Exact,
}

/// A brick that is filled or will be.
type Slot = Arc<OnceLock<CacheBrick>>;

/// A cache at its place in a tree.
#[derive(Debug)]
pub(crate) struct CacheSite {
    pub cache: Arc<NodeCache>,
    /// From the space of evaluation to the node's own.
    pub frame: Frame,
}

impl NodeCache {
    pub fn new(exact: Tree, spacing: f32) -> Self {
        Self { exact, spacing, bricks: RwLock::default() }
    }

    /// Takes over what `older` knows of bricks that do not touch `changed`, in the node's space.
    pub fn inherit(&mut self, older: &Self, changed: &Aabb) {
        if older.spacing != self.spacing {
            return;
        }
        let known = older.bricks.read().unwrap_or_else(std::sync::PoisonError::into_inner);
        let kept = known.iter().filter(|(key, _)| !region(**key, self.spacing).overlaps(changed));
        self.bricks = RwLock::new(kept.map(|(key, brick)| (*key, brick.clone())).collect());
    }

    /// The brick with this key, filled if it was not; `None` where the cache is full.
    fn brick(&self, key: [i32; 3]) -> Option<Slot> {
        let known = self.bricks.read().unwrap_or_else(std::sync::PoisonError::into_inner).get(&key).cloned();
        let slot = match known {
            Some(slot) => slot,
            None => {
                let mut bricks = self.bricks.write().unwrap_or_else(std::sync::PoisonError::into_inner);
                if bricks.len() >= MOST_BRICKS && !bricks.contains_key(&key) {
                    return None;
                }
                bricks.entry(key).or_default().clone()
            }
        };
        slot.get_or_init(|| self.fill(key));
        Some(slot)
    }

    fn fill(&self, key: [i32; 3]) -> CacheBrick {
        let mut sampler = self.exact.sampler();
        let bound = sampler.enter(region(key, self.spacing));
        if bound.hi <= 0.0 {
            return CacheBrick::Empty;
        }
        if sampler.creased() {
            return CacheBrick::Exact;
        }
        let points: [Vec3; SIDE * SIDE * SIDE] = std::array::from_fn(|at| {
            let at = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
            Brick::lattice_point(std::array::from_fn(|a| key[a] * CELLS + at[a] as i32), self.spacing)
        });
        let mut values = Box::new([0.0; SIDE * SIDE * SIDE]);
        sampler.values(&points, &mut *values);
        if interpolation_error(&values) <= TOLERANCE { CacheBrick::Smooth(values) } else { CacheBrick::Exact }
    }
}

/// The box of the brick with this key.
fn region(key: [i32; 3], spacing: f32) -> Aabb {
    let corner = |add: i32| Brick::lattice_point(key.map(|k| (k + add) * CELLS), spacing);
    Aabb { min: corner(0), max: corner(1) }
}

/// Estimate of the largest error of trilinear interpolation, from second differences: `⅛ Σ |∂²f| h²`.
fn interpolation_error(values: &Samples) -> f32 {
    let along = |stride: usize| {
        let mut largest = 0.0f32;
        for at in 0..values.len() - 2 * stride {
            if at / stride % SIDE < SIDE - 2 {
                let bend = values[at] - 2.0 * values[at + stride] + values[at + 2 * stride];
                largest = largest.max(bend.abs());
            }
        }
        largest
    };
    (along(1) + along(SIDE) + along(SIDE * SIDE)) / 8.0
}

/// One thread's way into a cache: remembers the brick it looked at last.
#[derive(Debug, Default)]
pub(crate) struct CacheReader {
    last: Option<([i32; 3], Option<Slot>)>,
}

impl CacheReader {
    /// The interpolated field at `p`, in the space of evaluation; `None` where it must be evaluated exactly.
    pub fn read<S: Scalar>(&mut self, site: &CacheSite, p: Triple<S>) -> Option<Slope<S>> {
        let cache = &site.cache;
        let q = site.frame.apply(p).map(|x| x * S::of(1.0 / cache.spacing));
        let cell = q.map(|x| x.value().floor() as i32);
        let key = cell.map(|c| c.div_euclid(CELLS));
        if self.last.as_ref().is_none_or(|(last, _)| *last != key) {
            self.last = Some((key, cache.brick(key)));
        }
        let (_, slot) = self.last.as_ref()?;
        match slot.as_ref()?.get()? {
            CacheBrick::Empty => Some(Slope::constant(0.0)),
            CacheBrick::Exact => None,
            CacheBrick::Smooth(values) => {
                let at = |a: usize| (cell[a] - key[a] * CELLS) as usize;
                let corner = at(0) + SIDE * (at(1) + SIDE * at(2));
                let t = std::array::from_fn(|a| q[a] - S::of(cell[a] as f32));
                let slope = trilinear(values, corner, t);
                let gradient = slope.gradient.map(|g| g * S::of(1.0 / cache.spacing));
                Some(Slope::new(slope.value, site.frame.pull_back(gradient)).on(CACHED_PIECE))
            }
        }
    }
}

/// Trilinear interpolation in the cell whose lowest sample is `corner`, and its derivative by `t`.
fn trilinear<S: Scalar>(values: &Samples, corner: usize, t: Triple<S>) -> Slope<S> {
    let sample = |x: usize, y: usize, z: usize| S::of(values[corner + x + SIDE * (y + SIDE * z)]);
    let mix = |a: S, b: S, t: S| a + (b - a) * t;
    let edge =
        |y: usize, z: usize| (mix(sample(0, y, z), sample(1, y, z), t[0]), sample(1, y, z) - sample(0, y, z));
    let side = |z: usize| {
        let ((low, low_x), (high, high_x)) = (edge(0, z), edge(1, z));
        (mix(low, high, t[1]), mix(low_x, high_x, t[1]), high - low)
    };
    let ((low, low_x, low_y), (high, high_x, high_y)) = (side(0), side(1));
    Slope::new(mix(low, high, t[2]), [mix(low_x, high_x, t[2]), mix(low_y, high_y, t[2]), high - low])
}
