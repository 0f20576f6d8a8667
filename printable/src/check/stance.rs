//! How a part stands on the bed.

use crate::slices::{SliceError, clip, slice_at};
use glam::{DVec2, DVec3};
use mesh::{Mass, Mesh};

/// How a part stands: its contact with the bed and where its weight is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stance {
    /// The middle of the part's box, on the bed, mm.
    pub foot: DVec3,
    /// Area of the part just above the bed, mm².
    pub contact: f64,
    /// Area of the convex hull of all contact, the support polygon, mm².
    pub base: f64,
    /// Centre of mass, mm, with inner voids empty; none if the mesh encloses nothing.
    pub centre: Option<DVec3>,
    /// How far inside the support polygon the centre of mass projects, mm; negative if outside. None without a
    /// support polygon or a centre of mass.
    pub margin: Option<f64>,
    /// The smallest tilt that topples the part, radians; negative if it falls over by itself.
    pub topple: Option<f64>,
}

/// How a part stands on a bed at `bottom`: contact is whatever is no higher above it than `contact_mm`.
///
/// Errors: a mesh that cannot be sliced.
pub(super) fn stance(mesh: &Mesh, bottom: f64, contact_mm: f64) -> Result<Stance, SliceError> {
    let height = bottom + contact_mm;
    let (grid, layer) = slice_at(mesh, height)?;
    let outlines = layer.regions.iter().flatten().flatten().map(|&p| grid.place(p));
    let low = mesh.triangles.iter().filter_map(|&t| mesh.corners(t)).flatten();
    let low = low.filter(|p| f64::from(p.z) <= height).map(|p| p.truncate().as_dvec2());
    let hull = convex_hull(outlines.chain(low).collect());
    let centre = mesh.mass().map(|Mass { centre, .. }| centre);
    let margin = centre.and_then(|centre| margin(&hull, centre.truncate()));
    let lever = centre.map(|centre| centre.z - bottom).filter(|&lever| lever > 0.0);
    Ok(Stance {
        foot: mesh.bounds().centre().with_z(bottom),
        contact: grid.square_mm(clip::total(&layer.regions)),
        base: area(&hull),
        centre,
        margin,
        topple: margin.zip(lever).map(|(margin, lever)| margin.atan2(lever)),
    })
}

/// The corners of the convex hull, counter-clockwise. **Source:** Andrew's monotone chain.
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

/// The sides of a polygon.
fn sides(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

fn area(polygon: &[DVec2]) -> f64 {
    let about = polygon.first().copied().unwrap_or_default();
    0.5 * sides(polygon).map(|(a, b)| (a - about).perp_dot(b - about)).sum::<f64>()
}

/// Distance from `p` to the outline of a convex polygon; negative outside. None if it has no area.
fn margin(hull: &[DVec2], p: DVec2) -> Option<f64> {
    if hull.len() < 3 || area(hull) <= 0.0 {
        return None;
    }
    let inside = sides(hull).all(|(a, b)| (b - a).perp_dot(p - a) >= 0.0);
    let to_side = |(a, b): (DVec2, DVec2)| {
        let along = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
        p.distance(a.lerp(b, along))
    };
    let nearest = sides(hull).map(to_side).fold(f64::INFINITY, f64::min);
    Some(if inside { nearest } else { -nearest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use mesh::shapes::cuboid;

    #[test]
    fn a_block_topples_about_its_nearest_edge() {
        let block = cuboid(Vec3::new(1.0, 2.0, 0.0), Vec3::new(5.0, 12.0, 20.0));
        let stance = stance(&block, 0.0, 0.05).expect("sound");
        assert!((stance.contact - 40.0).abs() < 1e-6 && (stance.base - 40.0).abs() < 1e-6, "{stance:?}");
        assert!((stance.margin.expect("stands") - 2.0).abs() < 1e-9);
        assert!((stance.topple.expect("stands") - 0.2f64.atan()).abs() < 1e-9);
    }

    #[test]
    fn a_part_whose_weight_is_beside_its_foot_falls_over() {
        let mut part = cuboid(Vec3::ZERO, Vec3::splat(2.0));
        part.append(&cuboid(Vec3::new(0.0, 0.0, 2.0), Vec3::new(20.0, 2.0, 4.0)));
        let stance = stance(&part, 0.0, 0.05).expect("sound");
        let centre = (8.0 * 1.0 + 80.0 * 10.0) / 88.0;
        assert!((stance.margin.expect("has a foot") + centre - 2.0).abs() < 1e-9, "{stance:?}");
        assert!(stance.topple.expect("has a foot") < 0.0);
    }

    #[test]
    fn hulls_of_few_or_collinear_points_have_no_inside() {
        let on_a_line = (0..9).map(|i| DVec2::splat(f64::from(i))).collect();
        for points in [vec![], vec![DVec2::ONE], vec![DVec2::ZERO, DVec2::ONE], on_a_line] {
            let hull = convex_hull(points);
            assert_eq!(margin(&hull, DVec2::ZERO), None, "{hull:?}");
        }
    }
}
