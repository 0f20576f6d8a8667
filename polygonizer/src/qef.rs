//! The point nearest to a set of planes, and how well they fix it.
//!
//! **Source:** Kobbelt et al. 2001, *Feature sensitive surface extraction*; Ju et al. 2002, *Dual contouring
//! of Hermite data*, for the pseudo-inverse around the mass point.

use glam::{DVec3, Vec3};

/// A plane through `point` with unit `normal`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub point: Vec3,
    pub normal: Vec3,
}

/// Eigenvalues below this share of the largest do not count. Two equally seen planes that meet at 11.5°
/// (dot product 0.98) have a share of 0.010, one plane in four of them 0.0075; a curved face that turns by
/// 6° within a cell, which must not count, 0.003.
const SMALLEST_SHARE: f64 = 0.005;

/// What a set of planes has in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// Least squares point: of all that fit equally well the one nearest to the mean of the
    /// planes' points.
    pub point: Vec3,
    /// 1: one plane; 2: they meet in a line along `free`; 3: in a point.
    pub rank: u8,
    /// Unit direction in which the point is fixed least.
    pub free: Vec3,
}

/// Where `planes` meet; `None` if there are none or a number is not finite.
pub(crate) fn meet(planes: &[Plane]) -> Option<Meeting> {
    let mass_point = planes.iter().map(|p| p.point.as_dvec3()).sum::<DVec3>() / planes.len() as f64;
    let mut normal_matrix = [[0.0; 3]; 3];
    let mut right = DVec3::ZERO;
    for plane in planes {
        let normal = plane.normal.as_dvec3();
        right += normal * normal.dot(plane.point.as_dvec3() - mass_point);
        for (row, n) in normal_matrix.iter_mut().zip(normal.to_array()) {
            for (entry, m) in row.iter_mut().zip(normal.to_array()) {
                *entry += n * m;
            }
        }
    }
    if !(mass_point + right).is_finite() {
        return None;
    }
    let (values, vectors) = eigen(normal_matrix);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let rank = order.iter().filter(|&&i| values[i] > SMALLEST_SHARE * values[order[0]]).count();
    let offset: DVec3 = order[..rank].iter().map(|&i| vectors[i] * (vectors[i].dot(right) / values[i])).sum();
    let free = vectors[order[2]].as_vec3();
    Some(Meeting { point: (mass_point + offset).as_vec3(), rank: rank as u8, free })
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [DVec3; 3]) {
    let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
    // Convergence is quadratic: four sweeps reach rounding from any start, the rest is margin.
    for _ in 0..8 {
        let off_diagonal = a[0][1].powi(2) + a[0][2].powi(2) + a[1][2].powi(2);
        let diagonal = a[0][0].powi(2) + a[1][1].powi(2) + a[2][2].powi(2);
        if off_diagonal <= 1e-24 * diagonal {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = (tangent * tangent + 1.0).sqrt().recip();
            let sin = tangent * cos;
            let r = 3 - p - q;
            let (app, aqq, apq, arp, arq) = (a[p][p], a[q][q], a[p][q], a[r][p], a[r][q]);
            a[p][p] = app - tangent * apq;
            a[q][q] = aqq + tangent * apq;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            (a[r][p], a[r][q]) = (cos * arp - sin * arq, sin * arp + cos * arq);
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
            (vectors[p], vectors[q]) =
                (vectors[p] * cos - vectors[q] * sin, vectors[p] * sin + vectors[q] * cos);
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(point: [f32; 3], normal: [f32; 3]) -> Plane {
        Plane { point: point.into(), normal: Vec3::from(normal).normalize_or_zero() }
    }

    #[test]
    fn three_planes_meet_in_their_corner() {
        let corner = Vec3::new(0.3, -2.0, 5.0);
        let normals = [[1.0, 0.2, 0.0], [0.0, 1.0, 0.3], [0.1, 0.0, 1.0]];
        let planes: Vec<_> = normals
            .iter()
            .map(|&n| {
                let along = Vec3::from(n).any_orthogonal_vector();
                plane((corner + along).to_array(), n)
            })
            .collect();
        let meeting = meet(&planes).expect("finite");
        assert_eq!(meeting.rank, 3);
        assert!(meeting.point.distance(corner) < 1e-5, "{meeting:?}");
    }

    #[test]
    fn two_planes_meet_in_a_line_at_the_point_nearest_to_the_mass_point() {
        let planes = [plane([1.0, 0.0, 4.0], [0.0, 1.0, 0.0]), plane([0.0, 1.0, 2.0], [1.0, 0.0, 0.0])];
        let meeting = meet(&planes).expect("finite");
        assert_eq!(meeting.rank, 2);
        assert!(meeting.point.distance(Vec3::new(0.0, 0.0, 3.0)) < 1e-6);
        assert!(meeting.free.z.abs() > 0.999_999);
    }

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let matrix = [[4.0, -1.0, 0.5], [-1.0, 2.0, 3.0], [0.5, 3.0, 1.0]];
        let (values, vectors) = eigen(matrix);
        for row in 0..3 {
            for column in 0..3 {
                let sum: f64 = (0..3).map(|i| values[i] * vectors[i][row] * vectors[i][column]).sum();
                assert!((sum - matrix[row][column]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn no_planes_and_broken_planes_meet_nowhere() {
        assert!(meet(&[]).is_none());
        assert!(meet(&[plane([f32::NAN, 0.0, 0.0], [1.0, 0.0, 0.0])]).is_none());
    }
}
