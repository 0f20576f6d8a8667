//! From layers to the bricks of an image: which are needed, and what they hold.

use super::disc::Layer;
use super::region::Region;
use blobtree::{VOXEL_BRICK, VOXEL_SAMPLES, VoxelBrick};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Layers that are kept: those of a brick with two on both sides, and some more.
pub(super) const KEPT: usize = 2 * VOXEL_BRICK;

/// How near to a place, in lattice steps, samples must be true where the place matters.
const NEAR: usize = 2;

const SIDE: usize = VOXEL_BRICK + 2;

/// Collects the bricks of an image from layers that come bottom up.
#[derive(Debug)]
pub(super) struct Collector {
    /// Keys of the first brick, and how many there are along each side.
    first: [i32; 3],
    sides: [usize; 3],
    /// Lattice index of the layers' first place.
    low: [i32; 3],
    needed: Vec<AtomicBool>,
    /// The last layers, each at its number modulo their count.
    layers: Vec<Layer>,
    top: f32,
    bricks: Vec<VoxelBrick>,
    /// Layers of bricks done.
    done: usize,
}

impl Collector {
    /// One without layers, of samples up to `top`. The `below` are the first two layers below the first, the higher one first.
    pub fn new(region: &Region, below: [Layer; 2], top: f32) -> Self {
        let step = VOXEL_BRICK as i32;
        let first = region.low.map(|i| i.div_euclid(step));
        let sides: [usize; 3] =
            std::array::from_fn(|a| (region.high()[a].div_euclid(step) - first[a] + 1) as usize);
        let [width, depth, _] = region.sides;
        let mut layers = vec![Layer::new(width, depth, top); KEPT];
        let [higher, lower] = below;
        (layers[KEPT - 1], layers[KEPT - 2]) = (higher, lower);
        Self {
            first,
            sides,
            low: region.low,
            needed: (0..sides.iter().product()).map(|_| AtomicBool::new(false)).collect(),
            layers,
            top,
            bricks: Vec::new(),
            done: 0,
        }
    }

    /// Where layer number `layer` is kept.
    pub fn layer_mut(&mut self, layer: usize) -> &mut Layer {
        &mut self.layers[layer % KEPT]
    }

    /// Takes out layer number `layer`, which is at least 1, and the one below it.
    pub fn take_layers(&mut self, layer: usize) -> [Layer; 2] {
        [layer - 1, layer].map(|layer| std::mem::replace(self.layer_mut(layer), Layer::new(0, 0, 0.0)))
    }

    /// Puts them back.
    pub fn give_layers(&mut self, layer: usize, [below, this]: [Layer; 2]) {
        *self.layer_mut(layer - 1) = below;
        *self.layer_mut(layer) = this;
    }

    /// Says that the place in this column, row and layer matters.
    pub fn mark(&self, x: usize, y: usize, layer: usize) {
        let step = VOXEL_BRICK as i32;
        let along = |at: usize, a: usize| {
            let (from, to) = (self.low[a] + at as i32 - NEAR as i32, self.low[a] + (at + NEAR) as i32);
            let key =
                |i: i32| (i.div_euclid(step) - self.first[a]).clamp(0, self.sides[a] as i32 - 1) as usize;
            key(from)..=key(to)
        };
        for z in along(layer, 2) {
            for y in along(y, 1) {
                for x in along(x, 0) {
                    let needed = &self.needed[x + self.sides[0] * (y + self.sides[1] * z)];
                    if !needed.load(Ordering::Relaxed) {
                        needed.store(true, Ordering::Relaxed);
                    }
                }
            }
        }
    }

    /// To be called when layer number `layer` is written and marked: takes the bricks that are complete.
    pub fn advance(&mut self, layer: usize) {
        while self.last_layer_for(self.done) <= layer as i32 {
            self.take();
        }
    }

    /// Takes all that is left; the last of `layers` layers goes on upwards.
    pub fn finish(mut self, layers: usize) -> Vec<VoxelBrick> {
        let mut layer = layers;
        while self.done < self.sides[2] {
            while self.last_layer_for(self.done) > layer as i32 - 1 {
                let last = self.layers[(layer - 1) % KEPT].clone();
                *self.layer_mut(layer) = last;
                layer += 1;
            }
            self.take();
        }
        self.bricks
    }

    /// The layer that decides whether the bricks in this layer of bricks are needed.
    fn last_layer_for(&self, done: usize) -> i32 {
        if done >= self.sides[2] {
            return i32::MAX;
        }
        (self.first[2] + done as i32 + 1) * VOXEL_BRICK as i32 - 1 + NEAR as i32
    }

    /// Takes the next layer of bricks.
    fn take(&mut self) {
        let z = self.done;
        let plane = self.sides[0] * self.sides[1];
        let own = &self.needed[z * plane..(z + 1) * plane];
        let wanted: Vec<usize> = (0..plane).filter(|i| own[*i].load(Ordering::Relaxed)).collect();
        let taken = wanted.par_iter().map(|i| {
            let key = [i % self.sides[0], i / self.sides[0], z];
            self.brick(std::array::from_fn(|a| self.first[a] + key[a] as i32))
        });
        let taken: Vec<VoxelBrick> = taken.collect();
        self.bricks.extend(taken);
        self.done += 1;
    }

    /// The samples of a brick, sharpened: less an eighth of their second differences, so that the image's filter gives
    /// them back as they are. Else it would move the surface wherever the slope across it jumps.
    fn brick(&self, key: [i32; 3]) -> VoxelBrick {
        let mut samples = Vec::with_capacity(VOXEL_SAMPLES);
        let start: [i32; 3] = std::array::from_fn(|a| key[a] * VOXEL_BRICK as i32 - 1 - self.low[a]);
        // Below the first layer is what was there at the beginning.
        let layer = |z: i32| &self.layers[z.rem_euclid(KEPT as i32) as usize];
        let column = |row: &[f32], x: i32| row[x.clamp(0, row.len() as i32 - 1) as usize];
        for z in start[2]..start[2] + SIDE as i32 {
            for y in start[1]..start[1] + SIDE as i32 {
                let row = layer(z).row(y as isize);
                let beside = [
                    layer(z).row(y as isize - 1),
                    layer(z).row(y as isize + 1),
                    layer(z - 1).row(y as isize),
                    layer(z + 1).row(y as isize),
                ];
                samples.extend((start[0]..start[0] + SIDE as i32).map(|x| {
                    let around = column(row, x - 1) + column(row, x + 1);
                    let around = beside.iter().fold(around, |sum, row| sum + column(row, x));
                    (column(row, x) - 0.125 * (around - 6.0 * column(row, x))).clamp(0.0, self.top)
                }));
            }
        }
        VoxelBrick { key, samples }
    }
}
