//! Phases two and three: which features may leave their cells, then the triangles around a brick's crossed
//! lattice edges.

use glam::Vec3;

use crate::brick_surface::{Bold, BrickSurface, MixedCell};
use crate::lattice::CELLS;
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
        let fits = |place: &&Vec3| {
            own.edges_of(bold).all(|around_edge| bold_fits(around, bold, **place, around_edge, spacing))
        };
        if let Some(&position) = bold.places.iter().find(fits) {
            vertices[usize::from(bold.number)] = Vertex { position, ..bold.vertex };
        }
    }
    vertices
}

/// Whether the ring around an edge can be cut with `bold` at `place`.
fn bold_fits(
    around: &Around<&BrickSurface>,
    bold: &Bold,
    place: Vec3,
    (cell, config, edge): ([usize; 3], u8, usize),
    spacing: f32,
) -> bool {
    let Some(ring) = ring_around(|brick, at| around[brick]?.cell(at), cell, config, edge) else {
        return false;
    };
    let mut places = [const { Vec::new() }; 4];
    for (places, vertex) in places.iter_mut().zip(ring) {
        let Some(brick) = around[vertex.brick()] else { return false };
        if vertex == VertexRef::new(OWN, bold.number) {
            places.push(place);
            continue;
        }
        places.push(brick.vertices[vertex.number()].position);
        if let Ok(other) = brick.bold.binary_search_by_key(&vertex.number(), |b| usize::from(b.number))
            && brick.bold[other].rank() < bold.rank()
        {
            places.extend(brick.bold[other].places);
        }
    }
    let start_inside = config >> edge_start(edge) & 1 == 1;
    let choices = places.each_ref().map(Vec::len);
    (0..choices.iter().product()).all(|mut choice: usize| {
        let positions = std::array::from_fn(|i| {
            let place = places[i][choice % choices[i]];
            choice /= choices[i];
            place
        });
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
    // Rings reach backwards only, so within the brick they find all they need here.
    let mut seen = [MixedCell { first_vertex: 0, key: 0 }; CELLS * CELLS * CELLS];
    let place = |[x, y, z]: [usize; 3]| (z * CELLS + y) * CELLS + x;
    for (cell, mixed) in own.cells() {
        let config = mixed.key as u8;
        seen[place(cell)] = mixed;
        for axis in 0..3 {
            if (config >> (1 << axis) ^ config) & 1 == 0 {
                continue;
            }
            let mixed_at = |brick: usize, at| {
                if brick == OWN { Some(seen[place(at)]) } else { around[brick]?.cell(at) }
            };
            let ring = ring_around(mixed_at, cell, config, 4 * axis);
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
