//! The field sampled layer by layer, a brick's height at a time.

use super::TOP;
use super::disc::Layer;
use super::region::Region;
use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, Sampler};
use glam::Vec3;
use rayon::prelude::*;

/// Places along each side of the parts that costly bricks are looked at in.
const PART: usize = 4;

/// As many layers as a brick is high, cut off at [`TOP`].
#[derive(Debug)]
pub(super) struct Slab {
    width: usize,
    /// For each row of bricks: its layers, in each its rows, in each its samples along x.
    values: Vec<f32>,
}

impl Slab {
    /// One without content, of a region's width and depth.
    pub fn new(region: &Region) -> Self {
        Self { width: region.sides[0], values: vec![0.0; region.sides[0] * region.sides[1] * BRICK] }
    }

    /// Samples the layers from number `layer` on.
    ///
    /// Promises: the same for any number of threads.
    pub fn fill(&mut self, region: &Region, layer: usize, child: &dyn Field) {
        let width = self.width;
        let rows = self.values.par_chunks_mut(width * BRICK * BRICK).enumerate();
        let worker = || (child.sampler(), Box::new([0.0; BRICK_SAMPLES]));
        rows.for_each_init(worker, |(sampler, samples), (row, values)| {
            for column in 0..width / BRICK {
                let at = [column * BRICK, row * BRICK, layer];
                let origin = std::array::from_fn(|a| region.low[a] + at[a] as i32);
                let brick = Brick { origin, spacing: region.spacing };
                sample(&mut **sampler, &brick, samples);
                for (line, from) in samples.chunks_exact(BRICK).enumerate() {
                    let start = line * width + column * BRICK;
                    values[start..start + BRICK].copy_from_slice(from);
                }
            }
        });
    }

    /// Copies the layer of this number, counted from the slab's first.
    pub fn copy_layer(&self, layer: usize, to: &mut Layer) {
        let width = self.width;
        for (row, values) in to.values.chunks_exact_mut(width).enumerate() {
            let start = ((row / BRICK * BRICK + layer) * BRICK + row % BRICK) * width;
            values.copy_from_slice(&self.values[start..start + width]);
        }
    }
}

fn sample(sampler: &mut dyn Sampler, brick: &Brick, samples: &mut [f32; BRICK_SAMPLES]) {
    let bound = sampler.enter(brick.region());
    if bound.hi <= 0.0 {
        samples.fill(0.0);
    } else if bound.lo >= TOP {
        samples.fill(TOP);
    } else {
        // What is creased is often costly, and most of it far from the surface.
        if sampler.creased() {
            by_parts(sampler, brick, samples);
        } else {
            sampler.fill(brick, samples);
        }
        samples.iter_mut().for_each(|value| *value = value.min(TOP));
    }
    sampler.leave();
}

/// Samples of a brick from parts of it, some of which need not be looked at place by place.
fn by_parts(sampler: &mut dyn Sampler, brick: &Brick, samples: &mut [f32; BRICK_SAMPLES]) {
    let mut places = [Vec3::ZERO; PART * PART * PART];
    let mut values = [0.0; PART * PART * PART];
    let parts = BRICK / PART;
    for part in 0..parts * parts * parts {
        let low = [part % parts, part / parts % parts, part / parts / parts].map(|at| at * PART);
        let at = |i: usize| [low[0] + i % PART, low[1] + i / PART % PART, low[2] + i / PART / PART];
        let bound =
            sampler.enter(Aabb { min: brick.point(low), max: brick.point(low.map(|at| at + PART - 1)) });
        if bound.hi <= 0.0 || bound.lo >= TOP {
            values.fill(if bound.hi <= 0.0 { 0.0 } else { 1.0 });
        } else {
            places.iter_mut().enumerate().for_each(|(i, place)| *place = brick.point(at(i)));
            sampler.values(&places, &mut values);
        }
        sampler.leave();
        for (i, value) in values.iter().enumerate() {
            let [x, y, z] = at(i);
            samples[x + BRICK * (y + BRICK * z)] = *value;
        }
    }
}
