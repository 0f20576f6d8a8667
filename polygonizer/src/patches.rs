//! Which crossed edges of a cell belong together: the surface patches of every corner configuration.
//!
//! Corner `c` of a cell has its x, y and z offset in bits 0, 1 and 2. Edge `4 a + u + 2 v` runs along axis
//! `a`, at offset `u` along axis `a + 1` and `v` along axis `a + 2` (modulo 3). Face `2 a + s` is the side
//! `s` of axis `a`. A configuration has bit `c` set where corner `c` is inside.
//!
//! The surface meets a cell's faces in segments that join crossed edges; linked end to end they make loops,
//! and every loop bounds one patch. A face whose diagonally opposite corners are alike is ambiguous: its
//! four crossings join around the inside corners (so solids part there), in both cells that share it.
//!
//! A patch that has *both* segments of an ambiguous face on its border is fine until the cell behind that
//! face has such a patch too: then the two patches would share two edges. Such faces are joined around
//! the outside corners instead, which parts both patches. No configuration has more than one such face, so
//! the two cells decide it alone.
//!
//! **Source:** Nielson 2004, *Dual marching cubes*; the exception is the non-manifold case that Wenger
//! 2013, *Isosurfaces*, and Schaefer, Ju & Warren 2007 discuss. **Departs:** the table is computed here.

use std::sync::LazyLock;

/// Most patches that a cell can have.
const MAX_PATCHES: usize = 4;

/// Marks an edge without a patch, and a cell without an ambivalent face.
pub(crate) const NONE: u8 = u8::MAX;

/// Set in a table key where the cell's ambivalent face joins around the outside corners.
pub(crate) const FLIPPED: u16 = 256;

/// The patches of one corner configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patches {
    /// How many there are.
    pub count: u8,
    /// The crossed edges of each, as bits.
    pub edges: [u16; MAX_PATCHES],
    /// The patch that each edge belongs to, [`NONE`] if it is not crossed.
    pub of_edge: [u8; 12],
    /// The ambiguous face both of whose segments border the same patch, else [`NONE`].
    pub ambivalent_face: u8,
}

/// The patches for every key: a configuration, plus [`FLIPPED`] where that holds.
pub(crate) static PATCHES: LazyLock<[Patches; 512]> = LazyLock::new(|| {
    std::array::from_fn(|key| {
        let config = key as u8;
        let plain = trace(config, NONE);
        if key & FLIPPED as usize == 0 || plain.ambivalent_face == NONE {
            plain
        } else {
            trace(config, plain.ambivalent_face)
        }
    })
});

/// The edge along `axis` that touches `corner`.
const fn edge_at(axis: usize, corner: usize) -> usize {
    4 * axis + (corner >> ((axis + 1) % 3) & 1) + 2 * (corner >> ((axis + 2) % 3) & 1)
}

/// The lower corner of an edge.
pub(crate) const fn edge_start(edge: usize) -> usize {
    let axis = edge / 4;
    (edge & 1) << ((axis + 1) % 3) | (edge >> 1 & 1) << ((axis + 2) % 3)
}

/// The corners of a face, as bits.
pub(crate) const fn face_corners(face: usize) -> u8 {
    let low = [0b0101_0101, 0b0011_0011, 0b0000_1111][face / 2];
    if face.is_multiple_of(2) { low } else { !low }
}

/// Whether all corners of `face` are on the same side of the surface.
pub(crate) const fn face_is_uniform(config: u8, face: usize) -> bool {
    let corners = face_corners(face);
    config & corners == 0 || config & corners == corners
}

fn is_crossed(config: u8, edge: usize) -> bool {
    let start = edge_start(edge);
    (config >> start ^ config >> (start | 1 << (edge / 4))) & 1 == 1
}

/// The segments on `face`: pairs of crossed edges, none, one or two of them.
fn segments(config: u8, face: usize, flipped: bool) -> Vec<[usize; 2]> {
    let (u, v) = ((face / 2 + 1) % 3, (face / 2 + 2) % 3);
    let corners = (0..8).filter(|c| face_corners(face) >> c & 1 == 1);
    let mut crossed: Vec<usize> = corners
        .clone()
        .flat_map(|c| [edge_at(u, c), edge_at(v, c)])
        .filter(|&e| is_crossed(config, e))
        .collect();
    crossed.sort_unstable();
    crossed.dedup();
    match crossed[..] {
        [a, b] => vec![[a, b]],
        [_, _, _, _] => corners
            .filter(|&c| (config >> c & 1 == 1) != flipped)
            .map(|c| [edge_at(u, c), edge_at(v, c)])
            .collect(),
        _ => Vec::new(),
    }
}

/// Links the segments of all faces to loops.
fn trace(config: u8, flipped_face: u8) -> Patches {
    let on_face: [Vec<[usize; 2]>; 6] =
        std::array::from_fn(|face| segments(config, face, face == flipped_face as usize));
    let mut patches =
        Patches { count: 0, edges: [0; MAX_PATCHES], of_edge: [NONE; 12], ambivalent_face: NONE };
    for first in 0..12 {
        if !is_crossed(config, first) || patches.of_edge[first] != NONE {
            continue;
        }
        let mut loop_edges = 1_u16 << first;
        loop {
            let linked = |[a, b]: &[usize; 2]| (loop_edges >> a | loop_edges >> b) & 1 == 1;
            let grown = on_face
                .iter()
                .flatten()
                .filter(|s| linked(s))
                .fold(loop_edges, |edges, [a, b]| edges | 1 << a | 1 << b);
            if grown == loop_edges {
                break;
            }
            loop_edges = grown;
        }
        for edge in (0..12).filter(|e| loop_edges >> e & 1 == 1) {
            patches.of_edge[edge] = patches.count;
        }
        patches.edges[usize::from(patches.count)] = loop_edges;
        patches.count += 1;
    }
    for (face, pair) in on_face.iter().enumerate() {
        if let [[a, _], [b, _]] = pair[..]
            && patches.of_edge[a] == patches.of_edge[b]
        {
            patches.ambivalent_face = face as u8;
        }
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ambivalent_faces(config: u8) -> usize {
        let patches = trace(config, NONE);
        (0..6)
            .filter(|&face| match segments(config, face, false)[..] {
                [[a, _], [b, _]] => patches.of_edge[a] == patches.of_edge[b],
                _ => false,
            })
            .count()
    }

    #[test]
    fn every_crossed_edge_belongs_to_one_patch_and_no_other_edge_to_any() {
        for (key, patches) in PATCHES.iter().enumerate() {
            for edge in 0..12 {
                let holders =
                    patches.edges[..usize::from(patches.count)].iter().filter(|e| *e >> edge & 1 == 1);
                assert_eq!(
                    holders.count(),
                    usize::from(is_crossed(key as u8, edge)),
                    "key {key} edge {edge}"
                );
            }
        }
    }

    #[test]
    fn every_patch_has_at_least_three_edges() {
        for patches in PATCHES.iter() {
            for edges in &patches.edges[..usize::from(patches.count)] {
                assert!(edges.count_ones() >= 3);
            }
        }
    }

    #[test]
    fn no_configuration_has_two_ambivalent_faces() {
        assert!((0..=255).all(|config| ambivalent_faces(config) <= 1));
        assert!((0..=255).any(|config| ambivalent_faces(config) == 1));
    }

    #[test]
    fn flipping_the_ambivalent_face_parts_its_patch() {
        for config in 0..256 {
            let (plain, flipped) = (&PATCHES[config], &PATCHES[config | FLIPPED as usize]);
            let more = u8::from(plain.ambivalent_face != NONE);
            assert_eq!(flipped.count, plain.count + more, "configuration {config}");
        }
    }

    /// Over all 2¹² signs of two cells that share a face, along each axis.
    #[test]
    fn no_two_patches_of_neighbouring_cells_share_two_segments() {
        for axis in 0..3 {
            let (high, low) = (2 * axis + 1, 2 * axis);
            for signs in 0_u32..1 << 12 {
                let (a, b) = cells_of(signs, axis);
                let flip = PATCHES[usize::from(a)].ambivalent_face == high as u8
                    && PATCHES[usize::from(b)].ambivalent_face == low as u8;
                let key = |config: u8| usize::from(config) | if flip { FLIPPED as usize } else { 0 };
                let shift = |edge: usize| edge_at(edge / 4, edge_start(edge) & !(1 << axis));
                let sides = segments(a, high, flip);
                let mut pairs: Vec<_> = sides
                    .iter()
                    .map(|s| (PATCHES[key(a)].of_edge[s[0]], PATCHES[key(b)].of_edge[shift(s[0])]))
                    .collect();
                pairs.dedup();
                assert_eq!(pairs.len(), sides.len(), "axis {axis}, signs {signs:012b}");
            }
        }
    }

    /// The configurations of two cells stacked along `axis`, from the signs of three layers of four corners.
    fn cells_of(signs: u32, axis: usize) -> (u8, u8) {
        let corner = |cell: u32, c: usize| {
            let layer = cell + (c >> axis & 1) as u32;
            let in_layer = (c >> ((axis + 1) % 3) & 1 | (c >> ((axis + 2) % 3) & 1) << 1) as u32;
            (signs >> (4 * layer + in_layer) & 1) as u8
        };
        let config = |cell| (0..8).fold(0, |bits, c| bits | corner(cell, c) << c);
        (config(0), config(1))
    }
}
