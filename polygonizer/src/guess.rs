//! Where a feature might be, from the planes that meet there.

use blobtree::Aabb;
use glam::Vec3;

use crate::qef::{Meeting, Plane};

/// Normals with a smaller dot product belong to different faces: 11.5° apart. Rounding off an edge that
/// turns less moves the surface by less than half a cell times the tangent of half the turn, 0.05 cell.
pub(crate) const SAME_FACE: f32 = 0.98;

/// How far outside its box a feature may be, in cells, to be moved to the box instead of left out.
pub(crate) const SLACK: f32 = 0.006;

/// Where a feature might be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guess {
    pub candidate: usize,
    /// In the box that it may be in.
    pub point: Vec3,
    /// Where the planes meet, which may be a slack outside that box.
    pub meeting: Vec3,
    pub rank: u8,
    /// Direction of the edge, for rank 2.
    pub free: Vec3,
    /// Smallest dot product of the normals that meet.
    pub turn: f32,
    /// Estimated distance from the surface, mm.
    pub off: f32,
    /// Whether it is the edge of two faces where the cell sees more.
    pub is_part: bool,
}

impl Guess {
    /// The meeting if it is a feature inside `allowed`, an edge moved along itself to get there.
    pub fn new(candidate: usize, meeting: Meeting, allowed: &Aabb, turn: f32) -> Option<Self> {
        let Meeting { point: mut meeting, rank, free } = meeting;
        if rank < 2 {
            return None;
        }
        let slack = SLACK * allowed.size().min_element();
        if meeting.distance(meeting.clamp(allowed.min, allowed.max)) > slack {
            if rank == 3 {
                return None;
            }
            let [low, high] = clip(meeting, free, allowed)?;
            meeting += free * 0.0_f32.clamp(low, high);
        }
        let point = meeting.clamp(allowed.min, allowed.max);
        let off = f32::INFINITY;
        Some(Self { candidate, point, meeting, rank, free, turn, off, is_part: false })
    }
}

impl Guess {
    /// Moves an edge's point along the edge to where that is nearest to `old`.
    pub fn keep_along_edge(&mut self, old: Vec3, allowed: &Aabb) {
        let along = (old - self.point).dot(self.free);
        let reach = clip(self.point, self.free, allowed).filter(|_| self.rank == 2);
        if let Some([low, high]) = reach {
            self.meeting += self.free * along.clamp(low, high);
            self.point = self.meeting.clamp(allowed.min, allowed.max);
        }
    }
}

/// The smallest dot product of any two of the planes' normals. Planes without a normal, from where the field has no
/// gradient, say nothing.
pub(crate) fn turn(planes: &[Plane]) -> f32 {
    let mut least = 1.0_f32;
    for (i, a) in planes.iter().enumerate().filter(|(_, plane)| plane.normal != Vec3::ZERO) {
        for b in planes[i + 1..].iter().filter(|plane| plane.normal != Vec3::ZERO) {
            least = least.min(a.normal.dot(b.normal));
        }
    }
    least
}

/// The planes joined to one for each direction, at most six.
pub(crate) fn faces_of(planes: &[Plane]) -> Vec<Plane> {
    let mut faces: Vec<(Plane, Plane, f32)> = Vec::new();
    for plane in planes.iter().filter(|plane| plane.normal != Vec3::ZERO) {
        match faces.iter().position(|(first, ..)| first.normal.dot(plane.normal) > SAME_FACE) {
            Some(i) => {
                let (_, sum, count) = &mut faces[i];
                sum.point += plane.point;
                sum.normal += plane.normal;
                *count += 1.0;
            }
            None if faces.len() < 6 => faces.push((*plane, *plane, 1.0)),
            None => {}
        }
    }
    faces
        .into_iter()
        .map(|(_, sum, count)| Plane { point: sum.point / count, normal: sum.normal.normalize_or_zero() })
        .collect()
}

/// The range of `t` in which `point + t · direction` is in `allowed`; `None` if it never is.
pub(crate) fn clip(point: Vec3, direction: Vec3, allowed: &Aabb) -> Option<[f32; 2]> {
    let mut range = [f32::NEG_INFINITY, f32::INFINITY];
    for axis in 0..3 {
        if direction[axis].abs() < 1e-6 {
            if !(allowed.min[axis]..=allowed.max[axis]).contains(&point[axis]) {
                return None;
            }
            continue;
        }
        let a = (allowed.min[axis] - point[axis]) / direction[axis];
        let b = (allowed.max[axis] - point[axis]) / direction[axis];
        range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    }
    (range[0] <= range[1] && range[0].is_finite() && range[1].is_finite()).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_without_a_normal_are_no_faces_and_turn_nothing() {
        let plane = |normal| Plane { point: Vec3::ZERO, normal };
        let flat = [plane(Vec3::Z), plane(Vec3::ZERO), plane(Vec3::Z)];
        assert_eq!((turn(&flat), faces_of(&flat).len()), (1.0, 1));
        let edge = [plane(Vec3::Z), plane(Vec3::ZERO), plane(Vec3::X)];
        assert_eq!((turn(&edge), faces_of(&edge).len()), (0.0, 2));
    }
}
