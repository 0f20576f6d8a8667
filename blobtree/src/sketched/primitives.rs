//! The solids that are drawn, as the user describes them: a drawing, its plane, and what is done with it.
//!
//! The drawing stays in the node for ever; the template is solved from it and follows it. Sizes are mm.
//! `falloff` is how far the influence reaches beyond the surface; without it, the field reaches 1 just at the
//! deepest place of the drawing.

use super::{Drawing, SketchPlane, Solved, Template};
use crate::checks::{Checked, ParameterError, length, number, one_of_length, place, place_in_plane};
use crate::primitive::falloff;
use glam::{Vec2, Vec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A drawing blown up like a cushion: seen along the plane's normal, its outline is the drawn curve.
///
/// Half the thickness is `½ · thickness · √((1 − s²)(1 − contrast · s²(2 − s²)))`. There `1 − s²` is the
/// template's bulge as a share of its highest: the solution of `∇²h = −4` with 0 on the curve. A drawn circle
/// becomes a ball and a strip a round bar; nothing has ridges but where the curve has sharp corners. A part that
/// is narrower than the drawing's deepest is up to 1.41 times as thick as it is wide, if it is long. With the flat
/// profile, s⁴ stands for the first s², and the root is a fourth one.
///
/// **Source:** Schmidt & Wyvill 2011, §11.3.3. **Departs:** the paper multiplies the template's field by a
/// falloff along the normal. Its height follows the distance from the curve, which has ridges halfway between
/// sides of the curve; and its surface depends on the falloff. The surface here is a true ellipsoid over a circle,
/// smooth, and does not change with the falloff.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Inflation {
    /// What was drawn.
    pub drawing: Arc<Drawing>,
    /// Where the drawing lies.
    #[serde(default, skip_serializing_if = "SketchPlane::is_default")]
    pub plane: SketchPlane,
    /// From surface to surface at the highest place, mm. Default: twice the drawing's depth, which is round.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub thickness: Option<f32>,
    /// How much thinner thin parts are than a cushion makes them: 0 not at all, 0.9 nearly as thin as they are
    /// narrow.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 0.9), extend("default" = 0.0))]
    pub contrast: f32,
    /// How much of the thickness follows the pen's pressure: 0 none, 1 all.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 1.0), extend("default" = 0.0))]
    pub pressure: f32,
    /// The shape across.
    #[serde(default, skip_serializing_if = "Profile::is_round")]
    #[schemars(extend("default" = "round"))]
    pub profile: Profile,
    /// How far the influence reaches beyond the surface in the plane, mm, and in proportion across it.
    /// Default: 1.2017 times the drawing's depth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
    /// Solved from the drawing.
    #[serde(skip)]
    pub template: Solved,
}

/// The shape of an inflation across.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Round all over, like a ball.
    #[default]
    Round,
    /// Flat with round edges, like a biscuit.
    Flat,
}

impl Profile {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    fn is_round(&self) -> bool {
        *self == Self::Round
    }
}

/// A drawing moved along its plane's normal: flat ends, sharp or filleted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearSweep {
    /// What was drawn.
    pub drawing: Arc<Drawing>,
    /// Where the drawing lies.
    #[serde(default, skip_serializing_if = "SketchPlane::is_default")]
    pub plane: SketchPlane,
    /// From end to end, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub length: f32,
    /// How far the middle lies before the plane, towards whoever draws, mm.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = -100_000.0, max = 100_000.0), extend("default" = 0.0))]
    pub offset: f32,
    /// Radius of the rounded edges of the ends, mm; 0 for sharp ones, at most half the length. Beyond the
    /// drawing's depth it counts as that depth.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 50_000.0), extend("default" = 0.0))]
    pub fillet: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the drawing's depth or half
    /// the length, whichever is smaller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
    /// Solved from the drawing.
    #[serde(skip)]
    pub template: Solved,
}

/// A drawing turned about an axis in its plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Revolution {
    /// What was drawn.
    pub drawing: Arc<Drawing>,
    /// Where the drawing lies.
    #[serde(default, skip_serializing_if = "SketchPlane::is_default")]
    pub plane: SketchPlane,
    /// The axis, in the drawing.
    #[serde(default, skip_serializing_if = "RevolutionAxis::is_default")]
    pub axis: RevolutionAxis,
    /// Which side of the axis is turned. Default: the one with more of the drawing. A drawing that comes
    /// closer to the axis than 3 % of the distance to its far end touches it, and leaves no hole there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the drawing's depth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
    /// Solved from the drawing.
    #[serde(skip)]
    pub template: Solved,
}

/// A line in a drawing about which it turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RevolutionAxis {
    /// A point of the axis in the drawing, mm.
    #[serde(default)]
    #[schemars(with = "[f32; 2]")]
    pub at: Vec2,
    /// Its direction in the drawing; any length but 0. Default: up.
    #[serde(default = "upwards")]
    #[schemars(with = "[f32; 2]")]
    pub direction: Vec2,
}

impl Default for RevolutionAxis {
    fn default() -> Self {
        Self { at: Vec2::ZERO, direction: Vec2::Y }
    }
}

impl RevolutionAxis {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A side of an axis, seen along its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// What lies to the left.
    Left,
    /// What lies to the right.
    Right,
    /// Both sides, one upon the other.
    Both,
}

/// A drawing moved along a path in space, turning with it as little as it can.
///
/// The drawing starts where the path does, turned from its plane into the one across the path, and keeps its
/// place beside the path. Where the path bends, its straight parts meet in the plane halfway between them.
/// **Source:** Schmidt & Wyvill 2011, §11.3.3, "arbitrary trajectories".
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathSweep {
    /// What was drawn.
    pub drawing: Arc<Drawing>,
    /// Where the drawing lies.
    #[serde(default, skip_serializing_if = "SketchPlane::is_default")]
    pub plane: SketchPlane,
    /// The path: 2 to 4096 points, not all the same, mm.
    #[schemars(with = "Vec<[f32; 3]>", length(min = 2, max = 4096))]
    pub path: Vec<Vec3>,
    /// Radius of the rounded edges of the ends, mm; 0 for sharp ones. Beyond the drawing's depth it counts as
    /// that depth.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 50_000.0), extend("default" = 0.0))]
    pub fillet: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the drawing's depth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
    /// Solved from the drawing.
    #[serde(skip)]
    pub template: Solved,
}

fn upwards() -> Vec2 {
    Vec2::Y
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_zero(x: &f32) -> bool {
    *x == 0.0
}

impl Inflation {
    /// The drawing blown up as thick as it is wide, round, with its own falloff.
    pub fn new(drawing: Arc<Drawing>, plane: SketchPlane, template: Arc<Template>) -> Self {
        Self {
            drawing,
            plane,
            thickness: None,
            contrast: 0.0,
            pressure: 0.0,
            profile: Profile::Round,
            falloff: None,
            template: Solved(template),
        }
    }
}

impl LinearSweep {
    /// The drawing moved by `length` mm, half of it on each side of the plane, with sharp ends and its own falloff.
    pub fn new(drawing: Arc<Drawing>, plane: SketchPlane, template: Arc<Template>, length: f32) -> Self {
        let (offset, fillet, falloff) = (0.0, 0.0, None);
        Self { drawing, plane, length, offset, fillet, falloff, template: Solved(template) }
    }
}

impl Revolution {
    /// The fuller side of the drawing turned about an axis, with its own falloff.
    pub fn new(
        drawing: Arc<Drawing>,
        plane: SketchPlane,
        template: Arc<Template>,
        axis: RevolutionAxis,
    ) -> Self {
        Self { drawing, plane, axis, side: None, falloff: None, template: Solved(template) }
    }
}

impl PathSweep {
    /// The drawing moved along a path, mm, with sharp ends and its own falloff.
    pub fn new(drawing: Arc<Drawing>, plane: SketchPlane, template: Arc<Template>, path: Vec<Vec3>) -> Self {
        Self { drawing, plane, path, fillet: 0.0, falloff: None, template: Solved(template) }
    }
}

impl Checked for Inflation {
    fn check(&self) -> Result<(), ParameterError> {
        self.drawing.check()?;
        self.plane.check()?;
        if let Some(thickness) = self.thickness {
            length("thickness", thickness)?;
        }
        number("contrast", self.contrast, 0.0, 0.9, "")?;
        number("pressure", self.pressure, 0.0, 1.0, "")?;
        falloff(self.falloff)
    }
}

impl Checked for LinearSweep {
    fn check(&self) -> Result<(), ParameterError> {
        self.drawing.check()?;
        self.plane.check()?;
        length("length", self.length)?;
        number("offset", self.offset, -crate::checks::LONGEST, crate::checks::LONGEST, "mm")?;
        if !(0.0..=self.length / 2.0).contains(&self.fillet) {
            return Err(ParameterError::new("fillet", self.fillet, "0 to half the length"));
        }
        falloff(self.falloff)
    }
}

impl Checked for Revolution {
    fn check(&self) -> Result<(), ParameterError> {
        self.drawing.check()?;
        self.plane.check()?;
        place_in_plane("axis.at", self.axis.at)?;
        place_in_plane("axis.direction", self.axis.direction)?;
        if self.axis.direction.length() < 1e-6 {
            let expected = "a direction: two numbers, not both 0";
            return Err(ParameterError::new("axis.direction", self.axis.direction, expected));
        }
        falloff(self.falloff)
    }
}

impl Checked for PathSweep {
    fn check(&self) -> Result<(), ParameterError> {
        self.drawing.check()?;
        self.plane.check()?;
        one_of_length("path", self.path.len(), 2, 4096)?;
        for p in &self.path {
            place("path", *p)?;
        }
        if self.path.iter().all(|p| p.distance(self.path[0]) < crate::checks::SHORTEST) {
            return Err(ParameterError::new("path", "points all in one place", "at least two places"));
        }
        number("fillet", self.fillet, 0.0, 50_000.0, "mm")?;
        falloff(self.falloff)
    }
}
