//! From pieces of outline to loops.

use super::cut::Crossing;
use super::grid::Point;

/// The outlines of one plane.
#[derive(Debug, Default)]
pub(crate) struct Loops {
    /// Closed outlines with the solid on their left; they may cross.
    pub(crate) closed: Vec<Vec<Point>>,
    /// The beginnings of outlines that do not close, because the mesh is open or its triangles disagree.
    pub(crate) open: Vec<Point>,
}

/// Joins crossings into loops. Where more than one piece could follow, the first in order does: where loops meet,
/// it does not matter how they are told apart, as the winding number is the same.
pub(crate) fn chain(crossings: &[Crossing]) -> Loops {
    let follow = followers(crossings);
    let mut has_predecessor = vec![false; crossings.len()];
    follow.iter().flatten().for_each(|&next| has_predecessor[next as usize] = true);
    let mut loops = Loops::default();
    let mut seen = vec![false; crossings.len()];
    // What nothing leads to begins an open chain, and all of it is set aside before loops are followed.
    for first in (0..crossings.len()).filter(|&i| !has_predecessor[i]) {
        walk(first, &follow, &mut seen, |_| {});
        loops.open.push(crossings[first].start);
    }
    for first in 0..crossings.len() {
        if !seen[first] {
            let mut points = Vec::new();
            walk(first, &follow, &mut seen, |i| points.push(crossings[i].start));
            loops.closed.push(points);
        }
    }
    loops
}

fn walk(first: usize, follow: &[Option<u32>], seen: &mut [bool], mut visit: impl FnMut(usize)) {
    let mut next = Some(first);
    while let Some(i) = next.filter(|&i| !seen[i]) {
        seen[i] = true;
        visit(i);
        next = follow[i].map(|next| next as usize);
    }
}

/// For every piece the one that begins where it ends; each follows one piece at most.
fn followers(crossings: &[Crossing]) -> Vec<Option<u32>> {
    let mut beginnings: Vec<(u64, u32)> = crossings.iter().map(|c| c.from).zip(0..).collect();
    beginnings.sort_unstable();
    // How many of those that begin on an edge are taken, kept at the first of them.
    let mut taken = vec![0; beginnings.len()];
    let follower = |crossing: &Crossing| {
        let first = beginnings.partition_point(|&(edge, _)| edge < crossing.to);
        let at = first + taken.get(first).copied().unwrap_or(0);
        let &(edge, index) = beginnings.get(at)?;
        (edge == crossing.to).then(|| {
            taken[first] += 1;
            index
        })
    };
    crossings.iter().map(follower).collect()
}
