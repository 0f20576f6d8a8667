//! The first layer, which the bed carries.

use super::TOP;
use super::disc::{Layer, dilate_row};
use super::region::Region;
use blobtree::{Brick, Field, ISO, Sample};
use glam::Vec3;
use rayon::prelude::*;

/// How far inside its outline, in lattice steps, a first layer rises; farther inside is well inside.
///
/// Where the field is flat, it has not reached [`TOP`] there, and the jump is carried outwards by the interpolation of
/// what the layers above can reach. So it must be far away: at 3, cones on drawings blown up flat began up to 6°
/// too wide.
const RAMP: f32 = 24.0;

/// How far inside a layer, along x or y, is well inside, in lattice steps.
const DEEP: usize = 3;

/// Halvings of a step in which an outline is looked for.
const HALVINGS: usize = 4;

/// What the bed carries: the first layer as it is outside of its outline; inside, rising to [`TOP`] with the slope
/// that it has on the outline.
///
/// Inside, the field itself will not do: above a flat bottom it is hardly more than ½, and so would be all that
/// stands on it.
pub(super) fn anchor(region: &Region, first: &Layer, child: &dyn Field) -> Layer {
    let outline = outline(region, first, child);
    let width = first.width;
    let mut anchor = first.clone();
    let mut nearest = vec![f32::INFINITY; first.values.len()];
    anchor.values.iter_mut().filter(|value| **value >= ISO).for_each(|value| *value = TOP);
    let depth = first.values.len() / width;
    for &(at, slope) in &outline {
        let around = |x: f32, most: usize| {
            let low = (x - RAMP).ceil().max(0.0) as usize;
            low..((x + RAMP).floor().max(0.0) as usize + 1).min(most)
        };
        for y in around(at[1], depth) {
            for x in around(at[0], width) {
                let place = x + width * y;
                let distance = (x as f32 - at[0]).hypot(y as f32 - at[1]);
                if first.values[place] >= ISO && distance < nearest[place] {
                    nearest[place] = distance;
                    anchor.values[place] = (ISO + slope * distance).max(first.values[place]).min(TOP);
                }
            }
        }
    }
    anchor
}

/// Sets to [`TOP`] what is farther inside a layer, along x or y, than [`DEEP`].
pub(super) fn lift(layer: &mut Layer) {
    let before = layer.clone();
    let rows = layer.values.par_chunks_mut(before.width).enumerate();
    rows.for_each_init(Vec::new, |least, (y, values)| {
        before.least(y, DEEP, least);
        let inside = values.iter_mut().zip(&*least).filter(|(_, least)| **least >= ISO);
        inside.for_each(|(value, _)| *value = TOP);
    });
}

/// The limit in the two layers below the first, the higher one first: it goes on to where the field is on the bed,
/// and is at least as wide as what leans inwards by the reach. So a foot stays as it is.
pub(super) fn below(region: &Region, first: &Layer, anchor: &Layer, child: &dyn Field) -> [Layer; 2] {
    let low = Brick::lattice_point(region.low, region.spacing);
    let width = first.width;
    let on_bed = |row: usize, values: &mut [f32]| {
        let place = |x: usize| low + Vec3::new(x as f32, row as f32, -region.bed_steps) * region.spacing;
        let places: Vec<Vec3> = (0..width).map(place).collect();
        child.sampler().values(&places, values);
        values.iter_mut().for_each(|value| *value = value.min(TOP));
    };
    let mut bed = Layer::new(width, first.values.len() / width, 0.0);
    bed.values.par_chunks_mut(width).enumerate().for_each(|(row, values)| on_bed(row, values));
    let mut wider = anchor.clone();
    [1.0, 2.0].map(|down| {
        let narrower = wider.clone();
        wider
            .values
            .chunks_exact_mut(width)
            .enumerate()
            .for_each(|(row, out)| dilate_row(&narrower, row, 1.0, out));
        let mut layer = wider.clone();
        for ((value, bed), first) in layer.values.iter_mut().zip(&bed.values).zip(&first.values) {
            *value = value.max(first + (bed - first) * down / region.bed_steps).clamp(0.0, TOP);
        }
        layer
    })
}

/// Places on the outline of a layer, in lattice steps from its first place, with the field's slope across it, per
/// step.
fn outline(region: &Region, first: &Layer, child: &dyn Field) -> Vec<([f32; 2], f32)> {
    let width = first.width;
    let mut ends: Vec<([f32; 2], [f32; 2])> = Vec::new();
    for (i, value) in first.values.iter().enumerate() {
        let at = [(i % width) as f32, (i / width) as f32];
        let across =
            [(i % width + 1 < width).then_some(i + 1), (i + width < first.values.len()).then_some(i + width)];
        for (axis, other) in across.into_iter().enumerate() {
            let Some(other) = other.map(|other| first.values[other]) else { continue };
            if (*value >= ISO) != (other >= ISO) {
                let mut next = at;
                next[axis] += 1.0;
                ends.push(if *value >= ISO { (at, next) } else { (next, at) });
            }
        }
    }
    let middle = |(inside, outside): &([f32; 2], [f32; 2])| -> [f32; 2] {
        std::array::from_fn(|a| 0.5 * (inside[a] + outside[a]))
    };
    let place = |at: [f32; 2]| {
        let low = Brick::lattice_point(region.low, region.spacing);
        low + Vec3::new(at[0], at[1], 0.0) * region.spacing
    };
    let mut sampler = child.sampler();
    for _ in 0..HALVINGS {
        let middles: Vec<Vec3> = ends.iter().map(|ends| place(middle(ends))).collect();
        let mut values = vec![0.0; middles.len()];
        sampler.values(&middles, &mut values);
        for (ends, value) in ends.iter_mut().zip(values) {
            if value >= ISO { ends.0 = middle(ends) } else { ends.1 = middle(ends) }
        }
    }
    let middles: Vec<Vec3> = ends.iter().map(|ends| place(middle(ends))).collect();
    let mut samples = vec![Sample::default(); middles.len()];
    sampler.samples(&middles, &mut samples);
    let slope = |sample: &Sample| sample.gradient.truncate().length() * region.spacing;
    ends.iter().zip(&samples).map(|(ends, sample)| (middle(ends), slope(sample))).collect()
}
