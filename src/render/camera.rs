//! From where a picture is taken: parallel projection, camera space and back.
//!
//! Camera space is in mm, with x to the right of the picture, y up, and z towards the viewer.

use blobtree::AffineMap;
use glam::{Mat3, Vec3};

/// A direction to look from, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Around the vertical from the front, counter-clockwise seen from above: a quarter turn is the right.
    azimuth: f32,
    /// Above the horizontal.
    elevation: f32,
}

impl View {
    /// Names and their degrees.
    const NAMED: [(&'static str, [f32; 2]); 7] = [
        ("iso", [35.0, 27.0]),
        ("front", [0.0, 0.0]),
        ("right", [90.0, 0.0]),
        ("back", [180.0, 0.0]),
        ("left", [-90.0, 0.0]),
        ("top", [0.0, 90.0]),
        ("bottom", [0.0, -90.0]),
    ];

    /// From the front, the right and below: 35° around and 30° up.
    pub const FROM_BELOW: Self = Self { azimuth: 0.611, elevation: -0.524 };

    /// From degrees.
    pub fn from_degrees(azimuth: f32, elevation: f32) -> Self {
        Self { azimuth: azimuth.to_radians(), elevation: elevation.to_radians() }
    }

    /// A name, or azimuth and elevation in degrees with a comma between.
    ///
    /// Errors: anything else, in words for the user.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = "a view is iso, front, back, left, right, top, bottom, or AZIMUTH,ELEVATION in degrees, \
                     from -360 to 360 and -90 to 90";
        if let Some((_, [azimuth, elevation])) = Self::NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(Self::from_degrees(*azimuth, *elevation));
        }
        let numbers =
            text.split_once(',').and_then(|(a, e)| Some((a.trim().parse().ok()?, e.trim().parse().ok()?)));
        match numbers {
            Some((a, e)) if (-360.0..=360.0).contains(&a) && (-90.0..=90.0).contains(&e) => {
                Ok(Self::from_degrees(a, e))
            }
            _ => Err(wrong.into()),
        }
    }
}

/// A camera without perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Rows are the camera's axes in the world.
    camera_from_world: Mat3,
    /// The world's origin in camera space, mm.
    origin: Vec3,
}

impl Camera {
    /// A camera that looks from `view` and has `center` (world, mm) at its own origin.
    pub fn new(view: View, center: Vec3) -> Self {
        let ((sa, ca), (se, ce)) = (view.azimuth.sin_cos(), view.elevation.sin_cos());
        Self::along(Vec3::new(sa * ce, -ca * ce, se), Vec3::new(ca, sa, 0.0), center)
    }

    /// A camera in the direction `towards` (a unit vector) from `center`.
    pub fn looking_from(towards: Vec3, center: Vec3) -> Self {
        let right = Vec3::new(-towards.y, towards.x, 0.0).try_normalize().unwrap_or(Vec3::X);
        Self::along(towards, right, center)
    }

    fn along(back: Vec3, right: Vec3, center: Vec3) -> Self {
        let camera_from_world = Mat3::from_cols(right, back.cross(right), back).transpose();
        Self { camera_from_world, origin: -(camera_from_world * center) }
    }

    /// The camera moved within its own space so that `center` there becomes the origin.
    pub fn recentred(&self, center: Vec3) -> Self {
        Self { origin: self.origin - center, ..*self }
    }

    /// A point in camera space.
    pub fn point_from_world(&self, p: Vec3) -> Vec3 {
        self.camera_from_world * p + self.origin
    }

    /// A point in the world.
    pub fn world_from_point(&self, p: Vec3) -> Vec3 {
        self.camera_from_world.transpose() * (p - self.origin)
    }

    /// A direction in the world.
    pub fn world_from_direction(&self, d: Vec3) -> Vec3 {
        self.camera_from_world.transpose() * d
    }

    /// A direction in camera space.
    pub fn direction_from_world(&self, d: Vec3) -> Vec3 {
        self.camera_from_world * d
    }

    /// The same as a map for the tree.
    pub fn affine_map(&self) -> AffineMap {
        let row = |i: usize| {
            let r = self.camera_from_world.row(i);
            [r.x, r.y, r.z, self.origin[i]]
        };
        AffineMap { rows: [row(0), row(1), row(2)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_view_has_x_to_the_right_and_z_up_and_sees_the_front() {
        let camera = Camera::new(View::from_degrees(0.0, 0.0), Vec3::ZERO);
        let seen = camera.point_from_world(Vec3::new(1.0, -3.0, 2.0));
        assert!(seen.abs_diff_eq(Vec3::new(1.0, 2.0, 3.0), 1e-6), "{seen}");
    }

    #[test]
    fn the_right_view_looks_along_minus_x_and_the_top_view_down() {
        let right = Camera::new(View::from_degrees(90.0, 0.0), Vec3::ZERO);
        assert!(right.point_from_world(Vec3::X).abs_diff_eq(Vec3::Z, 1e-6));
        assert!(right.point_from_world(Vec3::Y).abs_diff_eq(Vec3::X, 1e-6));
        let top = Camera::new(View::from_degrees(0.0, 90.0), Vec3::ZERO);
        assert!(top.point_from_world(Vec3::Z).abs_diff_eq(Vec3::Z, 1e-6));
        assert!(top.point_from_world(Vec3::Y).abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn camera_space_and_back_is_where_it_began() {
        let camera = Camera::new(View::from_degrees(33.0, 21.0), Vec3::new(5.0, 6.0, 7.0));
        let p = Vec3::new(1.0, -2.0, 30.0);
        assert!(camera.world_from_point(camera.point_from_world(p)).abs_diff_eq(p, 1e-4));
        let map = camera.affine_map().parent_from_child();
        assert!(map.transform_point3(p).abs_diff_eq(camera.point_from_world(p), 1e-4));
    }

    #[test]
    fn views_are_names_or_angles() {
        assert_eq!(View::parse("left"), View::parse("-90,0"));
        assert_eq!(View::parse("10, -5.5"), Ok(View::from_degrees(10.0, -5.5)));
        for wrong in ["", "up", "1", "nan,0", "0,91", "1,2,3"] {
            assert!(View::parse(wrong).is_err(), "{wrong}");
        }
    }
}
