//! Drawn solids compiled for evaluation, and the boxes that they reach.

use super::Leaf;
use super::extrusion::Extrusion;
use super::frame::Frame;
use super::inflated::{self, Inflated};
use super::pipe::Pipe;
use super::revolved::{self, Revolved};
use super::section::{self, Section};
use super::solid::Fallen;
use crate::field::Aabb;
use crate::sketched::{Inflation, LinearSweep, PathSweep, Rectangle, Revolution, SketchPlane};
use glam::{DAffine3, DMat3, DVec3, Vec2};

/// The frame of a drawing's plane: x and y as drawn, z towards whoever draws.
fn in_plane(plane: &SketchPlane, before: f32, child_from_world: &DAffine3) -> Frame {
    let turn = plane.turn();
    let origin = plane.origin.as_dvec3() + turn.transpose() * DVec3::new(0.0, 0.0, f64::from(before));
    Frame::new(DAffine3::from_mat3(turn) * DAffine3::from_translation(-origin) * *child_from_world)
}

pub(super) fn inflation(p: &Inflation, child_from_world: &DAffine3) -> Leaf {
    Leaf::Inflated(Inflated::new(in_plane(&p.plane, 0.0, child_from_world), p))
}

pub(super) fn linear_sweep(p: &LinearSweep, child_from_world: &DAffine3) -> Leaf {
    let half = 0.5 * p.length;
    let falloff = section::falloff(p.falloff, p.template.depth.min(half), &p.template);
    let section = Section::new(&p.template.0, &falloff);
    let fillet = p.fillet.min(p.template.depth).min(half);
    let frame = in_plane(&p.plane, p.offset, child_from_world);
    Leaf::Extrusion(Fallen::new(frame, Extrusion { section, half, fillet }, falloff))
}

pub(super) fn revolution(p: &Revolution, child_from_world: &DAffine3) -> Leaf {
    let falloff = section::falloff(p.falloff, p.template.depth, &p.template);
    let profile = revolved::Profile::new(p);
    let (right, up, normal) = axes(p, &profile);
    let turn = DMat3::from_cols(right, normal, up).transpose();
    let origin = p.plane.point(p.axis.at).as_dvec3();
    let frame =
        Frame::new(DAffine3::from_mat3(turn) * DAffine3::from_translation(-origin) * *child_from_world);
    let solid = Revolved { section: Section::new(&p.template.0, &falloff), profile };
    Leaf::Revolved(Fallen::new(frame, solid, falloff))
}

/// Away from the axis in the plane, along the axis, and across the plane.
fn axes(p: &Revolution, profile: &revolved::Profile) -> (DVec3, DVec3, DVec3) {
    let [x, y, normal] = p.plane.precise_axes();
    let of = |v: Vec2| x * f64::from(v.x) + y * f64::from(v.y);
    (of(profile.right), of(profile.up), normal)
}

pub(super) fn path_sweep(p: &PathSweep, child_from_world: &DAffine3) -> Leaf {
    let falloff = section::falloff(p.falloff, p.template.depth, &p.template);
    let pipe = Pipe::new(p, Section::new(&p.template.0, &falloff));
    Leaf::Pipe(Fallen::new(Frame::new(*child_from_world), pipe, falloff))
}

/// The box around the part of a plane as far as `before` on both sides of a distance from it.
fn slab(plane: &SketchPlane, area: &Rectangle, offset: f32, half: f32) -> Aabb {
    let [right, up, normal] = plane.axes();
    let (center, size) = (0.5 * (area.min + area.max), 0.5 * (area.max - area.min));
    let middle = plane.origin + right * center.x + up * center.y + normal * offset;
    Aabb::around(middle, right.abs() * size.x + up.abs() * size.y + normal.abs() * half)
}

/// The box outside which the field is 0.
pub(super) fn inflation_reach(p: &Inflation) -> Aabb {
    let width = section::falloff(p.falloff, p.template.depth, &p.template).width();
    let thickest = inflated::half_thickness(p) * (1.0 + width / p.template.depth);
    inflated::reach(&p.template, width).map_or(Aabb::EMPTY, |area| slab(&p.plane, &area, 0.0, thickest))
}

pub(super) fn linear_sweep_reach(p: &LinearSweep) -> Aabb {
    let half = 0.5 * p.length;
    let width = section::falloff(p.falloff, p.template.depth.min(half), &p.template).width();
    let area = section::reach(&p.template, width);
    area.map_or(Aabb::EMPTY, |area| slab(&p.plane, &area, p.offset, half + width))
}

pub(super) fn revolution_reach(p: &Revolution) -> Aabb {
    let width = section::falloff(p.falloff, p.template.depth, &p.template).width();
    let Some(area) = section::reach(&p.template, width) else { return Aabb::EMPTY };
    let profile = revolved::Profile::new(p);
    let (center, size) = (0.5 * (area.min + area.max) - profile.at, 0.5 * (area.max - area.min));
    let spread = |axis: Vec2| (axis.dot(center), axis.abs().dot(size));
    let ((out, wide), (height, tall)) = (spread(profile.right), spread(profile.up));
    let radius = profile.signs().iter().fold(0.0f32, |r, sign| r.max(sign * out + wide));
    let up = axes(p, &profile).1.as_vec3();
    let foot = p.plane.point(p.axis.at);
    let end = |z: f32| (foot + up * z, radius);
    if radius > 0.0 { super::reach::around_axis(end(height - tall), end(height + tall)) } else { Aabb::EMPTY }
}

pub(super) fn path_sweep_reach(p: &PathSweep) -> Aabb {
    let falloff = section::falloff(p.falloff, p.template.depth, &p.template);
    Pipe::new(p, Section::new(&p.template.0, &falloff)).reach()
}
