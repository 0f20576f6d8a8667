//! Closing cracks: joining the vertices of open edges that were one vertex before the file was written.
//!
//! STL knows no vertices, so a program that computes a corner once for every triangle, or rounds it on the way,
//! writes corners that differ in their last bits; OBJ and PLY files split vertices along texture seams. Slicers
//! take such meshes for closed, and so does [`close_cracks`]. It moves vertices by rounding errors only: holes
//! stay open, and what is closed already is not touched, however near to something else it lies.

use std::hash::{BuildHasher, RandomState};

use glam::{DVec3, Vec3};
use hashbrown::HashTable;
use rayon::prelude::*;

use super::Notice;
use super::weld::Welder;
use crate::edges::{EdgeTable, is_collapsed};
use crate::{Bounds, Mesh};

/// Distances to try, in units in the last place of the largest coordinate. Two corners that are one unit off along
/// each axis lie up to 3.5 units apart; text of seven digits, as most STL files have, has steps of up to 8.4 units
/// along each axis; and what a program computed in several steps of single precision needs the last.
const UNITS: [f64; 3] = [4.0, 16.0, 64.0];

/// The largest distance, as a share of the box's longest side: a part that lies far from the origin has coarse
/// units, and its shape is worth more than its cracks.
const LARGEST_SHARE: f64 = 1e-5;

/// Joins vertices at open edges, in exactly the same place or within rounding errors, where that closes edges.
///
/// - **In/out:** an edge is open where its triangles do not run along it equally often in both directions. Only
///   vertices of such edges are joined, each to the nearest one that stays, the lower index where two are equally
///   near. Triangles that lose a side by it go, and so do the vertices joined; the rest keep their order.
/// - **Units:** four distances are tried, 0 and about 2.5e-7, 1e-6 and 4e-6 of the box's longest side (more for a
///   part far from the origin, at most 1e-5). The one that leaves the least open wins, the smallest if several do.
/// - **Promises:** strictly fewer open edges, or no change and no notice. Edges that merely vanish with a triangle
///   do not count as closed, and no mesh loses all its triangles. The same
///   mesh gives the same result. Indices out of range are left alone.
/// - **Cost:** O(triangles) for a mesh that is closed; sorting the edges of one that is not.
pub fn close_cracks(mesh: &mut Mesh) -> Option<Notice> {
    if is_balanced(mesh) {
        return None;
    }
    let seam = Seam::new(mesh);
    let distances = distances(&seam, mesh);
    // What the largest distance does not join, no other does.
    join(&seam.vertices, &mesh.positions, *distances.last()?)?;
    let mut best = seam.before;
    let mut closing = None;
    for within in distances {
        let Some(joined) = join(&seam.vertices, &mesh.positions, within) else { continue };
        let left = seam.after(&joined);
        if left.faults < best.faults && left.open < best.open {
            best = left;
            closing = Some((joined, within));
        }
        if best.faults == 0 {
            break;
        }
    }
    let (joined, within) = closing?;
    let (count, collapsed) = apply(mesh, &joined);
    let [count, collapsed, open, left] = [count, collapsed, seam.before.open, best.open].map(|n| n as u64);
    Some(Notice::JoinedVertices { count, within, collapsed, open, left })
}

/// Whether triangles run along every edge equally often in both directions: each run adds or takes away the
/// edge's own 64-bit number. A sum that is zero by accident, or by design, only leaves a mesh as it is.
fn is_balanced(mesh: &Mesh) -> bool {
    let runs = |&triangle: &[u32; 3]| {
        if mesh.corners(triangle).is_none() || is_collapsed(triangle) {
            return 0;
        }
        sides(triangle).into_iter().fold(0_u64, |sum, (ends, forward)| {
            let number = mixed(u64::from(ends[0]) << 32 | u64::from(ends[1]));
            if forward { sum.wrapping_add(number) } else { sum.wrapping_sub(number) }
        })
    };
    mesh.triangles.iter().map(runs).fold(0, u64::wrapping_add) == 0
}

/// A bijection that leaves no pattern (the last step of SplitMix64).
fn mixed(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The three sides of a triangle, the smaller vertex first, and whether it runs from there.
fn sides([a, b, c]: [u32; 3]) -> [([u32; 2], bool); 3] {
    [(a, b), (b, c), (c, a)].map(|(from, to)| ([from.min(to), from.max(to)], from < to))
}

/// What is wrong with a mesh along its open edges.
#[derive(Clone, Copy)]
struct Left {
    /// Sides without a partner, sides beyond two at an edge, and what was lost: 0 where all is closed and manifold.
    faults: u64,
    /// Edges along which triangles do not run equally often in both directions.
    open: usize,
}

/// The vertices of open edges and all triangles that could lose a side, or gain a neighbour, by joining some.
struct Seam {
    /// Ascending.
    vertices: Vec<u32>,
    /// Whether each vertex of the mesh is one of them.
    is_member: Vec<bool>,
    /// Those with at least two corners among the vertices: no other has a side that can change.
    triangles: Vec<[u32; 3]>,
    /// The edges that have faults, and how many.
    faulty: Vec<([u32; 2], u64)>,
    before: Left,
}

impl Seam {
    fn new(mesh: &Mesh) -> Self {
        let mut is_member = vec![false; mesh.positions.len()];
        for edge in EdgeTable::new(mesh).iter().filter(|edge| edge.balance() != 0) {
            for end in edge.ends() {
                is_member[end as usize] = true;
            }
        }
        let touches = |&triangle: &[u32; 3]| {
            mesh.corners(triangle).is_some()
                && !is_collapsed(triangle)
                && triangle.into_iter().filter(|&v| is_member[v as usize]).count() >= 2
        };
        let triangles = mesh.triangles.iter().copied().filter(touches).collect();
        let vertices = (0..).zip(&is_member).filter_map(|(v, &is_member)| is_member.then_some(v)).collect();
        let before = Left { faults: 0, open: 0 };
        let mut seam = Self { vertices, is_member, triangles, faulty: Vec::new(), before };
        let mut faulty = Vec::new();
        (seam.before, _) = seam.count(
            |v| v,
            |ends, faults| {
                if faults > 0 {
                    faulty.push((ends, faults));
                }
            },
        );
        seam.faulty = faulty;
        seam
    }

    /// What is left when every vertex is joined to the one that `joined` says. Losing a triangle is not closing a
    /// crack: edges that vanish keep their faults, and every triangle that goes is one more.
    fn after(&self, joined: &[u32]) -> Left {
        let to = |v: u32| joined[v as usize];
        let mut edges = Vec::new();
        let (mut left, collapsed) = self.count(to, |ends, _| edges.push(ends));
        left.faults += collapsed;
        for &([a, b], faults) in &self.faulty {
            let (a, b) = (to(a), to(b));
            if edges.binary_search(&[a.min(b), a.max(b)]).is_err() {
                left.faults += faults;
            }
        }
        left
    }

    /// Counts the faults of edges between members, shows each edge with its faults in ascending order, and says
    /// how many triangles collapse.
    fn count(&self, joined: impl Fn(u32) -> u32, mut show: impl FnMut([u32; 2], u64)) -> (Left, u64) {
        let is_inside = |(ends, _): &([u32; 2], bool)| ends.iter().all(|&v| self.is_member[v as usize]);
        let kept = self.triangles.iter().map(|corners| corners.map(&joined)).filter(|&t| !is_collapsed(t));
        let collapsed = self.triangles.len() - kept.clone().count();
        let mut all: Vec<_> = kept.flat_map(sides).filter(is_inside).collect();
        all.par_sort_unstable();
        let mut left = Left { faults: 0, open: 0 };
        for edge in all.chunk_by(|a, b| a.0 == b.0) {
            let forward = edge.iter().filter(|(_, forward)| *forward).count();
            let balance = forward.abs_diff(edge.len() - forward);
            let faults = (balance + edge.len().saturating_sub(2)) as u64;
            left.faults += faults;
            left.open += usize::from(balance != 0);
            show(edge[0].0, faults);
        }
        (left, collapsed as u64)
    }
}

/// The distances to try, ascending, mm.
fn distances(seam: &Seam, mesh: &Mesh) -> Vec<f64> {
    let used = mesh.triangles.iter().filter_map(|&triangle| mesh.corners(triangle)).flatten();
    let (mut bounds, mut largest) = (Bounds::EMPTY, 0.0_f32);
    for p in used.filter(|p| p.is_finite()) {
        bounds.include(p);
        largest = largest.max(p.abs().max_element());
    }
    let longest = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
    let unit = f64::from(f32::EPSILON) * f64::from(largest);
    let mut distances = vec![0.0];
    distances.extend(UNITS.map(|units| (units * unit).min(LARGEST_SHARE * longest)));
    distances.dedup();
    let all_finite = seam.vertices.iter().all(|&v| mesh.positions[v as usize].is_finite());
    distances.truncate(if all_finite { distances.len() } else { 1 });
    distances
}

/// For every vertex of the mesh the one it is joined to, itself if none; nothing if no two are near enough.
fn join(members: &[u32], positions: &[Vec3], within: f64) -> Option<Vec<u32>> {
    let mut joined: Vec<u32> = (0..).take(positions.len()).collect();
    if within == 0.0 {
        let mut welder = Welder::with_room(members.len() / 2);
        let (mut places, mut firsts) = (Vec::new(), Vec::new());
        for &v in members {
            let place = welder.index_of(positions[v as usize], &mut places) as usize;
            if place == firsts.len() {
                firsts.push(v);
            }
            joined[v as usize] = firsts[place];
        }
    } else {
        let mut stays = Grid::new(members, positions, within);
        for &v in members {
            joined[v as usize] = stays.nearest_or_add(v);
        }
    }
    members.iter().any(|&v| joined[v as usize] != v).then_some(joined)
}

/// The vertices that stay, by place. No two are within the distance, so that a cell holds few, whatever the mesh.
struct Grid<'a> {
    positions: &'a [Vec3],
    within: f64,
    /// Lowest corner of all cells.
    corner: DVec3,
    /// Vertices by the hash of their cell. Its seed is random so that no file can make it slow; what is found
    /// does not depend on it.
    table: HashTable<u32>,
    seed: u64,
}

impl<'a> Grid<'a> {
    fn new(members: &[u32], positions: &'a [Vec3], within: f64) -> Self {
        let places = members.iter().map(|&v| positions[v as usize].as_dvec3());
        let corner = places.fold(DVec3::INFINITY, DVec3::min);
        let table = HashTable::with_capacity(members.len());
        Self { positions, within, corner, table, seed: RandomState::new().hash_one(members.len()) }
    }

    /// The nearest vertex within the distance; `vertex` itself, which then stays, if there is none.
    fn nearest_or_add(&mut self, vertex: u32) -> u32 {
        let p = self.place(vertex);
        let (low, high) = (self.cell(p - self.within), self.cell(p + self.within));
        let mut nearest = (self.within, vertex);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    for &other in self.table.iter_hash(hash([x, y, z], self.seed)) {
                        let found = (p.distance(self.place(other)), other);
                        if found <= nearest {
                            nearest = found;
                        }
                    }
                }
            }
        }
        if nearest.1 == vertex {
            let Self { positions, within, corner, table, seed } = self;
            let rehash = |&v: &u32| hash(cell_of(positions[v as usize].as_dvec3(), *corner, *within), *seed);
            table.insert_unique(rehash(&vertex), vertex, rehash);
        }
        nearest.1
    }

    fn place(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize].as_dvec3()
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        cell_of(p, self.corner, self.within)
    }
}

/// Cells four times as wide as the distance: what is within it lies in one along most axes, in two at most.
fn cell_of(p: DVec3, corner: DVec3, within: f64) -> [i64; 3] {
    ((p - corner) / (4.0 * within)).floor().as_i64vec3().to_array()
}

/// Cells of one mesh differ in their lowest 21 bits along each axis, so that none have the same number before it is
/// mixed.
fn hash(cell: [i64; 3], seed: u64) -> u64 {
    let number = cell.into_iter().fold(0_u64, |number, c| number << 21 | (c as u64 & 0x1F_FFFF));
    mixed(number ^ seed)
}

/// Joins the vertices; how many went, and how many triangles with them.
fn apply(mesh: &mut Mesh, joined: &[u32]) -> (usize, usize) {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    mesh.triangles.retain_mut(|corners| {
        let was_sound = !is_collapsed(*corners);
        *corners = corners.map(|v| joined.get(v as usize).copied().unwrap_or(v));
        !(was_sound && is_collapsed(*corners))
    });
    let mut renumbered = Vec::with_capacity(vertices);
    let mut kept = 0_u32;
    for (v, &to) in (0_u32..).zip(joined) {
        renumbered.push(kept);
        if v == to {
            mesh.positions[kept as usize] = mesh.positions[v as usize];
            kept += 1;
        }
    }
    mesh.positions.truncate(kept as usize);
    for v in mesh.triangles.as_flattened_mut() {
        *v = renumbered.get(*v as usize).copied().unwrap_or(*v);
    }
    (vertices - kept as usize, triangles - mesh.triangles.len())
}
