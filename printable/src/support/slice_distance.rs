//! How far each place of a slice is from the solid in it.

use crate::VoxelGrid;

/// For every place of layer z, row by row: voxels along x and along y to the closest solid voxel (city-block
/// distance); as large as the grid if there is none.
pub(super) fn slice_distances(grid: &VoxelGrid, z: usize) -> Vec<u16> {
    let [nx, ny, _] = grid.solid.size;
    let none = (nx + ny) as u16;
    let mut distance = vec![none; nx * ny];
    for y in grid.solid.kept(z) {
        for w in 0..grid.solid.words {
            crate::voxels::ones(grid.solid.word([w, y, z])).for_each(|x| distance[y * nx + w * 64 + x] = 0);
        }
    }
    for y in 1..ny {
        let (before, here) = distance.split_at_mut(y * nx);
        nearer(&before[(y - 1) * nx..], &mut here[..nx]);
    }
    for y in (1..ny).rev() {
        let (before, here) = distance.split_at_mut(y * nx);
        nearer(&here[..nx], &mut before[(y - 1) * nx..]);
    }
    for row in distance.chunks_exact_mut(nx) {
        let mut last = none;
        for distance in row.iter_mut() {
            last = (*distance).min(last + 1);
            *distance = last;
        }
        for distance in row.iter_mut().rev() {
            last = (*distance).min(last + 1);
            *distance = last;
        }
    }
    distance
}

/// Lowers the distances of a row to one more than those of the row beside it.
fn nearer(beside: &[u16], row: &mut [u16]) {
    for (distance, beside) in row.iter_mut().zip(beside) {
        *distance = (*distance).min(beside + 1);
    }
}
