//! From where the model is looked at, and how the hand turns it.

use blobtree::Aabb;
use glam::{Vec2, Vec3};
use sketch::suggest::{Projection, View};

/// The angle between the top and the bottom of the view, or between its sides if it is narrower, degrees. Small, so that sketches on a plane parallel to the
/// screen look as they were drawn.
const DEGREES: f32 = 24.0;

/// How far a drag over the whole shorter side of the view turns the model, degrees.
const TURN: f32 = 180.0;

/// Distances between which the camera stays from its target, mm.
const DISTANCES: [f32; 2] = [1.0, 100_000.0];

/// The farthest a target may be from the origin, mm.
const FARTHEST: f32 = 50_000.0;

/// What is shown when there is nothing to show: a hand's breadth around the origin.
const EMPTY: Aabb = Aabb { min: Vec3::new(-40.0, -40.0, 0.0), max: Vec3::new(40.0, 40.0, 50.0) };

/// An eye that looks at a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What it looks at, and turns around, mm.
    pub target: Vec3,
    /// How far it is away, mm.
    pub distance: f32,
    /// Around the vertical from the front, degrees, counter-clockwise seen from above: 90 is the right.
    pub azimuth: f32,
    /// Above the horizontal, −90 to 90 degrees.
    pub elevation: f32,
    /// Whether far things look smaller.
    pub perspective: bool,
}

/// The views with names: those of the view cube and of the keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From the front and the right, and from above.
    Corner,
    /// From the front.
    Front,
    /// From behind.
    Back,
    /// From the left.
    Left,
    /// From the right.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
}

impl Side {
    /// All, in the order of their keys, 0 to 6.
    pub const ALL: [Self; 7] =
        [Self::Corner, Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom];

    /// The name on the button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corner => "Corner",
            Self::Front => "Front",
            Self::Back => "Back",
            Self::Left => "Left",
            Self::Right => "Right",
            Self::Top => "Top",
            Self::Bottom => "Bottom",
        }
    }

    /// Azimuth and elevation, degrees.
    fn angles(self) -> [f32; 2] {
        match self {
            Self::Corner => [35.0, 27.0],
            Self::Front => [0.0, 0.0],
            Self::Back => [180.0, 0.0],
            Self::Left => [-90.0, 0.0],
            Self::Right => [90.0, 0.0],
            Self::Top => [0.0, 90.0],
            Self::Bottom => [0.0, -90.0],
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        let mut camera =
            Self { target: Vec3::ZERO, distance: 1.0, azimuth: 0.0, elevation: 0.0, perspective: true };
        camera.look_from(Side::Corner);
        camera.show(Aabb::EMPTY);
        camera
    }
}

impl Camera {
    /// How the model is seen on a screen of this size, pixels.
    pub fn view(&self, screen: Vec2) -> View {
        let (sa, ca) = self.azimuth.to_radians().sin_cos();
        let (se, ce) = self.elevation.to_radians().sin_cos();
        let back = Vec3::new(sa * ce, -ca * ce, se);
        let up = Vec3::new(-sa * se, ca * se, ce);
        let projection = if self.perspective {
            let height_degrees = 2.0 * (narrowest() * screen.y / shorter(screen)).atan().to_degrees();
            Projection::Perspective { height_degrees }
        } else {
            Projection::Orthographic { mm_per_px: self.mm_per_px(screen) }
        };
        View { eye: self.target + back * self.distance, forward: -back, up, screen, projection }
    }

    /// The size of a pixel at the target, mm.
    pub fn mm_per_px(&self, screen: Vec2) -> f32 {
        2.0 * self.distance * narrowest() / shorter(screen)
    }

    /// Turns the model with a drag over some pixels, as if it were held.
    pub fn orbit(&mut self, by_px: Vec2, screen: Vec2) {
        let degrees = by_px * TURN / shorter(screen);
        self.azimuth = (self.azimuth - degrees.x + 180.0).rem_euclid(360.0) - 180.0;
        self.elevation = (self.elevation + degrees.y).clamp(-90.0, 90.0);
    }

    /// Moves the model with a drag over some pixels; what is at the target's depth stays below the hand.
    pub fn pan(&mut self, by_px: Vec2, screen: Vec2) {
        let view = self.view(screen);
        let mm = by_px * self.mm_per_px(screen);
        self.target = (self.target - view.right() * mm.x + view.up * mm.y)
            .clamp(Vec3::splat(-FARTHEST), Vec3::splat(FARTHEST));
    }

    /// Makes everything `by` times as large; what is below the pixel `at` at the target's depth stays there.
    pub fn zoom(&mut self, by: f32, at: Vec2, screen: Vec2) {
        if !(by.is_finite() && by > 0.0) {
            return;
        }
        let below = |camera: &Self| camera.view(screen).at_depth(at, camera.distance);
        let before = below(self);
        self.distance = (self.distance / by).clamp(DISTANCES[0], DISTANCES[1]);
        let moved = below(self) - before;
        self.target = (self.target - moved).clamp(Vec3::splat(-FARTHEST), Vec3::splat(FARTHEST));
    }

    /// Looks from a named side.
    pub fn look_from(&mut self, side: Side) {
        [self.azimuth, self.elevation] = side.angles();
    }

    /// Looks at a box from so far away that all of it shows; an empty box is a hand's breadth around the origin.
    pub fn show(&mut self, what: Aabb) {
        let what = if what.is_empty() || !what.size().is_finite() { EMPTY } else { what };
        let radius = (0.5 * what.size().length()).max(1.0);
        self.target = 0.5 * (what.min + what.max);
        let away = radius / (0.5 * DEGREES).to_radians().sin();
        self.distance = (1.05 * away).clamp(DISTANCES[0], DISTANCES[1]);
    }
}

/// The tangent of half the angle of the view.
fn narrowest() -> f32 {
    (0.5 * DEGREES).to_radians().tan()
}

/// The shorter side of a screen.
fn shorter(screen: Vec2) -> f32 {
    screen.min_element().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2Swizzles as _;

    const SCREEN: Vec2 = Vec2::new(800.0, 600.0);

    #[test]
    fn the_front_view_has_x_to_the_right_and_z_up() {
        let mut camera = Camera::default();
        camera.look_from(Side::Front);
        let view = camera.view(SCREEN);
        assert!(view.right().abs_diff_eq(Vec3::X, 1e-6) && view.up.abs_diff_eq(Vec3::Z, 1e-6));
    }

    #[test]
    fn a_view_from_above_keeps_the_right_on_the_right() {
        let mut camera = Camera::default();
        camera.look_from(Side::Top);
        let view = camera.view(SCREEN);
        assert!(view.right().abs_diff_eq(Vec3::X, 1e-6) && view.up.abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn what_is_below_the_pointer_stays_there_while_zooming() {
        for perspective in [false, true] {
            let mut camera = Camera { perspective, ..Camera::default() };
            let at = Vec2::new(650.0, 120.0);
            let before = camera.view(SCREEN).at_depth(at, camera.distance);
            camera.zoom(1.7, at, SCREEN);
            let after = camera.view(SCREEN).screen_from_model(before).expect("before the eye");
            assert!(after.distance(at) < 0.1, "{after}");
        }
    }

    #[test]
    fn a_drag_takes_the_target_along() {
        let mut camera = Camera::default();
        let target = camera.target;
        camera.pan(Vec2::new(30.0, -50.0), SCREEN);
        let seen = camera.view(SCREEN).screen_from_model(target).expect("before the eye");
        assert!(seen.distance(0.5 * SCREEN + Vec2::new(30.0, -50.0)) < 0.1, "{seen}");
    }

    #[test]
    fn all_of_a_box_shows_from_every_side() {
        let shown = Aabb { min: Vec3::new(-5.0, 10.0, 0.0), max: Vec3::new(60.0, 20.0, 90.0) };
        for (side, screen) in Side::ALL.into_iter().flat_map(|side| [(side, SCREEN), (side, SCREEN.yx())]) {
            let mut camera = Camera::default();
            camera.look_from(side);
            camera.show(shown);
            for corner in shown.corners() {
                let px = camera.view(screen).screen_from_model(corner).expect("before the eye");
                assert!(px.cmpge(Vec2::ZERO).all() && px.cmple(screen).all(), "{side:?}, {screen}: {px}");
            }
        }
    }

    #[test]
    fn nothing_that_a_hand_does_makes_it_blind() {
        let mut camera = Camera::default();
        for by in [0.0, f32::NAN, f32::INFINITY, 1e30, 1e-30, -3.0] {
            camera.zoom(by, Vec2::new(10.0, 10.0), SCREEN);
            camera.orbit(Vec2::new(12345.0, -99999.0), SCREEN);
            camera.pan(Vec2::new(1e6, -1e6), SCREEN);
        }
        let view = camera.view(SCREEN);
        assert!(view.eye.is_finite() && view.forward.is_normalized() && camera.distance >= DISTANCES[0]);
    }
}
