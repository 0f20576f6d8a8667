//! A drawing's template as the cross-section of a solid.

use crate::falloff::Falloff;
use crate::scalar::Scalar;
use crate::sketched::{Reading, Rectangle, Template};
use glam::Vec2;
use std::sync::Arc;

/// A template, and where it matters.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    template: Arc<Template>,
    /// Where the distance may be below the falloff's width; empty if it never is.
    reach: Rectangle,
    /// The distance everywhere else: so much that no field is left.
    far: f32,
    ridges: Vec<Ridge>,
}

/// Within how many pixels of a corner the distance goes over to that of its two straight sides.
const SHARPENED: f32 = 4.0;

/// A sharp corner. The image rounds it by about a pixel; close to it, the distance from its sides takes over.
#[derive(Clone, Copy, Debug)]
struct Ridge {
    corner: Vec2,
    /// Across the line through the corner along which the gradient jumps; unit length.
    across: Vec2,
    /// How far from the corner its line is looked for; those of two corners do not overlap.
    radius: f32,
    /// Across both sides, away from what lies between them; unit length.
    sides: [Vec2; 2],
    /// 1 if what lies between the sides is solid, else −1.
    sign: f32,
    /// Up to where the sides count.
    sharpened: f32,
}

/// The falloff of a solid made from a template, which is right only as far as it was solved for.
pub(crate) fn falloff(width: Option<f32>, depth: f32, template: &Template) -> Falloff {
    let wanted = Falloff::new(width, depth);
    if wanted.width() <= template.falloff { wanted } else { Falloff::of_width(template.falloff) }
}

/// Where the template's distance may be below `width`.
pub(crate) fn reach(template: &Template, width: f32) -> Option<Rectangle> {
    template.distance.below(width)
}

impl Section {
    pub fn new(template: &Arc<Template>, falloff: &Falloff) -> Self {
        let width = falloff.width();
        let nowhere = Rectangle { min: Vec2::splat(f32::MAX), max: Vec2::splat(f32::MIN) };
        Self {
            template: template.clone(),
            reach: reach(template, width).unwrap_or(nowhere),
            far: 2.0 * width,
            ridges: Ridge::all(template),
        }
    }

    pub fn reach(&self) -> Rectangle {
        self.reach
    }

    /// The distance where there is nothing.
    pub fn far(&self) -> f32 {
        self.far
    }

    /// Signed distance and its gradient.
    #[inline(always)]
    pub fn read<S: Scalar>(&self, at: [S; 2]) -> Reading<S> {
        let (x, y) = (at[0].value(), at[1].value());
        let Rectangle { min, max } = self.reach;
        if !(x > min.x && x < max.x && y > min.y && y < max.y) {
            return Reading { value: S::of(self.far), slope: [S::of(0.0); 2] };
        }
        let mut reading = self.template.distance.read(at);
        for ridge in &self.ridges {
            let (dx, dy) = (x - ridge.corner.x, y - ridge.corner.y);
            if dx * dx + dy * dy < ridge.sharpened * ridge.sharpened {
                reading = ridge.sharpen(at, reading);
            }
        }
        reading
    }

    /// Tells apart the two sides of the lines that run into corners; 0 away from corners.
    #[inline(always)]
    pub fn piece(&self, at: [f32; 2]) -> u32 {
        let at = Vec2::from_array(at);
        for (number, ridge) in (0..).zip(&self.ridges) {
            let from_corner = at - ridge.corner;
            if from_corner.length_squared() < ridge.radius * ridge.radius {
                return 1 + 2 * number + u32::from(from_corner.dot(ridge.across) > 0.0);
            }
        }
        0
    }

    /// Bounds of the distance in a rectangle.
    pub fn bound(&self, area: &Rectangle) -> (f32, f32) {
        let Rectangle { min, max } = self.reach;
        if !(area.max.cmpgt(min).all() && area.min.cmplt(max).all()) {
            return (self.far, self.far);
        }
        let (mut lo, mut hi) = self.template.distance.bound(area.min, area.max);
        for ridge in &self.ridges {
            if let Some(sides) = ridge.bound(area) {
                (lo, hi) = (lo.min(sides.0), hi.max(sides.1));
            }
        }
        let slack = 1e-6 * (lo.abs() + hi.abs());
        let is_within = area.min.cmpgt(min).all() && area.max.cmplt(max).all();
        if is_within {
            (lo - slack, hi + slack)
        } else {
            ((lo - slack).min(self.far), (hi + slack).max(self.far))
        }
    }

    /// Whether the gradient may jump in a rectangle.
    pub fn creased(&self, area: &Rectangle) -> bool {
        let (center, half) = (0.5 * (area.min + area.max), 0.5 * (area.max - area.min));
        let blur = 2.0 * self.template.distance.pixel();
        self.ridges.iter().any(|ridge| {
            let from_corner = center - ridge.corner;
            let gap = (from_corner.abs() - half).max(Vec2::ZERO).length();
            let across = from_corner.dot(ridge.across).abs();
            gap <= ridge.radius + blur && across <= ridge.across.abs().dot(half) + blur
        })
    }
}

impl Ridge {
    fn all(template: &Template) -> Vec<Self> {
        let farthest = template.falloff.max(template.depth);
        let corners = &template.corners;
        let radius = |i: usize| {
            let others = corners.iter().enumerate().filter(|(j, _)| *j != i);
            others.fold(farthest, |r, (_, other)| r.min(0.5 * other.distance(corners[i])))
        };
        (0..corners.len()).filter_map(|i| Self::new(template, corners[i], radius(i))).collect()
    }

    fn new(template: &Template, corner: Vec2, radius: f32) -> Option<Self> {
        let pixel = template.distance.pixel();
        let [a, b] = sides(template, corner)?;
        let (across, between) = ((a - b).try_normalize()?, (a + b).try_normalize()?);
        let away = |side: Vec2| if side.perp().dot(between) < 0.0 { side.perp() } else { -side.perp() };
        let is_solid = template.distance.value(corner + 2.0 * pixel * between) < 0.0;
        let (sides, sign) = ([away(a), away(b)], if is_solid { 1.0 } else { -1.0 });
        Some(Self { corner, across, radius, sides, sign, sharpened: radius.min(SHARPENED * pixel) })
    }

    /// The reading of the image at a place near the corner, with the sides counting ever more towards it.
    #[inline(always)]
    fn sharpen<S: Scalar>(&self, at: [S; 2], image: Reading<S>) -> Reading<S> {
        let from_corner = [at[0] - S::of(self.corner.x), at[1] - S::of(self.corner.y)];
        let dot = |v: Vec2| S::of(v.x) * from_corner[0] + S::of(v.y) * from_corner[1];
        let [a, b] = self.sides.map(dot);
        let (side, normal) = if a.value() > b.value() { (a, self.sides[0]) } else { (b, self.sides[1]) };
        let (side, normal) = (S::of(self.sign) * side, self.sign * normal);
        let inverse = S::of(self.sharpened.powi(-2));
        let square = from_corner[0] * from_corner[0] + from_corner[1] * from_corner[1];
        let t = (S::of(1.0) - square * inverse).larger(S::of(0.0));
        let (weight, more) = (t * t * t, side - image.value);
        let fading = S::of(-6.0) * inverse * t * t * more;
        let slope = |axis: usize| {
            let own = S::of(normal[axis]) - image.slope[axis];
            image.slope[axis] + weight * own + fading * from_corner[axis]
        };
        Reading { value: image.value + weight * more, slope: [slope(0), slope(1)] }
    }

    /// Bounds of the distance from the sides in the part of an area where they count.
    fn bound(&self, area: &Rectangle) -> Option<(f32, f32)> {
        let reach = Vec2::splat(self.sharpened);
        let (min, max) = (area.min.max(self.corner - reach), area.max.min(self.corner + reach));
        if min.cmpgt(max).any() {
            return None;
        }
        let (center, half) = (0.5 * (min + max) - self.corner, 0.5 * (max - min));
        let side = |side: Vec2| (side.dot(center), side.abs().dot(half) + 1e-6 * self.corner.length());
        let [(a, da), (b, db)] = self.sides.map(side);
        let (lo, hi) = ((a - da).max(b - db), (a + da).max(b + db));
        Some(if self.sign > 0.0 { (lo, hi) } else { (-hi, -lo) })
    }
}

/// The directions of the curve on both sides of a corner, away from it.
pub(super) fn sides(template: &Template, corner: Vec2) -> Option<[Vec2; 2]> {
    let distance =
        |(contour, point): (usize, usize)| template.contours[contour][point].distance_squared(corner);
    let all =
        template.contours.iter().enumerate().flat_map(|(c, points)| (0..points.len()).map(move |p| (c, p)));
    let nearest = all.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    let points = &template.contours[nearest.0];
    // Far enough that the curve's own samples do not matter, near enough that its bends do not.
    let step = 3.0 * template.distance.pixel();
    let walk = |forward: bool| {
        let count = points.len();
        let at = |i: usize| points[(nearest.1 + if forward { i } else { count - i }) % count];
        let found = (1..count).map(at).find(|p| p.distance(corner) >= step);
        found.and_then(|p| (p - corner).try_normalize())
    };
    Some([walk(true)?, walk(false)?])
}
