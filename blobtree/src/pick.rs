//! From a ray to the surface, and from there to the primitive that made it.

use crate::eval::Tree;
use crate::explain::explain_in;
use crate::field::{Aabb, Field, ISO, Sampler};
use crate::node::{NodePath, NodeRef, Shape};
use glam::Vec3;

/// Where a ray meets a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The place on the surface, mm.
    pub point: Vec3,
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// Unit normal, outwards; 0 where the gradient vanishes.
    pub normal: Vec3,
}

/// What a user means who taps on a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// The place on the surface.
    pub hit: Hit,
    /// The primitives that make the surface there, and the support-free nodes that cut or grew it, with their shares
    /// in the field, the largest first. The
    /// first is meant; further taps at the same place cycle through the rest, [`NodePath::parent`] walks up.
    /// Inside a hole it is the part that was taken away.
    pub contributors: Vec<(NodePath, f32)>,
}

/// Samples of a stretch of the ray that is no longer divided.
const STEPS: usize = 16;

/// Stretches looked at before a ray gives up; one that grazes a rough surface may need many.
const MOST_STRETCHES: usize = 20_000;

/// The first place where the ray enters the solid; its origin if that lies inside.
///
/// Interval bounds skip what the ray cannot meet there, so nothing thicker than 1/16 of `resolution` mm is
/// missed. `None` without a meeting, or for a ray that is not finite.
pub fn cast_ray(field: &dyn Field, origin: Vec3, direction: Vec3, resolution: f32) -> Option<Hit> {
    let (from, to) = clipped(&field.support(), origin, direction)?;
    let at = |t: f32| origin + direction * t;
    let shortest = resolution.max(1e-4) / direction.length();
    let mut sampler = field.sampler();
    let mut stretches = vec![(from, to)];
    for _ in 0..MOST_STRETCHES {
        let (from, to) = stretches.pop()?;
        let region = Aabb::from_corners(at(from), at(to)).grown(1e-5 * at(to).abs().max_element());
        let bound = sampler.enter(region);
        let found = match bound {
            _ if bound.hi < ISO => None,
            _ if bound.lo >= ISO => Some(from),
            _ if to - from <= shortest => first_inside(&mut *sampler, &at, from, to),
            _ => {
                let middle = 0.5 * (from + to);
                // The nearer half is looked at first.
                stretches.extend([(middle, to), (from, middle)]);
                None
            }
        };
        sampler.leave();
        if let Some(t) = found {
            let gradient = field.sample(at(t)).gradient;
            return Some(Hit { point: at(t), t, normal: -gradient.normalize_or_zero() });
        }
    }
    None
}

/// The stretch of the ray in the box.
fn clipped(region: &Aabb, origin: Vec3, direction: Vec3) -> Option<(f32, f32)> {
    if !origin.is_finite() || !direction.is_finite() || direction.length() < 1e-12 || region.is_empty() {
        return None;
    }
    let (mut from, mut to) = (0.0f32, f32::MAX);
    for a in 0..3 {
        if direction[a] == 0.0 {
            if origin[a] < region.min[a] || origin[a] > region.max[a] {
                return None;
            }
            continue;
        }
        let ends = [(region.min[a] - origin[a]) / direction[a], (region.max[a] - origin[a]) / direction[a]];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from <= to).then_some((from, to))
}

/// Looks at a short stretch step by step, and closes in on where it enters the solid.
fn first_inside(sampler: &mut dyn Sampler, at: &dyn Fn(f32) -> Vec3, from: f32, to: f32) -> Option<f32> {
    let step = |i: usize| from + (to - from) * i as f32 / STEPS as f32;
    let points: [Vec3; STEPS + 1] = std::array::from_fn(|i| at(step(i)));
    let mut values = [0.0; STEPS + 1];
    sampler.values(&points, &mut values);
    let inside = values.iter().position(|value| *value >= ISO)?;
    if inside == 0 {
        return Some(from);
    }
    let (mut outside, mut inside) = (step(inside - 1), step(inside));
    for _ in 0..24 {
        let middle = 0.5 * (outside + inside);
        let mut value = [0.0];
        sampler.values(&[at(middle)], &mut value);
        if value[0] >= ISO { inside = middle } else { outside = middle }
    }
    Some(inside)
}

/// What lies under the pen: the first surface along the ray, and the primitives that made it.
///
/// `tree` is `root`, compiled. Cost: a ray, and an explanation of one place.
pub fn pick(root: &NodeRef, tree: &Tree, origin: Vec3, direction: Vec3) -> Option<Pick> {
    let resolution = tree.support().size().max_element() / 1024.0;
    let hit = cast_ray(tree, origin, direction, resolution)?;
    let parts = explain_in(tree, root, hit.point);
    let decides = |path: &NodePath| {
        path.find(root).is_some_and(|node| match &node.shape {
            Shape::Primitive(_) => true,
            Shape::SupportFree(..) => {
                parts.iter().all(|part| part.path != path.child(0) || part.share == 0.0)
            }
            _ => false,
        })
    };
    let mut contributors: Vec<(NodePath, f32)> = parts
        .iter()
        .filter(|part| part.share > 1e-3 && decides(&part.path))
        .map(|part| (part.path.clone(), part.share))
        .collect();
    contributors.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    Some(Pick { hit, contributors })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{Build, blend, cuboid, cylinder, point};

    fn picked(root: &NodeRef, origin: Vec3, direction: Vec3) -> Pick {
        pick(root, &Tree::new(root), origin, direction).expect("the ray meets the solid")
    }

    #[test]
    fn a_click_inside_a_hole_picks_what_was_taken_away() {
        let block = cuboid([0.0, 0.0, 10.0], [40.0, 40.0, 20.0]);
        let root: NodeRef = block.subtract(cylinder([0.0, 0.0, -1.0], [0.0, 0.0, 30.0], 8.0)).into();
        // At a slant into the bore, onto its wall.
        let pick_in_hole = picked(&root, Vec3::new(-6.0, 0.0, 40.0), Vec3::new(0.45, 0.0, -1.0));
        assert_eq!(pick_in_hole.contributors[0].0.to_string(), "/1");
        assert!((pick_in_hole.hit.point.x - 8.0).abs() < 1e-3, "{:?}", pick_in_hole.hit);
        assert!(pick_in_hole.hit.normal.x < -0.99);
        let on_top = picked(&root, Vec3::new(15.0, 0.0, 40.0), Vec3::NEG_Z);
        assert_eq!(on_top.contributors[0].0.to_string(), "/0");
        assert!((on_top.hit.point.z - 20.0).abs() < 1e-3);
    }

    #[test]
    fn taps_between_two_blended_balls_cycle_through_both() {
        let root: NodeRef = blend([point([-8.0, 0.0, 0.0], 10.0), point([9.0, 0.0, 0.0], 10.0)]).into();
        let pick = picked(&root, Vec3::new(-0.5, 0.0, 50.0), Vec3::NEG_Z);
        let names: Vec<String> = pick.contributors.iter().map(|c| c.0.to_string()).collect();
        assert_eq!(names, ["/0", "/1"]);
        assert!(pick.contributors[1].1 > 0.3, "{:?}", pick.contributors);
    }

    #[test]
    fn rays_that_miss_start_inside_or_are_not_numbers_are_ordinary() {
        let tree = Tree::new(&point([0.0, 0.0, 0.0], 10.0));
        assert_eq!(cast_ray(&tree, Vec3::new(0.0, 11.0, 50.0), Vec3::NEG_Z, 0.1), None);
        assert_eq!(cast_ray(&tree, Vec3::ZERO, Vec3::Z, 0.1).map(|hit| hit.t), Some(0.0));
        assert_eq!(cast_ray(&tree, Vec3::NAN, Vec3::Z, 0.1), None);
        assert_eq!(cast_ray(&tree, Vec3::ZERO, Vec3::ZERO, 0.1), None);
    }
}
