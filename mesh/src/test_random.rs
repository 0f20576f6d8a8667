//! Seeded random numbers and triangle soups for the tests of this crate.

use glam::Vec3;

use crate::Mesh;

/// SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x1234_5678_9abc_def0)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In the cube from −`reach` to `reach`.
    pub fn point(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * (2.0 * reach) - Vec3::splat(reach)
    }
}

/// Unconnected triangles with corners within `size` of a middle within `reach` of the origin (per axis).
pub(crate) fn soup(random: &mut Random, triangles: usize, reach: f32, size: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in (0u32..).take(triangles) {
        let middle = random.point(reach);
        mesh.positions.extend([(); 3].map(|()| middle + random.point(size)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}
