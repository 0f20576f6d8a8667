//! All layers of a region at once.

use super::TOP;
use super::disc::Layer;
use super::region::Region;
use rayon::prelude::*;

/// Values up to [`TOP`], in two bytes each.
#[derive(Debug)]
pub(super) struct Volume {
    pub sides: [usize; 3],
    values: Vec<u16>,
}

const STEPS: f32 = u16::MAX as f32 / TOP;

impl Volume {
    /// One without content.
    pub fn new(region: &Region) -> Self {
        Self { sides: region.sides, values: vec![0; region.sides.iter().product()] }
    }

    /// The layer of this number.
    pub fn layer(&self, layer: usize) -> Layer {
        let mut copy = Layer::new(self.sides[0], self.sides[1], 0.0);
        self.copy_layer(layer, &mut copy);
        copy
    }

    /// Copies the layer of this number.
    pub fn copy_layer(&self, layer: usize, to: &mut Layer) {
        let own = self.values[self.range(layer)].par_iter();
        to.values
            .par_iter_mut()
            .zip(own)
            .with_min_len(1 << 14)
            .for_each(|(to, value)| *to = f32::from(*value) / STEPS);
    }

    /// Puts a layer in its place.
    pub fn set_layer(&mut self, layer: usize, from: &Layer) {
        let range = self.range(layer);
        let own = self.values[range].par_iter_mut();
        own.zip(&from.values)
            .with_min_len(1 << 14)
            .for_each(|(value, from)| *value = (from * STEPS).round() as u16);
    }

    /// The value at a place.
    pub fn value(&self, [x, y, z]: [usize; 3]) -> f32 {
        f32::from(self.values[x + self.sides[0] * (y + self.sides[1] * z)]) / STEPS
    }

    /// Copies the values from a place on along x.
    pub fn copy_row(&self, [x, y, z]: [usize; 3], to: &mut [f32]) {
        let start = x + self.sides[0] * (y + self.sides[1] * z);
        let own = &self.values[start..start + to.len()];
        to.iter_mut().zip(own).for_each(|(to, value)| *to = f32::from(*value) / STEPS);
    }

    /// Sets the value at a place.
    pub fn set(&mut self, [x, y, z]: [usize; 3], value: f32) {
        self.values[x + self.sides[0] * (y + self.sides[1] * z)] = (value * STEPS).round() as u16;
    }

    /// Raises the value at a place to at least `value`.
    pub fn raise(&mut self, [x, y, z]: [usize; 3], value: f32) {
        let own = &mut self.values[x + self.sides[0] * (y + self.sides[1] * z)];
        *own = (*own).max((value * STEPS).round() as u16);
    }

    fn range(&self, layer: usize) -> std::ops::Range<usize> {
        let plane = self.sides[0] * self.sides[1];
        layer * plane..(layer + 1) * plane
    }
}
