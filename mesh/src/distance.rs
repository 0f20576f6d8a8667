//! Signed distance to any mesh, sound or not: negative inside, in mm.
//!
//! How far is always the exact distance to the nearest triangle. Which side is
//!
//! - for a sound mesh (closed, oriented, without crossings or nested solids) the side of the nearest feature, exact;
//! - otherwise whether the generalised winding number exceeds one half, so holes are closed where they look closed
//!   from within, overlapping bodies unite, and doubled faces do no harm.
//!
//! What it does not do: across a hole the distance jumps from −d to +d, since there is no surface to be near to; and
//! walls inside overlapping bodies still have distance 0, with negative values on both sides.

use glam::Vec3;

use crate::bvh::{Best, Bvh};
use crate::edges::EdgeTable;
use crate::measure::Bounds;
use crate::normals::Normals;
use crate::validity::{Fault, SelfIntersections};
use crate::winding::Winding;
use crate::{Feature, Mesh};

/// Most the fast winding number is off, away from the surface; the tests hold it to 0.01.
const WINDING_ERROR: f64 = 0.02;

/// A mesh prepared for signed distances. Owns all it needs; `Send + Sync`.
#[derive(Clone, Debug)]
pub struct MeshDistance {
    bvh: Bvh,
    normals: Normals,
    winding: Winding,
    sign: SignRule,
    /// Where the surface ends, as the winding number sees it; none if it ends nowhere.
    rim: Option<Rim>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum SignRule {
    NearestFeature,
    WindingNumber,
}

#[derive(Clone, Debug)]
struct Rim {
    edges: Bvh,
    /// Length times how many triangles too many, mm.
    length: f64,
}

/// The signed distance at a point and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance to the surface, mm; negative inside.
    pub signed_distance: f32,
    /// The direction in which the signed distance grows, length 1: away from the surface outside, towards it inside,
    /// the outward normal on it. Zero only on triangles that give no direction.
    pub gradient: Vec3,
    /// The nearest point of the surface, mm.
    pub point: Vec3,
    /// The triangle it lies on.
    pub triangle: u32,
    /// Where on that triangle.
    pub feature: Feature,
}

/// Why a mesh has no signed distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshDistanceError {
    /// There is nothing to be distant from.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices} vertices")]
    MissingVertex {
        /// Index of the triangle.
        triangle: usize,
        /// The index it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A corner of a triangle is not a place.
    #[error("triangle {triangle} has a corner that is not finite; remove it or repair vertex {vertex}")]
    NotFinite {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the vertex.
        vertex: u32,
    },
}

impl MeshDistance {
    /// Prepares a mesh. A mesh that faces inward (negative volume) is turned round; everything else is taken as it is.
    ///
    /// **Cost:** O(n log n); under half a second for 100,000 triangles, much of it the search for crossings that
    /// decides how the sign is found.
    /// **Errors:** no triangles, indices out of range, coordinates that are not finite.
    pub fn new(mesh: &Mesh) -> Result<Self, MeshDistanceError> {
        check(mesh)?;
        let mut mesh = mesh.clone();
        if mesh.volume() < 0.0 {
            mesh.flip();
        }
        let sound = mesh.is_closed_manifold() && {
            let report = mesh.validity(SelfIntersections::Search);
            let harmless = [Fault::UnusedVertex, Fault::NotFinite];
            report.is_printable_solid()
                && Fault::ALL.into_iter().all(|f| harmless.contains(&f) || report.count(f) == 0)
        };
        let bvh = Bvh::new(&mesh);
        Ok(Self {
            normals: Normals::new(&mesh),
            winding: Winding::new(&bvh),
            bvh,
            sign: if sound { SignRule::NearestFeature } else { SignRule::WindingNumber },
            rim: if sound { None } else { Rim::of(&mesh) },
        })
    }

    /// The box of the mesh, mm.
    pub fn bounds(&self) -> Bounds {
        self.bvh.bounds()
    }

    /// Whether the surface ends nowhere, so that the signed distance is continuous and 1-Lipschitz.
    pub fn is_watertight(&self) -> bool {
        self.rim.is_none()
    }

    /// How often the mesh wraps around `p`: 1 inside and 0 outside a sound mesh, in between near holes, 2 where two
    /// bodies overlap. Within 0.01 away from the surface; 0 for a point that is not finite. O(log n).
    pub fn winding_number(&self, p: Vec3) -> f64 {
        self.winding.at(&self.bvh, p)
    }

    /// The distance to the surface at `p` (mm), negative inside. `f32::INFINITY` if `p` is not finite or farther than
    /// 1e19 mm. O(log n).
    pub fn signed_distance(&self, p: Vec3) -> f32 {
        self.signed_distance_within(p, f32::INFINITY)
    }

    /// As [`Self::signed_distance`], but limited to −`max` … `max`: what is farther costs little.
    pub fn signed_distance_within(&self, p: Vec3, max: f32) -> f32 {
        if !p.is_finite() {
            return max;
        }
        let best = self.bvh.closest_from(p, Best::none_within(f64::from(max)));
        self.signed(p, &best, max, None)
    }

    /// As [`Self::signed_distance_within`] for every point, into the same place of `out`; points beyond the shorter of
    /// the two slices are left alone. Neighbours in the slice should be neighbours in space: each search then starts
    /// from the last one's result. The values are the same as one by one.
    pub fn signed_distances_within(&self, points: &[Vec3], max: f32, out: &mut [f32]) {
        let mut last: Option<(Vec3, f32, Best)> = None;
        for (&p, out) in points.iter().zip(out) {
            if !p.is_finite() {
                *out = max;
                continue;
            }
            let mut best = Best::none_within(f64::from(max));
            let mut side = None;
            if let Some((q, distance, nearest)) = last {
                if nearest.slot != Best::NO_SLOT {
                    self.bvh.improve(p, nearest.slot, &mut best);
                }
                // No surface within `distance` of q, so none to cross on the way, and the side stays the same.
                if self.is_watertight() && p.distance(q) < 0.999 * distance.abs() {
                    side = Some(distance.is_sign_negative());
                }
            }
            best = self.bvh.closest_from(p, best);
            *out = self.signed(p, &best, max, side);
            last = Some((p, *out, best));
        }
    }

    /// The signed distance with its gradient and source; none if `p` is not finite or farther than 1e19 mm. O(log n).
    pub fn nearest(&self, p: Vec3) -> Option<Nearest> {
        let best = self.bvh.closest_from(p, Best::none_within(f64::INFINITY));
        if best.slot == Best::NO_SLOT {
            return None;
        }
        let signed_distance = self.signed(p, &best, f32::INFINITY, None);
        let triangle = self.bvh.ids[best.slot as usize];
        let away = p.as_dvec3() - best.point;
        let distance = away.length();
        // Below this, rounding in the nearest point spoils the direction.
        let too_close = 1e-12 * (1.0 + best.point.abs().max_element());
        let gradient = if distance > too_close {
            (away / distance).as_vec3() * signed_distance.signum()
        } else {
            self.normals.at(triangle, best.feature).normalize_or_zero()
        };
        Some(Nearest {
            signed_distance,
            gradient,
            point: best.point.as_vec3(),
            triangle,
            feature: best.feature,
        })
    }

    /// Lower and upper bound of the signed distance in the ball of `radius` mm around `centre`; never too tight.
    ///
    /// Where the side can change only by crossing the surface, the signed distance grows at most as fast as the point
    /// moves, and the bound is the value at the centre ± `radius`. That is so everywhere for a watertight mesh, and
    /// near no hole for others: the winding number's fraction changes only on account of the rim, by at most
    /// rim length / (4π distance²) per mm (the rim seen as a current, after Biot and Savart). Where this could carry it
    /// past one half somewhere in the ball, both signs are possible and only the distance itself bounds the value.
    pub fn bound(&self, centre: Vec3, radius: f32) -> (f32, f32) {
        let value = self.signed_distance(centre);
        if !value.is_finite() || radius.is_nan() {
            return (f32::NEG_INFINITY, f32::INFINITY);
        }
        let slack = radius.abs() * (1.0 + 1e-6) + value.abs() * 1e-6;
        if self.rim.as_ref().is_none_or(|rim| self.keeps_side(rim, centre, radius)) {
            (value - slack, value + slack)
        } else {
            let most = value.abs() + slack;
            (-most, most)
        }
    }

    fn keeps_side(&self, rim: &Rim, centre: Vec3, radius: f32) -> bool {
        let radius = f64::from(radius.abs());
        let Some(nearest) = rim.edges.closest(centre, f64::INFINITY) else { return false };
        let gap = nearest.distance * (1.0 - 1e-6) - radius;
        let change = radius * rim.length / (4.0 * std::f64::consts::PI * gap * gap);
        let fraction = self.winding_number(centre).rem_euclid(1.0);
        gap > 0.0 && (fraction - 0.5).abs() > change + WINDING_ERROR
    }

    /// `known` is whether the point is inside, if that is known already.
    fn signed(&self, p: Vec3, best: &Best, max: f32, known: Option<bool>) -> f32 {
        let found = best.slot != Best::NO_SLOT;
        let distance = if found { best.distance_squared.sqrt() as f32 } else { max };
        let inside = known.unwrap_or_else(|| {
            if found && self.sign == SignRule::NearestFeature {
                let normal = self.normals.at(self.bvh.ids[best.slot as usize], best.feature);
                (p.as_dvec3() - best.point).dot(normal.as_dvec3()) < 0.0
            } else {
                self.is_wrapped(p)
            }
        });
        if inside { -distance } else { distance }
    }

    fn is_wrapped(&self, p: Vec3) -> bool {
        let Bounds { min, max } = self.bvh.bounds();
        let outside_box = !(min.cmple(p) & p.cmple(max)).all();
        // Nothing that ends nowhere wraps around a point outside its box.
        !(outside_box && self.is_watertight()) && self.winding_number(p) > 0.5
    }
}

impl Rim {
    fn of(mesh: &Mesh) -> Option<Self> {
        let (mut length, mut edges) = (0.0, Vec::new());
        for edge in EdgeTable::new(mesh).iter() {
            let [a, b] = edge.ends().map(|v| mesh.positions[v as usize]);
            let surplus = edge.balance().unsigned_abs();
            if surplus > 0 {
                length += a.as_dvec3().distance(b.as_dvec3()) * surplus as f64;
                edges.push([a, b, b]);
            }
        }
        (!edges.is_empty()).then(|| Self { edges: Bvh::from_triangles((0u32..).zip(edges)), length })
    }
}

fn check(mesh: &Mesh) -> Result<(), MeshDistanceError> {
    if mesh.triangles.is_empty() {
        return Err(MeshDistanceError::NoTriangles);
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &vertex in corners {
            match mesh.positions.get(vertex as usize) {
                None => {
                    let vertices = mesh.positions.len();
                    return Err(MeshDistanceError::MissingVertex { triangle, vertex, vertices });
                }
                Some(p) if !p.is_finite() => return Err(MeshDistanceError::NotFinite { triangle, vertex }),
                Some(_) => {}
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, ico_sphere, torus, uv_sphere};
    use crate::test_random::{Random, soup};

    fn distance(mesh: &Mesh) -> MeshDistance {
        MeshDistance::new(mesh).expect("the mesh is usable")
    }

    fn box_distance(p: Vec3, half: f32) -> f32 {
        let q = p.abs() - half;
        q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
    }

    /// A sphere of radius 5 without its cap above 60° latitude: 7 % of its area.
    fn sphere_with_hole() -> Mesh {
        let mut mesh = uv_sphere(Vec3::ZERO, 5.0, 64, 32);
        let high = |t: &[u32; 3]| t.iter().any(|&v| mesh.positions[v as usize].z > 4.4);
        mesh.triangles = mesh.triangles.iter().copied().filter(|t| !high(t)).collect();
        mesh
    }

    #[test]
    fn a_box_has_the_textbook_distance_and_gradient_everywhere() {
        let mesh = cuboid(Vec3::splat(-3.0), Vec3::splat(3.0));
        let field = distance(&mesh);
        assert!(field.is_watertight() && field.sign == SignRule::NearestFeature);
        let mut random = Random::new(3);
        for _ in 0..5000 {
            let p = random.point(6.0);
            let nearest = field.nearest(p).unwrap();
            assert!((nearest.signed_distance - box_distance(p, 3.0)).abs() < 1e-5, "{nearest:?} at {p}");
            let ahead = box_distance(p + nearest.gradient * 1e-2, 3.0) - box_distance(p, 3.0);
            assert!((ahead - 1e-2).abs() < 1e-4 || box_distance(p, 3.0).abs() < 1e-2, "{nearest:?} at {p}");
        }
    }

    #[test]
    fn gradients_on_faces_edges_and_corners_point_outward() {
        let field = distance(&cuboid(Vec3::splat(-3.0), Vec3::splat(3.0)));
        for (p, expected) in [
            (Vec3::new(3.0, 1.0, 0.5), Vec3::X),
            (Vec3::new(3.0, 3.0, 0.5), Vec3::new(1.0, 1.0, 0.0).normalize()),
            (Vec3::splat(-3.0), -Vec3::ONE.normalize()),
        ] {
            let nearest = field.nearest(p).unwrap();
            assert_eq!(nearest.signed_distance.abs(), 0.0);
            assert!(nearest.gradient.abs_diff_eq(expected, 1e-5), "{nearest:?}");
        }
    }

    #[test]
    fn spheres_tori_and_hollow_boxes_know_inside_from_outside() {
        let mut hollow = cuboid(Vec3::splat(-6.0), Vec3::splat(6.0));
        let mut void = cuboid(Vec3::splat(-4.0), Vec3::splat(4.0));
        void.flip();
        hollow.append(&void);
        type Expected = fn(Vec3) -> f32;
        let cases: [(Mesh, Expected); 3] = [
            (ico_sphere(Vec3::ZERO, 5.0, 5), |p| p.length() - 5.0),
            (torus(Vec3::ZERO, 5.0, 2.0, 256, 128), |p| (p.truncate().length() - 5.0).hypot(p.z) - 2.0),
            (hollow, |p| box_distance(p, 6.0).max(-box_distance(p, 4.0))),
        ];
        let mut random = Random::new(4);
        for (mesh, expected) in cases {
            let field = distance(&mesh);
            assert_eq!(field.sign, SignRule::NearestFeature);
            for _ in 0..2000 {
                let p = random.point(8.0);
                let found = field.signed_distance(p);
                assert!((found - expected(p)).abs() < 5e-3, "{found} for {} at {p}", expected(p));
            }
        }
    }

    #[test]
    fn the_sign_survives_holes_doubled_faces_overlaps_and_inside_out_meshes() {
        let ball = |p: Vec3| p.length() - 5.0;
        let mut doubled = uv_sphere(Vec3::ZERO, 5.0, 64, 32);
        doubled.triangles.extend(doubled.triangles.clone().into_iter().step_by(3));
        let mut overlapping = uv_sphere(Vec3::ZERO, 5.0, 64, 32);
        overlapping.append(&uv_sphere(Vec3::new(1.0, 0.1, 0.2), 3.0, 32, 16));
        let mut inside_out = uv_sphere(Vec3::ZERO, 5.0, 64, 32);
        inside_out.flip();
        let mut random = Random::new(6);
        for (name, mesh) in [
            ("hole", sphere_with_hole()),
            ("doubled", doubled),
            ("overlapping", overlapping),
            ("inside out", inside_out),
        ] {
            let field = distance(&mesh);
            for _ in 0..2000 {
                let p = random.point(8.0);
                // Under the hole the cap may sag; the doubled third thickens nothing.
                let near_hole = name == "hole" && p.z > 3.5 && p.truncate().length() < 3.5;
                if ball(p).abs() > 0.1 && !near_hole {
                    assert_eq!(field.signed_distance(p) < 0.0, ball(p) < 0.0, "{name} at {p}");
                }
            }
        }
    }

    #[test]
    fn batches_and_limits_give_the_same_values_as_single_points() {
        let mut random = Random::new(7);
        let overlapping = {
            let mut mesh = ico_sphere(Vec3::ZERO, 5.0, 3);
            mesh.append(&ico_sphere(Vec3::X * 4.0, 3.0, 3));
            mesh
        };
        for mesh in [ico_sphere(Vec3::ZERO, 5.0, 3), overlapping, sphere_with_hole()] {
            let field = distance(&mesh);
            let start = random.point(6.0);
            let line = |i: u16| start + Vec3::new(-0.04, 0.03, 0.02) * f32::from(i);
            let points: Vec<Vec3> = (0..500).map(line).chain((0..500).map(|_| random.point(9.0))).collect();
            for max in [f32::INFINITY, 1.0, 0.05] {
                let mut batch = vec![0.0; points.len()];
                field.signed_distances_within(&points, max, &mut batch);
                for (&p, &value) in points.iter().zip(&batch) {
                    assert_eq!(value, field.signed_distance_within(p, max), "{p} within {max}");
                    let full = field.signed_distance(p);
                    assert_eq!(value, full.clamp(-max, max), "{p} within {max}");
                }
            }
        }
    }

    #[test]
    fn bounds_hold_on_every_kind_of_mesh() {
        let mut random = Random::new(8);
        let meshes =
            [ico_sphere(Vec3::ZERO, 5.0, 3), sphere_with_hole(), soup(&mut random, 200, 5.0, 2.0), {
                let mut mesh = uv_sphere(Vec3::ZERO, 5.0, 24, 12);
                mesh.triangles.extend(mesh.triangles.clone().into_iter().take(200));
                mesh
            }];
        for (i, mesh) in meshes.iter().enumerate() {
            let field = distance(mesh);
            for _ in 0..400 {
                let (centre, radius) = (random.point(8.0), 2.0 * random.unit() * random.unit());
                let (low, high) = field.bound(centre, radius);
                for _ in 0..60 {
                    let p = centre + random.point(1.0).clamp_length_max(1.0) * radius;
                    let value = field.signed_distance(p);
                    assert!(low <= value && value <= high, "mesh {i}: {value} outside {low}..{high} at {p}");
                }
            }
        }
    }

    #[test]
    fn bounds_are_tight_for_watertight_meshes_and_far_from_holes() {
        let sound = distance(&ico_sphere(Vec3::ZERO, 5.0, 3));
        let (low, high) = sound.bound(Vec3::X * 5.0, 1.0);
        assert!(low > -1.1 && high < 1.1);
        let open = distance(&sphere_with_hole());
        assert!(!open.is_watertight());
        let (low, high) = open.bound(Vec3::Z * -9.0, 1.0);
        assert!(low > 2.9 && high < 5.1, "{low} {high}");
        let (low, high) = open.bound(Vec3::Z * 4.4, 1.0);
        assert!(low < -2.0 && high > 2.0, "{low} {high}");
    }

    #[test]
    fn unusable_meshes_are_refused_and_odd_points_answered() {
        let nan = Mesh { positions: vec![Vec3::NAN, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
        let missing = Mesh { positions: vec![Vec3::X], triangles: vec![[0, 0, 4]] };
        assert_eq!(MeshDistance::new(&Mesh::default()).unwrap_err(), MeshDistanceError::NoTriangles);
        assert_eq!(
            MeshDistance::new(&nan).unwrap_err(),
            MeshDistanceError::NotFinite { triangle: 0, vertex: 0 }
        );
        assert_eq!(
            MeshDistance::new(&missing).unwrap_err().to_string(),
            "triangle 0 names vertex 4, but there are only 1 vertices"
        );
        let point = Mesh { positions: vec![Vec3::X], triangles: vec![[0, 0, 0]] };
        assert_eq!(distance(&point).signed_distance(Vec3::ZERO), 1.0);
        let field = distance(&cuboid(Vec3::ZERO, Vec3::ONE));
        for p in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(f32::MAX)] {
            assert_eq!(field.signed_distance(p), f32::INFINITY);
            assert_eq!(field.nearest(p), None);
            assert_eq!(field.bound(p, 1.0), (f32::NEG_INFINITY, f32::INFINITY));
        }
    }
}
