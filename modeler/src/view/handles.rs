//! Handles of what is selected: arrows to move it, rings to turn it, a square to size it. As large as a pen needs.

use crate::modeler::Modeler;
use crate::placing::Motion;
use crate::theme;
use egui::Color32;
use glam::{Vec2, Vec3};
use sketch::suggest::View;

/// How near a pen must come to a handle, points.
const REACH: f32 = 14.0;

/// The length of an arrow, points.
const ARROW: f32 = 84.0;

/// The radius of a ring, points.
const RING: f32 = 58.0;

/// A ring is seen from its edge if its axis has less than this in the direction of the eye.
const EDGE_ON: f32 = 0.12;

/// Points of a ring.
const RING_POINTS: u16 = 48;

/// A handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Handle {
    /// Moves along an axis, 0 to 2.
    Arrow(usize),
    /// Turns about an axis, 0 to 2.
    Ring(usize),
    /// Sizes.
    Square,
    /// Moves parallel to the screen.
    Middle,
}

/// Where the handles of the selected nodes are: one set for all of them.
#[derive(Clone, Copy, Debug)]
pub struct Handles {
    /// The middle of the nodes, mm.
    pub middle: Vec3,
    /// A point of the screen there, mm.
    mm_per_point: f32,
    /// From the eye to the middle, a unit vector.
    sight: Vec3,
    view: View,
}

impl Handles {
    /// Those of the selected nodes, as they are shown; none while a sketch is in the air.
    pub fn of(modeler: &Modeler) -> Option<Self> {
        if !modeler.pad.is_empty() {
            return None;
        }
        let middle = modeler.selected_box()?.center();
        let view = modeler.camera.view(modeler.view.screen);
        let sight = view.ray(view.screen_from_model(middle)?).direction.normalize_or_zero();
        Some(Self { middle, mm_per_point: view.mm_per_px(view.depth(middle)), sight, view })
    }

    /// The line of a handle on the screen, in points of the view; empty for a ring seen from its edge, with which
    /// nothing can be turned.
    pub fn line(&self, handle: Handle) -> Vec<Vec2> {
        if let Handle::Ring(axis) = handle
            && Vec3::AXES[axis].dot(self.sight).abs() < EDGE_ON
        {
            return Vec::new();
        }
        let places: Vec<Vec3> = match handle {
            Handle::Arrow(axis) => {
                vec![self.middle, self.middle + Vec3::AXES[axis] * ARROW * self.mm_per_point]
            }
            Handle::Ring(axis) => {
                let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
                let around =
                    |i: u16| Vec2::from_angle(std::f32::consts::TAU * f32::from(i) / f32::from(RING_POINTS));
                let place = |at: Vec2| self.middle + (u * at.x + v * at.y) * RING * self.mm_per_point;
                (0..=RING_POINTS).map(around).map(place).collect()
            }
            Handle::Square => {
                let aside = (self.view.right() + self.view.up) * 0.62 * ARROW * self.mm_per_point;
                vec![self.middle + aside]
            }
            Handle::Middle => vec![self.middle],
        };
        places.into_iter().filter_map(|place| self.view.screen_from_model(place)).collect()
    }

    /// How far a place of the view is from a handle, points.
    fn distance(&self, handle: Handle, at: Vec2) -> f32 {
        let line = self.line(handle);
        match (handle, &line[..]) {
            // Near the middle, arrows lie upon each other: only their outer halves are held.
            (Handle::Arrow(_), [from, to]) => distance_to_segment(at, from.lerp(*to, 0.45), *to),
            (_, [only]) => at.distance(*only),
            (_, many) => many
                .windows(2)
                .map(|pair| distance_to_segment(at, pair[0], pair[1]))
                .fold(f32::INFINITY, f32::min),
        }
    }
}

/// All, those first that are taken first.
pub const ALL: [Handle; 8] = [
    Handle::Middle,
    Handle::Square,
    Handle::Arrow(0),
    Handle::Arrow(1),
    Handle::Arrow(2),
    Handle::Ring(0),
    Handle::Ring(1),
    Handle::Ring(2),
];

/// The colours of all of them.
#[cfg(test)]
pub fn colors(dark: bool) -> [Color32; 8] {
    ALL.map(|handle| handle.color(dark))
}

impl Handle {
    /// The handle at a place of the view: the nearest within a pen's reach.
    pub fn at(modeler: &Modeler, at: Vec2) -> Option<Self> {
        let handles = Handles::of(modeler)?;
        let reached = ALL.into_iter().map(|handle| (handles.distance(handle, at), handle));
        let reached: Vec<_> = reached.filter(|(distance, _)| *distance < REACH).collect();
        // Arrows and rings may pass over the dot and the square, which are small.
        let small = reached.iter().find(|(_, handle)| matches!(handle, Self::Middle | Self::Square));
        let nearest = || reached.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        small.or_else(nearest).map(|(_, handle)| *handle)
    }

    /// Its colour: red, green and blue for x, y and z.
    pub fn color(self, dark: bool) -> Color32 {
        match self {
            Self::Arrow(0) | Self::Ring(0) => Color32::from_rgb(214, 69, 61),
            Self::Arrow(1) | Self::Ring(1) => Color32::from_rgb(62, 140, 45),
            Self::Arrow(_) | Self::Ring(_) => Color32::from_rgb(62, 118, 210),
            Self::Square | Self::Middle => theme::selected(dark),
        }
    }

    /// What a drag with it from one place of the view to another does. The handles are where the node was before.
    pub fn motion(self, modeler: &Modeler, from: Vec2, to: Vec2) -> Option<Motion> {
        let middle = modeler.held_box()?.center();
        let view = modeler.camera.view(modeler.view.screen);
        let mm = view.mm_per_px(view.depth(middle));
        Some(match self {
            Self::Middle => {
                let by = (to - from) * mm;
                Motion::Move(view.right() * by.x - view.up * by.y)
            }
            Self::Arrow(axis) => {
                let axis = Vec3::AXES[axis];
                let along = Vec2::new(axis.dot(view.right()), -axis.dot(view.up));
                // An axis towards the eye would run away.
                let shortening = along.length().max(0.15);
                let by = (to - from).dot(along / shortening) * mm / shortening;
                Motion::Move(axis * by)
            }
            Self::Ring(axis) => {
                let center = view.screen_from_model(middle)?;
                let (a, b) = (from - center, to - center);
                let towards_eye = Vec3::AXES[axis].dot(view.forward) < 0.0;
                let degrees = a.angle_to(b).to_degrees() * if towards_eye { -1.0 } else { 1.0 };
                Motion::Turn { about: middle, axis: Vec3::AXES[axis], degrees }
            }
            Self::Square => {
                let center = view.screen_from_model(middle)?;
                let factor = to.distance(center) / from.distance(center).max(1.0);
                Motion::Scale { about: middle, factor: factor.clamp(0.05, 20.0) }
            }
        })
    }
}

fn distance_to_segment(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + along * t)
}
