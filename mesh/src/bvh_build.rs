//! Building the tree of [`crate::Bvh`]: surface area heuristic over 16 bins per axis, then flattened.
//!
//! **Source:** Wald 2007, *On fast Construction of SAH-based Bounding Volume Hierarchies*; **departs** by splitting
//! three times per node, largest box first, so that nodes have four children.

use glam::Vec3;
use rayon::prelude::*;

use crate::bvh::{LEAF, Node, WIDTH};
use crate::measure::Bounds;

const BINS: usize = 16;
/// Below this many triangles a thread is not worth waking.
const PARALLEL: usize = 4096;
/// From this level on, parts are halved by count, so that no input makes the tree deeper than 16 + 32 levels.
const SAH_LEVELS: u32 = 16;

struct Reference {
    bounds: Bounds,
    middle: Vec3,
    index: u32,
}

enum Branch {
    Leaf { first: u32, count: u32 },
    Inner(Vec<(Bounds, Branch)>),
}

/// The nodes, root first and parents before children, and the order in which leaves list the triangles.
pub(crate) fn build(corners: &[[Vec3; 3]]) -> (Vec<Node>, Vec<u32>) {
    let mut references: Vec<Reference> = (0u32..)
        .zip(corners)
        .map(|(index, [a, b, c])| {
            let bounds = Bounds { min: a.min(*b).min(*c), max: a.max(*b).max(*c) };
            Reference { bounds, middle: bounds.min * 0.5 + bounds.max * 0.5, index }
        })
        .collect();
    let mut nodes = Vec::new();
    if !references.is_empty() {
        let root = match branch(&mut references, 0, 0) {
            leaf @ Branch::Leaf { .. } => vec![(bounds_of(&references), leaf)],
            Branch::Inner(children) => children,
        };
        flatten(root, &mut nodes);
    }
    (nodes, references.into_iter().map(|r| r.index).collect())
}

fn branch(references: &mut [Reference], first: u32, level: u32) -> Branch {
    let count = references.len();
    if count <= LEAF {
        return Branch::Leaf { first, count: count as u32 };
    }
    let mut parts: Vec<(Bounds, &mut [Reference])> = vec![(bounds_of(references), references)];
    while parts.len() < WIDTH {
        let splittable = (0..parts.len()).filter(|&i| parts[i].1.len() > LEAF);
        let Some(largest) =
            splittable.max_by(|&i, &j| half_area(&parts[i].0).total_cmp(&half_area(&parts[j].0)))
        else {
            break;
        };
        let (_, part) = parts.remove(largest);
        let middle = split(part, level);
        let (left, right) = part.split_at_mut(middle);
        parts.insert(largest, (bounds_of(right), right));
        parts.insert(largest, (bounds_of(left), left));
    }
    let mut starts = Vec::with_capacity(WIDTH);
    let mut next = first;
    for (_, part) in &parts {
        starts.push(next);
        next += part.len() as u32;
    }
    let descend =
        |((bounds, part), start): ((Bounds, &mut [Reference]), u32)| (bounds, branch(part, start, level + 1));
    Branch::Inner(if count > PARALLEL {
        parts.into_par_iter().zip(starts).map(descend).collect()
    } else {
        parts.into_iter().zip(starts).map(descend).collect()
    })
}

/// Sorts the references into two non-empty parts and says where the second begins. Needs at least two.
fn split(references: &mut [Reference], level: u32) -> usize {
    let middles = references.iter().fold(Bounds::EMPTY, |mut b, r| {
        b.include(r.middle);
        b
    });
    let best = if level < SAH_LEVELS { best_cut(references, &middles) } else { None };
    if let Some((axis, cut)) = best {
        let middle = partition(references, |r| bin(&middles, axis, r.middle) < cut);
        if middle > 0 && middle < references.len() {
            return middle;
        }
    }
    let size = middles.size();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let half = references.len() / 2;
    references.select_nth_unstable_by(half, |a, b| {
        a.middle[axis].total_cmp(&b.middle[axis]).then(a.index.cmp(&b.index))
    });
    half
}

/// The axis and first bin of the right part with the least expected cost; none if all middles share a bin.
fn best_cut(references: &[Reference], middles: &Bounds) -> Option<(usize, usize)> {
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let mut bins = [(0usize, Bounds::EMPTY); BINS];
        for r in references {
            let (count, bounds) = &mut bins[bin(middles, axis, r.middle)];
            *count += 1;
            *bounds = bounds.union(r.bounds);
        }
        let mut right = [(0.0f64, 0usize); BINS + 1];
        let mut sweep = (0, Bounds::EMPTY);
        for cut in (1..BINS).rev() {
            sweep = (sweep.0 + bins[cut].0, sweep.1.union(bins[cut].1));
            right[cut] = (half_area(&sweep.1) * sweep.0 as f64, sweep.0);
        }
        let mut left = (0, Bounds::EMPTY);
        for cut in 1..BINS {
            left = (left.0 + bins[cut - 1].0, left.1.union(bins[cut - 1].1));
            let cost = half_area(&left.1) * left.0 as f64 + right[cut].0;
            if left.0 > 0 && right[cut].1 > 0 && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    best.map(|(_, axis, cut)| (axis, cut))
}

fn bin(middles: &Bounds, axis: usize, p: Vec3) -> usize {
    let low = f64::from(middles.min[axis]);
    let width = f64::from(middles.max[axis]) - low;
    let scaled = (f64::from(p[axis]) - low) / width * BINS as f64;
    // 0 / 0 is NaN, which becomes bin 0.
    (scaled as usize).min(BINS - 1)
}

fn half_area(bounds: &Bounds) -> f64 {
    let size = bounds.size().as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}

fn bounds_of(references: &[Reference]) -> Bounds {
    references.iter().fold(Bounds::EMPTY, |sum, r| sum.union(r.bounds))
}

/// Moves everything that `belongs_left` to the front and returns how many that are.
fn partition(references: &mut [Reference], belongs_left: impl Fn(&Reference) -> bool) -> usize {
    let mut left = 0;
    for i in 0..references.len() {
        if belongs_left(&references[i]) {
            references.swap(left, i);
            left += 1;
        }
    }
    left
}

fn flatten(children: Vec<(Bounds, Branch)>, nodes: &mut Vec<Node>) -> u32 {
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    for (lane, (bounds, child)) in children.into_iter().enumerate() {
        let (child, count) = match child {
            Branch::Leaf { first, count } => (first, count),
            Branch::Inner(grandchildren) => (flatten(grandchildren, nodes), 0),
        };
        let node = &mut nodes[index];
        for axis in 0..3 {
            node.min[axis][lane] = bounds.min[axis];
            node.max[axis][lane] = bounds.max[axis];
        }
        node.child[lane] = child;
        node.count[lane] = count;
    }
    index as u32
}
