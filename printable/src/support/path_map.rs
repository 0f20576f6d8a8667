//! The path map that knows solids: for every voxel, where the cheapest supporting path goes on.

use super::Element;
use super::element::{Step, shifted};
use super::paths::{Paths, ground_distance};
use super::slice_distance::slice_distances;
use crate::VoxelGrid;
use pulp::NullaryFnOnce;
use rayon::prelude::*;

/// What a path costs; of equally cheap ones, the one that goes straight down is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathCost {
    /// Layers climbed since the path left a solid, or climbed since the bed plus the distance there.
    Climbed,
    /// The paper's first cost: the distances, in its slice, of each voxel of the path from the closest solid one, in
    /// voxels along x and y, and one for each layer. Where a slice holds nothing solid, the distance is as large as
    /// the grid.
    InSlice,
}

/// The cheapest supporting paths of a whole grid, which may start on any solid or on the bed.
///
/// **Memory:** a byte for every two steps of every voxel: 128 MiB for 512³ with overhangs of up to 63° on cubic
/// voxels, and 512 MiB with the finest voxels that there are elements for. Twice two layers of costs while it is made.
/// **Source:** Reiner & Lefebvre 2016, "grow" and §3.2. **Departs:** their map knows the solid on the bed only, which
/// [`super::GroundPaths`] does without a map.
#[derive(Clone, Debug)]
pub struct PathMap {
    size: [usize; 3],
    /// Voxels in a row of a plane: those of the grid, rounded up to whole words.
    row: usize,
    /// Steps that a layer takes.
    steps: usize,
    /// Two directions in each byte, for all steps of a layer and all layers but the lowest.
    directions: Vec<u8>,
}

/// A direction: where the voxel came from along x, in two bits (0, −1 or 1), and along y, in two more.
const FROM_LOWER_X: u16 = 1;
const FROM_HIGHER_X: u16 = 2;
const FROM_LOWER_Y: u16 = 4;
const FROM_HIGHER_Y: u16 = 8;
/// Bits of a key that hold the direction; the others hold the cost.
const DIRECTION: u16 = 15;
/// The key of a place that no path comes from; costs end below it.
const FAR: u16 = !DIRECTION;

impl PathMap {
    /// Finds the cheapest paths, in one sweep from the bed up.
    ///
    /// **Cost:** about a nanosecond a voxel and step, on one thread; [`PathCost::InSlice`] several times that, partly on
    /// all threads. Costs beyond 4,095 are taken for equal.
    pub fn new(grid: &VoxelGrid, element: &Element, cost: PathCost) -> Self {
        let mut map = Self { size: [0; 3], row: 0, steps: 0, directions: Vec::new() };
        map.update(grid, element, cost);
        map
    }

    /// The same in the memory of this map: after every stroke, say.
    pub fn update(&mut self, grid: &VoxelGrid, element: &Element, cost: PathCost) {
        let [nx, ny, nz] = grid.solid.size;
        let row = grid.solid.words * 64;
        let layer = row * ny * element.reach().div_ceil(2);
        (self.size, self.row, self.steps) = ([nx, ny, nz], row, element.reach());
        self.directions.resize(layer * (nz - 1), 0);
        let mut costs = Costs::on_the_bed(grid, element);
        let arch = pulp::Arch::new();
        let layers_at_once = match cost {
            PathCost::Climbed => nz,
            PathCost::InSlice => 4 * rayon::current_num_threads(),
        };
        let mut slices = Vec::new();
        for (n, layer) in self.directions.chunks_exact_mut(layer).enumerate() {
            let z = n + 1;
            if cost == PathCost::InSlice && n % layers_at_once == 0 {
                let wanted = z..(z + layers_at_once).min(nz);
                slices = wanted.into_par_iter().map(|z| slice_distances(grid, z)).collect();
            }
            for (n, &step) in element.steps(z - 1).iter().enumerate() {
                let plane = &mut layer[n / 2 * row * ny..][..row * ny];
                arch.dispatch(Spread { step, costs: &mut costs, plane, nx, second: n % 2 == 1 });
                std::mem::swap(&mut costs.keys, &mut costs.next);
            }
            arch.dispatch(Climb { costs: &mut costs, further: slices.get(n % layers_at_once), nx });
            costs.start_on(grid, z);
        }
    }

    /// Bytes that the map takes.
    pub fn bytes(&self) -> usize {
        self.directions.len()
    }
}

impl Paths for PathMap {
    fn below(&self, [x, y, z]: [usize; 3]) -> [usize; 2] {
        let [nx, ny, _] = self.size;
        let plane = self.row * ny;
        let layer = (z - 1) * plane * self.steps.div_ceil(2);
        let mut place = [x, y];
        for step in (0..self.steps).rev() {
            let [x, y] = place;
            let byte = self.directions[layer + step / 2 * plane + y * self.row + x];
            let direction = u16::from(byte >> (4 * (step % 2))) & DIRECTION;
            let sign = |lower: u16, higher: u16| {
                i32::from(direction & higher != 0) - i32::from(direction & lower != 0)
            };
            let offset = [sign(FROM_LOWER_X, FROM_HIGHER_X), sign(FROM_LOWER_Y, FROM_HIGHER_Y)];
            place = shifted(place, offset, [nx, ny]).unwrap_or(place);
        }
        place
    }
}

/// The keys of a layer, cost and direction in one, with a margin of one on every side.
struct Costs {
    /// Voxels in a row, without the margin.
    row: usize,
    keys: Vec<u16>,
    next: Vec<u16>,
}

impl Costs {
    /// Those of the lowest layer: the distance to the solid on the bed.
    fn on_the_bed(grid: &VoxelGrid, element: &Element) -> Self {
        let [nx, ny, _] = grid.solid.size;
        let row = grid.solid.words * 64;
        let mut keys = vec![FAR; (row + 2) * (ny + 2)];
        for (y, distances) in ground_distance(grid, element).chunks_exact(nx).enumerate() {
            for (x, &distance) in distances.iter().enumerate() {
                keys[(y + 1) * (row + 2) + x + 1] = distance.min(FAR >> 4) << 4;
            }
        }
        Self { row, next: keys.clone(), keys }
    }

    /// Paths may start on any solid voxel of layer z.
    fn start_on(&mut self, grid: &VoxelGrid, z: usize) {
        for y in grid.solid.kept(z) {
            let keys = &mut self.keys[(y + 1) * (self.row + 2) + 1..][..self.row];
            for (w, keys) in keys.as_chunks_mut::<64>().0.iter_mut().enumerate() {
                let word = grid.solid.word([w, y, z]);
                if word == 0 {
                    continue;
                }
                for (part, keys) in keys.as_chunks_mut::<16>().0.iter_mut().enumerate() {
                    let bits = (word >> (16 * part)) as u16;
                    for (x, key) in keys.iter_mut().enumerate() {
                        *key = if bits & (1 << x) == 0 { *key } else { 0 };
                    }
                }
            }
        }
    }
}

/// One step: the cheapest key of each place and of those that the step reaches it from, and its direction.
struct Spread<'a> {
    step: Step,
    costs: &'a mut Costs,
    plane: &'a mut [u8],
    /// Voxels along x; there is nothing beyond.
    nx: usize,
    /// Whether directions go into the upper halves of the bytes of the plane, which hold those of the step before.
    second: bool,
}

impl NullaryFnOnce for Spread<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let row = self.costs.row;
        // A place that the step does not come from gets a key above all others.
        let [x, y, rising, falling] = self.step.masks().map(|mask| !(mask as u16));
        let [west, east] = [FROM_LOWER_X | x, FROM_HIGHER_X | x];
        let [south, north] = [FROM_LOWER_Y | y, FROM_HIGHER_Y | y];
        let [south_west, north_east] =
            [FROM_LOWER_Y | FROM_LOWER_X | rising, FROM_HIGHER_Y | FROM_HIGHER_X | rising];
        let [south_east, north_west] =
            [FROM_LOWER_Y | FROM_HIGHER_X | falling, FROM_HIGHER_Y | FROM_LOWER_X | falling];
        let Costs { keys, next, .. } = self.costs;
        for (y, plane) in self.plane.chunks_exact_mut(row).enumerate() {
            let line = |y: usize| &keys[y * (row + 2)..][..self.nx + 2];
            let next = &mut next[(y + 1) * (row + 2) + 1..][..self.nx];
            let plane = &mut plane[..self.nx];
            let from = [[south_west, south, south_east], [west, 0, east], [north_west, north, north_east]];
            if self.second {
                spread_row::<true>([line(y), line(y + 1), line(y + 2)], from, next, plane);
            } else {
                spread_row::<false>([line(y), line(y + 1), line(y + 2)], from, next, plane);
            }
        }
    }
}

/// The cheapest keys of a row and their directions, from the lines around it, each with a margin of one. `from` holds
/// the direction from each of the nine places.
#[inline(always)]
fn spread_row<const SECOND: bool>(
    lines: [&[u16]; 3],
    from: [[u16; 3]; 3],
    next: &mut [u16],
    plane: &mut [u8],
) {
    let count = next.len().min(plane.len());
    let (next, plane) = (&mut next[..count], &mut plane[..count]);
    let [below, here, above] = lines.map(|line| [0, 1, 2].map(|shift| &line[shift..][..count]));
    for x in 0..count {
        let lowest = |places: [&[u16]; 3], from: [u16; 3]| {
            (places[0][x] | from[0]).min(places[1][x] | from[1]).min(places[2][x] | from[2])
        };
        let key = lowest(below, from[0]).min(lowest(here, from[1])).min(lowest(above, from[2]));
        next[x] = key & !DIRECTION;
        let direction = (key & DIRECTION) as u8;
        plane[x] = if SECOND { plane[x] | direction << 4 } else { direction };
    }
}

/// A layer climbed: one more for every path, and how far it is from the solid in its slice.
struct Climb<'a> {
    costs: &'a mut Costs,
    further: Option<&'a Vec<u16>>,
    nx: usize,
}

impl NullaryFnOnce for Climb<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let row = self.costs.row;
        let lines = self.costs.keys.chunks_exact_mut(row + 2).skip(1);
        for (y, line) in lines.take(self.further.map_or(usize::MAX, |all| all.len() / self.nx)).enumerate() {
            let line = &mut line[1..=row];
            if let Some(further) = self.further {
                for (key, further) in line.iter_mut().zip(&further[y * self.nx..][..self.nx]) {
                    *key = key.saturating_add(further << 4) & FAR;
                }
            }
            for key in line {
                *key = key.saturating_add(1 << 4) & FAR;
            }
        }
    }
}
