//! What the model view asks of whoever draws triangles.

use crate::solid::Solid;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use sketch::suggest::View;
use std::sync::Arc;

/// How the solid is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Look {
    /// As if it were there.
    #[default]
    Shaded,
    /// As if of coloured glass.
    Glass,
    /// As if drawn with a pen: dots, denser where it is dark.
    Stipple,
    /// Only its edges and outlines.
    XRay,
}

impl Look {
    /// All, in the order of the menu.
    pub const ALL: [Self; 4] = [Self::Shaded, Self::Glass, Self::Stipple, Self::XRay];

    /// The name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaded => "Solid",
            Self::Glass => "Glass",
            Self::Stipple => "Pen and ink",
            Self::XRay => "X-ray",
        }
    }
}

/// A line in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its ends, mm.
    pub ends: [Vec3; 2],
    /// sRGB and how much it covers.
    pub color: [u8; 4],
    /// Points.
    pub width: f32,
}

/// A picture of the model.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// From where; its screen is in points.
    pub view: View,
    /// Its size, pixels.
    pub pixels: [u32; 2],
    /// The background, sRGB.
    pub background: [u8; 3],
    /// What is shown.
    pub solid: Option<&'a Arc<Solid>>,
    /// How.
    pub look: Look,
    /// Tints what leans out by more than this from the vertical, degrees; none tints nothing.
    pub overhang: Option<f32>,
    /// Lines on the ground and elsewhere; hidden by what is before them.
    pub lines: &'a [Line],
}

/// Whoever draws the model: a graphics card, or nobody.
pub trait Stage {
    /// Draws the picture, or finds that it is the last one again; `None` if nothing can be drawn.
    fn show(&mut self, picture: &Picture) -> Option<egui::TextureId>;
}

/// Draws nothing: for tests of everything else, and where there is no graphics card.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStage;

impl Stage for NoStage {
    fn show(&mut self, _: &Picture) -> Option<egui::TextureId> {
        None
    }
}
