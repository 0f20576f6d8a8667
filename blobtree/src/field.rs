//! The one interface everybody evaluates through: bounded scalar fields, sampled in bricks.

use glam::Vec3;

/// The field value at the surface: the solid is where the field is at least this.
pub const ISO: f32 = 0.5;

/// Samples along each side of a brick.
pub const BRICK: usize = 16;

/// Samples in a brick.
pub const BRICK_SAMPLES: usize = BRICK * BRICK * BRICK;

/// An axis-aligned box, mm. Empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: Vec3,
    /// Highest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing and is the neutral element of [`Self::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box with these two corners, in any order.
    pub fn from_corners(a: Vec3, b: Vec3) -> Self {
        Self { min: a.min(b), max: a.max(b) }
    }

    /// The box of half-size `half` (each component ≥ 0) around `center`.
    pub fn around(center: Vec3, half: Vec3) -> Self {
        Self { min: center - half, max: center + half }
    }

    /// The smallest box around all `points`; [`Self::EMPTY`] without points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Whether it contains no point at all. A box of zero width contains its points.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The middle; meaningless for an empty box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Side lengths; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The box grown by `margin` on every side; an empty box stays empty.
    pub fn grown(&self, margin: f32) -> Self {
        if self.is_empty() { *self } else { Self { min: self.min - margin, max: self.max + margin } }
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What both have in common; empty if nothing.
    pub fn intersection(&self, other: &Self) -> Self {
        let common = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        if common.is_empty() { Self::EMPTY } else { common }
    }

    /// Whether the two share a point, touching included.
    pub fn overlaps(&self, other: &Self) -> bool {
        !self.intersection(other).is_empty()
    }

    /// Whether `p` lies in the box, its boundary included.
    pub fn contains(&self, p: Vec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// The eight corners, x fastest.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// A part of space that holds every place where a field may have changed.
pub trait Dirty: Sync {
    /// A box around it, mm.
    fn bounds(&self) -> Aabb;

    /// A test, with scratch memory of its own, whether boxes have anything in common with it. May answer yes too
    /// often, never no.
    fn touch(&self) -> Box<dyn FnMut(&Aabb) -> bool + '_>;
}

impl Dirty for Aabb {
    fn bounds(&self) -> Aabb {
        *self
    }

    fn touch(&self) -> Box<dyn FnMut(&Aabb) -> bool + '_> {
        Box::new(|region| region.overlaps(self))
    }
}

/// Several places at once.
impl Dirty for Vec<Aabb> {
    fn bounds(&self) -> Aabb {
        self.iter().fold(Aabb::EMPTY, |all, each| all.union(each))
    }

    fn touch(&self) -> Box<dyn FnMut(&Aabb) -> bool + '_> {
        Box::new(|region| self.iter().any(|each| each.overlaps(region)))
    }
}

/// A closed range of field values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub lo: f32,
    /// Upper bound.
    pub hi: f32,
}

impl Interval {
    /// The range that holds only 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// Whether a surface may pass where the field has this range.
    pub fn may_cross(&self, iso: f32) -> bool {
        self.lo <= iso && iso <= self.hi
    }
}

/// A field's value and exact gradient at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The field value.
    pub value: f32,
    /// The derivative of the value, per mm. Points inwards at the surface, as fields grow inwards.
    /// At a crease it is that of the branch that decides the value.
    pub gradient: Vec3,
    /// Tells smooth pieces of the field apart: between nearby places with the same number, not 0, the
    /// gradient does not jump. Different numbers, or 0, say nothing. Numbers compare within one region.
    pub piece: u32,
}

/// The place of a cubic brick of 16³ samples in the lattice of all integer multiples of `spacing`.
///
/// Two bricks that share a lattice point compute it from the same numbers, so their samples there are
/// equal to the last bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brick {
    /// Lattice index of sample (0, 0, 0).
    pub origin: [i32; 3],
    /// Distance of neighbouring samples, mm.
    pub spacing: f32,
}

impl Brick {
    /// The position of the lattice point with this index.
    pub fn lattice_point(index: [i32; 3], spacing: f32) -> Vec3 {
        Vec3::from_array(index.map(|i| i as f32 * spacing))
    }

    /// The position of sample `[i, j, k]`, each in 0..16.
    pub fn point(&self, at: [usize; 3]) -> Vec3 {
        Self::lattice_point(std::array::from_fn(|a| self.origin[a] + at[a] as i32), self.spacing)
    }

    /// The box that its samples span, boundary samples included.
    pub fn region(&self) -> Aabb {
        Aabb { min: self.point([0; 3]), max: self.point([BRICK - 1; 3]) }
    }
}

/// A bounded scalar field: what every tree, compiled for evaluation, can do.
///
/// Primitives run from 0 (far outside) to 1 (on the skeleton); blends may exceed 1. The solid is where the
/// value is at least [`ISO`]. Every way to ask for the same point gives the same bits.
///
/// **Source:** Schmidt & Wyvill 2011, §11.3.1, eqs. 3 to 6.
pub trait Field: Send + Sync {
    /// The box outside which the field is 0, mm. May be loose, never too small. Empty for an empty field.
    fn support(&self) -> Aabb;

    /// A worker with its own scratch memory. Make one per thread and keep it for many bricks.
    fn sampler(&self) -> Box<dyn Sampler + '_>;

    /// The value at `p`. Finite for finite `p`, 0 outside [`Self::support`]. Slow: prefer bricks.
    fn value(&self, p: Vec3) -> f32 {
        let mut value = [0.0];
        self.sampler().values(&[p], &mut value);
        value[0]
    }

    /// The value and gradient at `p`. Slow: prefer batches.
    fn sample(&self, p: Vec3) -> Sample {
        let mut sample = [Sample::default()];
        self.sampler().samples(&[p], &mut sample);
        sample[0]
    }

    /// Bounds of the values in `region`. May be loose, never too tight.
    fn bound(&self, region: Aabb) -> Interval {
        self.sampler().enter(region)
    }
}

/// Evaluates a field for one thread, in batches, each inside a region for which the field was specialised.
///
/// Work goes from coarse to fine: `enter` a large region, look at its bound, `enter` a smaller one inside
/// it, ask for samples there, `leave` twice. Specialising never changes a value.
pub trait Sampler {
    /// Specialises the field to `region`, which must lie in the region entered before; returns bounds of
    /// the values there. Holds until the matching [`Self::leave`].
    fn enter(&mut self, region: Aabb) -> Interval;

    /// Ends the latest region still entered.
    fn leave(&mut self);

    /// Whether the gradient may jump somewhere in the current region: false where the field is smooth.
    fn creased(&self) -> bool;

    /// The values of all samples of `brick`, which must lie in the current region; x runs fastest, then y.
    fn fill(&mut self, brick: &Brick, values: &mut [f32; BRICK_SAMPLES]);

    /// The values at `points`, which must lie in the current region. Panics unless both lengths are equal.
    fn values(&mut self, points: &[Vec3], values: &mut [f32]);

    /// Values and gradients at `points`, which must lie in the current region. Panics unless both lengths
    /// are equal.
    fn samples(&mut self, points: &[Vec3], samples: &mut [Sample]);
}
