//! Where a closed line has sharp corners.

use super::line::Sample;
use glam::DVec2;

/// How far the directions of the two sides are taken, in extents of the contour, where nothing shakes. Shorter,
/// and single samples of a simplified line are corners; longer, and the tips of slim ellipses are.
const REACH: f64 = 0.025;
/// With more noise than this, in extents, a direction needs
pub(super) const STEADY: f64 = 5e-4;
/// at least so many samples, but no more than this length, in extents: longer, and the tips of ellipses are corners.
const LEAST_IN_REACH: f64 = 5.;
const FARTHEST_FOR_THAT: f64 = 0.06;
/// The same where only the places are kept at which the line bends: two or three of them make a blunt tip.
const SPARSE_REACH: f64 = 0.04;
/// The least turn of a corner, radians: a heptagon's corners are, a circle of nine samples has none.
const LEAST_TURN: f64 = 0.7;
/// Fillets below this radius are corners, in extents; those of a rounded square of 0.08 are not.
const LARGEST_FILLET: f64 = 0.025;
/// What lengths along the line may be off, in shares: evenly spaced samples lie just on the ends of a reach.
const ROUNDING: f64 = 1e-6;
/// A place asked to be sharp or round concerns corners this near, in extents.
pub(super) const NEAR: f64 = 0.05;

/// Where only the places are kept at which a line bends, it goes straight between them to this, in drawing sizes:
/// programs that thin lines out leave 2 of 255 pixels. An arc through a corner would leave its edges further.
const STRAIGHT: f64 = 0.01;

/// Places of the user's wishes.
#[derive(Clone, Debug, Default)]
pub(super) struct Wishes {
    pub rounded: Vec<DVec2>,
    pub sharpened: Vec<DVec2>,
}

/// A closed line as the search sees it.
pub(super) struct Closed<'a> {
    pub samples: &'a [Sample],
    /// Length along the line up to each sample, and all around as the last.
    pub lengths: &'a [f64],
    pub extent: f64,
    pub noise: f64,
    /// Whether only places were kept at which the line bends.
    pub sparse: bool,
    /// Samples that are corners for sure, ascending.
    pub known: &'a [usize],
}

/// A straight line fitted to a side.
#[derive(Clone, Copy)]
struct Side {
    middle: DVec2,
    /// Along the stroke, of length 1.
    direction: DVec2,
}

/// A sample that may be a corner, and how far the line turns there.
struct Candidate {
    sample: usize,
    turn: f64,
}

impl Closed<'_> {
    fn around(&self) -> f64 {
        self.lengths[self.samples.len()]
    }

    fn spacing(&self) -> f64 {
        let drawn = self.samples.iter().filter(|sample| sample.weight > 0.5).count();
        self.around() / drawn.max(1) as f64
    }

    /// The samples from `from` to `to` along the line before (`forward` false) or after sample `i`.
    fn stretch(&self, i: usize, forward: bool, from: f64, to: f64) -> impl Iterator<Item = (f64, usize)> {
        let n = self.samples.len();
        (0..n)
            .map(move |k| {
                let j = if forward { (i + k) % n } else { (i + n - k) % n };
                let gone = if forward {
                    self.lengths[j] - self.lengths[i]
                } else {
                    self.lengths[i] - self.lengths[j]
                };
                (if gone < 0. { gone + self.around() } else { gone }, j)
            })
            .take_while(move |&(gone, _)| gone <= to * (1. + ROUNDING))
            .filter(move |&(gone, _)| gone >= from * (1. - ROUNDING))
    }

    fn side(&self, i: usize, forward: bool, from: f64, to: f64) -> Option<Side> {
        let (mut weight, mut place, mut gone, mut squares, mut mixed) =
            (0., DVec2::ZERO, 0., 0., DVec2::ZERO);
        for (s, j) in self.stretch(i, forward, from, to) {
            let Sample { at, weight: w, .. } = self.samples[j];
            weight += w;
            place += w * at;
            gone += w * s;
            squares += w * s * s;
            mixed += w * s * at;
        }
        let slope = (mixed - gone * place / weight) / (squares - gone * gone / weight);
        let direction = if forward { slope } else { -slope }.try_normalize()?;
        Some(Side { middle: place / weight, direction })
    }

    /// Positive to the left.
    fn turn(&self, i: usize, reach: f64) -> f64 {
        let sides = self.side(i, false, 0., reach).zip(self.side(i, true, 0., reach));
        sides.map_or(0., |(before, after)| before.direction.angle_to(after.direction))
    }

    /// Whether the places around sample `i` may be all that is left of an arc: one that turns as they do stays
    /// near the edges between them.
    fn may_be_an_arc(&self, i: usize, reach: f64) -> bool {
        let turn = self.turn(i, reach);
        [false, true].into_iter().all(|forward| {
            let mut ahead = self.stretch(i, forward, reach, 0.5 * self.around());
            let Some((length, next)) = ahead.find(|&(_, j)| self.samples[j].weight > 0.5) else {
                return true;
            };
            let other = self.turn(next, reach);
            let turned = if other * turn > 0. { 0.5 * (turn + other) } else { 0.5 * turn };
            0.5 * length * (turned / 4.).tan().abs() < STRAIGHT
        })
    }

    /// Where the sides would meet, if they meet in a corner rather than in a fillet.
    fn sharp(&self, i: usize, reach: f64) -> Option<DVec2> {
        let before = self.side(i, false, reach / 3., reach)?;
        let after = self.side(i, true, reach / 3., reach)?;
        let tip = meeting((before.middle, before.direction), (after.middle, after.direction))?;
        let half_inside = (std::f64::consts::PI - before.direction.angle_to(after.direction).abs()) / 2.;
        let fillet = LARGEST_FILLET * self.extent * (1. / half_inside.sin().max(0.05) - 1.);
        let near = self.stretch(i, false, 0., reach).chain(self.stretch(i, true, 0., reach));
        let off = near.map(|(_, j)| self.samples[j].at.distance(tip)).fold(f64::INFINITY, f64::min);
        (off <= 0.7 * self.noise + fillet + 0.5 * self.spacing()).then_some(tip)
    }
}

/// Where two lines through places along directions meet.
pub(super) fn meeting(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> Option<DVec2> {
    let turn = a.1.perp_dot(b.1);
    (turn.abs() > 0.05).then(|| a.0 + a.1 * ((b.0 - a.0).perp_dot(b.1) / turn))
}

/// The samples that are corners, ascending: found, less those wished round, and those wished sharp.
///
/// A corner is where fitted directions of the two sides differ much over a short stretch, and where the sides,
/// prolonged, meet on the line rather than beyond it.
pub(super) fn find(line: &Closed, wishes: &Wishes) -> Vec<usize> {
    let reach = if line.sparse { SPARSE_REACH } else { REACH };
    let for_samples = (LEAST_IN_REACH * line.spacing()).min(FARTHEST_FOR_THAT * line.extent);
    let shaking = if line.noise > STEADY * line.extent { for_samples } else { 0. };
    let reach = (reach * line.extent).max(10. * line.noise).max(shaking).min(line.around() / 8.);
    let in_reach = (reach / line.spacing()).max(1.);
    let shaky = 2.5 * line.noise / reach * (12. / in_reach).sqrt();
    let mut candidates: Vec<Candidate> = (0..line.samples.len())
        .filter(|&i| line.samples[i].weight > 0.5 && line.samples[i].smoothing < 0.5)
        .map(|sample| Candidate { sample, turn: line.turn(sample, reach).abs() })
        .filter(|candidate| candidate.turn > LEAST_TURN + shaky)
        .filter(|candidate| !(line.sparse && line.may_be_an_arc(candidate.sample, reach)))
        .collect();
    candidates.sort_by(|a, b| b.turn.total_cmp(&a.turn).then(a.sample.cmp(&b.sample)));
    let known = line.known.iter().copied().filter(|&i| line.samples[i].smoothing < 0.5);
    let mut taken: Vec<usize> = known.collect();
    let mut corners = taken.clone();
    for Candidate { sample, .. } in candidates {
        if taken.iter().any(|&other| apart(line, other, sample) < reach) {
            continue;
        }
        taken.push(sample);
        corners.extend(line.sharp(sample, reach).map(|tip| nearest_drawn(line, tip, sample, reach)));
    }
    apply(&mut corners, line, wishes);
    corners.sort_unstable();
    corners.dedup();
    corners
}

fn apart(line: &Closed, a: usize, b: usize) -> f64 {
    let gone = (line.lengths[a] - line.lengths[b]).abs();
    gone.min(line.around() - gone)
}

/// The drawn sample nearest to the tip, within half the reach of the candidate.
fn nearest_drawn(line: &Closed, tip: DVec2, candidate: usize, reach: f64) -> usize {
    let half = 0.5 * reach;
    line.stretch(candidate, false, 0., half)
        .chain(line.stretch(candidate, true, 0., half))
        .map(|(_, j)| j)
        .filter(|&j| line.samples[j].weight > 0.5)
        .min_by(|&a, &b| {
            let far = |j: usize| line.samples[j].at.distance_squared(tip);
            far(a).total_cmp(&far(b)).then(a.cmp(&b))
        })
        .unwrap_or(candidate)
}

fn apply(corners: &mut Vec<usize>, line: &Closed, wishes: &Wishes) {
    let near = NEAR * line.extent;
    for place in &wishes.rounded {
        let far = |&i: &usize| line.samples[i].at.distance(*place);
        let nearest = (0..corners.len()).min_by(|&a, &b| far(&corners[a]).total_cmp(&far(&corners[b])));
        if let Some(found) = nearest.filter(|&k| far(&corners[k]) < near) {
            corners.remove(found);
        }
    }
    for place in &wishes.sharpened {
        let far = |i: &usize| line.samples[*i].at.distance(*place);
        let nearest = (0..line.samples.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        let Some(sample) = nearest.filter(|i| far(i) < near) else { continue };
        if corners.iter().all(|&corner| apart(line, corner, sample) > 0.2 * near) {
            corners.push(sample);
        }
    }
}
