//! A bounding volume hierarchy over triangles: closest point, first hit of a ray, everything in a box.
//!
//! Four boxes to a node, side by side, so that one look tests them all. Built by the surface area heuristic; the same
//! triangles always give the same tree, and every query's answer depends on the triangles alone, never on the order
//! in which the tree is walked: among equally good triangles the one with the smallest index wins.

use glam::{DVec3, Vec3};

use crate::Mesh;
use crate::bvh_build::build;
use crate::closest::{Feature, closest_on_triangle};
use crate::measure::Bounds;

/// Children of a node.
pub(crate) const WIDTH: usize = 4;
/// Most triangles in a leaf.
pub(crate) const LEAF: usize = 4;
/// A walk keeps at most three waiting children per level; [`build`] bounds the levels to 48.
const STACK: usize = 160;
/// Boxes may be this much farther than the best triangle and are still opened, so that rounding never hides a tie.
const SLACK: f32 = 1.000_002;

/// One step of the tree: four boxes and what is in them.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// `[axis][child]`.
    pub min: [[f32; WIDTH]; 3],
    pub max: [[f32; WIDTH]; 3],
    /// Index of the child node, or of a leaf's first slot.
    pub child: [u32; WIDTH],
    /// Triangles in a leaf; 0 for a child node, [`Node::NOTHING`] for no child.
    pub count: [u32; WIDTH],
}

impl Node {
    pub const NOTHING: u32 = u32::MAX;
    pub const EMPTY: Self = Self {
        min: [[f32::INFINITY; WIDTH]; 3],
        max: [[f32::NEG_INFINITY; WIDTH]; 3],
        child: [0; WIDTH],
        count: [Self::NOTHING; WIDTH],
    };

    pub fn bounds(&self, child: usize) -> Bounds {
        let pick = |from: &[[f32; WIDTH]; 3]| Vec3::new(from[0][child], from[1][child], from[2][child]);
        Bounds { min: pick(&self.min), max: pick(&self.max) }
    }

    fn distances_squared(&self, p: Vec3) -> [f32; WIDTH] {
        let mut sum = [0.0; WIDTH];
        for (axis, x) in p.to_array().into_iter().enumerate() {
            for (lane, total) in sum.iter_mut().enumerate() {
                let (below, above) = (self.min[axis][lane] - x, x - self.max[axis][lane]);
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *total += gap * gap;
            }
        }
        sum
    }
}

/// A search tree over a copy of a set of triangles. `Send + Sync`; queries take O(log n) for ordinary meshes.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) nodes: Vec<Node>,
    /// Corner positions in leaf order.
    pub(crate) corners: Vec<[Vec3; 3]>,
    /// The caller's index of each triangle in leaf order.
    pub(crate) ids: Vec<u32>,
    bounds: Bounds,
}

/// The point of a mesh closest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Distance, mm.
    pub distance: f64,
    /// The point on the mesh, mm.
    pub point: DVec3,
    /// Index of the triangle it lies on; the smallest one if several share it.
    pub triangle: u32,
    /// Where on that triangle.
    pub feature: Feature,
}

/// Where a ray first meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Parameter along the ray: the point is `origin + t · direction`.
    pub t: f64,
    /// The point, mm.
    pub point: Vec3,
    /// Index of the triangle; the smallest one if several are met at the same `t`.
    pub triangle: u32,
    /// Whether the ray arrives on the side from which the triangle runs counter-clockwise.
    pub front: bool,
}

/// The best triangle so far while looking for the closest point; `slot` is in leaf order.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    pub distance_squared: f64,
    pub point: DVec3,
    pub slot: u32,
    pub feature: Feature,
}

impl Best {
    pub const NO_SLOT: u32 = u32::MAX;

    /// Nothing found yet, and nothing farther than `max_distance` wanted.
    pub fn none_within(max_distance: f64) -> Self {
        let distance_squared = max_distance.max(0.0).powi(2).min(f64::from(f32::MAX));
        Self { distance_squared, point: DVec3::ZERO, slot: Self::NO_SLOT, feature: Feature::Face }
    }
}

impl Bvh {
    /// Builds the tree over a mesh's triangles; those that name a missing vertex or have a coordinate that is not
    /// finite are left out. O(n log n), on several threads where the pool has them.
    pub fn new(mesh: &Mesh) -> Self {
        Self::from_triangles((0..=u32::MAX).zip(&mesh.triangles).filter_map(|(id, &t)| {
            let corners = mesh.corners(t)?;
            corners.iter().all(|p| p.is_finite()).then_some((id, corners))
        }))
    }

    /// Builds the tree over `(index, corners)`; the coordinates must be finite.
    pub(crate) fn from_triangles(triangles: impl Iterator<Item = (u32, [Vec3; 3])>) -> Self {
        let (ids, corners): (Vec<u32>, Vec<[Vec3; 3]>) = triangles.unzip();
        let (nodes, order) = build(&corners);
        let bounds = nodes.first().map_or(Bounds::EMPTY, |root| {
            (0..WIDTH).map(|c| root.bounds(c)).fold(Bounds::EMPTY, Bounds::union)
        });
        let corners = order.iter().map(|&i| corners[i as usize]).collect();
        let ids = order.iter().map(|&i| ids[i as usize]).collect();
        Self { nodes, corners, ids, bounds }
    }

    /// The box of everything in the tree, mm.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The closest point not farther than `max_distance` mm (`f64::INFINITY` for any); none if there is no such.
    pub fn closest(&self, p: Vec3, max_distance: f64) -> Option<Closest> {
        let best = self.closest_from(p, Best::none_within(max_distance));
        (best.slot != Best::NO_SLOT).then(|| Closest {
            distance: best.distance_squared.sqrt(),
            point: best.point,
            triangle: self.ids[best.slot as usize],
            feature: best.feature,
        })
    }

    /// The better of `best` and the closest point of all triangles. Starting from a triangle that was close to a
    /// neighbouring point changes only the speed.
    pub(crate) fn closest_from(&self, p: Vec3, best: Best) -> Best {
        self.close_enough(p, best, -1.0)
    }

    /// Whether any triangle is within `distance` mm; cheaper than finding the closest.
    pub fn is_within(&self, p: Vec3, distance: f64) -> bool {
        let start = Best::none_within(distance);
        self.close_enough(p, start, start.distance_squared).slot != Best::NO_SLOT
    }

    /// Walks the tree until the closest triangle is found, or any with a squared distance of at most `enough`.
    fn close_enough(&self, p: Vec3, mut best: Best, enough: f64) -> Best {
        let mut stack = [(0.0f32, 0u32, 0u32); STACK];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let (distance_squared, child, count) = stack[height];
            if distance_squared > limit(best.distance_squared) {
                continue;
            }
            if count > 0 {
                for slot in child..child + count {
                    if box_distance_squared(p, &self.corners[slot as usize]) <= limit(best.distance_squared) {
                        self.improve(p, slot, &mut best);
                    }
                }
                if best.slot != Best::NO_SLOT && best.distance_squared <= enough {
                    return best;
                }
                continue;
            }
            let node = &self.nodes[child as usize];
            let distances = node.distances_squared(p);
            let (base, limit) = (height, limit(best.distance_squared));
            for (lane, &d) in distances.iter().enumerate() {
                if d <= limit && node.count[lane] != Node::NOTHING {
                    // Insertion keeps the nearest on top.
                    let mut i = height;
                    while i > base && stack[i - 1].0 < d {
                        stack[i] = stack[i - 1];
                        i -= 1;
                    }
                    stack[i] = (d, node.child[lane], node.count[lane]);
                    height += 1;
                }
            }
        }
        best
    }

    /// Takes the triangle in `slot` if it is closer than `best`, or as close with a smaller index.
    pub(crate) fn improve(&self, p: Vec3, slot: u32, best: &mut Best) {
        let p = p.as_dvec3();
        let (point, feature) = closest_on_triangle(p, self.corners[slot as usize]);
        let distance_squared = point.distance_squared(p);
        let wins_tie =
            || best.slot == Best::NO_SLOT || self.ids[slot as usize] < self.ids[best.slot as usize];
        if distance_squared < best.distance_squared
            || (distance_squared == best.distance_squared && wins_tie())
        {
            *best = Best { distance_squared, point, slot, feature };
        }
    }

    /// The first triangle that the ray meets at `0 ≤ t ≤ max_t`, from either side. `direction` (mm) need not have
    /// length 1. A ray through a shared edge or corner always meets one of the triangles there.
    pub fn ray_cast(&self, origin: Vec3, direction: Vec3, max_t: f64) -> Option<RayHit> {
        let ray = Ray::new(origin, direction)?;
        let mut best: Option<(f64, u32, bool)> = None;
        let mut reach = max_t;
        let mut stack = [(0.0f64, 0u32, 0u32); STACK];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let (entry, child, count) = stack[height];
            if entry > reach {
                continue;
            }
            if count > 0 {
                for slot in child..child + count {
                    let Some((t, front)) = ray.triangle(self.corners[slot as usize]) else { continue };
                    let id = self.ids[slot as usize];
                    if t <= reach && best.is_none_or(|(best_t, best_id, _)| (t, id) < (best_t, best_id)) {
                        best = Some((t, id, front));
                        reach = t;
                    }
                }
                continue;
            }
            let node = &self.nodes[child as usize];
            let base = height;
            for lane in (0..WIDTH).filter(|&lane| node.count[lane] != Node::NOTHING) {
                if let Some(entry) = ray.enters(&node.bounds(lane), reach) {
                    let mut i = height;
                    while i > base && stack[i - 1].0 < entry {
                        stack[i] = stack[i - 1];
                        i -= 1;
                    }
                    stack[i] = (entry, node.child[lane], node.count[lane]);
                    height += 1;
                }
            }
        }
        best.map(|(t, triangle, front)| {
            let point = (origin.as_dvec3() + direction.as_dvec3() * t).as_vec3();
            RayHit { t, point, triangle, front }
        })
    }

    /// Calls `visit` with the index of every triangle whose box touches `query`, in no particular order.
    pub fn for_each_in_box(&self, query: Bounds, mut visit: impl FnMut(u32)) {
        self.for_each_slot_in_box(query, |slot| visit(self.ids[slot as usize]));
    }

    pub(crate) fn for_each_slot_in_box(&self, query: Bounds, mut visit: impl FnMut(u32)) {
        let mut stack = [0u32; STACK];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let node = &self.nodes[stack[height] as usize];
            for lane in 0..WIDTH {
                let bounds = node.bounds(lane);
                if !(bounds.min.cmple(query.max) & query.min.cmple(bounds.max)).all() {
                    continue;
                }
                match node.count[lane] {
                    Node::NOTHING => {}
                    0 => {
                        stack[height] = node.child[lane];
                        height += 1;
                    }
                    count => {
                        let first = node.child[lane];
                        (first..first + count)
                            .filter(|&slot| {
                                let [a, b, c] = self.corners[slot as usize];
                                (a.min(b).min(c).cmple(query.max) & query.min.cmple(a.max(b).max(c))).all()
                            })
                            .for_each(&mut visit);
                    }
                }
            }
        }
    }
}

fn box_distance_squared(p: Vec3, [a, b, c]: &[Vec3; 3]) -> f32 {
    let (low, high) = (a.min(*b).min(*c), a.max(*b).max(*c));
    (low - p).max(p - high).max(Vec3::ZERO).length_squared()
}

fn limit(distance_squared: f64) -> f32 {
    (distance_squared as f32) * SLACK
}

/// A ray prepared for triangle tests that leave no gap between neighbours.
/// **Source:** Woop, Benthin, Wald 2013, *Watertight Ray/Triangle Intersection*, in `f64` throughout.
struct Ray {
    origin: DVec3,
    inverse: DVec3,
    axes: [usize; 3],
    shear: DVec3,
}

impl Ray {
    /// None if the direction is zero or anything is not finite.
    fn new(origin: Vec3, direction: Vec3) -> Option<Self> {
        if !origin.is_finite() || !direction.is_finite() || direction == Vec3::ZERO {
            return None;
        }
        let d = direction.as_dvec3();
        let size = d.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = DVec3::new(d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
        Some(Self { origin: origin.as_dvec3(), inverse: d.recip(), axes: [x, y, z], shear })
    }

    /// Where the ray enters a box, if it does so at `0 ≤ t ≤ reach`.
    fn enters(&self, bounds: &Bounds, reach: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0, reach);
        for axis in 0..3 {
            let low = f64::from(bounds.min[axis]) - self.origin[axis];
            let high = f64::from(bounds.max[axis]) - self.origin[axis];
            if self.inverse[axis].is_infinite() {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low * self.inverse[axis], high * self.inverse[axis]);
            near = f64::max(near, a.min(b));
            far = f64::min(far, a.max(b) * (1.0 + 1e-14));
        }
        (near <= far).then_some(near)
    }

    /// The parameter at which the ray meets a triangle and whether it comes from the front.
    fn triangle(&self, corners: [Vec3; 3]) -> Option<(f64, bool)> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|p| {
            let v = p.as_dvec3() - self.origin;
            DVec3::new(v[x] - self.shear.x * v[z], v[y] - self.shear.y * v[z], self.shear.z * v[z])
        });
        let [a, b, c] = sheared;
        let (u, v, w) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        let t = (u * a.z + v * b.z + w * c.z) / determinant;
        (determinant != 0.0 && t >= 0.0).then_some((t, determinant > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, ico_sphere};
    use crate::test_random::{Random, soup};

    fn brute_closest(mesh: &Mesh, p: Vec3) -> (f64, u32) {
        let mut best = (f64::INFINITY, 0);
        for (id, &t) in (0..).zip(&mesh.triangles) {
            let (point, _) = closest_on_triangle(p.as_dvec3(), mesh.corners(t).unwrap());
            let distance = point.distance(p.as_dvec3());
            if distance < best.0 {
                best = (distance, id);
            }
        }
        best
    }

    #[test]
    fn closest_points_equal_brute_force_on_random_soups() {
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let mesh = soup(&mut random, 1 + 13 * seed as usize, 10.0, 3.0);
            let bvh = Bvh::new(&mesh);
            for _ in 0..60 {
                let p = random.point(15.0);
                let found = bvh.closest(p, f64::INFINITY).unwrap();
                assert_eq!((found.distance, found.triangle), brute_closest(&mesh, p), "seed {seed} at {p}");
                for (share, expected) in [(0.999, false), (1.001, true)] {
                    assert_eq!(bvh.closest(p, found.distance * share).is_some(), expected, "seed {seed}");
                    assert_eq!(bvh.is_within(p, found.distance * share), expected, "seed {seed}");
                }
            }
        }
    }

    #[test]
    fn rays_hit_what_brute_force_hits() {
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let mesh = soup(&mut random, 1 + 13 * seed as usize, 10.0, 3.0);
            let bvh = Bvh::new(&mesh);
            for _ in 0..60 {
                let (origin, direction) = (random.point(15.0), random.point(1.0));
                let ray = Ray::new(origin, direction).unwrap();
                let brute = (0u32..)
                    .zip(&mesh.triangles)
                    .filter_map(|(id, &t)| Some((ray.triangle(mesh.corners(t)?)?.0, id)))
                    .min_by(|a, b| a.partial_cmp(b).unwrap());
                let found = bvh.ray_cast(origin, direction, f64::INFINITY);
                assert_eq!(found.map(|h| (h.t, h.triangle)), brute, "seed {seed}");
            }
        }
    }

    #[test]
    fn rays_through_vertices_and_edges_never_slip_through() {
        let mesh = ico_sphere(Vec3::ZERO, 1.0, 2);
        let bvh = Bvh::new(&mesh);
        for &[a, b, _] in &mesh.triangles {
            let (a, b) = (mesh.positions[a as usize], mesh.positions[b as usize]);
            for target in [a, a.midpoint(b)] {
                let hit = bvh.ray_cast(target * 3.0, -target, 10.0).expect("the sphere is closed");
                assert!(hit.front && (hit.t - 2.0).abs() < 1e-2, "{hit:?}");
                assert!(!bvh.ray_cast(Vec3::ZERO, target, 10.0).expect("closed from inside too").front);
            }
        }
    }

    #[test]
    fn rays_along_the_faces_of_a_box_and_bad_rays_do_no_harm() {
        let bvh = Bvh::new(&cuboid(Vec3::ZERO, Vec3::ONE));
        let hit = bvh.ray_cast(Vec3::new(-1.0, 0.25, 0.5), Vec3::X * 2.0, 10.0).unwrap();
        assert_eq!((hit.t, hit.point, hit.front), (0.5, Vec3::new(0.0, 0.25, 0.5), true));
        assert_eq!(bvh.ray_cast(Vec3::new(-1.0, 0.25, 0.5), Vec3::X, 0.9), None);
        bvh.ray_cast(Vec3::new(-1.0, 0.0, 0.5), Vec3::X, 10.0);
        assert_eq!(bvh.ray_cast(Vec3::NAN, Vec3::X, 10.0), None);
        assert_eq!(bvh.ray_cast(Vec3::ZERO, Vec3::ZERO, 10.0), None);
    }

    #[test]
    fn boxes_find_the_same_triangles_as_brute_force() {
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let mesh = soup(&mut random, 200, 10.0, 3.0);
            let bvh = Bvh::new(&mesh);
            let (a, b) = (random.point(10.0), random.point(10.0));
            let query = Bounds { min: a.min(b), max: a.max(b) };
            let mut found = Vec::new();
            bvh.for_each_in_box(query, |t| found.push(t));
            found.sort_unstable();
            let touches = |&(_, &t): &(u32, &[u32; 3])| {
                let [a, b, c] = mesh.corners(t).unwrap();
                (a.min(b).min(c).cmple(query.max) & query.min.cmple(a.max(b).max(c))).all()
            };
            let brute: Vec<u32> = (0u32..).zip(&mesh.triangles).filter(touches).map(|(id, _)| id).collect();
            assert_eq!(found, brute, "seed {seed}");
        }
    }

    #[test]
    fn thousands_of_equal_or_exponentially_shrinking_triangles_build_and_answer() {
        let same = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]; 5000] };
        assert_eq!(Bvh::new(&same).closest(Vec3::Z, f64::INFINITY).unwrap().triangle, 0);
        let mut shrinking = Mesh::default();
        for i in 0..240u32 {
            let size = 2f32.powi(120 - i as i32);
            shrinking.positions.extend([Vec3::X * size, Vec3::Y * size, Vec3::ZERO]);
            shrinking.triangles.extend([[3 * i, 3 * i + 1, 3 * i + 2]; 40]);
        }
        let found = Bvh::new(&shrinking).closest(Vec3::new(0.0, 0.0, 1.0), f64::INFINITY).unwrap();
        assert_eq!(found.distance, 1.0);
    }

    #[test]
    fn an_empty_or_unusable_mesh_gives_an_empty_tree() {
        let nan = Mesh { positions: vec![Vec3::NAN; 3], triangles: vec![[0, 1, 2], [7, 8, 9]] };
        for mesh in [Mesh::default(), nan] {
            let bvh = Bvh::new(&mesh);
            assert_eq!(bvh.closest(Vec3::ZERO, f64::INFINITY), None);
            assert_eq!(bvh.ray_cast(Vec3::ZERO, Vec3::X, f64::INFINITY), None);
            assert!(bvh.bounds().is_empty());
        }
    }
}
