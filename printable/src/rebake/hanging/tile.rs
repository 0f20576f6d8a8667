//! What one layer lacks of the one below, in squares of the plane.

use super::{Pair, Reach};
use crate::slices::clip::{
    Clipper, Region, area, doubled_area, grown, is_near_way, is_rounding, pairs, perimeter,
};
use crate::slices::grid::{Grid, Point};
use crate::slices::outline::{Outline, clipped, rings};
use crate::slices::rect::Rect;

/// How wide a tile is, in reaches: less, and there is more rim than inside; more, and more is looked at again than changes.
const WIDTH: f64 = 8.0;

/// Steps of the grid that tiles look further than their reach, as outlines are cut and grown to whole steps.
const MARGIN: i32 = 8;

/// How near is as good as touching, in steps of the grid.
const TOUCHING: f64 = 2.0;

/// A square of the plane; ordered by rows, then columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in super::super) struct Tile {
    row: i32,
    column: i32,
}

impl Tile {
    /// It and the eight beside it.
    pub fn around(self) -> impl Iterator<Item = Self> {
        let Self { row, column } = self;
        (-1..=1).flat_map(move |y| (-1..=1).map(move |x| Self { row: row + y, column: column + x }))
    }

    /// The tiles from one to another.
    pub fn all(low: Self, high: Self) -> impl Iterator<Item = Self> {
        (low.row..=high.row)
            .flat_map(move |row| (low.column..=high.column).map(move |column| Self { row, column }))
    }
}

/// The plane in tiles, each wider than the reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiling {
    /// In steps of the grid.
    width: i32,
}

impl Tiling {
    /// Tiles for a reach, mm.
    pub fn new(grid: &Grid, reach: f64) -> Self {
        Self { width: grid.steps(WIDTH * reach).ceil() as i32 }
    }

    pub fn tile_of(&self, p: Point) -> Tile {
        Tile { row: p.y.div_euclid(self.width), column: p.x.div_euclid(self.width) }
    }

    /// All tiles that a box touches.
    pub fn tiles(&self, rect: &Rect) -> impl Iterator<Item = Tile> + use<> {
        Tile::all(self.tile_of(rect.min), self.tile_of(rect.max))
    }

    fn rect(&self, low: Tile, high: Tile) -> Rect {
        let corner = |row: i32, column: i32| Point::new(column * self.width, row * self.width);
        Rect { min: corner(low.row, low.column), max: corner(high.row + 1, high.column + 1) }
    }
}

impl Pair<'_> {
    /// What of the layer is beyond reach of the one below in each of these tiles, which are in ascending order.
    pub(super) fn beyond(&self, clipper: &mut Clipper, tiles: &[Tile]) -> Vec<(Tile, Vec<Region>)> {
        let further = self.reach.steps() + MARGIN;
        let mut beyond = Vec::with_capacity(tiles.len());
        for row in tiles.chunk_by(|a, b| a.row == b.row) {
            // Outlines are cut to the row first, so that no tile goes through all of them.
            let rect = self.reach.tiling.rect(row[0], row[row.len() - 1]);
            let layer = clipped(self.layer, &rect);
            let below = clipped(self.below, &rect.widened(further));
            for tile in row {
                let rect = self.reach.tiling.rect(*tile, *tile);
                let layer = clipped(&layer, &rect);
                let below = clipped(&below, &rect.widened(further));
                let local = Local { pair: self, rect, layer: &layer, below: &below };
                beyond.push((*tile, local.beyond(clipper)));
            }
        }
        beyond
    }
}

/// A pair of layers in one tile.
struct Local<'a> {
    pair: &'a Pair<'a>,
    rect: Rect,
    layer: &'a [Outline],
    /// In and around the tile.
    below: &'a [Outline],
}

impl Local<'_> {
    fn beyond(&self, clipper: &mut Clipper) -> Vec<Region> {
        let Reach { mm, grid, .. } = *self.pair.reach;
        let around = self.rect.widened(self.pair.reach.steps() + MARGIN);
        let is_near = |region: &&Region, rect: &Rect, gap: i32| {
            Rect::around([*region]).is_some_and(|other| rect.is_near(&other, gap))
        };
        let gone: Vec<&Region> = self.pair.gone.iter().filter(|region| is_near(region, &around, 0)).collect();
        if self.layer.is_empty() || (gone.is_empty() && covers(self.below, &around)) {
            return Vec::new();
        }
        let [layer, below] = [self.layer, self.below].map(rings);
        let gone: Vec<&[Point]> = gone.into_iter().flatten().map(Vec::as_slice).collect();
        let left = (!gone.is_empty()).then(|| clipper.difference(&below[..], &gone[..]));
        let carrying = left.as_ref().map_or(below, |left| left.iter().flatten().map(Vec::as_slice).collect());
        let mut beyond = clipper.difference(&layer[..], &carrying[..]);
        beyond.retain(|region| !is_rounding(area(region), perimeter(region)));
        // What touches the layer below, and is nowhere longer than its reach, is within reach; but on the rim of the
        // tile, it may go on. What does not touch is an island: outlines that cross themselves hide some from probes.
        let is_short = |region: &Region| {
            let rect = Rect::around([region]);
            rect.is_some_and(|rect| rect.diagonal() <= grid.steps(mm) && self.rect.encloses(&rect))
        };
        let mut specks = Vec::new();
        beyond.retain(|region| {
            if is_short(region) && !touches(region, &carrying) {
                specks.push(region.clone());
            }
            !is_short(region)
        });
        let Some(rect) = Rect::around(&beyond) else { return specks };
        let mut holding = left.clone().unwrap_or_else(|| clipper.fill(&carrying[..]));
        holding.retain(|region| is_near(&region, &rect, self.pair.reach.steps()));
        if !holding.is_empty() {
            beyond = clipper.difference(&beyond[..], &grown(&holding, mm, grid.step)[..]);
            beyond.retain(|region| !is_rounding(area(region), perimeter(region)));
        }
        beyond.append(&mut specks);
        beyond
    }
}

/// Whether a corner of a region is on one of these rings, but for rounding.
fn touches(region: &Region, rings: &[&[Point]]) -> bool {
    let corners = region.iter().flatten();
    let mut sides = rings.iter().flat_map(|ring| pairs(ring));
    sides.any(|(a, b)| corners.clone().any(|p| is_near_way(*p, a, b, TOUCHING)))
}

/// Whether all of a box is inside an outline that was cut to it.
fn covers(outlines: &[Outline], rect: &Rect) -> bool {
    let [outline] = outlines else { return false };
    let [width, height] = [rect.max.x - rect.min.x, rect.max.y - rect.min.y].map(i128::from);
    doubled_area(&outline.ring) == 2 * width * height
}
