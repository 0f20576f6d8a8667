//! Groups of chains that touch each other: each is one outline, drawn in parts.

use super::chains::Chain;
use super::raster::Raster;
use glam::DVec2;

/// Cells across the drawing; lines that come as near as a cell touch.
const CELLS: usize = 400;

/// Chains, by number, that touch each other directly or through others; the largest group first.
pub(super) fn groups(chains: &[Chain], bridges: &[(usize, usize, [DVec2; 2])]) -> Vec<Vec<usize>> {
    let mut parents: Vec<usize> = (0..chains.len()).collect();
    let raster = Raster::over(DVec2::splat(-0.5), DVec2::splat(0.5), CELLS, 0.02);
    let mut owners: Vec<Option<usize>> = vec![None; raster.count()];
    for (k, chain) in chains.iter().enumerate() {
        let mut cells = Vec::new();
        raster.paint(&chain.path(), |cell| cells.push(cell));
        for &cell in &cells {
            for dy in [0, raster.width, 2 * raster.width] {
                for dx in 0..3 {
                    let near = (cell + dy + dx).checked_sub(raster.width + 1);
                    if let Some(owner) = near.and_then(|near| owners.get(near).copied().flatten()) {
                        join(&mut parents, owner, k);
                    }
                }
            }
        }
        for cell in cells {
            owners[cell].get_or_insert(k);
        }
    }
    for &(a, b, _) in bridges {
        join(&mut parents, a, b);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); chains.len()];
    for k in 0..chains.len() {
        let root = root(&mut parents, k);
        groups[root].push(k);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

fn root(parents: &mut [usize], mut k: usize) -> usize {
    while parents[k] != k {
        parents[k] = parents[parents[k]];
        k = parents[k];
    }
    k
}

fn join(parents: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b)] = a.min(b);
}
