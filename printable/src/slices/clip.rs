//! Sets of regions in the plane: filling, subtracting, growing. All on one [`Grid`](super::grid::Grid).

use super::grid::Point;
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::{Precision, Solver, Strategy};
use i_overlay::i_float::int::angle::Angle;
use i_overlay::i_shape::source::int::resource::IntShapeResource;
use i_overlay::mesh::int::arc::ArcOptions;
use i_overlay::mesh::int::outline::offset::IntOutlineOffset;
use i_overlay::mesh::int::style::{IntLineJoin, IntOutlineStyle};
use std::f64::consts::TAU;

/// One connected region: its outline counter-clockwise, then its holes clockwise.
pub(crate) type Region = Vec<Vec<Point>>;

/// How far the straight pieces of a round corner may lie inside the true arc, mm.
const ARC_ERROR_MM: f64 = 0.000_3;

/// From so many points on, the clipper looks for crossings in columns of the plane instead of along one sweep: with the
/// short sides of outlines, that takes about half the time.
const MANY: usize = 2_000;

/// Rings of points, in any containers.
pub(crate) trait Rings: IntShapeResource<i32> {}

impl<R: IntShapeResource<i32> + ?Sized> Rings for R {}

/// What is narrower than this many steps, on average, comes from rounding.
pub(crate) const ROUNDING: f64 = 4.0;

/// A clipper whose memory is used again and again.
pub(crate) struct Clipper {
    overlay: Overlay<i32>,
    points: usize,
}

impl Clipper {
    pub(crate) fn new() -> Self {
        Self { overlay: Overlay::new(0), points: 0 }
    }

    /// The regions around which `loops` wind a positive number of times.
    pub(crate) fn fill(&mut self, loops: &(impl Rings + ?Sized)) -> Vec<Region> {
        self.clear();
        self.add(loops, ShapeType::Subject);
        self.combined(OverlayRule::Subject)
    }

    /// What is in `a` and not in `b`; both are regions, or loops as for [`Self::fill`].
    pub(crate) fn difference(&mut self, a: &(impl Rings + ?Sized), b: &(impl Rings + ?Sized)) -> Vec<Region> {
        self.combine(a, b, OverlayRule::Difference)
    }

    /// What is in both; regions or loops.
    pub(crate) fn intersection(
        &mut self,
        a: &(impl Rings + ?Sized),
        b: &(impl Rings + ?Sized),
    ) -> Vec<Region> {
        self.combine(a, b, OverlayRule::Intersect)
    }

    fn combine(
        &mut self,
        a: &(impl Rings + ?Sized),
        b: &(impl Rings + ?Sized),
        rule: OverlayRule,
    ) -> Vec<Region> {
        self.clear();
        self.add(a, ShapeType::Subject);
        self.add(b, ShapeType::Clip);
        self.combined(rule)
    }

    fn clear(&mut self) {
        self.overlay.clear();
        self.points = 0;
    }

    fn add(&mut self, rings: &(impl Rings + ?Sized), role: ShapeType) {
        self.points += rings.iter_paths().map(<[Point]>::len).sum::<usize>();
        self.overlay.add_source(rings, role);
    }

    fn combined(&mut self, rule: OverlayRule) -> Vec<Region> {
        let strategy = if self.points < MANY { Strategy::Auto } else { Strategy::Frag };
        // Layers have a thread each, so none more is asked for.
        self.overlay.solver = Solver { strategy, precision: Precision::HIGH, multithreading: None };
        self.overlay.overlay(rule, FillRule::Positive)
    }
}

/// The regions grown by a disc of `radius` (shrunk, if negative); both lengths in mm, `step` that of the grid.
///
/// Straight pieces are exact to the grid, arcs lie up to 0.3 µm too far inside.
pub(crate) fn grown(regions: &[Region], radius: f64, step: f64) -> Vec<Region> {
    let bend = 2.0 * (1.0 - ARC_ERROR_MM / radius.abs().max(ARC_ERROR_MM)).acos();
    let max_step = Angle::from_bits((bend.min(TAU / 8.0) / TAU * 2f64.powi(32)) as u32);
    let round = IntLineJoin::Round(ArcOptions { max_step, rotation_precision: 32 });
    let style = IntOutlineStyle::new((radius / step).round() as i32).line_join(round);
    regions.outline(&style).expect("construction itself reports no errors, and the grid leaves room to grow")
}

/// Most points in a row that are left out of an outline.
const MOST_LEFT_OUT: usize = 64;

/// The regions with no more points than their outlines need: what is left out lies within the error of arcs.
///
/// Outlines that are grown, cut and grown again would otherwise gather the arcs of all their pasts.
pub(crate) fn thinned<'a>(regions: impl IntoIterator<Item = &'a Region>, step: f64) -> Vec<Region> {
    let off = ARC_ERROR_MM / step;
    let thin = |region: &Region| region.iter().map(|ring| thinned_ring(ring, off)).collect();
    regions.into_iter().map(thin).collect()
}

/// A ring without the points that are within `off` steps of the straight way between those kept; at least three.
fn thinned_ring(ring: &[Point], off: f64) -> Vec<Point> {
    let ends: Vec<Point> = ring.iter().chain(ring.first()).copied().collect();
    let mut kept = Vec::new();
    let mut from = 0;
    while from + 1 < ends.len() {
        kept.push(ends[from]);
        let farthest = (from + MOST_LEFT_OUT).min(ends.len() - 1);
        let fits =
            |to: &usize| ends[from + 1..*to].iter().all(|p| is_near_way(*p, ends[from], ends[*to], off));
        from = (from + 2..=farthest).take_while(fits).last().unwrap_or(from + 1);
    }
    if kept.len() < 3 { ring.to_vec() } else { kept }
}

/// Whether a point is within `off` of the straight way from one to another.
pub(crate) fn is_near_way(p: Point, from: Point, to: Point, off: f64) -> bool {
    let vector =
        |a: Point, b: Point| DVec2::new(f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
    let (along, at) = (vector(from, to), vector(from, p));
    let share = (at.dot(along) / along.length_squared().max(1.0)).clamp(0.0, 1.0);
    at.distance_squared(share * along) <= off * off
}

/// Area in square steps.
pub(crate) fn area(region: &Region) -> f64 {
    region.iter().map(|ring| doubled_area(ring) as f64 * 0.5).sum()
}

/// Area of all regions, in square steps.
pub(crate) fn total(regions: &[Region]) -> f64 {
    regions.iter().map(area).fold(0.0, |sum, area| sum + area)
}

/// Twice the signed area of a ring, in square steps, exact.
pub(crate) fn doubled_area(ring: &[Point]) -> i128 {
    pairs(ring)
        .map(|(a, b)| i128::from(i64::from(a.x) * i64::from(b.y) - i64::from(a.y) * i64::from(b.x)))
        .sum()
}

/// Length of all outlines, in steps.
pub(crate) fn perimeter(region: &Region) -> f64 {
    region.iter().flat_map(|ring| pairs(ring)).map(|(a, b)| distance(a, b)).sum()
}

/// Whether an area, in square steps, is no wider along a rim of so many steps than rounding explains.
pub(crate) fn is_rounding(area: f64, rim: f64) -> bool {
    2.0 * area <= ROUNDING * rim
}

/// The sides of a ring.
pub(crate) fn pairs(ring: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    let next = ring.iter().skip(1).chain(ring.first());
    ring.iter().copied().zip(next.copied())
}

/// In steps.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (f64::from(a.x) - f64::from(b.x)).hypot(f64::from(a.y) - f64::from(b.y))
}
