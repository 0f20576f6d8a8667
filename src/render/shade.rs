//! From samples to colours: three lights, a soft shadow, darker corners, and a ground to stand on.
//!
//! Lights hang on the camera, so that a shape is lit alike from all sides. Computed in linear light.

use super::buffer::{Buffer, Kind, RAYS, Relief, Sample};
use super::camera::Camera;
use blobtree::Color;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Where the key light comes from, camera space: from the upper left, before the shape.
pub const KEY_FROM: Vec3 = Vec3::new(-0.47, 0.66, 0.59);
const KEY: Vec3 = Vec3::new(0.86, 0.82, 0.76);
/// A weak cool light from the right brightens what the key light leaves dark.
const FILL_FROM: Vec3 = Vec3::new(0.80, 0.10, 0.59);
const FILL: Vec3 = Vec3::new(0.13, 0.15, 0.19);
/// Light from above and from below, all around.
const SKY: Vec3 = Vec3::new(0.38, 0.41, 0.46);
const FLOOR: Vec3 = Vec3::new(0.20, 0.185, 0.17);
/// The brightest of the highlights and of the rims.
const GLOSS: f32 = 0.10;
const RIM: f32 = 0.10;
/// The colour of a surface from behind.
const INSIDE: [u8; 3] = [196, 92, 74];
/// How dark the shadow on the ground is, and how dark its corners.
const GROUND_SHADOW: f32 = 0.34;
const GROUND_CORNERS: f32 = 0.55;

/// Directions and steps in which dark corners are looked for.
const DIRECTIONS: usize = 4;
const STEPS: [f32; 5] = [0.06, 0.16, 0.32, 0.58, 1.0];
/// How far corners are looked for, as a share of the shape's size.
const REACH: f32 = 0.16;
/// Rays into the shadow map for each sample.
const TAPS: usize = 8;

/// Everything that a picture is made of.
pub struct Stage<'a> {
    /// What the camera sees, with the ground in it.
    pub seen: &'a Buffer,
    /// From where.
    pub camera: Camera,
    /// What the key light sees.
    pub lit: &'a Buffer,
    /// From where.
    pub light: Camera,
    /// The shape's longest side, mm.
    pub size: f32,
    /// The ground's grid: its spacing and middle, mm; none for a ground without one.
    pub grid: Option<(f32, Vec3)>,
    /// Behind everything; a soft gradient if none.
    pub background: Option<Color>,
}

/// A stage with what is the same for all its rays.
struct Prepared<'a> {
    stage: &'a Stage<'a>,
    /// Depths that the camera sees, one for each pixel, and those that the light sees.
    seen: Relief,
    lit: Relief,
    /// Columns and rows out of which no ray is near the shape: left, top, right, bottom.
    near: [f32; 4],
    /// Linear light of every sRGB value.
    linear: [f32; 256],
    /// For each ray of a pixel: directions in which corners are looked for, and places around a shadow's.
    turns: [([Vec2; DIRECTIONS], [Vec2; TAPS]); RAYS * RAYS],
}

impl Stage<'_> {
    /// The picture: red, green and blue of every pixel, row by row.
    pub fn pixels(&self) -> Vec<u8> {
        let prepared = Prepared::new(self);
        let frame = self.seen.frame;
        let (width, height) = (frame.columns / RAYS, frame.rows / RAYS);
        let mut pixels = vec![0; 3 * width * height];
        pixels.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
            let behind = self.behind(y as f32 / height as f32);
            for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                let rays = (0..RAYS * RAYS).map(|ray| prepared.color(x, y, ray, behind));
                let mean = rays.sum::<Vec3>() / (RAYS * RAYS) as f32;
                pixel.copy_from_slice(&mean.to_array().map(|c| (255.0 * srgb_from_linear(c)).round() as u8));
            }
        });
        pixels
    }

    /// The background at this share of the way down.
    fn behind(&self, down: f32) -> Vec3 {
        let (top, bottom) = match self.background {
            Some(Color(flat)) => (flat, flat),
            None => ([243, 245, 248], [205, 210, 217]),
        };
        let light = |c: [u8; 3]| Vec3::from_array(c.map(linear));
        light(top).lerp(light(bottom), down)
    }

    /// The columns and rows around the shape.
    fn near(&self) -> [f32; 4] {
        let frame = self.seen.frame;
        let lines = self.seen.samples.par_chunks(frame.columns).enumerate();
        let boxes = lines.filter_map(|(row, line)| {
            let is_shape = |s: &Sample| matches!(s.kind, Kind::Surface | Kind::Inside);
            let (left, right) = (line.iter().position(is_shape)?, line.iter().rposition(is_shape)?);
            Some([left as f32, row as f32, right as f32, row as f32])
        });
        let join =
            |a: [f32; 4], b: [f32; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
        let [left, top, right, bottom] = boxes.reduce(|| [f32::MAX, f32::MAX, 0.0, 0.0], join);
        let reach = REACH * self.size / frame.pitch;
        [left - reach, top - reach, right + reach, bottom + reach]
    }
}

impl<'a> Prepared<'a> {
    fn new(stage: &'a Stage<'a>) -> Self {
        let turns = [0.0, 0.5, 0.75, 0.25].map(|jitter| {
            let turn = |i: usize| Vec2::from_angle(TAU * (i as f32 + jitter) / DIRECTIONS as f32);
            // Places spread evenly over a disc: each a golden angle on.
            let tap = |i: usize| {
                Vec2::from_angle(i as f32 * 2.399_963 + TAU * jitter)
                    * ((i as f32 + 0.5) / TAPS as f32).sqrt()
            };
            (std::array::from_fn(turn), std::array::from_fn(tap))
        });
        let (seen, lit) = (stage.seen.relief(RAYS), stage.lit.relief(1));
        Self { stage, seen, lit, near: stage.near(), linear: std::array::from_fn(|c| linear(c as u8)), turns }
    }

    /// The light of one ray of a pixel.
    fn color(&self, x: usize, y: usize, ray: usize, behind: Vec3) -> Vec3 {
        let (column, row) = (x * RAYS + ray % RAYS, y * RAYS + ray / RAYS);
        let frame = self.stage.seen.frame;
        let sample = &self.stage.seen.samples[row * frame.columns + column];
        let spot = Spot {
            at: Vec2::new(column as f32, row as f32),
            place: frame.point(column, row, sample.depth),
            normal: sample.normal(),
            ray,
        };
        match sample.kind {
            Kind::Nothing => behind,
            Kind::Ground => behind * self.on_ground(&spot),
            Kind::Surface => self.on_surface(&spot, sample.color),
            Kind::Inside => self.on_surface(&spot, INSIDE),
        }
    }

    fn on_surface(&self, spot: &Spot, color: [u8; 3]) -> Vec3 {
        let normal = spot.normal;
        let key = KEY_FROM.normalize_or_zero();
        let facing = normal.dot(key).max(0.0);
        let shine = if facing > 0.0 { self.lit_share(spot) } else { 0.0 };
        let open = 1.0 - 0.8 * self.corner(spot);
        let up = self.stage.camera.world_from_direction(normal).z.mul_add(0.5, 0.5);
        let around = FLOOR.lerp(SKY, up) * open;
        let fill = FILL * normal.dot(FILL_FROM.normalize_or_zero()).max(0.0) * open;
        let half = (key + Vec3::Z).normalize_or_zero();
        let gloss = GLOSS * normal.dot(half).max(0.0).powi(40) * shine;
        let rim = RIM * (1.0 - normal.z.max(0.0)).powi(3) * up * open;
        let albedo = Vec3::from_array(color.map(|c| self.linear[usize::from(c)]));
        shoulder(albedo * (KEY * facing * shine + around + fill) + gloss + rim)
    }

    /// How much of the background's light the ground gives back.
    fn on_ground(&self, spot: &Spot) -> f32 {
        let shade = GROUND_SHADOW * (1.0 - self.lit_share(spot));
        let corner = GROUND_CORNERS * self.corner(spot);
        let line = self.grid_line(self.stage.camera.world_from_point(spot.place));
        (1.0 - shade) * (1.0 - corner) * (1.0 - line)
    }

    /// How dark the grid makes the ground at this place of the world.
    fn grid_line(&self, p: Vec3) -> f32 {
        let Some((spacing, middle)) = self.stage.grid else { return 0.0 };
        let away = (p - middle).truncate().length() / self.stage.size;
        let width = (1.1 * RAYS as f32 * self.stage.seen.frame.pitch / spacing).min(0.2);
        let on_line = p.truncate() / spacing;
        let off = (on_line - on_line.round()).abs();
        let line = if off.min_element() < 0.5 * width { 0.2 } else { 0.0 };
        line * (1.0 - away / 1.5).clamp(0.0, 1.0).powi(2)
    }

    /// How much of the key light reaches a place, from 0 to 1. Shadows are the softer the farther away what
    /// throws them.
    ///
    /// **Source:** Fernando 2005, *Percentage-Closer Soft Shadows*.
    fn lit_share(&self, spot: &Spot) -> f32 {
        let Stage { lit, light, camera, size, .. } = self.stage;
        let frame = lit.frame;
        let lifted = spot.place + spot.normal * (2.0 * frame.pitch);
        let p = light.point_from_world(camera.world_from_point(lifted));
        let middle = Vec2::from_array(frame.place_of(p));
        let widest = 0.06 * size / frame.pitch;
        let (width, height) = (frame.columns as f32 + widest, frame.rows as f32 + widest);
        if middle.min_element() < -widest || middle.x > width || middle.y > height {
            return 1.0;
        }
        let taps = |radius: f32| self.turns[spot.ray].1.iter().map(move |tap| middle + tap * radius);
        let above = |at: Vec2| {
            let higher = self.lit.nearest(at).2 - p.z;
            (higher > 2.0 * frame.pitch).then_some(higher)
        };
        let (mut found, mut distance) = (0, 0.0);
        for higher in taps(widest).filter_map(above) {
            found += 1;
            distance += higher;
        }
        if found == 0 {
            return 1.0;
        }
        let radius = (0.10 * distance / found as f32 / frame.pitch).clamp(1.5, widest);
        1.0 - taps(radius).filter_map(above).count() as f32 / TAPS as f32
    }

    /// How much of the light from all around the neighbourhood keeps away, from 0 to 1: how high it stands
    /// above the surface, in several directions.
    fn corner(&self, spot: &Spot) -> f32 {
        let [left, top, right, bottom] = self.near;
        if !(left..=right).contains(&spot.at.x) || !(top..=bottom).contains(&spot.at.y) {
            return 0.0;
        }
        let frame = self.stage.seen.frame;
        let reach = REACH * self.stage.size;
        let mut hidden = 0.0;
        for turn in self.turns[spot.ray].0 {
            let mut most = 0.0f32;
            for step in STEPS {
                let at = spot.at + turn * (step * reach / frame.pitch);
                if at.min_element() < 0.0 || at.x >= frame.columns as f32 || at.y >= frame.rows as f32 {
                    break;
                }
                let (x, y, depth) = self.seen.nearest(at / RAYS as f32);
                let towards = frame.point(x * RAYS, y * RAYS, depth) - spot.place;
                let squared = towards.length_squared();
                let near = 1.0 - squared / (1.6 * reach).powi(2);
                if near > 0.0 && squared > 0.0 {
                    most = most.max((spot.normal.dot(towards) / squared.sqrt() - 0.12) * near);
                }
            }
            hidden += most;
        }
        hidden / DIRECTIONS as f32
    }
}

/// What a ray met, ready for light.
struct Spot {
    /// Its column and row.
    at: Vec2,
    /// In camera space, mm.
    place: Vec3,
    normal: Vec3,
    /// Which of its pixel's rays it is.
    ray: usize,
}

/// Lets bright light run out softly below 1.
fn shoulder(c: Vec3) -> Vec3 {
    c.map(|c| c / (1.0 + c.powi(6)).powf(1.0 / 6.0))
}

fn linear(srgb: u8) -> f32 {
    let c = f32::from(srgb) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

fn srgb_from_linear(c: f32) -> f32 {
    let c = c.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_survives_the_way_to_linear_light_and_back() {
        for c in 0..=255u8 {
            assert_eq!((255.0 * srgb_from_linear(linear(c))).round(), f32::from(c));
        }
    }
}
