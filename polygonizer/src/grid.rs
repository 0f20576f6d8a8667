//! The samples of one brick, their signs, and the cells that the surface passes.

use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, ISO};
use glam::Vec3;

use crate::lattice::CELLS;
use crate::patches::{edge_start, face_is_uniform};

/// How far a vertex stays from the sides of the box it may move in, in cells. A surface in the outermost
/// corner of a cell is missed by √3 of it at most, which leaves room below 1 % of a cell.
pub(crate) const MARGIN: f32 = 1.0 / 256.0;

/// Which side of the surface a field value is on. Values that are no number are outside.
pub(crate) fn is_inside(value: f32) -> bool {
    value >= ISO
}

/// One patch of one cell of a brick: what a vertex is placed for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// The cell within the brick.
    pub cell: [u8; 3],
    /// The cell's corner configuration.
    pub config: u8,
    /// The patch's crossed edges, as bits.
    pub edges: u16,
    /// Whether the cell has other patches.
    pub shares_cell: bool,
}

impl Site {
    /// The numbers of the crossed edges.
    pub fn crossed_edges(self) -> impl Iterator<Item = usize> {
        bits(self.edges)
    }

    /// The sum of the directions in which its edges lead out of the solid.
    pub fn outward(self) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for edge in self.crossed_edges() {
            let start_is_inside = self.config >> edge_start(edge) & 1 == 1;
            sum[edge / 4] += if start_is_inside { 1.0 } else { -1.0 };
        }
        sum
    }
}

/// The positions of the set bits.
#[inline]
pub(crate) fn bits(mut word: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (bit < 16).then_some(bit as usize)
    })
}

/// The index of a sample of a brick.
pub(crate) const fn sample_index(at: [usize; 3]) -> usize {
    (at[2] * BRICK + at[1]) * BRICK + at[0]
}

/// A brick's samples and signs. Reused from brick to brick.
pub(crate) struct Grid {
    /// Which brick they belong to.
    pub brick: Brick,
    /// As [`blobtree::Sampler::fill`] leaves them.
    pub values: Box<[f32; BRICK_SAMPLES]>,
    /// Bit x of word `z · 16 + y` is set where sample `[x, y, z]` is inside.
    rows: [u16; BRICK * BRICK],
    /// Coordinates of the samples along each axis, mm.
    coordinates: [[f32; BRICK]; 3],
}

impl Grid {
    pub fn new() -> Self {
        Self {
            brick: Brick { origin: [0; 3], spacing: 1.0 },
            values: Box::new([0.0; BRICK_SAMPLES]),
            rows: [0; BRICK * BRICK],
            coordinates: [[0.0; BRICK]; 3],
        }
    }

    /// Turns to another brick; values and signs are still those of the last one.
    pub fn move_to(&mut self, brick: Brick) {
        self.brick = brick;
        for i in 0..BRICK {
            let point = brick.point([i; 3]);
            for axis in 0..3 {
                self.coordinates[axis][i] = point[axis];
            }
        }
    }

    /// Takes the signs of `values`. Returns whether the surface passes the brick at all.
    pub fn read_signs(&mut self) -> bool {
        for (row, values) in self.rows.iter_mut().zip(self.values.chunks_exact(BRICK)) {
            *row = values.iter().enumerate().fold(0, |bits, (x, &v)| bits | u16::from(is_inside(v)) << x);
        }
        let any = self.rows.iter().fold(0, |a, r| a | r);
        let all = self.rows.iter().fold(u16::MAX, |a, r| a & r);
        any != 0 && all != u16::MAX
    }

    /// The cells of row `[y, z]` with corners on both sides, as bits.
    pub fn mixed_cells(&self, y: usize, z: usize) -> u16 {
        let rows = self.rows_around(y, z);
        let any = rows[0] | rows[1] | rows[2] | rows[3];
        let all = rows[0] & rows[1] & rows[2] & rows[3];
        (any | any >> 1) & !(all & all >> 1) & ((1 << CELLS) - 1)
    }

    /// The corner configuration of a cell.
    pub fn config(&self, [x, y, z]: [usize; 3]) -> u8 {
        let pair = |row: u16| (row >> x & 3) as u8;
        let [a, b, c, d] = self.rows_around(y, z).map(pair);
        a | b << 2 | c << 4 | d << 6
    }

    fn rows_around(&self, y: usize, z: usize) -> [u16; 4] {
        let first = z * BRICK + y;
        [first, first + 1, first + BRICK, first + BRICK + 1].map(|row| self.rows[row])
    }

    /// The position of a sample or cell corner.
    pub fn point(&self, at: [usize; 3]) -> Vec3 {
        Vec3::new(self.coordinates[0][at[0]], self.coordinates[1][at[1]], self.coordinates[2][at[2]])
    }

    /// The value at a sample.
    pub fn value(&self, at: [usize; 3]) -> f32 {
        self.values[sample_index(at)]
    }

    /// Where the surface crosses the lattice edge from sample `at` along `axis` if the field is linear
    /// there, from 0 to 1 along it.
    #[inline]
    pub fn linear_crossing(&self, at: [usize; 3], axis: usize) -> f32 {
        let first = sample_index(at);
        let (from, to) = (self.values[first], self.values[first + [1, BRICK, BRICK * BRICK][axis]]);
        let t = (ISO - from) / (to - from);
        // Not a number only if the field has values that are none, or infinite.
        if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 }
    }

    /// The x of all crossed lattice edges along `axis` that start in row `[y, z]` of samples.
    pub fn crossed_edges(&self, axis: usize, y: usize, z: usize) -> impl Iterator<Item = usize> + use<> {
        let row = |y: usize, z: usize| self.rows[z * BRICK + y];
        let own = row(y, z);
        bits(match axis {
            0 => (own ^ own >> 1) & ((1 << CELLS) - 1),
            1 if y < CELLS => own ^ row(y + 1, z),
            2 if z < CELLS => own ^ row(y, z + 1),
            _ => 0,
        })
    }

    /// The mean of a site's linear crossings.
    pub fn mean_crossing(&self, site: Site) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for edge in site.crossed_edges() {
            let (axis, start) = (edge / 4, edge_start(edge));
            sum += Vec3::from_array([0, 1, 2].map(|a| (start >> a & 1) as f32));
            sum[axis] += self.linear_crossing(corner(site.cell, start), axis);
        }
        self.point(corner(site.cell, 0)) + sum * (self.brick.spacing / site.edges.count_ones() as f32)
    }

    /// The cell less a margin: where a smooth vertex may lie.
    pub fn own_box(&self, cell: [u8; 3]) -> Aabb {
        let margin = self.brick.spacing * MARGIN;
        Aabb { min: self.point(corner(cell, 0)) + margin, max: self.point(corner(cell, 7)) - margin }
    }

    /// [`Self::own_box`] and one cell more on every side: where a bold vertex may lie.
    pub fn bold_box(&self, cell: [u8; 3]) -> Aabb {
        self.own_box(cell).grown(self.brick.spacing)
    }

    /// The place of a point among the cells around `cell`: its own is 0, the next ones are ± 1.
    pub fn step_to(&self, cell: [u8; 3], point: Vec3) -> [i32; 3] {
        let (low, high) = (self.point(corner(cell, 0)), self.point(corner(cell, 7)));
        std::array::from_fn(|a| i32::from(point[a] > high[a]) - i32::from(point[a] < low[a]))
    }

    /// [`Self::own_box`] and one cell more beyond every face that no edge of crosses the surface.
    ///
    /// Seen along any crossed edge of its cell, a vertex in there stays in its quadrant: the four vertices
    /// around an edge always make a star-shaped polygon, of which one diagonal gives two proper triangles.
    pub fn feature_box(&self, cell: [u8; 3], config: u8) -> Aabb {
        let mut allowed = self.own_box(cell);
        for axis in 0..3 {
            if face_is_uniform(config, 2 * axis) {
                allowed.min[axis] -= self.brick.spacing;
            }
            if face_is_uniform(config, 2 * axis + 1) {
                allowed.max[axis] += self.brick.spacing;
            }
        }
        allowed
    }
}

/// The sample at corner `number` of `cell`.
#[inline]
pub(crate) fn corner(cell: [u8; 3], number: usize) -> [usize; 3] {
    std::array::from_fn(|a| usize::from(cell[a]) + (number >> a & 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_cells_are_exactly_those_with_both_signs() {
        let mut grid = Grid::new();
        let mut state = 7_u32;
        for value in grid.values.iter_mut() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *value = if state >> 28 < 2 { 1.0 } else { 0.0 };
        }
        assert!(grid.read_signs());
        for z in 0..CELLS {
            for y in 0..CELLS {
                for x in 0..CELLS {
                    let cell = [x as u8, y as u8, z as u8];
                    let config =
                        (0..8).fold(0, |c, i| c | u8::from(is_inside(grid.value(corner(cell, i)))) << i);
                    assert_eq!(grid.config([x, y, z]), config);
                    assert_eq!(grid.mixed_cells(y, z) >> x & 1 == 1, config != 0 && config != 255);
                }
            }
        }
    }
}
