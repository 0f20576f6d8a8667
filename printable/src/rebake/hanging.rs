//! What hangs in the air, by exact slices.

use crate::slices::Slices;
use crate::slices::clip::{Clipper, Rect, Region, area, grown, pairs, perimeter, thinned, total};
use crate::slices::grid::Grid;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// What is narrower than this many steps of the grid, on average, comes from rounding.
const ROUNDING: f64 = 4.0;

/// A connected place of a layer that nothing carries.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    /// Places on its rim and inside it, mm.
    pub places: Vec<DVec3>,
    /// mm².
    pub area: f64,
    /// Whether it is all of a region that shares no area with what is carried below.
    pub island: bool,
}

/// What every layer lacks.
#[derive(Debug)]
pub(super) struct Hanging {
    /// mm.
    reach: f64,
    /// Of each layer, what the one below, as it is, does not carry; and whether that is all of a region.
    lacks: Vec<Lacks>,
}

type Lacks = Vec<(Region, bool)>;

impl Hanging {
    /// What lies farther than `reach`, mm, from the layer below.
    ///
    /// Promises: the same for any number of threads.
    pub fn new(slices: &Slices, reach: f64) -> Self {
        let all: Vec<usize> = (0..slices.layers.len()).collect();
        let mut hanging = Self { reach, lacks: vec![Lacks::new(); all.len()] };
        hanging.renew(slices, &all);
        hanging
    }

    /// Follows the slices after a change of these layers, in ascending order.
    pub fn renew(&mut self, slices: &Slices, changed: &[usize]) {
        let mut stale: Vec<usize> = changed.iter().flat_map(|layer| [*layer, layer + 1]).collect();
        stale.dedup();
        stale.retain(|layer| *layer < self.lacks.len());
        let reach = self.reach;
        let lacking = |clipper: &mut Clipper, layer: &usize| {
            let below = layer.checked_sub(1).map(|below| &slices.layers[below].regions);
            let Some(below) = below else { return Lacks::new() };
            Carrier { grid: &slices.grid, reach, clipper }.lacking(&slices.layers[*layer].regions, below)
        };
        let lacks: Vec<Lacks> = stale.par_iter().map_init(Clipper::new, lacking).collect();
        for (layer, lacks) in stale.into_iter().zip(lacks) {
            self.lacks[layer] = lacks;
        }
    }

    /// All that must go for every layer to lie within reach of what is left of the one below, from the bottom up.
    ///
    /// - **In:** `pitch`, how far apart places of a piece may be, mm.
    /// - **Promises:** the same for any number of threads.
    pub fn pieces(&self, slices: &Slices, pitch: f64) -> Vec<Piece> {
        let mut lacks = self.lacks.clone();
        // Where something goes, the layer above lacks more.
        let mut clipper = Clipper::new();
        let mut left: Option<Vec<Region>> = None;
        for (layer, lacks) in lacks.iter_mut().enumerate() {
            let regions = &slices.layers[layer].regions;
            if let Some(left) = left {
                let mut carrier = Carrier { grid: &slices.grid, reach: self.reach, clipper: &mut clipper };
                *lacks = carrier.lacking(regions, &left);
            }
            let gone: Vec<Region> = lacks.iter().map(|(region, _)| region.clone()).collect();
            let mut rest = |gone: &[Region]| thinned(&clipper.difference(regions, gone), slices.grid.step);
            left = (!gone.is_empty()).then(|| rest(&gone));
        }
        let pieces = |(layer, lacks): (usize, &Lacks)| {
            let z = slices.planes.heights[layer];
            let piece = |(region, island): &(Region, bool)| Piece {
                places: places(region, &slices.grid, pitch).into_iter().map(|p| p.extend(z)).collect(),
                area: slices.grid.square_mm(area(region)),
                island: *island,
            };
            lacks.iter().map(piece).collect::<Vec<_>>()
        };
        lacks.par_iter().enumerate().flat_map_iter(pieces).collect()
    }
}

/// What finds out what one layer lacks.
struct Carrier<'a> {
    grid: &'a Grid,
    reach: f64,
    clipper: &'a mut Clipper,
}

impl Carrier<'_> {
    /// What of a layer the one below does not carry; and whether that is all of a region.
    fn lacking(&mut self, regions: &[Region], below: &[Region]) -> Vec<(Region, bool)> {
        let mut beyond = self.clipper.difference(regions, below);
        beyond.retain(|region| !is_rounding(area(region), perimeter(region)));
        let free = total(&beyond);
        let (mut islands, mut others) = (Vec::new(), Vec::new());
        for region in regions {
            let rim = perimeter(region);
            let mut shared = || self.clipper.intersection(std::slice::from_ref(region), below);
            match area(region) <= free + ROUNDING * rim && is_rounding(total(&shared()), rim) {
                true => islands.push(region.clone()),
                false => others.push(region),
            }
        }
        if !islands.is_empty() {
            beyond = self.clipper.difference(&beyond, &islands);
        }
        let hanging = self.beyond_reach(beyond, below);
        let hanging = hanging.into_iter().map(|region| (region, false));
        islands.into_iter().map(|region| (region, true)).chain(hanging).collect()
    }

    /// What of these regions is farther than the reach from the layer below.
    fn beyond_reach(&mut self, beyond: Vec<Region>, below: &[Region]) -> Vec<Region> {
        let steps = self.grid.steps(self.reach);
        // What touches the layer below, and is nowhere longer than its reach, is within reach.
        let long = |region: &Region| Rect::around([region]).is_some_and(|rect| rect.diagonal() > steps);
        let long: Vec<Region> = beyond.into_iter().filter(long).collect();
        let Some(rect) = Rect::around(&long) else { return long };
        let near = |region: &&Region| {
            Rect::around([*region]).is_some_and(|other| rect.is_near(&other, steps.ceil() as i32))
        };
        let holding: Vec<Region> = below.iter().filter(near).cloned().collect();
        if holding.is_empty() {
            return long;
        }
        let mut hanging = self.clipper.difference(&long, &grown(&holding, self.reach, self.grid.step));
        hanging.retain(|region| !is_rounding(area(region), perimeter(region)));
        hanging
    }
}

/// Whether an area, in square steps, is no wider along a rim of so many steps than rounding explains.
fn is_rounding(area: f64, rim: f64) -> bool {
    2.0 * area <= ROUNDING * rim
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
