//! Closest supporting paths: from every place the way down that comes to matter or to the bed soonest.

use super::volume::Volume;
use blobtree::ISO;

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
    /// Cost: a few operations for each place.
    pub fn new(volume: &Volume) -> Self {
        let sides = volume.sides;
        let mut map = Self { sides, costs: vec![0; sides.iter().product()] };
        for z in 1..sides[2] {
            for y in 0..sides[1] {
                for x in 0..sides[0] {
                    let cost = if volume.value([x, y, z]) >= ISO {
                        0
                    } else {
                        let [nx, ny] = map.next([x, y, z]);
                        map.cost([nx, ny, z - 1]).saturating_add(1)
                    };
                    map.costs[x + sides[0] * (y + sides[1] * z)] = cost;
                }
            }
        }
        map
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
