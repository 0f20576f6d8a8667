//! What voxels know of a place: islands, and what hangs above.

use crate::{
    Changes, Element, LayerHeight, MAX_VOXELS, SupportRule, VoxelGrid, VoxelSize, Why, trim_with_changes,
    unsupported,
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

/// What trimming takes of a solid.
pub(super) struct Taken {
    grid: VoxelGrid,
    element: Element,
    changes: Changes,
}

impl Taken {
    /// None if there is no solid.
    pub fn new(rule: SupportRule, field: &dyn Field) -> Option<Self> {
        let (mut grid, element) = voxels_of(rule, field)?;
        let changes = trim_with_changes(&mut grid, &element);
        Some(Self { grid, element, changes })
    }

    /// Whether the place is taken as part of an island.
    pub fn is_island(&self, place: Vec3) -> bool {
        let voxel = self.grid.shape().in_voxels(place).floor();
        // Near the surface, the voxel of the place may be empty: those around it know, too.
        let around = [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        let reason = around.iter().find_map(|step| {
            let near = voxel + Vec3::from_array(step.map(|n: i8| f32::from(n)));
            let inside = near.min_element() >= 0.0;
            let near = near.to_array().map(|n| n as usize);
            inside.then(|| self.changes.why(&self.grid, &self.element, near)).flatten()
        });
        reason == Some(Why::Island)
    }
}

/// The voxels of a solid that nothing carries, by their centres.
pub(super) fn hanging(rule: SupportRule, field: &dyn Field) -> Vec<Vec3> {
    let Some((grid, element)) = voxels_of(rule, field) else { return Vec::new() };
    unsupported(&grid, &element).into_iter().map(|voxel| grid.shape().center(voxel)).collect()
}

/// The place that grown matter at `place` holds: of all that hangs, the nearest above in whose reach it is.
pub(super) fn held_by(rule: SupportRule, hanging: &[Vec3], place: Vec3) -> Option<Vec3> {
    let reach = rule.overhang.radians().tan();
    let cost = |hanging: &Vec3| {
        let way = *hanging - place;
        let out = (way.xy().length() - way.z * reach).max(0.0);
        way.length() + OUT_OF_REACH * out
    };
    let above = hanging.iter().filter(|hanging| hanging.z > place.z);
    above.min_by(|a, b| cost(a).total_cmp(&cost(b))).copied()
}
