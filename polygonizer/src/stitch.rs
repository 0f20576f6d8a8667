//! Phase three: the triangles around a brick's crossed lattice edges.

use crate::brick_surface::{BrickSurface, MixedCell};
use crate::lattice::CELLS;
use crate::place::Vertex;
use crate::ring::{Around, OWN, VertexRef, prefers_second, ring_around, spare_areas};

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
            let spare = spare_areas(corners, axis, config & 1 == 1, spacing);
            let [a, b, c, d] = ring;
            if prefers_second(corners, spare) {
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
