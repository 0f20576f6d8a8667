//! Ways along circles: how a line goes on, and between its samples.

use glam::DVec2;

/// No arc between two samples turns further than this, radians, to either side of the middle.
const MOST_HALF_TURN: f64 = 0.8;

/// A way ahead along a circle, or straight on where the curvature is 0.
#[derive(Clone, Copy)]
pub(super) struct Way {
    pub at: DVec2,
    /// Of length 1.
    pub direction: DVec2,
    /// Positive to the left.
    pub curvature: f64,
}

impl Way {
    /// On from the last of three places, along their circle.
    pub fn through([a, b, c]: [DVec2; 3]) -> Option<Self> {
        let curvature = curvature(a, b, c);
        let half = half_turn(curvature, b.distance(c));
        let direction = DVec2::from_angle(half).rotate((c - b).try_normalize()?);
        Some(Self { at: c, direction, curvature })
    }

    /// The place and the direction so far ahead.
    pub fn ahead(&self, length: f64) -> (DVec2, DVec2) {
        let turned = DVec2::from_angle(self.curvature * length).rotate(self.direction);
        let half = 0.5 * self.curvature * length;
        let chord = if half.abs() < 1e-9 { length } else { length * half.sin() / half };
        (self.at + chord * DVec2::from_angle(half).rotate(self.direction), turned)
    }

    /// How far a place is from the whole circle.
    pub fn off(&self, place: DVec2) -> f64 {
        let to = place - self.at;
        let beside = self.direction.perp_dot(to);
        // |to − r·n| − |r|, in a form that holds for straight ways too.
        let bent = beside - 0.5 * self.curvature * to.length_squared();
        let root = (1. - 2. * self.curvature * bent).max(0.).sqrt();
        (2. * bent / (1. + root)).abs()
    }

    /// How far ahead along this way and the other one they meet, if they do so at an angle.
    pub fn meets(&self, other: &Self) -> Option<[f64; 2]> {
        let mut lengths = [0., 0.];
        for _ in 0..8 {
            let ((a, on), (b, off)) = (self.ahead(lengths[0]), other.ahead(lengths[1]));
            let turn = on.perp_dot(off);
            if turn.abs() < 0.05 {
                return None;
            }
            lengths[0] += (b - a).perp_dot(off) / turn;
            lengths[1] += (b - a).perp_dot(on) / turn;
        }
        let apart = self.ahead(lengths[0]).0.distance(other.ahead(lengths[1]).0);
        (apart < 1e-9).then_some(lengths)
    }

    /// The angle by which one turns who goes so far ahead, and back along the other way.
    pub fn turn_to(&self, other: &Self, lengths: [f64; 2]) -> f64 {
        let (on, off) = (self.ahead(lengths[0]).1, other.ahead(lengths[1]).1);
        on.angle_to(-off).abs()
    }
}

/// Of the circle through three places, positive where they turn left.
fn curvature(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let sides = a.distance(b) * b.distance(c) * c.distance(a);
    2. * (b - a).perp_dot(c - a) / sides.max(1e-30)
}

/// By how much a circle turns over half an arc with a chord of this length.
fn half_turn(curvature: f64, chord: f64) -> f64 {
    (0.5 * curvature * chord).clamp(-1., 1.).asin()
}

/// The smooth way between two places, given what comes before and after them, or that one of them is a corner: at each
/// end it goes along the circle through three places.
///
/// **Source:** circle splines (Séquin, Lee & Yen 2005): the turn of the arc is blended.
#[derive(Clone, Copy)]
pub(super) struct Between {
    ends: [DVec2; 2],
    half_turns: [f64; 2],
}

impl Between {
    pub fn new(before: Option<DVec2>, ends: [DVec2; 2], after: Option<DVec2>) -> Self {
        let [a, b] = ends;
        let chord = a.distance(b);
        let half = |curvature: f64| half_turn(curvature, chord).clamp(-MOST_HALF_TURN, MOST_HALF_TURN);
        let start = before.map(|p| half(curvature(p, a, b)));
        let end = after.map(|q| half(curvature(a, b, q)));
        let half_turns = [start.or(end).unwrap_or(0.), end.or(start).unwrap_or(0.)];
        Self { ends, half_turns }
    }

    /// The place at a share of the way.
    pub fn at(&self, share: f64) -> DVec2 {
        let later = (0.5 * std::f64::consts::PI * share).sin().powi(2);
        let half = self.half_turns[0] + later * (self.half_turns[1] - self.half_turns[0]);
        let scale = if half.abs() < 1e-9 { share } else { (half * share).sin() / half.sin() };
        let [a, b] = self.ends;
        a + scale * DVec2::from_angle(-half * (1. - share)).rotate(b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_circle(angle: f64) -> DVec2 {
        DVec2::new(3., 1.) + 2. * DVec2::from_angle(angle)
    }

    #[test]
    fn ways_along_a_circle_stay_on_it() {
        for [from, on] in [[0.2, 0.3], [2., -0.4]] {
            let place = |k: f64| on_circle(from + k * on);
            let way = Way::through([place(0.), place(1.), place(2.)]).expect("three places");
            assert!((way.curvature - 0.5 * on.signum()).abs() < 1e-9);
            assert!(way.ahead(2. * on.abs()).0.distance(place(3.)) < 1e-9);
            assert!(way.off(place(-1.)) < 1e-9 && (way.off(DVec2::new(4., 1.)) - 1.).abs() < 1e-9);
            let between = Between::new(Some(place(0.)), [place(1.), place(2.)], Some(place(3.)));
            assert!(between.at(0.3).distance(place(1.3)) < 1e-9);
        }
    }

    #[test]
    fn a_straight_way_meets_a_circle_where_it_should() {
        let place = |k: f64| on_circle(-0.6 + 0.1 * k);
        let arc = Way::through([place(0.), place(1.), place(2.)]).expect("three places");
        let line = Way { at: DVec2::new(0., 1.), direction: DVec2::X, curvature: 0. };
        let [along_arc, along_line] = arc.meets(&line).expect("they cross");
        assert!((along_arc - 0.8).abs() < 1e-9 && (along_line - 5.).abs() < 1e-9);
        assert!((arc.turn_to(&line, [along_arc, along_line]) - 0.5 * std::f64::consts::PI).abs() < 1e-9);
    }
}
