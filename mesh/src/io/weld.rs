//! Joining vertices that lie in exactly the same place.

use std::hash::{BuildHasher, RandomState};

use glam::Vec3;
use hashbrown::HashTable;

use crate::Mesh;

/// Finds the index of a position, adding it where it is new.
///
/// The table holds indices only, 5 bytes a vertex; its hash is seeded at random so that no file can make it
/// slow, and the order of indices does not depend on it.
pub(super) struct Welder {
    table: HashTable<u32>,
    hasher: RandomState,
}

impl Welder {
    /// With room for this many vertices, which the caller has reason to expect.
    pub(super) fn with_room(vertices: usize) -> Self {
        Self { table: HashTable::with_capacity(vertices), hasher: RandomState::new() }
    }

    /// The index of `position` in `positions`; pushes it if no bit-identical one is there. The caller keeps
    /// `positions.len()` below `u32::MAX` and hands in the same list every time.
    pub(super) fn index_of(&mut self, position: Vec3, positions: &mut Vec<Vec3>) -> u32 {
        // Adding zero turns -0 into 0, so that equal coordinates have equal bits.
        let position = position + Vec3::ZERO;
        let key = bits(position);
        let hash = self.hasher.hash_one(key);
        let same = |&index: &u32| bits(positions[index as usize]) == key;
        if let Some(&index) = self.table.find(hash, same) {
            return index;
        }
        let index = positions.len() as u32;
        positions.push(position);
        let rehash = |&index: &u32| self.hasher.hash_one(bits(positions[index as usize]));
        self.table.insert_unique(hash, index, rehash);
        index
    }
}

fn bits(position: Vec3) -> [u32; 3] {
    position.to_array().map(f32::to_bits)
}

/// The mesh with bit-identical vertices joined (`-0 = 0`) and unused ones gone, and how many vertices that took away.
///
/// Texture seams and scanner output split vertices of OBJ and PLY files; this closes them. Triangles that lose a
/// corner by it are left out. Vertices keep the order in which triangles first use them. Indices must be in range.
/// **Cost:** O(triangles).
pub fn weld(mesh: &Mesh) -> (Mesh, usize) {
    let mut welder = Welder::with_room(mesh.positions.len());
    let mut positions = Vec::new();
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|index| welder.index_of(mesh.positions[index as usize], &mut positions));
        if a != b && b != c && c != a {
            triangles.push([a, b, c]);
        }
    }
    let gone = mesh.positions.len().saturating_sub(positions.len());
    (Mesh { positions, triangles }, gone)
}
