//! Sampled functions at their place in a tree.

use super::Kernel;
use super::frame::Frame;
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple};
use crate::support_free::VoxelImage;
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// An image with its place.
#[derive(Clone, Debug)]
pub(crate) struct Voxels {
    /// To lattice units.
    frame: Frame,
    image: Arc<VoxelImage>,
}

impl Voxels {
    /// `image_from_world` leads from the space of evaluation to that of the image, in mm.
    pub fn new(image_from_world: &DAffine3, image: Arc<VoxelImage>) -> Self {
        let per_mm = f64::from(image.spacing()).recip();
        let lattice_from_image = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::splat(per_mm)));
        Self { frame: Frame::new(lattice_from_image * *image_from_world), image }
    }
}

impl Kernel for Voxels {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let reading = self.image.read(self.frame.apply(p));
        Slope::new(reading.value, self.frame.pull_back(reading.slope))
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let range = self.frame.range(region).to_box();
        let (lo, hi) = self.image.bound(range.min.to_array(), range.max.to_array());
        Interval { lo, hi }
    }

    /// It jumps only where bricks end, which nobody sees: there it decides nothing.
    fn creased(&self, _region: &Aabb) -> bool {
        false
    }
}
