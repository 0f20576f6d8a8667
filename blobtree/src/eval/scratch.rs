//! Buffers that are used again and again, so that evaluation does not allocate.

use super::places::{Cloud, ROW};
use crate::scalar::Slope;

/// Values in rows.
pub(crate) type Values = Vec<[f32; ROW]>;

/// Values and gradients in rows.
#[derive(Debug, Default)]
pub(crate) struct Slopes {
    pub value: Values,
    pub gradient: [Values; 3],
    pub piece: Vec<[u32; ROW]>,
}

impl Slopes {
    pub fn resize(&mut self, rows: usize) {
        self.value.resize(rows, [0.0; ROW]);
        for along in &mut self.gradient {
            along.resize(rows, [0.0; ROW]);
        }
        self.piece.resize(rows, [0; ROW]);
    }

    /// One row, by value: loops over rows in hand need not fear that buffers overlap.
    #[inline(always)]
    pub fn row(&self, r: usize) -> SlopeRow {
        let [x, y, z] = &self.gradient;
        SlopeRow { value: self.value[r], gradient: [x[r], y[r], z[r]], piece: self.piece[r] }
    }

    #[inline(always)]
    pub fn set_row(&mut self, r: usize, row: &SlopeRow) {
        self.value[r] = row.value;
        for (along, x) in self.gradient.iter_mut().zip(row.gradient) {
            along[r] = x;
        }
        self.piece[r] = row.piece;
    }

    #[inline(always)]
    pub fn get(&self, r: usize, i: usize) -> Slope<f32> {
        let [x, y, z] = &self.gradient;
        Slope::new(self.value[r][i], [x[r][i], y[r][i], z[r][i]]).on(self.piece[r][i])
    }

    #[inline(always)]
    pub fn set(&mut self, r: usize, i: usize, slope: Slope<f32>) {
        self.value[r][i] = slope.value;
        self.piece[r][i] = slope.piece;
        for (along, x) in self.gradient.iter_mut().zip(slope.gradient) {
            along[r][i] = x;
        }
    }
}

/// Values and gradients of one row.
#[derive(Clone, Copy)]
pub(crate) struct SlopeRow {
    pub value: [f32; ROW],
    pub gradient: [[f32; ROW]; 3],
    pub piece: [u32; ROW],
}

impl SlopeRow {
    pub const ZERO: Self = Self { value: [0.0; ROW], gradient: [[0.0; ROW]; 3], piece: [0; ROW] };

    #[inline(always)]
    pub fn get(&self, i: usize) -> Slope<f32> {
        let [x, y, z] = &self.gradient;
        Slope::new(self.value[i], [x[i], y[i], z[i]]).on(self.piece[i])
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, slope: Slope<f32>) {
        self.value[i] = slope.value;
        for (along, x) in self.gradient.iter_mut().zip(slope.gradient) {
            along[i] = x;
        }
        self.piece[i] = slope.piece;
    }
}

/// What is not in use.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    values: Vec<Values>,
    slopes: Vec<Slopes>,
    clouds: Vec<Cloud>,
}

impl Scratch {
    pub fn take_values(&mut self, rows: usize) -> Values {
        let mut values = self.values.pop().unwrap_or_default();
        values.resize(rows, [0.0; ROW]);
        values
    }

    pub fn give_values(&mut self, values: Values) {
        self.values.push(values);
    }

    pub fn take_slopes(&mut self, rows: usize) -> Slopes {
        let mut slopes = self.slopes.pop().unwrap_or_default();
        slopes.resize(rows);
        slopes
    }

    pub fn give_slopes(&mut self, slopes: Slopes) {
        self.slopes.push(slopes);
    }

    pub fn take_cloud(&mut self, rows: usize) -> Cloud {
        let mut cloud = self.clouds.pop().unwrap_or_default();
        cloud.resize(rows);
        cloud
    }

    pub fn give_cloud(&mut self, cloud: Cloud) {
        self.clouds.push(cloud);
    }
}
