//! Voxels of a field.

use super::bits::{Block, Row, for_width, run_of_bits};
use super::{GridShape, VoxelError, VoxelGrid, VoxelSize};
use blobtree::{Aabb, Field, ISO, Sampler};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Voxels along each side of a brick, which is sampled if bounds do not settle it.
const BRICK: usize = 16;
/// Voxels along x and y of a block of bricks, which is bounded first.
const BLOCK: usize = 64;
/// Parts along each axis into which a box is cut to find the solid in it, and how often.
const PARTS: u16 = 16;
const ROUNDS: usize = 3;

impl VoxelGrid {
    /// The solid of a field: every voxel at whose centre the field is at least 0.5.
    ///
    /// - **Promises:** exactly that, for every voxel; the same for any number of threads.
    /// - **Cost:** one sample for each voxel of the bricks of 16³ that bounds do not prove empty or full, on all
    ///   threads of the current pool.
    /// - **Errors:** more than [`MAX_VOXELS`](super::MAX_VOXELS) along a side; nothing solid; solid below the bed;
    ///   nothing on the bed.
    pub fn from_field(field: &dyn Field, size: VoxelSize) -> Result<Self, VoxelError> {
        let bounds = solid_bounds(field);
        let shape = GridShape::covering(bounds, size)?;
        let mut grid = Self::new(shape);
        if bounds.min.z < -0.5 * size.height() && any_below_bed(field, &shape) {
            let layers = (-bounds.min.z / size.height()).ceil();
            return Err(VoxelError::BelowBed { by: layers * size.height() });
        }
        for_width!(grid.solid.words, W => fill::<W>(field, &mut grid));
        grid.on_the_bed()
    }

    /// The same of what is above the bed, wherever the field's solid lies.
    ///
    /// Errors: more than [`MAX_VOXELS`](super::MAX_VOXELS) along a side; nothing solid above the bed.
    pub(crate) fn above_bed(field: &dyn Field, size: VoxelSize) -> Result<Self, VoxelError> {
        let mut grid = Self::new(GridShape::covering(solid_bounds(field), size)?);
        for_width!(grid.solid.words, W => fill::<W>(field, &mut grid));
        Ok(grid)
    }

    /// The grid itself, if it stands on the bed.
    pub(super) fn on_the_bed(self) -> Result<Self, VoxelError> {
        let lowest = self.solid_voxels().next();
        match lowest {
            None => Err(VoxelError::Empty),
            Some([_, _, 0]) => Ok(self),
            Some([_, _, z]) => Err(VoxelError::Floating { by: z as f32 * self.shape.size.height() }),
        }
    }
}

/// A box around the solid, tighter than the field's support.
pub(crate) fn solid_bounds(field: &dyn Field) -> Aabb {
    let mut sampler = field.sampler();
    let mut bounds = field.support();
    for _ in 0..ROUNDS {
        if bounds.is_empty() {
            break;
        }
        let (corner, part) = (bounds.min, bounds.size() / f32::from(PARTS));
        sampler.enter(bounds);
        let cells = (0..PARTS).flat_map(|z| (0..PARTS).flat_map(move |y| (0..PARTS).map(move |x| [x, y, z])));
        let solid = cells.map(|cell| {
            let low = Vec3::from_array(cell.map(f32::from));
            Aabb { min: corner + low * part, max: corner + (low + 1.0) * part }.intersection(&bounds)
        });
        let tighter = solid.filter(|&cell| may_be_solid(&mut *sampler, cell));
        let tighter = tighter.fold(Aabb::EMPTY, |all, cell| all.union(&cell));
        sampler.leave();
        bounds = tighter;
    }
    bounds
}

fn may_be_solid(sampler: &mut dyn Sampler, region: Aabb) -> bool {
    let bound = sampler.enter(region);
    sampler.leave();
    // Bounds that are no numbers prove nothing.
    bound.hi >= ISO || bound.hi.is_nan()
}

/// Whether the layer below the bed would hold a voxel.
fn any_below_bed(field: &dyn Field, shape: &GridShape) -> bool {
    let [nx, ny, _] = shape.voxels;
    (0..ny).into_par_iter().any(|y| {
        let places: Vec<Vec3> =
            (0..nx).map(|x| shape.center([x, y, 0]) - Vec3::new(0.0, 0.0, shape.size.height())).collect();
        let mut values = vec![0.0; nx];
        let mut sampler = field.sampler();
        sampler.enter(Aabb::of_points(places.iter().copied()));
        sampler.values(&places, &mut values);
        values.iter().any(|&value| value >= ISO)
    })
}

/// Fills the layers, 16 at a time.
fn fill<const W: usize>(field: &dyn Field, grid: &mut VoxelGrid) {
    let shape = grid.shape;
    let [nx, ny, nz] = shape.voxels;
    grid.solid.layers.par_chunks_mut(BRICK).enumerate().for_each_init(
        || (field.sampler(), Scratch::default()),
        |(sampler, scratch), (slab, layers)| {
            let z = slab * BRICK..((slab + 1) * BRICK).min(nz);
            let mut blocks: Vec<Block<W>> = vec![Block::default(); z.len()];
            blocks.iter_mut().for_each(|block| block.reset(0..ny));
            for part in parts([0..nx, 0..ny, z.clone()], BLOCK) {
                let mut slab = Slab { shape: &shape, first: z.start, blocks: &mut blocks };
                slab.settle(&mut **sampler, part, BLOCK, scratch);
            }
            for (layer, mut block) in layers.iter_mut().zip(blocks) {
                block.tighten();
                layer.set(&block);
            }
        },
    );
}

/// Voxels along x, y and z.
type Part = [Range<usize>; 3];

/// A part cut into smaller ones of at most `side` voxels along x and y.
fn parts([x, y, z]: Part, side: usize) -> impl Iterator<Item = Part> {
    let cut =
        move |range: Range<usize>| range.clone().step_by(side).map(move |n| n..(n + side).min(range.end));
    cut(y).flat_map(move |y| {
        let z = z.clone();
        cut(x.clone()).map(move |x| [x, y.clone(), z.clone()])
    })
}

#[derive(Default)]
struct Scratch {
    places: Vec<Vec3>,
    values: Vec<f32>,
}

/// Sixteen layers while they are filled.
struct Slab<'a, const W: usize> {
    shape: &'a GridShape,
    first: usize,
    blocks: &'a mut [Block<W>],
}

impl<const W: usize> Slab<'_, W> {
    /// Fills a part of at most `side` voxels along x and y.
    fn settle(&mut self, sampler: &mut dyn Sampler, part: Part, side: usize, scratch: &mut Scratch) {
        let low = part.clone().map(|range| range.start);
        let high = part.clone().map(|range| range.end - 1);
        let region = Aabb { min: self.shape.center(low), max: self.shape.center(high) };
        let bound = sampler.enter(region);
        if bound.lo >= ISO {
            self.fill(&part);
        } else if bound.hi >= ISO || bound.hi.is_nan() {
            if side == BLOCK {
                parts(part, BRICK).for_each(|part| self.settle(sampler, part, BRICK, scratch));
            } else {
                self.sample(sampler, &part, scratch);
            }
        }
        sampler.leave();
    }

    fn fill(&mut self, [x, y, z]: &Part) {
        let run: Row<W> = run_of_bits(x.start, x.end);
        for z in z.clone() {
            for y in y.clone() {
                let row = self.blocks[z - self.first].at_mut(y);
                *row = std::array::from_fn(|w| row[w] | run[w]);
            }
        }
    }

    fn sample(&mut self, sampler: &mut dyn Sampler, [x, y, z]: &Part, scratch: &mut Scratch) {
        let Scratch { places, values } = scratch;
        let rows = || z.clone().flat_map(|z| y.clone().map(move |y| (y, z)));
        places.clear();
        let shape = self.shape;
        places.extend(rows().flat_map(|(y, z)| x.clone().map(move |x| shape.center([x, y, z]))));
        values.resize(places.len(), 0.0);
        sampler.values(places, values);
        for ((y, z), values) in rows().zip(values.chunks_exact(x.len())) {
            let row = self.blocks[z - self.first].at_mut(y);
            for (x, &value) in x.clone().zip(values) {
                row[x / 64] |= u64::from(value >= ISO) << (x % 64);
            }
        }
    }
}
