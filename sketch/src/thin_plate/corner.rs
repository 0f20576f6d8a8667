//! The kink of a signed distance at a sharp corner.

use glam::DVec2;

/// The part of the signed distance field around a corner that is not smooth.
///
/// With `lᵢ(p) = nᵢ·(p − c)` for the outward normals of the two sides, the distance near the corner is the
/// larger of the two (convex) or the smaller (concave): `(l₁ + l₂)/2 ± |l₁ − l₂|/2`; but where the corner itself is
/// the nearest place, it is the distance to that, with its sign. The ridge is what this has beyond
/// `(l₁ + l₂)/2`, faded out with C² weights at `radius`. Its only kink is on the inside of the turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerRidge {
    /// The corner.
    pub at: DVec2,
    /// Unit normals of the two sides, pointing out of the shape.
    pub sides: [DVec2; 2],
    /// Whether the shape is convex here: its inside spans less than half a turn.
    pub convex: bool,
    /// Where the ridge has faded to nothing, in the unit of the places.
    pub radius: f64,
}

impl CornerRidge {
    /// The ridge of the corner of a curve that runs through `before`, `at` and `after` with its inside to the
    /// left; none where it does not turn or a leg has no length.
    pub fn new(before: DVec2, at: DVec2, after: DVec2, radius: f64) -> Option<Self> {
        let into = (at - before).try_normalize()?;
        let out = (after - at).try_normalize()?;
        let turn = into.perp_dot(out);
        let turns = turn.abs() > 1e-9 && radius > 0.0;
        turns.then(|| Self { at, sides: [into, out].map(|d| -d.perp()), convex: turn > 0.0, radius })
    }

    /// The ridge at a place, in the unit of length of the places.
    pub fn value(&self, p: DVec2) -> f64 {
        let away = p - self.at;
        let t = away.length_squared() / (self.radius * self.radius);
        if t.is_nan() || t >= 1.0 {
            return 0.0;
        }
        let sign = if self.convex { 1.0 } else { -1.0 };
        let [into, out] = self.sides.map(DVec2::perp);
        let ridge = if into.dot(away) > 0.0 && out.dot(away) < 0.0 {
            sign * away.length() - 0.5 * (self.sides[0] + self.sides[1]).dot(away)
        } else {
            sign * 0.5 * (self.sides[0] - self.sides[1]).dot(away).abs()
        };
        ridge * (1.0 - t) * (1.0 - t) * (1.0 - t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taking_the_ridge_off_leaves_the_mean_of_the_two_sides() {
        // The distance to two long sides, and its sign by the nearer.
        let reach = 1e4;
        for (into, out) in [(DVec2::Y, DVec2::new(-0.8, 0.6)), (DVec2::Y, DVec2::new(0.6, -0.8))] {
            let at = DVec2::new(3.0, 4.0);
            let ridge = CornerRidge::new(at - into, at, at + out, 1e7).expect("it turns");
            for i in 0..100 {
                let away = DVec2::from_angle(0.0631 * f64::from(i)) * (0.1 + 0.01 * f64::from(i));
                let l = ridge.sides.map(|n| n.dot(away));
                let to_side = |d: DVec2| (away - d * d.dot(away).clamp(0.0, reach)).length();
                let inside = if ridge.convex { l[0].max(l[1]) < 0.0 } else { l[0].min(l[1]) < 0.0 };
                let distance = to_side(-into).min(to_side(out)) * if inside { -1.0 } else { 1.0 };
                let rest = distance - ridge.value(at + away);
                assert!((rest - 0.5 * (l[0] + l[1])).abs() < 1e-9, "{away}: {rest}");
            }
            assert_eq!(ridge.value(at + DVec2::splat(1e7)), 0.0);
        }
    }

    #[test]
    fn a_left_turn_is_convex_and_its_normals_point_outward() {
        let corner = |c| CornerRidge::new(DVec2::ZERO, DVec2::X, c, 1.0);
        let square = corner(DVec2::ONE).expect("it turns");
        assert!(square.convex);
        assert_eq!(square.sides, [DVec2::NEG_Y, DVec2::X]);
        assert!(!corner(DVec2::new(1.0, -1.0)).expect("it turns").convex);
        assert_eq!(corner(DVec2::new(2.0, 0.0)), None);
        assert_eq!(corner(DVec2::X), None);
    }
}
