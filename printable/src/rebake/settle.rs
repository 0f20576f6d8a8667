//! The last look: what the exact slices of the finished mesh still show hanging is dented away.

use super::Rebaker;
use super::dents::Dents;
use super::look::Look;
use blobtree::{Bake, BakeError, SupportFree, Tree};
use polygonizer::CellSize;
use std::sync::Arc;

/// Most times that a node is dented. Slicers put a column under any sliver, however thin, so it goes on until nothing
/// hangs, which took dice 20 rounds, a horse 30 and a bunny 55; the last ones are cheap, as they change little.
const ROUNDS: usize = 80;

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
    let mut tree = node(&bake);
    let Some(mut look) = Look::new(rebaker, cell, rule, &tree)? else { return Ok(bake) };
    for _ in 0..ROUNDS {
        let pieces = look.pieces(rebaker, dents.pitch())?;
        if pieces.is_empty() {
            break;
        }
        let area: f64 = pieces.iter().map(|piece| piece.area).sum();
        bake.removed_mm3 += area * f64::from(rule.layer_height);
        let dirty = dents.press(&tree, &pieces);
        rebaker.go_on()?;
        // Dents too far apart for one image are left out.
        let Ok(image) = dents.image() else { return Ok(bake) };
        bake.dents = Some(Arc::new(image));
        tree = node(&bake);
        if !look.follow(rebaker, &tree, &dirty)? {
            return Ok(bake);
        }
        if !look.slice(rebaker)? {
            break;
        }
    }
    Ok(bake)
}
