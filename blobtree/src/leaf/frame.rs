//! Where a leaf stands: the map from the space of evaluation to its own.

use crate::field::Aabb;
use crate::scalar::{Scalar, Triple};
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// An affine map from the space of evaluation to a leaf's own, where the leaf stands at the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    rows: [[f32; 3]; 3],
    offset: [f32; 3],
}

/// A box in a leaf's space, with room for rounding errors in the way there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub center: Vec3,
    pub half: Vec3,
}

impl Frame {
    pub fn new(leaf_from_world: DAffine3) -> Self {
        let columns = leaf_from_world.matrix3.transpose();
        let row = |v: DVec3| v.as_vec3().to_array();
        Self {
            rows: [row(columns.x_axis), row(columns.y_axis), row(columns.z_axis)],
            offset: leaf_from_world.translation.as_vec3().to_array(),
        }
    }

    /// The leaf's coordinates of `p`. The x term comes last, so that along a row of samples the rest is
    /// computed once, and every way of sampling rounds alike.
    #[inline(always)]
    pub fn apply<S: Scalar>(&self, p: Triple<S>) -> Triple<S> {
        let m = |r: usize, c: usize| S::of(self.rows[r][c]);
        std::array::from_fn(|r| m(r, 0) * p[0] + ((m(r, 1) * p[1] + m(r, 2) * p[2]) + S::of(self.offset[r])))
    }

    /// The derivatives of the leaf's coordinates (rows) by those of the place (columns).
    #[inline(always)]
    pub fn rows<S: Scalar>(&self) -> [[S; 3]; 3] {
        self.rows.map(|row| row.map(S::of))
    }

    /// A gradient in the leaf's space, as one in the space of evaluation.
    #[inline(always)]
    pub fn pull_back<S: Scalar>(&self, g: Triple<S>) -> Triple<S> {
        let m = |r: usize, c: usize| S::of(self.rows[r][c]);
        std::array::from_fn(|c| m(0, c) * g[0] + m(1, c) * g[1] + m(2, c) * g[2])
    }

    /// The smallest box in the leaf's space around `region`.
    pub fn range(&self, region: &Aabb) -> Range {
        let (center, half) = (region.center(), region.size() * 0.5);
        let mut range = Range { center: Vec3::ZERO, half: Vec3::ZERO };
        for r in 0..3 {
            let row = Vec3::from_array(self.rows[r]);
            let reach = row.abs().dot(half);
            range.center[r] = row.dot(center) + self.offset[r];
            let magnitude = row.abs().dot(center.abs()) + self.offset[r].abs() + reach;
            range.half[r] = reach + 2e-6 * magnitude;
        }
        range
    }
}

impl Range {
    pub fn to_box(self) -> Aabb {
        Aabb::around(self.center, self.half)
    }

    /// Bounds of `|q_axis|`.
    pub fn abs(&self, axis: usize) -> (f32, f32) {
        let center = self.center[axis].abs();
        ((center - self.half[axis]).max(0.0), center + self.half[axis])
    }

    /// Bounds of `q_axis`.
    pub fn along(&self, axis: usize) -> (f32, f32) {
        (self.center[axis] - self.half[axis], self.center[axis] + self.half[axis])
    }

    /// Bounds of the distance from the z axis.
    pub fn around_z(&self) -> (f32, f32) {
        let (x, y) = (self.abs(0), self.abs(1));
        (x.0.hypot(y.0) * (1.0 - 1e-6), x.1.hypot(y.1) * (1.0 + 1e-6))
    }

    /// Bounds of the distance from the origin.
    pub fn length(&self) -> (f32, f32) {
        let near = Vec3::from_array([0, 1, 2].map(|a| self.abs(a).0));
        let far = Vec3::from_array([0, 1, 2].map(|a| self.abs(a).1));
        (near.length() * (1.0 - 1e-6), far.length() * (1.0 + 1e-6))
    }

    /// Half the diagonal: how far a function of Lipschitz constant 1 can stray from its value in the middle.
    pub fn radius(&self) -> f32 {
        self.half.length() * (1.0 + 1e-6)
    }
}

/// The rotation whose rows are an orthonormal basis with `z` (a unit vector) last: it turns `z` upright.
pub(crate) fn upright(z: DVec3) -> DMat3 {
    let x = z.any_orthonormal_vector();
    DMat3::from_cols(x, z.cross(x), z).transpose()
}
