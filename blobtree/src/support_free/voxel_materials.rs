//! What brush strokes say that the matter they add is made of.

use super::VOXEL_BRICK;
use glam::Vec3;
use std::collections::HashMap;

/// No lattice has as many places along a side.
const FARTHEST: f64 = 1e9;

/// A brick of materials, each one more than its number; 0 where nothing is said.
type Brick = [u16; VOXEL_BRICK * VOXEL_BRICK * VOXEL_BRICK];

/// Materials on a lattice of space, in bricks where something is said.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelMaterials {
    spacing: f32,
    /// Lattice index of place 0.
    low: [i32; 3],
    bricks: HashMap<[usize; 3], Box<Brick>>,
}

impl VoxelMaterials {
    /// Nothing said, on a lattice of this spacing, mm, whose place 0 has the index `low` from the origin.
    pub fn new(spacing: f32, low: [i32; 3]) -> Self {
        Self { spacing, low, bricks: HashMap::new() }
    }

    /// Whether no place is of another material than 0.
    pub fn is_plain(&self) -> bool {
        self.bricks.values().all(|brick| brick.iter().all(|said| *said <= 1))
    }

    /// Says what a place of the lattice is made of.
    pub fn set(&mut self, at: [usize; 3], material: u8) {
        let (brick, within) = find(at);
        let brick = self.bricks.entry(brick).or_insert_with(|| Box::new([0; _]));
        brick[within] = u16::from(material) + 1;
    }

    /// The material that the nearest of the eight places around says; 0 if none does. Below place 0 all goes on as there.
    pub fn at(&self, place: Vec3) -> u8 {
        let steps = place / self.spacing;
        let steps: [f64; 3] =
            std::array::from_fn(|a| (f64::from(steps[a]) - f64::from(self.low[a])).clamp(0.0, FARTHEST));
        let corners =
            (0..8).map(|n: usize| std::array::from_fn(|a| steps[a].floor() as usize + (n >> a & 1)));
        let said = corners.filter_map(|corner: [usize; 3]| {
            let away = (0..3).map(|a| (corner[a] as f64 - steps[a]).powi(2)).sum::<f64>();
            Some((away, self.said(corner)?))
        });
        said.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, material)| material)
    }

    fn said(&self, at: [usize; 3]) -> Option<u8> {
        let (brick, within) = find(at);
        let said = self.bricks.get(&brick)?[within];
        u8::try_from(said.checked_sub(1)?).ok()
    }
}

/// A place's brick, and its number in that.
fn find(at: [usize; 3]) -> ([usize; 3], usize) {
    let [x, y, z] = at.map(|i| i % VOXEL_BRICK);
    (at.map(|i| i / VOXEL_BRICK), x + VOXEL_BRICK * (y + VOXEL_BRICK * z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_around_that_says_something_says_the_material() {
        let mut materials = VoxelMaterials::new(0.5, [-3, 0, 7]);
        materials.set([9, 2, 0], 0);
        assert!(materials.is_plain());
        materials.set([9, 2, 0], 255);
        materials.set([10, 2, 0], 0);
        let place = Vec3::new(3.0, 1.0, 3.5);
        let at = |x: f32, y: f32, z: f32| materials.at(place + Vec3::new(x, y, z));
        assert_eq!([at(0.24, 0.0, 0.0), at(0.26, 0.0, 0.0)], [255, 0]);
        assert_eq!([at(0.0, 0.0, 0.49), at(0.0, -0.49, 0.0), at(-0.49, 0.0, 0.0)], [255; 3]);
        assert_eq!([at(0.0, 0.0, 0.51), at(0.0, -0.51, 0.0), at(-0.51, 0.0, 0.0)], [0; 3]);
        // The first layer is the lowest.
        assert_eq!(at(0.0, 0.0, -20.0), 255);
        for far in [-f32::MAX, f32::MAX] {
            assert_eq!(materials.at(Vec3::splat(far)), 0);
        }
    }
}
