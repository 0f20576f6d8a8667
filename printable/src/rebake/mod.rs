//! The support rule kept by the field itself, so that what prints stays smooth.
//!
//! Flat grey-scale morphology commutes with thresholding: if every value is limited by the greatest value that the
//! layer below has within reach,
//!
//! ```text
//! f'(x, k + 1) = min(f(x, k + 1), max over |y| ≤ r of f'(x + y, k))
//! ```
//!
//! then every level of `f'` keeps equation (1), the surface ½ among them, and its surface is as smooth as `f`. What
//! goes back into the tree is not `f'` but its second argument, the *limit*, kept as samples where it is below `f`:
//! the node is `min(f, limit)`, which is `f` itself, bit for bit, wherever nothing was taken away.
//!
//! All of this happens in a space that is stretched along z until the largest overhang is 45°, on a cubic lattice:
//! there the reach is one lattice step for every rule.

mod anchor;
mod bricks;
mod brush;
mod cone;
mod dents;
mod disc;
mod grow;
mod hanging;
mod look;
mod path;
mod path_map;
mod region;
mod settle;
mod slab;
mod strut;
mod trim;
mod volume;

use blobtree::{Bake, BakeError, Baker, Field, ISO, SupportFree, SupportMode, Tree};
use polygonizer::{Cancel, CellSize};
use region::Region;

/// The value that counts as well inside: a limit as high as this is none.
///
/// Lower, interpolation would move slanted surfaces inwards, by 3° along the diagonals at 0.52; higher, thin necks,
/// whose field never gets there, would limit the field of what stands on them.
const TOP: f32 = ISO + 0.25;

/// How far a layer may reach beyond the one below, in lattice steps: a little less than one, so that rounding and
/// meshing stay within the rule, and dents are made up for within some layers. It lets through 43.6° to 44.1° for 45°.
/// With 0.985 it takes twice as many rounds to settle a snowman; with 0.96 some directions let through 1.5° too little.
const REACH: f32 = 0.97;

/// Bakes support-free nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rebaker<'a> {
    cancel: Option<&'a Cancel>,
    cell: Option<CellSize>,
}

impl<'a> Rebaker<'a> {
    /// One that always goes on to the end.
    pub fn new() -> Self {
        Self::default()
    }

    /// One that stops once `cancel` says so.
    pub fn with_cancel(cancel: &'a Cancel) -> Self {
        Self { cancel: Some(cancel), cell: None }
    }

    /// One that also settles what it bakes: it meshes every node in cells of this size, slices the mesh, and dents
    /// the node where a slice hangs in the air, until none does.
    ///
    /// What is left hanging without is what the lattice does not see: tips thinner than a step, edges of flat undersides.
    /// The exact slices see it, of this mesh; another cell size has other tips.
    pub fn settling(self, cell: CellSize) -> Self {
        Self { cell: Some(cell), ..self }
    }

    fn go_on(&self) -> Result<(), BakeError> {
        if self.cancel.is_some_and(Cancel::is_cancelled) { Err(BakeError::Cancelled) } else { Ok(()) }
    }
}

impl Baker for Rebaker<'_> {
    /// - **Promises:** the same bytes for any number of threads; `child` is looked at only above the bed and in the
    ///   layer below it.
    /// - **Cost:** one value of the field for each place of the lattice in the solid's box, some of them bounded
    ///   away, and about a tenth of that for the rule. At most 2²⁷ places: beyond, the lattice gets coarser.
    /// - **Source:** Reiner & Lefebvre 2016, equation 1 and "trim". **Departs:** on the field instead of voxels,
    ///   with a disc of 16 directions instead of a square.
    fn bake(&self, rule: &SupportFree, child: &dyn Field) -> Result<Bake, BakeError> {
        let Some(region) = Region::around_solid(rule, child) else { return Ok(Bake::default()) };
        match rule.mode {
            SupportMode::Off => Ok(Bake::default()),
            SupportMode::Trim => trim::trim(self, &region, child),
            SupportMode::Grow => grow::grow(self, &region, child),
        }
    }

    /// - **Promises:** the same bytes for any number of threads. Nothing changes but what the strokes reach, what stands
    ///   on that, and, for [`AddGrow`](blobtree::BrushKind::AddGrow), the way down from it.
    /// - **Cost:** that of baking, and for each dab some hundred nanoseconds for each place of the lattice in its tip.
    ///   Two bytes for each place, twelve more where something changed.
    /// - **Source:** Reiner & Lefebvre 2016, §2.2. **Departs:** on the field, as all here; preserving keeps
    ///   walls and posts where erosion would leave nothing, so that what stands above does not fall.
    fn brush(&self, rule: &SupportFree, node: &dyn Field, bake: Bake) -> Result<Bake, BakeError> {
        brush::brush(self, rule, node, bake)
    }

    /// - **Promises:** only takes away; nothing if no cell size was asked for.
    /// - **Cost:** a mesh of the node and its slices, and up to eighty times those of the parts that were dented.
    fn finish(
        &self,
        rule: &SupportFree,
        node: &dyn Fn(&Bake) -> Tree,
        bake: Bake,
    ) -> Result<Bake, BakeError> {
        match self.cell {
            Some(cell) => settle::settle(self, cell, rule, node, bake),
            None => Ok(bake),
        }
    }
}
