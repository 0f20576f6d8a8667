//! Where the solid of a field is.

use crate::field::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, ISO, Sampler};
use glam::Vec3;

/// The finest step in looking for a solid's box, as a share of its field's longest side.
const FINEST: f32 = 1.0 / 512.0;

/// Most regions looked at before a box is taken as it is.
const PATIENCE: usize = 200_000;

/// A box around the solid of `field`, mm: never too small, and at most about 1/256 of the field's support too
/// large on each side where its bounds are tight. Empty if there is no solid.
///
/// Cost: regions are halved only where the solid may reach out of the box known so far.
pub fn solid_box(field: &dyn Field) -> Aabb {
    let support = field.support();
    if support.is_empty() || !(support.min.is_finite() && support.max.is_finite()) {
        return support;
    }
    let mut sampler = field.sampler();
    let mut search = Search {
        known: inside_samples(&mut *sampler, support),
        finest: support.size().max_element() * FINEST,
        left: PATIENCE,
    };
    search.visit(&mut *sampler, support);
    search.known.intersection(&support)
}

struct Search {
    /// Holds every part of the solid that was met.
    known: Aabb,
    finest: f32,
    left: usize,
}

impl Search {
    fn visit(&mut self, sampler: &mut dyn Sampler, region: Aabb) {
        let region = without(region, self.known);
        if region.is_empty() {
            return;
        }
        self.left = self.left.saturating_sub(1);
        let bound = sampler.enter(region);
        if bound.hi >= ISO {
            let size = region.size();
            let is_small = size.max_element() <= self.finest || self.left == 0;
            match halves(region) {
                Some(halves) if bound.lo < ISO && !is_small => {
                    halves.into_iter().for_each(|half| self.visit(sampler, half));
                }
                _ => self.known = self.known.union(&region),
            }
        }
        sampler.leave();
    }
}

/// What is left of a region without the part in `known`, as far as that is a box: where the region sticks out
/// along one axis only. Without this, flat faces of a solid would be followed all over.
fn without(region: Aabb, known: Aabb) -> Aabb {
    let low = region.min.cmpge(known.min);
    let high = region.max.cmple(known.max);
    let within = low & high;
    if within.all() {
        return Aabb::EMPTY;
    }
    let mut left = region;
    for axis in (0..3).filter(|axis| (0..3).all(|other| other == *axis || within.test(other))) {
        if low.test(axis) {
            left.min[axis] = left.min[axis].max(known.max[axis]);
        } else if high.test(axis) {
            left.max[axis] = left.max[axis].min(known.min[axis]);
        }
    }
    left
}

/// A region cut in two across its longest side; none where there is no number between its ends.
fn halves(region: Aabb) -> Option<[Aabb; 2]> {
    let size = region.size();
    let axis = (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
    let (mut low, mut high) = (region, region);
    low.max[axis] = region.center()[axis];
    high.min[axis] = low.max[axis];
    (region.min[axis] < low.max[axis] && low.max[axis] < region.max[axis]).then_some([low, high])
}

/// The box of the points of a coarse lattice that are inside: a beginning.
fn inside_samples(sampler: &mut dyn Sampler, support: Aabb) -> Aabb {
    let spacing = support.size().max_element() / (BRICK - 2) as f32;
    if !spacing.is_normal() {
        return Aabb::EMPTY;
    }
    let origin = (support.min / spacing).ceil();
    if origin.abs().max_element() > 1e6 {
        return Aabb::EMPTY;
    }
    let brick = Brick { origin: origin.to_array().map(|c| c as i32), spacing };
    let mut values = Box::new([0.0; BRICK_SAMPLES]);
    sampler.enter(brick.region());
    sampler.fill(&brick, &mut values);
    sampler.leave();
    let inside = values.iter().enumerate().filter(|(_, value)| **value >= ISO);
    let place = |i: usize| brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK]);
    Aabb::of_points(inside.map(|(i, _)| place(i)).collect::<Vec<Vec3>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::*;
    use crate::eval::Tree;

    #[test]
    fn the_box_of_a_solid_holds_it_and_is_close() {
        let ball = |x: f32, r: f32| point([x, 0.0, r], r);
        let shape = union([ball(-20.0, 5.0), ball(10.0, 1.0), ball(30.0, 8.0)]);
        let found = solid_box(&Tree::new(&shape));
        let exact = Aabb { min: Vec3::new(-25.0, -8.0, 0.0), max: Vec3::new(38.0, 8.0, 16.0) };
        assert!(found.contains(exact.min) && found.contains(exact.max), "{found:?}");
        assert!((found.min - exact.min).abs().max_element() < 0.7, "{found:?}");
        assert!((found.max - exact.max).abs().max_element() < 0.7, "{found:?}");
    }

    #[test]
    fn flat_faces_are_found_exactly_and_soon() {
        let shape = cuboid([0.0, 0.0, 26.0], [60.0, 40.0, 52.0])
            .union(cylinder([0.0, 0.0, 0.0], [0.0, 0.0, 2.0], 35.0))
            .translate([1.3, 0.7, 0.0]);
        let tree = Tree::new(&shape);
        let mut search = Search { known: Aabb::EMPTY, finest: 0.2, left: PATIENCE };
        search.visit(&mut *tree.sampler(), tree.support());
        assert!(search.left > PATIENCE - 20_000, "{} regions", PATIENCE - search.left);
        let exact = Aabb { min: Vec3::new(-33.7, -34.3, 0.0), max: Vec3::new(36.3, 35.7, 52.0) };
        assert!(search.known.contains(exact.min) && search.known.contains(exact.max), "{:?}", search.known);
        assert!(exact.grown(0.5).contains(search.known.min) && exact.grown(0.5).contains(search.known.max));
    }

    #[test]
    fn where_numbers_lie_far_apart_the_search_ends() {
        for far in [1e5, 1e6, 1e7, 3e7, 1e8, 1e9, 1e12] {
            let shape = union([point([far, -far, 5.0], 5.0), point([far, 9.0 - far, 5.0], 5.0)]);
            let tree = Tree::new(&shape);
            let mut search = Search { known: Aabb::EMPTY, finest: 1e-3, left: PATIENCE };
            search.visit(&mut *tree.sampler(), tree.support());
            let found = solid_box(&tree);
            assert!(found.is_empty() || found.contains(found.center()), "{far}: {found:?}");
        }
    }

    #[test]
    fn nothing_has_an_empty_box() {
        let nothing = point([0.0; 3], 5.0).subtract(point([0.0; 3], 9.0));
        assert!(solid_box(&Tree::new(&nothing)).is_empty());
    }
}
