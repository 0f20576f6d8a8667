//! Sizes of a mesh: box, area, volume, centre of mass, inertia, Euler characteristic; and moving and scaling it.
//!
//! Volume and mass are integrals over the signed tetrahedra between each triangle and the middle of the box, in
//! `f64`, so a mesh far from the origin loses nothing beyond its `f32` positions. They are exact for a closed,
//! consistently oriented mesh; where a mesh overlaps itself the overlap counts twice. Triangles that name a vertex
//! that does not exist count for nothing.

use glam::{DMat3, DVec3, Vec3};

use crate::Mesh;
use crate::edges::EdgeTable;

/// An axis-aligned box, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The box of nothing: including a point makes it that point.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Grows to hold `p`.
    pub fn include(&mut self, p: Vec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths; zero for the empty box.
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The middle, in full precision; the origin for the empty box.
    pub fn centre(&self) -> DVec3 {
        let centre = (self.min.as_dvec3() + self.max.as_dvec3()) * 0.5;
        if centre.is_finite() { centre } else { DVec3::ZERO }
    }

    /// Whether no point was ever included.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }
}

/// What a solid of density 1 weighs and how it turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Volume, mm³; negative for an inward-facing mesh.
    pub volume: f64,
    /// Centre of mass, mm.
    pub centre: DVec3,
    /// Inertia tensor about the centre of mass at density 1, mm⁵; negative with the volume.
    pub inertia: DMat3,
}

impl Mesh {
    /// The corner positions of a triangle, or none if it names a vertex that does not exist.
    pub fn corners(&self, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
        let [a, b, c] = triangle.map(|i| self.positions.get(i as usize).copied());
        Some([a?, b?, c?])
    }

    /// The box of all vertices that triangles use, mm. [`Bounds::EMPTY`] without triangles.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        self.triangles.iter().filter_map(|&t| self.corners(t)).flatten().for_each(|p| bounds.include(p));
        bounds
    }

    /// Surface area, mm².
    pub fn area(&self) -> f64 {
        self.triangles
            .iter()
            .filter_map(|&t| self.corners(t))
            .map(|corners| {
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                0.5 * (b - a).cross(c - a).length()
            })
            .sum()
    }

    /// Signed volume, mm³: positive when the triangles face outward.
    pub fn volume(&self) -> f64 {
        self.moments().volume
    }

    /// Volume, centre of mass and inertia; none if the mesh encloses nothing (its volume is zero to rounding).
    ///
    /// **Source:** Tonon 2004, *Explicit exact formulas for the 3-D tetrahedron inertia tensor*: over a tetrahedron
    /// with one corner in the origin and the others a, b, c, ∫xᵢxⱼ = V/20·(aᵢaⱼ + bᵢbⱼ + cᵢcⱼ + sᵢsⱼ), s = a + b + c.
    pub fn mass(&self) -> Option<Mass> {
        let moments = self.moments();
        let noise = 1e-12 * self.area() * f64::from(self.bounds().size().max_element());
        if !moments.volume.is_finite() || moments.volume.abs() <= noise {
            return None;
        }
        let offset = moments.first / moments.volume;
        let second = moments.second - moments.volume * outer(offset, offset);
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        Some(Mass {
            volume: moments.volume,
            centre: moments.about + offset,
            inertia: DMat3::from_diagonal(DVec3::splat(trace)) - second,
        })
    }

    /// Vertices − edges + triangles, over the vertices in use: 2 per sphere-like part, 0 per torus-like one.
    /// Triangles with a repeated or missing vertex are not counted.
    pub fn euler_characteristic(&self) -> i64 {
        let mut used = vec![false; self.positions.len()];
        let (mut edges, mut sides, mut vertices) = (0, 0, 0);
        for edge in EdgeTable::new(self).iter() {
            edges += 1;
            sides += edge.halves.len() as i64;
            for v in edge.ends() {
                vertices += i64::from(!std::mem::replace(&mut used[v as usize], true));
            }
        }
        vertices - edges + sides / 3
    }

    fn moments(&self) -> Moments {
        let about = self.bounds().centre();
        let mut sum = Moments { about, volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
        for corners in self.triangles.iter().filter_map(|&t| self.corners(t)) {
            let [a, b, c] = corners.map(|p| p.as_dvec3() - about);
            let volume = a.dot(b.cross(c)) / 6.0;
            let s = a + b + c;
            sum.volume += volume;
            sum.first += s * (volume / 4.0);
            sum.second += (outer(a, a) + outer(b, b) + outer(c, c) + outer(s, s)) * (volume / 20.0);
        }
        sum
    }

    /// Moves every vertex by `offset`, mm.
    pub fn translate(&mut self, offset: Vec3) {
        for p in &mut self.positions {
            *p += offset;
        }
    }

    /// Scales about the origin. A negative factor mirrors, so it turns the triangles round as well.
    pub fn scale(&mut self, factor: f32) {
        for p in &mut self.positions {
            *p *= factor;
        }
        if factor < 0.0 {
            self.flip();
        }
    }

    /// Scales alike in all directions to `height` mm along z; the middle of the box's bottom stays where it is.
    /// Returns the factor, or none (and changes nothing) if the mesh is flat in z or `height` is not positive.
    pub fn fit_height(&mut self, height: f64) -> Option<f64> {
        let bounds = self.bounds();
        let present = f64::from(bounds.max.z) - f64::from(bounds.min.z);
        let factor = height / present;
        if !(present > 0.0 && height > 0.0 && factor.is_finite()) {
            return None;
        }
        let fixed = bounds.centre().with_z(f64::from(bounds.min.z));
        for p in &mut self.positions {
            *p = ((p.as_dvec3() - fixed) * factor + fixed).as_vec3();
        }
        Some(factor)
    }

    /// Lowers or lifts the mesh so that its lowest point is at z = 0. An empty mesh stays as it is.
    pub fn place_on_bed(&mut self) {
        let bounds = self.bounds();
        if !bounds.is_empty() {
            self.translate(Vec3::new(0.0, 0.0, -bounds.min.z));
        }
    }

    /// Turns every triangle round: inside becomes outside.
    pub fn flip(&mut self) {
        for t in &mut self.triangles {
            t.swap(1, 2);
        }
    }

    /// Adds another mesh's vertices and triangles behind this one's; nothing is welded.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i.saturating_add(first))));
    }
}

/// Integrals of 1, x and x xᵀ over the solid, with x measured from `about`.
struct Moments {
    about: DVec3,
    volume: f64,
    first: DVec3,
    second: DMat3,
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::{Quat, Vec3};

    use super::*;
    use crate::shapes::{cuboid, cylinder, ico_sphere, tetrahedron, torus, uv_sphere};

    fn close(a: f64, b: f64, relative: f64) -> bool {
        (a - b).abs() <= relative * b.abs()
    }

    #[test]
    fn a_box_weighs_what_the_textbook_says() {
        let mass = cuboid(Vec3::ZERO, Vec3::new(2.0, 4.0, 6.0)).mass().unwrap();
        assert_eq!(mass.volume, 48.0);
        assert!(mass.centre.abs_diff_eq(DVec3::new(1.0, 2.0, 3.0), 1e-12));
        let expected = DMat3::from_diagonal(DVec3::new(16.0 + 36.0, 4.0 + 36.0, 4.0 + 16.0) * 48.0 / 12.0);
        assert!(mass.inertia.abs_diff_eq(expected, 1e-10), "{}", mass.inertia);
    }

    #[test]
    fn a_box_turned_and_far_away_keeps_its_principal_inertia() {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.3);
        // Far enough to ruin products of coordinates, near enough that f32 positions still hold 1e-4 mm.
        let offset = Vec3::new(1024.0, -2048.0, 512.0);
        let mut mesh = cuboid(Vec3::new(-10.0, -20.0, -30.0), Vec3::new(10.0, 20.0, 30.0));
        for p in &mut mesh.positions {
            *p = turn * *p + offset;
        }
        let mass = mesh.mass().unwrap();
        assert!(close(mass.volume, 48_000.0, 1e-5), "{}", mass.volume);
        assert!(mass.centre.abs_diff_eq(offset.as_dvec3(), 1e-3), "{}", mass.centre);
        let back = DMat3::from_quat(turn.as_dquat());
        let principal = back.transpose() * mass.inertia * back;
        let expected = DVec3::new(5200.0, 4000.0, 2000.0) * 48_000.0 / 12.0;
        let scale = expected.x;
        assert!(principal.abs_diff_eq(DMat3::from_diagonal(expected), 2e-5 * scale), "{principal}");
    }

    #[test]
    fn a_tetrahedron_has_the_volume_and_centre_of_its_corners() {
        let corners =
            [Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0), Vec3::new(0.0, 0.0, 5.0)];
        let mass = tetrahedron(corners).mass().unwrap();
        assert!(close(mass.volume, 10.0, 1e-12));
        assert!(mass.centre.abs_diff_eq(DVec3::new(0.75, 1.0, 1.25), 1e-12));
        // ∫x² over the corner tetrahedron is V·a²/10, so about the centroid V·a²·(1/10 − 1/16).
        let spread = DVec3::new(9.0, 16.0, 25.0) * 10.0 * (0.1 - 0.0625);
        assert!(close(mass.inertia.x_axis.x, spread.y + spread.z, 1e-12));
    }

    #[test]
    fn round_shapes_converge_to_their_closed_forms() {
        let centre = Vec3::new(3.0, -4.0, 5.0);
        for (mesh, volume, area) in [
            (uv_sphere(centre, 2.0, 128, 64), PI * 32.0 / 3.0, PI * 16.0),
            (ico_sphere(centre, 2.0, 5), PI * 32.0 / 3.0, PI * 16.0),
            (torus(centre, 5.0, 2.0, 192, 96), 2.0 * PI * PI * 5.0 * 4.0, 4.0 * PI * PI * 10.0),
            (cylinder(centre, 2.0, 3.0, 192), PI * 12.0, PI * 20.0),
        ] {
            assert!(close(mesh.volume(), volume, 2e-3), "{} for {volume}", mesh.volume());
            assert!(close(mesh.area(), area, 2e-3), "{} for {area}", mesh.area());
        }
        let error = |n| 1.0 - uv_sphere(Vec3::ZERO, 1.0, 2 * n, n).volume() / (PI * 4.0 / 3.0);
        let order = (error(16) / error(32)).log2();
        assert!((1.9..2.1).contains(&order), "convergence order {order}");
        let ball = ico_sphere(centre, 2.0, 5).mass().unwrap();
        assert!(close(ball.inertia.z_axis.z, 0.4 * 4.0 * ball.volume, 2e-3));
    }

    #[test]
    fn a_void_is_subtracted_and_a_torus_has_no_euler_characteristic() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::splat(4.0));
        let mut void = cuboid(Vec3::ONE, Vec3::splat(3.0));
        void.flip();
        mesh.append(&void);
        assert!(close(mesh.volume(), 56.0, 1e-14));
        assert_eq!(mesh.euler_characteristic(), 4);
        assert_eq!(torus(Vec3::ZERO, 5.0, 2.0, 16, 8).euler_characteristic(), 0);
    }

    #[test]
    fn open_flat_and_broken_meshes_have_no_mass_but_do_not_panic() {
        assert_eq!(Mesh::default().mass(), None);
        assert_eq!(Mesh::default().bounds(), Bounds::EMPTY);
        let sheet =
            Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2], [0, 1, 7]] };
        assert_eq!(sheet.mass(), None);
        assert_eq!(sheet.area(), 0.5);
        let nan = Mesh { positions: vec![Vec3::NAN, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
        assert_eq!(nan.mass(), None);
    }

    #[test]
    fn fitting_a_height_scales_about_the_middle_of_the_bottom() {
        let mut mesh = cuboid(Vec3::new(2.0, 2.0, 5.0), Vec3::new(4.0, 6.0, 9.0));
        assert_eq!(mesh.fit_height(8.0), Some(2.0));
        let bounds = mesh.bounds();
        assert_eq!((bounds.min, bounds.max), (Vec3::new(1.0, 0.0, 5.0), Vec3::new(5.0, 8.0, 13.0)));
        mesh.place_on_bed();
        assert_eq!(mesh.bounds().min.z, 0.0);
        assert_eq!(mesh.fit_height(f64::NAN), None);
        assert_eq!(mesh.fit_height(-1.0), None);
    }

    #[test]
    fn mirroring_by_a_negative_scale_keeps_the_volume_positive() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.scale(-2.0);
        assert_eq!(mesh.volume(), 8.0);
    }
}
