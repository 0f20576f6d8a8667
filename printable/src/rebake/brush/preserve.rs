//! Carving that leaves what carries the solid above.
//!
//! From the top down, each layer keeps at least the one above, eroded by the reach: so much carries it. That alone
//! ends in edges and points, which no layer below would carry, and everything above would fall with them. So what has
//! become as thin as a wall is not eroded any further: it goes on straight down, if what would fall without it is
//! [of note](super::fall).

use super::canvas::Canvas;
use super::dabs::{Changes, layer_of};
use super::fall::Stakes;
use super::firm::firm;
use super::stamp::{Block, Stamp};
use crate::rebake::disc::Layer;
use blobtree::ISO;

/// By how much what is kept below something leans inwards, in lattice steps for a layer: enough less than the reach
/// that nothing of it is taken again.
pub(super) const LEAN: f32 = 0.88;

/// Width, in lattice steps, of cracks that are not left between what is kept and what was not carved.
const CRACK: f32 = 1.0;

/// How far inside what carries something must lie, in lattice steps, in parts: half of what a wall is thick, at least.
const DEEP: [f32; 2] = [1.0, 0.9];

/// How far a place may be, in lattice steps, in parts, from what lies so deep in the layer below.
const FAR: [f32; 3] = [1.0, 1.0, 1.0];

/// From where on, in lattice steps from a place that is too far, what is kept goes over into what erosion leaves; and
/// by how much for each step.
const WHOLE: f32 = 2.0;
const FADE: f32 = 0.03;

/// How far from what would fall what was there before stays, in lattice steps.
const BESIDE: f32 = 2.0;

/// How far a layer is looked at around a block: as far as one place can be felt.
const AROUND: usize = 8;

/// Carves, but for what carries the solid above; says what changed in each layer from the lowest.
pub(super) fn carve_and_keep(canvas: &mut Canvas, carve: &Stamp) -> Changes {
    let mut stakes = Stakes::of(carve);
    let mut changes: Changes = Vec::new();
    let mut whole = Vec::new();
    for z in (carve.block.low[2]..carve.block.end[2]).rev() {
        let block = layer_of(&carve.block, z);
        let mut to = carve.layer(z).to_vec();
        if z + 1 < canvas.sides()[2] {
            whole = keep(canvas, &block, &mut to, &mut stakes, &whole);
        }
        changes.push(canvas.lower(&block, &to));
    }
    changes.reverse();
    changes
}

/// Raises the limits of a block of one layer to what carries the layer above. Gives the places, of those looked at,
/// that are kept as they are above because much depends on them; `before` are those of the layer above.
fn keep(canvas: &Canvas, block: &Block, to: &mut [f32], stakes: &mut Stakes, before: &[bool]) -> Vec<bool> {
    let [width, depth, _] = block.sides();
    let own = canvas.window(block, block.low[2], AROUND);
    let above = canvas.window(block, block.low[2] + 1, AROUND);
    let places = || (0..depth).flat_map(|y| (0..width).map(move |x| x + AROUND + (y + AROUND) * own.width));
    let mut kept = own.clone();
    let mut raise = |values: &Layer| {
        for (at, to) in places().zip(&mut *to) {
            *to = to.max(values.values[at]);
            kept.values[at] = own.values[at].min(*to);
        }
        kept.clone()
    };
    let carving = raise(&above.eroded(LEAN));
    let carving = raise(&carving.dilated(CRACK).eroded(CRACK));
    // What was begun goes on down to the end.
    let goes_on = |at: usize| before.get(at) == Some(&true) && above.values[at] >= ISO;
    let mut whole: Vec<bool> = (0..own.values.len()).map(goes_on).collect();
    for part in parts(hanging(&above, &carving), own.width) {
        let goes_on = part.iter().any(|at| whole[*at]);
        let place = |at: &usize| {
            let along = |a: usize, i: usize| {
                (block.low[a] + i).checked_sub(AROUND).filter(|i| *i < canvas.sides()[a])
            };
            Some([along(0, at % own.width)?, along(1, at / own.width)?])
        };
        if goes_on || stakes.are_high(canvas, part.iter().filter_map(place), block.low[2] + 1) {
            part.iter().for_each(|at| whole[*at] = true);
        }
    }
    if !whole.contains(&true) {
        return whole;
    }
    let mut kept = carving;
    for (at, distance) in distances(&whole, own.width) {
        let value = above.values[at] - FADE * (distance - WHOLE).max(0.0);
        kept.values[at] = kept.values[at].max(value).min(own.values[at]);
    }
    // Where it does not go on straight down, it goes on as before.
    let carried = kept.dilated(LEAN);
    let is_loose = |at: usize| whole[at] && carried.values[at] < ISO;
    let loose: Vec<bool> = (0..whole.len()).map(is_loose).collect();
    for (at, distance) in distances(&loose, own.width) {
        if distance < BESIDE && own.values[at] > kept.values[at] {
            kept.values[at] = own.values[at];
            whole[at] = true;
        }
    }
    firm(&mut kept);
    for (at, to) in places().zip(&mut *to) {
        *to = to.max(kept.values[at]);
    }
    whole
}

/// Which places of the layer above are too far from what could carry them.
fn hanging(above: &Layer, own: &Layer) -> Vec<bool> {
    let lost = |n: usize| above.values[n] >= ISO && own.values[n] < ISO;
    if !(0..above.values.len()).any(lost) {
        return vec![false; above.values.len()];
    }
    let deep = DEEP.into_iter().fold(own.clone(), |layer, by| layer.eroded(by));
    let carried = FAR.into_iter().fold(deep, |layer, by| layer.dilated(by));
    (0..above.values.len()).map(|n| above.values[n] >= ISO && carried.values[n] < ISO).collect()
}

/// The parts of a layer that touch nowhere, each with its places.
fn parts(mut layer: Vec<bool>, width: usize) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    for start in 0..layer.len() {
        if !std::mem::take(&mut layer[start]) {
            continue;
        }
        let mut part = vec![start];
        let mut next = 0;
        while let Some(at) = part.get(next).copied() {
            next += 1;
            for_near(at, width, layer.len(), 1, |beside, _| {
                if std::mem::take(&mut layer[beside]) {
                    part.push(beside);
                }
            });
        }
        all.push(part);
    }
    all
}

/// The places near those of a layer, with their distance from them in steps.
fn distances(layer: &[bool], width: usize) -> impl Iterator<Item = (usize, f32)> {
    let mut nearest = vec![f32::INFINITY; layer.len()];
    for at in (0..layer.len()).filter(|at| layer[*at]) {
        for_near(at, width, layer.len(), AROUND, |beside, distance| {
            nearest[beside] = nearest[beside].min(distance);
        });
    }
    nearest.into_iter().enumerate().filter(|(_, distance)| distance.is_finite())
}

/// Calls `found` for the places within a square of `reach` steps around one, with their distance.
fn for_near(at: usize, width: usize, places: usize, reach: usize, mut found: impl FnMut(usize, f32)) {
    let [x, y] = [at % width, at / width];
    for near_y in y.saturating_sub(reach)..(y + reach + 1).min(places / width) {
        for near_x in x.saturating_sub(reach)..(x + reach + 1).min(width) {
            found(near_x + width * near_y, (near_x as f32 - x as f32).hypot(near_y as f32 - y as f32));
        }
    }
}
