//! The field of a drawing: what a sketched primitive sweeps.

use super::FieldImage;
use glam::Vec2;
use std::ops::Deref;
use std::sync::Arc;

/// What the sketch room makes of a drawing for the tree to sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// The smoothed signed distance to the drawn curve, mm, below 0 inside. Right as far as `falloff` outside;
    /// from there on, and at the image's border, at least `falloff`.
    pub distance: FieldImage,
    /// How high an inflation stands over a place, squared, mm²: 0 on the curve, the square of `depth` where it is
    /// highest, and outside, to where the distance is `falloff`, the square of `depth` less that of `depth` plus
    /// the distance, or nearly so close to the curve; beyond and at the image's border, no more.
    pub bulge: FieldImage,
    /// How hard the pen pressed near a place, 0 to 1; none where it always pressed alike.
    pub pressure: Option<FieldImage>,
    /// How far the influence reaches beyond the curve, mm.
    pub falloff: f32,
    /// The largest distance from the curve to a point inside, mm.
    pub depth: f32,
    /// The curve itself: closed, outlines counter-clockwise, holes clockwise, mm.
    pub contours: Vec<Vec<Vec2>>,
    /// Where the curve has sharp corners, mm.
    pub corners: Vec<Vec2>,
}

/// The template of an empty drawing: 0 everywhere.
impl Default for Template {
    fn default() -> Self {
        let far = vec![1.0; 9];
        let distance = FieldImage::new(Vec2::ZERO, 1.0, [3, 3], far).expect("nine finite samples");
        let bulge = distance.bulge(1.0);
        let (contours, corners) = (Vec::new(), Vec::new());
        Self { distance, bulge, pressure: None, falloff: 1.0, depth: 1.0, contours, corners }
    }
}

/// A template in the node whose drawing it was solved from. All are equal: what they hold follows from the
/// drawing and the falloff, by which nodes are compared.
#[derive(Clone, Debug, Default)]
pub struct Solved(pub Arc<Template>);

impl PartialEq for Solved {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Deref for Solved {
    type Target = Template;

    fn deref(&self) -> &Template {
        &self.0
    }
}
