//! Grow: matter below what nothing carries.

use super::carry::Carrier;
use super::changes::{voxel_number, voxel_of};
use super::paths::Paths;
use super::{Changes, Element};
use crate::VoxelGrid;
use crate::voxels::{Block, for_width, ones};
use std::collections::HashMap;

/// Adds a supporting path below every voxel that nothing carries, from the top down.
///
/// - **In:** `paths` says where paths go; `material` is that of what is grown.
/// - **Promises:** only adds; nothing unsupported is left; every grown voxel carries the one it was grown for, and
///   stands on the bed, on what was there, or on another grown one. A path ends at the first voxel that is carried.
/// - **Cost:** one pass, and a look at the voxels around each grown one.
/// - **Source:** Reiner & Lefebvre 2016, "grow". **Departs:** theirs adds one path for each position of the brush and
///   puts the brush along it, as [`Action::AddGrow`](crate::Action::AddGrow) does; here paths are a voxel wide and
///   join where they meet.
pub fn grow(grid: &mut VoxelGrid, element: &Element, paths: &dyn Paths, material: u8) -> Changes {
    let mut changes = Changes::default();
    grow_below(grid, element, paths, material, None, &mut changes);
    changes
}

/// The same, of the voxels in `only` alone, if given, and of those that are grown.
pub(crate) fn grow_below(
    grid: &mut VoxelGrid,
    element: &Element,
    paths: &dyn Paths,
    material: u8,
    only: Option<&crate::voxels::Bits>,
    changes: &mut Changes,
) {
    // What each grown voxel of the layer at hand was grown for.
    let mut causes = HashMap::new();
    for z in (1..grid.solid.size[2]).rev() {
        let hanging = hanging_in(grid, element, z, only, &causes);
        let mut grown = HashMap::new();
        for [x, y] in hanging {
            if is_carried(grid, element, [x, y, z]) {
                continue;
            }
            let [below_x, below_y] = paths.below([x, y, z]);
            let below = [below_x, below_y, z - 1];
            let number = voxel_number(grid, [x, y, z]);
            let cause = causes.get(&number).copied().unwrap_or(number);
            add_grown(grid, below, material, changes);
            changes.grow(grid, below, cause);
            grown.insert(voxel_number(grid, below), cause);
        }
        causes = grown;
    }
}

/// The voxels of a layer that nothing carries, row by row; with `only`, those in it or grown.
fn hanging_in(
    grid: &VoxelGrid,
    element: &Element,
    z: usize,
    only: Option<&crate::voxels::Bits>,
    grown: &HashMap<u32, u32>,
) -> Vec<[usize; 2]> {
    if let Some(only) = only {
        let mut places: Vec<_> = only.iter_layer(z).collect();
        places.extend(grown.keys().map(|&number| voxel_of(grid, number)).map(|[x, y, _]| [x, y]));
        places.sort_unstable_by_key(|&[x, y]| [y, x]);
        places.dedup();
        places.retain(|&[x, y]| grid.solid.get([x, y, z]));
        return places;
    }
    let mut places = Vec::new();
    for_width!(grid.solid.words, W => {
        let mut carrier = Carrier::<W>::new(&grid.solid);
        let mut carried = Block::default();
        let (here, below) = (grid.solid.layers[z].rows::<W>(), grid.solid.layers[z - 1].rows());
        carrier.carried(element.steps(z - 1), below, here.range(), &mut carried);
        for y in here.range() {
            let (here, carried) = (here.at(y), carried.as_rows().at(y));
            places.extend((0..W).flat_map(|w| ones(here[w] & !carried[w]).map(move |x| [w * 64 + x, y])));
        }
    });
    places
}

/// Whether the layer below carries a voxel above the bed.
pub(crate) fn is_carried(grid: &VoxelGrid, element: &Element, [x, y, z]: [usize; 3]) -> bool {
    let [nx, ny, _] = grid.solid.size;
    element.carriers(z - 1, [x, y], [nx, ny]).into_iter().any(|[x, y]| grid.solid.get([x, y, z - 1]))
}

/// Makes one voxel solid.
fn add_grown(grid: &mut VoxelGrid, [x, y, z]: [usize; 3], material: u8, changes: &mut Changes) {
    for_width!(grid.solid.words, W => {
        let old = grid.solid.layers[z].rows::<W>().at(y);
        let voxel = crate::voxels::run_of_bits::<W>(x, x + 1);
        let new = std::array::from_fn(|w| old[w] | voxel[w]);
        changes.write::<W>(grid, [y, z], [old, new]);
        changes.paint::<W>(grid, [y, z], voxel, material);
    });
}
