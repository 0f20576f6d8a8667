//! A function of space, sampled where it matters and read back smoothly.

use crate::checks::ParameterError;
use crate::scalar::{Scalar, Triple};

/// Samples along each side of a brick that are its own.
pub const VOXEL_BRICK: usize = 8;

/// Samples along each side of a brick with one more on every side.
const SIDE: usize = VOXEL_BRICK + 2;

/// Samples that a brick holds: its own, and one more on every side, which neighbours hold too.
pub const VOXEL_SAMPLES: usize = SIDE * SIDE * SIDE;

/// Most places for bricks in the box around all bricks of an image.
const MOST_PLACES: usize = 1 << 22;

/// The number of a brick that is not there.
const NONE: u32 = u32::MAX;

/// Above this the function counts as unlimited.
const UNLIMITED: f32 = f32::MAX;

/// The share of the way from ½ to the top at which a limit has gone up to [`UNLIMITED`].
const OPEN: f32 = 0.999;

/// What an image is where it has no brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// Nothing: 0.
    Nothing,
    /// No limit. In the bricks, too, what is above ½ rises to no limit where the samples reach their top, by
    /// `½ + u / (1 − u / u₀)` for a sample `½ + u` and the top `½ + u₀`: with slope 1 at ½, so that the surface
    /// there is as smooth as the samples.
    NoLimit,
}

/// A brick of samples, x fastest, with its place in units of bricks.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelBrick {
    /// Sample 0 of brick `key` that is its own has lattice index `8 · key`.
    pub key: [i32; 3],
    /// [`VOXEL_SAMPLES`] numbers from 0 to the image's top.
    pub samples: Vec<f32>,
}

/// Samples on a lattice of space, in bricks where the function matters, read back with a C¹ filter.
///
/// - **Filter:** the samples are the control points of a uniform quadratic B-spline, so values never leave the
///   range of the 27 samples around them, and the gradient is continuous between bricks that are there. A linear
///   function comes back exactly; a curved one is smoothed by an eighth of `spacing²` times its second
///   derivatives.
/// - **Memory:** two bytes for each sample, kept to 1/65535 of the top.
/// - **Source:** Schmidt & Wyvill 2011, §11.3.3, "a C1 bi-quadratic filter", in three dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelImage {
    spacing: f32,
    top: f32,
    beyond: Beyond,
    /// Limits outside count as the nearest inside, in lattice units; outside nothing there is nothing.
    low: [f32; 3],
    high: [f32; 3],
    /// Key of the first place for a brick.
    first: [i32; 3],
    sides: [usize; 3],
    /// The brick's number at each place.
    numbers: Vec<u32>,
    samples: Vec<u16>,
    /// Ranges of the places, then of 2 × 2 × 2 of these, up to a single one.
    ranges: Vec<Ranges>,
}

#[derive(Clone, Debug, PartialEq)]
struct Ranges {
    sides: [usize; 3],
    ranges: Vec<(f32, f32)>,
}

/// The value of an image at a place, with its derivatives in lattice units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading<S> {
    pub value: S,
    pub slope: Triple<S>,
}

impl VoxelImage {
    /// - **In:** `spacing` of the lattice, mm; samples from 0 to `top`; bricks of different keys; the lattice box
    ///   from index `low` to `high` outside which there is nothing, or the limit of the nearest place in it.
    /// - **Errors:** numbers that are not finite or out of range, a brick of another size, two of the same key, or
    ///   bricks too far apart.
    /// - **Cost:** one pass over the samples.
    pub fn new(
        spacing: f32,
        top: f32,
        beyond: Beyond,
        [low, high]: [[i32; 3]; 2],
        bricks: &[VoxelBrick],
    ) -> Result<Self, ParameterError> {
        if !(spacing.is_finite() && spacing > 0.0 && spacing.recip().is_finite()) {
            return Err(ParameterError::new("spacing", spacing, "a length above 0 mm"));
        }
        if !(top > 0.5 && top <= 1e3) {
            return Err(ParameterError::new("top", top, "more than 0.5, at most 1000"));
        }
        if (0..3).any(|a| low[a] > high[a]) {
            return Err(ParameterError::new("high", high, "no less than `low`"));
        }
        let (first, sides) = places(bricks)?;
        let mut image = Self {
            spacing,
            top,
            beyond,
            low: low.map(|i| i as f32),
            high: high.map(|i| i as f32),
            first,
            sides,
            numbers: vec![NONE; sides.iter().product()],
            samples: Vec::with_capacity(bricks.len() * VOXEL_SAMPLES),
            ranges: Vec::new(),
        };
        for (number, brick) in bricks.iter().enumerate() {
            image.put(number as u32, brick)?;
        }
        image.ranges = image.all_ranges();
        Ok(image)
    }

    fn put(&mut self, number: u32, brick: &VoxelBrick) -> Result<(), ParameterError> {
        if brick.samples.len() != VOXEL_SAMPLES {
            let found = format!("a list of {}", brick.samples.len());
            return Err(ParameterError::new("samples", found, &format!("{VOXEL_SAMPLES} samples")));
        }
        if let Some(bad) = brick.samples.iter().find(|x| !(0.0..=self.top).contains(*x)) {
            return Err(ParameterError::new("samples", bad, "numbers from 0 to the top"));
        }
        let place = self.place(brick.key).unwrap_or_default();
        if self.numbers[place] != NONE {
            return Err(ParameterError::new("key", brick.key, "another one for each brick"));
        }
        self.numbers[place] = number;
        let steps = f32::from(u16::MAX) / self.top;
        self.samples.extend(brick.samples.iter().map(|x| (x * steps).round() as u16));
        Ok(())
    }

    /// Distance between samples, mm.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// How many bricks there are.
    pub fn bricks(&self) -> usize {
        self.samples.len() / VOXEL_SAMPLES
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        2 * self.samples.len() + 4 * self.numbers.len() * 4
    }

    /// The place of this key in the table.
    fn place(&self, key: [i32; 3]) -> Option<usize> {
        let at = self.at(key)?;
        Some(at[0] + self.sides[0] * (at[1] + self.sides[1] * at[2]))
    }

    fn at(&self, key: [i32; 3]) -> Option<[usize; 3]> {
        let at: [usize; 3] = std::array::from_fn(|a| {
            usize::try_from(key[a].wrapping_sub(self.first[a])).unwrap_or(usize::MAX)
        });
        (0..3).all(|a| at[a] < self.sides[a]).then_some(at)
    }

    fn beyond(&self) -> f32 {
        match self.beyond {
            Beyond::Nothing => 0.0,
            Beyond::NoLimit => UNLIMITED,
        }
    }

    /// The value at a place in lattice units, and its exact gradient there. Cost: 27 samples.
    #[inline(always)]
    pub(crate) fn read<S: Scalar>(&self, at: Triple<S>) -> Reading<S> {
        let q: Triple<S> = std::array::from_fn(|a| {
            if at[a].value() < self.low[a] {
                S::of(self.low[a])
            } else if at[a].value() > self.high[a] {
                S::of(self.high[a])
            } else {
                at[a]
            }
        });
        let free: [bool; 3] = std::array::from_fn(|a| (self.low[a]..=self.high[a]).contains(&at[a].value()));
        if self.beyond == Beyond::Nothing && free != [true; 3] {
            return Reading { value: S::of(0.0), slope: [S::of(0.0); 3] };
        }
        let nearest = q.map(|x| (x.value() + 0.5).floor() as i32);
        let constant = |value| Reading { value: S::of(value), slope: [S::of(0.0); 3] };
        let place = self.place(nearest.map(|i| i.div_euclid(VOXEL_BRICK as i32)));
        let Some(number) = place.map(|place| self.numbers[place]).filter(|number| *number != NONE) else {
            return constant(self.beyond());
        };
        let within = nearest.map(|i| i.rem_euclid(VOXEL_BRICK as i32) as usize);
        let start = number as usize * VOXEL_SAMPLES + within[0] + SIDE * (within[1] + SIDE * within[2]);
        let reading = self.filtered(start, std::array::from_fn(|a| q[a] - S::of(nearest[a] as f32)));
        let reading = if self.beyond == Beyond::NoLimit { self.opened(reading) } else { reading };
        Reading {
            value: reading.value,
            slope: std::array::from_fn(|a| if free[a] { reading.slope[a] } else { S::of(0.0) }),
        }
    }

    /// The spline over the 27 samples from `start` on, at `t` from the one in the middle.
    #[inline(always)]
    fn filtered<S: Scalar>(&self, start: usize, t: Triple<S>) -> Reading<S> {
        let (half, three_quarters) = (S::of(0.5), S::of(0.75));
        let weights = t.map(|t| {
            let (before, after) = (half - t, half + t);
            [half * before * before, three_quarters - t * t, half * after * after]
        });
        let slopes = t.map(|t| [t - half, -(t + t), half + t]);
        let unit = self.top / f32::from(u16::MAX);
        let zero = S::of(0.0);
        let (mut value, mut slope) = (zero, [zero; 3]);
        for k in 0..3 {
            let (mut plane, mut plane_x, mut plane_y) = (zero, zero, zero);
            for j in 0..3 {
                let from = start + SIDE * (j + SIDE * k);
                let row: [S; 3] = std::array::from_fn(|i| S::of(f32::from(self.samples[from + i]) * unit));
                let along = weights[0][0] * row[0] + weights[0][1] * row[1] + weights[0][2] * row[2];
                let along_x = slopes[0][0] * row[0] + slopes[0][1] * row[1] + slopes[0][2] * row[2];
                plane = plane + weights[1][j] * along;
                plane_x = plane_x + weights[1][j] * along_x;
                plane_y = plane_y + slopes[1][j] * along;
            }
            value = value + weights[2][k] * plane;
            slope[0] = slope[0] + weights[2][k] * plane_x;
            slope[1] = slope[1] + weights[2][k] * plane_y;
            slope[2] = slope[2] + slopes[2][k] * plane;
        }
        Reading { value, slope }
    }

    /// What is above ½, raised: see [`Beyond::NoLimit`].
    #[inline(always)]
    fn opened<S: Scalar>(&self, reading: Reading<S>) -> Reading<S> {
        let (room, above) = (self.top - 0.5, reading.value - S::of(0.5));
        if above.value() <= 0.0 {
            return reading;
        }
        if above.value() >= OPEN * room {
            return Reading { value: S::of(UNLIMITED), slope: [S::of(0.0); 3] };
        }
        let steepness = S::of(1.0) / (S::of(1.0) - above * S::of(room.recip()));
        let steepness_squared = steepness * steepness;
        Reading { value: S::of(0.5) + above * steepness, slope: reading.slope.map(|x| x * steepness_squared) }
    }

    /// The lowest and the highest value between two places in lattice units: never too tight, and at most by some
    /// bricks' worth too loose.
    ///
    /// Cost: at most some hundred ranges, whatever the box.
    pub(crate) fn bound(&self, low: [f32; 3], high: [f32; 3]) -> (f32, f32) {
        let key = |x: f32, a: usize, by: f32| {
            let index = (x.clamp(self.low[a], self.high[a]) + by).floor() as i32;
            index.div_euclid(VOXEL_BRICK as i32)
        };
        // Nearest samples change half way; rounding may take either.
        let from: [i32; 3] = std::array::from_fn(|a| key(low[a], a, 0.499));
        let to: [i32; 3] = std::array::from_fn(|a| key(high[a], a, 0.501));
        let ends = |a: usize| (from[a] - self.first[a], to[a] - self.first[a]);
        let outside = (0..3).any(|a| ends(a).0 < 0 || ends(a).1 >= self.sides[a] as i32);
        let within: [(i32, i32); 3] =
            std::array::from_fn(|a| (ends(a).0.max(0), ends(a).1.min(self.sides[a] as i32 - 1)));
        let beyond = (self.beyond(), self.beyond());
        let mut bound = if outside { beyond } else { (f32::INFINITY, f32::NEG_INFINITY) };
        if within.iter().all(|(lo, hi)| lo <= hi) {
            let inside = self.range(within);
            bound = (bound.0.min(inside.0), bound.1.max(inside.1));
        }
        let leaves = (0..3).any(|a| low[a] < self.low[a] || high[a] > self.high[a]);
        if self.beyond == Beyond::Nothing && leaves { (0.0, bound.1.max(0.0)) } else { bound }
    }

    /// The range over these places.
    fn range(&self, within: [(i32, i32); 3]) -> (f32, f32) {
        let mut level = 0;
        while level + 1 < self.ranges.len() && within.iter().any(|(lo, hi)| (hi >> level) - (lo >> level) > 3)
        {
            level += 1;
        }
        let Ranges { sides, ranges } = &self.ranges[level];
        let mut range = (f32::INFINITY, f32::NEG_INFINITY);
        let along = |a: usize| (within[a].0 >> level) as usize..=(within[a].1 >> level) as usize;
        for z in along(2) {
            for y in along(1) {
                for x in along(0) {
                    let (lo, hi) = ranges[x + sides[0] * (y + sides[1] * z)];
                    range = (range.0.min(lo), range.1.max(hi));
                }
            }
        }
        range
    }

    fn all_ranges(&self) -> Vec<Ranges> {
        let first: Vec<(f32, f32)> = self.numbers.iter().map(|number| self.brick_range(*number)).collect();
        let mut levels = vec![Ranges { sides: self.sides, ranges: first }];
        while let Some(coarser) = levels.last().and_then(Ranges::coarser) {
            levels.push(coarser);
        }
        levels
    }

    fn brick_range(&self, number: u32) -> (f32, f32) {
        if number == NONE {
            return (self.beyond(), self.beyond());
        }
        let start = number as usize * VOXEL_SAMPLES;
        let own = &self.samples[start..start + VOXEL_SAMPLES];
        let ends = own.iter().fold((u16::MAX, 0), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
        let unit = self.top / f32::from(u16::MAX);
        // Room for the filter's rounding; sums of zeros are 0.
        let loose = |x: u16, by: f32| if x == 0 { 0.0 } else { f32::from(x) * unit + by * self.top };
        let raised = |value: f32| match self.beyond {
            Beyond::Nothing => value,
            Beyond::NoLimit => self.opened(Reading { value, slope: [0.0; 3] }).value,
        };
        // The pole magnifies rounding.
        let magnified = |value: f32, by: f32| if value > 0.5 { value * (1.0 + by) } else { value };
        (
            magnified(raised(loose(ends.0, -2e-6)), -1e-3),
            magnified(raised(loose(ends.1, 2e-6)), 1e-3).min(UNLIMITED),
        )
    }
}

impl Ranges {
    /// Ranges of 2 × 2 × 2; none of a single one.
    fn coarser(&self) -> Option<Self> {
        if self.ranges.len() <= 1 {
            return None;
        }
        let sides = self.sides.map(|side| side.div_ceil(2));
        let mut ranges = vec![(f32::INFINITY, f32::NEG_INFINITY); sides.iter().product()];
        for (i, (lo, hi)) in self.ranges.iter().enumerate() {
            let [x, y] = [i % self.sides[0], i / self.sides[0] % self.sides[1]];
            let z = i / self.sides[0] / self.sides[1];
            let range = &mut ranges[x / 2 + sides[0] * (y / 2 + sides[1] * (z / 2))];
            *range = (range.0.min(*lo), range.1.max(*hi));
        }
        Some(Self { sides, ranges })
    }
}

/// First key and sides of the box of keys around all bricks.
fn places(bricks: &[VoxelBrick]) -> Result<([i32; 3], [usize; 3]), ParameterError> {
    let Some(some) = bricks.first() else { return Ok(([0; 3], [0; 3])) };
    let (mut low, mut high) = (some.key, some.key);
    for brick in bricks {
        low = std::array::from_fn(|a| low[a].min(brick.key[a]));
        high = std::array::from_fn(|a| high[a].max(brick.key[a]));
    }
    let sides: [usize; 3] = std::array::from_fn(|a| (i64::from(high[a]) - i64::from(low[a]) + 1) as usize);
    let places = sides.iter().try_fold(1usize, |product, side| product.checked_mul(*side));
    match places {
        Some(count) if count <= MOST_PLACES => Ok((low, sides)),
        _ => Err(ParameterError::new("key", high, "bricks closer together")),
    }
}
