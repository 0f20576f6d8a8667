//! Where overhangs begin between two layers.
//!
//! One step of the sweep lets a level spread by the whole reach, as if it had been held up by the layer below from
//! the start. Where a flat underside begins only half way up to the next layer, the level cannot have begun to
//! spread before: it goes along paths through the field between both layers, and is no greater than the least value
//! on the way.

use super::disc::Layer;
use blobtree::ISO;

/// Places looked at on a path.
const STEPS: usize = 7;

/// By how much of a layer the field on a path lags behind: what interpolation gets wrong must not let an overhang
/// begin too early, which would show as a ledge. Half of this leaves ledges of 0.02 mm beyond the reach in layers of
/// 0.25 mm under a ball on a stem; twice of it costs as much shape again.
pub(super) const DELAY: f32 = 0.25;

/// By how much what is outside in the layer below counts as further outside: below a flat underside the field may be
/// hardly less than ½, and interpolation would move the outline there by most of a lattice step.
pub(super) const GAP: f32 = 0.01;

/// Cosine and sine of the 16 directions of the disc, in the order of their angle.
const DIRECTIONS: [[f32; 2]; 16] = [
    [1.0, 0.0],
    [0.923_879_5, 0.382_683_43],
    [0.707_106_77, 0.707_106_77],
    [0.382_683_43, 0.923_879_5],
    [0.0, 1.0],
    [-0.382_683_43, 0.923_879_5],
    [-0.707_106_77, 0.707_106_77],
    [-0.923_879_5, 0.382_683_43],
    [-1.0, 0.0],
    [-0.923_879_5, -0.382_683_43],
    [-0.707_106_77, -0.707_106_77],
    [-0.382_683_43, -0.923_879_5],
    [0.0, -1.0],
    [0.382_683_43, -0.923_879_5],
    [0.707_106_77, -0.707_106_77],
    [0.923_879_5, -0.382_683_43],
];

/// A layer with the one below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between<'a> {
    /// What the layer below carries.
    pub carried: &'a Layer,
    /// The field in the layer below, and in this one.
    pub fields: [&'a Layer; 2],
}

/// Three rows of three places around one.
type Patch = [[f32; 3]; 3];

impl Between<'_> {
    /// What the layer below carries at this place if every level must go there through the field, which lags behind by
    /// `delay` of a layer: `limit`, what it would carry otherwise, or less.
    pub fn limit(&self, x: usize, y: usize, limit: f32, delay: f32) -> f32 {
        let fields = self.fields.map(|layer| patch(layer, x, y));
        if fields[0].as_flattened().iter().all(|value| *value >= limit) {
            return limit;
        }
        let carried = patch(self.carried, x, y)
            .map(|row| row.map(|value| if value < ISO { value - GAP } else { value }));
        let straight_up = carried[1][1].min(way(&fields, [0.0; 2], delay));
        let along =
            |direction: &[f32; 2]| interpolated(&carried, *direction).min(way(&fields, *direction, delay));
        DIRECTIONS.iter().map(along).fold(straight_up, f32::max).min(limit)
    }
}

/// The least value on the way from `start`, relative to the middle of the lower layer, to the middle of the upper.
fn way(fields: &[Patch; 2], start: [f32; 2], delay: f32) -> f32 {
    (1..=STEPS).fold(f32::INFINITY, |least, step| {
        let up = step as f32 / (STEPS + 1) as f32;
        let at = start.map(|x| x * (1.0 - up));
        let late = (up - delay).max(0.0);
        let value = (1.0 - late) * interpolated(&fields[0], at) + late * interpolated(&fields[1], at);
        least.min(value)
    })
}

fn patch(layer: &Layer, x: usize, y: usize) -> Patch {
    let columns = [x.saturating_sub(1), x, (x + 1).min(layer.width - 1)];
    let rows = [y as isize - 1, y as isize, y as isize + 1];
    rows.map(|row| columns.map(|column| layer.row(row)[column]))
}

/// The bilinear value at a place within one step of the middle.
fn interpolated(patch: &Patch, at: [f32; 2]) -> f32 {
    let side = |x: f32| if x < 0.0 { 0 } else { 2 };
    let (column, row) = (side(at[0]), side(at[1]));
    let [x, y] = at.map(f32::abs);
    (1.0 - y) * ((1.0 - x) * patch[1][1] + x * patch[1][column])
        + y * ((1.0 - x) * patch[row][1] + x * patch[row][column])
}
