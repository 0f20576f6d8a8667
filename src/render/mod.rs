//! Pictures with no GPU and no display: rays against the field, or triangles, then light.
//!
//! Reach for [`picture`]. The same input gives the same bytes for any number of threads.

mod buffer;
mod camera;
mod cast;
mod paint;
mod raster;
mod shade;

pub use camera::View;

use crate::failure::Failure;
use crate::job::{Job, Watch};
use blobtree::{Aabb, BakeStore, Color, Node, NodeRef, Palette, STONE, Shape, Warp, solid_box};
use buffer::{Buffer, Frame, Kind, RAYS, Sample};
use camera::Camera;
use glam::Vec3;
use mesh::Mesh;
use paint::Paint;
use raster::Shaded;
use shade::{KEY_FROM, Stage};
use std::sync::Arc;

/// The share of the picture that the shape fills in the direction in which it is larger.
const FILLED: f32 = 0.76;
/// Rays along each side of the light's own picture.
const LIGHT_RAYS: usize = 640;
/// From lower than this, the sine of 6°, the ground would be a sliver.
const LOWEST_VIEW: f32 = 0.1;
/// Bytes of a PNG file that have no bearing on its pixels: no more than that.
const PNG_OVERHEAD: usize = 4096;

/// What is drawn.
pub enum Subject<'a> {
    /// A scene, by its tree and what its support-free nodes are baked to.
    Scene(&'a NodeRef, &'a BakeStore),
    /// A mesh whose indices all exist.
    Mesh(&'a Mesh),
    /// Such a mesh tinted by its overhangs, with the largest that prints, radians from the vertical.
    Overhangs(&'a Mesh, f32),
}

/// How it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// From where.
    pub view: View,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Behind everything; a soft gradient if none.
    pub background: Option<Color>,
}

/// Draws a picture: red, green and blue of every pixel, row by row from the top. None if there is nothing to see.
/// Stages "prepare", "look", "light" and "shade".
///
/// Errors: [`Failure::Interrupted`], and a shape too far from the origin or too thin to be drawn.
pub fn picture(subject: &Subject, settings: &Settings, job: &mut Job) -> Result<Option<Vec<u8>>, Failure> {
    let (subject, world) = job.stage("prepare", |_| {
        let subject = Prepared::new(subject);
        let world = subject.bounds(None);
        Ok((subject, world))
    })?;
    if world.is_empty() {
        return Ok(None);
    }
    let camera = Camera::new(settings.view, world.center());
    let (camera, mut seen) = job.stage("look", |watch| {
        let (camera, frame) =
            framed(&subject, camera, settings.size.map(|side| side as usize * RAYS), FILLED);
        Ok((camera, subject.draw(&camera, frame, watch)?))
    })?;
    let (light, lit) = job.stage("light", |watch| {
        let from = camera.world_from_direction(KEY_FROM.normalize_or_zero());
        let light = Camera::looking_from(from, world.center());
        let (light, frame) = framed(&subject, light, [LIGHT_RAYS; 2], 0.98);
        Ok((light, subject.draw(&light, frame, watch)?))
    })?;
    let pixels = job.stage("shade", |_| {
        let ground = Ground::under(&world);
        ground.show(&camera, &mut seen);
        let size = world.size().max_element();
        let grid = ground.is_bed.then(|| (grid_spacing(size), world.center()));
        let background = settings.background;
        Ok(Stage { seen: &seen, camera, lit: &lit, light, size, grid, background }.pixels())
    })?;
    Ok(Some(pixels))
}

/// The bytes of a PNG file.
pub fn png(pixels: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::with_capacity(pixels.len() / 8 + PNG_OVERHEAD);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// A subject with what every picture of it needs.
enum Prepared<'a> {
    Scene(&'a NodeRef, &'a BakeStore),
    Mesh(Shaded<'a>, &'a Mesh, Paint),
}

impl<'a> Prepared<'a> {
    fn new(subject: &Subject<'a>) -> Self {
        match subject {
            Subject::Scene(root, bakes) => Self::Scene(root, bakes),
            Subject::Mesh(mesh) => Self::Mesh(Shaded::new(mesh), mesh, Paint::Plain(STONE.0)),
            Subject::Overhangs(mesh, limit) => {
                let paint = Paint::Overhangs { limit: *limit, bed: mesh.bounds().min.z };
                Self::Mesh(Shaded::new(mesh), mesh, paint)
            }
        }
    }

    /// The box of the solid, in the space of a camera or in the world.
    fn bounds(&self, camera: Option<&Camera>) -> Aabb {
        match self {
            Self::Scene(root, bakes) => solid_box(&bakes.compile(&seen_by(root, camera))),
            Self::Mesh(_, mesh, _) => {
                let used = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
                match camera {
                    Some(camera) => Aabb::of_points(used.map(|p| camera.point_from_world(p))),
                    None => Aabb::of_points(used),
                }
            }
        }
    }

    fn draw(&self, camera: &Camera, frame: Frame, watch: &Watch) -> Result<Buffer, Failure> {
        match self {
            Self::Scene(root, bakes) => {
                let root = seen_by(root, Some(camera));
                let tree = bakes.compile(&root);
                let solid = solid_box(&tree);
                if solid.size().max_element() / frame.pitch > cast::MOST_STEPS {
                    return Err(Failure::Input(
                        "the shape is too long and thin to be drawn from here".into(),
                    ));
                }
                cast::cast(&tree, solid, &Palette::new(&root, bakes), frame, watch)
            }
            Self::Mesh(shaded, _, paint) => shaded.draw(camera, *paint, frame, watch),
        }
    }
}

/// The tree in the space of a camera.
fn seen_by(root: &NodeRef, camera: Option<&Camera>) -> NodeRef {
    match camera {
        Some(camera) => {
            let warp = Warp::Affine(camera.affine_map());
            Arc::new(Node::new(Shape::Warp(warp, root.clone())))
        }
        None => root.clone(),
    }
}

/// The camera moved so that the shape is in the middle of its picture and fills `filled` of it.
fn framed(subject: &Prepared, camera: Camera, [columns, rows]: [usize; 2], filled: f32) -> (Camera, Frame) {
    let bounds = subject.bounds(Some(&camera));
    let size = bounds.size();
    let pitch = (size.x / columns as f32).max(size.y / rows as f32) / filled;
    // A shape seen as a single point still needs a picture of some size.
    let pitch = if pitch > 0.0 { pitch } else { 1.0 };
    (camera.recentred(bounds.center()), Frame { columns, rows, pitch })
}

/// The plane that a shape stands on.
struct Ground {
    height: f32,
    /// Whether it is the printer's bed.
    is_bed: bool,
}

impl Ground {
    /// The bed, if the shape is on or above it; else a plane under the shape.
    fn under(world: &Aabb) -> Self {
        let size = world.size().max_element();
        let is_bed = world.min.z > -0.01 * size && world.min.z < 2.0 * size;
        Self { height: if is_bed { world.min.z.min(0.0) } else { world.min.z }, is_bed }
    }

    /// Puts the ground behind the shape, where the camera sees it from above.
    fn show(&self, camera: &Camera, seen: &mut Buffer) {
        let up = camera.direction_from_world(Vec3::Z);
        if up.z < LOWEST_VIEW {
            return;
        }
        let on = camera.point_from_world(Vec3::new(0.0, 0.0, self.height));
        let frame = seen.frame;
        for (index, sample) in seen.samples.iter_mut().enumerate().filter(|(_, s)| s.kind == Kind::Nothing) {
            let ray = frame.point(index % frame.columns, index / frame.columns, 0.0);
            let depth = (on - ray).dot(up) / up.z;
            *sample = Sample::new(depth, up, [0; 3], Kind::Ground);
        }
    }
}

/// The power of ten that gives a shape of this size, mm, between 3 and 30 lines.
fn grid_spacing(size: f32) -> f32 {
    10f32.powi((size / 3.0).log10().floor().clamp(-4.0, 6.0) as i32)
}
