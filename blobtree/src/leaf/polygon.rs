//! Planar polygons as skeletons.

use crate::scalar::Scalar;
use glam::{Vec2, Vec3};

/// Unit normal and a point of the plane of a polygon; `None` if its corners lie on a line, or off the plane
/// by more than 1 % of their extent.
pub(crate) fn plane(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let center = points.iter().sum::<Vec3>() / points.len() as f32;
    let (mut normal, mut extent) = (Vec3::ZERO, 0.0f32);
    for (i, p) in points.iter().enumerate() {
        // Newell's method, about the centre.
        normal += (*p - center).cross(points[(i + 1) % points.len()] - center);
        extent = extent.max(p.distance(center));
    }
    let flat = normal.length() > 1e-6 * extent * extent;
    let normal = normal.try_normalize().filter(|_| flat)?;
    points.iter().all(|p| (*p - center).dot(normal).abs() <= 0.01 * extent).then_some((normal, center))
}

/// A closed polygon in the plane z = 0, filled even-odd.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    corners: Vec<Vec2>,
    convex: bool,
}

impl Outline {
    pub fn new(corners: Vec<Vec2>) -> Self {
        let n = corners.len();
        let turn = |i: usize| {
            let (a, b, c) = (corners[i], corners[(i + 1) % n], corners[(i + 2) % n]);
            (b - a).perp_dot(c - b)
        };
        let convex = (0..n).all(|i| turn(i) >= 0.0) || (0..n).all(|i| turn(i) <= 0.0);
        Self { corners, convex }
    }

    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// From the nearest point of the filled polygon to `q`, and the number of the edge on which it lies, from
    /// 1; 0 inside.
    pub fn offset_in_plane<S: Scalar>(&self, q: [S; 2]) -> ([S; 2], u32) {
        let (mut nearest, mut nearest2, mut inside) = (([S::of(0.0); 2], 0), f32::INFINITY, false);
        let mut from = self.corners[self.corners.len() - 1];
        for (edge, &to) in (1..).zip(&self.corners) {
            let along = to - from;
            let p = [q[0] - S::of(from.x), q[1] - S::of(from.y)];
            let length2 = along.length_squared().max(1e-24);
            let t = (p[0] * S::of(along.x) + p[1] * S::of(along.y)) * S::of(1.0 / length2);
            let t = t.larger(S::of(0.0)).smaller(S::of(1.0));
            let o = [p[0] - t * S::of(along.x), p[1] - t * S::of(along.y)];
            let d2 = o[0].value() * o[0].value() + o[1].value() * o[1].value();
            if d2 < nearest2 {
                (nearest, nearest2) = ((o, edge), d2);
            }
            let (x, y) = (q[0].value(), q[1].value());
            if (from.y > y) != (to.y > y) && x < from.x + (y - from.y) / (to.y - from.y) * along.x {
                inside = !inside;
            }
            from = to;
        }
        if inside { ([S::of(0.0); 2], 0) } else { nearest }
    }
}
