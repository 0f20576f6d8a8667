//! Deformations of space, as the user describes them.

use crate::checks::{Checked, LONGEST, ParameterError, number, place};
use glam::{Affine3A, EulerRot, Mat3, Quat, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A deformation of the space in which a child stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Warp {
    /// Scale, then turn, then move.
    Transform(Transform),
    /// Any invertible linear map and a move.
    Affine(AffineMap),
    /// Cross-sections grow or shrink along an axis.
    Taper(Taper),
    /// Cross-sections turn along an axis.
    Twist(Twist),
    /// An axis becomes an arc.
    Bend(Bend),
}

impl Warp {
    /// The name in scene files and on screen.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Transform(_) => "transform",
            Self::Affine(_) => "affine",
            Self::Taper(_) => "taper",
            Self::Twist(_) => "twist",
            Self::Bend(_) => "bend",
        }
    }

    /// Whether every number is in its legal range.
    ///
    /// Errors: the first parameter that is not, with its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Transform(w) => w.check(),
            Self::Affine(w) => w.check(),
            Self::Taper(w) => w.check(),
            Self::Twist(w) => w.check(),
            Self::Bend(w) => w.check(),
        }
    }

    /// The map from the child's space to the parent's, where it is affine.
    pub fn parent_from_child(&self) -> Option<Affine3A> {
        match self {
            Self::Transform(w) => Some(w.parent_from_child()),
            Self::Affine(w) => Some(w.parent_from_child()),
            Self::Taper(_) | Self::Twist(_) | Self::Bend(_) => None,
        }
    }
}

/// Scale, then turn about x, y and z in this order, then move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Transform {
    /// How far to move, mm.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(with = "[f32; 3]", extend("default" = [0.0, 0.0, 0.0]))]
    pub translate: Vec3,
    /// Angles about the x, y and z axis, applied in this order, degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(with = "[f32; 3]", extend("default" = [0.0, 0.0, 0.0]))]
    pub rotate_degrees: Vec3,
    /// Factors along x, y and z, 0.001 to 1000; negative ones mirror.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[schemars(with = "[f32; 3]", extend("default" = [1.0, 1.0, 1.0]))]
    pub scale: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { translate: Vec3::ZERO, rotate_degrees: Vec3::ZERO, scale: Vec3::ONE }
    }
}

impl Transform {
    /// The map from the child's space to the parent's.
    pub fn parent_from_child(&self) -> Affine3A {
        let turn = self.rotate_degrees.map(f32::to_radians);
        // Extrinsic x, then y, then z.
        let rotation = Quat::from_euler(EulerRot::ZYX, turn.z, turn.y, turn.x);
        Affine3A::from_scale_rotation_translation(self.scale, rotation, self.translate)
    }
}

/// Any invertible affine map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AffineMap {
    /// Three rows of four numbers: the parent's x, y and z from the child's x, y, z and 1.
    pub rows: [[f32; 4]; 3],
}

impl AffineMap {
    /// The map from the child's space to the parent's.
    pub fn parent_from_child(&self) -> Affine3A {
        let [x, y, z] = self.rows;
        let linear = Mat3::from_cols_array_2d(&[[x[0], x[1], x[2]], [y[0], y[1], y[2]], [z[0], z[1], z[2]]]);
        Affine3A::from_mat3_translation(linear.transpose(), Vec3::new(x[3], y[3], z[3]))
    }
}

/// An axis of the coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

impl Axis {
    /// This axis's index, then the other two in right-handed order.
    pub(crate) fn indices(self) -> [usize; 3] {
        match self {
            Self::X => [0, 1, 2],
            Self::Y => [1, 2, 0],
            Self::Z => [2, 0, 1],
        }
    }
}

/// Cross-sections are scaled about the axis: by 1 up to `start`, by `scale` from `end` on, in between
/// linearly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Taper {
    /// The axis along which the scale changes. It runs through the origin. Default: z.
    #[serde(default = "z")]
    pub axis: Axis,
    /// Where along the axis the taper begins, mm.
    pub start: f32,
    /// Where it ends, mm; above `start`.
    pub end: f32,
    /// The scale from `end` on, 0.01 to 100.
    #[schemars(range(min = 0.01, max = 100.0))]
    pub scale: f32,
}

/// Cross-sections turn about the axis, the more the farther along it from the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Twist {
    /// The axis of the twist. It runs through the origin. Default: z.
    #[serde(default = "z")]
    pub axis: Axis,
    /// Turn for each mm along the axis, counter-clockwise seen against it, −90 to 90 degrees.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub degrees_per_mm: f32,
}

/// The stretch of the axis from `start` to `end` becomes an arc; what lies before stays, what lies after
/// goes on straight.
///
/// The solid should lie closer to the axis than the arc's radius, `(end − start) / angle`; what reaches past
/// the arc's centre folds over.
///
/// **Source:** Barr 1984, *Global and local deformations of solid primitives*.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// The axis that is bent. It runs through the origin. Default: z.
    #[serde(default = "z")]
    pub axis: Axis,
    /// The axis towards which it bends; another one. Default: x.
    #[serde(default = "x")]
    pub towards: Axis,
    /// Where along the axis the arc begins, mm.
    pub start: f32,
    /// Where it ends, mm; above `start`.
    pub end: f32,
    /// How far the axis turns, −180 to 180 degrees, not 0.
    #[schemars(range(min = -180.0, max = 180.0))]
    pub degrees: f32,
}

fn x() -> Axis {
    Axis::X
}

fn z() -> Axis {
    Axis::Z
}

fn one() -> Vec3 {
    Vec3::ONE
}

fn is_zero(v: &Vec3) -> bool {
    *v == Vec3::ZERO
}

fn is_one(v: &Vec3) -> bool {
    *v == Vec3::ONE
}

impl Checked for Transform {
    fn check(&self) -> Result<(), ParameterError> {
        place("translate", self.translate)?;
        for angle in self.rotate_degrees.to_array() {
            number("rotate_degrees", angle, -3600.0, 3600.0, "degrees")?;
        }
        for factor in self.scale.to_array() {
            if !(1e-3..=1e3).contains(&factor.abs()) {
                let expected = "0.001 to 1000, or the same below 0 to mirror";
                return Err(ParameterError::new("scale", factor, expected));
            }
        }
        Ok(())
    }
}

impl Checked for AffineMap {
    fn check(&self) -> Result<(), ParameterError> {
        let map = self.parent_from_child();
        let columns = Mat3::from(map.matrix3);
        let longest = columns.x_axis.length().max(columns.y_axis.length()).max(columns.z_axis.length());
        let volume = columns.determinant().abs();
        let legal = map.is_finite()
            && Vec3::from(map.translation).abs().max_element() <= LONGEST
            && (1e-3..=1e3).contains(&longest)
            && volume >= 1e-6 * longest.powi(3);
        if legal {
            Ok(())
        } else {
            let expected = "an invertible map that scales by 0.001 to 1000 and moves at most 100000 mm";
            Err(ParameterError::new("rows", self.rows, expected))
        }
    }
}

impl Checked for Taper {
    fn check(&self) -> Result<(), ParameterError> {
        stretch(self.start, self.end)?;
        number("scale", self.scale, 0.01, 100.0, "")
    }
}

impl Checked for Twist {
    fn check(&self) -> Result<(), ParameterError> {
        number("degrees_per_mm", self.degrees_per_mm, -90.0, 90.0, "")
    }
}

impl Checked for Bend {
    fn check(&self) -> Result<(), ParameterError> {
        stretch(self.start, self.end)?;
        number("degrees", self.degrees, -180.0, 180.0, "degrees, not 0")?;
        if self.degrees.abs() < 1e-3 {
            return Err(ParameterError::new("degrees", self.degrees, "-180 to 180 degrees, not 0"));
        }
        if self.axis == self.towards {
            return Err(ParameterError::new("towards", self.towards, "another axis than `axis`"));
        }
        Ok(())
    }
}

fn stretch(start: f32, end: f32) -> Result<(), ParameterError> {
    number("start", start, -LONGEST, LONGEST, "mm")?;
    number("end", end, -LONGEST, LONGEST, "mm")?;
    if end - start < crate::checks::SHORTEST {
        return Err(ParameterError::new("end", end, "above `start`"));
    }
    Ok(())
}
