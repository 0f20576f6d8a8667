//! Fewer triangles for the same shape, by collapsing edges.
//!
//! Good for closed, manifold meshes that carry more triangles than their shape needs. What it does not do: repair
//! anything, move what is not manifold, or look for crossings that a collapse might bring about where the surface
//! passes closer to itself than the tolerance.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use crate::Mesh;
use crate::bvh::Bvh;
use crate::closest::closest_on_triangle;
use crate::edges::{EdgeTable, is_collapsed};
use crate::quadric::Quadric;
use crate::validity::{has_no_area, vertices_with_several_fans};

/// Collapses between two looks at the cancel token.
const BETWEEN_CANCEL: usize = 256;
/// A triangle may turn by this much in one collapse (cosine of 60°).
const MOST_TURN: f64 = 0.5;
/// Samples of the new surface are held to this share of the tolerance, to leave room for what lies between them: on
/// scanned and machine parts the surface came up to 1.4 times as far away as the samples' limit.
const SAMPLED_SHARE: f64 = 0.7;
/// Squared length counts this much as error, so that flat regions lose their shortest edges first. Large against the
/// rounding of errors (1e-12 mm² for 100 mm), small against any useful tolerance.
const LENGTH_WEIGHT: f64 = 1e-9;

/// Collapses edges, cheapest first, while the surface stays within `tolerance` mm of where it was.
///
/// - **Promises:** a closed edge-manifold mesh stays one, with the same bodies and genus; no triangle turns over or
///   loses its area. Every old vertex is within `tolerance` of the new surface. Every new vertex, and the middles of
///   the sides and of the triangles around it, are within 0.7 times `tolerance` of the old surface; what lies between
///   is not measured but stayed within `tolerance` on all models tried. Sharp edges and corners stay where they are
///   because the planes beside them pin them. Vertices at holes and non-manifold places do not move. The same mesh
///   gives the same result.
/// - **Cancel:** `cancelled` is asked now and then; once it says yes the answer is none.
/// - **Errors:** none. A tolerance that is not positive, or a vertex that is not finite, leaves the mesh as it is.
/// - **Cost:** O(n log n), a few microseconds per triangle.
/// - **Source:** Garland & Heckbert 1997; link condition of Dey et al. 1999, *Topology Preserving Edge Contraction*.
pub fn simplify(mesh: &Mesh, tolerance: f64, cancelled: &dyn Fn() -> bool) -> Option<Mesh> {
    let usable = |t: &[u32; 3]| mesh.corners(*t).is_some_and(|c| c.iter().all(|p| p.is_finite()));
    if !(tolerance > 0.0 && mesh.triangles.iter().all(usable)) {
        return Some(mesh.clone());
    }
    let mut work = Work::new(mesh, tolerance);
    let mut tried = 0usize;
    while let Some(Reverse(candidate)) = work.heap.pop() {
        if tried.is_multiple_of(BETWEEN_CANCEL) && cancelled() {
            return None;
        }
        tried += 1;
        if work.is_current(&candidate) {
            work.try_collapse(&candidate);
        }
    }
    Some(work.finish())
}

/// An edge waiting to be collapsed; ordered by cost, then by its vertices.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    /// The bits of a non-negative `f64`, which sort as the number does.
    cost: u64,
    keep: u32,
    remove: u32,
    /// How often the two had changed when this was written; stale if they have changed since.
    stamps: [u32; 2],
}

struct Work {
    positions: Vec<Vec3>,
    quadrics: Vec<Quadric>,
    /// Corners; a removed triangle has three equal ones.
    triangles: Vec<[u32; 3]>,
    /// The live triangles around every vertex, in ascending order.
    around: Vec<Vec<u32>>,
    stamps: Vec<u32>,
    locked: Vec<bool>,
    heap: BinaryHeap<Reverse<Candidate>>,
    /// The old vertices that each vertex stands for; they stay within the tolerance of the triangles around it.
    absorbed: Vec<Vec<u32>>,
    old_positions: Vec<Vec3>,
    original: Bvh,
    tolerance: f64,
    /// How far samples of the new surface may be from the original, mm.
    reach: f64,
}

impl Work {
    fn new(mesh: &Mesh, tolerance: f64) -> Self {
        let count = mesh.positions.len();
        let mut work = Self {
            positions: mesh.positions.clone(),
            quadrics: vec![Quadric::default(); count],
            triangles: mesh.triangles.clone(),
            around: vec![Vec::new(); count],
            stamps: vec![0; count],
            locked: locked_vertices(mesh),
            heap: BinaryHeap::new(),
            absorbed: (0u32..).take(count).map(|v| vec![v]).collect(),
            old_positions: mesh.positions.clone(),
            original: Bvh::new(mesh),
            tolerance,
            reach: SAMPLED_SHARE * tolerance,
        };
        for (t, &triangle) in (0u32..).zip(&mesh.triangles) {
            let [a, b, c] = work.corners(triangle);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for v in triangle.map(|v| v as usize) {
                work.quadrics[v] = work.quadrics[v].plus(&Quadric::plane(a, normal));
                work.around[v].push(t);
            }
        }
        for edge in EdgeTable::new(mesh).iter() {
            let [a, b] = edge.ends();
            work.offer(a, b);
        }
        work
    }

    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.positions[v as usize].as_dvec3())
    }

    /// Puts an edge on the heap if it may be collapsed within the tolerance.
    fn offer(&mut self, a: u32, b: u32) {
        let (keep, remove) = (a.min(b), a.max(b));
        if self.locked[keep as usize] || self.locked[remove as usize] {
            return;
        }
        let (_, error) = self.target(keep, remove);
        if error <= self.reach * self.reach {
            let ends = [keep, remove].map(|v| self.positions[v as usize].as_dvec3());
            let cost = error + LENGTH_WEIGHT * ends[0].distance_squared(ends[1]);
            let stamps = [keep, remove].map(|v| self.stamps[v as usize]);
            self.heap.push(Reverse(Candidate { cost: cost.to_bits(), keep, remove, stamps }));
        }
    }

    /// Where the two vertices become one, and the error there. An end of the edge is taken whenever nothing is better
    /// by more than rounding, so that corners keep their coordinates.
    fn target(&self, keep: u32, remove: u32) -> (Vec3, f64) {
        let quadric = self.quadrics[keep as usize].plus(&self.quadrics[remove as usize]);
        let ends = [keep, remove].map(|v| self.positions[v as usize]);
        let [a, b] = ends.map(Vec3::as_dvec3);
        let error = |p: Vec3| quadric.at(p.as_dvec3());
        let mut best = if error(ends[1]) < error(ends[0]) { ends[1] } else { ends[0] };
        let free = quadric.minimum().filter(|p| p.distance(a) + p.distance(b) < 3.0 * a.distance(b));
        let between = || quadric.minimum_between(a, b).map(|t| a.lerp(b, t));
        if let Some(p) = free.or_else(between) {
            let p = p.as_vec3();
            let noise = 1e-14 * (1.0 + a.length_squared());
            if error(p) + noise < error(best) {
                best = p;
            }
        }
        (best, error(best))
    }

    fn is_current(&self, candidate: &Candidate) -> bool {
        candidate.stamps == [candidate.keep, candidate.remove].map(|v| self.stamps[v as usize])
    }

    fn try_collapse(&mut self, candidate: &Candidate) {
        let (keep, remove) = (candidate.keep, candidate.remove);
        let (target, _) = self.target(keep, remove);
        if self.keeps_topology(keep, remove)
            && self.keeps_shape(keep, remove, target)
            && let Some(moves) = self.rehomed(keep, remove, target)
        {
            self.collapse(keep, remove, target);
            for [old, from, to] in moves {
                self.absorbed[from as usize].retain(|&v| v != old);
                self.absorbed[to as usize].push(old);
            }
        }
    }

    /// The link condition: the vertices have exactly the two opposite corners in common, and no edge.
    fn keeps_topology(&self, keep: u32, remove: u32) -> bool {
        let (ours, theirs) = (self.neighbours(keep), self.neighbours(remove));
        let common: Vec<u32> = ours.into_iter().filter(|v| theirs.binary_search(v).is_ok()).collect();
        let [a, b] = common[..] else { return false };
        let faces = |v: u32| self.around[v as usize].iter().map(|&t| self.triangles[t as usize]);
        let spans = |v: u32| faces(v).any(|t| t.contains(&a) && t.contains(&b));
        let shared = faces(keep).filter(|t| t.contains(&remove)).count();
        shared == 2 && !(spans(keep) && spans(remove))
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let faces = self.around[v as usize].iter();
        let mut all: Vec<u32> = faces.flat_map(|&t| self.triangles[t as usize]).filter(|&w| w != v).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether no triangle turns over or loses its area, and the new ones stay near the original surface.
    fn keeps_shape(&self, keep: u32, remove: u32, target: Vec3) -> bool {
        let sound = |t: &[u32; 3], v: u32| {
            let moved = t.map(|w| if w == v { target } else { self.positions[w as usize] });
            let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
            let (before, after) = (normal(self.corners(*t)), normal(moved.map(Vec3::as_dvec3)));
            before.dot(after) >= MOST_TURN * before.length() * after.length() && !has_no_area(moved)
        };
        let staying = |v: u32, other: u32| {
            let faces = self.around[v as usize].iter().map(|&t| self.triangles[t as usize]);
            faces.filter(move |t| !t.contains(&other)).map(move |t| (t, v))
        };
        let faces = || staying(keep, remove).chain(staying(remove, keep));
        let near = |p: DVec3| self.original.is_within(p.as_vec3(), self.reach);
        let new = target.as_dvec3();
        faces().all(|(t, v)| sound(&t, v))
            && near(new)
            && faces().all(|(t, v)| {
                let [a, b] = others(t, v).map(|w| self.positions[w as usize].as_dvec3());
                near((a + b + new) / 3.0) && near((a + new) * 0.5)
            })
    }

    /// Which old vertices must change hands so that all stay within the tolerance of their triangles: `[old, from, to]`
    /// each. None if the collapse would leave one too far from every triangle around.
    fn rehomed(&self, keep: u32, remove: u32, target: Vec3) -> Option<Vec<[u32; 3]>> {
        let mut concerned = self.neighbours(keep);
        concerned.extend(self.neighbours(remove));
        concerned.sort_unstable();
        concerned.dedup();
        let ring = self.ring_after(&concerned, keep, remove, target);
        let most = self.tolerance * self.tolerance;
        let mut moves = Vec::new();
        for &v in &concerned {
            let owner = if v == remove { keep } else { v };
            for &old in &self.absorbed[v as usize] {
                let p = self.old_positions[old as usize].as_dvec3();
                let near = |face: &&([u32; 3], [Vec3; 3])| {
                    closest_on_triangle(p, face.1).0.distance_squared(p) <= most
                };
                if !ring.iter().filter(|face| face.0.contains(&owner)).any(|face| near(&face)) {
                    moves.push([old, owner, ring.iter().find(near)?.0[0]]);
                }
            }
        }
        Some(moves)
    }

    /// The triangles around some vertices as they will be after a collapse.
    fn ring_after(
        &self,
        vertices: &[u32],
        keep: u32,
        remove: u32,
        target: Vec3,
    ) -> Vec<([u32; 3], [Vec3; 3])> {
        let mut faces: Vec<u32> = vertices.iter().flat_map(|&v| &self.around[v as usize]).copied().collect();
        faces.sort_unstable();
        faces.dedup();
        let triangles = faces.into_iter().map(|t| self.triangles[t as usize]);
        triangles
            .filter(|t| !(t.contains(&keep) && t.contains(&remove)))
            .map(|t| {
                let t = t.map(|v| if v == remove { keep } else { v });
                (t, t.map(|v| if v == keep { target } else { self.positions[v as usize] }))
            })
            .collect()
    }

    fn collapse(&mut self, keep: u32, remove: u32, target: Vec3) {
        let (k, r) = (keep as usize, remove as usize);
        self.positions[k] = target;
        self.quadrics[k] = self.quadrics[k].plus(&self.quadrics[r]);
        let absorbed = std::mem::take(&mut self.absorbed[r]);
        self.absorbed[k].extend(absorbed);
        self.stamps[k] += 1;
        self.stamps[r] += 1;
        for t in std::mem::take(&mut self.around[r]) {
            let triangle = self.triangles[t as usize];
            if triangle.contains(&keep) {
                for v in triangle {
                    self.around[v as usize].retain(|&other| other != t);
                }
                self.triangles[t as usize] = [keep; 3];
            } else {
                self.triangles[t as usize] = triangle.map(|v| if v == remove { keep } else { v });
                self.around[k].push(t);
            }
        }
        self.around[k].sort_unstable();
        for v in self.neighbours(keep) {
            self.offer(keep, v);
        }
    }

    /// What is left, with unused vertices dropped and the order kept.
    fn finish(self) -> Mesh {
        let mut mesh = Mesh::default();
        let mut renamed = vec![u32::MAX; self.positions.len()];
        let left: Vec<[u32; 3]> = self.triangles.into_iter().filter(|t| !is_collapsed(*t)).collect();
        for v in left.iter().flatten() {
            renamed[*v as usize] = 0;
        }
        for (new, &p) in renamed.iter_mut().zip(&self.positions).filter(|(new, _)| **new == 0) {
            *new = mesh.positions.len() as u32;
            mesh.positions.push(p);
        }
        mesh.triangles = left.into_iter().map(|t| t.map(|v| renamed[v as usize])).collect();
        mesh
    }
}

/// The two corners that follow `v` in the triangle.
fn others([a, b, c]: [u32; 3], v: u32) -> [u32; 2] {
    if v == a {
        [b, c]
    } else if v == b {
        [c, a]
    } else {
        [a, b]
    }
}

/// Vertices where the surface is not a disc: at holes, at edges with the wrong number or direction of triangles, where
/// fans touch, and at triangles that name a vertex twice.
fn locked_vertices(mesh: &Mesh) -> Vec<bool> {
    let mut locked = vec![false; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        for v in triangle {
            locked[v as usize] |= is_collapsed(triangle);
        }
    }
    let edges = EdgeTable::new(mesh);
    for edge in edges.iter() {
        if edge.halves.len() != 2 || edge.balance() != 0 {
            edge.ends().into_iter().for_each(|v| locked[v as usize] = true);
        }
    }
    for v in vertices_with_several_fans(mesh, &edges) {
        locked[v as usize] = true;
    }
    locked
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::shapes::{cuboid, cylinder, ico_sphere, subdivide, torus, uv_sphere};
    use crate::{Fault, SelfIntersections};

    fn simplified(mesh: &Mesh, tolerance: f64) -> Mesh {
        simplify(mesh, tolerance, &|| false).expect("nobody cancels")
    }

    /// How far apart the surfaces are, both ways, judged at vertices and triangle middles of both.
    fn deviation(a: &Mesh, b: &Mesh) -> f64 {
        let one_way = |from: &Mesh, to: &Mesh| {
            let to = Bvh::new(to);
            let middles =
                from.triangles.iter().filter_map(|&t| from.corners(t)).map(|[a, b, c]| (a + b + c) / 3.0);
            let farthest =
                |far: f64, p: Vec3| far.max(to.closest(p, f64::INFINITY).map_or(0.0, |c| c.distance));
            middles.chain(from.positions.iter().copied()).fold(0.0, farthest)
        };
        one_way(a, b).max(one_way(b, a))
    }

    #[test]
    fn a_fine_sphere_loses_most_triangles_and_keeps_its_volume() {
        for fine in [ico_sphere(Vec3::ZERO, 10.0, 6), uv_sphere(Vec3::ONE, 10.0, 160, 80)] {
            let coarse = simplified(&fine, 0.01);
            assert!(coarse.triangles.len() * 2 < fine.triangles.len(), "{} left", coarse.triangles.len());
            let report = coarse.validity(SelfIntersections::Search);
            assert!(report.is_printable_solid() && report.findings().count() == 0);
            assert_eq!(coarse.euler_characteristic(), 2);
            let change = (coarse.volume() - fine.volume()).abs();
            assert!(change < 0.01 * 4.0 * PI * 100.0, "volume changed by {change}");
            let apart = deviation(&fine, &coarse);
            assert!(apart < 0.01, "{apart} mm apart");
        }
    }

    #[test]
    fn a_subdivided_cube_goes_back_to_its_corners() {
        let cube = cuboid(Vec3::new(-1.0, 2.0, 0.1), Vec3::new(9.3, 7.7, 5.9));
        let fine = (0..4).fold(cube.clone(), |mesh, _| subdivide(&mesh));
        let coarse = simplified(&fine, 0.01);
        assert!(coarse.triangles.len() <= 16, "{} triangles", coarse.triangles.len());
        assert!(coarse.is_closed_manifold());
        for corner in &cube.positions {
            assert!(coarse.positions.contains(corner), "{corner} is gone: {:?}", coarse.positions);
        }
    }

    #[test]
    fn sharp_rims_and_handles_stay() {
        let tube = subdivide(&subdivide(&cylinder(Vec3::ZERO, 5.0, 10.0, 64)));
        let coarse = simplified(&tube, 0.01);
        let bounds = coarse.bounds();
        assert!(bounds.min.z.abs() < 1e-5 && (bounds.max.z - 10.0).abs() < 1e-5, "{bounds:?}");
        assert!(coarse.triangles.len() * 4 < tube.triangles.len());
        assert!((coarse.volume() / tube.volume() - 1.0).abs() < 1e-3);
        let ring = simplified(&torus(Vec3::ZERO, 10.0, 3.0, 128, 64), 0.05);
        assert!(ring.is_closed_manifold() && ring.triangles.len() < 8000);
        assert_eq!(ring.euler_characteristic(), 0);
    }

    #[test]
    fn however_large_the_tolerance_no_body_vanishes_or_breaks() {
        for mesh in [ico_sphere(Vec3::ZERO, 1.0, 3), torus(Vec3::ZERO, 3.0, 1.0, 24, 12)] {
            let coarse = simplified(&mesh, 100.0);
            assert!(coarse.is_closed_manifold() && coarse.triangles.len() >= 4);
            assert_eq!(coarse.euler_characteristic(), mesh.euler_characteristic());
            assert_eq!(coarse.validity(SelfIntersections::Skip).count(Fault::ZeroArea), 0);
        }
    }

    #[test]
    fn the_rim_of_a_hole_does_not_move() {
        let mut mesh = uv_sphere(Vec3::ZERO, 5.0, 64, 32);
        let upper = |t: &[u32; 3]| t.iter().all(|&v| mesh.positions[v as usize].z > -1e-4);
        mesh.triangles = mesh.triangles.iter().copied().filter(upper).collect();
        let coarse = simplified(&mesh, 0.05);
        let rim = |m: &Mesh| m.validity(SelfIntersections::Skip).count(Fault::BoundaryEdge);
        assert_eq!((rim(&mesh), rim(&coarse)), (64, 64));
        assert!(coarse.triangles.len() < mesh.triangles.len());
    }

    #[test]
    fn cancelling_and_unusable_input_are_answered() {
        let mesh = ico_sphere(Vec3::ZERO, 1.0, 3);
        assert_eq!(simplify(&mesh, 0.1, &|| true), None);
        assert_eq!(simplified(&mesh, 0.0), mesh);
        assert_eq!(simplified(&mesh, f64::NAN), mesh);
        let broken = Mesh { positions: vec![Vec3::NAN; 3], triangles: vec![[0, 1, 2], [0, 1, 9]] };
        assert_eq!(simplified(&broken, 1.0).triangles, broken.triangles);
        assert_eq!(simplified(&Mesh::default(), 1.0), Mesh::default());
    }
}
