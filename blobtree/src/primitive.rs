//! The solids at the leaves of the tree, as the user describes them.
//!
//! Sizes are those of the surface, in mm. `falloff` is how far the influence reaches beyond the surface and
//! so how widely the solid blends; without it, the field reaches 1 just at the deepest place of the solid.

use crate::checks::{Checked, ParameterError, length, one_of_length, place, unit};
use crate::imported::ImportedMesh;
use crate::sketched::{Drawing, Inflation, LinearSweep, PathSweep, Revolution, Template};
use glam::Vec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A solid without children.
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive {
    /// A ball around a point.
    Point(Point),
    /// A capsule around a line segment.
    Segment(Segment),
    /// A chain of capsules whose radius changes from point to point.
    Polyline(Polyline),
    /// A flat round pebble around a disc.
    Disc(Disc),
    /// A flat pebble around a planar polygon.
    Polygon(Polygon),
    /// A box, with sharp or rounded edges.
    Box(Cuboid),
    /// A cylinder with sharp rims.
    Cylinder(Cylinder),
    /// A cone or a truncated cone with sharp rims.
    Cone(Cone),
    /// A ring.
    Torus(Torus),
    /// An ellipsoid.
    Ellipsoid(Ellipsoid),
    /// Everything on one side of a plane, as far as `extent`.
    HalfSpace(HalfSpace),
    /// A triangle mesh from a file.
    Mesh(ImportedMesh),
    /// A drawing blown up like a cushion.
    Inflation(Inflation),
    /// A drawing moved along its plane's normal.
    LinearSweep(LinearSweep),
    /// A drawing turned about an axis.
    Revolution(Revolution),
    /// A drawing moved along a path.
    PathSweep(PathSweep),
}

impl Primitive {
    /// The name in scene files and on screen.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Point(_) => "point",
            Self::Segment(_) => "segment",
            Self::Polyline(_) => "polyline",
            Self::Disc(_) => "disc",
            Self::Polygon(_) => "polygon",
            Self::Box(_) => "box",
            Self::Cylinder(_) => "cylinder",
            Self::Cone(_) => "cone",
            Self::Torus(_) => "torus",
            Self::Ellipsoid(_) => "ellipsoid",
            Self::HalfSpace(_) => "half_space",
            Self::Mesh(_) => "mesh",
            Self::Inflation(_) => "inflation",
            Self::LinearSweep(_) => "sweep",
            Self::Revolution(_) => "revolution",
            Self::PathSweep(_) => "path_sweep",
        }
    }

    /// Whether every number is in its legal range.
    ///
    /// Errors: the first parameter that is not, with its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Point(p) => p.check(),
            Self::Segment(p) => p.check(),
            Self::Polyline(p) => p.check(),
            Self::Disc(p) => p.check(),
            Self::Polygon(p) => p.check(),
            Self::Box(p) => p.check(),
            Self::Cylinder(p) => p.check(),
            Self::Cone(p) => p.check(),
            Self::Torus(p) => p.check(),
            Self::Ellipsoid(p) => p.check(),
            Self::HalfSpace(p) => p.check(),
            Self::Mesh(p) => p.check(),
            Self::Inflation(p) => p.check(),
            Self::LinearSweep(p) => p.check(),
            Self::Revolution(p) => p.check(),
            Self::PathSweep(p) => p.check(),
        }
    }
}

/// What drawn primitives have in common: the drawing, how far it is to reach, and the template solved for both.
pub(crate) struct Drawn<'a> {
    pub drawing: &'a mut Arc<Drawing>,
    pub falloff: Option<f32>,
    pub template: &'a mut Arc<Template>,
}

impl Primitive {
    /// Whether it is made from a drawing.
    pub(crate) fn is_drawn(&self) -> bool {
        matches!(self, Self::Inflation(_) | Self::LinearSweep(_) | Self::Revolution(_) | Self::PathSweep(_))
    }

    /// What it is drawn with, if it is.
    pub(crate) fn drawn(&mut self) -> Option<Drawn<'_>> {
        let (drawing, falloff, template) = match self {
            Self::Inflation(p) => (&mut p.drawing, p.falloff, &mut p.template),
            Self::LinearSweep(p) => (&mut p.drawing, p.falloff, &mut p.template),
            Self::Revolution(p) => (&mut p.drawing, p.falloff, &mut p.template),
            Self::PathSweep(p) => (&mut p.drawing, p.falloff, &mut p.template),
            _ => return None,
        };
        Some(Drawn { drawing, falloff, template: &mut template.0 })
    }
}

/// A ball. Without `falloff` it is the paper's point primitive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Centre, mm.
    #[schemars(with = "[f32; 3]")]
    pub center: Vec3,
    /// Distance from the centre to the surface, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub radius: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A capsule: everything within `radius` of a line segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// One end of the axis, mm.
    #[schemars(with = "[f32; 3]")]
    pub from: Vec3,
    /// The other end of the axis, mm. May be the same point.
    #[schemars(with = "[f32; 3]")]
    pub to: Vec3,
    /// Distance from the axis to the surface, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub radius: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A chain of capsules whose radius changes from point to point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polyline {
    /// At least one point, at most 4096.
    #[schemars(length(min = 1, max = 4096))]
    pub points: Vec<PolylinePoint>,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the largest radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A point of a [`Polyline`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PolylinePoint {
    /// Place on the axis, mm.
    #[schemars(with = "[f32; 3]")]
    pub at: Vec3,
    /// Distance from the axis to the surface here, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub radius: f32,
}

/// A flat round pebble: everything within half the thickness of a disc.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre, mm.
    #[schemars(with = "[f32; 3]")]
    pub center: Vec3,
    /// Direction across the disc; any length but 0. Default: up.
    #[serde(default = "up")]
    #[schemars(with = "[f32; 3]")]
    pub normal: Vec3,
    /// Distance from the centre to the rim of the surface, mm; at least half the thickness.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub radius: f32,
    /// Thickness from surface to surface, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub thickness: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 0.6008 times the thickness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A flat pebble: everything within half the thickness of a planar polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// At least 3 corners in one plane (to 1 % of their extent), at most 1024, in order, mm. Need not be
    /// convex; crossing edges count even-odd.
    #[schemars(with = "Vec<[f32; 3]>", length(min = 3, max = 1024))]
    pub points: Vec<Vec3>,
    /// Thickness from surface to surface, mm; the outline grows by half of it.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub thickness: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 0.6008 times the thickness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A box along the axes. Turn it with a transform.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Centre, mm.
    #[schemars(with = "[f32; 3]")]
    pub center: Vec3,
    /// Side lengths, mm.
    #[schemars(with = "[f32; 3]")]
    pub size: Vec3,
    /// Radius of the rounded edges, mm; 0 for sharp edges, at most half the shortest side.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 100_000.0), extend("default" = 0.0))]
    pub rounding: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 0.6008 times the shortest side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A cylinder with flat ends and sharp rims.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Centre of one end, mm.
    #[schemars(with = "[f32; 3]")]
    pub from: Vec3,
    /// Centre of the other end, mm; must be another point.
    #[schemars(with = "[f32; 3]")]
    pub to: Vec3,
    /// Radius, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub radius: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the radius or half the
    /// length, whichever is smaller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A cone, or a truncated one, with flat ends and sharp rims.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Centre of the base, mm.
    #[schemars(with = "[f32; 3]")]
    pub from: Vec3,
    /// Centre of the top, mm; must be another point.
    #[schemars(with = "[f32; 3]")]
    pub to: Vec3,
    /// Radius of the base, mm; 0 for a tip.
    #[schemars(range(min = 0.0, max = 100_000.0))]
    pub radius_from: f32,
    /// Radius of the top, mm; 0 for a tip. Not both may be 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 100_000.0))]
    pub radius_to: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 0.6008 times the larger radius or half
    /// the length, whichever is smaller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// A ring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Torus {
    /// Centre, mm.
    #[schemars(with = "[f32; 3]")]
    pub center: Vec3,
    /// Direction of the axis; any length but 0. Default: up.
    #[serde(default = "up")]
    #[schemars(with = "[f32; 3]")]
    pub normal: Vec3,
    /// Distance from the centre to the middle of the tube, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub major_radius: f32,
    /// Radius of the tube, mm.
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub minor_radius: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the minor radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// An ellipsoid along the axes. Turn it with a transform.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// Centre, mm.
    #[schemars(with = "[f32; 3]")]
    pub center: Vec3,
    /// Distances from the centre to the surface along x, y and z, mm; at most 100 times apart.
    #[schemars(with = "[f32; 3]")]
    pub radii: Vec3,
    /// How far the influence reaches beyond the surface, mm. Default: 1.2017 times the smallest radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: Option<f32>,
}

/// Everything behind a plane, as far as `extent` from `point`: for cutting and for ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfSpace {
    /// A point on the plane, mm.
    #[schemars(with = "[f32; 3]")]
    pub point: Vec3,
    /// Direction out of the solid; any length but 0. Default: up.
    #[serde(default = "up")]
    #[schemars(with = "[f32; 3]")]
    pub normal: Vec3,
    /// How far from `point` the solid goes on, mm: fields must end somewhere. Default: 500.
    #[serde(default = "far")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub extent: f32,
    /// How far the influence reaches beyond the surface, mm. Default: 5.
    #[serde(default = "five")]
    #[schemars(range(min = 0.001, max = 100_000.0))]
    pub falloff: f32,
}

fn up() -> Vec3 {
    Vec3::Z
}

fn far() -> f32 {
    500.0
}

fn five() -> f32 {
    5.0
}

fn is_zero(x: &f32) -> bool {
    *x == 0.0
}

impl Checked for Point {
    fn check(&self) -> Result<(), ParameterError> {
        place("center", self.center)?;
        length("radius", self.radius)?;
        falloff(self.falloff)
    }
}

impl Checked for Segment {
    fn check(&self) -> Result<(), ParameterError> {
        place("from", self.from)?;
        place("to", self.to)?;
        length("radius", self.radius)?;
        falloff(self.falloff)
    }
}

impl Checked for Polyline {
    fn check(&self) -> Result<(), ParameterError> {
        one_of_length("points", self.points.len(), 1, 4096)?;
        for p in &self.points {
            place("points.at", p.at)?;
            length("points.radius", p.radius)?;
        }
        falloff(self.falloff)
    }
}

impl Checked for Disc {
    fn check(&self) -> Result<(), ParameterError> {
        place("center", self.center)?;
        unit("normal", self.normal)?;
        length("radius", self.radius)?;
        length("thickness", self.thickness)?;
        if self.thickness > 2.0 * self.radius {
            return Err(ParameterError::new("thickness", self.thickness, "at most twice the radius"));
        }
        falloff(self.falloff)
    }
}

impl Checked for Polygon {
    fn check(&self) -> Result<(), ParameterError> {
        one_of_length("points", self.points.len(), 3, 1024)?;
        for p in &self.points {
            place("points", *p)?;
        }
        length("thickness", self.thickness)?;
        if crate::leaf::polygon::plane(&self.points).is_none() {
            let expected = "corners of one plane, not all on a line";
            return Err(ParameterError::new("points", format!("{} points", self.points.len()), expected));
        }
        falloff(self.falloff)
    }
}

impl Checked for Cuboid {
    fn check(&self) -> Result<(), ParameterError> {
        place("center", self.center)?;
        for side in self.size.to_array() {
            length("size", side)?;
        }
        if !(0.0..=self.size.min_element() / 2.0).contains(&self.rounding) {
            let expected = "0 to half the shortest side";
            return Err(ParameterError::new("rounding", self.rounding, expected));
        }
        falloff(self.falloff)
    }
}

impl Checked for Cylinder {
    fn check(&self) -> Result<(), ParameterError> {
        axis(self.from, self.to)?;
        length("radius", self.radius)?;
        falloff(self.falloff)
    }
}

impl Checked for Cone {
    fn check(&self) -> Result<(), ParameterError> {
        axis(self.from, self.to)?;
        for (name, radius) in [("radius_from", self.radius_from), ("radius_to", self.radius_to)] {
            if radius != 0.0 {
                length(name, radius)?;
            }
        }
        if self.radius_from == 0.0 && self.radius_to == 0.0 {
            return Err(ParameterError::new("radius_to", 0.0, "a radius above 0 at one end at least"));
        }
        falloff(self.falloff)
    }
}

impl Checked for Torus {
    fn check(&self) -> Result<(), ParameterError> {
        place("center", self.center)?;
        unit("normal", self.normal)?;
        length("major_radius", self.major_radius)?;
        length("minor_radius", self.minor_radius)?;
        falloff(self.falloff)
    }
}

impl Checked for Ellipsoid {
    fn check(&self) -> Result<(), ParameterError> {
        place("center", self.center)?;
        for radius in self.radii.to_array() {
            length("radii", radius)?;
        }
        if self.radii.max_element() > 100.0 * self.radii.min_element() {
            let expected = "radii at most 100 times apart";
            return Err(ParameterError::new("radii", self.radii, expected));
        }
        falloff(self.falloff)
    }
}

impl Checked for HalfSpace {
    fn check(&self) -> Result<(), ParameterError> {
        place("point", self.point)?;
        unit("normal", self.normal)?;
        length("extent", self.extent)?;
        length("falloff", self.falloff)
    }
}

/// Checks an optional falloff width.
pub(crate) fn falloff(width: Option<f32>) -> Result<(), ParameterError> {
    width.map_or(Ok(()), |w| length("falloff", w))
}

fn axis(from: Vec3, to: Vec3) -> Result<(), ParameterError> {
    place("from", from)?;
    place("to", to)?;
    if from.distance(to) < crate::checks::SHORTEST {
        return Err(ParameterError::new("to", to, "a point other than `from`"));
    }
    Ok(())
}
