//! Closest supporting paths: from every place the way down that comes to matter or to the bed soonest.

use super::disc::Layer;
use super::volume::Volume;
use blobtree::ISO;
use rayon::prelude::*;

/// Places that one thread is done with sooner than another one is found.
const ALONE: usize = 1 << 13;

/// Layers from every place down to what carries.
///
/// **Source:** Reiner & Lefebvre 2016, §3.2, "path map". **Departs:** the cost counts layers to the nearest matter
/// anywhere below, not the distance on the ground; and a path moves along one axis at a time, as a step along both
/// would lean by more than the rule allows.
#[derive(Debug)]
pub(super) struct PathMap {
    sides: [usize; 3],
    costs: Vec<u16>,
}

impl PathMap {
    /// - **Promises:** the same for any number of threads.
    /// - **Cost:** a few operations for each place.
    pub fn new(volume: &Volume) -> Self {
        let [width, depth, layers] = volume.sides;
        let mut costs = vec![0u16; width * depth * layers];
        let mut solid = Layer::new(width, depth, 0.0);
        for z in 1..layers {
            volume.copy_layer(z, &mut solid);
            let (below, own) = costs.split_at_mut(z * width * depth);
            let below = &below[(z - 1) * width * depth..];
            let rows = own[..width * depth].par_chunks_mut(width).zip(solid.values.par_chunks(width));
            rows.enumerate().with_min_len(ALONE / width + 1).for_each(|(y, (own, solid))| {
                let row = |y: usize| &below[y * width..(y + 1) * width];
                let (before, here, after) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(depth - 1)));
                for (x, (own, solid)) in own.iter_mut().zip(solid).enumerate() {
                    if *solid < ISO {
                        let along = here[x].min(here[x.saturating_sub(1)]).min(here[(x + 1).min(width - 1)]);
                        *own = along.min(before[x]).min(after[x]).saturating_add(1);
                    }
                }
            });
        }
        Self { sides: volume.sides, costs }
    }

    /// Layers from this place down to matter or to the bed.
    pub fn cost(&self, [x, y, z]: [usize; 3]) -> u16 {
        self.costs[x + self.sides[0] * (y + self.sides[1] * z)]
    }

    /// Where in the layer below the path goes from a place above the first layer: straight down unless that takes
    /// longer.
    pub fn next(&self, [x, y, z]: [usize; 3]) -> [usize; 2] {
        let beside = [
            [x, y],
            [x.saturating_sub(1), y],
            [(x + 1).min(self.sides[0] - 1), y],
            [x, y.saturating_sub(1)],
            [x, (y + 1).min(self.sides[1] - 1)],
        ];
        let cost = |[x, y]: [usize; 2]| self.cost([x, y, z - 1]);
        beside.into_iter().fold([x, y], |best, other| if cost(other) < cost(best) { other } else { best })
    }
}
