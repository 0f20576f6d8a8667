//! Which colour a mesh has where.

use blobtree::STONE;
use glam::Vec3;

/// What a mesh is painted with.
#[derive(Clone, Copy, Debug)]
pub enum Paint {
    /// The same everywhere.
    Plain([u8; 3]),
    /// By overhang: what leans out farther than `limit`, radians from the vertical, in orange to red; what comes
    /// close, in blue; everything else, and what lies on the bed at height `bed`, mm, in stone.
    Overhangs {
        /// Radians from the vertical.
        limit: f32,
        /// mm.
        bed: f32,
    },
}

/// Overhangs begin to turn blue this much below the limit: 20°.
const CLOSE: f32 = 0.349;
/// Facets no higher than this lie on the bed, mm.
const ON_BED: f32 = 1e-3;
/// Blue, orange and vermilion of Okabe and Ito, which people who confuse red and green tell apart too.
const BLUE: [u8; 3] = [0, 114, 178];
const ORANGE: [u8; 3] = [240, 170, 20];
const VERMILION: [u8; 3] = [203, 74, 0];

impl Paint {
    /// The colour of a triangle.
    pub fn of(&self, corners: [Vec3; 3]) -> [u8; 3] {
        let (limit, bed) = match *self {
            Self::Plain(color) => return color,
            Self::Overhangs { limit, bed } => (limit, bed),
        };
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if a.z.max(b.z).max(c.z) <= bed + ON_BED {
            return STONE.0;
        }
        let beyond = (-normal.z).clamp(-1.0, 1.0).asin() - limit;
        // Facets right at the limit are rounded to either side of it.
        if beyond > 0.5_f32.to_radians() {
            mixed(ORANGE, VERMILION, beyond / (std::f32::consts::FRAC_PI_2 - limit))
        } else {
            mixed(BLUE, STONE.0, -beyond / CLOSE)
        }
    }
}

/// From one colour to another.
fn mixed(from: [u8; 3], to: [u8; 3], share: f32) -> [u8; 3] {
    let share = share.clamp(0.0, 1.0);
    std::array::from_fn(|i| (f32::from(from[i]) * (1.0 - share) + f32::from(to[i]) * share).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A facet that leans out by so many degrees from the vertical, well above the bed.
    fn facet(degrees: f32) -> [Vec3; 3] {
        let up = Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        [Vec3::Z * 9.0, Vec3::Z * 9.0 + up + Vec3::Y, Vec3::Z * 9.0 + up]
    }

    #[test]
    fn overhangs_are_told_from_what_prints_and_the_bed() {
        let paint = Paint::Overhangs { limit: 45f32.to_radians(), bed: 0.0 };
        assert_eq!(paint.of(facet(0.0)), STONE.0);
        assert_eq!(paint.of(facet(-60.0)), STONE.0);
        assert_eq!(paint.of(facet(45.0)), BLUE);
        assert_eq!(paint.of(facet(46.0))[2], mixed(ORANGE, VERMILION, 1.0 / 45.0)[2]);
        assert_eq!(paint.of(facet(90.0)), VERMILION);
        let lying = facet(90.0).map(|p| p - Vec3::Z * 9.0);
        assert_eq!(paint.of(lying), STONE.0);
    }
}
