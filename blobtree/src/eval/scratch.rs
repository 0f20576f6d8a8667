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
