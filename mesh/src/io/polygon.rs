//! Faces of any number of corners, cut into triangles.

use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};

use super::builder::{MeshBuilder, check};
use super::{Notice, Place, ReadError};

/// Point-in-triangle tests that one file may cost, a fraction of a second. Real models need a few for every
/// concave face; only a file made to be slow passes this, and its polygons are then cut into fans.
const BUDGET: u64 = 30_000_000;

/// Most corners of one face.
const MAX_CORNERS: u64 = 100_000;

/// Refuses faces without a surface, and those of absurd length.
pub(super) fn check_corners(count: u64, place: impl FnOnce() -> Place) -> Result<(), ReadError> {
    if count >= 3 {
        return check(count, MAX_CORNERS, "corners of one face", place);
    }
    let (found, expected) = (format!("a face with {count} corners"), "at least 3".to_owned());
    Err(ReadError::Malformed { place: place(), found, expected })
}

/// Takes the faces of an OBJ or PLY file: checks their indices, cuts them, hands the triangles on.
pub(super) struct Faces {
    /// The number a format gives its first vertex, 0 or 1.
    first_index: u32,
    budget: u64,
    fanned: u64,
    first_fanned: Option<Place>,
    /// The highest index so far; faces may come before their vertices.
    highest: Option<(u32, Place)>,
    flat: Vec<DVec2>,
}

impl Faces {
    pub(super) fn new(first_index: u32) -> Self {
        Self { first_index, budget: BUDGET, fanned: 0, first_fanned: None, highest: None, flat: Vec::new() }
    }

    /// Adds a face of at least three corners ([`check_corners`]), counted from 0.
    ///
    /// Convex faces become fans, others are cut ear by ear. Corners beyond the vertices read so far are taken
    /// on trust until [`Self::finish`], and their face is cut into a fan.
    pub(super) fn add(
        &mut self,
        builder: &mut MeshBuilder,
        corners: &[u32],
        place: Place,
    ) -> Result<(), ReadError> {
        let Some(&top) = corners.iter().max() else {
            return Ok(());
        };
        if self.highest.as_ref().is_none_or(|&(highest, _)| top > highest) {
            self.highest = Some((top, place.clone()));
        }
        if let [a, b, c] = *corners {
            return builder.triangle([a, b, c], || place);
        }
        let known = self.flatten(corners, &builder.mesh.positions);
        if known && is_strictly_convex(&self.flat) {
            return fan(builder, corners, &place);
        }
        if !known || !self.clip_ears(builder, corners, &place)? {
            self.fanned += 1;
            self.first_fanned.get_or_insert(place);
        }
        Ok(())
    }

    /// Checks that every index was in range, and adds what there is to tell. To be called after the last vertex.
    pub(super) fn finish(self, vertices: usize, notices: &mut Vec<Notice>) -> Result<(), ReadError> {
        if let Some((index, place)) = self.highest
            && index as usize >= vertices
        {
            let first = self.first_index.into();
            let index = i64::from(index) + i64::from(self.first_index);
            return Err(ReadError::IndexOutOfRange { place, index, vertices: vertices as u64, first });
        }
        if let Some(first) = self.first_fanned {
            notices.push(Notice::FannedPolygons { count: self.fanned, first });
        }
        Ok(())
    }

    /// Lays the corners into a plane, counter-clockwise; false if one of them is not known yet.
    fn flatten(&mut self, corners: &[u32], positions: &[Vec3]) -> bool {
        self.flat.clear();
        let point = |index: u32| positions.get(index as usize).map(|p| p.as_dvec3());
        // Newell's normal: twice the area seen along each axis.
        let mut normal = DVec3::ZERO;
        for (i, &corner) in corners.iter().enumerate() {
            let (Some(a), Some(b)) = (point(corner), point(corners[(i + 1) % corners.len()])) else {
                return false;
            };
            normal += (a - b).yzx() * (a + b).zxy();
        }
        let size = normal.abs();
        let (u, v, facing) = if size.x >= size.y && size.x >= size.z {
            (1, 2, normal.x)
        } else if size.y >= size.z {
            (2, 0, normal.y)
        } else {
            (0, 1, normal.z)
        };
        let sides = if facing < 0.0 { (v, u) } else { (u, v) };
        self.flat.extend(
            corners.iter().filter_map(|&index| point(index)).map(|p| DVec2::new(p[sides.0], p[sides.1])),
        );
        true
    }

    /// Cuts off ears until a triangle is left; whatever has no ear, or costs too much, is cut into a fan, and
    /// that is told by `false`.
    fn clip_ears(
        &mut self,
        builder: &mut MeshBuilder,
        corners: &[u32],
        place: &Place,
    ) -> Result<bool, ReadError> {
        let mut ring: Vec<usize> = (0..corners.len()).collect();
        let mut at = 0;
        let mut tried = 0;
        while ring.len() > 3 && tried < ring.len() && self.budget >= ring.len() as u64 {
            self.budget -= ring.len() as u64;
            let count = ring.len();
            let [before, here, after] =
                [(at + count - 1) % count, at % count, (at + 1) % count].map(|i| ring[i]);
            if is_ear(&self.flat, &ring, [before, here, after]) {
                builder.triangle([before, here, after].map(|i| corners[i]), || place.clone())?;
                ring.remove(at % count);
                tried = 0;
            } else {
                tried += 1;
                at += 1;
            }
            at %= ring.len();
        }
        let rest: Vec<u32> = ring.iter().map(|&i| corners[i]).collect();
        fan(builder, &rest, place)?;
        Ok(rest.len() == 3)
    }
}

fn fan(builder: &mut MeshBuilder, corners: &[u32], place: &Place) -> Result<(), ReadError> {
    corners
        .windows(2)
        .skip(1)
        .try_for_each(|pair| builder.triangle([corners[0], pair[0], pair[1]], || place.clone()))
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

fn is_strictly_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    (0..count).all(|i| turn(flat[i], flat[(i + 1) % count], flat[(i + 2) % count]) > 0.0)
}

/// Whether the triangle turns left and holds no other corner (corners in the same place do not count).
fn is_ear(flat: &[DVec2], ring: &[usize], [before, here, after]: [usize; 3]) -> bool {
    let (a, b, c) = (flat[before], flat[here], flat[after]);
    let holds = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    turn(a, b, c) > 0.0 && !ring.iter().map(|&i| flat[i]).any(|p| p != a && p != b && p != c && holds(p))
}

#[cfg(test)]
mod tests {
    use super::super::ReadLimits;
    use super::*;

    fn cut(points: &[[f32; 3]]) -> (Vec<[u32; 3]>, Vec<Notice>) {
        let mut builder = MeshBuilder::new(&ReadLimits::default());
        builder.mesh.positions = points.iter().map(|&p| Vec3::from(p)).collect();
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        let mut faces = Faces::new(0);
        faces.add(&mut builder, &corners, Place::File).expect("indices are in range");
        let mut notices = Vec::new();
        faces.finish(points.len(), &mut notices).expect("indices are in range");
        (builder.mesh.triangles, notices)
    }

    #[test]
    fn concave_polygons_are_cut_into_triangles_that_all_face_the_same_way_and_cover_the_area() {
        // An L of area 3 in each of the three planes, both ways round.
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for axis in 0..3 {
            for backwards in [false, true] {
                let mut points: Vec<[f32; 3]> = l
                    .iter()
                    .map(|&[u, v]| {
                        let mut p = [0.0; 3];
                        (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v);
                        p
                    })
                    .collect();
                if backwards {
                    points.reverse();
                }
                let (triangles, notices) = cut(&points);
                assert_eq!((triangles.len(), notices.len()), (4, 0));
                let areas = triangles.iter().map(|t| {
                    let [a, b, c] = t.map(|i| Vec3::from(points[i as usize]));
                    (b - a).cross(c - a)[axis] / 2.0
                });
                let sign = if backwards { -1.0 } else { 1.0 };
                assert!(areas.clone().all(|area| area * sign > 0.0), "axis {axis}: a triangle is flipped");
                assert_eq!(areas.sum::<f32>(), 3.0 * sign);
            }
        }
    }

    #[test]
    fn a_polygon_without_area_becomes_a_fan_and_is_reported() {
        let (triangles, notices) = cut(&[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [3., 0., 0.]]);
        assert_eq!(triangles.len(), 2);
        assert_eq!(notices, [Notice::FannedPolygons { count: 1, first: Place::File }]);
    }
}
