//! Gaps that whoever drew would close: outlines left open by far more than a slip of the pen.

use super::chains::Chain;
use super::groups::groups;
use super::line::{coarse, extent};
use super::polygon;
use super::raster::Raster;
use glam::DVec2;

/// Cells across the drawing on which what a closing encloses is measured.
const CELLS: usize = 160;
/// A closing must enclose this many times the square of its length: half a disc encloses 0.39 of its diameter's.
const GAIN: f64 = 0.33;
/// Smaller chains than this are decorations, in drawing sizes.
const LEAST_EXTENT: f64 = 0.05;
/// A chain whose ends are this near, in its extents, is a loop not quite closed: the wheel of a car,
const NEARLY: f64 = 0.35;
/// if it encloses this share of the square of its extent.
const LOOP_AREA: f64 = 0.04;
/// Ends may be this far apart, in extents of the chain, if closing it encloses
const FARTHEST: f64 = 1.05;
/// this share of the square of its extent
const WIDE_AREA: f64 = 0.1;
/// and this share of what is enclosed already: the bowl of a glass, the body of a bottle, but no ear of a bear.
const COMPARABLE: f64 = 0.25;
/// Ends of two chains may be this far apart, in extents of their group: the bottom of a bottle left away, but not
/// the floor under a table,
const BETWEEN: f64 = 0.45;
/// if that encloses this many times the square of the distance: a bottle is long, two rods of a tent are not,
const BETWEEN_GAIN: f64 = 0.8;
/// this share of the drawing's square, and as much as all that is enclosed already.
const BETWEEN_AREA: f64 = 0.04;
/// Two straight lines from a tip are legs or a roof rather than an outline, if they are straight to this, in
/// extents.
const STRAIGHT: f64 = 0.06;
/// Chains beyond this number are not looked at, the smallest first.
const MOST: usize = 16;

/// A line between two chains, or from a chain to itself.
pub(super) type Bridge = (usize, usize, [DVec2; 2]);

/// A gap that could be closed.
struct Gap {
    chains: [usize; 2],
    ends: [DVec2; 2],
    /// Extent of the chain or of the group that it is a gap of.
    extent: f64,
    /// Whether neither end leads on to another line.
    is_free: bool,
}

impl Gap {
    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Whether to close it, given what that encloses and what is enclosed already.
    fn is_left_open(&self, gain: f64, already: f64, chains: &[Chain]) -> bool {
        let (length, square) = (self.length(), self.extent * self.extent);
        if gain < GAIN * length * length {
            return false;
        }
        if self.chains[0] != self.chains[1] {
            return gain > BETWEEN_AREA.max(already).max(BETWEEN_GAIN * length * length);
        }
        if already > 0. && is_pointed(&chains[self.chains[0]]) {
            return false;
        }
        length < NEARLY * self.extent && gain > LOOP_AREA * square
            || self.is_free && gain > (WIDE_AREA * square).max(COMPARABLE * already)
    }
}

/// Closes chains, and adds bridges between the ends of different ones, where that encloses much for its length.
///
/// What is enclosed already, such as a smiling mouth in a face, gains nothing and stays open.
pub(super) fn close(chains: &mut [Chain], bridges: &mut Vec<Bridge>) {
    let gaps = gaps(chains, bridges);
    if gaps.is_empty() {
        return;
    }
    let raster = Raster::over(DVec2::splat(-0.5), DVec2::splat(0.5), CELLS, 0.02);
    let mut painted = vec![false; raster.count()];
    let paint = |path: &[DVec2], painted: &mut Vec<bool>| raster.paint(path, |cell| painted[cell] = true);
    chains.iter().for_each(|chain| paint(&chain.path(), &mut painted));
    bridges.iter().for_each(|(.., bridge)| paint(bridge, &mut painted));
    let enclosed = |painted: &[bool]| {
        let outside = raster.outside(|i| !painted[i]);
        let inside = (0..raster.count()).filter(|&i| !outside[i] && !painted[i]).count();
        inside as f64 * raster.cell * raster.cell
    };
    let mut already = enclosed(&painted);
    for gap in gaps {
        let mut closed = painted.clone();
        paint(&gap.ends, &mut closed);
        let then = enclosed(&closed);
        if !gap.is_left_open(then - already, already, chains) {
            continue;
        }
        (painted, already) = (closed, then);
        let [a, b] = gap.chains;
        if a == b {
            chains[a].close();
        } else {
            bridges.push((a, b, gap.ends));
        }
    }
}

/// The gaps worth a look: those between the ends of one chain, the largest chain first, then those between
/// chains, the nearest ends first.
fn gaps(chains: &[Chain], bridges: &[Bridge]) -> Vec<Gap> {
    let mut open: Vec<(usize, f64)> =
        chains.iter().enumerate().filter(|(_, c)| !c.closed).map(|(i, c)| (i, c.extent())).collect();
    open.retain(|&(_, extent)| extent > LEAST_EXTENT);
    open.sort_by(|a, b| coarse(b.1).total_cmp(&coarse(a.1)).then(a.0.cmp(&b.0)));
    open.truncate(MOST);
    if open.is_empty() {
        return Vec::new();
    }
    let ends = |i: usize| [chains[i].samples[0].at, chains[i].samples[chains[i].samples.len() - 1].at];
    let leans = |at: &DVec2| bridges.iter().any(|(.., bridge)| bridge[0] == *at);
    let is_free = |ends: [DVec2; 2]| !ends.iter().any(leans);
    let own = open.iter().map(|&(i, extent)| {
        let ends = ends(i);
        Gap { chains: [i, i], ends, extent, is_free: is_free(ends) }
    });
    let mut gaps: Vec<Gap> = own.filter(|gap| gap.length() <= FARTHEST * gap.extent).collect();
    let mut between = Vec::new();
    for group in groups(chains, bridges).iter().filter(|group| group.len() > 1) {
        let places: Vec<DVec2> =
            group.iter().flat_map(|&i| &chains[i].samples).map(|sample| sample.at).collect();
        let extent = polygon::extent(&places);
        let members: Vec<usize> = open.iter().map(|&(i, _)| i).filter(|i| group.contains(i)).collect();
        for (k, &a) in members.iter().enumerate() {
            for &b in &members[k + 1..] {
                let pairs = ends(a).into_iter().flat_map(|p| ends(b).map(|q| [p, q]));
                let free = pairs.filter(|&ends| is_free(ends));
                between.extend(free.map(|ends| Gap { chains: [a, b], ends, extent, is_free: true }));
            }
        }
    }
    between.retain(|gap| gap.length() <= BETWEEN * gap.extent);
    between.sort_by(|a, b| coarse(a.length()).total_cmp(&coarse(b.length())).then(a.chains.cmp(&b.chains)));
    between.truncate(4 * MOST);
    gaps.extend(between);
    gaps
}

/// Whether the chain is two straight lines from a tip.
fn is_pointed(chain: &Chain) -> bool {
    let places: Vec<DVec2> = chain.samples.iter().map(|sample| sample.at).collect();
    let (first, last) = (places[0], places[places.len() - 1]);
    let off = |p: DVec2, a: DVec2, b: DVec2| {
        (b - a).try_normalize().map_or(p.distance(a), |along| along.perp_dot(p - a).abs())
    };
    let far = |&(_, p): &(usize, &DVec2)| off(*p, first, last);
    let Some((tip, &at)) = places.iter().enumerate().max_by(|a, b| far(a).total_cmp(&far(b))) else {
        return false;
    };
    let most = STRAIGHT * extent(&chain.samples);
    places[..tip].iter().all(|&p| off(p, first, at) < most)
        && places[tip..].iter().all(|&p| off(p, at, last) < most)
}
