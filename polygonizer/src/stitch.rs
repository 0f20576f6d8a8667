//! Phases two and three: which features may leave their cells, then the triangles around a brick's crossed
//! lattice edges.

use glam::Vec3;

use crate::brick_surface::{BrickSurface, Bold};
use crate::patches::edge_start;
use crate::place::Vertex;
use crate::ring::{Around, OWN, VertexRef, can_be_cut, least_areas, prefers_second, ring_around};

/// The vertices of the middle brick, those moved whose bold places do no harm.
///
/// A bold vertex is not sure to leave its rings cuttable. It is taken if they are, with every other
/// bold vertex of higher rank (less far out) taken or not, and every one of lower rank not: whatever the others
/// turn out to be, the lowest taken one of a ring has made sure of it.
pub(crate) fn settle(around: &Around<&BrickSurface>, spacing: f32) -> Vec<Vertex> {
    let Some(own) = around[OWN] else { return Vec::new() };
    let mut vertices = own.vertices.to_vec();
    for bold in &own.bold {
        let fits = own
            .edges_of(bold)
            .all(|(cell, config, edge)| bold_fits(around, bold, (cell, config, edge), spacing));
        if fits {
            vertices[usize::from(bold.number)] = bold.vertex;
        }
    }
    vertices
}

/// Whether the ring around an edge can be cut with `bold` in its bold place.
fn bold_fits(
    around: &Around<&BrickSurface>,
    bold: &Bold,
    (cell, config, edge): ([usize; 3], u8, usize),
    spacing: f32,
) -> bool {
    let Some(ring) = ring_around(around, cell, config, edge) else { return false };
    let places: [[Option<Vec3>; 2]; 4] = ring.map(|r| {
        let Some(brick) = around[r.brick()] else { return [None; 2] };
        if r == VertexRef::new(OWN, bold.number) {
            return [Some(bold.vertex.position), None];
        }
        let other = brick.bold.iter().find(|b| usize::from(b.number) == r.number() && b.rank() < bold.rank());
        [Some(brick.vertices[r.number()].position), other.map(|b| b.vertex.position)]
    });
    let start_inside = config >> edge_start(edge) & 1 == 1;
    (0..16).all(|choice: usize| {
        let mut positions = [Vec3::ZERO; 4];
        for (i, place) in places.iter().enumerate() {
            // A choice that a vertex does not have repeats another.
            let Some(position) = place[choice >> i & 1].or(place[0]) else { return false };
            positions[i] = position;
        }
        can_be_cut(least_areas(positions, edge / 4, start_inside, spacing))
    })
}

/// The triangles around the lattice edges that start in cells of the middle brick: one quadrilateral for each
/// edge that the surface crosses, in the order of cells and axes, cut in two. `vertices` are the settled ones.
pub(crate) fn stitch(
    around: &Around<&BrickSurface>,
    vertices: &Around<&[Vertex]>,
    spacing: f32,
) -> Vec<[VertexRef; 3]> {
    let Some(own) = around[OWN] else { return Vec::new() };
    let mut triangles = Vec::with_capacity(2 * own.vertices.len());
    for (cell, mixed) in own.cells() {
        let config = mixed.key as u8;
        for axis in 0..3 {
            if (config >> (1 << axis) ^ config) & 1 == 0 {
                continue;
            }
            let ring = ring_around(around, cell, config, 4 * axis);
            let found = ring.and_then(|ring| Some((ring, vertices_of(ring, vertices)?)));
            let Some((ring, corners)) = found else { continue };
            let areas = least_areas(corners.map(|v| v.position), axis, config & 1 == 1, spacing);
            let [a, b, c, d] = ring;
            if prefers_second(corners, areas) {
                triangles.extend([[b, c, d], [b, d, a]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    triangles
}

fn vertices_of<'a>(ring: [VertexRef; 4], vertices: &Around<&'a [Vertex]>) -> Option<[&'a Vertex; 4]> {
    let of = |r: VertexRef| Some(&vertices[r.brick()]?[r.number()]);
    Some([of(ring[0])?, of(ring[1])?, of(ring[2])?, of(ring[3])?])
}
