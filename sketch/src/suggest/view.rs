//! Between the screen and the model.

use crate::stroke::Placement;
use blobtree::SketchPlane;
use glam::{Vec2, Vec3};

/// From where the model is seen, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the camera is, mm. Depths are measured from here along [`Self::forward`].
    pub eye: Vec3,
    /// Where it looks, a unit vector.
    pub forward: Vec3,
    /// What is up on the screen, a unit vector at a right angle to it.
    pub up: Vec3,
    /// The size of the screen, pixels.
    pub screen: Vec2,
    /// How depth shows.
    pub projection: Projection,
}

/// How depth shows on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Not at all: sizes are the same everywhere.
    Orthographic {
        /// The size of a pixel, mm.
        mm_per_px: f32,
    },
    /// As in a photograph.
    Perspective {
        /// The angle between the top and the bottom of the screen, degrees, below 180.
        height_degrees: f32,
    },
}

/// A half-line in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, mm.
    pub origin: Vec3,
    /// Where it goes, a unit vector.
    pub direction: Vec3,
}

/// The least distance before the eye of something that a perspective can show, mm.
const NEAREST: f32 = 1e-3;

impl View {
    /// The view from `eye` to `target`, with z up where that is possible, else y.
    pub fn look_at(eye: Vec3, target: Vec3, screen: Vec2, projection: Projection) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::Y);
        let upright = |up: Vec3| (up - forward * up.dot(forward)).try_normalize();
        let steep = forward.cross(Vec3::Z).length() < 1e-3;
        let up = upright(if steep { Vec3::Y } else { Vec3::Z }).unwrap_or(forward.any_orthonormal_vector());
        Self { eye, forward, up, screen, projection }
    }

    /// What is to the right on the screen, a unit vector.
    pub fn right(&self) -> Vec3 {
        self.forward.cross(self.up)
    }

    /// How far before the eye a place lies, mm.
    pub fn depth(&self, place: Vec3) -> f32 {
        (place - self.eye).dot(self.forward)
    }

    /// The size of a pixel on the plane at this depth, mm.
    pub fn mm_per_px(&self, depth: f32) -> f32 {
        match self.projection {
            Projection::Orthographic { mm_per_px } => mm_per_px,
            Projection::Perspective { height_degrees } => {
                2.0 * depth.max(NEAREST) * (0.5 * height_degrees).to_radians().tan() / self.screen.y
            }
        }
    }

    /// The half-line of all that a pixel may show. In an orthographic view it starts in the plane of the eye.
    pub fn ray(&self, px: Vec2) -> Ray {
        let from_middle = px - 0.5 * self.screen;
        let aside = self.right() * from_middle.x - self.up * from_middle.y;
        match self.projection {
            Projection::Orthographic { mm_per_px } => {
                Ray { origin: self.eye + aside * mm_per_px, direction: self.forward }
            }
            Projection::Perspective { .. } => {
                let direction = self.forward + aside * self.mm_per_px(1.0);
                Ray { origin: self.eye, direction: direction.normalize_or(self.forward) }
            }
        }
    }

    /// Where a place shows on the screen, pixels; `None` behind the eye of a perspective view.
    pub fn screen_from_model(&self, place: Vec3) -> Option<Vec2> {
        let depth = self.depth(place);
        if depth < NEAREST && matches!(self.projection, Projection::Perspective { .. }) {
            return None;
        }
        let from_eye = place - self.eye;
        let aside = Vec2::new(from_eye.dot(self.right()), -from_eye.dot(self.up));
        Some(0.5 * self.screen + aside / self.mm_per_px(depth))
    }

    /// The place that a pixel shows at this depth.
    pub fn at_depth(&self, px: Vec2, depth: f32) -> Vec3 {
        let plane = self.plane(depth);
        plane.point(self.placement(depth).mm_from_px(px))
    }

    /// The plane at this depth, parallel to the screen, with its origin in the middle.
    pub fn plane(&self, depth: f32) -> SketchPlane {
        SketchPlane { origin: self.eye + self.forward * depth, right: self.right(), up: self.up }
    }

    /// How pixels lie on [`Self::plane`].
    pub fn placement(&self, depth: f32) -> Placement {
        Placement { origin_px: 0.5 * self.screen, mm_per_px: self.mm_per_px(depth) }
    }
}
