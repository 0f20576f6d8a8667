//! What the five brushes do with a field, dab by dab: what they do with voxels, at every level of the field at once.

use super::canvas::{Canvas, Changed};
use super::fall::Stakes;
use super::firm::firm;
use super::grow::{along_path, with_foot};
use super::preserve::carve_and_keep;
use super::stamp::{Block, Lattice, Shape, Stamp};
use crate::Dab;
use crate::rebake::anchor::lift;
use crate::rebake::disc::{Layer, dilate_row};
use crate::rebake::path_map::PathMap;
use crate::rebake::{REACH, TOP};
use blobtree::{BrushKind, ISO};

/// How far a layer is looked at around a block: as far as [`lift`] looks, and a step more.
const AROUND: usize = 4;

/// By how much limits stay away from what they leave alone: more than the filter of the image takes from them.
const BESIDE: f32 = 0.03;

/// How far inside a smoothing tip smoothing has its full effect, in values of the tip.
const RIM: f32 = 0.1;

/// A brush in hand.
pub(super) struct Hand<'a> {
    pub kind: BrushKind,
    pub shape: &'a Shape,
    pub lattice: &'a Lattice,
    /// Where matter grows down to.
    pub paths: Option<&'a PathMap>,
    /// What is added is made of, and what grows below that.
    pub materials: [u8; 2],
}

impl Hand<'_> {
    /// Puts the brush down once; `stamp` is its tip there.
    pub fn dab(&self, canvas: &mut Canvas, dab: &Dab, stamp: Stamp) {
        let [material, grown] = self.materials;
        match self.kind {
            BrushKind::AddTrim => {
                let near = near_surface(canvas, &stamp, self.reach_of(dab), true);
                add(canvas, &near.unwrap_or(stamp), |_, _| material);
            }
            BrushKind::AddGrow => {
                let near = near_surface(canvas, &stamp, self.reach_of(dab), true);
                let tip = near.unwrap_or(stamp);
                let all = self
                    .paths
                    .map(|paths| along_path(canvas, self.lattice, self.shape, dab, paths, tip.clone()));
                let of_tip = |at, to: f32| if tip.value(at) >= to.min(ISO) { material } else { grown };
                let all = with_foot(canvas, all.unwrap_or_else(|| tip.clone()));
                add(canvas, &all, of_tip);
            }
            BrushKind::RemoveTrim => {
                let carve = self.carve(canvas, &stamp, dab);
                let changed = carve_from_below(canvas, &carve);
                topple(canvas, carve.block.low[2], changed);
            }
            BrushKind::RemovePreserve => {
                let carve = self.carve(canvas, &stamp, dab);
                let preserve = |canvas: &mut Canvas| {
                    let changed = carve_and_keep(canvas, &carve);
                    topple(canvas, carve.block.low[2], changed);
                };
                canvas.try_to(preserve, |canvas, lowered| Stakes::of(&carve).stand(canvas, lowered));
            }
            BrushKind::SmoothTrim => {
                for _ in 0..(3.0 * dab.strength()).ceil() as usize {
                    smooth(canvas, &stamp, material);
                }
            }
        }
    }

    /// How far the surface moves at most, in lattice steps along x and y and along z; none if as far as it likes.
    fn reach_of(&self, dab: &Dab) -> Option<[usize; 2]> {
        let far = dab.strength() * dab.radius();
        (dab.strength() < 1.0).then(|| self.lattice.steps().map(|step| (far / step).round() as usize))
    }

    /// The limit that a dab carves with.
    fn carve(&self, canvas: &Canvas, stamp: &Stamp, dab: &Dab) -> Stamp {
        let near = near_surface(canvas, stamp, self.reach_of(dab), false);
        let values = &near.as_ref().unwrap_or(stamp).values;
        Stamp { block: stamp.block, values: values.iter().map(|value| 1.0 - value).collect() }
    }
}

/// What the layer below carries of a block of one layer, once it is prepared.
fn carried(canvas: &Canvas, block: &Block, prepare: impl Fn(&mut Layer)) -> Vec<f32> {
    let [width, depth, _] = block.sides();
    let Some(below) = block.low[2].checked_sub(1) else { return vec![TOP; width * depth] };
    let mut window = canvas.window(block, below, AROUND);
    prepare(&mut window);
    inner(&window, width, depth, |layer, y, row| dilate_row(layer, y, REACH, row))
}

/// Rows of a window without its margin.
fn inner(
    window: &Layer,
    width: usize,
    depth: usize,
    mut row_of: impl FnMut(&Layer, usize, &mut [f32]),
) -> Vec<f32> {
    let mut row = vec![0.0; window.width];
    let mut all = Vec::with_capacity(width * depth);
    for y in 0..depth {
        row_of(window, y + AROUND, &mut row);
        all.extend_from_slice(&row[AROUND..AROUND + width]);
    }
    all
}

/// One layer of a block.
pub(super) fn layer_of(block: &Block, z: usize) -> Block {
    let mut layer = *block;
    (layer.low[2], layer.end[2]) = (z, z + 1);
    layer
}

/// Adds what of a stamp is carried, from below; `material` says of what, by place and value.
fn add(canvas: &mut Canvas, stamp: &Stamp, material: impl Fn([usize; 3], f32) -> u8) {
    for z in stamp.block.low[2]..stamp.block.end[2] {
        let block = layer_of(&stamp.block, z);
        let mut to = carried(canvas, &block, lift);
        to.iter_mut().zip(stamp.layer(z)).for_each(|(to, value)| *to = to.min(*value));
        canvas.raise(&block, &to, &material);
    }
}

/// What changed in each layer of a block, from its lowest.
pub(super) type Changes = Vec<Option<Changed>>;

fn carve_from_below(canvas: &mut Canvas, carve: &Stamp) -> Changes {
    let layers = carve.block.low[2]..carve.block.end[2];
    layers.map(|z| canvas.lower(&layer_of(&carve.block, z), carve.layer(z))).collect()
}

/// Takes away what lost what carried it, layer by layer. `changes` are those from layer `low` on.
fn topple(canvas: &mut Canvas, low: usize, changes: Changes) {
    let mut below: Option<Changed> = None;
    let mut changes = changes.into_iter();
    for z in low..canvas.sides()[2] {
        let own = changes.next();
        if own.is_none() && below.is_none() {
            return;
        }
        let toppled = below.as_ref().and_then(|below| drop_unsupported(canvas, below, z));
        below = match (own.flatten(), toppled) {
            (Some(own), Some(toppled)) => Some(own.with(toppled)),
            (own, toppled) => own.or(toppled),
        };
    }
}

/// Lowers what is above changed places to what is carried there now.
fn drop_unsupported(canvas: &mut Canvas, below: &Changed, z: usize) -> Option<Changed> {
    let [nx, ny, _] = canvas.sides();
    let Block { low, end } = below.block;
    let block = Block {
        low: [low[0].saturating_sub(2), low[1].saturating_sub(2), z],
        end: [(end[0] + 2).min(nx), (end[1] + 2).min(ny), z + 1],
    };
    let [width, ..] = block.sides();
    let mut doubtful = vec![false; block.sides().iter().product()];
    below.each(|[x, y, _]| {
        for y in y.saturating_sub(1).max(block.low[1])..(y + 2).min(block.end[1]) {
            for x in x.saturating_sub(1).max(block.low[0])..(x + 2).min(block.end[0]) {
                doubtful[block.index([x, y, z])] = true;
            }
        }
    });
    let inside = |layer: &mut Layer| {
        firm(layer);
        lift(layer);
    };
    let mut to = carried(canvas, &block, inside);
    for (n, to) in to.iter_mut().enumerate() {
        if !doubtful[n] {
            // What lost nothing stays; the limit beside it goes on smoothly.
            let at = [block.low[0] + n % width, block.low[1] + n / width, z];
            *to = to.max(canvas.value.value(at) + BESIDE);
        }
    }
    canvas.lower(&block, &to)
}

/// One pass: the tip's places go with the mean of the 27 around them; what that adds is of `material`.
fn smooth(canvas: &mut Canvas, stamp: &Stamp, material: u8) {
    let layers = stamp.block.low[2]..stamp.block.end[2];
    let top = canvas.sides()[2] - 1;
    let targets: Vec<Vec<f32>> = layers
        .clone()
        .map(|z| {
            let block = layer_of(&stamp.block, z);
            let [width, ..] = block.sides();
            let around = [z.saturating_sub(1), z, (z + 1).min(top)];
            let windows = around.map(|z| canvas.window(&block, z, 1));
            let target = |(n, tip): (usize, &f32)| {
                let (x, y) = (n % width, n / width);
                let row =
                    |layer: &Layer, dy: usize| layer.row((y + dy) as isize)[x..x + 3].iter().sum::<f32>();
                let sum: f32 = windows.iter().map(|layer| (0..3).map(|dy| row(layer, dy)).sum::<f32>()).sum();
                let own = windows[1].row(y as isize + 1)[x + 1];
                let share = ((tip - ISO) / RIM).clamp(0.0, 1.0);
                own + share * (sum / 27.0 - own)
            };
            stamp.layer(z).iter().enumerate().map(target).collect()
        })
        .collect();
    let mut changes: Changes = Vec::new();
    for (z, target) in layers.zip(&targets) {
        let block = layer_of(&stamp.block, z);
        let mut up = carried(canvas, &block, lift);
        let mut down = target.clone();
        for (n, tip) in stamp.layer(z).iter().enumerate() {
            let beside = if *tip > ISO { 0.0 } else { BESIDE };
            up[n] = up[n].min(target[n] - beside);
            down[n] += beside;
        }
        canvas.raise(&block, &up, |_, _| material);
        changes.push(canvas.lower(&block, &down));
    }
    topple(canvas, stamp.block.low[2], changes);
}

/// The part of a stamp that is within reach of the surface: outside the solid when adding, inside when not, which is
/// the solid, or the air around it, widened step by step. None if the whole stamp counts.
fn near_surface(canvas: &Canvas, stamp: &Stamp, reach: Option<[usize; 2]>, adding: bool) -> Option<Stamp> {
    let [wide, high] = reach?;
    let block = stamp.block;
    let [width, depth, layers] = block.sides();
    let plane = width * depth;
    let sign = |value: f32| if adding { value } else { 1.0 - value };
    let mut near: Vec<f32> = Vec::with_capacity(plane * layers);
    for z in block.low[2]..block.end[2] {
        near.extend(canvas.window(&layer_of(&block, z), z, 0).values.iter().map(|value| sign(*value)));
    }
    let steps = wide.max(high);
    for step in 0..steps {
        let takes = |most: usize| (step + 1) * most / steps > step * most / steps;
        let mut next = near.clone();
        if takes(wide) {
            for (from, to) in near.chunks_exact(plane).zip(next.chunks_exact_mut(plane)) {
                let layer = Layer { width, values: from.to_vec() };
                to.chunks_exact_mut(width).enumerate().for_each(|(y, row)| dilate_row(&layer, y, 1.0, row));
            }
        }
        if takes(high) {
            for z in 0..layers {
                for beside in [z.checked_sub(1), (z + 1 < layers).then_some(z + 1)].into_iter().flatten() {
                    let from = &near[beside * plane..][..plane];
                    let to = &mut next[z * plane..][..plane];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to = to.max(*from));
                }
            }
            // The bed counts as solid.
            if adding && block.low[2] == 0 {
                next[..plane].fill(1.0);
            }
        }
        near = next;
    }
    near.iter_mut().zip(&stamp.values).for_each(|(near, tip)| *near = near.min(*tip));
    Some(Stamp { block, values: near })
}
