//! Equation 1, layer by layer.

use super::CheckSettings;
use super::excess::{Held, farthest};
use crate::slices::clip::{Clipper, ROUNDING, Region, area, grown, is_rounding, perimeter, total};
use crate::slices::rect::Rect;
use crate::slices::{Layer, SliceError, Slices, Tally, Watch};
use glam::DVec3;
use rayon::prelude::*;

/// Hanging places kept of each layer, the largest ones.
const MOST_SPOTS: usize = 20;
/// Hanging places smaller than this are counted but not listed, mm².
const SMALLEST_SPOT: f64 = 1e-4;

/// What one layer needs of the one below.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerCheck {
    /// Height at which it was looked at, mm.
    pub z: f64,
    /// Its area, mm².
    pub area: f64,
    /// Its connected regions.
    pub regions: usize,
    /// Area beyond the reach of the layer below, mm².
    pub unsupported: f64,
    /// The part of that which is wider than [`CheckSettings::sliver_mm`], mm².
    pub wide: f64,
    /// Regions that share no area with the layer below.
    pub islands: usize,
    /// Islands that also lie farther from the layer below than its reach.
    pub detached: usize,
    /// Outlines that do not close.
    pub open_outlines: usize,
}

/// One connected place where a layer hangs in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its layer, counted from 0.
    pub layer: usize,
    /// Its point that is farthest from the layer below, mm.
    pub place: DVec3,
    /// Unsupported area; for islands the whole area, mm².
    pub area: f64,
    /// How far it reaches beyond what the layer below holds, mm; none if nothing is below. At islands near the layer
    /// below it can be negative.
    pub excess: Option<f64>,
    /// Whether it is a region that shares no area with the layer below.
    pub island: bool,
}

/// A layer's numbers and places.
pub(super) struct Judged {
    pub(super) layer: LayerCheck,
    pub(super) spots: Vec<Spot>,
}

/// Judges all layers. Errors: [`SliceError::Cancelled`].
pub(super) fn judge(
    slices: &Slices,
    settings: &CheckSettings,
    watch: &Watch,
) -> Result<Vec<Judged>, SliceError> {
    let tally = Tally::new(watch, slices.layers.len());
    let judge = |clipper: &mut Clipper, layer: usize| {
        if watch.is_cancelled() {
            return Err(SliceError::Cancelled);
        }
        let judged = Judge { slices, settings, clipper, layer }.judge();
        tally.step();
        Ok(judged)
    };
    (0..slices.layers.len()).into_par_iter().map_init(Clipper::new, judge).collect()
}

/// One layer before the court.
struct Judge<'a> {
    slices: &'a Slices,
    settings: &'a CheckSettings,
    clipper: &'a mut Clipper,
    layer: usize,
}

impl Judge<'_> {
    fn judge(&mut self) -> Judged {
        let Layer { regions, open } = &self.slices.layers[self.layer];
        let mut layer = LayerCheck {
            z: self.slices.planes.heights[self.layer],
            area: self.slices.area(self.layer),
            regions: regions.len(),
            open_outlines: open.len(),
            ..LayerCheck::default()
        };
        let mut spots = Vec::new();
        if let Some(below) = self.layer.checked_sub(1).map(|below| &self.slices.layers[below].regions) {
            let beyond = self.beyond(regions, below);
            let islands = self.islands(regions, below, &beyond);
            let unsupported = self.unsupported(&beyond, &islands, below);
            layer.unsupported = self.square_mm(&unsupported);
            layer.wide = self.wide(&unsupported);
            layer.islands = islands.len();
            layer.detached = islands.iter().filter(|island| self.covers(&unsupported, island)).count();
            spots = self.spots(&unsupported, &islands, below, layer.wide == 0.0);
        }
        Judged { layer, spots }
    }

    /// What of a layer does not lie on the one below, without what rounding made.
    fn beyond(&mut self, regions: &[Region], below: &[Region]) -> Vec<Region> {
        let mut beyond = self.clipper.difference(regions, below);
        beyond.retain(|region| !is_rounding(area(region), perimeter(region)));
        beyond
    }

    /// The regions that share no area with the layer below. `beyond` is what does not lie on it.
    fn islands(&mut self, regions: &[Region], below: &[Region], beyond: &[Region]) -> Vec<Region> {
        let free = total(beyond);
        let mut islands = Vec::new();
        for region in regions {
            let (own, rim) = (area(region), perimeter(region));
            // A region with nothing below it is part of what does not lie on the layer below.
            if own <= free + ROUNDING * rim {
                let shared = self.clipper.intersection(std::slice::from_ref(region), below);
                if is_rounding(total(&shared), rim) {
                    islands.push(region.clone());
                }
            }
        }
        islands
    }

    /// What lies beyond the reach of the layer below.
    fn unsupported(&mut self, beyond: &[Region], islands: &[Region], below: &[Region]) -> Vec<Region> {
        let reach = self.settings.reach_mm();
        let steps = self.slices.grid.steps(reach);
        // What touches the layer below, and is nowhere longer than its reach, is within reach.
        let short = |region: &Region| {
            islands.is_empty() && Rect::around([region]).is_none_or(|rect| rect.diagonal() <= steps)
        };
        let open: Vec<Region> = beyond.iter().filter(|region| !short(region)).cloned().collect();
        let Some(rect) = Rect::around(&open) else { return open };
        let near = |region: &&Region| {
            Rect::around([*region]).is_some_and(|other| rect.is_near(&other, steps.ceil() as i32))
        };
        let holding: Vec<Region> = below.iter().filter(near).cloned().collect();
        if holding.is_empty() {
            return open;
        }
        let mut unsupported = self.clipper.difference(&open, &grown(&holding, reach, self.slices.grid.step));
        unsupported.retain(|region| !is_rounding(area(region), perimeter(region)));
        unsupported
    }

    /// The area of `regions` that a disc as wide as a sliver fits into, mm².
    fn wide(&mut self, regions: &[Region]) -> f64 {
        let (half, step) = (0.5 * self.settings.sliver_mm, self.slices.grid.step);
        let shrunk = grown(regions, -half, step);
        // Grown back a little more, so that what is cut off does not count as narrow.
        let opened = grown(&shrunk, half * 1.0001, step);
        let wide = self.clipper.intersection(regions, &opened);
        self.square_mm(&wide)
    }

    /// Whether all of a region is in `regions`, but for rounding.
    fn covers(&mut self, regions: &[Region], region: &Region) -> bool {
        let left = self.clipper.difference(std::slice::from_ref(region), regions);
        is_rounding(total(&left), perimeter(region))
    }

    /// The largest hanging places: islands, and what hangs on regions that are no islands.
    fn spots(
        &mut self,
        unsupported: &[Region],
        islands: &[Region],
        below: &[Region],
        narrow: bool,
    ) -> Vec<Spot> {
        let hanging = match islands.is_empty() {
            true => unsupported.to_vec(),
            false => self.clipper.difference(unsupported, islands),
        };
        let all = islands.iter().map(|r| (r, true)).chain(hanging.iter().map(|r| (r, false)));
        let mut sized: Vec<_> =
            all.map(|(r, island)| (self.square_mm(std::slice::from_ref(r)), r, island)).collect();
        sized.retain(|&(area, _, _)| area >= SMALLEST_SPOT);
        sized.sort_by(|a, b| b.0.total_cmp(&a.0));
        sized.truncate(MOST_SPOTS);
        if sized.is_empty() {
            return Vec::new();
        }
        let held = Held::new(below, &self.slices.grid);
        let z = self.slices.planes.heights[self.layer];
        let spot = |&(area, region, island): &(f64, &Region, bool)| {
            let (place, distance) = farthest(region, narrow, &held, &self.slices.grid);
            let excess = distance.map(|distance| distance - self.settings.rule_reach_mm());
            Spot { layer: self.layer, place: place.extend(z), area, excess, island }
        };
        sized.iter().map(spot).collect()
    }

    fn square_mm(&self, regions: &[Region]) -> f64 {
        self.slices.grid.square_mm(total(regions))
    }
}
