//! Thin parts get an inside.
//!
//! The field of something thin is hardly more than ½ anywhere. By the rule, every level of the field is carried by
//! itself, so what stands on it would keep no higher values, and after some dabs nothing would be left of either.

use crate::rebake::disc::Layer;
use blobtree::ISO;

/// The least value of a place, by how many steps it lies inside.
const INSIDE: [f32; 2] = [ISO + 0.06, ISO + 0.12];

/// Raises what lies inside a layer: the surface stays where it is.
pub(super) fn firm(layer: &mut Layer) {
    let mut inside: Vec<bool> = layer.values.iter().map(|value| *value >= ISO).collect();
    for least in INSIDE {
        inside = shrunk(&inside, layer.width);
        let values = layer.values.iter_mut().zip(&inside).filter(|(_, inside)| **inside);
        values.for_each(|(value, _)| *value = value.max(least));
    }
}

/// Places that have none outside beside them, corners included; beyond the border the last ones go on.
fn shrunk(layer: &[bool], width: usize) -> Vec<bool> {
    let along = |all: &[bool], step: usize, at: usize, most: usize, n: usize| {
        all[n] && (at == 0 || all[n - step]) && (at + 1 == most || all[n + step])
    };
    let along_x: Vec<bool> = (0..layer.len()).map(|n| along(layer, 1, n % width, width, n)).collect();
    (0..layer.len()).map(|n| along(&along_x, width, n / width, layer.len() / width, n)).collect()
}
