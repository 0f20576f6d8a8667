//! The part of the lattice in which a solid lies.

use blobtree::{Aabb, BRICK, Brick, Field, GROWN_FALLOFF, ISO, SupportFree};

/// Most places of a lattice: 512³.
const MOST_PLACES: f64 = (1u64 << 27) as f64;

/// Most places along a side.
const MOST_ALONG: f64 = 4096.0;

/// Places around the solid that are looked at, too, so that its outer field is there to be cut.
const MARGIN: i32 = 8;

/// Bricks along each side of the blocks that are looked at first.
const BLOCK: i32 = 8;

/// A box of a lattice around a solid above its bed, in the stretched space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Region {
    /// Distance of neighbouring places, mm.
    pub spacing: f32,
    /// Index of the first place; z is 0, the middle of the first layer.
    pub low: [i32; 3],
    /// Places along x and y in whole bricks; layers in whole bricks.
    pub sides: [usize; 3],
    /// How far the bed lies below the first layer, in lattice steps.
    pub bed_steps: f32,
    /// What a place stands for in the node's own space, mm³.
    pub cell_mm3: f64,
    /// Whether the solid reaches below the bed.
    pub cut_at_bed: bool,
}

impl Region {
    /// The region in which the solid of `child` lies; none if there is no solid.
    pub fn around_solid(rule: &SupportFree, child: &dyn Field) -> Option<Self> {
        Self::around(rule, child, &Aabb::EMPTY)
    }

    /// The same, with a box in which something may be added.
    pub fn around(rule: &SupportFree, child: &dyn Field, added: &Aabb) -> Option<Self> {
        let support = child.support().union(added);
        if support.is_empty() || !(support.min.is_finite() && support.max.is_finite()) {
            return None;
        }
        let stretch = rule.overhang_degrees.to_radians().tan();
        // Lattice steps are no longer than a layer is high, and one or more of them make a layer.
        let steps = (stretch - 1e-3).ceil().max(1.0);
        let mut spacing = rule.layer_height * stretch / steps;
        let coarse = spacing.max(support.size().max_element() / 200.0);
        let arena = child.support();
        let solid_in = |arena: &Aabb, spacing: f32| match arena.is_empty() {
            true => *added,
            false => keys_of_solid(child, arena, spacing).map_or(*added, |solid| solid.union(added)),
        };
        let rough = solid_in(&arena, coarse);
        if rough.is_empty() {
            return None;
        }
        let size = rough.size().as_dvec3() + f64::from(2 * MARGIN) * f64::from(spacing);
        let along = size.max_element() / f64::from(spacing);
        let places = size.element_product() / f64::from(spacing).powi(3);
        spacing *= (places / MOST_PLACES).cbrt().max(along / MOST_ALONG).max(1.0) as f32;
        let solid = if spacing == coarse { rough } else { solid_in(&rough.intersection(&arena), spacing) };
        if solid.is_empty() {
            return None;
        }
        let index = |x: f32| (x / spacing).round() as i32;
        let low = solid.min.to_array().map(|x| index(x) - MARGIN);
        let high = solid.max.to_array().map(|x| index(x) + MARGIN);
        let whole = |places: i32| places.max(1) as usize / BRICK * BRICK + BRICK;
        Some(Self {
            spacing,
            low: [low[0], low[1], 0],
            sides: [whole(high[0] - low[0]), whole(high[1] - low[1]), whole(high[2])],
            bed_steps: 0.5 * rule.layer_height * stretch / spacing,
            cell_mm3: f64::from(spacing).powi(3) / f64::from(stretch),
            cut_at_bed: solid_below_bed(child, &solid, spacing),
        })
    }

    /// The lowest and highest place of the region that are no farther from the child's support than grown matter may be.
    pub fn ends_within(&self, support: &Aabb) -> [[i32; 3]; 2] {
        let around = support.grown(0.99 * GROWN_FALLOFF);
        let (low, high) = (around.min / self.spacing, around.max / self.spacing);
        // Downwards matter may grow to the bed.
        let lowest = [low.x.ceil() as i32, low.y.ceil() as i32, -2];
        let first = std::array::from_fn(|a| lowest[a].max(if a == 2 { -2 } else { self.low[a] }));
        let last = high.floor().to_array().map(|x| x as i32);
        [first, std::array::from_fn(|a| last[a].min(self.high()[a]).max(first[a]))]
    }

    /// Index of the last place along each axis.
    pub fn high(&self) -> [i32; 3] {
        std::array::from_fn(|a| self.low[a] + self.sides[a] as i32 - 1)
    }
}

/// A box around all bricks, within `arena`, that may hold solid.
fn keys_of_solid(child: &dyn Field, arena: &Aabb, spacing: f32) -> Option<Aabb> {
    let step = BRICK as f32 * spacing;
    let key = |x: f32| (x / step).floor() as i32;
    let (low, high) = (arena.min.to_array().map(key), arena.max.to_array().map(key));
    let mut sampler = child.sampler();
    let mut found = Aabb::EMPTY;
    for_each(low, high, BLOCK, &mut |low, high| {
        let region = bricks_box(low, high, step).intersection(arena);
        if inside(&found, &region) {
            return;
        }
        if sampler.enter(region).hi >= ISO {
            for_each(low, high, 1, &mut |key, _| {
                let region = bricks_box(key, key, step).intersection(arena);
                if !region.is_empty() && !inside(&found, &region) {
                    if sampler.enter(region).hi >= ISO {
                        found = found.union(&region);
                    }
                    sampler.leave();
                }
            });
        }
        sampler.leave();
    });
    (!found.is_empty()).then_some(found)
}

fn inside(outer: &Aabb, inner: &Aabb) -> bool {
    !outer.is_empty() && outer.contains(inner.min) && outer.contains(inner.max)
}

fn bricks_box(low: [i32; 3], high: [i32; 3], step: f32) -> Aabb {
    let corner = |key: [i32; 3], by: i32| Brick::lattice_point(key.map(|k| k + by), step);
    Aabb { min: corner(low, 0), max: corner(high, 1) }
}

/// Calls `visit` with the first and last key of every block of `size` keys a side, cut to the range.
fn for_each(low: [i32; 3], high: [i32; 3], size: i32, visit: &mut dyn FnMut([i32; 3], [i32; 3])) {
    let starts = |a: usize| (low[a]..=high[a]).step_by(size as usize);
    for z in starts(2) {
        for y in starts(1) {
            for x in starts(0) {
                let first = [x, y, z];
                visit(first, std::array::from_fn(|a| (first[a] + size - 1).min(high[a])));
            }
        }
    }
}

/// Whether a place at least one lattice step below the first layer's middle is solid.
fn solid_below_bed(child: &dyn Field, solid: &Aabb, spacing: f32) -> bool {
    let index = |x: f32| (x / spacing).floor() as i32;
    let (low, high) = (solid.min.to_array().map(index), solid.max.to_array().map(index));
    if low[2] >= 0 {
        return false;
    }
    let mut sampler = child.sampler();
    let mut values = Box::new([0.0; BRICK * BRICK * BRICK]);
    let mut found = false;
    // Bricks whose last layer is just below the first one, and those below them.
    let layers = (-low[2]).div_euclid(BRICK as i32) + 1;
    let count = |a: usize| (high[a] - low[a]).div_euclid(BRICK as i32);
    for_each([0, 0, -layers], [count(0), count(1), -1], 1, &mut |key, _| {
        let step = BRICK as i32;
        let origin = [low[0] + key[0] * step, low[1] + key[1] * step, key[2] * step];
        let brick = Brick { origin, spacing };
        if !found && sampler.enter(brick.region()).hi >= ISO {
            sampler.fill(&brick, &mut values);
            found = values.iter().any(|value| *value >= ISO);
        }
        if !found {
            sampler.leave();
        }
    });
    found
}
