//! The support-free node: its child, changed so that it prints without supports.
//!
//! What is changed, and how, is the work of an upper room: it hands in a [`Baker`], whose [`Bake`]s a
//! [`BakeStore`] keeps from one version of a scene to the next. Without one, the node's child is shown as it is,
//! and [`Tree::unconstrained`](crate::Tree::unconstrained) says so.

mod bake;
mod brush_stroke;
mod image;
mod store;
mod voxel_materials;

pub use bake::{Bake, BakeError, Baker, Brushed};
pub use brush_stroke::{BrushKind, BrushStroke, BrushTip, GROWN_MATERIAL, MAX_NODE_DABS};
pub use image::{Beyond, VOXEL_BRICK, VOXEL_SAMPLES, VoxelBrick, VoxelImage};
pub use store::BakeStore;
pub(crate) use store::Kept;
pub use voxel_materials::VoxelMaterials;

use crate::checks::{Checked, ParameterError, number};
use crate::field::Aabb;
use glam::{DAffine3, DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How far grown matter reaches beyond its surface, mm.
pub const GROWN_FALLOFF: f32 = 2.0;

/// What a support-free node does to its child, in the child's own space, where z points up from the bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportFree {
    /// How what needs supports is dealt with.
    #[serde(default, skip_serializing_if = "SupportMode::is_trim")]
    pub mode: SupportMode,
    /// The largest overhang that prints, degrees from the vertical.
    #[serde(default = "usual_overhang", skip_serializing_if = "is_usual_overhang")]
    #[schemars(range(min = 20.0, max = 70.0))]
    pub overhang_degrees: f32,
    /// Height of a layer, mm.
    #[serde(default = "usual_layer", skip_serializing_if = "is_usual_layer")]
    #[schemars(range(min = 0.02, max = 2.0))]
    pub layer_height: f32,
    /// Height of the print bed, mm: what lies on it needs no support, and what is below it is cut off.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = -100_000.0, max = 100_000.0))]
    pub bed: f32,
    /// Brush strokes, done one after the other to what the mode has made.
    #[serde(skip_deserializing, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip)]
    pub strokes: Vec<Arc<BrushStroke>>,
}

/// How what needs supports is dealt with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupportMode {
    /// It is taken away.
    #[default]
    Trim,
    /// Matter grows below it, from the nearest part of the shape or from the bed.
    Grow,
    /// Not at all: the node is its child.
    Off,
}

impl SupportMode {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    fn is_trim(&self) -> bool {
        *self == Self::Trim
    }
}

impl Default for SupportFree {
    /// Trims to 45° in layers of 0.25 mm, from the bed at 0.
    fn default() -> Self {
        let (overhang_degrees, layer_height) = (usual_overhang(), usual_layer());
        Self { mode: SupportMode::Trim, overhang_degrees, layer_height, bed: 0.0, strokes: Vec::new() }
    }
}

impl SupportFree {
    /// Whether every number is in its legal range.
    ///
    /// Errors: the first parameter that is not, with its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        Checked::check(self)
    }

    /// The map from the child's space to the one in which it is baked: stretched along z so that the largest
    /// overhang is 45°, with 0 in the middle of the first layer, mm.
    pub fn upright_from_child(&self) -> DAffine3 {
        let stretch = f64::from(self.overhang_degrees).to_radians().tan();
        let first = f64::from(self.bed) + 0.5 * f64::from(self.layer_height);
        let scale = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.0, 1.0, stretch)));
        scale * DAffine3::from_translation(DVec3::new(0.0, 0.0, -first))
    }

    /// The box outside which the node's field is 0, from its child's.
    pub(crate) fn support(&self, child: &Aabb) -> Aabb {
        if self.mode == SupportMode::Off {
            return *child;
        }
        let mut around = *child;
        if self.mode == SupportMode::Grow && !child.is_empty() {
            around = child.grown(GROWN_FALLOFF);
            around.min.z = around.min.z.min(self.bed - GROWN_FALLOFF);
        }
        brush_stroke::support(&around, self.strokes.iter().map(|stroke| &**stroke), self.bed)
    }
}

impl Checked for SupportFree {
    fn check(&self) -> Result<(), ParameterError> {
        number("overhang_degrees", self.overhang_degrees, 20.0, 70.0, "degrees")?;
        number("layer_height", self.layer_height, 0.02, 2.0, "mm")?;
        number("bed", self.bed, -1e5, 1e5, "mm")?;
        brush_stroke::check_all(self.strokes.iter().map(|stroke| &**stroke))
    }
}

fn usual_overhang() -> f32 {
    45.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_usual_overhang(degrees: &f32) -> bool {
    *degrees == usual_overhang()
}

fn usual_layer() -> f32 {
    0.25
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_usual_layer(mm: &f32) -> bool {
    *mm == usual_layer()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_zero(x: &f32) -> bool {
    *x == 0.0
}
