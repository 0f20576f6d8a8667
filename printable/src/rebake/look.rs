//! The mesh of a node, its slices and what hangs of it, kept up to date where the node changes.

use super::Rebaker;
use super::hanging::{Hanging, Piece, Tile};
use crate::LayerHeight;
use crate::slices::outline::Outlines;
use crate::slices::{SliceError, Watch};
use blobtree::{BRICK, BakeError, Dirty, SupportFree, Tree};
use polygonizer::{CellSize, Options, PolygonizeError, Surface};

/// How far a layer may reach beyond the rule before it is dented, mm: as much as meshing is inexact.
const TOLERANCE_MM: f64 = 0.008;

/// Cells of the mesh along each side of its bricks.
const CELLS: i32 = BRICK as i32 - 1;

/// Cells around a brick in which its vertices may lie.
const AROUND: i32 = 2;

/// By how much a mesh may begin elsewhere before all layers lie elsewhere, mm.
const SAME_BOTTOM_MM: f64 = 1e-7;

/// What can be seen of a node.
#[derive(Debug)]
pub(super) struct Look {
    surface: Surface,
    height: LayerHeight,
    reach: f64,
    outlines: Outlines,
    hanging: Hanging,
    /// Where each layer may have changed since it was cut.
    stale: Vec<Vec<Tile>>,
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
        let outlines = Outlines::new(&surface.mesh(), height, &watch(rebaker));
        let Some(outlines) = sliced(outlines)? else { return Ok(None) };
        let reach = f64::from(rule.layer_height) * f64::from(rule.overhang_degrees).to_radians().tan();
        let reach = reach + TOLERANCE_MM;
        let hanging = Hanging::new(rebaker, &outlines, reach)?;
        let stale = vec![Vec::new(); outlines.layers.len()];
        Ok(Some(Self { surface, height, reach, outlines, hanging, stale }))
    }

    /// Lets the mesh follow the node after changes that can be felt in these boxes only; says whether there still is one.
    ///
    /// - **Cost:** that of the mesh around the boxes.
    /// - **Errors:** [`BakeError::Cancelled`].
    pub fn follow(&mut self, rebaker: &Rebaker, tree: &Tree, dirty: &dyn Dirty) -> Result<bool, BakeError> {
        let cell = self.surface.cell().mm();
        let Some(changes) = meshed(self.surface.update(tree, dirty, &options(rebaker)))? else {
            return Ok(false);
        };
        for key in changes.changed.iter().chain(&changes.removed) {
            let ends = key.map(|key| {
                [key * CELLS - AROUND, (key + 1) * CELLS + AROUND].map(|index| f64::from(index as f32 * cell))
            });
            let heights = &self.outlines.planes.heights;
            let [first, end] = ends[2].map(|end| heights.partition_point(|z| *z < end));
            let [low, high] = [0, 1].map(|end| self.hanging.tile_of(ends[0][end], ends[1][end]));
            self.stale[first..end].iter_mut().for_each(|tiles| tiles.extend(Tile::all(low, high)));
        }
        Ok(true)
    }

    /// Brings outlines up to date with the mesh; says whether there still are some.
    ///
    /// - **Cost:** that of the outlines of layers of bricks that have changed, of looking at them where they have, and
    ///   a pass over all triangles.
    /// - **Errors:** [`BakeError::Cancelled`].
    pub fn slice(&mut self, rebaker: &Rebaker) -> Result<bool, BakeError> {
        let mesh = self.surface.mesh();
        let moved = (f64::from(mesh.bounds().min.z) - self.outlines.planes.bottom).abs();
        if moved > SAME_BOTTOM_MM {
            let outlines = Outlines::new(&mesh, self.height, &watch(rebaker));
            let Some(outlines) = sliced(outlines)? else { return Ok(false) };
            self.hanging = Hanging::new(rebaker, &outlines, self.reach)?;
            self.stale = vec![Vec::new(); outlines.layers.len()];
            self.outlines = outlines;
            return Ok(true);
        }
        let stale: Vec<usize> =
            (0..self.stale.len()).filter(|layer| !self.stale[*layer].is_empty()).collect();
        if sliced(self.outlines.renew(&mesh, &stale, &watch(rebaker)))?.is_none() {
            return Ok(false);
        }
        self.hanging.renew(rebaker, &self.outlines, &self.stale)?;
        self.stale.iter_mut().for_each(Vec::clear);
        Ok(true)
    }

    /// All that must go; places of a piece are no farther apart than `pitch`, mm.
    ///
    /// Errors: [`BakeError::Cancelled`].
    pub fn pieces(&self, rebaker: &Rebaker, pitch: f64) -> Result<Vec<Piece>, BakeError> {
        self.hanging.pieces(rebaker, &self.outlines, pitch)
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

#[cfg(test)]
mod tests {
    use super::super::dents::Dents;
    use super::*;
    use crate::slices::clip::doubled_area;
    use blobtree::build::{Build, cuboid, point, segment};
    use blobtree::{Bake, BakeStore, Baker, Field, Node, NodeRef, SupportMode};
    use std::sync::Arc;

    /// Dents a node some times, and compares each look with a fresh one: meshes to the last bit.
    #[derive(Debug)]
    struct Comparing;

    const ROUNDS: usize = 4;

    impl Baker for Comparing {
        fn bake(&self, rule: &SupportFree, child: &dyn Field) -> Result<Bake, BakeError> {
            Rebaker::new().bake(rule, child)
        }

        fn finish(
            &self,
            rule: &SupportFree,
            node: &dyn Fn(&Bake) -> Tree,
            mut bake: Bake,
        ) -> Result<Bake, BakeError> {
            let rebaker = Rebaker::new();
            let cell = CellSize::from_mm(rule.layer_height).expect("legal");
            let mut dents = Dents::new(rule);
            let mut tree = node(&bake);
            let fresh =
                |tree: &Tree| Look::new(&rebaker, cell, rule, tree).expect("no cancel").expect("solid");
            let mut kept = fresh(&tree);
            for round in 0..ROUNDS {
                let pieces = kept.pieces(&rebaker, dents.pitch()).expect("no cancel");
                assert!(round > 0 || rule.mode == SupportMode::Grow || !pieces.is_empty(), "nothing hangs");
                if pieces.is_empty() {
                    break;
                }
                let dirty = dents.press(&tree, &pieces);
                bake.dents = Some(Arc::new(dents.image().expect("close together")));
                tree = node(&bake);
                assert!(kept.follow(&rebaker, &tree, &dirty).expect("no cancel"), "round {round}");
                assert!(kept.slice(&rebaker).expect("no cancel"), "round {round}");
                let fresh = fresh(&tree);
                assert!(kept.surface == fresh.surface, "round {round}: the mesh differs");
                assert_eq!(kept.surface.mesh(), fresh.surface.mesh(), "round {round}");
                // Outlines may begin elsewhere, and lie on another grid.
                assert_eq!(kept.outlines.layers.len(), fresh.outlines.layers.len(), "round {round}");
                for layer in 0..fresh.outlines.layers.len() {
                    let [kept, fresh] = [&kept, &fresh].map(|look| {
                        let outlines = &look.outlines.layers[layer];
                        let doubled =
                            outlines.iter().map(|outline| doubled_area(&outline.ring)).sum::<i128>();
                        look.outlines.grid.square_mm(0.5 * doubled as f64)
                    });
                    let apart = kept - fresh;
                    assert!(apart.abs() < 1e-4, "round {round}, layer {layer}: {apart} mm² apart");
                }
                let hanging = |look: &Look| -> f64 {
                    look.pieces(&rebaker, dents.pitch())
                        .expect("no cancel")
                        .iter()
                        .map(|piece| piece.area)
                        .sum()
                };
                let apart = hanging(&kept) - hanging(&fresh);
                assert!(apart.abs() < 1e-4, "round {round}: {apart} mm² more hang");
            }
            Ok(bake)
        }
    }

    fn shapes() -> [Node; 2] {
        let block = || cuboid([0., 0., 6.], [14., 10., 12.]);
        [
            block().blend_subtract(point([-3., 0., -1.], 3.).union(point([3., 0., -1.], 3.))),
            block().union(segment([0., 0., 9.], [14., 1., 8.], 0.6)),
        ]
    }

    #[test]
    fn what_was_kept_through_settling_equals_a_fresh_look() {
        for mode in [SupportMode::Trim, SupportMode::Grow] {
            for shape in shapes() {
                let rule = SupportFree { mode, ..SupportFree::default() };
                let root: NodeRef = shape.support_free(rule).into();
                BakeStore::new().bake(&root, &Comparing).expect("it can be baked");
            }
        }
    }
}
