//! What a dab needs to stand on: its tip, put down along the closest supporting path.

use super::canvas::Canvas;
use super::stamp::{Lattice, Shape, Stamp};
use crate::Dab;
use crate::rebake::path_map::PathMap;
use crate::rebake::strut::{ROOT, SMOOTHED, TAPER, THICKER_MM};
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

/// The places of the path, layer by layer, with some layers more into what it ends on.
fn way_down(canvas: &Canvas, paths: &PathMap, from: [usize; 3]) -> Vec<[usize; 2]> {
    let [mut x, mut y, mut z] = from;
    let mut way = vec![[x, y]];
    let mut root = ROOT;
    while z > 0 && root > 0 {
        if canvas.value.value([x, y, z]) >= ISO {
            root -= 1;
        } else {
            [x, y] = paths.next([x, y, z]);
        }
        z -= 1;
        way.push([x, y]);
    }
    way
}
