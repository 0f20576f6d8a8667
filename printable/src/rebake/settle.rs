//! The last look: what the exact slices of the finished mesh still show hanging is dented away.

use super::Rebaker;
use super::dents::Dents;
use super::hanging::{Piece, hanging};
use crate::LayerHeight;
use crate::slices::{Bottom, SliceError, Slices, Watch};
use blobtree::{Bake, BakeError, SupportFree, Tree};
use polygonizer::{CellSize, Options, PolygonizeError, Surface};
use std::sync::Arc;

/// How far a layer may reach beyond the rule before it is dented, mm: as much as meshing is inexact.
const TOLERANCE_MM: f64 = 0.008;

/// Less area than this in all is left to hang, mm².
const LITTLE: f64 = 0.03;

/// Most times that a node is meshed.
const ROUNDS: usize = 16;

/// Dents a node until no slice of its mesh hangs in the air; see [`Rebaker::settling`].
///
/// Errors: [`BakeError::Cancelled`].
pub(super) fn settle(
    rebaker: &Rebaker,
    cell: CellSize,
    rule: &SupportFree,
    node: &dyn Fn(&Bake) -> Tree,
    mut bake: Bake,
) -> Result<Bake, BakeError> {
    let mut dents = Dents::new(rule);
    for _ in 0..ROUNDS {
        let tree = node(&bake);
        let Some(pieces) = hanging_pieces(rebaker, cell, rule, &tree, dents.pitch())? else { break };
        let area: f64 = pieces.iter().map(|piece| piece.area).sum();
        if area <= LITTLE && !pieces.iter().any(|piece| piece.island) {
            break;
        }
        dents.press(&tree, &pieces);
        // Dents too far apart for one image are left out.
        let Ok(image) = dents.image() else { break };
        bake.dents = Some(Arc::new(image));
        bake.removed_mm3 += area * f64::from(rule.layer_height);
    }
    Ok(bake)
}

/// What hangs of a node's mesh; none if there is no mesh that could be looked at.
fn hanging_pieces(
    rebaker: &Rebaker,
    cell: CellSize,
    rule: &SupportFree,
    tree: &Tree,
    pitch: f64,
) -> Result<Option<Vec<Piece>>, BakeError> {
    let options = Options { cancel: rebaker.cancel, ..Options::default() };
    let mesh = match Surface::build(tree, cell, &options) {
        Ok(surface) => surface.mesh(),
        Err(PolygonizeError::Cancelled) => return Err(BakeError::Cancelled),
        Err(_) => return Ok(None),
    };
    let Ok(height) = LayerHeight::from_mm(rule.layer_height) else { return Ok(None) };
    let watch = Watch { cancel: rebaker.cancel, progress: None };
    let slices = match Slices::new(&mesh, height, Bottom::LowestPoint, &watch) {
        Ok(slices) => slices,
        Err(SliceError::Cancelled) => return Err(BakeError::Cancelled),
        Err(_) => return Ok(None),
    };
    let reach = f64::from(rule.layer_height) * f64::from(rule.overhang_degrees).to_radians().tan();
    Ok(Some(hanging(&slices, reach + TOLERANCE_MM, pitch)))
}
