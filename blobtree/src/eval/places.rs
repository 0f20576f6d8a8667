//! Batches of places, in rows of 16: bricks of the lattice, and clouds of any points.

use crate::field::{BRICK, Brick};

/// Places in a row: what is computed in one go.
pub(crate) const ROW: usize = BRICK;

/// A batch of places.
pub(crate) trait Places {
    type Row<'a>: Row
    where
        Self: 'a;
    fn rows(&self) -> usize;
    fn row(&self, r: usize) -> Self::Row<'_>;
}

/// One row of a batch.
pub(crate) trait Row: Copy {
    fn place(&self, i: usize) -> [f32; 3];
}

/// The samples of a brick: coordinates along each axis.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    pub along: [[f32; BRICK]; 3],
}

impl Axes {
    pub fn new(brick: &Brick) -> Self {
        let along = |a: usize| std::array::from_fn(|i| (brick.origin[a] + i as i32) as f32 * brick.spacing);
        Self { along: [along(0), along(1), along(2)] }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct AxesRow<'a> {
    x: &'a [f32; BRICK],
    y: f32,
    z: f32,
}

impl Places for Axes {
    type Row<'a> = AxesRow<'a>;

    fn rows(&self) -> usize {
        BRICK * BRICK
    }

    #[inline(always)]
    fn row(&self, r: usize) -> AxesRow<'_> {
        AxesRow { x: &self.along[0], y: self.along[1][r % BRICK], z: self.along[2][r / BRICK] }
    }
}

impl Row for AxesRow<'_> {
    #[inline(always)]
    fn place(&self, i: usize) -> [f32; 3] {
        [self.x[i], self.y, self.z]
    }
}

/// Any points, coordinate by coordinate, in whole rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cloud {
    pub along: [Vec<[f32; ROW]>; 3],
}

#[derive(Clone, Copy)]
pub(crate) struct CloudRow<'a> {
    along: [&'a [f32; ROW]; 3],
}

impl Cloud {
    /// Makes room for this many rows; what they hold is left to be written.
    pub fn resize(&mut self, rows: usize) {
        for along in &mut self.along {
            along.resize(rows, [0.0; ROW]);
        }
    }

    #[inline(always)]
    pub fn set(&mut self, r: usize, i: usize, place: [f32; 3]) {
        for (along, x) in self.along.iter_mut().zip(place) {
            along[r][i] = x;
        }
    }
}

impl Places for Cloud {
    type Row<'a> = CloudRow<'a>;

    fn rows(&self) -> usize {
        self.along[0].len()
    }

    #[inline(always)]
    fn row(&self, r: usize) -> CloudRow<'_> {
        CloudRow { along: [&self.along[0][r], &self.along[1][r], &self.along[2][r]] }
    }
}

impl Row for CloudRow<'_> {
    #[inline(always)]
    fn place(&self, i: usize) -> [f32; 3] {
        [self.along[0][i], self.along[1][i], self.along[2][i]]
    }
}
