//! The four vertices around a crossed lattice edge, and how to cut their quadrilateral.

use glam::Vec2;

use crate::brick_surface::MixedCell;
use crate::lattice::CELLS;
use crate::patches::{NONE, PATCHES, edge_start};
use crate::place::{Vertex, VertexKind};

/// A brick and the 26 around it; that at offset `[x, y, z]` has the index `(x+1) + 3 (y+1) + 9 (z+1)`.
pub(crate) type Around<T> = [Option<T>; 27];

/// The index in [`Around`] of the brick itself.
pub(crate) const OWN: usize = 13;

/// A vertex as seen from a brick: its number in its own brick, and which of [`Around`] that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct VertexRef(u32);

impl VertexRef {
    /// The vertex `number` of the brick with index `brick`.
    pub const fn new(brick: usize, number: u16) -> Self {
        Self((brick as u32) << 16 | number as u32)
    }

    /// Index of its brick.
    pub const fn brick(self) -> usize {
        (self.0 >> 16) as usize
    }

    /// Its number there.
    pub const fn number(self) -> usize {
        (self.0 & 0xffff) as usize
    }

    /// The vertex as seen from the brick itself if this is how the brick with index `brick` sees it.
    pub const fn seen_from_own(self, brick: usize) -> Self {
        Self::new(self.brick() + brick - OWN, self.number() as u16)
    }

    /// The vertex as the brick with index `brick` sees it.
    pub const fn seen_from(self, brick: usize) -> Self {
        Self::new(self.brick() + OWN - brick, self.number() as u16)
    }
}

/// Steps along the axes in [`Around`].
const STRIDES: [usize; 3] = [1, 3, 9];

/// The vertices around `edge` of `cell`, counter-clockwise seen from outside. `mixed_at` finds the mixed cell
/// at a place of a brick of [`Around`].
///
/// `None` if a brick is missing that its bounds wrongly proved empty, or cells do not agree on the edge, which an update
/// with too small a box can do.
#[inline]
pub(crate) fn ring_around(
    mut mixed_at: impl FnMut(usize, [usize; 3]) -> Option<MixedCell>,
    cell: [usize; 3],
    config: u8,
    edge: usize,
) -> Option<[VertexRef; 4]> {
    let patches = &*PATCHES;
    let (axis, start) = (edge / 4, edge_start(edge));
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut ring = [VertexRef(0); 4];
    for (vertex, (back_u, back_v)) in ring.iter_mut().zip([(1, 1), (0, 1), (0, 0), (1, 0)]) {
        let mut at = cell;
        let mut brick = OWN;
        for (a, back) in [(u, back_u), (v, back_v)] {
            match cell[a] + (start >> a & 1) {
                0 if back == 1 => (at[a], brick) = (CELLS - 1, brick - STRIDES[a]),
                CELLS if back == 0 => (at[a], brick) = (0, brick + STRIDES[a]),
                index => at[a] = index - back,
            }
        }
        let mixed = mixed_at(brick, at)?;
        let patch = patches[usize::from(mixed.key)].of_edge[4 * axis + back_u + 2 * back_v];
        if patch == NONE {
            return None;
        }
        *vertex = VertexRef::new(brick, mixed.first_vertex + u16::from(patch));
    }
    if config >> start & 1 == 0 {
        ring.reverse();
    }
    Some(ring)
}

/// Diagonals must leave both triangles more than this area as seen along the edge, in squared cells. When all
/// four are in their quadrants with a margin of a 256th of a cell, the better one always leaves more.
const LEAST_AREA: f32 = 1e-6;

/// What vertices that leave their cells must leave as spare area, in squared cells: two at nearly the same
/// place would make triangles of rounding errors.
pub(crate) const ROOM: f32 = 3e-4;

/// A triangle whose height is a smaller share of its longest side is nearly flat: three vertices along one
/// sharp edge, or along the border of a cell, make triangles of rounding errors. With 1e-3, a few in millions have no
/// area where cells are small and far from the origin; with 3e-2, a third more triangles cross.
const FLAT: f32 = 3e-3;

/// How close to the outward normals at its corners a triangle's normal must be (as a dot product) to be
/// known as not turned over whatever it looks like along the edge. At a right-angled sharp edge, where normals
/// are means, a right triangle has 0.7; at a corner of three right angles 0.58.
const AGREEMENT: f32 = 0.3;

/// A cut is taken to be turned over when a triangle's normal and the outward normal at a corner have a smaller dot
/// product. With 0, a few triangles more lie over their neighbours, where gaps are narrow; a fair one at a sharp edge
/// has 0.2, see [`AGREEMENT`].
const FACING: f32 = 0.1;

/// A feature may not leave its cell if its ring can only be cut into triangles turned over more than this. With −0.5,
/// five times as many triangles cross where slivers of solids end; with 0.1, more of the edges of boxes is cut off.
const TURNED_OVER: f32 = -0.2;

/// For each diagonal, how much more than the least area the smaller of its two triangles has, mm²; first for
/// that from 0 to 2. None above 0: no cut without a flat triangle or one turned over.
///
/// The ring is counter-clockwise seen from outside, and `start_inside` says whether outside is where the edge
/// leads. Areas are those seen along the edge; where these are too small, true ones if the triangles face as
/// the surface does at their corners.
pub(crate) fn spare_areas(vertices: [&Vertex; 4], axis: usize, start_inside: bool, spacing: f32) -> [f32; 2] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let from_first = vertices.map(|vertex| vertex.position - vertices[0].position);
    let seen = from_first.map(|p| Vec2::new(p[u], p[v]));
    let side = if start_inside { 0.5 } else { -0.5 };
    let area = |[a, b, c]: [usize; 3]| side * (seen[b] - seen[a]).perp_dot(seen[c] - seen[a]);
    let least = LEAST_AREA * spacing * spacing;
    [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]].map(|[first, second]| {
        let spare = area(first).min(area(second)) - least;
        if spare > ROOM * spacing * spacing {
            return spare;
        }
        let true_area = |[a, b, c]: [usize; 3]| {
            let normal = (from_first[b] - from_first[a]).cross(from_first[c] - from_first[a]);
            let twice = normal.length();
            let agrees = [a, b, c].iter().all(|&i| vertices[i].normal.dot(normal) > AGREEMENT * twice);
            if agrees { 0.5 * twice } else { 0.0 }
        };
        spare.max(true_area(first).min(true_area(second)) - least)
    })
}

/// How the two triangles of each diagonal lie; first for that from 0 to 2.
fn cuts(vertices: [&Vertex; 4]) -> [Cut; 2] {
    [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]].map(|[first, second]| {
        let of = |corners: [usize; 3]| Cut::triangle(corners.map(|i| vertices[i]));
        let (first, second) = (of(first), of(second));
        Cut { slimness: first.slimness.min(second.slimness), facing: first.facing.min(second.facing) }
    })
}

/// The worse of a quadrilateral's two triangles, in each respect.
struct Cut {
    /// Height over longest side, about.
    slimness: f32,
    /// The dot product of the normal and that outward normal at a corner that it agrees with least; 1 for slivers
    /// along sharp edges.
    facing: f32,
}

impl Cut {
    fn triangle(corners: [&Vertex; 3]) -> Self {
        let [a, b, c] = corners.map(|vertex| vertex.position);
        let normal = (b - a).cross(c - a);
        let twice = normal.length();
        let longest2 = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        let slimness = twice / longest2;
        let least = corners.map(|vertex| vertex.normal.dot(normal)).into_iter().fold(twice, f32::min);
        let lies_along_edge =
            slimness < FLAT && corners.iter().all(|vertex| vertex.kind != VertexKind::Smooth);
        Self { slimness, facing: if lies_along_edge { 1.0 } else { least / twice } }
    }
}

/// Whether a ring can be cut into triangles that are not turned over, as far as normals tell: at corners, where they
/// are means of three faces or more, they do not.
pub(crate) fn faces_outward(vertices: [&Vertex; 4], spare: [f32; 2], least_spare: f32) -> bool {
    let has_corner = has_corner(vertices);
    let cuts = cuts(vertices);
    (0..2).any(|i| spare[i] > least_spare && (has_corner || cuts[i].facing >= TURNED_OVER))
}

fn has_corner(vertices: [&Vertex; 4]) -> bool {
    vertices.iter().any(|vertex| vertex.kind == VertexKind::Corner)
}

/// Whether the diagonal from 1 to 3 is better than that from 0 to 2.
///
/// First, no triangle may be flat or turned over; then sharp edges are joined, from corner to corner if possible; then
/// the shorter diagonal is taken.
pub(crate) fn prefers_second(vertices: [&Vertex; 4], spare: [f32; 2]) -> bool {
    if spare[0] <= 0.0 || spare[1] <= 0.0 {
        return spare[1] > spare[0];
    }
    let [first, second] = cuts(vertices);
    if first.slimness.min(second.slimness) < FLAT {
        return second.slimness > first.slimness;
    }
    let facing = [first, second].map(|cut| cut.facing.min(FACING));
    if facing[0] != facing[1] && (facing.contains(&FACING) || !has_corner(vertices)) {
        return facing[1] > facing[0];
    }
    let sharpness = |a: usize, b: usize| {
        let (a, b) = (vertices[a].kind, vertices[b].kind);
        if a.min(b) == VertexKind::Smooth { None } else { Some((a.min(b), a.max(b))) }
    };
    match sharpness(1, 3).cmp(&sharpness(0, 2)) {
        std::cmp::Ordering::Equal => {
            let length = |a: usize, b: usize| vertices[a].position.distance_squared(vertices[b].position);
            length(1, 3) < length(0, 2)
        }
        order => order.is_gt(),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn smooth(x: f32, y: f32, z: f32, normal: Vec3) -> Vertex {
        Vertex { position: Vec3::new(x, y, z), normal, kind: VertexKind::Smooth }
    }

    /// A ring around the lattice edge along z at the origin: one vertex hangs low on a wall, below a flat part.
    fn beside_a_wall() -> [Vertex; 4] {
        let wall = Vec3::new(0.9, 0.4, 0.1).normalize();
        [
            smooth(-0.5, -0.7, 0.7, Vec3::Z),
            smooth(0.4, -0.4, -0.5, wall),
            smooth(0.1, 0.4, 0.0, Vec3::Z),
            smooth(-0.1, 0.6, -0.1, Vec3::Z),
        ]
    }

    #[test]
    fn a_diagonal_that_turns_no_triangle_over_beats_a_shorter_one() {
        let ring = beside_a_wall();
        for turn in 0..4 {
            let turned: [&Vertex; 4] = std::array::from_fn(|i| &ring[(i + turn) % 4]);
            let spare = spare_areas(turned, 2, true, 1.0);
            assert!(spare.iter().all(|spare| *spare > 0.0), "seen along the edge, both will do: {spare:?}");
            assert_eq!(prefers_second(turned, spare), turn % 2 == 1, "turned by {turn}");
            let length = |a: usize, b: usize| turned[a].position.distance(turned[b].position);
            assert_eq!(length(1, 3) < length(0, 2), turn % 2 == 0, "the shorter one is the other");
        }
    }
}
