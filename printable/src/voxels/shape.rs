//! How large voxels are, how many there are, and where they lie.

use crate::LayerHeight;
use blobtree::Aabb;
use glam::Vec3;

/// Most voxels along any side of a grid.
pub const MAX_VOXELS: usize = 512;

/// Legal voxel widths, mm.
const WIDTHS: std::ops::RangeInclusive<f32> = 0.005..=10.0;

/// The size of a voxel: as high as a layer, and square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelSize {
    width: f32,
    height: f32,
}

impl VoxelSize {
    /// Voxels of this width in x and y, mm. Errors: [`VoxelError::Width`] outside 0.005 to 10 mm.
    pub fn new(width_mm: f32, layer_height: LayerHeight) -> Result<Self, VoxelError> {
        if WIDTHS.contains(&width_mm) {
            Ok(Self { width: width_mm, height: layer_height.mm() })
        } else {
            Err(VoxelError::Width { mm: width_mm })
        }
    }

    /// As wide as high, as in the paper.
    pub fn cubic(layer_height: LayerHeight) -> Self {
        Self { width: layer_height.mm(), height: layer_height.mm() }
    }

    /// Width in x and y, mm.
    pub fn width(self) -> f32 {
        self.width
    }

    /// Height, mm: that of a layer.
    pub fn height(self) -> f32 {
        self.height
    }
}

/// Where the voxels of a grid lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridShape {
    /// How many voxels there are along x, y and z; each 1 to [`MAX_VOXELS`].
    pub(crate) voxels: [usize; 3],
    /// Their size.
    pub(crate) size: VoxelSize,
    /// The lowest corner in x and y, mm; in z it is the bed.
    pub(crate) corner: [f32; 2],
}

impl GridShape {
    /// A grid with its lowest corner at `corner` (x and y, mm) on the bed.
    ///
    /// Errors: more than [`MAX_VOXELS`] along a side, none along a side, a corner that is not finite.
    pub fn new(voxels: [usize; 3], size: VoxelSize, corner: [f32; 2]) -> Result<Self, VoxelError> {
        if voxels.contains(&0) || !corner.iter().all(|c| c.abs() < 1e6) {
            return Err(VoxelError::Empty);
        }
        if voxels.iter().any(|&n| n > MAX_VOXELS) {
            return Err(VoxelError::too_large(voxels.map(|n| n as f64), size));
        }
        Ok(Self { voxels, size, corner })
    }

    /// The smallest grid whose voxels cover `bounds` from the bed upwards.
    ///
    /// Errors: more than [`MAX_VOXELS`] along a side; nothing above the bed; bounds that are not finite.
    pub fn covering(bounds: Aabb, size: VoxelSize) -> Result<Self, VoxelError> {
        let finite = bounds.min.is_finite() && bounds.max.is_finite();
        if bounds.is_empty() || !finite || bounds.max.z <= 0.0 {
            return Err(VoxelError::Empty);
        }
        let per_mm = Vec3::new(size.width, size.width, size.height).as_dvec3().recip();
        let low = (bounds.min.as_dvec3() * per_mm).floor();
        let high = (bounds.max.as_dvec3() * per_mm).ceil();
        let count = [(high.x - low.x).max(1.0), (high.y - low.y).max(1.0), high.z.max(1.0)];
        if count.iter().any(|&n| n > MAX_VOXELS as f64) {
            return Err(VoxelError::too_large(count, size));
        }
        let corner = [low.x, low.y].map(|c| (c * f64::from(size.width)) as f32);
        Self::new(count.map(|n| n as usize), size, corner)
    }

    /// How many voxels there are along x, y and z.
    pub fn voxels(&self) -> [usize; 3] {
        self.voxels
    }

    /// Their size.
    pub fn size(&self) -> VoxelSize {
        self.size
    }

    /// Where a voxel is sampled: its centre, mm. In z that is the middle of its layer.
    pub fn center(&self, [x, y, z]: [usize; 3]) -> Vec3 {
        let VoxelSize { width, height } = self.size;
        let [low_x, low_y] = self.corner;
        Vec3::new(
            low_x + (x as f32 + 0.5) * width,
            low_y + (y as f32 + 0.5) * width,
            (z as f32 + 0.5) * height,
        )
    }

    /// A place (mm) in voxels from the grid's corner: the centre of voxel `[x, y, z]` is at x + ½, y + ½, z + ½.
    pub fn in_voxels(&self, place: Vec3) -> Vec3 {
        let VoxelSize { width, height } = self.size;
        let [low_x, low_y] = self.corner;
        Vec3::new((place.x - low_x) / width, (place.y - low_y) / width, place.z / height)
    }
}

/// Why there are no voxels of something.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VoxelError {
    /// No such voxels are made.
    #[error("voxel width is {mm} mm, not 0.005 to 10 mm; the layer height is a good width")]
    Width {
        /// As asked for.
        mm: f32,
    },
    /// More voxels than a grid holds.
    #[error(
        "{} × {} × {} voxels of {width} mm are too many for a grid of at most {MAX_VOXELS} along each side; \
         take voxels at least {factor} times as large, or scale the model by {} or less",
        voxels[0], voxels[1], voxels[2], shrink(*factor)
    )]
    TooLarge {
        /// How many it would take along x, y and z.
        voxels: [u64; 3],
        /// Their width, mm.
        width: f32,
        /// How many times larger in each direction the voxels must be at least, rounded up to hundredths.
        factor: f32,
    },
    /// There is nothing solid at the centre of any voxel.
    #[error("there is no voxel to fill: the model is empty, or thinner than a voxel everywhere")]
    Empty,
    /// Part of the model is under the bed.
    #[error("the model reaches below the bed, z = 0, by up to {by} mm; raise it")]
    BelowBed {
        /// How far, mm; of a field as far as its bounds tell, rounded up to whole layers.
        by: f32,
    },
    /// Nothing stands on the bed.
    #[error("the model floats {by} mm above the bed, z = 0; lower it by that much")]
    Floating {
        /// How far the lowest voxel is above the bed, mm.
        by: f32,
    },
    /// The mesh has no inside.
    #[error(transparent)]
    Mesh(#[from] mesh::MeshDistanceError),
}

/// The scale that makes a model smaller by `factor`, rounded down to thousandths.
fn shrink(factor: f32) -> f32 {
    (1000.0 / factor).floor() / 1000.0
}

impl VoxelError {
    fn too_large(count: [f64; 3], size: VoxelSize) -> Self {
        let most = count.into_iter().fold(0.0, f64::max);
        let factor = (most / MAX_VOXELS as f64 * 100.0).ceil() / 100.0;
        Self::TooLarge { voxels: count.map(|n| n as u64), width: size.width, factor: factor as f32 }
    }
}
