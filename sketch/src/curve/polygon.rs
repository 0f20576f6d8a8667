//! Closed polygons: area, inside, crossings.

use glam::DVec2;

/// Twice the signed area is the sum of the cross products; counter-clockwise is positive.
pub(super) fn area(points: &[DVec2]) -> f64 {
    let Some(&origin) = points.first() else { return 0. };
    0.5 * edges(points).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>()
}

/// The edges, the closing one last.
pub(super) fn edges(points: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + Clone {
    points.iter().copied().zip(points.iter().copied().cycle().skip(1))
}

/// Whether the polygon winds around a place an odd number of times.
pub(super) fn contains(points: &[DVec2], at: DVec2) -> bool {
    edges(points)
        .filter(|(a, b)| {
            (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)
        })
        .count()
        % 2
        == 1
}

/// Lower and upper corner of the box around the points.
pub(super) fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    points
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(least, most), &p| (least.min(p), most.max(p)))
}

/// The longer side of the box around the points.
pub(super) fn extent(points: &[DVec2]) -> f64 {
    let (least, most) = bounds(points);
    (most - least).max_element().max(0.)
}

/// Whether the boxes around two polygons overlap.
pub(super) fn near(both: [&[DVec2]; 2]) -> bool {
    let [a, b] = both.map(bounds);
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

/// Where two segments cross: the shares of their lengths.
pub(super) fn crossing(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> Option<(f64, f64)> {
    touching(a, b, 0.)
}

/// As [`crossing`], also where segments end up to `reach` short of each other.
pub(super) fn touching(a: (DVec2, DVec2), b: (DVec2, DVec2), reach: f64) -> Option<(f64, f64)> {
    let (along_a, along_b, between) = (a.1 - a.0, b.1 - b.0, b.0 - a.0);
    let turn = along_a.perp_dot(along_b);
    if turn == 0. {
        return None;
    }
    let (s, t) = (between.perp_dot(along_b) / turn, between.perp_dot(along_a) / turn);
    let on = |share: f64, along: DVec2| {
        let beyond = if reach > 0. { reach / along.length() } else { 0. };
        (-beyond..=1. + beyond).contains(&share).then_some(share.clamp(0., 1.))
    };
    on(s, along_a).zip(on(t, along_b))
}

/// An edge of one of several polygons.
struct Edge {
    polygon: usize,
    place: usize,
    /// Edges of its polygon.
    of: usize,
    ends: (DVec2, DVec2),
    span: (f64, f64),
}

impl Edge {
    fn next_to(&self, other: &Self) -> bool {
        let apart = self.place.abs_diff(other.place);
        self.polygon == other.polygon && (apart == 1 || apart + 1 == self.of)
    }
}

/// Whether any two edges of any of the polygons cross, neighbours along one polygon apart.
///
/// **Cost:** edges sorted by x; about linear for evenly spaced points.
pub(super) fn cross<'a>(polygons: impl Iterator<Item = &'a [DVec2]>) -> bool {
    crossings_of(polygons).next().is_some()
}

/// Every two edges of a polygon that cross, and where. **Cost:** as [`cross`].
pub(super) fn crossings(points: &[DVec2]) -> impl Iterator<Item = (usize, usize, DVec2)> {
    crossings_of(std::iter::once(points))
}

/// Two edges i < j of a polygon that cross, the ones nearest to each other along it, and where.
pub(super) fn first_crossing(points: &[DVec2]) -> Option<(usize, usize, DVec2)> {
    let nearest = crossings(points).min_by_key(|&(a, b, _)| (a.abs_diff(b), a.min(b)));
    nearest.map(|(a, b, at)| (a.min(b), a.max(b), at))
}

/// As [`first_crossing`], of a polygon that crosses itself once.
pub(super) fn only_crossing(points: &[DVec2]) -> Option<(usize, usize, DVec2)> {
    let mut all = crossings(points);
    let (a, b, at) = all.next()?;
    all.next().is_none().then_some((a.min(b), a.max(b), at))
}

fn crossings_of<'a>(
    polygons: impl Iterator<Item = &'a [DVec2]>,
) -> impl Iterator<Item = (usize, usize, DVec2)> {
    let mut all: Vec<Edge> = polygons
        .enumerate()
        .flat_map(|(polygon, points)| {
            edges(points).enumerate().map(move |(place, ends)| {
                let span = (ends.0.x.min(ends.1.x), ends.0.x.max(ends.1.x));
                Edge { polygon, place, of: points.len(), ends, span }
            })
        })
        .collect();
    all.sort_by(|a, b| a.span.0.total_cmp(&b.span.0));
    let all = std::rc::Rc::new(all);
    (0..all.len()).flat_map(move |i| {
        let all = all.clone();
        (i + 1..all.len())
            .take_while({
                let all = all.clone();
                move |&k| all[k].span.0 <= all[i].span.1
            })
            .filter_map(move |k| {
                let (a, b) = (&all[i], &all[k]);
                let (share, _) = if a.next_to(b) { None } else { crossing(a.ends, b.ends) }?;
                Some((a.place, b.place, a.ends.0.lerp(a.ends.1, share)))
            })
    })
}
