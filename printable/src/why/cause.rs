//! Causes, in words.

use blobtree::BrushKind;
use glam::{Affine3A, Vec3};
use std::fmt;

/// Why matter was taken away or added. Angles are from the vertical, in degrees; places in mm.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// Taken: it lies below the bed.
    BelowBed,
    /// Taken: nothing of its part of the layer is carried from below; it would have been printed in the air.
    Island,
    /// Taken: the surface below it overhangs too far.
    Overhang {
        /// How far that surface leans out; 90 if it is flat.
        lean_degrees: f32,
        /// The most that prints.
        most_degrees: f32,
        /// Where: straight below.
        underside: Vec3,
    },
    /// Taken: the surface below it does not lean out too far, or there is none, but what carried it was taken away.
    Toppled,
    /// Added, so that matter above is carried.
    Grown {
        /// A place of that matter which nothing would carry; none if it is too small to be found.
        holds: Option<Vec3>,
    },
    /// A brush stroke did it.
    Stroke {
        /// Which one, from 0.
        number: usize,
        /// What its brush does.
        brush: BrushKind,
        /// Whether the tip came here; else it is a consequence.
        under_tip: bool,
        /// Whether it added matter here.
        added: bool,
    },
    /// Taken: it hung in the air in the exact slices of the mesh, when that was settled.
    Settled,
}

impl Cause {
    /// A short name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::BelowBed => "below_bed",
            Self::Island => "island",
            Self::Overhang { .. } => "overhang",
            Self::Toppled => "toppled",
            Self::Grown { .. } => "grown",
            Self::Stroke { .. } => "stroke",
            Self::Settled => "settled",
        }
    }

    /// The same with its places in the space that `map` leads to.
    pub(super) fn seen_through(mut self, map: &Affine3A) -> Self {
        match &mut self {
            Self::Overhang { underside, .. } => *underside = map.transform_point3(*underside),
            Self::Grown { holds: Some(place) } => *place = map.transform_point3(*place),
            _ => {}
        }
        self
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BelowBed => f.write_str("below the bed"),
            Self::Island => f.write_str("island: nothing below holds it"),
            Self::Overhang { lean_degrees, most_degrees, underside } => write!(
                f,
                "overhang: the surface below it, at {}, leans out by {lean_degrees:.0}° from the vertical, \
                 more than {most_degrees}°",
                Told(*underside)
            ),
            Self::Toppled => f.write_str("what carried it was taken away"),
            Self::Grown { holds: Some(place) } => write!(f, "grown to hold what hangs at {}", Told(*place)),
            Self::Grown { holds: None } => f.write_str("grown to hold what hangs above"),
            Self::Stroke { number, brush, under_tip, added } => {
                let did = match (added, under_tip) {
                    (true, true) => "added it",
                    (true, false) => "added what it holds, or is part of",
                    (false, true) => "took it away",
                    (false, false) => "took away what carried it",
                };
                write!(f, "stroke {} ({}) {did}", number + 1, brush.name())
            }
            Self::Settled => f.write_str("settled: it hung in the air in the slices of the mesh"),
        }
    }
}

/// A place in hundredths of a millimetre.
struct Told(Vec3);

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Adding 0 turns -0 into 0.
        let [x, y, z] = self.0.to_array().map(|n| (100.0 * n).round() / 100.0 + 0.0);
        write!(f, "{x},{y},{z}")
    }
}
