//! Rays against a field, tile by tile and brick by brick.
//!
//! The field stands in camera space, so that a brick of samples is 16 × 16 rays wide and 16 steps deep.

use super::buffer::{Buffer, Frame, Kind, Sample};
use crate::failure::Failure;
use crate::job::Watch;
use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, ISO, Painter, Palette, Sampler};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Cells between the samples of a brick: neighbours in depth share a layer of samples.
const CELLS: i32 = BRICK as i32 - 1;
/// Rays in a tile.
const TILE: usize = BRICK * BRICK;
/// Steps of the root finding: the bracket is one ray's distance wide, and each step gains two digits.
const STEPS: usize = 4;
/// Most steps in depth: a picture of a needle from its end.
pub const MOST_STEPS: f32 = 4e6;

/// Sends the rays of `frame` through `field` and notes the first surface each meets.
///
/// - **In:** both in camera space; `solid` holds the solid, mm.
/// - **Errors:** [`Failure::Interrupted`].
pub fn cast(
    field: &dyn Field,
    solid: Aabb,
    palette: &Palette,
    frame: Frame,
    watch: &Watch,
) -> Result<Buffer, Failure> {
    let mut buffer = Buffer::new(frame);
    let deep = [solid.min.z, solid.max.z].map(|z| z / frame.pitch);
    let back = deep[0].floor() as i32 - 1;
    let depth = Depth { back, bricks: ((deep[1].ceil() as i32 + 1 - back) / CELLS + 1).max(1) };
    let bands = frame.rows.div_ceil(BRICK);
    let done = AtomicUsize::new(0);
    let rows = buffer.samples.par_chunks_mut(frame.columns * BRICK).enumerate();
    rows.for_each_init(
        || Caster::new(field.sampler(), palette.painter(), frame, depth),
        |caster, (band, samples)| {
            if watch.go_on().is_ok() {
                caster.visit_columns(band * BRICK, 0..frame.columns.div_ceil(BRICK), samples);
                watch.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / bands as f32);
            }
        },
    );
    watch.go_on()?;
    Ok(buffer)
}

/// The bricks along the rays.
#[derive(Clone, Copy, Debug)]
struct Depth {
    /// Lattice index of the last sample.
    back: i32,
    bricks: i32,
}

/// A ray's first change from outside to inside.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    ray: usize,
    /// Depth and value outside.
    outside: [f32; 2],
    /// Depth and value inside.
    inside: [f32; 2],
}

/// One thread's rays.
struct Caster<'a> {
    sampler: Box<dyn Sampler + 'a>,
    painter: Painter<'a>,
    frame: Frame,
    depth: Depth,
    values: Box<[f32; BRICK_SAMPLES]>,
    met: [bool; TILE],
    brackets: Vec<Bracket>,
}

impl<'a> Caster<'a> {
    fn new(sampler: Box<dyn Sampler + 'a>, painter: Painter<'a>, frame: Frame, depth: Depth) -> Self {
        let brackets = Vec::with_capacity(TILE);
        Self {
            sampler,
            painter,
            frame,
            depth,
            values: Box::new([0.0; BRICK_SAMPLES]),
            met: [false; TILE],
            brackets,
        }
    }

    /// The brick of the tile at these columns and rows, `number` bricks from the back.
    fn brick(&self, column: usize, row: usize, number: i32) -> Brick {
        // Rows run down, the lattice runs up: a tile's lowest lattice row is its last.
        let y = self.frame.y_index(row) - CELLS;
        Brick {
            origin: [self.frame.x_index(column), y, self.depth.back + number * CELLS],
            spacing: self.frame.pitch,
        }
    }

    /// The region of a row of tiles over some of the bricks.
    fn region(&self, row: usize, tiles: &std::ops::Range<usize>, bricks: std::ops::Range<i32>) -> Aabb {
        let first = self.brick(tiles.start * BRICK, row, bricks.start).region();
        first.union(&self.brick((tiles.end - 1) * BRICK, row, bricks.end - 1).region())
    }

    /// All tiles of a row between these.
    fn visit_columns(&mut self, row: usize, tiles: std::ops::Range<usize>, samples: &mut [Sample]) {
        let bound = self.sampler.enter(self.region(row, &tiles, 0..self.depth.bricks));
        if bound.hi >= ISO {
            let middle = tiles.start.midpoint(tiles.end);
            if tiles.len() == 1 {
                self.cast_tile(row, tiles.start, samples);
            } else {
                self.visit_columns(row, tiles.start..middle, samples);
                self.visit_columns(row, middle..tiles.end, samples);
            }
        }
        self.sampler.leave();
    }

    /// One tile, whose whole depth is entered.
    fn cast_tile(&mut self, row: usize, tile: usize, samples: &mut [Sample]) {
        self.met = [false; TILE];
        self.brackets.clear();
        self.visit_depth(row, tile, 0..self.depth.bricks);
        if self.brackets.is_empty() {
            return;
        }
        let points = self.refined(row, tile);
        let mut met = vec![blobtree::Sample::default(); points.len()];
        self.sampler.samples(&points, &mut met);
        let colors = self.painter.colors(&points);
        for (((bracket, point), sample), color) in self.brackets.iter().zip(&points).zip(&met).zip(colors) {
            let (column, line) = (tile * BRICK + bracket.ray % BRICK, BRICK - 1 - bracket.ray / BRICK);
            let index = line * self.frame.columns + column;
            if column < self.frame.columns && index < samples.len() {
                samples[index] = Sample::new(point.z, -sample.gradient, color, Kind::Surface);
            }
        }
    }

    /// The bricks of a tile, nearest first, until every ray has met something.
    fn visit_depth(&mut self, row: usize, tile: usize, bricks: std::ops::Range<i32>) {
        if self.brackets.len() == TILE {
            return;
        }
        let bound = self.sampler.enter(self.region(row, &(tile..tile + 1), bricks.clone()));
        if bound.hi >= ISO {
            let middle = bricks.start.midpoint(bricks.end);
            if bricks.len() == 1 {
                let brick = self.brick(tile * BRICK, row, bricks.start);
                self.sampler.fill(&brick, &mut self.values);
                self.scan(&brick);
            } else {
                self.visit_depth(row, tile, middle..bricks.end);
                self.visit_depth(row, tile, bricks.start..middle);
            }
        }
        self.sampler.leave();
    }

    /// Notes the rays that first come inside in this brick.
    fn scan(&mut self, brick: &Brick) {
        let layers = self.values.as_chunks::<TILE>().0;
        for (k, layer) in layers.iter().enumerate().rev() {
            for (ray, &value) in layer.iter().enumerate() {
                if value >= ISO && !self.met[ray] {
                    self.met[ray] = true;
                    let depth = |layer| brick.point([0, 0, layer]).z;
                    // Before the first layer of the brick every ray was outside.
                    let before = layers.get(k + 1).map_or(0.0, |layer| layer[ray]);
                    let outside = [if k + 1 < BRICK { depth(k + 1) } else { depth(k) }, before];
                    self.brackets.push(Bracket { ray, outside, inside: [depth(k), value] });
                }
            }
        }
    }

    /// The places where the rays cross the surface, by false position on all of them at once.
    fn refined(&mut self, row: usize, tile: usize) -> Vec<Vec3> {
        let brick = self.brick(tile * BRICK, row, 0);
        let mut ends: Vec<[[f32; 2]; 2]> = self.brackets.iter().map(|b| [b.outside, b.inside]).collect();
        let mut points: Vec<Vec3> = self
            .brackets
            .iter()
            .map(|b| brick.point([b.ray % BRICK, b.ray / BRICK, 0]).with_z(b.inside[0]))
            .collect();
        let mut values = vec![0.0; points.len()];
        for _ in 0..STEPS {
            points.iter_mut().zip(&ends).for_each(|(p, ends)| p.z = secant(ends));
            self.sampler.values(&points, &mut values);
            for ((ends, point), &value) in ends.iter_mut().zip(&points).zip(&values) {
                narrow(ends, [point.z, value]);
            }
        }
        points.iter_mut().zip(&ends).for_each(|(p, ends)| p.z = secant(ends));
        points
    }
}

/// Where the line through both ends is at the surface's value, between them.
fn secant([[z0, v0], [z1, v1]]: &[[f32; 2]; 2]) -> f32 {
    let t = (ISO - v0) / (v1 - v0);
    if t.is_finite() { z0 + (z1 - z0) * t.clamp(0.0, 1.0) } else { z0.midpoint(*z1) }
}

/// Puts a new point in the place of the end on its side, and moves the other one's value towards the surface
/// so that both ends get closer.
fn narrow(ends: &mut [[f32; 2]; 2], new: [f32; 2]) {
    let side = usize::from(new[1] >= ISO);
    ends[side] = new;
    let other = &mut ends[1 - side][1];
    *other = other.midpoint(ISO);
}
