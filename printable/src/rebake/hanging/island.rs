//! Regions that share no area with the layer below.

use super::Pair;
use crate::slices::clip::{Clipper, Region, is_rounding, pairs, perimeter, total};
use crate::slices::grid::Point;
use crate::slices::outline::{Outline, clipped, is_in, rings};
use crate::slices::rect::Rect;
use glam::DVec2;

/// Sides of each outline beside which it is looked whether both layers are solid there.
const PROBES: usize = 16;

/// How far beside an outline that is, in steps of the grid: what both share has to be as wide as that.
const BESIDE: f64 = 16_384.0;

/// What is no longer than so many reaches is looked at exactly: a speck may touch what is below by less than a probe sees.
const SPECK: f64 = 4.0;

/// Room around an outline, in steps of the grid, that shows where regions end.
const ROOM: i32 = 4;

impl Pair<'_> {
    /// The islands of the layer that have one of the outlines `asked` for; what is gone is no longer below.
    pub(super) fn islands(&self, clipper: &mut Clipper, asked: impl Fn(&Outline) -> bool) -> Vec<Region> {
        let mut islands = Vec::new();
        for outline in self.layer.iter().filter(|outline| asked(outline) && outline.is_outer()) {
            if !self.is_surely_carried(outline) {
                islands.extend(self.islands_within(&outline.rect, clipper));
            }
        }
        islands.sort_unstable();
        islands.dedup();
        islands
    }

    /// Whether this is no speck, and a probe finds both layers solid in its region.
    fn is_surely_carried(&self, outline: &Outline) -> bool {
        if outline.rect.diagonal() < SPECK * f64::from(self.reach.steps()) {
            return false;
        }
        let inner = self.layer.iter().filter(|other| outline.rect.encloses(&other.rect) && other.is_outer());
        let inner: Vec<&Outline> = inner.collect();
        let is_shared = |p: Point| {
            let own = outline.winding(p) != 0 && inner.iter().all(|inner| inner.winding(p) == 0);
            own && is_solid(self.layer, p) && is_solid(self.below, p) && !is_in(self.gone, p)
        };
        let near = self.below.iter().filter(|below| below.rect.is_near(&outline.rect, 0));
        [outline].into_iter().chain(near).flat_map(|outline| probes(&outline.ring)).any(is_shared)
    }

    /// The islands in a box, off its rim.
    fn islands_within(&self, rect: &Rect, clipper: &mut Clipper) -> Vec<Region> {
        let rect = rect.widened(ROOM);
        let [layer, below] = [self.layer, self.below].map(|outlines| clipped(outlines, &rect));
        let mut below = clipper.fill(&rings(&below)[..]);
        if !self.gone.is_empty() {
            below = clipper.difference(&below, self.gone);
        }
        let mut islands = clipper.fill(&rings(&layer)[..]);
        islands.retain(|region| {
            let is_whole = Rect::around([region]).is_some_and(|own| rect.encloses(&own));
            is_whole && is_rounding(total(&clipper.intersection(region, &below)), perimeter(region))
        });
        islands
    }
}

fn is_solid(outlines: &[Outline], p: Point) -> bool {
    outlines.iter().map(|outline| outline.winding(p)).sum::<i32>() > 0
}

/// Places beside the middles of some sides of a ring, on the left.
fn probes(ring: &[Point]) -> impl Iterator<Item = Point> + '_ {
    let every = ring.len().div_ceil(PROBES).max(1);
    pairs(ring).step_by(every).map(|(a, b)| {
        let [a, b] = [a, b].map(|p| DVec2::new(f64::from(p.x), f64::from(p.y)));
        let beside = 0.5 * (a + b) + BESIDE * (b - a).perp().normalize_or_zero();
        Point::new(beside.x.round() as i32, beside.y.round() as i32)
    })
}
