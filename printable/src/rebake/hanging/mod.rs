//! What hangs in the air, by exact slices.
//!
//! Layers are looked at tile by tile, so that after a change only the tiles are looked at again that it can be felt in.

mod island;
mod piece;
mod tile;

pub(super) use piece::Piece;
pub(super) use tile::Tile;

use super::Rebaker;
use crate::slices::clip::{Clipper, Region, thinned};
use crate::slices::grid::Grid;
use crate::slices::outline::{Outline, Outlines};
use crate::slices::rect::Rect;
use blobtree::BakeError;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use tile::Tiling;

/// What every layer lacks.
#[derive(Debug)]
pub(super) struct Hanging {
    reach: Reach,
    /// Of each layer, what the one below, as it is, does not carry.
    lacks: Vec<Lacks>,
}

/// How far a layer may lie from the one below.
#[derive(Clone, Copy, Debug)]
struct Reach {
    mm: f64,
    grid: Grid,
    tiling: Tiling,
}

/// What a layer lacks.
#[derive(Clone, Debug, Default, PartialEq)]
struct Lacks {
    /// Regions that share no area with what is below.
    islands: Vec<Region>,
    /// What is beyond reach in each tile, parts of islands too; only tiles with something.
    beyond: BTreeMap<Tile, Vec<Region>>,
}

/// A layer above another.
struct Pair<'a> {
    reach: &'a Reach,
    layer: &'a [Outline],
    below: &'a [Outline],
    /// What is no longer there of the one below.
    gone: &'a [Region],
}

impl Hanging {
    /// What lies farther than `reach`, mm, from the layer below.
    ///
    /// Promises: the same for any number of threads. Errors: [`BakeError::Cancelled`].
    pub fn new(rebaker: &Rebaker, outlines: &Outlines, reach: f64) -> Result<Self, BakeError> {
        let reach = Reach { mm: reach, grid: outlines.grid, tiling: Tiling::new(&outlines.grid, reach) };
        let mut hanging = Self { reach, lacks: vec![Lacks::default(); outlines.layers.len()] };
        let all = |layer: &Vec<Outline>| {
            let rects = layer.iter().flat_map(|outline| [outline.rect.min, outline.rect.max]);
            let points: Vec<_> = rects.collect();
            Rect::of_points(&points).map_or(Vec::new(), |rect| reach.tiling.tiles(&rect).collect())
        };
        let all: Vec<Vec<Tile>> = outlines.layers.iter().map(all).collect();
        hanging.look(rebaker, outlines, &all)?;
        Ok(hanging)
    }

    /// The tile of a place, mm.
    pub fn tile_of(&self, x: f64, y: f64) -> Tile {
        self.reach.tiling.tile_of(self.reach.grid.point(glam::DVec2::new(x, y)))
    }

    /// Follows the outlines after a change of each layer in these tiles.
    ///
    /// Errors: [`BakeError::Cancelled`]; then what is known is of no use.
    pub fn renew(
        &mut self,
        rebaker: &Rebaker,
        outlines: &Outlines,
        changed: &[Vec<Tile>],
    ) -> Result<(), BakeError> {
        let stale = |layer: usize| {
            let below = layer.checked_sub(1).map_or(&[][..], |below| &changed[below]);
            let mut tiles: Vec<Tile> = below.iter().flat_map(|tile| tile.around()).collect();
            tiles.extend_from_slice(&changed[layer]);
            tiles.sort_unstable();
            tiles.dedup();
            tiles
        };
        let stale: Vec<Vec<Tile>> = (0..changed.len()).map(stale).collect();
        self.look(rebaker, outlines, &stale)
    }

    /// Looks at these tiles of each layer, in ascending order.
    fn look(&mut self, rebaker: &Rebaker, outlines: &Outlines, tiles: &[Vec<Tile>]) -> Result<(), BakeError> {
        let reach = self.reach;
        let look = |clipper: &mut Clipper, (above, (lacks, tiles)): (usize, (&mut Lacks, &Vec<Tile>))| {
            rebaker.go_on()?;
            if tiles.is_empty() {
                return Ok(());
            }
            let [below, layer] = [above, above + 1].map(|layer| outlines.layers[layer].as_slice());
            let pair = Pair { reach: &reach, layer, below, gone: &[] };
            lacks.islands = pair.islands(clipper, |_| true);
            lacks.renew(pair.beyond(clipper, tiles));
            Ok(())
        };
        let above = self.lacks.iter_mut().zip(tiles).skip(1).collect::<Vec<_>>();
        above.into_par_iter().enumerate().try_for_each_init(Clipper::new, look)
    }

    /// All that must go for every layer to lie within reach of what is left of the one below, from the bottom up.
    ///
    /// - **In:** `pitch`, how far apart places of a piece may be, mm.
    /// - **Promises:** the same for any number of threads.
    /// - **Errors:** [`BakeError::Cancelled`].
    pub fn pieces(
        &self,
        rebaker: &Rebaker,
        outlines: &Outlines,
        pitch: f64,
    ) -> Result<Vec<Piece>, BakeError> {
        let mut clipper = Clipper::new();
        let mut found = Vec::new();
        let mut gone: Vec<Region> = Vec::new();
        for layer in 1..self.lacks.len() {
            rebaker.go_on()?;
            // Where something goes, the layer above lacks more.
            let lacks = self.without(outlines, layer, &gone, &mut clipper);
            let pieces = lacks.regions(&mut clipper);
            gone = thinned(pieces.iter().map(|(region, _)| region), self.reach.grid.step);
            found.extend(pieces.into_iter().map(|(region, island)| (layer, region, island)));
        }
        let piece = |(layer, region, island): &(usize, Region, bool)| {
            Piece::new(region, *island, outlines.planes.heights[*layer], &self.reach.grid, pitch)
        };
        Ok(found.par_iter().map(piece).collect())
    }

    /// What a layer lacks if these regions of the one below are gone.
    fn without(
        &self,
        outlines: &Outlines,
        layer: usize,
        gone: &[Region],
        clipper: &mut Clipper,
    ) -> Cow<'_, Lacks> {
        let known = &self.lacks[layer];
        let rects: Vec<Rect> = gone.iter().filter_map(|region| Rect::around([region])).collect();
        if rects.is_empty() {
            return Cow::Borrowed(known);
        }
        let steps = self.reach.steps();
        let felt = rects.iter().flat_map(|rect| self.reach.tiling.tiles(&rect.widened(steps)));
        let mut tiles: Vec<Tile> = felt.collect();
        tiles.sort_unstable();
        tiles.dedup();
        let [below, layer] = [layer - 1, layer].map(|layer| outlines.layers[layer].as_slice());
        let pair = Pair { reach: &self.reach, layer, below, gone };
        let mut lacks = known.clone();
        let further =
            pair.islands(clipper, |outline| rects.iter().any(|rect| rect.is_near(&outline.rect, 0)));
        lacks.islands.extend(further);
        lacks.islands.sort_unstable();
        lacks.islands.dedup();
        lacks.renew(pair.beyond(clipper, &tiles));
        Cow::Owned(lacks)
    }
}

impl Reach {
    /// In whole steps of the grid, no less.
    fn steps(&self) -> i32 {
        self.grid.steps(self.mm).ceil() as i32
    }
}

impl Lacks {
    fn renew(&mut self, beyond: Vec<(Tile, Vec<Region>)>) {
        for (tile, regions) in beyond {
            match regions.is_empty() {
                true => self.beyond.remove(&tile),
                false => self.beyond.insert(tile, regions),
            };
        }
    }

    /// All regions, each with whether it is an island.
    fn regions(&self, clipper: &mut Clipper) -> Vec<(Region, bool)> {
        let mut others: Vec<Region> = self.beyond.values().flatten().cloned().collect();
        if !self.islands.is_empty() && !others.is_empty() {
            others = clipper.difference(&others, &self.islands);
        }
        let islands = self.islands.iter().map(|region| (region.clone(), true));
        islands.chain(others.into_iter().map(|region| (region, false))).collect()
    }
}

#[cfg(test)]
mod tests;
