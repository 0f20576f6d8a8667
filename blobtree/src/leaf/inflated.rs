//! Drawings blown up like cushions.

use super::Kernel;
use super::extrusion::across;
use super::frame::Frame;
use super::section;
use super::skeleton::falloff_bound;
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple, scaled};
use crate::sketched::{Inflation, Profile, Reading, Rectangle, Template};
use glam::Vec2;
use std::sync::Arc;

/// Least share of the thickness that is left where the pen hardly pressed: something must remain to print.
const LIGHTEST: f32 = 0.05;

/// A bulge over the plane z = 0, and how thick it is.
///
/// With `e²` what the bulge lies below `depth²` (its highest, so that e is `depth` on the curve) and τ the height,
/// stretched such that a full thickness counts as `depth`: the field falls off with `√(e² + τ²)`, or
/// `⁴√(e⁴ + τ⁴)`.
#[derive(Clone, Debug)]
pub(crate) struct Inflated {
    frame: Frame,
    template: Arc<Template>,
    /// Where there may be anything; empty if there is nothing.
    reach: Rectangle,
    tips: Vec<Tip>,
    depth: f32,
    /// By how much heights are stretched where the solid is as thick as it gets.
    stretch: f32,
    contrast: f32,
    pressure: f32,
    flat: bool,
    /// Distance up to which the field is 1; below 0 if it would only be so behind the middle. 0 for the natural
    /// falloff, which needs no root then.
    full: f32,
    inv_reach2: f32,
}

/// Where the solid ends in a point: a sharp corner of the curve that sticks out.
#[derive(Clone, Copy, Debug)]
struct Tip {
    corner: Vec2,
    /// Across the line that halves the corner; unit length.
    across: Vec2,
    /// How far around it two sides are told apart; those of two tips do not overlap.
    radius: f32,
}

/// Within how many pixels of a tip the normal turns quickly.
const POINTED: f32 = 2.5;

/// Half the thickness at the deepest place.
pub(crate) fn half_thickness(inflation: &Inflation) -> f32 {
    inflation.thickness.map_or(inflation.template.depth, |thickness| 0.5 * thickness)
}

/// Where the field of an inflation may be above 0 in the plane.
pub(crate) fn reach(template: &Template, width: f32) -> Option<Rectangle> {
    let (depth, farthest) = (template.depth, template.depth + width);
    template.bulge.above((depth - farthest) * (depth + farthest))
}

impl Inflated {
    pub fn new(frame: Frame, inflation: &Inflation) -> Self {
        let template = &inflation.template;
        let (depth, falloff) =
            (template.depth, section::falloff(inflation.falloff, template.depth, template));
        let nowhere = Rectangle { min: Vec2::splat(f32::MAX), max: Vec2::splat(f32::MIN) };
        Self {
            frame,
            template: template.0.clone(),
            reach: reach(template, falloff.width()).unwrap_or(nowhere),
            tips: Tip::all(template),
            depth,
            stretch: depth / half_thickness(inflation),
            contrast: inflation.contrast,
            pressure: if template.pressure.is_some() { inflation.pressure } else { 0.0 },
            flat: inflation.profile == Profile::Flat,
            full: depth - falloff.core,
            inv_reach2: falloff.reach.powi(-2),
        }
    }

    /// The square of the share of the thickness that contrast leaves where `s²` is this, 1 on the curve and
    /// beyond; and half its derivative by `s²`.
    #[inline(always)]
    fn left_by_contrast<S: Scalar>(&self, square: S) -> (S, S) {
        let (one, square) = (S::of(1.0), square.smaller(S::of(1.0)));
        let contrast = S::of(self.contrast);
        (one - contrast * square * (S::of(2.0) - square), -contrast * (one - square))
    }

    /// The share of the thickness that the pen's pressure leaves.
    #[inline(always)]
    fn left_by_pressure<S: Scalar>(&self, at: [S; 2]) -> Reading<S> {
        let none = Reading { value: S::of(1.0), slope: [S::of(0.0); 2] };
        let Some(pressure) = self.template.pressure.as_ref().filter(|_| self.pressure > 0.0) else {
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

    /// The square of the distance that the field falls off with, from `e²` and `τ²`.
    #[inline(always)]
    fn squared_distance<S: Scalar>(&self, e2: S, height2: S) -> S {
        if self.flat { (e2 * e2 + height2 * height2).sqrt() } else { e2 + height2 }
    }

    /// `e²`, and half its derivatives.
    #[inline(always)]
    fn below_top<S: Scalar>(&self, at: [S; 2]) -> Reading<S> {
        let bulge = self.template.bulge.read(at);
        let value = S::of(self.depth * self.depth) - bulge.value;
        if value.value() > 0.0 {
            Reading { value, slope: bulge.slope.map(|x| x * S::of(-0.5)) }
        } else {
            Reading { value: S::of(0.0), slope: [S::of(0.0); 2] }
        }
    }

    /// Tells the four sides of a tip apart; 0 away from tips.
    #[inline(always)]
    fn piece(&self, at: Vec2, height: f32) -> u32 {
        for (number, tip) in (0..).zip(&self.tips) {
            let from_tip = at - tip.corner;
            if from_tip.length_squared() < tip.radius * tip.radius {
                return 1
                    + 4 * number
                    + 2 * u32::from(from_tip.dot(tip.across) > 0.0)
                    + u32::from(height > 0.0);
            }
        }
        0
    }
}

impl Tip {
    fn all(template: &Template) -> Vec<Self> {
        let corners = &template.corners;
        let tip = |(i, &corner): (usize, &Vec2)| {
            let others = corners.iter().enumerate().filter(|(j, _)| *j != i);
            let radius = others.fold(template.depth, |r, (_, other)| r.min(0.5 * other.distance(corner)));
            let [a, b] = section::sides(template, corner)?;
            let (across, between) = ((a - b).try_normalize()?, (a + b).try_normalize()?);
            let is_solid = template.bulge.value(corner + 2.0 * template.bulge.pixel() * between) > 0.0;
            is_solid.then_some(Self { corner, across, radius })
        };
        corners.iter().enumerate().filter_map(tip).collect()
    }
}

impl Kernel for Inflated {
    #[inline(always)]
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let q = self.frame.apply(p);
        let (x, y) = (q[0].value(), q[1].value());
        let Rectangle { min, max } = self.reach;
        if !(x > min.x && x < max.x && y > min.y && y < max.y) {
            return Slope::constant(0.0);
        }
        let Reading { value: e2, slope: half_e } = self.below_top([q[0], q[1]]);
        let inverse = S::of(self.depth.powi(-2));
        let (contrast, by_square) = self.left_by_contrast(e2 * inverse);
        let press = self.left_by_pressure([q[0], q[1]]);
        let left = contrast * press.value * press.value;
        let up = S::of(self.stretch * self.stretch) * q[2] / left;
        let height2 = up * q[2];
        let m2 = self.squared_distance(e2, height2);
        // The square of what is beyond `full`, and its derivative by `m2`.
        let (over2, share) = if self.full == 0.0 {
            (m2, S::of(1.0))
        } else {
            let m = m2.sqrt();
            let over = (m - S::of(self.full)).larger(S::of(0.0));
            (over * over, over / m.larger(S::of(1e-6 * self.depth)))
        };
        let t = (S::of(1.0) - over2 * S::of(self.inv_reach2)).larger(S::of(0.0));
        // Half the derivatives of τ² along x, y and z: thinner parts are stretched more.
        let thinner = S::of(2.0) * by_square * inverse / contrast;
        let half_height = |a: usize| -height2 * (thinner * half_e[a] + press.slope[a] / press.value);
        let (of_e, of_height) = if self.flat {
            let inverse = S::of(1.0) / m2.larger(S::of(1e-12 * self.depth * self.depth));
            (e2 * inverse, height2 * inverse)
        } else {
            (S::of(1.0), S::of(1.0))
        };
        let gradient = [
            of_e * half_e[0] + of_height * half_height(0),
            of_e * half_e[1] + of_height * half_height(1),
            of_height * up,
        ];
        let slope = S::of(-6.0 * self.inv_reach2) * t * t * share;
        let piece = self.piece(Vec2::new(x, y), q[2].value());
        Slope::new(t * t * t, self.frame.pull_back(scaled(gradient, slope))).on(piece)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let range = self.frame.range(region);
        let area = across(&range);
        let Rectangle { min, max } = self.reach;
        if !(area.max.cmpgt(min).all() && area.min.cmplt(max).all()) {
            return Interval::ZERO;
        }
        let (low, high) = self.template.bulge.bound(area.min, area.max);
        let deepest = self.depth * self.depth;
        let slack = 2e-6 * (deepest + low.abs().max(high.abs()));
        let [least, most] = [deepest - high - slack, deepest - low + slack].map(|e2| e2.max(0.0));
        let contrast = |e2: f32| self.left_by_contrast(e2 / deepest).0 * (1.0 + 1e-6);
        let pressure = match self.template.pressure.as_ref().filter(|_| self.pressure > 0.0) {
            None => (1.0, 1.0),
            Some(image) => {
                let (low, high) = image.bound(area.min, area.max);
                let share = |x: f32| (1.0 - self.pressure + self.pressure * x).clamp(LIGHTEST, 1.0);
                (share(low), share(high))
            }
        };
        let (near, far) = range.abs(2);
        let height2 = |z: f32, contrast: f32, press: f32| (self.stretch * z / press).powi(2) / contrast;
        let (thin, thick) =
            (height2(near, contrast(least), pressure.1), height2(far, contrast(most), pressure.0));
        let low = self.squared_distance(least, thin).sqrt() * (1.0 - 4e-6);
        let high = self.squared_distance(most, thick).sqrt() * (1.0 + 4e-6);
        let slack = 4e-6 * self.depth;
        let bound = falloff_bound(low - slack - self.full, high + slack - self.full, self.inv_reach2);
        let is_within = area.min.cmpgt(min).all() && area.max.cmplt(max).all();
        if is_within { bound } else { Interval { lo: 0.0, ..bound } }
    }

    /// Only at tips: the bulge is smooth everywhere.
    fn creased(&self, region: &Aabb) -> bool {
        let range = self.frame.range(region);
        let area = across(&range);
        let reach = POINTED * self.template.bulge.pixel();
        let is_near = |tip: &Tip| {
            let gap = tip.corner - tip.corner.clamp(area.min, area.max);
            gap.length() <= reach.min(tip.radius)
        };
        range.abs(2).0 <= reach && self.tips.iter().any(is_near)
    }
}
