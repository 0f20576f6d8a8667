//! A drawing as a sketched node keeps it: the strokes themselves, in the sketch plane.

use crate::checks::{ParameterError, number, one_of_length, place_in_plane};
use glam::Vec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Strokes in a sketch plane, and how they are to be read. Coordinates are mm, x to the right, y up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drawing {
    /// The strokes in the order in which they were drawn.
    pub strokes: Vec<DrawnStroke>,
    /// Places of corners that are found in the strokes but are to be round, mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<[f32; 2]>")]
    pub rounded: Vec<Vec2>,
    /// Places where a corner is wanted though none is found, mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<[f32; 2]>")]
    pub sharpened: Vec<Vec2>,
    /// What closed strokes inside an outline mean.
    #[serde(default, skip_serializing_if = "Holes::is_kept")]
    pub holes: Holes,
}

/// What closed strokes inside an outline mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Holes {
    /// Holes, and islands in holes.
    #[default]
    Keep,
    /// Nothing: the outline is filled.
    Fill,
}

impl Holes {
    fn is_kept(&self) -> bool {
        *self == Self::Keep
    }
}

/// One movement of the pen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrawnStroke {
    /// Where the pen was: `[x, y]` in mm, perhaps with the pressure (0 to 1, default 1) and the smoothing
    /// (0 to 100, default 0).
    #[schemars(with = "Vec<Vec<f32>>", inner(length(min = 2, max = 4)))]
    pub points: Vec<DrawnPoint>,
}

/// A place of the pen. In files a list of 2 to 4 numbers, as there are thousands of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f32>", into = "Vec<f32>")]
pub struct DrawnPoint {
    /// Place in the sketch plane, mm.
    pub at: Vec2,
    /// How hard the pen pressed, 0 to 1.
    pub pressure: f32,
    /// How far the curve may leave this point to be smooth, 0 to 100: 0 as close as for any other, each step of 1
    /// as much as one circling gesture asks for.
    pub smoothing: f32,
}

impl DrawnPoint {
    /// A point where the pen pressed fully, mm.
    pub fn at(at: Vec2) -> Self {
        Self { at, pressure: 1.0, smoothing: 0.0 }
    }
}

impl From<DrawnPoint> for Vec<f32> {
    fn from(DrawnPoint { at, pressure, smoothing }: DrawnPoint) -> Self {
        let numbers = [at.x, at.y, pressure, smoothing];
        let count = match (pressure, smoothing) {
            (1.0, 0.0) => 2,
            (_, 0.0) => 3,
            _ => 4,
        };
        numbers[..count].to_vec()
    }
}

impl TryFrom<Vec<f32>> for DrawnPoint {
    type Error = &'static str;

    fn try_from(numbers: Vec<f32>) -> Result<Self, Self::Error> {
        let (x, y, rest) = match numbers.as_slice() {
            [x, y, rest @ ..] if rest.len() <= 2 => (*x, *y, rest),
            _ => {
                return Err("[x, y], [x, y, pressure] or [x, y, pressure, smoothing]");
            }
        };
        let or = |i: usize, default: f32| rest.get(i).copied().unwrap_or(default);
        Ok(Self { at: Vec2::new(x, y), pressure: or(0, 1.0), smoothing: or(1, 0.0) })
    }
}

impl Drawing {
    /// Most strokes in a drawing.
    pub const MAX_STROKES: usize = 10_000;
    /// Most points in a drawing, those of all strokes together; also most places of corners.
    pub const MAX_POINTS: usize = 100_000;

    /// Whether every number is in its legal range. A legal drawing need not have an outline.
    ///
    /// Errors: the first number that is not, with its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        one_of_length("drawing.strokes", self.strokes.len(), 0, Self::MAX_STROKES)?;
        one_of_length("drawing.rounded", self.rounded.len(), 0, Self::MAX_POINTS)?;
        one_of_length("drawing.sharpened", self.sharpened.len(), 0, Self::MAX_POINTS)?;
        let points: usize = self.strokes.iter().map(|stroke| stroke.points.len()).sum();
        one_of_length("drawing.strokes.points", points, 0, Self::MAX_POINTS)?;
        for point in self.strokes.iter().flat_map(|stroke| &stroke.points) {
            place_in_plane("drawing.strokes.points", point.at)?;
            number("drawing.strokes.points.pressure", point.pressure, 0.0, 1.0, "")?;
            number("drawing.strokes.points.smoothing", point.smoothing, 0.0, 100.0, "")?;
        }
        self.rounded.iter().try_for_each(|at| place_in_plane("drawing.rounded", *at))?;
        self.sharpened.iter().try_for_each(|at| place_in_plane("drawing.sharpened", *at))
    }
}
