//! Which lines of a drawing are outlines, which are holes, and which are left out.

use super::chains::{self, Chain};
use super::closing;
use super::corners::Wishes;
use super::fair::{fair, turned};
use super::groups::groups;
use super::line::{Line, coarse};
use super::lobes::lobes;
use super::polygon;
use super::silhouette::{PENS, Silhouette, WIDE_PENS, silhouettes};
use super::{Contour, NoOutline};
use glam::DVec2;

/// Lines beyond this number are not looked at, the smallest first.
const MOST_LINES: usize = 1000;
/// Groups beyond this number are not looked at, the smallest first.
const MOST_GROUPS: usize = 100;
/// Groups below this are dots, in drawing sizes.
const LEAST_EXTENT: f64 = 0.01;
/// Groups smaller than this, in drawing sizes, are decorations if they do not close.
const WORTH_CLOSING: f64 = 0.5;
/// A group whose outlines have less than this share of the square of its extent may not be closed yet,
const OPEN_AREA: f64 = 0.15;
/// and is not, if closing it gives this many times as much
const GAIN: f64 = 2.5;
/// and at least this share.
const CLOSED_AREA: f64 = 0.04;
/// A line that goes around this share of the square of its extent is closed, however far its ends are apart up to
/// a share of the extent: people leave the bottom of a hand or of a bulb away.
const FAR_CLOSE: [(f64, f64); 2] = [(0.6, 0.08), (1., 0.15)];
/// Outlines that together are smaller than this, in drawing sizes, are details of something that does not close.
const LEAST_SHARE: f64 = 0.2;
/// A line longer than this many of its extents is a scribble, not an outline.
const LONGEST_LOOP: f64 = 40.;
/// How far a filled group may exceed its one closed line before the line is not the whole outline.
const MORE_THAN_THE_LINE: f64 = 0.03;
/// A line that encloses nothing though its ends are this near, in extents, goes back the way it came.
const FLAT_GAP: f64 = 0.15;
/// How often corners that touch other pieces are pulled back halfway,
const BLUNTINGS: usize = 4;
/// and how near they are, in extents.
const NEAR_CORNER: f64 = 0.02;
/// Pieces that cross each other even so are shrunk by this before the smaller one is given up.
const SHRINK: f64 = 0.003;

/// Closed curves, in the frame of the lines, and the strokes that make them.
#[derive(Default)]
pub(super) struct Outline {
    pub contours: Vec<Contour>,
    pub used: Vec<usize>,
}

impl Outline {
    fn area(&self) -> f64 {
        self.contours.iter().map(|contour| polygon::area(&contour.points).abs()).sum()
    }
}

/// Reads lines as outlines and holes.
pub(super) fn outline(mut lines: Vec<Line>, wishes: &Wishes, fill_holes: bool) -> Result<Outline, NoOutline> {
    let extent = |line: &Line| super::line::extent(&line.samples);
    if lines.len() > MOST_LINES {
        // Of a pattern of equal lines, rounding leaves some out everywhere, rather than all of one side.
        lines.sort_by(|a, b| extent(b).total_cmp(&extent(a)).then(a.stroke.cmp(&b.stroke)));
        lines.truncate(MOST_LINES);
    }
    lines.sort_by(|a, b| coarse(extent(b)).total_cmp(&coarse(extent(a))).then(a.stroke.cmp(&b.stroke)));
    let mut chains = chains::chains(lines);
    let mut bridges = chains::bridges(&chains);
    closing::close(&mut chains, &mut bridges);
    let mut groups: Vec<Group> = groups(&chains, &bridges)
        .into_iter()
        .map(|members| Group::of(&members, &chains, &bridges))
        .filter(|group| group.extent > LEAST_EXTENT)
        .collect();
    groups.sort_by(|a, b| coarse(b.extent).total_cmp(&coarse(a.extent)));
    groups.truncate(MOST_GROUPS);
    let mut found: Vec<Outline> = groups.iter().map(|group| group.outline(wishes)).collect();
    close_the_open(&groups, &mut found, wishes);
    let mut all = Outline::default();
    for outline in found {
        all.contours.extend(outline.contours);
        all.used.extend(outline.used);
    }
    all.contours = nested(apart(all.contours), fill_holes);
    let is_detail = joint_extent(std::slice::from_ref(&all)) < LEAST_SHARE;
    if is_detail { Err(reason(&chains)) } else { Ok(all) }
}

/// The extent of all contours together.
fn joint_extent(outlines: &[Outline]) -> f64 {
    let contours = outlines.iter().flat_map(|outline| &outline.contours);
    let places: Vec<DVec2> = contours.flat_map(|contour| &contour.points).copied().collect();
    polygon::extent(&places)
}

/// Lengths in the reason are in the frame of the lines.
fn reason(chains: &[Chain]) -> NoOutline {
    let longest = chains.iter().max_by(|a, b| a.extent().total_cmp(&b.extent()));
    match longest {
        None => NoOutline::Dots,
        Some(chain) if chain.closed || chain.gap() < FLAT_GAP * chain.extent() => NoOutline::Flat,
        Some(chain) => NoOutline::Open { gap: chain.gap() },
    }
}

/// Chains that touch.
struct Group<'a> {
    chains: Vec<&'a Chain>,
    bridges: Vec<[DVec2; 2]>,
    extent: f64,
}

impl<'a> Group<'a> {
    fn of(members: &[usize], chains: &'a [Chain], bridges: &[(usize, usize, [DVec2; 2])]) -> Self {
        let of_members = bridges.iter().filter(|(a, ..)| members.contains(a));
        let chains: Vec<&Chain> = members.iter().map(|&k| &chains[k]).collect();
        let places: Vec<DVec2> = chains.iter().flat_map(|chain| chain.path()).collect();
        Self {
            chains,
            bridges: of_members.map(|&(.., bridge)| bridge).collect(),
            extent: polygon::extent(&places),
        }
    }

    fn outline(&self, wishes: &Wishes) -> Outline {
        let Some((chain, contour)) = self.single_loop(wishes) else {
            return self.filled(wishes, &PENS);
        };
        if !is_simple(&contour) {
            let lobes = lobes(&contour).filter(|_| self.chains.len() == 1);
            let both = |lobes: [Contour; 2]| Outline { contours: lobes.into(), used: chain.strokes.clone() };
            return lobes.map_or_else(|| self.filled(wishes, &PENS), both);
        }
        if self.chains.len() == 1 {
            return Outline { contours: vec![contour], used: chain.strokes.clone() };
        }
        let filled = self.filled(wishes, &PENS);
        if filled.area() > (1. + MORE_THAN_THE_LINE) * polygon::area(&contour.points).abs() {
            return filled;
        }
        Outline { contours: vec![contour], used: chain.strokes.clone() }
    }

    /// The contour of the one closed chain; it may cross itself.
    fn single_loop(&self, wishes: &Wishes) -> Option<(&'a Chain, Contour)> {
        let mut closed = self.chains.iter().filter(|chain| chain.closed);
        let (chain, None) = (closed.next()?, closed.next()) else { return None };
        if super::line::length(&chain.samples) > LONGEST_LOOP * chain.extent() {
            return None;
        }
        Some((chain, fair(&chain.samples, wishes)?))
    }

    fn middle(&self) -> DVec2 {
        let places: Vec<DVec2> = self.chains.iter().flat_map(|chain| chain.path()).collect();
        let (least, most) = polygon::bounds(&places);
        least.midpoint(most)
    }

    /// The outlines with the largest open chain closed, though its ends are far from each other.
    fn closed_afar(&self, wishes: &Wishes) -> Option<Outline> {
        let open = self.chains.iter().filter(|chain| !chain.closed);
        let largest = open.max_by(|a, b| a.extent().total_cmp(&b.extent()))?;
        let places: Vec<DVec2> = largest.samples.iter().map(|sample| sample.at).collect();
        let extent = largest.extent();
        let area = polygon::area(&places).abs() / (extent * extent);
        if !FAR_CLOSE.iter().any(|&(gap, least)| largest.gap() < gap * extent && area > least) {
            return None;
        }
        let mut closed = (*largest).clone();
        closed.close();
        let others = self.chains.iter().filter(|chain| !std::ptr::eq(**chain, *largest)).copied();
        let chains = others.chain(std::iter::once(&closed)).collect();
        Some(Group { chains, bridges: self.bridges.clone(), extent: self.extent }.outline(wishes))
    }

    fn filled(&self, wishes: &Wishes, pens: &[f64]) -> Outline {
        let mut outline = Outline::default();
        for silhouette in silhouettes(&self.chains, &self.bridges, pens) {
            let Silhouette { samples, plain, wide, filled, strokes } = silhouette;
            let readings = [&samples, &plain, &wide, &filled];
            let fair = readings.into_iter().find_map(|samples| fair(samples, wishes).filter(is_simple));
            let rough = || Contour { points: filled.iter().map(|s| s.at).collect(), corners: Vec::new() };
            outline.contours.push(fair.unwrap_or_else(rough));
            outline.used.extend(strokes);
        }
        outline
    }
}

/// Whether smoothing left the contour without a crossing.
fn is_simple(contour: &Contour) -> bool {
    !polygon::cross(std::iter::once(&contour.points[..]))
}

/// Closes large groups that enclose next to nothing and do not lie in what others enclose.
fn close_the_open(groups: &[Group], found: &mut [Outline], wishes: &Wishes) {
    for (k, group) in groups.iter().enumerate() {
        let nothing_yet = found.iter().all(|outline| outline.contours.is_empty());
        let square = group.extent * group.extent;
        if !(nothing_yet || group.extent > WORTH_CLOSING) || found[k].area() > OPEN_AREA * square {
            continue;
        }
        let enough = (CLOSED_AREA * square).max(GAIN * found[k].area());
        let middle = group.middle();
        let others = found.iter().enumerate().filter(|&(other, _)| other != k).map(|(_, outline)| outline);
        if others.flat_map(|o| &o.contours).any(|c| polygon::contains(&c.points, middle)) {
            continue;
        }
        let wider = std::iter::once_with(|| group.filled(wishes, &WIDE_PENS));
        if let Some(better) =
            group.closed_afar(wishes).into_iter().chain(wider).find(|outline| outline.area() > enough)
        {
            found[k] = better;
        }
    }
    let total: f64 = found.iter().map(Outline::area).sum();
    if total < CLOSED_AREA && joint_extent(found) < WORTH_CLOSING && !groups.is_empty() {
        let all = Group {
            chains: groups.iter().flat_map(|group| group.chains.iter().copied()).collect(),
            bridges: groups.iter().flat_map(|group| group.bridges.iter().copied()).collect(),
            extent: 1.,
        };
        let better = all.filled(wishes, &WIDE_PENS);
        if better.area() > CLOSED_AREA {
            found.iter_mut().for_each(|outline| *outline = Outline::default());
            found[0] = better;
        }
    }
}

/// Contours that do not cross: those that do are shrunk a little, then the smaller ones left away.
fn apart(mut contours: Vec<Contour>) -> Vec<Contour> {
    contours.sort_by(|a, b| polygon::area(&b.points).abs().total_cmp(&polygon::area(&a.points).abs()));
    let mut kept: Vec<Contour> = Vec::new();
    for mut contour in contours {
        let crosses = |contour: &Contour, kept: &[Contour]| {
            kept.iter().any(|other| {
                let both = [&other.points[..], &contour.points];
                polygon::near(both) && polygon::cross(both.into_iter())
            })
        };
        for _ in 0..BLUNTINGS {
            if crosses(&contour, &kept) {
                blunt_near(&mut contour, &kept);
            }
        }
        for _ in 0..3 {
            if crosses(&contour, &kept) {
                let middle = contour.points.iter().sum::<DVec2>() / contour.points.len() as f64;
                contour.points.iter_mut().for_each(|p| *p += SHRINK * (middle - *p));
            }
        }
        if !crosses(&contour, &kept) {
            kept.push(contour);
        }
    }
    kept
}

/// Pulls corners back that lie near other contours: lobes of a line that crosses itself have theirs in common.
fn blunt_near(contour: &mut Contour, others: &[Contour]) {
    let n = contour.points.len();
    let near = NEAR_CORNER * polygon::extent(&contour.points);
    for &i in &contour.corners {
        let at = contour.points[i];
        if others.iter().flat_map(|other| &other.points).any(|p| p.distance(at) < near) {
            let behind = contour.points[(i + n - 1) % n].midpoint(contour.points[(i + 1) % n]);
            contour.points[i] = at.lerp(behind, 0.5);
        }
    }
}

/// Outlines counter-clockwise and holes clockwise, by how many others they lie in.
fn nested(contours: Vec<Contour>, fill_holes: bool) -> Vec<Contour> {
    let around = |contour: &Contour| {
        let own = polygon::area(&contour.points).abs();
        let larger = contours.iter().filter(|other| polygon::area(&other.points).abs() > own);
        larger.filter(|other| polygon::contains(&other.points, contour.points[0])).count()
    };
    let depths: Vec<usize> = contours.iter().map(around).collect();
    let with_depth = contours.into_iter().zip(depths).filter(|(_, depth)| !fill_holes || *depth == 0);
    with_depth.map(|(contour, depth)| turned(contour, depth % 2 == 0)).collect()
}
