//! Where matter should grow down to, from a voxel that nothing carries.
//!
//! A supporting path goes down one layer at a time, each time to a voxel that would carry the one above, until it
//! comes to one that is carried. Many do; the *closest* ones stay near what is there already.

use super::Element;
use super::carry::Carrier;
use crate::VoxelGrid;
use crate::voxels::{Block, MAX_VOXELS, Row, for_width, ones};

/// Supporting paths of least cost, step by step.
///
/// **Source:** Reiner & Lefebvre 2016, "grow".
pub trait Paths: Sync {
    /// The place `[x, y]` in the layer below with which a path from `voxel` goes on. `voxel` must lie in the grid,
    /// above the bed; the place does, too, and carries it.
    fn below(&self, voxel: [usize; 3]) -> [usize; 2];
}

/// Closest by the distance to the solid on the bed: the paper's cost, `layers climbed + distance on the bed`.
///
/// The distance counts the layers in which a solid could grow that far, so it is the element's own, and the cost of
/// the best path from layer k at distance D is `max(k, D)`: for D < k, paths drop straight down, and then run
/// towards the solid on the bed as steeply as the element allows, to be there in layer 0. From D > k they get as
/// near as they can. That closed form saves the path map, so all that is kept is D.
///
/// **Memory:** 2 bytes for each column of voxels, 0.5 MiB for 512².
/// **Departs:** the paper's distance is that of its square; its path map is a volume.
#[derive(Clone, Debug)]
pub struct GroundPaths {
    size: [usize; 2],
    distance: Vec<u16>,
    element: Element,
}

impl GroundPaths {
    /// Measures distances from the solid on the bed of `grid`. Without one, all paths drop straight down.
    ///
    /// **Cost:** one layer's dilation for every layer of the largest distance; a few milliseconds for 512².
    pub fn new(grid: &VoxelGrid, element: &Element) -> Self {
        let [nx, ny, _] = grid.solid.size;
        Self { size: [nx, ny], distance: ground_distance(grid, element), element: element.clone() }
    }

    /// Layers that it takes at least to grow from the solid on the bed to a column: `u16::MAX` if there is none,
    /// or it would take more than 4,096.
    pub fn distance(&self, [x, y]: [usize; 2]) -> u16 {
        self.distance[y * self.size[0] + x]
    }
}

impl Paths for GroundPaths {
    fn below(&self, [x, y, z]: [usize; 3]) -> [usize; 2] {
        if usize::from(self.distance([x, y])) < z {
            return [x, y];
        }
        let near = |[px, py]: [usize; 2]| px.abs_diff(x).pow(2) + py.abs_diff(y).pow(2);
        let carriers = self.element.carriers(z - 1, [x, y], self.size).into_iter();
        carriers.min_by_key(|&place| (self.distance(place), near(place))).unwrap_or([x, y])
    }
}

/// Layers after which distances on the bed are called infinite.
const MOST_LAYERS: u16 = 8 * MAX_VOXELS as u16;

/// How many layers it takes to grow from the solid on the bed to each column, row by row; `u16::MAX` if
/// more than [`MOST_LAYERS`].
pub(super) fn ground_distance(grid: &VoxelGrid, element: &Element) -> Vec<u16> {
    let [nx, ny, _] = grid.solid.size;
    let mut distance = vec![u16::MAX; nx * ny];
    for_width!(grid.solid.words, W => {
        let mut carrier = Carrier::<W>::new(&grid.solid);
        let (mut reached, mut next) = (Block::default(), Block::default());
        let bed = grid.solid.layers[0].rows::<W>();
        reached.first = bed.first;
        reached.rows.extend_from_slice(bed.rows);
        let full: Row<W> = grid.solid.full_row();
        let mut known = vec![[0u64; W]; ny];
        let mut unknown = if bed.rows.is_empty() { 0 } else { nx * ny };
        for layers in 0..MOST_LAYERS {
            for y in reached.range() {
                let row = reached.as_rows().at(y);
                for w in 0..W {
                    let new = row[w] & full[w] & !known[y][w];
                    known[y][w] |= new;
                    unknown -= new.count_ones() as usize;
                    ones(new).for_each(|x| distance[y * nx + w * 64 + x] = layers);
                }
            }
            if unknown == 0 {
                break;
            }
            let steps = element.steps(usize::from(layers) % MAX_VOXELS);
            carrier.carried(steps, reached.as_rows(), 0..ny, &mut next);
            std::mem::swap(&mut reached, &mut next);
        }
    });
    distance
}
