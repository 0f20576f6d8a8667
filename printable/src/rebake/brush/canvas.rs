//! The solid while it is brushed: a field that is raised and lowered.
//!
//! With f the field before all brushes, it is `min(max(f, grown), limit)` at every place. Raising it to t makes
//! `grown` and `limit` at least t, lowering it to t makes `limit` at most t; so the two say all that was done.

use super::stamp::Block;
use crate::rebake::TOP;
use crate::rebake::disc::Layer;
use crate::rebake::volume::Volume;
use blobtree::{ISO, VoxelMaterials};

/// By how much a place must change to count as changed.
pub(super) const FELT: f32 = 1e-3;

/// Places along each side of a page.
const PAGE: usize = 16;

/// Values of a region, kept in pages where they are not all the same.
#[derive(Debug)]
pub(super) struct Paged {
    background: f32,
    pages_along: [usize; 3],
    pages: Vec<Option<Box<[f32; PAGE * PAGE * PAGE]>>>,
}

impl Paged {
    fn new(sides: [usize; 3], background: f32) -> Self {
        let pages_along = sides.map(|side| side.div_ceil(PAGE));
        Self { background, pages_along, pages: vec![None; pages_along.iter().product()] }
    }

    fn find(&self, at: [usize; 3]) -> (usize, usize) {
        let page = at.map(|i| i / PAGE);
        let [x, y, z] = at.map(|i| i % PAGE);
        let page = page[0] + self.pages_along[0] * (page[1] + self.pages_along[1] * page[2]);
        (page, x + PAGE * (y + PAGE * z))
    }

    pub fn value(&self, at: [usize; 3]) -> f32 {
        let (page, within) = self.find(at);
        self.pages[page].as_ref().map_or(self.background, |page| page[within])
    }

    fn set(&mut self, at: [usize; 3], value: f32) {
        let (page, within) = self.find(at);
        if self.pages[page].is_some() || value != self.background {
            let background = self.background;
            self.pages[page].get_or_insert_with(|| Box::new([background; PAGE * PAGE * PAGE]))[within] =
                value;
        }
    }

    /// The value where no page is.
    pub fn background(&self) -> f32 {
        self.background
    }

    /// Whether a value in this layer is not the background.
    pub fn is_felt_in(&self, layer: usize) -> bool {
        let plane = self.pages_along[0] * self.pages_along[1];
        let pages = self.pages[layer / PAGE * plane..][..plane].iter().flatten();
        let start = layer % PAGE * PAGE * PAGE;
        let own = |page: &[f32; PAGE * PAGE * PAGE]| {
            page[start..start + PAGE * PAGE].iter().any(|value| *value != self.background)
        };
        pages.into_iter().any(|page| own(page))
    }

    /// Whether all of the pages in this layer are background.
    pub fn is_plain(&self, layer: usize) -> bool {
        let plane = self.pages_along[0] * self.pages_along[1];
        self.pages[layer / PAGE * plane..][..plane].iter().all(Option::is_none)
    }
}

/// Places of a layer, in a block of one layer, that changed.
#[derive(Clone, Debug)]
pub(super) struct Changed {
    pub block: Block,
    pub places: Vec<bool>,
}

impl Changed {
    /// Those of a block that covers both.
    pub fn with(self, other: Self) -> Self {
        let block = self.block.joined(&other.block);
        let mut places = vec![false; block.sides().iter().product()];
        for part in [&self, &other] {
            part.each(|at| places[block.index(at)] = true);
        }
        Self { block, places }
    }

    /// Calls `found` for all places that changed.
    pub fn each(&self, mut found: impl FnMut([usize; 3])) {
        let [width, ..] = self.block.sides();
        let [low_x, low_y, z] = self.block.low;
        for (n, _) in self.places.iter().enumerate().filter(|(_, changed)| **changed) {
            found([low_x + n % width, low_y + n / width, z]);
        }
    }
}

/// See the module.
#[derive(Debug)]
pub(super) struct Canvas {
    pub value: Volume,
    pub grown: Paged,
    pub limit: Paged,
    /// What was added is made of, where that was not solid; none if nobody asks.
    pub materials: Option<VoxelMaterials>,
    /// What was lowered since it is noted, in order; none if it is not.
    lowered: Option<Vec<Lowered>>,
}

/// What a place was before it was lowered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lowered {
    pub at: [u16; 3],
    pub value: f32,
    limit: f32,
}

impl Canvas {
    /// One that nothing was done to; `materials`, without any said, if it is to note them.
    pub fn new(value: Volume, materials: Option<VoxelMaterials>) -> Self {
        let sides = value.sides;
        let (grown, limit) = (Paged::new(sides, 0.0), Paged::new(sides, TOP));
        Self { value, grown, limit, materials, lowered: None }
    }

    pub fn sides(&self) -> [usize; 3] {
        self.value.sides
    }

    /// Raises the places of a block of one layer to these values; tells which rose. `material` is what those are made of
    /// that were not solid, by place and value.
    pub fn raise(
        &mut self,
        block: &Block,
        to: &[f32],
        material: impl Fn([usize; 3], f32) -> u8,
    ) -> Option<Changed> {
        self.change(block, to, |canvas, at, to| {
            if to <= 0.0 {
                return false;
            }
            let to = to.min(TOP);
            let before = canvas.value.value(at);
            canvas.grown.set(at, canvas.grown.value(at).max(to));
            if canvas.limit.value(at) < to {
                canvas.limit.set(at, to);
            }
            if to > before {
                canvas.value.set(at, to);
                if before < ISO
                    && let Some(materials) = &mut canvas.materials
                {
                    materials.set(at, material(at, to));
                }
            }
            to > before + FELT
        })
    }

    /// Lowers the places of a block of one layer to these values; tells which fell.
    pub fn lower(&mut self, block: &Block, to: &[f32]) -> Option<Changed> {
        self.change(block, to, |canvas, at, to| {
            if to >= TOP {
                return false;
            }
            let (before, limit) = (canvas.value.value(at), canvas.limit.value(at));
            if let Some(lowered) = &mut canvas.lowered
                && to < before.max(limit)
            {
                lowered.push(Lowered { at: at.map(|i| i as u16), value: before, limit });
            }
            canvas.limit.set(at, limit.min(to));
            if to < before {
                canvas.value.set(at, to.max(0.0));
            }
            to < before - FELT
        })
    }

    /// Does something that only lowers, and undoes it unless it is `right` by what was lowered, in order; gives whether
    /// it was.
    pub fn try_to(
        &mut self,
        lower: impl FnOnce(&mut Self),
        is_right: impl FnOnce(&Self, &[Lowered]) -> bool,
    ) -> bool {
        self.lowered = Some(Vec::new());
        lower(self);
        let lowered = self.lowered.take().unwrap_or_default();
        let is_right = is_right(self, &lowered);
        if !is_right {
            for Lowered { at, value, limit } in lowered.into_iter().rev() {
                let at = at.map(usize::from);
                self.value.set(at, value);
                self.limit.set(at, limit);
            }
        }
        is_right
    }

    fn change(
        &mut self,
        block: &Block,
        to: &[f32],
        change: impl Fn(&mut Self, [usize; 3], f32) -> bool,
    ) -> Option<Changed> {
        let mut places = vec![false; to.len()];
        let [width, ..] = block.sides();
        let mut any = false;
        for (n, to) in to.iter().enumerate() {
            let at = [block.low[0] + n % width, block.low[1] + n / width, block.low[2]];
            places[n] = change(self, at, *to);
            any |= places[n];
        }
        any.then_some(Changed { block: *block, places })
    }

    /// The values around a block of one layer in another layer, `margin` places wider; beyond the region the nearest
    /// value goes on.
    pub fn window(&self, block: &Block, layer: usize, margin: usize) -> Layer {
        let [width, depth, _] = block.sides();
        let mut window = Layer::new(width + 2 * margin, depth + 2 * margin, 0.0);
        let [nx, ny, _] = self.sides();
        for (y, row) in window.values.chunks_exact_mut(width + 2 * margin).enumerate() {
            let y = (block.low[1] + y).saturating_sub(margin).min(ny - 1);
            // Those beyond the first place, those in the region, and those beyond the last.
            let before = margin.saturating_sub(block.low[0]);
            let first = (block.low[0] + before - margin).min(nx - 1);
            let inside = (row.len() - before).min(nx - first);
            self.value.copy_row([first, y, layer], &mut row[before..before + inside]);
            let (low, high) = (row[before], row[before + inside - 1]);
            row[..before].fill(low);
            row[before + inside..].fill(high);
        }
        window
    }
}
