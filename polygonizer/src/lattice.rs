//! Where cells, bricks and blocks of bricks lie: plain integer arithmetic on the world lattice.

use blobtree::{Aabb, BRICK, Brick};

/// Cells along each side of a brick; its samples are one more, shared with the next brick.
pub(crate) const CELLS: usize = BRICK - 1;

/// Bricks along each side of a block, the coarse region that is bounded before its bricks.
const BLOCK: i32 = 4;

/// Bricks in a block.
pub(crate) const BRICKS_PER_BLOCK: usize = (BLOCK * BLOCK * BLOCK) as usize;

/// Lattice indices stay within ± this, so that `f32` keeps a 512th of a cell everywhere.
pub(crate) const MAX_INDEX: i32 = 1 << 15;

/// The place of a brick, in bricks from the origin.
pub(crate) type BrickKey = [i32; 3];

/// The lattice of one cell size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    /// Cell size, mm.
    pub spacing: f32,
}

impl Lattice {
    /// The samples of the brick at `key`.
    pub fn brick(self, key: BrickKey) -> Brick {
        Brick { origin: key.map(|k| k * CELLS as i32), spacing: self.spacing }
    }

    /// The box that the brick at `key` can depend on: its cells and one cell more on every side.
    pub fn apron(self, key: BrickKey) -> Aabb {
        self.box_of_cells(key, 1)
    }

    /// The region of a whole block, with one cell more on every side.
    pub fn block_region(self, block: [i32; 3]) -> Aabb {
        self.box_of_cells(block.map(|b| b * BLOCK), BLOCK)
    }

    fn box_of_cells(self, first: BrickKey, bricks: i32) -> Aabb {
        let low = first.map(|k| k * CELLS as i32 - 1);
        let high = first.map(|k| (k + bricks) * CELLS as i32 + 1);
        Aabb { min: Brick::lattice_point(low, self.spacing), max: Brick::lattice_point(high, self.spacing) }
    }

    /// The bricks whose aprons can meet `region`; `None` when it is empty or leaves ± [`MAX_INDEX`] cells.
    pub fn bricks_within_reach(self, region: Aabb) -> Option<BrickRange> {
        let limit = (MAX_INDEX - 2 * BLOCK * CELLS as i32) as f32 * self.spacing;
        let reachable = region.min.min_element() >= -limit && region.max.max_element() <= limit;
        (reachable && !region.is_empty()).then(|| self.bricks_near(region))
    }

    /// The bricks whose aprons can meet `region`, which must not reach beyond those of
    /// [`Self::bricks_within_reach`].
    pub fn bricks_near(self, region: Aabb) -> BrickRange {
        // In f64 the quotient is exact enough that one spare cell covers its rounding.
        let index = |x: f32| (f64::from(x) / f64::from(self.spacing)).floor() as i32;
        BrickRange {
            low: region.min.to_array().map(|x| (index(x) - 2).div_euclid(CELLS as i32)),
            high: region.max.to_array().map(|x| (index(x) + 2).div_euclid(CELLS as i32)),
        }
    }

    /// What the aprons of all bricks in `range` cover.
    pub fn region_of(self, range: BrickRange) -> Aabb {
        self.apron(range.low).union(&self.apron(range.high))
    }
}

/// The block that the brick at `key` belongs to.
pub(crate) fn block_of(key: BrickKey) -> [i32; 3] {
    key.map(|k| k.div_euclid(BLOCK))
}

/// A box of bricks, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BrickRange {
    low: BrickKey,
    high: BrickKey,
}

impl BrickRange {
    /// The blocks that hold any of these bricks.
    pub fn blocks(self) -> Self {
        Self { low: block_of(self.low), high: block_of(self.high) }
    }

    /// How many keys there are.
    pub fn count(self) -> u64 {
        (0..3).map(|a| (self.high[a] - self.low[a] + 1).max(0) as u64).product()
    }

    /// The keys in both.
    pub fn intersection(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|a| self.low[a].max(other.low[a])),
            high: std::array::from_fn(|a| self.high[a].min(other.high[a])),
        }
    }

    /// Brick number `n` of the [`BRICKS_PER_BLOCK`] of `block`, if it is in this range.
    pub fn in_block(self, block: [i32; 3], n: usize) -> Option<BrickKey> {
        let n = n as i32;
        let within = [n % BLOCK, n / BLOCK % BLOCK, n / (BLOCK * BLOCK)];
        let key: BrickKey = std::array::from_fn(|a| block[a] * BLOCK + within[a]);
        (0..3).all(|a| (self.low[a]..=self.high[a]).contains(&key[a])).then_some(key)
    }

    /// All keys, x fastest.
    pub fn iter(self) -> impl Iterator<Item = BrickKey> {
        let Self { low, high } = self;
        (low[2]..=high[2])
            .flat_map(move |z| (low[1]..=high[1]).map(move |y| (y, z)))
            .flat_map(move |(y, z)| (low[0]..=high[0]).map(move |x| [x, y, z]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn every_brick_whose_apron_meets_a_box_is_near_it() {
        let lattice = Lattice { spacing: 0.3 };
        let region = Aabb { min: Vec3::new(-14.2, 0.0, 4.5), max: Vec3::new(-4.5, 4.2, 9.1) };
        let near = lattice.bricks_within_reach(region).expect("small region");
        let all = BrickRange { low: [-6; 3], high: [6; 3] };
        for key in all.iter().filter(|&key| lattice.apron(key).overlaps(&region)) {
            assert!(near.iter().any(|k| k == key), "{key:?} is missing");
        }
    }

    #[test]
    fn blocks_hold_each_brick_once() {
        let range = BrickRange { low: [-5, -1, 3], high: [6, 2, 9] };
        let mut seen: Vec<_> = range
            .blocks()
            .iter()
            .flat_map(|b| (0..BRICKS_PER_BLOCK).filter_map(move |n| range.in_block(b, n)))
            .collect();
        assert_eq!(seen.len() as u64, range.count());
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len() as u64, range.count());
    }

    #[test]
    fn boxes_too_far_away_or_not_finite_have_no_bricks() {
        let lattice = Lattice { spacing: 0.1 };
        for x in [1e9, f32::INFINITY, f32::NAN] {
            assert_eq!(lattice.bricks_within_reach(Aabb { min: Vec3::ZERO, max: Vec3::splat(x) }), None);
        }
        assert_eq!(lattice.bricks_within_reach(Aabb::EMPTY), None);
    }
}
