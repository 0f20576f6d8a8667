//! Quadric error: the mean squared distance to a set of planes, as a function of the point.

use glam::{DMat3, DVec3};

/// Σ (n·x + d)² over planes with unit normals, and how many planes.
/// **Source:** Garland & Heckbert 1997, *Surface Simplification Using Quadric Error Metrics*; **departs** by dividing
/// by the number of planes, so that the error is a length squared that can be compared with a tolerance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadric {
    /// xx, yy, zz, xy, yz, zx of Σ n nᵀ.
    square: [f64; 6],
    linear: DVec3,
    constant: f64,
    planes: f64,
}

impl Quadric {
    /// The plane through `point` with unit `normal`.
    pub fn plane(point: DVec3, normal: DVec3) -> Self {
        let DVec3 { x, y, z } = normal;
        let offset = -normal.dot(point);
        Self {
            square: [x * x, y * y, z * z, x * y, y * z, z * x],
            linear: normal * offset,
            constant: offset * offset,
            planes: 1.0,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        Self {
            square: std::array::from_fn(|i| self.square[i] + other.square[i]),
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            planes: self.planes + other.planes,
        }
    }

    /// The mean squared distance at `x`, never negative; 0 without planes.
    pub fn at(&self, x: DVec3) -> f64 {
        let sum = x.dot(self.matrix() * x) + 2.0 * self.linear.dot(x) + self.constant;
        (sum / self.planes.max(1.0)).max(0.0)
    }

    /// The point with the least error; none where the planes do not single one out.
    pub fn minimum(&self) -> Option<DVec3> {
        let matrix = self.matrix();
        let trace = self.square[0] + self.square[1] + self.square[2];
        // Relative to the cube of the mean eigenvalue: below this the planes nearly share a line.
        let well_posed = matrix.determinant() > 1e-4 * (trace / 3.0).powi(3);
        well_posed.then(|| matrix.inverse() * -self.linear)
    }

    /// Where along the way from `a` (0) to `b` (1) the error is least; none if it is the same all along.
    pub fn minimum_between(&self, a: DVec3, b: DVec3) -> Option<f64> {
        let along = b - a;
        let bend = along.dot(self.matrix() * along);
        let slope = along.dot(self.matrix() * a + self.linear);
        (bend > 1e-12 * along.length_squared()).then(|| (-slope / bend).clamp(0.0, 1.0))
    }

    fn matrix(&self) -> DMat3 {
        let [xx, yy, zz, xy, yz, zx] = self.square;
        DMat3::from_cols_array(&[xx, xy, zx, xy, yy, yz, zx, yz, zz])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_their_common_point_and_errors_add() {
        let corner = DVec3::new(1.0, 2.0, 3.0);
        let planes = [DVec3::X, DVec3::Y, DVec3::Z].map(|n| Quadric::plane(corner, n));
        let sum = planes.iter().fold(Quadric::default(), |q, p| q.plus(p));
        assert!(sum.minimum().unwrap().abs_diff_eq(corner, 1e-12));
        assert!((sum.at(DVec3::new(2.0, 4.0, 3.0)) - 5.0 / 3.0).abs() < 1e-12);
        let edge = planes[0].plus(&planes[1]);
        assert_eq!(edge.minimum(), None);
        assert_eq!(edge.minimum_between(corner, corner + DVec3::Z), None);
        assert_eq!(planes[0].minimum_between(DVec3::ZERO, DVec3::X * 4.0), Some(0.25));
    }
}
