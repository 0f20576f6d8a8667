//! How the graphics card draws: one pipeline for each look of the solid, one for lines.

use modeler::stage::Look;
use std::mem::size_of;

/// The format of the picture. Its shader writes sRGB values itself, as egui wants them.
pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The format of the depth behind it.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What holds for the whole picture; laid out as in the shader.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Uniforms {
    /// From mm to the picture, by columns.
    pub clip_from_world: [[f32; 4]; 4],
    /// The eye, mm, with 1; or the direction towards it, with 0.
    pub eye: [f32; 4],
    /// Where the light comes from, and the sine of the lean from which on it is tinted (above 1: nothing is).
    pub key: [f32; 4],
    /// sRGB.
    pub background: [f32; 4],
    /// The size of the picture, in the first two.
    pub pixels: [f32; 4],
}

/// What is to be drawn, and where.
pub struct Work<'a> {
    /// Where colours go.
    pub color: &'a wgpu::TextureView,
    /// Where several samples become one pixel, if there are several.
    pub resolved: Option<&'a wgpu::TextureView>,
    /// Where depths go.
    pub depth: &'a wgpu::TextureView,
    /// What holds for the whole picture.
    pub uniforms: &'a Uniforms,
    /// Corners of triangles, and how many.
    pub solid: Option<(&'a wgpu::Buffer, u32)>,
    /// How the solid is drawn.
    pub look: Look,
    /// Lines, and how many.
    pub lines: Option<(wgpu::Buffer, u32)>,
}

/// Everything on the card that stays.
pub struct Pipelines {
    /// For each pixel.
    pub samples: u32,
    uniforms: wgpu::Buffer,
    bound: wgpu::BindGroup,
    shaded: wgpu::RenderPipeline,
    stipple: wgpu::RenderPipeline,
    glass: wgpu::RenderPipeline,
    x_ray: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
}

/// How one pipeline differs from the others.
struct Kind {
    vertex: &'static str,
    fragment: &'static str,
    attributes: &'static [wgpu::VertexAttribute],
    stride: u64,
    topology: wgpu::PrimitiveTopology,
    step: wgpu::VertexStepMode,
    /// Whether it mixes with what is behind and hides nothing.
    mixes: bool,
}

const CORNER: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];
const LINE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32];

/// The size of a line in its buffer: both ends, the colour and the width in pixels.
pub const LINE_BYTES: usize = 32;

impl Pipelines {
    /// Makes them.
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        let shader = device.create_shader_module(wgpu::include_wgsl!("model.wgsl"));
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        let solid = |fragment, mixes| Kind {
            vertex: "solid",
            fragment,
            attributes: &CORNER,
            stride: 28,
            topology: wgpu::PrimitiveTopology::TriangleList,
            step: wgpu::VertexStepMode::Vertex,
            mixes,
        };
        let lines = Kind {
            vertex: "line",
            fragment: "ink",
            attributes: &LINE,
            stride: LINE_BYTES as u64,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            step: wgpu::VertexStepMode::Instance,
            mixes: true,
        };
        let make = |kind: &Kind| pipeline(device, &shader, &layout, samples, kind);
        Self {
            samples,
            uniforms,
            bound,
            shaded: make(&solid("shaded", false)),
            stipple: make(&solid("stipple", false)),
            glass: make(&solid("glass", true)),
            x_ray: make(&solid("x_ray", true)),
            lines: make(&lines),
        }
    }

    /// Draws.
    pub fn draw(&self, device: &wgpu::Device, queue: &wgpu::Queue, work: &Work) {
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(work.uniforms));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let [r, g, b, a] = work.uniforms.background.map(f64::from);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("model"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: work.color,
                depth_slice: None,
                resolve_target: work.resolved,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: work.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_bind_group(0, &self.bound, &[]);
        let mut one = |pipeline: &wgpu::RenderPipeline, buffer: &wgpu::Buffer, corners, instances| {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..corners, 0..instances);
        };
        let (look, mixes) = match work.look {
            Look::Shaded => (&self.shaded, false),
            Look::Stipple => (&self.stipple, false),
            Look::Glass => (&self.glass, true),
            Look::XRay => (&self.x_ray, true),
        };
        // What hides comes before lines, what mixes after them.
        if let Some((buffer, count)) = work.solid.filter(|_| !mixes) {
            one(look, buffer, count, 1);
        }
        if let Some((buffer, count)) = &work.lines {
            // Each line is a strip of two triangles.
            one(&self.lines, buffer, 4, *count);
        }
        if let Some((buffer, count)) = work.solid.filter(|_| mixes) {
            one(look, buffer, count, 1);
        }
        drop(pass);
        queue.submit([encoder.finish()]);
    }
}

fn pipeline(
    device: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    bound: &wgpu::BindGroupLayout,
    samples: u32,
    kind: &Kind,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(bound)],
        immediate_size: 0,
    });
    let buffer = wgpu::VertexBufferLayout {
        array_stride: kind.stride,
        step_mode: kind.step,
        attributes: kind.attributes,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.fragment),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(kind.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(buffer)],
        },
        primitive: wgpu::PrimitiveState { topology: kind.topology, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(!kind.mixes),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(kind.fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR,
                blend: kind.mixes.then_some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::COLOR,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
