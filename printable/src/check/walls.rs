//! How thick walls are, by sampled rays.

use glam::{DVec3, Vec3};
use mesh::{Bvh, Mesh};
use rayon::prelude::*;

/// Rays that are sent.
const RAYS: usize = 4000;
/// Rays begin this far below the surface, mm, so that they do not meet where they come from.
const BELOW: f64 = 1e-3;
/// Two walls face each other if their normals differ from opposite by less than this: the cosine of 41°. Rays that
/// meet the other side of a sharp edge or a needle's tip say nothing of a wall, and rims of 45° are common in shapes
/// that print without supports.
const FACING: f64 = 0.75;
/// The plastic number's inverses, which spread points evenly over a square.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Thickness of the walls where rays through them meet a facing wall. Sampled: a thin place smaller than one part in
/// 4000 of the surface can be missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls {
    /// Rays that met a facing wall.
    pub samples: usize,
    /// The thinnest wall that was met, mm, from its outer side.
    pub thinnest: f64,
    /// Where that was, mm.
    pub place: DVec3,
    /// One in a hundred rays met a wall no thicker than this, mm.
    pub percentile_1: f64,
    /// Half of them met a wall no thicker than this, mm.
    pub median: f64,
    /// The share of rays that met a wall thinner than asked for.
    pub thin_share: f64,
}

/// Sends rays inward from points spread evenly over the surface; none if no ray meets a facing wall.
///
/// The points follow from the mesh alone, so the same mesh gives the same figures.
pub(super) fn walls(mesh: &Mesh, thin_mm: f64) -> Option<Walls> {
    let mut met: Vec<(f64, DVec3)> = {
        let bvh = Bvh::new(mesh);
        let points = spread(mesh);
        points.into_par_iter().filter_map(|point| cast(mesh, &bvh, point)).collect()
    };
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(thinnest, place) = met.first()?;
    let at = |share: f64| met[((met.len() - 1) as f64 * share) as usize].0;
    let thin = met.partition_point(|&(thickness, _)| thickness < thin_mm);
    Some(Walls {
        samples: met.len(),
        thinnest,
        place,
        percentile_1: at(0.01),
        median: at(0.5),
        thin_share: thin as f64 / met.len() as f64,
    })
}

/// A place on the surface and the direction outward.
type Start = (DVec3, DVec3);

/// Evenly spread places: the area, laid out triangle by triangle, is stepped along, and within triangles a sequence
/// without clusters is followed.
fn spread(mesh: &Mesh) -> Vec<Start> {
    let sign = if mesh.volume() < 0.0 { -1.0 } else { 1.0 };
    let faces: Vec<[DVec3; 4]> = mesh
        .triangles
        .iter()
        .filter_map(|&t| mesh.corners(t))
        .map(|corners| {
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            [a, b, c, (b - a).cross(c - a) * sign]
        })
        .filter(|[.., normal]| normal.is_finite() && *normal != DVec3::ZERO)
        .collect();
    let step = faces.iter().map(|[.., normal]| normal.length()).sum::<f64>() / RAYS as f64;
    let (mut starts, mut passed) = (Vec::with_capacity(RAYS), 0.5 * step);
    for &[a, b, c, normal] in &faces {
        let size = normal.length();
        while passed < size && starts.len() < RAYS {
            let [mut u, mut v] = SPREAD.map(|share| (starts.len() as f64 * share).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            starts.push((a + (b - a) * u + (c - a) * v, normal / size));
            passed += step;
        }
        passed -= size;
    }
    starts
}

/// How thick the wall below a place is, if a facing wall is on its other side.
fn cast(mesh: &Mesh, bvh: &Bvh, (place, outward): Start) -> Option<(f64, DVec3)> {
    let hit = bvh.ray_cast((place - outward * BELOW).as_vec3(), -outward.as_vec3(), f64::INFINITY)?;
    let [a, b, c] = mesh.corners(mesh.triangles[hit.triangle as usize])?.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    (normal.dot(outward).abs() > FACING && !hit.front).then_some((hit.t + BELOW, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::{cuboid, ico_sphere};

    #[test]
    fn walls_of_plates_and_shells_are_as_thick_as_they_were_made() {
        let plate = walls(&cuboid(Vec3::ZERO, Vec3::new(40.0, 30.0, 0.6)), 0.8).expect("has walls");
        assert!((plate.thinnest - 0.6).abs() < 1e-5 && (plate.median - 0.6).abs() < 1e-5, "{plate:?}");
        assert!(plate.thin_share > 0.9);
        let mut shell = ico_sphere(Vec3::ZERO, 10.0, 4);
        let mut void = ico_sphere(Vec3::ZERO, 8.5, 4);
        void.flip();
        shell.append(&void);
        let shell = walls(&shell, 0.8).expect("has walls");
        assert!((shell.percentile_1 - 1.5).abs() < 0.02, "{shell:?}");
        assert_eq!(shell.thin_share, 0.0);
    }

    #[test]
    fn meshes_without_walls_have_none() {
        let sheet = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
        let point = Mesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]] };
        for mesh in [Mesh::default(), sheet, point] {
            assert_eq!(walls(&mesh, 0.4), None);
        }
    }
}
