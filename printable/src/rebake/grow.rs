//! Grow: matter is added below what nothing carries, until everything is carried.
//!
//! From the top down, a layer must hold at least the layer above eroded by the reach: that much carries it. So flat
//! undersides get vaults, and round ones cones that run into what is below. Where erosion leaves nothing of a part,
//! because it is smaller than the reach, a strut takes its weight, along the closest supporting path: the one that
//! comes to matter or to the bed soonest.

use super::bricks::Collector;
use super::disc::{Layer, dilate_row};
use super::path_map::PathMap;
use super::region::Region;
use super::slab::Slab;
use super::strut::{Strut, draw};
use super::trim::{self, FELT};
use super::volume::Volume;
use super::{Rebaker, TOP};
use blobtree::{BRICK, Bake, BakeError, Beyond, Field, ISO, VoxelImage};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// How far from what carries a place may be, in lattice steps, before a strut is made for it. Corners that erosion
/// rounds off are nearer; trimming takes what they lack.
const FAR: f32 = 1.6;

/// By how much grown matter leans outwards, in lattice steps for a layer: enough less than the reach that trimming finds
/// nothing to take. 41.3° for 45°.
const LEAN: f32 = 0.88;

/// Grows what is missing, then trims what is left over.
///
/// Errors: [`BakeError::Cancelled`].
pub(super) fn grow(rebaker: &Rebaker, region: &Region, child: &dyn Field) -> Result<Bake, BakeError> {
    let mut volume = Volume::new(region);
    sample(rebaker, region, child, &mut volume)?;
    let paths = PathMap::new(&volume);
    let layers = region.sides[2];
    for layer in (0..layers - 1).rev() {
        if layer.is_multiple_of(BRICK) {
            rebaker.go_on()?;
        }
        let above = volume.layer(layer + 1);
        let mut own = volume.layer(layer);
        let changed = raise(&above, &mut own);
        if changed {
            volume.set_layer(layer, &own);
        }
        for start in unsupported(&above, &own) {
            draw(&mut volume, &Strut::along(&paths, start, layer, region));
        }
    }
    drop(paths);
    let grown = collect(rebaker, region, child, &volume)?;
    let mut source = |layer: usize, to: &mut Layer| volume.copy_layer(layer, to);
    let mut bake = trim::sweep(rebaker, region, child, &mut source)?;
    if let Some((image, places)) = grown {
        bake.grown = Some(Arc::new(image));
        bake.added_mm3 = places as f64 * region.cell_mm3;
        // Struts go on downwards from the first layer.
        bake.cut_at_bed = true;
    }
    Ok(bake)
}

pub(super) fn sample(
    rebaker: &Rebaker,
    region: &Region,
    child: &dyn Field,
    volume: &mut Volume,
) -> Result<(), BakeError> {
    let mut slab = Slab::new(region);
    let mut row = Layer::new(region.sides[0], region.sides[1], 0.0);
    for layer in 0..region.sides[2] {
        if layer.is_multiple_of(BRICK) {
            rebaker.go_on()?;
            slab.fill(region, layer, child);
        }
        slab.copy_layer(layer % BRICK, &mut row);
        volume.set_layer(layer, &row);
    }
    Ok(())
}

/// Raises a layer to the one above, eroded by the reach; says whether anything changed.
fn raise(above: &Layer, own: &mut Layer) -> bool {
    let width = own.width;
    let mut negative = above.clone();
    negative.values.iter_mut().for_each(|value| *value = -*value);
    let rows = own.values.par_chunks_mut(width).enumerate();
    let changed = rows.map_init(
        || vec![0.0; width],
        |eroded, (y, own)| {
            dilate_row(&negative, y, LEAN, eroded);
            let mut changed = false;
            for (own, eroded) in own.iter_mut().zip(eroded) {
                if -*eroded > *own {
                    changed = true;
                    *own = -*eroded;
                }
            }
            changed
        },
    );
    changed.reduce(|| false, |a, b| a | b)
}

/// Places of the layer above, no two close together, that together stand for all that this layer cannot carry.
fn unsupported(above: &Layer, own: &Layer) -> Vec<[usize; 2]> {
    let width = own.width;
    let rows = above.values.par_chunks(width).enumerate();
    let found: Vec<Vec<[usize; 2]>> = rows
        .map(|(y, row)| {
            let hanging = |x: &usize| row[*x] >= ISO && !carried(own, *x, y);
            (0..width).filter(hanging).map(|x| [x, y]).collect()
        })
        .collect();
    let mut starts: Vec<[usize; 2]> = Vec::new();
    for place in found.into_iter().flatten() {
        let near = |start: &[usize; 2]| {
            let apart = |a: usize| place[a] as f32 - start[a] as f32;
            apart(0).hypot(apart(1)) < 2.0 * FAR
        };
        // The latest are the nearest.
        if !starts.iter().rev().any(near) {
            starts.push(place);
        }
    }
    starts
}

fn carried(own: &Layer, x: usize, y: usize) -> bool {
    let reach = FAR.ceil() as isize;
    (-reach..=reach).any(|dy| {
        let row = own.row(y as isize + dy);
        (-reach..=reach).any(|dx| {
            let at = (x as isize + dx).clamp(0, own.width as isize - 1) as usize;
            row[at] >= ISO && (dx as f32).hypot(dy as f32) <= FAR
        })
    })
}

/// The image of what was added, and how many places became solid; none if none did.
fn collect(
    rebaker: &Rebaker,
    region: &Region,
    child: &dyn Field,
    volume: &Volume,
) -> Result<Option<(VoxelImage, u64)>, BakeError> {
    let first = volume.layer(0);
    let mut collector = Collector::new(region, [first.clone(), first], TOP);
    let mut slab = Slab::new(region);
    let mut field = Layer::new(region.sides[0], region.sides[1], 0.0);
    let added = AtomicU64::new(0);
    for layer in 0..region.sides[2] {
        if layer.is_multiple_of(BRICK) {
            rebaker.go_on()?;
            slab.fill(region, layer, child);
        }
        slab.copy_layer(layer % BRICK, &mut field);
        let grown = volume.layer(layer);
        let rows = grown.values.par_chunks(field.width).zip(field.values.par_chunks(field.width));
        rows.enumerate().for_each(|(y, (grown, field))| {
            for (x, (grown, field)) in grown.iter().zip(field).enumerate() {
                if *grown > field + FELT {
                    collector.mark(x, y, layer);
                    added.fetch_add(u64::from(*grown >= ISO && *field < ISO), Ordering::Relaxed);
                }
            }
        });
        *collector.layer_mut(layer) = grown;
        collector.advance(layer);
    }
    let added = added.into_inner();
    let bricks = collector.finish(region.sides[2]);
    if added == 0 {
        return Ok(None);
    }
    let image =
        VoxelImage::new(region.spacing, TOP, Beyond::Nothing, region.ends_within(&child.support()), &bricks);
    image.map(|image| Some((image, added))).map_err(|e| BakeError::Impossible(e.to_string()))
}
