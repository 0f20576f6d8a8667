//! A function of the plane sampled on a grid and read back smoothly.

use crate::checks::ParameterError;
use crate::scalar::Scalar;
use glam::Vec2;

/// Samples along each side of the blocks whose ranges are kept.
const BLOCK: usize = 8;

/// Samples of a function of the plane on a square grid, read back with a C¹ biquadratic filter.
///
/// - **Filter:** the samples are the control points of a uniform quadratic B-spline, so values never leave the
///   range of the nine samples around them, and the gradient is continuous. A linear function comes back
///   exactly; a curved one is smoothed by `pixel²/8` of its Laplacian. Beyond half a pixel inside the border,
///   the nearest value there goes on.
/// - **Source:** Schmidt & Wyvill 2011, §11.3.3, "a C1 bi-quadratic filter".
#[derive(Clone, Debug, PartialEq)]
pub struct FieldImage {
    origin: Vec2,
    pixel: f32,
    inverse: f32,
    size: [usize; 2],
    samples: Vec<f32>,
    /// Ranges of the blocks of samples, then of 2 × 2 of these, up to a single one.
    ranges: Vec<Ranges>,
}

/// The ranges of blocks, row by row.
#[derive(Clone, Debug, PartialEq)]
struct Ranges {
    size: [usize; 2],
    ranges: Vec<(f32, f32)>,
}

/// The value of an image at a place, with its derivatives along x and y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading<S> {
    pub value: S,
    pub slope: [S; 2],
}

/// A rectangle of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rectangle {
    pub min: Vec2,
    pub max: Vec2,
}

impl FieldImage {
    /// Fewest samples along a side.
    pub const MIN_SIZE: usize = 3;
    /// Most samples along a side.
    pub const MAX_SIZE: usize = 8192;

    /// - **In:** `origin` is the place of the first sample and `pixel` the distance between samples, mm;
    ///   `size` samples along x and y; `samples` row by row from the lowest y.
    /// - **Errors:** fewer than 3 or more than 8192 samples along a side, another number of samples than `size`
    ///   says, a pixel that is not above 0, or a number that is not finite.
    /// - **Cost:** one pass over the samples; ranges of blocks add 5 % of memory.
    pub fn new(
        origin: Vec2,
        pixel: f32,
        size: [usize; 2],
        samples: Vec<f32>,
    ) -> Result<Self, ParameterError> {
        if !size.iter().all(|n| (Self::MIN_SIZE..=Self::MAX_SIZE).contains(n)) {
            return Err(ParameterError::new("size", size, "3 to 8192 samples along each side"));
        }
        if samples.len() != size[0] * size[1] {
            let expected = format!("{} samples", size[0] * size[1]);
            return Err(ParameterError::new("samples", format!("a list of {}", samples.len()), &expected));
        }
        if !(pixel.is_finite() && pixel > 0.0 && pixel.recip().is_finite()) {
            return Err(ParameterError::new("pixel", pixel, "a length above 0 mm"));
        }
        if !origin.is_finite() {
            return Err(ParameterError::new("origin", origin, "two coordinates in mm"));
        }
        if let Some(bad) = samples.iter().find(|x| !x.is_finite()) {
            return Err(ParameterError::new("samples", bad, "finite numbers"));
        }
        let ranges = Ranges::all(size, &samples);
        Ok(Self { origin, pixel, inverse: pixel.recip(), size, samples, ranges })
    }

    /// Place of the first sample, mm.
    pub fn origin(&self) -> Vec2 {
        self.origin
    }

    /// Distance between samples, mm.
    pub fn pixel(&self) -> f32 {
        self.pixel
    }

    /// Samples along x and y.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The samples, row by row from the lowest y.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// The place of the sample in this column and row, mm.
    pub fn place(&self, column: usize, row: usize) -> Vec2 {
        self.origin + self.pixel * Vec2::new(column as f32, row as f32)
    }

    /// The value at a place, mm. Cost: nine samples.
    pub fn value(&self, at: Vec2) -> f32 {
        self.read(at.to_array()).value
    }

    /// The value at a place, and its exact gradient. Cost: nine samples.
    pub fn value_and_gradient(&self, at: Vec2) -> (f32, Vec2) {
        let reading = self.read(at.to_array());
        (reading.value, Vec2::from_array(reading.slope))
    }

    /// The lowest and the highest value in the rectangle between two corners, mm: never too tight, and at most
    /// by some pixels' worth too loose.
    ///
    /// Cost: at most some hundred samples and blocks, whatever the rectangle.
    pub fn bound(&self, min: Vec2, max: Vec2) -> (f32, f32) {
        let lo = [self.cell(min.x, 0), self.cell(min.y, 1)].map(|cell| cell - 1);
        let hi = [self.cell(max.x, 0), self.cell(max.y, 1)].map(|cell| cell + 1);
        if (0..2).all(|a| hi[a] - lo[a] < 2 * BLOCK) {
            return self.range_of_samples(lo, hi);
        }
        let mut scale = BLOCK;
        for level in &self.ranges {
            if (0..2).all(|a| hi[a] / scale - lo[a] / scale < 12) || level.ranges.len() == 1 {
                return level.range(lo.map(|i| i / scale), hi.map(|i| i / scale));
            }
            scale *= 2;
        }
        (f32::NEG_INFINITY, f32::INFINITY)
    }

    /// The part of the plane in which values change: half a pixel inside the border.
    pub(crate) fn rectangle(&self) -> Rectangle {
        let last = Vec2::new((self.size[0] - 1) as f32, (self.size[1] - 1) as f32);
        let half = Vec2::splat(0.5);
        Rectangle { min: self.origin + self.pixel * half, max: self.origin + self.pixel * (last - half) }
    }

    /// The bulge of a template from its distance alone, of which this is the image: where it is e from the deepest
    /// level set, `depth² − e²`.
    ///
    /// Right for a disc, and outside of any curve; of other shapes it makes roofs with ridges, where a solved bulge
    /// is smooth.
    #[must_use]
    pub fn bulge(&self, depth: f32) -> Self {
        let lower = |distance: &f32| {
            let e = (depth + distance).clamp(0.0, 1e18);
            (depth - e) * (depth + e)
        };
        let samples: Vec<f32> = self.samples.iter().map(lower).collect();
        let ranges = Ranges::all(self.size, &samples);
        Self { samples, ranges, ..self.clone() }
    }

    /// A rectangle around all places with values below `level`, not looking beyond [`Self::rectangle`]; none
    /// if there are none. Right to some pixels.
    pub(crate) fn below(&self, level: f32) -> Option<Rectangle> {
        self.around(|range| range.0 < level)
    }

    /// The same for values above `level`.
    pub(crate) fn above(&self, level: f32) -> Option<Rectangle> {
        self.around(|range| range.1 > level)
    }

    /// A rectangle around the blocks whose ranges are looked for.
    fn around(&self, is_wanted: impl Fn((f32, f32)) -> bool) -> Option<Rectangle> {
        let blocks = &self.ranges[0];
        let mut found: Option<([usize; 2], [usize; 2])> = None;
        for (i, range) in blocks.ranges.iter().enumerate() {
            if is_wanted(*range) {
                let at = [i % blocks.size[0], i / blocks.size[0]];
                let (lo, hi) = found.unwrap_or((at, at));
                found = Some((
                    std::array::from_fn(|a| lo[a].min(at[a])),
                    std::array::from_fn(|a| hi[a].max(at[a])),
                ));
            }
        }
        let (lo, hi) = found?;
        // A sample is felt up to one and a half pixels around it.
        let low = Vec2::from_array(lo.map(|b| (b * BLOCK) as f32 - 1.5));
        let high = Vec2::from_array(hi.map(|b| (b * BLOCK + BLOCK - 1) as f32 + 1.5));
        let whole = self.rectangle();
        Some(Rectangle {
            min: (self.origin + self.pixel * low).max(whole.min),
            max: (self.origin + self.pixel * high).min(whole.max),
        })
    }

    /// The value and its gradient at a place, mm.
    #[inline(always)]
    pub(crate) fn read<S: Scalar>(&self, at: [S; 2]) -> Reading<S> {
        let (x, y) = (self.weights(at[0], 0), self.weights(at[1], 1));
        let first = y.first * self.size[0] + x.first;
        let mut rows = [(S::of(0.0), S::of(0.0)); 3];
        for (r, row) in rows.iter_mut().enumerate() {
            let samples = &self.samples[first + r * self.size[0]..][..3];
            let [a, b, c] = [S::of(samples[0]), S::of(samples[1]), S::of(samples[2])];
            *row = (
                a * x.value[0] + b * x.value[1] + c * x.value[2],
                a * x.slope[0] + b * x.slope[1] + c * x.slope[2],
            );
        }
        let value = rows[0].0 * y.value[0] + rows[1].0 * y.value[1] + rows[2].0 * y.value[2];
        let along_x = rows[0].1 * y.value[0] + rows[1].1 * y.value[1] + rows[2].1 * y.value[2];
        let along_y = rows[0].0 * y.slope[0] + rows[1].0 * y.slope[1] + rows[2].0 * y.slope[2];
        Reading { value, slope: [along_x, along_y] }
    }

    /// The weights of three neighbouring samples along an axis.
    #[inline(always)]
    fn weights<S: Scalar>(&self, x: S, axis: usize) -> Weights<S> {
        let last = self.size[axis] as f32 - 1.5;
        let u = (x - S::of(self.origin[axis])) * S::of(self.inverse);
        let inside = u.value() > 0.5 && u.value() < last;
        let u = u.larger(S::of(0.5)).smaller(S::of(last));
        let nearest = ((u.value() + 0.5) as usize).min(self.size[axis] - 2);
        let t = u - S::of(nearest as f32);
        let (before, after) = (S::of(0.5) - t, S::of(0.5) + t);
        let half = S::of(0.5);
        // Beyond the border the value does not change.
        let unit = S::of(if inside { self.inverse } else { 0.0 });
        Weights {
            first: nearest - 1,
            value: [half * before * before, S::of(0.75) - t * t, half * after * after],
            slope: [-before * unit, -(t + t) * unit, after * unit],
        }
    }

    /// The middle one of the three samples that are felt at this coordinate.
    fn cell(&self, x: f32, axis: usize) -> usize {
        let u = (x - self.origin[axis]) * self.inverse;
        ((u.clamp(0.5, self.size[axis] as f32 - 1.5) + 0.5) as usize).clamp(1, self.size[axis] - 2)
    }

    fn range_of_samples(&self, lo: [usize; 2], hi: [usize; 2]) -> (f32, f32) {
        let rows = (lo[1]..=hi[1]).map(|row| &self.samples[row * self.size[0]..][lo[0]..=hi[0]]);
        rows.flatten().fold(NOTHING, |range, x| joined(range, (*x, *x)))
    }
}

/// Three neighbouring samples, and what each counts in the value and in the slope.
struct Weights<S> {
    first: usize,
    value: [S; 3],
    slope: [S; 3],
}

/// The range of no values.
const NOTHING: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

fn joined(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl Ranges {
    fn all(size: [usize; 2], samples: &[f32]) -> Vec<Self> {
        let blocks = size.map(|n| n.div_ceil(BLOCK));
        let mut first = Self { size: blocks, ranges: vec![NOTHING; blocks[0] * blocks[1]] };
        for (i, x) in samples.iter().enumerate() {
            let block = i / size[0] / BLOCK * blocks[0] + i % size[0] / BLOCK;
            first.ranges[block] = joined(first.ranges[block], (*x, *x));
        }
        let mut all = vec![first];
        while all[all.len() - 1].ranges.len() > 1 {
            let next = all[all.len() - 1].halved();
            all.push(next);
        }
        all
    }

    fn halved(&self) -> Self {
        let size = self.size.map(|n| n.div_ceil(2));
        let mut ranges = vec![NOTHING; size[0] * size[1]];
        for (i, range) in self.ranges.iter().enumerate() {
            let at = i / self.size[0] / 2 * size[0] + i % self.size[0] / 2;
            ranges[at] = joined(ranges[at], *range);
        }
        Self { size, ranges }
    }

    fn range(&self, lo: [usize; 2], hi: [usize; 2]) -> (f32, f32) {
        let rows = (lo[1]..=hi[1]).map(|row| &self.ranges[row * self.size[0]..][lo[0]..=hi[0]]);
        rows.flatten().fold(NOTHING, |range, block| joined(range, *block))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    fn image(size: [usize; 2], f: impl Fn(Vec2) -> f32) -> FieldImage {
        let (origin, pixel) = (Vec2::new(-3.0, 2.0), 0.25);
        let place = |i: usize| origin + pixel * Vec2::new((i % size[0]) as f32, (i / size[0]) as f32);
        let samples = (0..size[0] * size[1]).map(|i| f(place(i))).collect();
        FieldImage::new(origin, pixel, size, samples).expect("a legal image")
    }

    #[test]
    fn linear_functions_come_back_exactly_and_quadratic_ones_but_for_a_constant() {
        let linear = image([20, 30], |p| 3.0 * p.x - 2.0 * p.y + 1.0);
        let bowl = image([20, 30], |p| p.length_squared());
        let mut rng = Rng::with_seed(1);
        for _ in 0..1000 {
            let p = Vec2::new(-2.8 + 4.4 * rng.f32(), 2.2 + 6.8 * rng.f32());
            let (value, gradient) = linear.value_and_gradient(p);
            assert!((value - (3.0 * p.x - 2.0 * p.y + 1.0)).abs() < 1e-4, "{value} at {p}");
            assert!(gradient.distance(Vec2::new(3.0, -2.0)) < 1e-4, "{gradient} at {p}");
            let (value, gradient) = bowl.value_and_gradient(p);
            // pixel² / 8 of the Laplacian, which is 4.
            assert!((value - p.length_squared() - 0.25 * 0.25 * 0.5).abs() < 1e-4, "{value} at {p}");
            assert!(gradient.distance(2.0 * p) < 1e-3, "{gradient} at {p}");
        }
    }

    #[test]
    fn value_and_gradient_are_continuous_across_cells_and_constant_beyond_the_border() {
        let mut rng = Rng::with_seed(2);
        let noise: Vec<f32> = (0..15 * 12).map(|_| rng.f32()).collect();
        let image = FieldImage::new(Vec2::ZERO, 1.0, [15, 12], noise).expect("legal");
        for _ in 0..2000 {
            // On the border between two cells.
            let p = Vec2::new(1.5 + rng.u32(..12) as f32, 0.6 + 9.8 * rng.f32());
            let (before, after) = (p - Vec2::new(1e-5, 0.0), p + Vec2::new(1e-5, 0.0));
            assert!((image.value(before) - image.value(after)).abs() < 1e-3);
            let (a, b) = (image.value_and_gradient(before).1, image.value_and_gradient(after).1);
            assert!(a.distance(b) < 1e-3, "{a} and {b} at {p}");
        }
        for far in [Vec2::new(-5.0, 5.0), Vec2::new(1e9, 1e9), Vec2::new(3.0, -1e20)] {
            let inside = far.clamp(Vec2::splat(0.5), Vec2::new(13.5, 10.5));
            assert_eq!(image.value(far), image.value(inside));
        }
        assert_eq!(image.value_and_gradient(Vec2::new(1e9, -1e9)).1, Vec2::ZERO);
        assert!(image.value(Vec2::NAN).is_finite());
    }

    #[test]
    fn bounds_hold_for_rectangles_of_any_size_and_are_tight_for_small_ones() {
        let mut rng = Rng::with_seed(3);
        let wavy = image([150, 90], |p| p.x.sin() + 0.3 * (4.0 * p.y).cos());
        for trial in 0..20_000 {
            let corner = || Vec2::new(-6.0 + 45.0 * rng.f32(), -1.0 + 28.0 * rng.f32());
            let a = std::iter::repeat_with(corner).next().expect("endless");
            let size = 40.0 * Vec2::splat(rng.f32().powi(4));
            let (lo, hi) = wavy.bound(a, a + size);
            for _ in 0..8 {
                let value = wavy.value(a + size * Vec2::new(rng.f32(), rng.f32()));
                assert!((lo - 1e-6..=hi + 1e-6).contains(&value), "trial {trial}: {value} not in {lo}..{hi}");
            }
            if size.x < 0.05 {
                assert!(hi - lo < 1.6, "trial {trial}: {lo}..{hi} for {size}");
            }
        }
    }

    #[test]
    fn images_that_are_none_are_refused() {
        let refused = |size: [usize; 2], samples: Vec<f32>, pixel: f32| {
            FieldImage::new(Vec2::ZERO, pixel, size, samples).expect_err("not an image").field
        };
        assert_eq!(refused([2, 3], vec![0.0; 6], 1.0), "size");
        assert_eq!(refused([usize::MAX, 2], vec![], 1.0), "size");
        assert_eq!(refused([3, 3], vec![0.0; 8], 1.0), "samples");
        assert_eq!(refused([3, 3], vec![f32::NAN; 9], 1.0), "samples");
        for pixel in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-45] {
            assert_eq!(refused([3, 3], vec![0.0; 9], pixel), "pixel");
        }
        assert!(FieldImage::new(Vec2::NAN, 1.0, [3, 3], vec![0.0; 9]).is_err());
    }
}
