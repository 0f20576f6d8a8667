//! What an upper room makes of a support-free node's child.

use super::{SupportFree, VoxelImage, VoxelMaterials};
use crate::eval::Tree;
use crate::field::Field;
use std::sync::Arc;

/// The work of a support-free node, done: its field is `min(max(child, grown), limit)`, brushed over, and not above the
/// dents.
///
/// All images are in the space of [`SupportFree::upright_from_child`]. Where nothing was changed they are
/// [beyond](super::Beyond) their bricks, so that the node's field there is the child's own, to the last bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bake {
    /// The most that the field may be; none if nothing is taken away.
    pub limit: Option<Arc<VoxelImage>>,
    /// A further limit, where the solid was found to hang in spite of the first; none if it did not.
    pub dents: Option<Arc<VoxelImage>>,
    /// The field of the matter that was added; none if there is none.
    pub grown: Option<Arc<VoxelImage>>,
    /// What the brushes did to that.
    pub brushed: Brushed,
    /// Whether the child reaches below the bed, so that it is cut there.
    pub cut_at_bed: bool,
    /// How much was taken away above the bed, about, mm³.
    pub removed_mm3: f64,
    /// How much was added, about, mm³.
    pub added_mm3: f64,
}

/// The work of a node's brush strokes: what was `f` before them is `min(max(f, grown), limit)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Brushed {
    /// The field of what they added; none if nothing.
    pub grown: Option<Arc<VoxelImage>>,
    /// The most that the field may be; none if they took nothing away.
    pub limit: Option<Arc<VoxelImage>>,
    /// What the matter that they added is made of; none if all is of material 0.
    pub materials: Option<Arc<VoxelMaterials>>,
}

/// What blobtree needs from the rooms above for trees with support-free nodes.
pub trait Baker {
    /// Makes `child`, whose parameters are legal, print without supports. `child` is in the space of
    /// [`SupportFree::upright_from_child`]; the mode is not [`Off`](super::SupportMode::Off).
    ///
    /// Errors: why there is no result.
    fn bake(&self, rule: &SupportFree, child: &dyn Field) -> Result<Bake, BakeError>;

    /// Brushes over what [`Self::bake`] made, which is in `bake`: `node` is compiled with it, in the space of
    /// [`SupportFree::upright_from_child`], and not cut at the bed. Called if there are strokes. By default they do
    /// nothing.
    ///
    /// Errors: as [`Self::bake`].
    fn brush(&self, _rule: &SupportFree, _node: &dyn Field, bake: Bake) -> Result<Bake, BakeError> {
        Ok(bake)
    }

    /// Has a last look at the node that [`Self::bake`] made, in the node's own space, and mends its bake. `node`
    /// compiles it with any bake. By default there is nothing to mend.
    ///
    /// Errors: as [`Self::bake`].
    fn finish(
        &self,
        _rule: &SupportFree,
        _node: &dyn Fn(&Bake) -> Tree,
        bake: Bake,
    ) -> Result<Bake, BakeError> {
        Ok(bake)
    }
}

/// Why a support-free node could not be baked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// Somebody asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The shape does not allow it; in words for the user.
    #[error("{0}")]
    Impossible(String),
}
