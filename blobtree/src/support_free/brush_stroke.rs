//! Brush strokes, as scenes keep them: what the pen did, to be replayed whenever something below changes.

use super::GROWN_FALLOFF;
use crate::checks::{ParameterError, number, one_of_length, place};
use crate::eval;
use crate::field::Aabb;
use crate::node::{NodeRef, Shape};
use crate::primitive::Primitive;
use crate::scene::Whole;
use glam::Vec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

/// Most dabs of all strokes of a support-free node together. With six milliseconds for each, as in a sheep of 315, so
/// many take ten minutes; a million would take two hours.
pub const MAX_NODE_DABS: usize = 100_000;

/// The material of what grows, unless a stroke says otherwise.
pub const GROWN_MATERIAL: u8 = 1;

/// Most places of a stroke.
const MOST_PLACES: usize = MAX_NODE_DABS;

/// What a brush does with the solid under its tip.
///
/// **Source:** Reiner & Lefebvre 2016, §2.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BrushKind {
    /// Adds what of the tip is carried from below; changes nothing else.
    AddTrim,
    /// Takes the tip away, and then all that nothing carries any more.
    RemoveTrim,
    /// Takes the tip away, but for what carries the solid above.
    RemovePreserve,
    /// Adds the whole tip, and grows what it needs to stand on.
    AddGrow,
    /// Smooths what is in the tip, and then takes away what nothing carries any more.
    SmoothTrim,
}

impl BrushKind {
    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::AddTrim => "add_trim",
            Self::RemoveTrim => "remove_trim",
            Self::RemovePreserve => "remove_preserve",
            Self::AddGrow => "add_grow",
            Self::SmoothTrim => "smooth_trim",
        }
    }

    /// Whether it can make solid what was not.
    pub fn adds(self) -> bool {
        matches!(self, Self::AddTrim | Self::AddGrow | Self::SmoothTrim)
    }
}

/// The shape of a brush, of radius 1 around the origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum BrushTip {
    /// A ball.
    #[default]
    Ball,
    /// A cube with sides along the axes; half its width is the radius.
    Cube,
    /// An upright cylinder, as high as it is wide.
    Cylinder,
    /// Any solid but an imported mesh: a millimetre in it is a radius.
    Shape(NodeRef),
}

impl BrushTip {
    /// The named tips, as in scene files.
    pub(crate) const NAMES: [&'static str; 3] = ["ball", "cube", "cylinder"];

    /// The tip of this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "ball" => Some(Self::Ball),
            "cube" => Some(Self::Cube),
            "cylinder" => Some(Self::Cylinder),
            _ => None,
        }
    }

    fn is_ball(&self) -> bool {
        *self == Self::Ball
    }

    /// The box outside which a tip of radius 1 is not felt.
    fn support(&self) -> Aabb {
        match self {
            Self::Shape(node) => eval::support(node),
            _ => Aabb::around(Vec3::ZERO, Vec3::ONE),
        }
    }
}

impl Serialize for BrushTip {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Ball => serializer.serialize_str("ball"),
            Self::Cube => serializer.serialize_str("cube"),
            Self::Cylinder => serializer.serialize_str("cylinder"),
            Self::Shape(node) => Whole(node).serialize(serializer),
        }
    }
}

/// One stroke of a brush, in the space of the support-free node's child.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BrushStroke {
    /// What the brush does.
    pub brush: BrushKind,
    /// The tip: "ball", "cube", "cylinder", or a node, in which a millimetre is a radius.
    #[serde(skip_deserializing, skip_serializing_if = "BrushTip::is_ball")]
    #[schemars(skip)]
    pub tip: BrushTip,
    /// The tip's radius at full pressure, mm.
    #[schemars(range(min = 0.05, max = 100.0))]
    pub radius: f32,
    /// The radius at no pressure, mm; the same if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.05, max = 100.0))]
    pub light_radius: Option<f32>,
    /// How far the surface moves at most with a dab, in radii, at full pressure. At 1 the whole tip counts. When
    /// smoothing, a third for each pass.
    #[serde(default = "whole", skip_serializing_if = "is_whole")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub strength: f32,
    /// The strength at no pressure; the same if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub light_strength: Option<f32>,
    /// Distance from dab to dab along the places, in radii; if left out, there is a dab at each place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.05, max = 100.0))]
    pub spacing: Option<f32>,
    /// What is added is made of this; 0 is the material of the shape.
    #[serde(default, skip_serializing_if = "is_default_material")]
    pub material: u8,
    /// What grows below what is added is made of this.
    #[serde(default = "usual_grown", skip_serializing_if = "is_usual_grown")]
    pub grown_material: u8,
    /// Where the pen was, mm.
    #[schemars(with = "Vec<[f32; 3]>")]
    pub places: Vec<Vec3>,
    /// How hard it was pressed at each place, 0 to 1; 1 everywhere if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressures: Option<Vec<f32>>,
}

impl BrushStroke {
    /// A stroke of a ball of `radius`, mm, with a dab at each of the places.
    pub fn new(brush: BrushKind, radius: f32, places: impl IntoIterator<Item = [f32; 3]>) -> Self {
        Self {
            brush,
            tip: BrushTip::Ball,
            radius,
            light_radius: None,
            strength: whole(),
            light_strength: None,
            spacing: None,
            material: 0,
            grown_material: usual_grown(),
            places: places.into_iter().map(Vec3::from_array).collect(),
            pressures: None,
        }
    }

    /// The pressure at the place of this number.
    pub fn pressure(&self, number: usize) -> f32 {
        self.pressures.as_ref().and_then(|all| all.get(number)).copied().unwrap_or(1.0)
    }

    /// No fewer dabs than it has.
    pub fn dabs_at_most(&self) -> usize {
        let Some(spacing) = self.spacing else { return self.places.len() };
        let least = self.light_radius.map_or(self.radius, |light| light.min(self.radius));
        let pairs = self.places.windows(2);
        let length: f64 = pairs.map(|pair| f64::from(pair[0].distance(pair[1]))).sum();
        (length / f64::from(least * spacing)).ceil() as usize + 1
    }

    /// A box around all that its tips reach, mm.
    pub fn reach(&self) -> Aabb {
        let radius = self.light_radius.map_or(self.radius, |light| light.max(self.radius));
        let tip = self.tip.support();
        if tip.is_empty() {
            return Aabb::EMPTY;
        }
        let around = |place: &Vec3| [*place + tip.min * radius, *place + tip.max * radius];
        Aabb::of_points(self.places.iter().flat_map(around))
    }

    /// Errors: the first parameter that is not in its legal range.
    pub(crate) fn check(&self, label: &str) -> Result<(), ParameterError> {
        let of = |field: &str| format!("{label}.{field}");
        number(&of("radius"), self.radius, 0.05, 100.0, "mm")?;
        number(&of("light_radius"), self.light_radius.unwrap_or(self.radius), 0.05, 100.0, "mm")?;
        number(&of("strength"), self.strength, 0.0, 1.0, "")?;
        number(&of("light_strength"), self.light_strength.unwrap_or(self.strength), 0.0, 1.0, "")?;
        number(&of("spacing"), self.spacing.unwrap_or(1.0), 0.05, 100.0, "radii")?;
        one_of_length(&of("places"), self.places.len(), 1, MOST_PLACES)?;
        for (n, at) in self.places.iter().enumerate() {
            place(&format!("{label}.places[{n}]"), *at)?;
        }
        if let Some(pressures) = &self.pressures {
            let places = self.places.len();
            one_of_length(&of("pressures"), pressures.len(), places, places)?;
            for (n, pressure) in pressures.iter().enumerate() {
                number(&format!("{label}.pressures[{n}]"), *pressure, 0.0, 1.0, "")?;
            }
        }
        match &self.tip {
            BrushTip::Shape(node) if holds_mesh(node) => {
                let expected = "a tip without imported meshes; they belong into the tree";
                Err(ParameterError::new(&of("tip"), "a node with a mesh", expected))
            }
            _ => Ok(()),
        }
    }
}

/// Errors: too many dabs in all, or a stroke that is not legal by itself.
pub(super) fn check_all<'a>(
    strokes: impl ExactSizeIterator<Item = &'a BrushStroke>,
) -> Result<(), ParameterError> {
    let mut dabs = 0;
    for (n, stroke) in strokes.enumerate() {
        stroke.check(&format!("strokes[{n}]"))?;
        dabs += stroke.dabs_at_most();
        if dabs > MAX_NODE_DABS {
            let expected = format!("at most {MAX_NODE_DABS}; take a larger brush or spacing");
            return Err(ParameterError::new("strokes", format!("{dabs} dabs or more"), &expected));
        }
    }
    Ok(())
}

/// How much thicker than the tip what grows may become, mm.
const THICKER: f32 = 1.5;

/// The box in which the solid of a `child` that is brushed over may lie, with its falloff, above a bed at this height.
pub(super) fn support<'a>(child: &Aabb, strokes: impl Iterator<Item = &'a BrushStroke>, bed: f32) -> Aabb {
    let mut all = *child;
    for stroke in strokes.filter(|stroke| stroke.brush.adds()) {
        all = all.union(&stroke.reach().grown(GROWN_FALLOFF));
        if stroke.brush == BrushKind::AddGrow && !all.is_empty() {
            // Paths run down, towards what is there already.
            all = all.grown(stroke.radius + THICKER + GROWN_FALLOFF);
            all.min.z = all.min.z.min(bed - GROWN_FALLOFF);
        }
    }
    all
}

fn holds_mesh(node: &NodeRef) -> bool {
    matches!(node.shape, Shape::Primitive(Primitive::Mesh(_))) || node.children().iter().any(holds_mesh)
}

fn whole() -> f32 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_whole(strength: &f32) -> bool {
    *strength == whole()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_default_material(material: &u8) -> bool {
    *material == 0
}

fn usual_grown() -> u8 {
    GROWN_MATERIAL
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_usual_grown(material: &u8) -> bool {
    *material == usual_grown()
}
