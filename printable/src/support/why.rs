//! Why a voxel was taken or added.

use super::Element;
use super::element::shifted;
use crate::VoxelGrid;

/// Why a voxel is not there any more, or there all of a sudden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// It was asked for: the brush added or removed it.
    Brushed,
    /// Taken: nothing of its part of the layer is carried from below; it would have been printed in the air.
    Island,
    /// Taken: its part of the layer is carried elsewhere, but overhangs too far here.
    TooSteep,
    /// Grown, so that this voxel is carried.
    GrownFor([usize; 3]),
}

/// Tells an island from an overhang: whether the part of the layer that a taken voxel belonged to, with all that was
/// taken of it, is carried anywhere. Voxels that touch, corners included, are one part.
pub(super) fn taken(grid: &VoxelGrid, element: &Element, taken: &[(u32, u64)], voxel: [usize; 3]) -> Why {
    let [nx, ny, _] = grid.solid.size;
    let z = voxel[2];
    let Some(below) = z.checked_sub(1) else { return Why::Brushed };
    let mut open = vec![false; nx * ny];
    for y in grid.solid.kept(z) {
        for x in 0..nx {
            open[y * nx + x] = grid.solid.get([x, y, z]);
        }
    }
    for &(number, bits) in taken {
        let [w, y, layer] = grid.solid.word_place(number);
        if layer == z {
            crate::voxels::ones(bits).for_each(|bit| open[y * nx + w * 64 + bit] = true);
        }
    }
    let carried = |place| {
        element.carriers(below, place, [nx, ny]).into_iter().any(|[x, y]| grid.solid.get([x, y, below]))
    };
    let mut waiting = vec![[voxel[0], voxel[1]]];
    open[voxel[1] * nx + voxel[0]] = false;
    while let Some(place) = waiting.pop() {
        if carried(place) {
            return Why::TooSteep;
        }
        for offset in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [dx, dy])) {
            if let Some([x, y]) = shifted(place, offset, [nx, ny]).filter(|&[x, y]| open[y * nx + x]) {
                open[y * nx + x] = false;
                waiting.push([x, y]);
            }
        }
    }
    Why::Island
}
