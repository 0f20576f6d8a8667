//! The mesh of a node, its slices and what hangs of it, kept up to date where the node changes.

use super::Rebaker;
use super::hanging::{Hanging, Piece};
use crate::LayerHeight;
use crate::slices::{Bottom, SliceError, Slices, Watch};
use blobtree::{Aabb, BRICK, BakeError, SupportFree, Tree};
use polygonizer::{CellSize, Options, PolygonizeError, Surface};

/// How far a layer may reach beyond the rule before it is dented, mm: as much as meshing is inexact.
const TOLERANCE_MM: f64 = 0.008;

/// Cells of the mesh along each side of its bricks.
const CELLS: i32 = BRICK as i32 - 1;

/// Cells around a brick in which its vertices may lie.
const AROUND: i32 = 2;

/// Bricks between two changes that the mesh follows one after the other.
const GAP: i32 = 2;

/// By how much a mesh may begin elsewhere before all layers lie elsewhere, mm.
const SAME_BOTTOM_MM: f64 = 1e-7;

/// What can be seen of a node.
#[derive(Debug)]
pub(super) struct Look {
    surface: Surface,
    height: LayerHeight,
    reach: f64,
    slices: Slices,
    hanging: Hanging,
    /// Which layers may have changed since they were sliced.
    stale: Vec<bool>,
}

/// Changes close to each other.
#[derive(Debug)]
pub(super) struct Spot {
    /// Numbers of the changes.
    pub changes: Vec<usize>,
    /// Where they are felt.
    dirty: Aabb,
    /// First and last of the bricks of the mesh that may feel them.
    bricks: [[i32; 3]; 2],
}

impl Spot {
    fn new(change: usize, dirty: Aabb, cell: f32) -> Self {
        let brick = |x: f32, by: i32| ((x / cell).floor() as i32 + by).div_euclid(CELLS);
        let low = dirty.min.to_array().map(|x| brick(x, -AROUND));
        let high = dirty.max.to_array().map(|x| brick(x, AROUND));
        Self { changes: vec![change], dirty, bricks: [low, high] }
    }

    /// Both as one.
    fn joined(mut self, mut other: Self, cell: f32) -> Self {
        let all = Self::new(0, self.dirty.union(&other.dirty), cell);
        self.changes.append(&mut other.changes);
        Self { changes: self.changes, ..all }
    }

    /// Whether as one they take no more bricks than one after the other.
    fn is_as_cheap_with(&self, other: &Self) -> bool {
        let count = |[low, high]: [[i32; 3]; 2]| {
            (0..3).map(|a| i64::from(high[a]) - i64::from(low[a]) + 1).product::<i64>()
        };
        let (own, other_bricks) = (self.bricks, other.bricks);
        let both = [
            std::array::from_fn(|a| own[0][a].min(other_bricks[0][a])),
            std::array::from_fn(|a| own[1][a].max(other_bricks[1][a])),
        ];
        count(both) <= count(self.bricks) + count(other.bricks)
    }

    /// Whether bricks of both may be neighbours.
    fn is_near(&self, other: &Self) -> bool {
        let apart = |a: usize| {
            self.bricks[0][a] > other.bricks[1][a] + GAP || other.bricks[0][a] > self.bricks[1][a] + GAP
        };
        !(0..3).any(apart)
    }
}

impl Look {
    /// The first look; none if there is no mesh that could be looked at.
    ///
    /// Errors: [`BakeError::Cancelled`].
    pub fn new(
        rebaker: &Rebaker,
        cell: CellSize,
        rule: &SupportFree,
        tree: &Tree,
    ) -> Result<Option<Self>, BakeError> {
        let Some(surface) = meshed(Surface::build(tree, cell, &options(rebaker)))? else { return Ok(None) };
        let Ok(height) = LayerHeight::from_mm(rule.layer_height) else { return Ok(None) };
        let slices = Slices::new(&surface.mesh(), height, Bottom::LowestPoint, &watch(rebaker));
        let Some(slices) = sliced(slices)? else { return Ok(None) };
        let reach = f64::from(rule.layer_height) * f64::from(rule.overhang_degrees).to_radians().tan();
        let reach = reach + TOLERANCE_MM;
        let hanging = Hanging::new(&slices, reach);
        let stale = vec![false; slices.layers.len()];
        Ok(Some(Self { surface, height, reach, slices, hanging, stale }))
    }

    /// Groups of changes that the mesh can follow at once, each change by its number. A change is known by the box in
    /// which it is felt.
    ///
    /// The mesh follows box by box, so boxes of one group must not be near each other: bricks of a box that is
    /// yet to come would not fit to those of one that was.
    pub fn groups(&self, dirty: &[Aabb]) -> Vec<Vec<Spot>> {
        let cell = self.surface.cell().mm();
        let mut spots: Vec<Spot> = Vec::new();
        for (number, dirty) in dirty.iter().enumerate() {
            let mut spot = Spot::new(number, *dirty, cell);
            while let Some(other) = spots.iter().position(|other| spot.is_as_cheap_with(other)) {
                spot = spot.joined(spots.swap_remove(other), cell);
            }
            spots.push(spot);
        }
        let mut groups: Vec<Vec<Spot>> = Vec::new();
        for spot in spots {
            match groups.iter_mut().find(|group| group.iter().all(|other| !spot.is_near(other))) {
                Some(group) => group.push(spot),
                None => groups.push(vec![spot]),
            }
        }
        groups
    }

    /// Lets the mesh follow the node after a change that can be felt in this group only; says whether there still is
    /// one.
    ///
    /// - **Cost:** that of the mesh around the boxes.
    /// - **Errors:** [`BakeError::Cancelled`].
    pub fn follow(&mut self, rebaker: &Rebaker, tree: &Tree, group: &[Spot]) -> Result<bool, BakeError> {
        let cell = self.surface.cell().mm();
        for spot in group {
            let Some(changes) = meshed(self.surface.update(tree, &spot.dirty, &options(rebaker)))? else {
                return Ok(false);
            };
            for key in changes.changed.iter().chain(&changes.removed) {
                let ends = [key[2] * CELLS - AROUND, (key[2] + 1) * CELLS + AROUND];
                let ends = ends.map(|index| f64::from(index as f32 * cell));
                let heights = &self.slices.planes.heights;
                let [first, end] = ends.map(|end| heights.partition_point(|z| *z < end));
                self.stale[first..end].fill(true);
            }
        }
        Ok(true)
    }

    /// Brings slices up to date with the mesh; says whether there still are some.
    ///
    /// - **Cost:** that of the layers of bricks that have changed, and a pass over all triangles.
    /// - **Errors:** [`BakeError::Cancelled`].
    pub fn slice(&mut self, rebaker: &Rebaker) -> Result<bool, BakeError> {
        let mesh = self.surface.mesh();
        let moved = (f64::from(mesh.bounds().min.z) - self.slices.planes.bottom).abs();
        if moved > SAME_BOTTOM_MM {
            let slices = Slices::new(&mesh, self.height, Bottom::LowestPoint, &watch(rebaker));
            let Some(slices) = sliced(slices)? else { return Ok(false) };
            self.hanging = Hanging::new(&slices, self.reach);
            self.stale = vec![false; slices.layers.len()];
            self.slices = slices;
            return Ok(true);
        }
        let stale: Vec<usize> = (0..self.stale.len()).filter(|layer| self.stale[*layer]).collect();
        self.stale.fill(false);
        let Some(different) = sliced(self.slices.renew(&mesh, &stale, &watch(rebaker)))? else {
            return Ok(false);
        };
        self.hanging.renew(&self.slices, &different);
        Ok(true)
    }

    /// All that must go; places of a piece are no farther apart than `pitch`, mm.
    pub fn pieces(&self, pitch: f64) -> Vec<Piece> {
        self.hanging.pieces(&self.slices, pitch)
    }
}

fn options<'a>(rebaker: &Rebaker<'a>) -> Options<'a> {
    Options { cancel: rebaker.cancel, ..Options::default() }
}

fn watch<'a>(rebaker: &Rebaker<'a>) -> Watch<'a> {
    Watch { cancel: rebaker.cancel, progress: None }
}

fn meshed<T>(result: Result<T, PolygonizeError>) -> Result<Option<T>, BakeError> {
    match result {
        Ok(surface) => Ok(Some(surface)),
        Err(PolygonizeError::Cancelled) => Err(BakeError::Cancelled),
        Err(_) => Ok(None),
    }
}

fn sliced<T>(result: Result<T, SliceError>) -> Result<Option<T>, BakeError> {
    match result {
        Ok(slices) => Ok(Some(slices)),
        Err(SliceError::Cancelled) => Err(BakeError::Cancelled),
        Err(_) => Ok(None),
    }
}
