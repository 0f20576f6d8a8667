//! The tip of a brush as a field on the lattice.

use crate::Dab;
use crate::rebake::region::Region;
use blobtree::{Aabb, BrushTip, Field, GROWN_FALLOFF, ISO, SupportFree, Tree};
use glam::{DVec3, Vec3};

/// The shape of a tip, of radius 1 around the origin.
pub(super) enum Shape {
    Ball,
    Cube,
    Cylinder,
    Solid(Box<Tree>),
}

impl Shape {
    pub fn of(tip: &BrushTip) -> Self {
        match tip {
            BrushTip::Ball => Self::Ball,
            BrushTip::Cube => Self::Cube,
            BrushTip::Cylinder => Self::Cylinder,
            BrushTip::Shape(node) => Self::Solid(Box::new(Tree::new(node))),
        }
    }

    /// Distance from the surface, negative inside; of solids of trees, none.
    fn distance(&self, p: Vec3) -> f32 {
        // From distances beyond the faces.
        let of_box = |q: Vec3| q.max(Vec3::ZERO).length() + q.max_element().min(0.0);
        match self {
            Self::Ball | Self::Solid(_) => p.length() - 1.0,
            Self::Cube => of_box(p.abs() - 1.0),
            Self::Cylinder => of_box(Vec3::new(p.truncate().length() - 1.0, p.z.abs() - 1.0, -1.0)),
        }
    }
}

/// Places of a region: from the first to before the last along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub low: [usize; 3],
    pub end: [usize; 3],
}

impl Block {
    pub fn sides(&self) -> [usize; 3] {
        std::array::from_fn(|a| self.end[a] - self.low[a])
    }

    pub fn joined(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|a| self.low[a].min(other.low[a])),
            end: std::array::from_fn(|a| self.end[a].max(other.end[a])),
        }
    }

    /// Number of a place in it, x fastest.
    pub fn index(&self, at: [usize; 3]) -> usize {
        let [width, depth, _] = self.sides();
        at[0] - self.low[0] + width * (at[1] - self.low[1] + depth * (at[2] - self.low[2]))
    }
}

/// The field of a dab: ½ on its surface, more inside, 0 from some way outside on.
#[derive(Clone)]
pub(super) struct Stamp {
    pub block: Block,
    pub values: Vec<f32>,
}

/// Where the lattice lies in the space of the node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    spacing: f32,
    /// Of the place of number 0 of the region, mm.
    origin: Vec3,
    /// Distance of layers, mm.
    layer: f32,
    sides: [usize; 3],
}

impl Lattice {
    pub fn new(rule: &SupportFree, region: &Region) -> Self {
        let node_from_upright = rule.upright_from_child().inverse();
        let place = |index: [i32; 3]| {
            let upright = DVec3::from_array(index.map(|i| f64::from(i) * f64::from(region.spacing)));
            node_from_upright.transform_point3(upright)
        };
        let origin = place(region.low);
        let next = place([region.low[0], region.low[1], region.low[2] + 1]);
        Self {
            spacing: region.spacing,
            origin: origin.as_vec3(),
            layer: (next.z - origin.z) as f32,
            sides: region.sides,
        }
    }

    /// Steps of the lattice, along x and y and along z, mm.
    pub fn steps(&self) -> [f32; 2] {
        [self.spacing, self.layer]
    }

    /// A place of the region, mm.
    fn place(&self, [x, y, z]: [usize; 3]) -> Vec3 {
        self.origin + Vec3::new(x as f32, y as f32, 0.0) * self.spacing + Vec3::Z * (z as f32 * self.layer)
    }

    /// The same place in steps of the lattice from the first place.
    pub fn in_steps(&self, place: Vec3) -> Vec3 {
        (place - self.origin) / Vec3::new(self.spacing, self.spacing, self.layer)
    }

    /// A place in mm from one in steps.
    pub fn place_of_steps(&self, at: Vec3) -> Vec3 {
        self.origin + at * Vec3::new(self.spacing, self.spacing, self.layer)
    }

    /// The places of the region in a box, in mm; none if it holds none.
    fn block(&self, bounds: &Aabb) -> Option<Block> {
        let (low, high) = (self.in_steps(bounds.min), self.in_steps(bounds.max));
        let end = |a: usize| ((high[a].floor() + 1.0).max(0.0) as usize).min(self.sides[a]);
        let block = Block {
            low: std::array::from_fn(|a| low[a].ceil().max(0.0) as usize),
            end: std::array::from_fn(end),
        };
        (0..3).all(|a| block.low[a] < block.end[a]).then_some(block)
    }

    /// The places of a dab of a tip; none where it does not reach the region.
    pub fn block_of(&self, shape: &Shape, dab: &Dab) -> Option<Block> {
        let (center, radius) = (dab.center(), dab.radius());
        let bounds = match shape {
            Shape::Solid(tree) => {
                let support = tree.support();
                if support.is_empty() {
                    return None;
                }
                Aabb { min: center + support.min * radius, max: center + support.max * radius }
            }
            _ => Aabb::around(center, Vec3::splat(radius + falloff(dab))),
        };
        self.block(&bounds)
    }

    /// The dab of a tip; none where it does not reach the region.
    pub fn stamp(&self, shape: &Shape, dab: &Dab) -> Option<Stamp> {
        let (center, radius, falloff) = (dab.center(), dab.radius(), falloff(dab));
        let block = self.block_of(shape, dab)?;
        let mut values = Vec::with_capacity(block.sides().iter().product());
        let rows =
            (block.low[2]..block.end[2]).flat_map(|z| (block.low[1]..block.end[1]).map(move |y| [y, z]));
        if let Shape::Solid(tree) = shape {
            let mut sampler = tree.sampler();
            sampler.enter(tree.support());
            let mut row = vec![0.0; block.sides()[0]];
            for [y, z] in rows {
                let place = |x: usize| (self.place([x, y, z]) - center) / radius;
                let places: Vec<Vec3> = (block.low[0]..block.end[0]).map(place).collect();
                sampler.values(&places, &mut row);
                values.extend(row.iter().map(|value| value.min(1.0)));
            }
        } else {
            for [y, z] in rows {
                values.extend((block.low[0]..block.end[0]).map(|x| {
                    let p = (self.place([x, y, z]) - center) / radius;
                    (ISO * (1.0 - shape.distance(p) * radius / falloff)).clamp(0.0, 1.0)
                }));
            }
        }
        Some(Stamp { block, values })
    }
}

/// How far the field of a dab of a plain shape reaches beyond its surface, mm.
fn falloff(dab: &Dab) -> f32 {
    GROWN_FALLOFF.min(dab.radius())
}

impl Stamp {
    /// The value at a place; 0 outside its block.
    pub fn value(&self, at: [usize; 3]) -> f32 {
        let inside = (0..3).all(|a| (self.block.low[a]..self.block.end[a]).contains(&at[a]));
        if inside { self.values[self.block.index(at)] } else { 0.0 }
    }

    /// The greater of two fields.
    pub fn with(self, other: &Self) -> Self {
        let block = self.block.joined(&other.block);
        let mut values = vec![0.0f32; block.sides().iter().product()];
        for part in [&self, other] {
            let [width, ..] = part.block.sides();
            for (n, row) in part.values.chunks_exact(width).enumerate() {
                let depth = part.block.sides()[1];
                let at = [part.block.low[0], part.block.low[1] + n % depth, part.block.low[2] + n / depth];
                let start = block.index(at);
                let all = &mut values[start..start + width];
                all.iter_mut().zip(row).for_each(|(all, value)| *all = all.max(*value));
            }
        }
        Self { block, values }
    }

    /// The values of a layer of its block.
    pub fn layer(&self, z: usize) -> &[f32] {
        let [width, depth, _] = self.block.sides();
        &self.values[(z - self.block.low[2]) * width * depth..][..width * depth]
    }
}
