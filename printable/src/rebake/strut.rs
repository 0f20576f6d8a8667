//! Struts: round columns along paths, thicker further down.

use super::TOP;
use super::path_map::PathMap;
use super::region::Region;
use super::volume::Volume;
use blobtree::{GROWN_FALLOFF, ISO};

/// Radius at the top, in lattice steps: wide enough to be seen by the lattice.
pub(super) const THINNEST: f32 = 1.8;

/// Most by which a radius grows, mm.
pub(super) const THICKER_MM: f32 = 1.5;

/// By how much it grows with each step down.
pub(super) const TAPER: f32 = 0.04;

/// Layers above and below over which a path is smoothed.
pub(super) const SMOOTHED: usize = 4;

/// Layers by which a strut goes on into what it stands on.
const ROOT: usize = 6;

/// A column: its middle and radius in each layer from the highest down, in lattice steps.
#[derive(Debug)]
pub(super) struct Strut {
    highest: usize,
    middles: Vec<([f32; 2], f32)>,
    /// How far the field reaches beyond the surface, in lattice steps.
    falloff: f32,
}

impl Strut {
    /// The strut that carries a place of the layer above `layer`.
    pub fn along(paths: &PathMap, start: [usize; 2], layer: usize, region: &Region) -> Self {
        let mut way = vec![start, start];
        let mut at = [start[0], start[1], layer];
        let mut root = ROOT;
        while at[2] > 0 && root > 0 {
            if paths.cost(at) == 0 {
                root -= 1;
            }
            let [x, y] = if paths.cost(at) == 0 { [at[0], at[1]] } else { paths.next(at) };
            at = [x, y, at[2] - 1];
            way.push([x, y]);
        }
        let thickest = THINNEST + THICKER_MM / region.spacing;
        let middles = (0..way.len()).map(|i| {
            let around = SMOOTHED.min(i).min(way.len() - 1 - i);
            let near = &way[i - around..=i + around];
            let mean = |a: usize| near.iter().map(|at| at[a] as f32).sum::<f32>() / near.len() as f32;
            ([mean(0), mean(1)], (THINNEST + TAPER * i as f32).min(thickest))
        });
        Self { highest: layer + 1, middles: middles.collect(), falloff: GROWN_FALLOFF / region.spacing }
    }
}

/// Adds a strut to a volume.
pub(super) fn draw(volume: &mut Volume, strut: &Strut) {
    let [width, depth, _] = volume.sides;
    for (down, (middle, radius)) in strut.middles.iter().enumerate() {
        let Some(layer) = strut.highest.checked_sub(down) else { break };
        let far = radius + strut.falloff;
        let span = |x: f32, most: usize| {
            (x - far).ceil().max(0.0) as usize..((x + far).floor().max(0.0) as usize + 1).min(most)
        };
        for y in span(middle[1], depth) {
            for x in span(middle[0], width) {
                let distance = (x as f32 - middle[0]).hypot(y as f32 - middle[1]);
                let value = ISO * (1.0 + (radius - distance) / strut.falloff);
                if value > 0.0 {
                    volume.raise([x, y, layer], value.min(TOP));
                }
            }
        }
    }
}
