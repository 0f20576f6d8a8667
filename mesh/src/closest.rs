//! The closest point of one triangle, and which part of the triangle it lies on.

use glam::{DVec3, Vec3};

/// The part of a triangle that a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Its inside.
    Face,
    /// The side from this corner (0, 1 or 2) to the next.
    Edge(u8),
    /// This corner (0, 1 or 2).
    Corner(u8),
}

/// The point of a triangle closest to `p`, in `f64` because thin triangles are ill-conditioned.
///
/// Never outside the triangle's box, so that box distances are true lower bounds. Triangles without area are treated
/// as their three sides. **Source:** Ericson, *Real-Time Collision Detection*, §5.1.5; **departs** by the two above.
pub(crate) fn closest_on_triangle(p: DVec3, corners: [Vec3; 3]) -> (DVec3, Feature) {
    let low = corners[0].min(corners[1]).min(corners[2]).as_dvec3();
    let high = corners[0].max(corners[1]).max(corners[2]).as_dvec3();
    let corners = corners.map(Vec3::as_dvec3);
    let (point, feature) = by_region(p, corners).unwrap_or_else(|| closest_on_sides(p, corners));
    (point.max(low).min(high), feature)
}

/// None if the triangle has no area to speak of.
fn by_region(p: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(DVec3, Feature)> {
    let (ab, ac) = (b - a, c - a);
    let ap = p - a;
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Some((a, Feature::Corner(0)));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return Some((b, Feature::Corner(1)));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return Some((c, Feature::Corner(2)));
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let doubled_area_squared = va + vb + vc;
    if doubled_area_squared <= 1e-24 * ab.length_squared() * ac.length_squared() {
        return None;
    }
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return Some((a + ab * (d1 / (d1 - d3)), Feature::Edge(0)));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return Some((a + ac * (d2 / (d2 - d6)), Feature::Edge(2)));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return Some((b + (c - b) * along, Feature::Edge(1)));
    }
    Some((a + ab * (vb / doubled_area_squared) + ac * (vc / doubled_area_squared), Feature::Face))
}

fn closest_on_sides(p: DVec3, corners: [DVec3; 3]) -> (DVec3, Feature) {
    let mut best = (corners[0], Feature::Corner(0));
    for side in 0..3u8 {
        let next = (side + 1) % 3;
        let (a, b) = (corners[usize::from(side)], corners[usize::from(next)]);
        let length_squared = a.distance_squared(b);
        let along = (p - a).dot(b - a);
        let candidate = if along <= 0.0 || length_squared == 0.0 {
            (a, Feature::Corner(side))
        } else if along >= length_squared {
            (b, Feature::Corner(next))
        } else {
            (a + (b - a) * (along / length_squared), Feature::Edge(side))
        };
        if candidate.0.distance_squared(p) < best.0.distance_squared(p) {
            best = candidate;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_region_of_a_triangle_answers_for_itself() {
        let triangle = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        for (p, expected, feature) in [
            ((1.0, 1.0, 3.0), (1.0, 1.0, 0.0), Feature::Face),
            ((2.0, -1.0, 1.0), (2.0, 0.0, 0.0), Feature::Edge(0)),
            ((3.0, 3.0, 1.0), (2.0, 2.0, 0.0), Feature::Edge(1)),
            ((-1.0, 2.0, 1.0), (0.0, 2.0, 0.0), Feature::Edge(2)),
            ((-1.0, -1.0, 1.0), (0.0, 0.0, 0.0), Feature::Corner(0)),
            ((6.0, -1.0, 1.0), (4.0, 0.0, 0.0), Feature::Corner(1)),
            ((-1.0, 6.0, 1.0), (0.0, 4.0, 0.0), Feature::Corner(2)),
        ] {
            let (point, found) = closest_on_triangle(DVec3::from(p), triangle);
            assert_eq!((point, found), (DVec3::from(expected), feature), "{p:?}");
        }
    }

    #[test]
    fn triangles_without_area_are_their_sides() {
        let p = DVec3::new(8.0, 1.0, 0.0);
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        for corners in [[0.0, 10.0, 4.0], [0.0, 0.0, 10.0], [0.0, 10.0, 10.0], [10.0, 0.0, 10.0]] {
            let (point, _) = closest_on_triangle(p, corners.map(at));
            assert_eq!(point, DVec3::new(8.0, 0.0, 0.0), "{corners:?}");
        }
        assert_eq!(closest_on_triangle(p, [at(3.0); 3]).0, DVec3::new(3.0, 0.0, 0.0));
    }
}
