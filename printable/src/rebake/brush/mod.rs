//! Brush strokes, replayed on the field.
//!
//! What brushes do with voxels is made of set operations: adding, removing, and keeping what the layer below carries.
//! Each has a grey-scale twin, the greater, the lesser, and the lesser of a value and what the layer below carries, and
//! flat morphology commutes with thresholding. So replayed on a field, with tips that are fields, strokes make the solid
//! that they make of voxels, and its surface is as smooth as the field and the tips.

mod canvas;
mod dabs;
mod fall;
mod firm;
mod grow;
mod preserve;
mod stamp;

use super::bricks::Collector;
use super::disc::Layer;
use super::path_map::PathMap;
use super::region::Region;
use super::volume::Volume;
use super::{Rebaker, TOP, grow::sample};
use crate::Dab;
use crate::brush::dabs_of;
use blobtree::{
    Aabb, Bake, BakeError, Beyond, BrushKind, BrushStroke, Brushed, Field, SupportFree, VoxelBrick,
    VoxelImage, VoxelMaterials,
};
use canvas::{Canvas, FELT, Paged};
use dabs::Hand;
use glam::DVec3;
use rayon::prelude::*;
use stamp::{Lattice, Shape, Stamp};
use std::sync::Arc;

/// Places of stamps that are made at once.
const AHEAD: usize = 1 << 22;

/// Replays all strokes of a rule on `node`, what was baked before.
///
/// Errors: [`BakeError::Cancelled`]; a stroke that takes too many dabs.
pub(super) fn brush(
    rebaker: &Rebaker,
    rule: &SupportFree,
    node: &dyn Field,
    mut bake: Bake,
) -> Result<Bake, BakeError> {
    let added = added_within(rule);
    let Some(region) = Region::around(rule, node, &added) else { return Ok(bake) };
    let mut volume = Volume::new(&region);
    sample(rebaker, &region, node, &mut volume)?;
    let lattice = Lattice::new(rule, &region);
    let is_colourful = rule.strokes.iter().any(|stroke| is_colourful(stroke));
    let materials = is_colourful.then(|| VoxelMaterials::new(region.spacing, region.low));
    let mut canvas = Canvas::new(volume, materials);
    for (number, stroke) in rule.strokes.iter().enumerate() {
        let dabs = dabs_of(stroke)
            .map_err(|e| BakeError::Impossible(format!("`strokes[{number}]` cannot be replayed: {e}")))?;
        let shape = Shape::of(&stroke.tip);
        rebaker.go_on()?;
        let paths = (stroke.brush == BrushKind::AddGrow).then(|| PathMap::new(&canvas.value));
        let materials = [stroke.material, stroke.grown_material];
        let hand =
            Hand { kind: stroke.brush, shape: &shape, lattice: &lattice, paths: paths.as_ref(), materials };
        let places =
            |dab: &Dab| lattice.block_of(&shape, dab).map_or(0, |block| block.sides().iter().product());
        for dabs in groups(&dabs, places) {
            let stamps: Vec<Option<Stamp>> = dabs.par_iter().map(|dab| lattice.stamp(&shape, dab)).collect();
            for (dab, stamp) in dabs.iter().zip(stamps) {
                rebaker.go_on()?;
                if let Some(stamp) = stamp {
                    hand.dab(&mut canvas, dab, stamp);
                }
            }
        }
    }
    let ends = [[region.low[0], region.low[1], -2], region.high()];
    let image = |bricks: Vec<VoxelBrick>, beyond: Beyond| {
        rebaker.go_on()?;
        let image = VoxelImage::new(region.spacing, TOP, beyond, ends, &bricks);
        let image = image.map_err(|e| BakeError::Impossible(e.to_string()));
        (!bricks.is_empty()).then_some(image).transpose().map(|image| image.map(Arc::new))
    };
    let felt_grown = |grown: f32, value: f32| grown > 0.0 && grown >= value - FELT;
    let felt_limit = |limit: f32, value: f32| limit < TOP && limit <= value + FELT;
    // What was added to the first layer goes on below it.
    bake.cut_at_bed |= region.cut_at_bed || canvas.grown.is_felt_in(0);
    bake.brushed = Brushed {
        grown: image(collect(&region, &canvas, &canvas.grown, felt_grown), Beyond::Nothing)?,
        limit: image(collect(&region, &canvas, &canvas.limit, felt_limit), Beyond::NoLimit)?,
        materials: canvas.materials.filter(|materials| !materials.is_plain()).map(Arc::new),
    };
    Ok(bake)
}

/// Dabs that follow each other, in groups whose stamps have [`AHEAD`] places together, or of one dab.
fn groups(dabs: &[Dab], places: impl Fn(&Dab) -> usize) -> Vec<&[Dab]> {
    let mut groups = Vec::new();
    let (mut start, mut all) = (0, 0);
    for (n, dab) in dabs.iter().enumerate() {
        let own = places(dab);
        if n > start && all + own > AHEAD {
            groups.push(&dabs[start..n]);
            (start, all) = (n, 0);
        }
        all += own;
    }
    groups.push(&dabs[start..]);
    groups
}

/// Whether a stroke may add anything of another material than 0.
fn is_colourful(stroke: &BrushStroke) -> bool {
    let grows = stroke.brush == BrushKind::AddGrow;
    stroke.brush.adds() && (stroke.material != 0 || grows && stroke.grown_material != 0)
}

/// Where strokes may add, in the space in which nodes are baked.
fn added_within(rule: &SupportFree) -> Aabb {
    let upright = rule.upright_from_child();
    let adding = rule.strokes.iter().filter(|stroke| stroke.brush.adds());
    let reach = adding.fold(Aabb::EMPTY, |all, stroke| {
        let mut reach = stroke.reach();
        if stroke.brush == BrushKind::AddGrow {
            reach = reach.grown(super::strut::THICKER_MM);
        }
        all.union(&reach)
    });
    if reach.is_empty() {
        return reach;
    }
    let corner = |p: glam::Vec3| upright.transform_point3(DVec3::from(p)).as_vec3();
    Aabb { min: corner(reach.min), max: corner(reach.max) }
}

/// The bricks of an image of values, where they are felt.
fn collect(
    region: &Region,
    canvas: &Canvas,
    values: &Paged,
    felt: impl Fn(f32, f32) -> bool,
) -> Vec<VoxelBrick> {
    let [width, depth, layers] = region.sides;
    let layer_of = |z: usize| {
        let mut layer = Layer::new(width, depth, values.background());
        if !values.is_plain(z) {
            for (n, value) in layer.values.iter_mut().enumerate() {
                *value = values.value([n % width, n / width, z]);
            }
        }
        layer
    };
    let first = layer_of(0);
    let mut collector = Collector::new(region, [first.clone(), first], TOP);
    for z in 0..layers {
        let layer = layer_of(z);
        if !values.is_plain(z) {
            for (n, value) in layer.values.iter().enumerate() {
                let (x, y) = (n % width, n / width);
                if felt(*value, canvas.value.value([x, y, z])) {
                    collector.mark(x, y, z);
                }
            }
        }
        *collector.layer_mut(z) = layer;
        collector.advance(z);
    }
    collector.finish(layers)
}
