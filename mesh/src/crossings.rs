//! Pairs of triangles that cross: where a mesh intersects itself.

use glam::{BVec3, DVec3, Vec3};
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

use crate::Mesh;
use crate::bvh::Bvh;
use crate::edges::is_collapsed;
use crate::measure::Bounds;

/// Triangles looked at together; the search can stop between two such groups.
const GROUP: usize = 4096;
/// Pairs of touching boxes after which the search gives up: seconds of one core, a minute if all lie in one plane.
const MOST_CANDIDATES: usize = 50_000_000;
/// Crossing pairs that are kept with their place; the rest are counted.
const MOST_LISTED: usize = 1000;

/// The pairs of triangles that cross each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    /// How many pairs cross.
    pub count: usize,
    /// The first thousand pairs `[a, b]`, `a < b`, in ascending order, each with a point (mm) near the crossing.
    pub pairs: Vec<([u32; 2], Vec3)>,
    /// Whether every pair was looked at. False when more than 50 million pairs of boxes overlap; then `count` is the
    /// count so far.
    pub complete: bool,
}

impl Mesh {
    /// Finds the pairs of triangles whose insides cross along a line, decided exactly (on the `f32` coordinates).
    ///
    /// Not counted: triangles that merely touch or overlap in one plane, those that share an edge (they can only lie
    /// flat on each other), and triangles with a repeated or missing vertex or a coordinate that is not finite.
    /// O(n log n + pairs of touching boxes), in parallel; the answer does not depend on the number of threads.
    ///
    /// **Source:** Guigue & Devillers 2003, *Fast and Robust Triangle-Triangle Overlap Test Using Orientation
    /// Predicates*; Shewchuk's adaptive predicates.
    pub fn crossings(&self) -> Crossings {
        let bvh = Bvh::new(self);
        let mut found = Crossings { complete: true, ..Crossings::default() };
        let mut candidates = 0;
        let mut first = 0;
        for group in self.triangles.chunks(GROUP) {
            if candidates > MOST_CANDIDATES {
                found.complete = false;
                break;
            }
            let rows: Vec<(usize, Vec<u32>)> = group
                .par_iter()
                .zip(first..first + group.len() as u32)
                .map(|(&triangle, index)| crossing_partners(self, &bvh, triangle, index))
                .collect();
            for (a, (looked_at, partners)) in (first..).zip(rows) {
                candidates += looked_at;
                found.count += partners.len();
                let room = MOST_LISTED - found.pairs.len();
                found.pairs.extend(partners.into_iter().take(room).map(|b| ([a, b], place(self, a, b))));
            }
            first += group.len() as u32;
        }
        found
    }
}

/// How many later triangles have a box that touches, and which of them cross, in ascending order.
fn crossing_partners(mesh: &Mesh, bvh: &Bvh, triangle: [u32; 3], index: u32) -> (usize, Vec<u32>) {
    let Some(corners) = mesh.corners(triangle).filter(|_| !is_collapsed(triangle)) else {
        return (0, Vec::new());
    };
    let [a, b, c] = corners;
    let bounds = Bounds { min: a.min(b).min(c), max: a.max(b).max(c) };
    let (mut looked_at, mut partners) = (0, Vec::new());
    bvh.for_each_slot_in_box(bounds, |slot| {
        let other = bvh.ids[slot as usize];
        if other <= index {
            return;
        }
        looked_at += 1;
        let their = mesh.triangles[other as usize];
        let shared = their.iter().filter(|v| triangle.contains(v)).count();
        if shared < 2 && !is_collapsed(their) && triangles_cross(corners, bvh.corners[slot as usize]) {
            partners.push(other);
        }
    });
    partners.sort_unstable();
    (looked_at, partners)
}

/// The middle of the overlap of the two triangles' boxes.
fn place(mesh: &Mesh, a: u32, b: u32) -> Vec3 {
    let bounds = [a, b].map(|t| {
        let mut bounds = Bounds::EMPTY;
        let corners = mesh.corners(mesh.triangles[t as usize]);
        corners.into_iter().flatten().for_each(|p| bounds.include(p));
        bounds
    });
    bounds[0].min.max(bounds[1].min).midpoint(bounds[0].max.min(bounds[1].max))
}

/// Whether two triangles share a line segment of positive length with each reaching to both sides of the other.
fn triangles_cross(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    if in_one_axis_plane(a, b) || apart(a, b) || apart(b, a) {
        return false;
    }
    let (Some(a_sides), Some(b_sides)) = (straddles(a, b), straddles(b, a)) else { return false };
    // Turn both so that the first corner is the one alone on its side, and that side is the other's positive one.
    let (mut a, mut b) = (rotated(a, a_sides.alone), rotated(b, b_sides.alone));
    if !a_sides.positive {
        b.swap(1, 2);
    }
    if !b_sides.positive {
        a.swap(1, 2);
    }
    // The two intervals on the common line overlap in more than a point.
    orientation(a[0], a[1], b[0], b[1]) < 0.0 && orientation(a[0], a[2], b[2], b[0]) < 0.0
}

/// Flat parts of machine-made meshes: all six corners in one plane across an axis.
fn in_one_axis_plane(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let same = |p: &Vec3| p.cmpeq(a[0]);
    let equal = a.iter().chain(&b).map(same).fold(BVec3::TRUE, |all, one| all & one);
    equal.any()
}

/// A quick and safe no: all of `b` clearly on one side of the plane of `a`, but for corners they share.
fn apart(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let plane = a.map(Vec3::as_dvec3);
    let normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]);
    let error = normal_error(plane);
    let (mut above, mut below) = (true, true);
    for p in b.into_iter().filter(|p| !a.contains(p)) {
        let offset = p.as_dvec3() - plane[0];
        let (height, extent) = (offset.dot(normal), error * offset.abs().element_sum());
        above &= height > extent;
        below &= height < -extent;
    }
    above || below
}

/// A generous bound of the rounding error in the plane's normal, per unit of offset.
fn normal_error(a: [DVec3; 3]) -> f64 {
    let longest = (a[1] - a[0]).abs().element_sum().max((a[2] - a[0]).abs().element_sum());
    1e-14 * longest * longest
}

struct Sides {
    /// Which corner is alone on its side of the other triangle's plane.
    alone: usize,
    /// Whether that is the positive side.
    positive: bool,
}

/// How `triangle` lies across the plane of `other`; none unless it reaches to both sides.
fn straddles(triangle: [Vec3; 3], other: [Vec3; 3]) -> Option<Sides> {
    let mut heights = [0.0; 3];
    let mut in_plane = 0;
    for (height, p) in heights.iter_mut().zip(triangle) {
        if !other.contains(&p) {
            *height = orientation(other[0], other[1], other[2], p);
        }
        in_plane += usize::from(*height == 0.0);
        // Two corners in the plane leave one for both sides. Exact zeros are slow to find, so this is worth asking.
        if in_plane == 2 {
            return None;
        }
    }
    let above = heights.map(|h| h > 0.0);
    let below = heights.map(|h| h < 0.0);
    let count = |side: [bool; 3]| side.iter().filter(|&&s| s).count();
    let alone = |side: [bool; 3]| side.iter().position(|&s| s);
    match (count(above), count(below)) {
        (0, _) | (_, 0) => None,
        (1, _) => Some(Sides { alone: alone(above)?, positive: true }),
        _ => Some(Sides { alone: alone(below)?, positive: false }),
    }
}

fn rotated(triangle: [Vec3; 3], first: usize) -> [Vec3; 3] {
    std::array::from_fn(|i| triangle[(first + i) % 3])
}

/// Positive if `d` is on the side of the plane `a b c` from which they run counter-clockwise. Exact in sign.
fn orientation(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let coordinate = |p: Vec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, ico_sphere, uv_sphere};
    use crate::test_random::{Random, soup};

    /// An independent judge: does a side of one triangle pierce the inside of the other? In plain `f64`.
    fn pierced(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
        let pierces = |s: [Vec3; 3], t: [Vec3; 3]| {
            let t = t.map(Vec3::as_dvec3);
            let s = s.map(Vec3::as_dvec3);
            let n = (t[1] - t[0]).cross(t[2] - t[0]);
            (0..3).any(|i| {
                let (p, q) = (s[i], s[(i + 1) % 3]);
                let (hp, hq) = ((p - t[0]).dot(n), (q - t[0]).dot(n));
                if hp * hq >= 0.0 {
                    return false;
                }
                let x = p + (q - p) * (hp / (hp - hq));
                (0..3).all(|k| (t[(k + 1) % 3] - t[k]).cross(x - t[k]).dot(n) > 0.0)
            })
        };
        pierces(a, b) || pierces(b, a)
    }

    #[test]
    fn crossing_pairs_equal_brute_force_on_random_soups() {
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let mesh = soup(&mut random, 120, 5.0, 3.0);
            let mut brute = Vec::new();
            for a in 0..120u32 {
                for b in a + 1..120 {
                    let [ca, cb] = [a, b].map(|t| mesh.corners(mesh.triangles[t as usize]).unwrap());
                    if pierced(ca, cb) {
                        brute.push([a, b]);
                    }
                }
            }
            let found = mesh.crossings();
            assert!(found.complete && brute.len() > 30, "seed {seed}");
            assert_eq!(found.pairs.iter().map(|p| p.0).collect::<Vec<_>>(), brute, "seed {seed}");
        }
    }

    #[test]
    fn clean_shapes_touching_boxes_and_duplicates_have_no_crossings() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.append(&cuboid(Vec3::X, Vec3::new(2.0, 1.0, 1.0)));
        mesh.append(&cuboid(Vec3::ONE, Vec3::splat(2.0)));
        mesh.append(&cuboid(Vec3::ZERO, Vec3::ONE));
        assert_eq!(mesh.crossings().count, 0);
        assert_eq!(uv_sphere(Vec3::ZERO, 5.0, 64, 32).crossings().count, 0);
        assert_eq!(ico_sphere(Vec3::ZERO, 5.0, 4).crossings().count, 0);
    }

    #[test]
    fn two_overlapping_spheres_cross_along_one_circle() {
        let mut mesh = ico_sphere(Vec3::ZERO, 1.0, 3);
        mesh.append(&ico_sphere(Vec3::new(1.0, 0.1, 0.2), 1.0, 3));
        let found = mesh.crossings();
        assert!((60..300).contains(&found.count), "{}", found.count);
        for &([a, b], place) in &found.pairs {
            assert!(a < 1280 && b >= 1280);
            assert!((place.length() - 1.0).abs() < 0.15, "{place}");
        }
    }

    #[test]
    fn triangles_that_cross_through_a_shared_corner_count() {
        let positions = vec![
            Vec3::ZERO,
            Vec3::new(2.0, -1.0, 0.0),
            Vec3::new(2.0, 1.0, 0.0),
            Vec3::new(1.0, 0.0, -1.0),
            Vec3::new(1.0, 0.0, 1.0),
        ];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 3, 4]] };
        assert_eq!(mesh.crossings().count, 1);
    }

    #[test]
    fn the_list_is_bounded_and_broken_triangles_are_passed_over() {
        let mut random = Random::new(1);
        let mut mesh = soup(&mut random, 400, 1.0, 5.0);
        mesh.triangles.extend([[0, 0, 1], [5, 6, 9_999_999]]);
        mesh.positions[7] = Vec3::NAN;
        let found = mesh.crossings();
        assert!(found.count > 1000 && found.pairs.len() == 1000);
    }
}
