//! A place that hangs in the air, as places to dent.

use crate::slices::clip::{Region, area, pairs};
use crate::slices::grid::Grid;
use glam::{DVec2, DVec3};

/// A connected place of a layer that nothing carries.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Piece {
    /// Places on its rim and inside it, mm.
    pub places: Vec<DVec3>,
    /// mm².
    pub area: f64,
    /// Whether it is all of a region that shares no area with what is carried below.
    pub island: bool,
}

impl Piece {
    /// A region at height `z`, mm; places are no farther apart than `pitch`, mm.
    pub(super) fn new(region: &Region, island: bool, z: f64, grid: &Grid, pitch: f64) -> Self {
        let places = places(region, grid, pitch).into_iter().map(|place| place.extend(z)).collect();
        Self { places, area: grid.square_mm(area(region)), island }
    }
}

/// Places along the rim of a region and on lines through it, no two neighbours farther apart than `pitch`, mm.
fn places(region: &Region, grid: &Grid, pitch: f64) -> Vec<DVec2> {
    let sides: Vec<[DVec2; 2]> =
        region.iter().flat_map(|ring| pairs(ring)).map(|(a, b)| [grid.place(a), grid.place(b)]).collect();
    let mut places = Vec::new();
    for [a, b] in &sides {
        let parts = (a.distance(*b) / pitch).ceil().max(1.0) as usize;
        places.extend((0..parts).map(|i| a.lerp(*b, i as f64 / parts as f64)));
    }
    let ends = sides
        .iter()
        .flatten()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p.y), high.max(p.y)]);
    let rows = (ends[0] / pitch).ceil() as i64..=(ends[1] / pitch).floor() as i64;
    for y in rows.map(|row| row as f64 * pitch) {
        let crossing = |[a, b]: &[DVec2; 2]| {
            ((a.y <= y) != (b.y <= y)).then(|| a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y))
        };
        let mut crossings: Vec<f64> = sides.iter().filter_map(crossing).collect();
        crossings.sort_by(f64::total_cmp);
        for span in crossings.chunks_exact(2) {
            let columns = (span[0] / pitch).ceil() as i64..=(span[1] / pitch).floor() as i64;
            places.extend(columns.map(|column| DVec2::new(column as f64 * pitch, y)));
        }
    }
    places
}
