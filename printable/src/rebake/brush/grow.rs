//! What a dab needs to stand on: its tip, put down along the closest supporting path.

use super::canvas::{Canvas, FELT};
use super::dabs::layer_of;
use super::preserve::LEAN;
use super::stamp::{Block, Lattice, Shape, Stamp};
use crate::Dab;
use crate::rebake::path_map::PathMap;
use crate::rebake::strut::{SMOOTHED, TAPER, THICKER_MM};
use blobtree::ISO;
use glam::Vec3;

/// Tips along a path are no farther apart than this, in radii.
const APART: f32 = 0.25;

/// The stamp with those along the path from its middle down to matter or to the bed, each a little larger than the one
/// above it, so that it leans by less than the path.
pub(super) fn along_path(
    canvas: &Canvas,
    lattice: &Lattice,
    shape: &Shape,
    dab: &Dab,
    paths: &PathMap,
    stamp: Stamp,
) -> Stamp {
    let sides = canvas.sides();
    let at = lattice.in_steps(dab.center()).round();
    if (0..3).any(|a| !(0.0..sides[a] as f32).contains(&at[a])) {
        return stamp;
    }
    let way = way_down(canvas, paths, at.to_array().map(|x| x as usize));
    let [step, layer] = lattice.steps();
    let skip = (APART * dab.radius() / layer).floor().max(1.0) as usize;
    let mut all = stamp;
    for down in (0..way.len()).filter(|down| *down > 0 && (down % skip == 0 || down + 1 == way.len())) {
        let around = SMOOTHED.min(down).min(way.len() - 1 - down);
        let near = &way[down - around..=down + around];
        let mean = |a: usize| near.iter().map(|at| at[a] as f32).sum::<f32>() / near.len() as f32;
        let center = lattice.place_of_steps(Vec3::new(mean(0), mean(1), at.z - down as f32));
        let radius = dab.radius() + (TAPER * down as f32 * step).min(THICKER_MM);
        if let Ok(dab) = Dab::new(center, radius, 1.0)
            && let Some(stamp) = lattice.stamp(shape, &dab)
        {
            all = all.with(&stamp);
        }
    }
    all
}

/// The stamp with what carries it, down to the bed: each layer holds at least the one above, eroded, where that is more
/// than without the stamp. So it leans on what is beside it.
pub(super) fn with_foot(canvas: &Canvas, stamp: Stamp) -> Stamp {
    let Block { low, end } = stamp.block;
    let block = Block { low: [low[0], low[1], 0], end };
    let [width, depth, layers] = block.sides();
    let plane = width * depth;
    let mut all = Stamp { block, values: vec![0.0; plane * layers] };
    all.values[plane * low[2]..].copy_from_slice(&stamp.values);
    for z in (0..layers - 1).rev() {
        if z + 1 < low[2] && all.layer(z + 1).iter().all(|value| *value == 0.0) {
            break;
        }
        let without = canvas.window(&layer_of(&block, z), z + 1, 1);
        let mut above = without.clone();
        let inner = |n: usize| n % width + 1 + (n / width + 1) * above.width;
        let places: Vec<usize> = (0..plane).map(inner).collect();
        for (at, value) in places.iter().zip(all.layer(z + 1)) {
            above.values[*at] = above.values[*at].max(*value);
        }
        let [needed, before] = [&above, &without].map(|layer| layer.eroded(LEAN));
        for (at, value) in places.iter().zip(&mut all.values[plane * z..plane * (z + 1)]) {
            if needed.values[*at] > before.values[*at] + FELT {
                *value = value.max(needed.values[*at]);
            }
        }
    }
    all
}

/// The places of the path, layer by layer, to the first that lies in matter or on the bed.
fn way_down(canvas: &Canvas, paths: &PathMap, from: [usize; 3]) -> Vec<[usize; 2]> {
    let [mut x, mut y, mut z] = from;
    let mut way = vec![[x, y]];
    while z > 0 && canvas.value.value([x, y, z]) < ISO {
        [x, y] = paths.next([x, y, z]);
        z -= 1;
        way.push([x, y]);
    }
    way
}
