//! The graphics card: draws pictures of the model into a texture, which the view shows.

use super::pipelines::{COLOR, DEPTH, LINE_BYTES, Pipelines, Uniforms};
use eframe::egui::TextureId;
use egui_wgpu::RenderState;
use glam::{Mat4, Vec3, Vec4};
use modeler::solid::Solid;
use modeler::stage::{Look, Picture, Stage};
use sketch::suggest::{Projection, View};
use std::sync::Arc;

/// A graphics card with a picture.
pub struct Card {
    state: RenderState,
    pipelines: Pipelines,
    target: Option<Target>,
    /// The solid on the card, and how many corners it has.
    solid: Option<(Arc<Solid>, wgpu::Buffer, u32)>,
    /// What was drawn last.
    drawn: Option<Key>,
}

/// The textures of a picture.
struct Target {
    pixels: [u32; 2],
    /// What is drawn on, with several samples for each pixel on cards that are quick at it.
    samples: wgpu::TextureView,
    /// What is shown, where that is another one.
    resolved: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    id: TextureId,
}

/// All that makes one picture differ from another.
#[derive(Clone, PartialEq)]
struct Key {
    uniforms: Vec<u8>,
    pixels: [u32; 2],
    solid: Option<(u64, bool)>,
    look: Look,
    lines: Vec<u8>,
}

impl Card {
    /// Prepares a card.
    pub fn new(state: RenderState) -> Self {
        // A processor that plays a graphics card has better things to do than to smooth edges.
        let quick = state.adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        let pipelines = Pipelines::new(&state.device, if quick { 4 } else { 1 });
        Self { state, pipelines, target: None, solid: None, drawn: None }
    }

    fn fit(&mut self, pixels: [u32; 2]) {
        if self.target.as_ref().is_some_and(|target| target.pixels == pixels) {
            return;
        }
        let (device, samples) = (&self.state.device, self.pipelines.samples);
        let shown = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let color = texture(device, pixels, COLOR, 1, shown);
        let many = (samples > 1)
            .then(|| texture(device, pixels, COLOR, samples, wgpu::TextureUsages::RENDER_ATTACHMENT));
        let depth = texture(device, pixels, DEPTH, samples, wgpu::TextureUsages::RENDER_ATTACHMENT);
        let mut renderer = self.state.renderer.write();
        let id = match self.target.take() {
            Some(old) => {
                renderer.update_egui_texture_from_wgpu_texture(
                    device,
                    &color,
                    wgpu::FilterMode::Nearest,
                    old.id,
                );
                old.id
            }
            None => renderer.register_native_texture(device, &color, wgpu::FilterMode::Nearest),
        };
        drop(renderer);
        let (samples, resolved) = match many {
            Some(many) => (many, Some(color)),
            None => (color, None),
        };
        self.target = Some(Target { pixels, samples, resolved, depth, id });
        self.drawn = None;
    }

    /// Brings the solid to the card, unless it is there.
    fn load(&mut self, solid: Option<&Arc<Solid>>) {
        let Some(solid) = solid.filter(|solid| !solid.corners.is_empty()) else {
            self.solid = None;
            return;
        };
        if self.solid.as_ref().is_some_and(|(known, ..)| Arc::ptr_eq(known, solid)) {
            return;
        }
        let bytes: Vec<u8> = corner_bytes(solid);
        self.solid = buffer(&self.state.device, &self.state.queue, &bytes)
            .map(|buffer| (solid.clone(), buffer, solid.corners.len() as u32));
    }
}

/// The corners as the card takes them: 28 bytes each.
fn corner_bytes(solid: &Solid) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(28 * solid.corners.len());
    for corner in &solid.corners {
        bytes.extend_from_slice(bytemuck::cast_slice(&corner.position));
        bytes.extend_from_slice(bytemuck::cast_slice(&corner.normal));
        bytes.extend_from_slice(&corner.color);
    }
    bytes
}

/// The lines as the card takes them: 32 bytes each, with widths in pixels.
fn line_bytes(picture: &Picture) -> Vec<u8> {
    let scale = picture.pixels[0] as f32 / picture.view.screen.x.max(1.0);
    let mut bytes = Vec::with_capacity(LINE_BYTES * picture.lines.len());
    for line in picture.lines {
        for end in line.ends {
            bytes.extend_from_slice(bytemuck::cast_slice(&end.to_array()));
        }
        bytes.extend_from_slice(&line.color);
        bytes.extend_from_slice(bytemuck::bytes_of(&(line.width * scale).max(1.0)));
    }
    bytes
}

/// A buffer of vertices; none if the card takes none as large.
fn buffer(device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> Option<wgpu::Buffer> {
    let size = (bytes.len() as u64).next_multiple_of(4);
    if size > device.limits().max_buffer_size {
        return None;
    }
    let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
    let buffer =
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    queue.write_buffer(&buffer, 0, bytes);
    Some(buffer)
}

fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    samples: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// From places to the picture: x and y from −1 to 1, depth from 0 (near) to 1.
fn clip_from_world(view: &View) -> Mat4 {
    let (right, back) = (view.right(), -view.forward);
    let axes = Mat4::from_cols(right.extend(0.0), view.up.extend(0.0), back.extend(0.0), Vec4::W).transpose();
    let eye_from_world = axes * Mat4::from_translation(-view.eye);
    let aspect = view.screen.x / view.screen.y.max(1.0);
    let clip_from_eye = match view.projection {
        Projection::Perspective { height_degrees } => {
            let near = (0.002 * view.eye.length()).max(0.5);
            let far = 20_000.0 * near;
            let f = 1.0 / (0.5 * height_degrees).to_radians().tan();
            let (a, b) = (far / (near - far), near * far / (near - far));
            Mat4::from_cols(
                Vec4::new(f / aspect, 0.0, 0.0, 0.0),
                Vec4::new(0.0, f, 0.0, 0.0),
                Vec4::new(0.0, 0.0, a, -1.0),
                Vec4::new(0.0, 0.0, b, 0.0),
            )
        }
        Projection::Orthographic { mm_per_px } => {
            let half = 0.5 * mm_per_px * view.screen;
            let (near, far) = (-20.0 * view.eye.length() - 1000.0, 20.0 * view.eye.length() + 1000.0);
            let depth = 1.0 / (near - far);
            Mat4::from_cols(
                Vec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
                Vec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
                Vec4::new(0.0, 0.0, depth, 0.0),
                Vec4::new(0.0, 0.0, near * depth, 1.0),
            )
        }
    };
    clip_from_eye * eye_from_world
}

fn uniforms(picture: &Picture) -> Uniforms {
    let view = &picture.view;
    let toward_eye = match view.projection {
        Projection::Perspective { .. } => view.eye.extend(1.0),
        Projection::Orthographic { .. } => (-view.forward).extend(0.0),
    };
    let key = (-view.forward + 0.9 * view.up - 0.6 * view.right()).normalize_or(Vec3::Z);
    let lean = picture.overhang.map_or(2.0, |degrees| degrees.to_radians().sin());
    let [r, g, b] = picture.background.map(|c| f32::from(c) / 255.0);
    Uniforms {
        clip_from_world: clip_from_world(view).to_cols_array_2d(),
        eye: toward_eye.to_array(),
        key: key.extend(lean).to_array(),
        background: [r, g, b, 1.0],
        pixels: [picture.pixels[0] as f32, picture.pixels[1] as f32, 0.0, 0.0],
    }
}

impl Stage for Card {
    fn show(&mut self, picture: &Picture) -> Option<TextureId> {
        self.fit(picture.pixels);
        self.load(picture.solid);
        let uniforms = uniforms(picture);
        let lines = line_bytes(picture);
        let key = Key {
            uniforms: bytemuck::bytes_of(&uniforms).to_vec(),
            pixels: picture.pixels,
            solid: picture.solid.map(|solid| (solid.version, solid.is_fine)),
            look: picture.look,
            lines,
        };
        let target = self.target.as_ref()?;
        if self.drawn.as_ref() != Some(&key) {
            let solid = self.solid.as_ref().map(|(_, buffer, corners)| (buffer, *corners));
            self.pipelines.draw(
                &self.state.device,
                &self.state.queue,
                &super::pipelines::Work {
                    color: &target.samples,
                    resolved: target.resolved.as_ref(),
                    depth: &target.depth,
                    uniforms: &uniforms,
                    solid,
                    look: picture.look,
                    lines: buffer(&self.state.device, &self.state.queue, &key.lines)
                        .filter(|_| !key.lines.is_empty())
                        .map(|buffer| (buffer, picture.lines.len() as u32)),
                },
            );
            self.drawn = Some(key);
        }
        Some(target.id)
    }
}
