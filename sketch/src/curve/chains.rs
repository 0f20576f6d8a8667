//! Lines joined by their ends into chains, and the groups of chains that touch.

use super::line::{Line, Sample, coarse, extent, length};
use super::polygon::{area, bounds, crossings, touching};
use glam::DVec2;

/// Ends nearer than this belong together, in drawing sizes: what people leave open between strokes.
const JOIN: f64 = 0.06;
/// And nearer than this share of the shorter line.
const JOIN_SHARE: f64 = 0.4;
/// A chain whose ends are nearer than this share of its extent is closed.
const CLOSE_SHARE: f64 = 0.15;
/// An end this near to another line leans on it, in drawing sizes.
const LEAN: f64 = 0.05;
/// Least area of a loop, over length times extent: a line that goes back the way it came has less.
const LEAST_AREA: f64 = 0.004;
/// A loop smaller than this part of its line is not the line with its tails cut off: the tail is the string of a
/// balloon.
const MOST_OF_IT: f64 = 0.5;
/// Places nearer to each other than this, in drawing sizes, are one: more than rounding, less than can be seen.
pub(super) const AS_NEAR: f64 = 1e-5;
/// What counts as no weight where there is nothing drawn.
const WEIGHT_OF_A_GAP: f64 = 1e-3;

/// Lines that follow each other.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub samples: Vec<Sample>,
    /// The last sample leads back to the first.
    pub closed: bool,
    /// The strokes it is made of.
    pub strokes: Vec<usize>,
}

impl Chain {
    /// The places in order, the first repeated at the end if the chain is closed.
    pub fn path(&self) -> Vec<DVec2> {
        let closing = self.samples.first().filter(|_| self.closed);
        self.samples.iter().chain(closing).map(|sample| sample.at).collect()
    }

    pub fn gap(&self) -> f64 {
        self.samples.first().zip(self.samples.last()).map_or(0., |(a, b)| a.at.distance(b.at))
    }

    pub fn extent(&self) -> f64 {
        extent(&self.samples)
    }

    /// Whether there is room inside, were it closed.
    pub fn has_room(&self) -> bool {
        let places: Vec<DVec2> = self.samples.iter().map(|sample| sample.at).collect();
        let least = LEAST_AREA * length(&self.samples) * self.extent();
        area(&places).abs() > least || has_lobes(&places, least)
    }

    /// Closes the chain across its gap.
    pub fn close(&mut self) {
        let Some((first, last)) = self.samples.first().copied().zip(self.samples.last().copied()) else {
            return;
        };
        self.samples.extend(gap_samples(last, first));
        self.closed = true;
    }
}

/// Whether a closed line crosses itself so that it goes around one side and around the other the other way, such as an
/// eight: together they may enclose nothing.
fn has_lobes(places: &[DVec2], least: f64) -> bool {
    let all = area(places);
    crossings(places).any(|(i, j, _)| {
        let one = area(&places[i.min(j) + 1..=i.max(j)]);
        let other = all - one;
        one * other < 0. && one.abs().min(other.abs()) > least
    })
}

/// Samples that lead across a gap without holding the curve to the straight line.
fn gap_samples(from: Sample, to: Sample) -> Vec<Sample> {
    let pieces = (from.at.distance(to.at) / 0.01).ceil() as usize;
    let on_the_way = |i| {
        let at = from.at.lerp(to.at, i as f64 / pieces as f64);
        Sample {
            at,
            weight: WEIGHT_OF_A_GAP,
            smoothing: from.smoothing.max(to.smoothing),
            sparse: from.sparse,
        }
    };
    (1..pieces).map(on_the_way).collect()
}

/// Joins lines by their ends, nearest ends first, and closes what comes back to itself.
pub(super) fn chains(lines: Vec<Line>) -> Vec<Chain> {
    let single = lines.into_iter().map(|line| {
        let chain = Chain { samples: line.samples, closed: false, strokes: vec![line.stroke] };
        closed_if_near(chain)
    });
    let (mut done, open): (Vec<Chain>, Vec<Chain>) = single.partition(|chain| chain.closed);
    done.extend(linked(open).into_iter().map(closed_if_near));
    done
}

fn closed_if_near(mut chain: Chain) -> Chain {
    if chain.closed {
        return chain;
    }
    if let Some(trimmed) = without_overshoot(&chain.samples) {
        chain.samples = trimmed;
        chain.closed = true;
    } else if chain.gap() <= CLOSE_SHARE * chain.extent() + AS_NEAR && chain.has_room() {
        chain.close();
    }
    chain
}

/// The samples between the place where both tails cross, if they cross near the ends.
///
/// The tails may be a quarter of the line each, and not much longer than the ends are apart: a figure of eight
/// also crosses itself, but its ends meet.
fn without_overshoot(samples: &[Sample]) -> Option<Vec<Sample>> {
    let total = length(samples);
    let apart = samples.first()?.at.distance(samples.last()?.at);
    let most = (0.25 * total).min(3. * apart + 0.02);
    let tail = |pairs: &mut dyn Iterator<Item = usize>| {
        let mut gone = 0.;
        let mut tail = Vec::new();
        for i in pairs {
            if gone > most {
                break;
            }
            tail.push((i, gone));
            gone += samples[i].at.distance(samples[i + 1].at);
        }
        tail
    };
    let edges = samples.len().checked_sub(1)?;
    let heads = tail(&mut (0..edges));
    let ends = tail(&mut (0..edges).rev());
    let segment = |i: usize| (samples[i].at, samples[i + 1].at);
    let mut best: Option<(f64, usize, usize, DVec2)> = None;
    for &(i, before) in &heads {
        for &(j, after) in ends.iter().filter(|&&(j, _)| j > i + 1) {
            let Some((s, t)) = touching(segment(i), segment(j), AS_NEAR) else { continue };
            let (a, b) = segment(i);
            let head = before + s * a.distance(b);
            let end = after + (1. - t) * samples[j].at.distance(samples[j + 1].at);
            if head.max(end) <= most && best.is_none_or(|(least, ..)| head + end < least - AS_NEAR) {
                best = Some((head + end, i, j, a.lerp(b, s)));
            }
        }
    }
    let (_, i, j, at) = best?;
    let mut kept = vec![Sample { at, ..samples[i] }];
    kept.extend(samples[i + 1..=j].iter().filter(|sample| sample.at.distance(at) > 2. * AS_NEAR));
    let places: Vec<DVec2> = kept.iter().map(|sample| sample.at).collect();
    let has_room = area(&places).abs() > LEAST_AREA * length(&kept) * extent(&kept);
    (has_room && extent(&kept) > MOST_OF_IT * extent(samples)).then_some(kept)
}

/// An end of a chain: which one, and whether it is the last sample.
type End = (usize, bool);

fn linked(open: Vec<Chain>) -> Vec<Chain> {
    let place = |end: End| {
        let samples = &open[end.0].samples;
        if end.1 { samples[samples.len() - 1].at } else { samples[0].at }
    };
    let reach: Vec<f64> = open.iter().map(|chain| JOIN.min(JOIN_SHARE * length(&chain.samples))).collect();
    let ends: Vec<End> = (0..open.len()).flat_map(|i| [(i, false), (i, true)]).collect();
    let mut pairs: Vec<(f64, End, End)> = Vec::new();
    for (k, &a) in ends.iter().enumerate() {
        for &b in ends[k + 1..].iter().filter(|b| b.0 != a.0) {
            let gap = place(a).distance(place(b));
            if gap <= reach[a.0].min(reach[b.0]) + AS_NEAR {
                pairs.push((gap, a, b));
            }
        }
    }
    pairs.sort_by(|a, b| coarse(a.0).total_cmp(&coarse(b.0)).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partner: Vec<[Option<End>; 2]> = vec![[None; 2]; open.len()];
    for (_, a, b) in pairs {
        let free = |end: End| partner[end.0][usize::from(end.1)].is_none();
        if free(a) && free(b) {
            partner[a.0][usize::from(a.1)] = Some(b);
            partner[b.0][usize::from(b.1)] = Some(a);
        }
    }
    walks(&open, &partner)
}

/// Follows the links, first from free ends, then around rings.
fn walks(open: &[Chain], partner: &[[Option<End>; 2]]) -> Vec<Chain> {
    let mut used = vec![false; open.len()];
    let free_ends = (0..open.len())
        .flat_map(|i| [(i, false), (i, true)])
        .filter(|e| partner[e.0][usize::from(e.1)].is_none());
    let starts: Vec<End> = free_ends.chain((0..open.len()).map(|i| (i, false))).collect();
    let mut chains = Vec::new();
    for start in starts {
        if used[start.0] {
            continue;
        }
        let mut chain = Chain { samples: Vec::new(), closed: false, strokes: Vec::new() };
        let mut at = start;
        loop {
            used[at.0] = true;
            chain.strokes.extend(&open[at.0].strokes);
            let mut samples = open[at.0].samples.clone();
            if at.1 {
                samples.reverse();
            }
            if let Some(&last) = chain.samples.last() {
                chain.samples.extend(gap_samples(last, samples[0]));
            }
            chain.samples.extend(samples);
            match partner[at.0][usize::from(!at.1)] {
                Some(next) if !used[next.0] => at = next,
                Some(next) => {
                    if next == start && chain.has_room() {
                        chain.close();
                    }
                    break;
                }
                None => break,
            }
        }
        chains.push(chain);
    }
    chains
}

/// Short straight bridges from free ends to the lines that they lean on: the chain, the other one, the bridge.
///
/// An end leans on its own chain only further along than a few times the bridge.
pub(super) fn bridges(chains: &[Chain]) -> Vec<(usize, usize, [DVec2; 2])> {
    let mut found = Vec::new();
    let paths: Vec<Vec<DVec2>> = chains.iter().map(Chain::path).collect();
    let boxes: Vec<(DVec2, DVec2)> = paths.iter().map(|path| bounds(path)).collect();
    for (i, chain) in chains.iter().enumerate().filter(|(_, chain)| !chain.closed) {
        let mut backward = paths[i].clone();
        backward.reverse();
        for path in [&paths[i], &backward] {
            let (end, reach) = (path[0], LEAN.min(0.5 * chain.extent()));
            let own = nearest(end, far_along(path, 4. * reach)).map(|at| (i, at));
            let in_reach = |j: &usize| {
                let (least, most) = boxes[*j];
                *j != i && end.clamp(least, most).distance(end) <= reach
            };
            let others = (0..chains.len()).filter(in_reach);
            let other = others.filter_map(|j| Some((j, nearest(end, &paths[j])?)));
            let nearest = own
                .into_iter()
                .chain(other)
                .min_by(|a, b| coarse(a.1.distance(end)).total_cmp(&coarse(b.1.distance(end))));
            if let Some((j, at)) = nearest.filter(|(_, at)| at.distance(end) <= reach) {
                found.push((i, j, [end, at]));
            }
        }
    }
    found
}

/// What of a path is further than a length from its start.
fn far_along(path: &[DVec2], least: f64) -> &[DVec2] {
    let mut gone = 0.;
    let near = path.windows(2).take_while(|pair| {
        gone += pair[0].distance(pair[1]);
        gone < least
    });
    &path[(near.count() + 1).min(path.len())..]
}

pub(super) fn nearest(at: DVec2, path: &[DVec2]) -> Option<DVec2> {
    let on = |a: DVec2, b: DVec2| {
        let along = b - a;
        let share = (at - a).dot(along) / along.length_squared().max(1e-30);
        a + along * share.clamp(0., 1.)
    };
    let places = path.windows(2).map(|pair| on(pair[0], pair[1]));
    places.min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)))
}
