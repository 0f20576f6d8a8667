//! How nodes combine their children.

use crate::checks::{ParameterError, number};

/// A node's way to combine the fields of its children, any number of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// All of them: `max f`.
    Union,
    /// What all have in common: `min f`; empty without children.
    Intersection,
    /// The first without the others: `max(0, min(f, 1 − g))`.
    Difference,
    /// Ricci's blend `(Σ fˢ)^(1/s)`.
    Blend(Sharpness),
    /// The intersection with filleted edges, by De Morgan from Ricci's blend: `1 − (Σ (1 − f)ˢ)^(1/s)`.
    BlendIntersection(Sharpness),
    /// The difference with filleted edges: `1 − ((1 − f)ˢ + Σ gˢ)^(1/s)`.
    BlendDifference(Sharpness),
    /// The summation blend `Σ f`: the widest and roundest.
    Sum,
    /// A blend that acts only where surfaces meet at an angle: no bulge where they already overlap, no reach
    /// across a gap.
    GradientBlend,
}

/// The exponent s of Ricci's operators, 1 to 64: 1 is the sum, and the larger, the sharper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sharpness(f32);

impl Sharpness {
    /// The paper's usual choice.
    pub const DEFAULT: Self = Self(2.0);

    /// Errors: a sharpness outside 1 to 64.
    pub fn new(s: f32) -> Result<Self, ParameterError> {
        number("sharpness", s, 1.0, 64.0, "")?;
        Ok(Self(s))
    }

    /// The exponent.
    pub fn get(self) -> f32 {
        self.0
    }
}

impl Operator {
    /// The name in scene files and on screen.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
            Self::Blend(_) => "blend",
            Self::BlendIntersection(_) => "blend_intersection",
            Self::BlendDifference(_) => "blend_difference",
            Self::Sum => "sum",
            Self::GradientBlend => "gradient_blend",
        }
    }

    /// The exponent of the Ricci operators.
    pub fn sharpness(&self) -> Option<Sharpness> {
        match self {
            Self::Blend(s) | Self::BlendIntersection(s) | Self::BlendDifference(s) => Some(*s),
            _ => None,
        }
    }
}
