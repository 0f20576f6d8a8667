//! Which triangles meet at which edge, as one sorted list: the base of every topological question.

use rayon::prelude::*;

use crate::Mesh;

/// One side of one triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Half {
    /// The two vertices of the edge, the smaller first.
    ends: [u32; 2],
    /// Index of the triangle.
    pub triangle: u32,
    /// Which side: from corner `side` to corner `side + 1`.
    pub side: u8,
    /// Whether the triangle runs along the edge from its smaller to its larger vertex.
    pub forward: bool,
}

/// All sides of all sound triangles (three different vertices that exist), sorted by edge, then by triangle.
pub(crate) struct EdgeTable {
    halves: Vec<Half>,
}

/// One edge with the triangle sides that lie on it.
#[derive(Clone, Copy)]
pub(crate) struct Edge<'a> {
    pub halves: &'a [Half],
}

/// Into so many tables edges are shared, where work on them may be stopped in between.
const SHARES: u32 = 64;

/// All sides of all sound triangles.
fn halves(mesh: &Mesh) -> impl Iterator<Item = Half> {
    let sound = |t: &[u32; 3]| mesh.corners(*t).is_some() && !is_collapsed(*t);
    (0..=u32::MAX).zip(&mesh.triangles).filter(move |(_, t)| sound(t)).flat_map(|(triangle, &t)| {
        [0u8, 1, 2].map(|side| {
            let (from, to) = (t[usize::from(side)], t[(usize::from(side) + 1) % 3]);
            Half { ends: [from.min(to), from.max(to)], triangle, side, forward: from < to }
        })
    })
}

impl EdgeTable {
    /// Sorts the sides; O(n log n). Triangles beyond the 2³²nd are not seen.
    pub fn new(mesh: &Mesh) -> Self {
        Self { halves: halves(mesh).collect() }.sorted()
    }

    /// Some tables, not sorted yet, which share all edges among them: those whose first vertices are neighbours stay
    /// together.
    pub fn in_shares(mesh: &Mesh) -> Vec<Self> {
        let width = (mesh.positions.len() as u32).div_ceil(SHARES).max(1);
        let mut shares: Vec<Self> = (0..SHARES).map(|_| Self { halves: Vec::new() }).collect();
        halves(mesh).for_each(|half| shares[(half.ends[0] / width) as usize].halves.push(half));
        shares
    }

    /// In the order that everything else needs.
    pub fn sorted(mut self) -> Self {
        self.halves.par_sort_unstable();
        self
    }

    /// The edges in ascending order of their vertices.
    pub fn iter(&self) -> impl Iterator<Item = Edge<'_>> {
        self.halves.chunk_by(|a, b| a.ends == b.ends).map(|halves| Edge { halves })
    }
}

impl Edge<'_> {
    /// The two vertices, the smaller index first.
    pub fn ends(&self) -> [u32; 2] {
        self.halves[0].ends
    }

    /// Triangles running forward minus triangles running backward: 0 where orientations agree all around.
    pub fn balance(&self) -> i64 {
        self.halves.iter().map(|h| if h.forward { 1 } else { -1 }).sum()
    }
}

/// Whether a triangle names a vertex twice.
pub(crate) fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
