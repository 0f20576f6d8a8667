//! How far from what holds it a hanging place reaches.

use crate::slices::clip::{Region, pairs};
use crate::slices::grid::Grid;
use crate::slices::rect::Rect;
use glam::{DVec2, Vec3};
use mesh::{Bvh, Mesh};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The farthest point is found to this, mm.
const ACCURACY: f64 = 0.02;
/// Most cells that are opened for one place; those so long and thin that they need more have their farthest point
/// close to a vertex.
const PATIENCE: usize = 100;
/// Most cells along the longer side to begin with.
const FIRST_CELLS: f64 = 32.0;

/// The outlines of a layer, to measure distances to it from outside.
pub(super) struct Held {
    /// Sides as triangles without area, around a centre of their own so that `f32` tells them to 10 nm and better.
    sides: Bvh,
    centre: DVec2,
    empty: bool,
}

impl Held {
    pub(super) fn new(regions: &[Region], grid: &Grid) -> Self {
        let centre =
            Rect::around(regions).map_or(DVec2::ZERO, |r| grid.place(r.min).midpoint(grid.place(r.max)));
        let mut mesh = Mesh::default();
        for ring in regions.iter().flatten() {
            for (a, b) in pairs(ring) {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend([a, b].map(|p| (grid.place(p) - centre).as_vec2().extend(0.0)));
                mesh.triangles.push([first, first + 1, first + 1]);
            }
        }
        Self { empty: mesh.triangles.is_empty(), sides: Bvh::new(&mesh), centre }
    }

    /// Distance from a place outside the layer, mm; none if the layer is empty.
    fn distance(&self, p: DVec2) -> Option<f64> {
        let p: Vec3 = (p - self.centre).as_vec2().extend(0.0);
        self.sides.closest(p, f64::INFINITY).map(|closest| closest.distance)
    }
}

/// The point of a region that is farthest from what is `held`, and how far that is, mm.
///
/// A `narrow` region has no place far from its vertices' distances, so only those are asked. In others, the search
/// is best first over square cells, as polylabel finds the middle of a polygon.
pub(super) fn farthest(region: &Region, narrow: bool, held: &Held, grid: &Grid) -> (DVec2, Option<f64>) {
    let vertices = region.iter().flatten().map(|&p| grid.place(p));
    if held.empty {
        return (vertices.clone().next().unwrap_or(DVec2::ZERO), None);
    }
    let mut search = Search { rings: places(region, grid), held, best: (DVec2::ZERO, f64::NEG_INFINITY) };
    for p in vertices {
        search.offer(p);
    }
    let mut cells = if narrow { BinaryHeap::new() } else { search.first_cells() };
    for _ in 0..PATIENCE {
        let Some(cell) = cells.pop().filter(|cell| cell.most > search.best.1 + ACCURACY) else { break };
        let half = cell.half * 0.5;
        for corner in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            cells.extend(search.cell(cell.middle + half * DVec2::from(corner), half));
        }
    }
    (search.best.0, Some(search.best.1))
}

fn places(region: &Region, grid: &Grid) -> Vec<Vec<DVec2>> {
    region.iter().map(|ring| ring.iter().map(|&p| grid.place(p)).collect()).collect()
}

struct Search<'a> {
    rings: Vec<Vec<DVec2>>,
    held: &'a Held,
    best: (DVec2, f64),
}

impl Search<'_> {
    fn offer(&mut self, p: DVec2) -> f64 {
        let distance = self.held.distance(p).unwrap_or(0.0);
        if distance > self.best.1 {
            self.best = (p, distance);
        }
        distance
    }

    /// Cells that cover the region.
    fn first_cells(&mut self) -> BinaryHeap<Cell> {
        let points = || self.rings.iter().flatten().copied();
        let min = points().fold(DVec2::INFINITY, DVec2::min);
        let size = points().fold(DVec2::NEG_INFINITY, DVec2::max) - min;
        let side = size.min_element().max(size.max_element() / FIRST_CELLS);
        let count = (size / side).ceil().max(DVec2::ONE);
        let mut cells = BinaryHeap::new();
        for row in 0..count.y as usize {
            for column in 0..count.x as usize {
                let middle = min + side * (DVec2::new(column as f64, row as f64) + 0.5);
                cells.extend(self.cell(middle, 0.5 * side));
            }
        }
        cells
    }

    /// A cell, if it meets the region.
    fn cell(&mut self, middle: DVec2, half: f64) -> Option<Cell> {
        let (inside, to_outline) = self.look(middle);
        let diagonal = half * std::f64::consts::SQRT_2;
        if !inside && to_outline > diagonal {
            return None;
        }
        let distance = if inside { self.offer(middle) } else { self.held.distance(middle)? };
        Some(Cell { middle, half, most: distance + diagonal })
    }

    /// Whether a place is in the region, and its distance to the outline.
    fn look(&self, p: DVec2) -> (bool, f64) {
        let (mut inside, mut nearest) = (false, f64::INFINITY);
        for ring in &self.rings {
            let sides = ring.iter().zip(ring.iter().skip(1).chain(ring.first()));
            for (&a, &b) in sides {
                let side = b - a;
                let along =
                    ((p - a).dot(side) / side.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                nearest = nearest.min(p.distance_squared(a + side * along));
                if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / side.y * side.x {
                    inside = !inside;
                }
            }
        }
        (inside, nearest.sqrt())
    }
}

/// A square with an upper bound of the distances in it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    middle: DVec2,
    half: f64,
    most: f64,
}

impl Eq for Cell {}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_place =
            || self.middle.x.total_cmp(&other.middle.x).then(self.middle.y.total_cmp(&other.middle.y));
        self.most.total_cmp(&other.most).then_with(by_place)
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
