//! Phase two: which features may leave their cells.
//!
//! A bold vertex is not sure to leave its rings cuttable. So places that do not fit even with all others at
//! home are dropped first. Then a place is taken if its rings can be cut with every other bold vertex of
//! higher rank (less far out) in any of its places or at home, and every one of lower rank at home. Whatever
//! the others turn out to be, the lowest of a ring that left home has made sure of the ring.

use blobtree::BRICK_SAMPLES;

use crate::brick_surface::{Bold, BrickSurface};
use crate::patches::edge_start;
use crate::place::Vertex;
use crate::ring::{Around, OWN, ROOM, VertexRef, faces_outward, ring_around, spare_areas};

// Vertex numbers have 16 bits: four patches in each cell at most.
const _: () = assert!(4 * BRICK_SAMPLES <= 1 << 16);

/// The bold vertices of the middle brick, with those places that fit if all others stay at home.
pub(crate) fn fitting_alone(around: &Around<&BrickSurface>, spacing: f32) -> Vec<Bold> {
    let Some(own) = around[OWN] else { return Vec::new() };
    let alone = |bold: &Bold| {
        let fits = |place: &&Vertex| fits(around, own, bold, place, |_| None, spacing);
        let places: Vec<Vertex> = bold.places.iter().filter(fits).copied().collect();
        (!places.is_empty()).then_some(Bold { places, ..*bold })
    };
    own.bold.iter().filter_map(alone).collect()
}

/// The vertices of the middle brick, those moved whose bold places do no harm. `bold` are those of all bricks
/// around that fit alone.
pub(crate) fn settle(around: &Around<&BrickSurface>, bold: &Around<&[Bold]>, spacing: f32) -> Vec<Vertex> {
    let (Some(own), Some(own_bold)) = (around[OWN], bold[OWN]) else { return Vec::new() };
    let mut vertices = own.vertices.to_vec();
    for mover in own_bold {
        let rival = |vertex: VertexRef| {
            let others = bold[vertex.brick()]?;
            let found = others.binary_search_by_key(&vertex.number(), |b| usize::from(b.number)).ok()?;
            Some(&others[found]).filter(|other| other.rank() < mover.rank())
        };
        let fits = |place: &&Vertex| fits(around, own, mover, place, rival, spacing);
        if let Some(&place) = mover.places.iter().find(fits) {
            vertices[usize::from(mover.number)] = place;
        }
    }
    vertices
}

/// Whether all rings around `mover` can be cut with it at `place` and its rivals anywhere.
fn fits<'a>(
    around: &Around<&BrickSurface>,
    own: &BrickSurface,
    mover: &Bold,
    place: &Vertex,
    rival: impl Fn(VertexRef) -> Option<&'a Bold>,
    spacing: f32,
) -> bool {
    own.edges_of(mover).all(|(cell, config, edge)| {
        let ring = ring_around(|brick, at| around[brick]?.cell(at), cell, config, edge);
        let start_inside = config >> edge_start(edge) & 1 == 1;
        ring.is_some_and(|ring| {
            let choices = ring.map(|vertex| {
                if vertex == VertexRef::new(OWN, mover.number) {
                    return vec![*place];
                }
                let home = around[vertex.brick()].map(|brick| brick.vertices[vertex.number()]);
                let away = rival(vertex).into_iter().flat_map(|other| &other.places).copied();
                home.into_iter().chain(away).collect()
            });
            all_can_be_cut(&choices, edge / 4, start_inside, spacing)
        })
    })
}

/// Whether a ring can be cut whichever of its choices each vertex takes.
fn all_can_be_cut(choices: &[Vec<Vertex>; 4], axis: usize, start_inside: bool, spacing: f32) -> bool {
    let combinations = choices.iter().map(Vec::len).product();
    (0..combinations).all(|mut rest: usize| {
        let vertices = std::array::from_fn(|i| {
            let choice = rest % choices[i].len();
            rest /= choices[i].len();
            &choices[i][choice]
        });
        let spare = spare_areas(vertices, axis, start_inside, spacing);
        faces_outward(vertices, spare, ROOM * spacing * spacing)
    })
}
