//! What voxels know of a place: islands, and what hangs above.

use crate::{
    Element, LayerHeight, MAX_VOXELS, SupportRule, VoxelGrid, VoxelSize, Why, trim_with_changes, unsupported,
};
use blobtree::Field;
use glam::{Vec3, Vec3Swizzles};

/// Most voxels along a side, some less than a grid holds, as covering rounds outwards.
const MOST: f32 = (MAX_VOXELS - 8) as f32;

/// What a step out of the reach of what hangs counts for, in steps towards it.
const OUT_OF_REACH: f32 = 3.0;

/// The solid of a field above the bed, z = 0, in voxels as high as a layer, or higher where those would be too many; and
/// the element of the rule for them. None if there is no solid.
fn voxels_of(rule: SupportRule, field: &dyn Field) -> Option<(VoxelGrid, Element)> {
    let bounds = crate::voxels::solid_bounds(field);
    let longest = bounds.size().with_z(bounds.max.z).max_element();
    let height = LayerHeight::from_mm(rule.layer_height.mm().max(longest / MOST)).ok()?;
    let grid = VoxelGrid::above_bed(field, VoxelSize::cubic(height)).ok()?;
    let element = Element::for_rule(SupportRule { layer_height: height, ..rule }).ok()?;
    Some((grid, element))
}

/// Whether trimming takes the place as part of an island.
pub(super) fn is_island(rule: SupportRule, field: &dyn Field, place: Vec3) -> bool {
    let Some((mut grid, element)) = voxels_of(rule, field) else { return false };
    let changes = trim_with_changes(&mut grid, &element);
    let voxel = grid.shape().in_voxels(place).floor();
    // Near the surface, the voxel of the place may be empty: those around it know, too.
    let around = [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    let reason = around.iter().find_map(|step| {
        let near = voxel + Vec3::from_array(step.map(|n: i8| f32::from(n)));
        let inside = near.min_element() >= 0.0;
        let near = near.to_array().map(|n| n as usize);
        inside.then(|| changes.why(&grid, &element, near)).flatten()
    });
    reason == Some(Why::Island)
}

/// The place that grown matter at `place` holds: of all voxels that nothing carries, the nearest above in whose reach
/// it is.
pub(super) fn held_by(rule: SupportRule, field: &dyn Field, place: Vec3) -> Option<Vec3> {
    let (grid, element) = voxels_of(rule, field)?;
    let reach = rule.overhang.radians().tan();
    let cost = |hanging: &Vec3| {
        let way = *hanging - place;
        let out = (way.xy().length() - way.z * reach).max(0.0);
        way.length() + OUT_OF_REACH * out
    };
    let hanging = unsupported(&grid, &element).into_iter().map(|voxel| grid.shape().center(voxel));
    let above = hanging.filter(|hanging| hanging.z > place.z);
    above.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}
