//! What a dragged part comes to rest on: the bed, the middle of the bed, the mirror plane, and whole steps.

use super::handles::Handle;
use super::on_screen;
use crate::modeler::Modeler;
use crate::placing::Motion;
use blobtree::Aabb;
use egui::{Align2, Color32, FontId, Painter, Pos2, Response, Stroke};
use glam::Vec3;
use sketch::suggest::View;

/// How near a part must come to a place to rest there, points.
const REACH: f32 = 8.0;

/// Moves along an arrow end on multiples of this, mm, if they come within a quarter of it.
const STEP: f32 = 1.0;

/// Turns end on multiples of this, degrees, if they come within a quarter of it.
const STEP_DEGREES: f32 = 15.0;

/// Along an axis that makes less than this share of a move, nothing is looked for: it points to the eye.
const MOVED_ALONG: f32 = 0.05;

/// How far guides go beyond the part, as a share of its size.
const BEYOND: f32 = 0.25;

/// Where a part rests, across an axis: its middle at x = 0, its middle at y = 0, or its lowest point at z = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guide(usize);

impl Guide {
    /// What the user reads.
    pub fn name(self) -> &'static str {
        ["on the mirror plane, x = 0", "in the middle, y = 0", "on the bed, z = 0"][self.0]
    }

    /// How far the part is from it along its axis, mm.
    fn distance(self, part: &Aabb) -> f32 {
        if self.0 == 2 { part.min.z } else { part.center()[self.0] }
    }

    /// A frame in its plane around the part.
    fn frame(self, part: &Aabb) -> [Vec3; 4] {
        let beyond = BEYOND * part.size().max_element();
        let (mut lo, mut hi) = (part.min - beyond, part.max + beyond);
        lo.z = lo.z.min(0.0).max(-beyond);
        (lo[self.0], hi[self.0]) = (0.0, 0.0);
        let (u, v) = ((self.0 + 1) % 3, (self.0 + 2) % 3);
        let corner = |at_u: f32, at_v: f32| {
            let mut corner = Vec3::ZERO;
            (corner[u], corner[v]) = (at_u, at_v);
            corner
        };
        [corner(lo[u], lo[v]), corner(hi[u], lo[v]), corner(hi[u], hi[v]), corner(lo[u], hi[v])]
    }
}

/// The motion of a handle, brought to rest where it comes near a place to rest, and those places. `part` is around what
/// moves before it moves; a point of the screen there is `mm_per_point` wide.
pub fn snapped(motion: Motion, handle: Handle, part: &Aabb, mm_per_point: f32) -> (Motion, Vec<Guide>) {
    let mut guides = Vec::new();
    let motion = match (motion, handle) {
        (Motion::Move(by), Handle::Arrow(axis)) => {
            let mut along = by;
            along[axis] = stepped(by[axis], STEP);
            Motion::Move(rested(by, &[axis], part, REACH * mm_per_point, &mut guides).unwrap_or(along))
        }
        (Motion::Move(by), _) => {
            Motion::Move(rested(by, &[0, 1, 2], part, REACH * mm_per_point, &mut guides).unwrap_or(by))
        }
        (Motion::Turn { about, axis, degrees }, _) => {
            Motion::Turn { about, axis, degrees: stepped(degrees, STEP_DEGREES) }
        }
        (motion @ Motion::Scale { .. }, _) => motion,
    };
    (motion, guides)
}

/// The move that ends at guides across these axes, where it comes near them; `None` if it does not.
fn rested(by: Vec3, axes: &[usize], part: &Aabb, reach: f32, guides: &mut Vec<Guide>) -> Option<Vec3> {
    let mut rested = by;
    for &axis in axes.iter().filter(|axis| by[**axis].abs() > MOVED_ALONG * by.length()) {
        let away = Guide(axis).distance(part);
        if (away + by[axis]).abs() < reach {
            rested[axis] = -away;
            guides.push(Guide(axis));
        }
    }
    (!guides.is_empty()).then_some(rested)
}

/// The nearest multiple of a step, if it is near.
fn stepped(value: f32, step: f32) -> f32 {
    let near = (value / step).round() * step;
    if (value - near).abs() < 0.25 * step { near } else { value }
}

/// Shows on what the dragged part rests.
pub fn paint(modeler: &Modeler, painter: &Painter, view: &View, response: &Response) {
    let Some(part) = modeler.selected_box() else { return };
    let color = if painter.ctx().global_style().visuals.dark_mode {
        Color32::from_rgb(255, 120, 220)
    } else {
        Color32::from_rgb(170, 20, 130)
    };
    for guide in &modeler.view.guides {
        let corners = guide.frame(&part);
        let seen: Option<Vec<Pos2>> = corners
            .into_iter()
            .chain([corners[0]])
            .map(|corner| view.screen_from_model(corner).map(|at| on_screen(at, response)))
            .collect();
        let Some(frame) = seen else { continue };
        // The name stands where it covers the part least: below the lowest corner.
        let lowest = frame.iter().copied().reduce(|low, at| if at.y > low.y { at } else { low });
        painter.add(egui::Shape::dashed_line(&frame, Stroke::new(1.5, color), 7.0, 4.0));
        if let Some(at) = lowest {
            let at = at + egui::vec2(0.0, 3.0);
            painter.text(at, Align2::CENTER_TOP, guide.name(), FontId::proportional(13.0), color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PART: Aabb = Aabb { min: Vec3::new(8.0, -3.0, 4.0), max: Vec3::new(12.0, 7.0, 10.0) };

    #[test]
    fn a_move_ends_on_the_bed_and_on_the_mirror_plane_where_it_comes_near_them() {
        let moved = |by: Vec3, handle| snapped(Motion::Move(by), handle, &PART, 0.1);
        let (motion, guides) = moved(Vec3::new(-9.6, 0.0, -3.5), Handle::Middle);
        assert_eq!(motion, Motion::Move(Vec3::new(-10.0, 0.0, -4.0)));
        assert_eq!(guides, [Guide(0), Guide(2)]);
        let (motion, guides) = moved(Vec3::new(0.0, 0.0, -3.4), Handle::Arrow(2));
        assert_eq!((motion, &guides[..]), (Motion::Move(Vec3::new(0.0, 0.0, -4.0)), &[Guide(2)][..]));
        // Along y nothing was moved, so it stays where it is, though the middle is near.
        let part = Aabb { min: Vec3::new(8.0, -5.2, 4.0), ..PART };
        let (motion, guides) = snapped(Motion::Move(Vec3::new(3.0, 0.0, 3.0)), Handle::Middle, &part, 0.1);
        assert_eq!((motion, guides.len()), (Motion::Move(Vec3::new(3.0, 0.0, 3.0)), 0));
    }

    #[test]
    fn what_comes_near_nothing_moves_by_whole_millimetres_along_an_arrow_only() {
        let by = Vec3::new(0.0, 0.0, 6.2);
        assert_eq!(
            snapped(Motion::Move(by), Handle::Arrow(2), &PART, 0.1).0,
            Motion::Move(Vec3::new(0.0, 0.0, 6.0))
        );
        assert_eq!(snapped(Motion::Move(by), Handle::Middle, &PART, 0.1).0, Motion::Move(by));
        let turn = |degrees| Motion::Turn { about: Vec3::ZERO, axis: Vec3::Z, degrees };
        assert_eq!(snapped(turn(47.0), Handle::Ring(2), &PART, 0.1).0, turn(45.0));
        assert_eq!(snapped(turn(51.0), Handle::Ring(2), &PART, 0.1).0, turn(51.0));
    }
}
