//! Trim: what the layer below cannot carry is taken away, level by level of the field.

use super::anchor::{anchor, below, lift};
use super::bricks::Collector;
use super::disc::{Layer, dilate_row};
use super::path::{Between, DELAY, GAP};
use super::region::Region;
use super::slab::Slab;
use super::{REACH, Rebaker, TOP};
use blobtree::{BRICK, Bake, BakeError, Beyond, Field, ISO, VoxelImage};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// By how much a limit must be below the field to matter.
pub(super) const FELT: f32 = 5e-4;

/// Values so near to ½ can be seen in the surface.
const NEAR_SURFACE: f32 = 0.1;

/// Rows that a thread works on at a time.
const ROWS: usize = 16;

/// By how much the limit is above what the layer below carries inside the solid, below a place where it is felt first.
///
/// The filter of the image takes about as much where no samples are kept below. That bit into necks whose field is
/// hardly more than ½: with 0.005, cuts beside the middles of layers show ledges of 0.7 mm² below the flat underside of a
/// blend, with 0.05 of 0.05 mm², as overhangs begin too early then; with 0.01 none.
const HELD: f32 = 0.01;

/// How far inside the layer below, in lattice steps along x and y, nothing is limited: the field is of no matter there, and
/// above a first layer without much of a slope it would be limited for ever. Nearer to the surface, the jump shows in it.
const DEEP: usize = 8;

/// Layers in which what is well inside a slice counts as well inside the solid. Above a flat bottom the field is hardly
/// more than ½, and would limit the field of all that stands on it.
const LIFTED: usize = 24;

/// What a sweep found out.
#[derive(Debug, Default)]
struct Findings {
    removed: AtomicU64,
    touched: AtomicBool,
}

/// The layers that a sweep has in hand.
#[derive(Debug)]
struct Sweep {
    /// What the layer below carries: its field, limited.
    carried: Layer,
    /// The field in the layer below, and in this one.
    fields: [Layer; 2],
    findings: Findings,
}

/// Trims a field.
///
/// Errors: [`BakeError::Cancelled`].
pub(super) fn trim(rebaker: &Rebaker, region: &Region, child: &dyn Field) -> Result<Bake, BakeError> {
    let mut slab = Slab::new(region);
    let mut source = |layer: usize, to: &mut Layer| {
        if layer.is_multiple_of(BRICK) {
            slab.fill(region, layer, child);
        }
        slab.copy_layer(layer % BRICK, to);
    };
    sweep(rebaker, region, child, &mut source)
}

/// Sweeps layers from the bed up; `source` gives them, one after the other.
///
/// Errors: [`BakeError::Cancelled`].
pub(super) fn sweep(
    rebaker: &Rebaker,
    region: &Region,
    child: &dyn Field,
    source: &mut dyn FnMut(usize, &mut Layer),
) -> Result<Bake, BakeError> {
    let [width, depth, layers] = region.sides;
    let empty = Layer::new(width, depth, 0.0);
    let mut sweep = Sweep {
        carried: empty.clone(),
        fields: [empty.clone(), empty.clone()],
        findings: Findings::default(),
    };
    let mut next = empty;
    source(0, &mut sweep.fields[1]);
    sweep.carried = anchor(region, &sweep.fields[1], child);
    let mut collector = Collector::new(region, below(region, &sweep.fields[1], &sweep.carried, child), TOP);
    collector.layer_mut(0).values.copy_from_slice(&sweep.carried.values);
    collector.advance(0);
    for layer in 1..layers {
        if layer.is_multiple_of(BRICK) {
            rebaker.go_on()?;
        }
        sweep.fields.swap(0, 1);
        source(layer, &mut sweep.fields[1]);
        if layer < LIFTED {
            lift(&mut sweep.fields[1]);
        }
        let [mut below, mut limit] = collector.take_layers(layer);
        sweep.step(layer, [&mut below, &mut limit], &mut next, &collector);
        collector.give_layers(layer, [below, limit]);
        std::mem::swap(&mut sweep.carried, &mut next);
        collector.advance(layer);
    }
    let bricks = collector.finish(layers);
    let mut bake = Bake { cut_at_bed: region.cut_at_bed, ..Bake::default() };
    if sweep.findings.touched.into_inner() {
        let ends = [region.low, region.high()];
        let image = VoxelImage::new(region.spacing, TOP, Beyond::NoLimit, ends, &bricks);
        bake.limit = Some(Arc::new(image.map_err(|e| BakeError::Impossible(e.to_string()))?));
        bake.removed_mm3 = sweep.findings.removed.into_inner() as f64 * region.cell_mm3;
    }
    Ok(bake)
}

impl Sweep {
    /// One layer: its limit from what the layer below carries, and what it carries itself.
    fn step(
        &self,
        layer: usize,
        [limit_below, limit]: [&mut Layer; 2],
        carried: &mut Layer,
        collector: &Collector,
    ) {
        let chunk = ROWS * limit.width;
        let limits = limit_below.values.par_chunks_mut(chunk).zip(limit.values.par_chunks_mut(chunk));
        limits.zip(carried.values.par_chunks_mut(chunk)).enumerate().for_each(
            |(number, ((below, limit), carried))| {
                let width = self.carried.width;
                let below = below.chunks_exact_mut(width);
                let rows = below.zip(limit.chunks_exact_mut(width)).zip(carried.chunks_exact_mut(width));
                let mut deep = Vec::new();
                for (row, ((below, limit), carried)) in rows.enumerate() {
                    let y = number * ROWS + row;
                    let field = self.fields[1].row(y as isize);
                    dilate_row(&self.carried, y, REACH, limit);
                    let mut felt = false;
                    let known = self.carried.row(y as isize).iter().zip(field);
                    for ((carried, limit), (before, field)) in carried.iter_mut().zip(&*limit).zip(known) {
                        felt |= *field > limit + FELT || *field >= ISO && *before < ISO;
                        *carried = if limit < field { *limit } else { *field };
                    }
                    if felt {
                        self.carried.least(y, DEEP, &mut deep);
                        let within = limit.iter_mut().zip(&deep);
                        within.filter(|(_, deep)| **deep >= ISO).for_each(|(limit, _)| *limit = TOP);
                        self.feel([y, layer], [below, limit], carried, collector);
                    }
                }
            },
        );
    }

    /// Goes over a row in which the limit is felt, or something begins.
    ///
    /// Below a place where it is felt first, the limit is drawn down to what the layer below carries: so the filter
    /// of the image does not round the beginning of the overhang upwards. What is solid there stays so.
    fn feel(
        &self,
        [y, layer]: [usize; 2],
        [below, limit]: [&mut [f32]; 2],
        carried: &mut [f32],
        collector: &Collector,
    ) {
        let between = Between { carried: &self.carried, fields: [&self.fields[0], &self.fields[1]] };
        let (field, carried_below) = (self.fields[1].row(y as isize), self.carried.row(y as isize));
        let field_below = self.fields[0].row(y as isize);
        let mut removed = 0;
        for (x, field) in field.iter().enumerate() {
            if *field > limit[x] + FELT {
                if (limit[x] - ISO).abs() < NEAR_SURFACE {
                    limit[x] = between.limit(x, y, limit[x], DELAY);
                }
            } else if *field >= ISO && carried_below[x] < ISO {
                // New here, and within reach; but what begins in the air beside something else is an island.
                let through_solid = between.limit(x, y, limit[x], 0.0);
                if through_solid > ISO - GAP {
                    continue;
                }
                limit[x] = through_solid;
            } else {
                continue;
            }
            carried[x] = limit[x].min(*field);
            let is_whole = carried_below[x] >= ISO && carried_below[x] >= field_below[x];
            below[x] = carried_below[x] + if is_whole { HELD } else { 0.0 };
            collector.mark(x, y, layer);
            if limit[x] < ISO && *field > ISO - NEAR_SURFACE {
                self.findings.touched.store(true, Ordering::Relaxed);
                removed += u64::from(*field >= ISO);
            }
        }
        self.findings.removed.fetch_add(removed, Ordering::Relaxed);
    }
}
