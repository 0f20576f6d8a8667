//! One thread's evaluation of a tree.

use super::places::{Axes, Cloud, ROW};
use super::program::{Instr, Tree};
use super::scratch::Scratch;
use super::slopes::Want;
use super::specialise::{Crease, Narrowed, Narrower};
use crate::cache::CacheReader;
use crate::field::{Aabb, BRICK_SAMPLES, Brick, Interval, Sample, Sampler};
use crate::leaf::PurePoint;
use glam::Vec3;
use std::sync::atomic::Ordering;

/// Points evaluated in one go.
const CHUNK: usize = 64 * ROW;

/// One thread's evaluation of a [`Tree`]: its regions, and its scratch memory.
#[derive(Debug)]
pub(crate) struct TreeSampler<'a> {
    pub tree: &'a Tree,
    pub narrower: Narrower,
    levels: Vec<Level>,
    pub scratch: Scratch,
    /// Tables of the point primitives that a brick sums.
    pub tables: Vec<[[f32; ROW]; 3]>,
    /// Those primitives.
    pub points: Vec<Instr>,
    /// The same for sums with gradients.
    pub numbered_points: Vec<(u32, PurePoint)>,
    /// A way into each of the tree's caches.
    pub readers: Vec<CacheReader<'a>>,
    pub arch: pulp::Arch,
    /// Evaluations of a primitive at a point so far.
    pub evaluations: u64,
}

/// A region entered.
#[derive(Clone, Copy, Debug)]
struct Level {
    narrowed: Narrowed,
    /// Where its part of the arena begins.
    base: usize,
}

impl<'a> TreeSampler<'a> {
    pub fn new(tree: &'a Tree) -> Self {
        Self {
            tree,
            narrower: Narrower::new(tree),
            levels: Vec::new(),
            scratch: Scratch::default(),
            tables: Vec::new(),
            points: Vec::new(),
            numbered_points: Vec::new(),
            readers: tree.caches.iter().map(CacheReader::new).collect(),
            arch: pulp::Arch::new(),
            evaluations: 0,
        }
    }

    /// The program of the region entered last.
    fn current(&self) -> Instr {
        self.levels.last().map_or(self.tree.root, |level| level.narrowed.instr)
    }

    /// Whether the gradient may jump somewhere in the current region.
    pub fn crease(&self) -> Crease {
        self.levels.last().map_or(Crease::Sharp, |level| level.narrowed.crease)
    }

    /// A cloud of at most [`CHUNK`] points, its last row filled up with the last of them.
    fn cloud_of(&mut self, points: &[Vec3]) -> Cloud {
        let rows = points.len().div_ceil(ROW);
        let mut cloud = self.scratch.take_cloud(rows);
        for at in 0..rows * ROW {
            let p = points[at.min(points.len() - 1)];
            cloud.set(at / ROW, at % ROW, p.to_array());
        }
        cloud
    }
}

impl Drop for TreeSampler<'_> {
    fn drop(&mut self) {
        self.tree.evaluations.fetch_add(self.evaluations, Ordering::Relaxed);
    }
}

impl Sampler for TreeSampler<'_> {
    fn enter(&mut self, region: Aabb) -> Interval {
        let base = self.narrower.arena.len();
        let narrowed = self.narrower.narrow(self.tree, self.current(), &region);
        self.levels.push(Level { narrowed, base });
        narrowed.bound
    }

    fn leave(&mut self) {
        if let Some(level) = self.levels.pop() {
            self.narrower.arena.truncate(level.base);
        }
    }

    fn creased(&self) -> bool {
        self.crease() > Crease::None
    }

    fn fill(&mut self, brick: &Brick, values: &mut [f32; BRICK_SAMPLES]) {
        let (rows, _) = values.as_chunks_mut();
        self.run_values(self.current(), &Axes::new(brick), rows);
    }

    fn values(&mut self, points: &[Vec3], values: &mut [f32]) {
        assert_eq!(points.len(), values.len(), "one value per point");
        for (points, values) in points.chunks(CHUNK).zip(values.chunks_mut(CHUNK)) {
            let cloud = self.cloud_of(points);
            let mut rows = self.scratch.take_values(points.len().div_ceil(ROW));
            self.run_values(self.current(), &cloud, &mut rows);
            values.copy_from_slice(&rows.as_flattened()[..points.len()]);
            self.scratch.give_values(rows);
            self.scratch.give_cloud(cloud);
        }
    }

    fn samples(&mut self, points: &[Vec3], samples: &mut [Sample]) {
        assert_eq!(points.len(), samples.len(), "one sample per point");
        for (points, samples) in points.chunks(CHUNK).zip(samples.chunks_mut(CHUNK)) {
            let cloud = self.cloud_of(points);
            let mut slopes = self.scratch.take_slopes(points.len().div_ceil(ROW));
            self.run_slopes(self.current(), &cloud, &mut slopes, Want::Gradient);
            for (at, sample) in samples.iter_mut().enumerate() {
                let slope = slopes.get(at / ROW, at % ROW);
                let gradient = Vec3::from_array(slope.gradient);
                *sample = Sample { value: slope.value, gradient, piece: slope.piece };
            }
            self.scratch.give_slopes(slopes);
            self.scratch.give_cloud(cloud);
        }
    }
}
