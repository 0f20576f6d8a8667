//! Drawings blown up like cushions.

use super::Kernel;
use super::extrusion::across;
use super::frame::Frame;
use super::section::{self, Section};
use super::skeleton::falloff_bound;
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple, scaled};
use crate::sketched::{Inflation, Profile, Reading};

/// Least share of the thickness that is left where the pen hardly pressed: something must remain to print.
const LIGHTEST: f32 = 0.05;

/// A section in the plane z = 0, and how it is blown up.
///
/// With e the distance from the deepest level set (`depth` on the curve) and τ the height, stretched such
/// that a full thickness counts as `depth`: the field falls off with `√(e² + τ²)`, or `⁴√(e⁴ + τ⁴)`.
#[derive(Clone, Debug)]
pub(crate) struct Inflated {
    frame: Frame,
    section: Section,
    depth: f32,
    /// By how much heights are stretched where the solid is as thick as it gets.
    stretch: f32,
    contrast: f32,
    pressure: f32,
    flat: bool,
    /// Distance up to which the field is 1; below 0 if it would only be so behind the skeleton.
    full: f32,
    inv_reach2: f32,
}

/// Half the thickness at the deepest place.
pub(crate) fn half_thickness(inflation: &Inflation) -> f32 {
    inflation.thickness.map_or(inflation.template.depth, |thickness| 0.5 * thickness)
}

impl Inflated {
    pub fn new(frame: Frame, inflation: &Inflation) -> Self {
        let template = &inflation.template;
        let (depth, falloff) =
            (template.depth, section::falloff(inflation.falloff, template.depth, template));
        Self {
            frame,
            section: Section::new(template, &falloff),
            depth,
            stretch: depth / half_thickness(inflation),
            contrast: inflation.contrast,
            pressure: if template.pressure.is_some() { inflation.pressure } else { 0.0 },
            flat: inflation.profile == Profile::Flat,
            full: depth - falloff.core,
            inv_reach2: falloff.reach.powi(-2),
        }
    }

    /// The square of the share of the thickness that contrast leaves at `s`, 1 on the curve and beyond; and
    /// its derivative.
    #[inline(always)]
    fn left_by_contrast<S: Scalar>(&self, s: S) -> (S, S) {
        let (one, s) = (S::of(1.0), s.smaller(S::of(1.0)));
        let (square, contrast) = (s * s, S::of(self.contrast));
        (one - contrast * square * (S::of(2.0) - square), -contrast * S::of(4.0) * s * (one - square))
    }

    /// The share of the thickness that the pen's pressure leaves.
    #[inline(always)]
    fn left_by_pressure<S: Scalar>(&self, at: [S; 2]) -> Reading<S> {
        let none = Reading { value: S::of(1.0), slope: [S::of(0.0); 2] };
        let Some(pressure) = self.section.template().pressure.as_ref().filter(|_| self.pressure > 0.0) else {
            return none;
        };
        let Reading { value, slope } = pressure.read(at);
        let share = S::of(1.0 - self.pressure) + S::of(self.pressure) * value;
        if share.value() < LIGHTEST {
            return Reading { value: S::of(LIGHTEST), ..none };
        }
        if share.value() > 1.0 {
            return none;
        }
        Reading { value: share, slope: slope.map(|x| x * S::of(self.pressure)) }
    }

    /// The distance that the field falls off with, from `e²` and `τ²`.
    #[inline(always)]
    fn distance<S: Scalar>(&self, e2: S, height2: S) -> S {
        if self.flat { (e2 * e2 + height2 * height2).sqrt().sqrt() } else { (e2 + height2).sqrt() }
    }
}

impl Kernel for Inflated {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let q = self.frame.apply(p);
        let reading = self.section.read([q[0], q[1]]);
        if reading.value.value() >= self.section.far() {
            return Slope::constant(0.0);
        }
        let e = (reading.value + S::of(self.depth)).larger(S::of(0.0));
        let (contrast, by_s) = self.left_by_contrast(e * S::of(1.0 / self.depth));
        let press = self.left_by_pressure([q[0], q[1]]);
        let left = contrast * press.value * press.value;
        let up = S::of(self.stretch * self.stretch) * q[2] / left;
        let (e2, height2) = (e * e, up * q[2]);
        let m = self.distance(e2, height2);
        let over = (m - S::of(self.full)).larger(S::of(0.0));
        let t = (S::of(1.0) - over * over * S::of(self.inv_reach2)).larger(S::of(0.0));
        // Half the derivative of e² and τ² along x, y and z.
        let thinner = by_s * S::of(0.5 / self.depth) / contrast;
        let half: [Triple<S>; 2] = [
            [e * reading.slope[0], e * reading.slope[1], S::of(0.0)],
            [0, 1, 2].map(|a| match a {
                2 => up,
                _ => -height2 * (thinner * reading.slope[a] + press.slope[a] / press.value),
            }),
        ];
        let (of_e, of_height) = if self.flat { (e2, height2) } else { (S::of(1.0), S::of(1.0)) };
        let length = m.larger(S::of(1e-6 * self.depth));
        let length = if self.flat { length * length * length } else { length };
        let slope = S::of(-6.0 * self.inv_reach2) * t * t * over / length;
        let gradient = std::array::from_fn(|a| of_e * half[0][a] + of_height * half[1][a]);
        let piece = self.section.piece([q[0].value(), q[1].value()]);
        Slope::new(t * t * t, self.frame.pull_back(scaled(gradient, slope))).on(piece)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let range = self.frame.range(region);
        let area = across(&range);
        let (lo, hi) = self.section.bound(&area);
        let e = |sd: f32| (sd + self.depth).max(0.0);
        let contrast = |sd: f32| self.left_by_contrast(e(sd) / self.depth).0;
        let pressure = match self.section.template().pressure.as_ref().filter(|_| self.pressure > 0.0) {
            None => (1.0, 1.0),
            Some(image) => {
                let (low, high) = image.bound(area.min, area.max);
                let share = |x: f32| (1.0 - self.pressure + self.pressure * x).clamp(LIGHTEST, 1.0);
                (share(low), share(high))
            }
        };
        let (near, far) = range.abs(2);
        let height2 = |z: f32, contrast: f32, press: f32| (self.stretch * z / press).powi(2) / contrast;
        let (least, most) = (height2(near, contrast(lo), pressure.1), height2(far, contrast(hi), pressure.0));
        let low = self.distance(e(lo).powi(2), least) * (1.0 - 4e-6);
        let high = self.distance(e(hi).powi(2), most) * (1.0 + 4e-6);
        let slack = 4e-6 * self.depth;
        falloff_bound(low - slack - self.full, high + slack - self.full, self.inv_reach2)
    }

    fn creased(&self, region: &Aabb) -> bool {
        self.section.creased(&across(&self.frame.range(region)))
    }
}
