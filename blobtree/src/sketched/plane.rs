//! Where a drawing lies in space.

use crate::checks::{ParameterError, place, unit};
use glam::{DMat3, DVec3, Vec2, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The plane of a drawing: its point (x, y) lies at `origin + x · right + y · up`.
///
/// By default drawings stand upright and face −y, as seen by someone who looks along +y with z up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SketchPlane {
    /// Where the drawing's origin lies, mm.
    #[serde(default)]
    #[schemars(with = "[f32; 3]")]
    pub origin: Vec3,
    /// The drawing's x direction; any length but 0. Default: +x.
    #[serde(default = "x_axis")]
    #[schemars(with = "[f32; 3]")]
    pub right: Vec3,
    /// The drawing's y direction; what of it points along `right` is left aside. Default: +z.
    #[serde(default = "z_axis")]
    #[schemars(with = "[f32; 3]")]
    pub up: Vec3,
}

fn x_axis() -> Vec3 {
    Vec3::X
}

fn z_axis() -> Vec3 {
    Vec3::Z
}

impl Default for SketchPlane {
    fn default() -> Self {
        Self { origin: Vec3::ZERO, right: Vec3::X, up: Vec3::Z }
    }
}

impl SketchPlane {
    /// Whether this is the default plane.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Unit vectors along the drawing's x and y, and across it towards whoever draws.
    pub fn axes(&self) -> [Vec3; 3] {
        self.precise_axes().map(|axis| axis.as_vec3())
    }

    pub(crate) fn precise_axes(&self) -> [DVec3; 3] {
        let right = self.right.as_dvec3().normalize_or(DVec3::X);
        let up = self.up.as_dvec3();
        let up = (up - right * up.dot(right)).normalize_or(right.any_orthonormal_vector());
        [right, up, right.cross(up)]
    }

    /// The rotation from space to the plane's axes: right, up, towards whoever draws.
    pub(crate) fn turn(&self) -> DMat3 {
        let [right, up, normal] = self.precise_axes();
        DMat3::from_cols(right, up, normal).transpose()
    }

    /// Where a point of the drawing lies in space, mm.
    pub fn point(&self, at: Vec2) -> Vec3 {
        let [right, up, _] = self.axes();
        self.origin + right * at.x + up * at.y
    }

    /// The point of the drawing nearest to a place, and how far the place lies before the plane, mm.
    pub fn project(&self, place: Vec3) -> (Vec2, f32) {
        let q = self.turn() * (place - self.origin).as_dvec3();
        (Vec2::new(q.x as f32, q.y as f32), q.z as f32)
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        place("plane.origin", self.origin)?;
        unit("plane.right", self.right)?;
        unit("plane.up", self.up)?;
        let (right, up) = (self.right.as_dvec3().normalize_or_zero(), self.up.as_dvec3().normalize_or_zero());
        if right.cross(up).length() < 1e-3 {
            return Err(ParameterError::new("plane.up", self.up, "a direction other than `plane.right`"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_stands_upright_and_faces_the_viewer_by_default() {
        let plane = SketchPlane::default();
        assert_eq!(plane.point(Vec2::new(2.0, 3.0)), Vec3::new(2.0, 0.0, 3.0));
        assert_eq!(plane.axes()[2], Vec3::NEG_Y);
        assert_eq!(plane.project(Vec3::new(2.0, -7.0, 3.0)), (Vec2::new(2.0, 3.0), 7.0));
    }

    #[test]
    fn any_two_directions_make_right_angles_and_equal_ones_are_refused() {
        let plane = SketchPlane {
            right: Vec3::new(3.0, 1.0, 0.0),
            up: Vec3::new(1.0, 2.0, 5.0),
            ..SketchPlane::default()
        };
        let [right, up, normal] = plane.axes();
        assert!(right.dot(up).abs() < 1e-6 && (right.cross(up) - normal).length() < 1e-6);
        assert!((up.length() - 1.0).abs() < 1e-6 && up.dot(plane.up) > 0.0);
        assert!(plane.check().is_ok());
        let flat = SketchPlane { up: Vec3::NEG_X, ..SketchPlane::default() };
        assert_eq!(flat.check().expect_err("parallel").field, "plane.up");
    }
}
