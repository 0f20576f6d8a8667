//! The boxes that primitives reach.

use super::{polygon, sketched};
use crate::falloff::Falloff;
use crate::field::Aabb;
use crate::primitive::{PolylinePoint, Primitive};
use glam::Vec3;

/// The box outside which a primitive's field is 0, in its own space.
pub(crate) fn support(primitive: &Primitive) -> Aabb {
    let reached = reached(primitive);
    reached.grown(1e-5 * reached.size().max_element())
}

/// The box around a cone or cylinder whose base, top and side have all moved out by `width`: its rims stay
/// sharp, and so reach farther.
fn widened(from: Vec3, to: Vec3, [radius_from, radius_to]: [f32; 2], width: f32) -> Aabb {
    let length = from.distance(to);
    let (axis, growth) = ((to - from) / length, (radius_to - radius_from) / length);
    let out = width * (1.0 + growth * growth).sqrt();
    let radius = |z: f32| (radius_from + growth * z + out).max(0.0);
    around_axis((from - axis * width, radius(-width)), (to + axis * width, radius(length + width)))
}

/// The box around two discs about the line through their centres, each given by centre and radius.
pub(super) fn around_axis((from, r0): (Vec3, f32), (to, r1): (Vec3, f32)) -> Aabb {
    let axis = (to - from).normalize_or(Vec3::Z);
    let reach = (Vec3::ONE - axis * axis).max(Vec3::ZERO).map(f32::sqrt);
    Aabb::around(from, reach * r0).union(&Aabb::around(to, reach * r1))
}

/// The box around a disc.
fn around_disc(center: Vec3, normal: Vec3, radius: f32) -> Aabb {
    let normal = normal.normalize_or(Vec3::Z);
    Aabb::around(center, (Vec3::ONE - normal * normal).max(Vec3::ZERO).map(f32::sqrt) * radius)
}

/// The box around a primitive's surface in its own space, grown by the falloff.
fn reached(primitive: &Primitive) -> Aabb {
    let falloff = |width: Option<f32>, depth: f32| Falloff::new(width, depth).width();
    let grown = |surface: Aabb, depth: f32, width: Option<f32>| surface.grown(falloff(width, depth));
    match primitive {
        Primitive::Point(p) => grown(Aabb::around(p.center, Vec3::splat(p.radius)), p.radius, p.falloff),
        Primitive::Segment(p) => grown(Aabb::from_corners(p.from, p.to).grown(p.radius), p.radius, p.falloff),
        Primitive::Polyline(p) => {
            let ball = |q: &PolylinePoint| Aabb::around(q.at, Vec3::splat(q.radius));
            let surface = p.points.iter().fold(Aabb::EMPTY, |b, q| b.union(&ball(q)));
            grown(surface, p.points.iter().fold(0.0f32, |r, q| r.max(q.radius)), p.falloff)
        }
        Primitive::Disc(p) => {
            let half = 0.5 * p.thickness;
            grown(around_disc(p.center, p.normal, p.radius - half).grown(half), half, p.falloff)
        }
        Primitive::Polygon(p) => {
            let (normal, origin) = polygon::plane(&p.points).unwrap_or((Vec3::Z, p.points[0]));
            let flattened = p.points.iter().map(|q| *q - normal * (*q - origin).dot(normal));
            let half = 0.5 * p.thickness;
            grown(Aabb::of_points(flattened).grown(half), half, p.falloff)
        }
        Primitive::Box(p) => {
            grown(Aabb::around(p.center, 0.5 * p.size), 0.5 * p.size.min_element(), p.falloff)
        }
        Primitive::Cylinder(p) => {
            let depth = p.radius.min(0.5 * p.from.distance(p.to));
            widened(p.from, p.to, [p.radius, p.radius], falloff(p.falloff, depth))
        }
        Primitive::Cone(p) => {
            let depth = 0.5 * p.radius_from.max(p.radius_to).min(p.from.distance(p.to));
            widened(p.from, p.to, [p.radius_from, p.radius_to], falloff(p.falloff, depth))
        }
        Primitive::Torus(p) => {
            let ring = around_disc(p.center, p.normal, p.major_radius);
            grown(ring.grown(p.minor_radius), p.minor_radius, p.falloff)
        }
        Primitive::Ellipsoid(p) => grown(Aabb::around(p.center, p.radii), p.radii.min_element(), p.falloff),
        Primitive::HalfSpace(p) => {
            // Its ball, without what lies above the plane for axis-aligned planes.
            let n = p.normal.normalize_or(Vec3::Z);
            let ball = Aabb::around(p.point, Vec3::splat(p.extent));
            let low = n.map(|c| if c > 0.999_999 { 0.0 } else { p.extent });
            let high = n.map(|c| if c < -0.999_999 { 0.0 } else { p.extent });
            let half = Aabb { min: p.point - high, max: p.point + low };
            grown(ball.intersection(&half), p.extent, Some(p.falloff))
        }
        Primitive::Mesh(p) => {
            let bounds = p.distance.bounds();
            grown(Aabb { min: bounds.min, max: bounds.max }, p.falloff, Some(p.falloff))
        }
        Primitive::Inflation(p) => sketched::inflation_reach(p),
        Primitive::LinearSweep(p) => sketched::linear_sweep_reach(p),
        Primitive::Revolution(p) => sketched::revolution_reach(p),
        Primitive::PathSweep(p) => sketched::path_sweep_reach(p),
    }
}
