//! Pictures of the main screens, light and dark, compared with those in `tests/snapshots`.
//!
//! `TRULLO_UPDATE_SNAPSHOTS=1 cargo test --bin trullo snapshots` writes them anew. What differs is written beside the
//! picture, as `NAME.new.png`. Without any graphics driver, not even one played by the processor, nothing is compared.

use super::desk::Files;
use super::stage::Card;
use blobtree::NodePath;
use blobtree::build::{point, union};
use eframe::egui::{self, Pos2, TexturesDelta, Theme, vec2};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, TestRenderer};
use egui_wgpu::{RenderState, RendererOptions, ScreenDescriptor, WgpuConfiguration, WgpuSetup};
use glam::{Vec2, Vec3};
use modeler::Modeler;
use modeler::camera::Side;
use modeler::dialog::Dialog;
use modeler::settings::Tool;
use modeler::stage::Look;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Points, and pixels.
const SIZE: egui::Vec2 = vec2(1000.0, 640.0);

/// As small as a window may be: what is shown of a small screen whose things are twice as large.
const SMALL: egui::Vec2 = vec2(500.0, 400.0);

/// Pixels that differ by more than this in a channel are different.
const FAINT: u8 = 24;

/// The share of pixels that may be different: fonts and edges come out a little different with each driver.
const TOLERATED: f64 = 0.005;

/// Goes from the empty page to a screen.
type Prepare = fn(&mut Screen);

type Screen = Harness<'static, (Modeler, Card)>;

/// A graphics card without a window, if there is one: the processor's own before others, which is the same everywhere.
fn card() -> Option<RenderState> {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.native_adapter_selector = Some(Arc::new(|adapters, _| {
        let is_real = |adapter: &&wgpu::Adapter| adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        adapters.iter().min_by_key(is_real).cloned().ok_or_else(|| "no adapter".to_owned())
    }));
    let wgpu_setup = WgpuSetup::CreateNew(setup);
    let instance = pollster::block_on(wgpu_setup.new_instance());
    let config = WgpuConfiguration { wgpu_setup, ..WgpuConfiguration::default() };
    pollster::block_on(RenderState::create(&config, &instance, None, RendererOptions::PREDICTABLE)).ok()
}

/// Keeps egui's textures on the card.
struct Textures(RenderState);

impl TestRenderer for Textures {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut renderer = self.0.renderer.write();
        for (id, images) in delta.set.drain() {
            for image in images {
                renderer.update_texture(&self.0.device, &self.0.queue, id, &image);
            }
        }
        for id in delta.free.drain() {
            renderer.free_texture(&id);
        }
    }
}

fn screen(state: &RenderState, size: egui::Vec2, theme: Theme) -> Screen {
    let modeler = Modeler::new(Box::new(Files::default()), None, Arc::new(|| ())).expect("threads");
    let builder = Harness::builder().with_size(size).with_theme(theme).renderer(Textures(state.clone()));
    let both = (modeler, Card::new(state.clone()));
    let mut screen =
        builder.build_ui_state(|ui, (modeler, card): &mut (Modeler, Card)| modeler.ui(ui, card), both);
    settle(&mut screen);
    screen
}

fn settle(screen: &mut Screen) {
    let until = Instant::now() + Duration::from_secs(120);
    screen.run_steps(3);
    while !screen.state().0.is_at_rest() {
        assert!(Instant::now() < until, "it never comes to rest");
        std::thread::sleep(Duration::from_millis(5));
        screen.step();
    }
    screen.run_steps(2);
}

/// Width and height of the screen, pixels.
fn size_of(screen: &Screen) -> [u32; 2] {
    let size = screen.ctx.viewport_rect().size();
    [size.x as u32, size.y as u32]
}

/// The pixels of the screen, red, green, blue and opacity.
fn pixels(screen: &Screen, state: &RenderState) -> Vec<u8> {
    let (device, queue, mut renderer) = (&state.device, &state.queue, state.renderer.write());
    let [width, height] = size_of(screen);
    let area = ScreenDescriptor { size_in_pixels: [width, height], pixels_per_point: 1.0 };
    let shapes = screen.ctx.tessellate(screen.output().shapes.clone(), 1.0);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let before = renderer.update_buffers(device, queue, &mut encoder, &shapes, &area);
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: state.target_format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = target.create_view(&wgpu::TextureViewDescriptor::default());
    let mut pass = encoder
        .begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..wgpu::RenderPassDescriptor::default()
        })
        .forget_lifetime();
    renderer.render(&mut pass, &shapes, &area);
    drop(pass);
    let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(stride * height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(target.as_image_copy(), to, size);
    queue.submit(before.into_iter().chain([encoder.finish()]));
    buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("the card is there"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the card is there");
    let bytes = buffer.slice(..).get_mapped_range().expect("it is mapped");
    let rows = bytes.chunks_exact(stride as usize).flat_map(|row| &row[..4 * width as usize]);
    let is_bgra = matches!(state.target_format, wgpu::TextureFormat::Bgra8Unorm);
    let mut pixels: Vec<u8> = rows.copied().collect();
    for pixel in pixels.chunks_exact_mut(4) {
        if is_bgra {
            pixel.swap(0, 2);
        }
        pixel[3] = 255;
    }
    pixels
}

/// Compares the screen with its picture; what is wrong with it, if anything.
fn compare(screen: &Screen, state: &RenderState, name: &str) -> Option<String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let file = folder.join(format!("{name}.png"));
    let new = folder.join(format!("{name}.new.png"));
    let now = pixels(screen, state);
    if std::env::var_os("TRULLO_UPDATE_SNAPSHOTS").is_some() {
        write(&file, &now, size_of(screen));
        return None;
    }
    let Some(before) = read(&file).filter(|before| before.len() == now.len()) else {
        write(&new, &now, size_of(screen));
        return Some(format!("{name}: there is no picture of this size"));
    };
    let is_other = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > FAINT);
    let others = now.chunks_exact(4).zip(before.chunks_exact(4)).filter(|pair| is_other(*pair)).count();
    let share = others as f64 / (now.len() / 4) as f64;
    if share <= TOLERATED {
        return None;
    }
    write(&new, &now, size_of(screen));
    Some(format!("{name}: {:.1} % of the pixels are different, see {}", 100.0 * share, new.display()))
}

fn read(file: &std::path::Path) -> Option<Vec<u8>> {
    let mut decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(file).ok()?));
    decoder.set_transformations(png::Transformations::ALPHA | png::Transformations::EXPAND);
    let mut reader = decoder.read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut pixels).ok()?;
    Some(pixels)
}

fn write(file: &std::path::Path, pixels: &[u8], [width, height]: [u32; 2]) {
    let out = std::io::BufWriter::new(std::fs::File::create(file).expect("the folder is there"));
    let mut encoder = png::Encoder::new(out, width, height);
    // Opacity says nothing.
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let opaque: Vec<u8> = pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&opaque)).expect("there is room");
}

/// Draws a circle with the pen, and lets the pictures beside it be drawn.
fn draw_circle(screen: &mut Screen) {
    let middle = screen.get_by_label("Model view").rect().center();
    let place = |i: u16| -> Pos2 {
        let angle = std::f32::consts::TAU * f32::from(i) / 64.0;
        middle + 110.0 * vec2(angle.cos(), angle.sin())
    };
    screen.hover_at(place(0));
    screen.drag_at(place(0));
    (0..=64).for_each(|i| screen.hover_at(place(i)));
    screen.drop_at(place(64));
    settle(screen);
    let is_drawn = |screen: &Screen| {
        let found = screen.state().0.pad.expectations.as_ref();
        found.is_some_and(|found| found.pictures.iter().all(Option::is_some))
    };
    let until = Instant::now() + Duration::from_secs(60);
    while !is_drawn(screen) {
        assert!(Instant::now() < until, "pictures are missing");
        screen.step();
    }
    screen.run_steps(2);
}

/// Opens an example of the gallery.
fn open(screen: &mut Screen, example: usize) {
    let (_, text) = modeler::desk::Desk::examples(&Files::default())[example];
    let scene = blobtree::Scene::from_bytes(text.as_bytes(), &mut blobtree::DrawingsBy(sketch::solve));
    screen.state_mut().0.put(scene.expect("examples are legal"), None);
    settle(screen);
}

/// Drags a ball to where it rests on the bed and on the mirror plane, and holds it there.
fn drag_to_rest(screen: &mut Screen) {
    let balls = union([point([22., 0., 18.], 10.), point([-14., 0., 8.], 8.)]);
    let (modeler, _) = screen.state_mut();
    modeler.put(blobtree::Scene::new(balls), None);
    modeler.look_from(Side::Front);
    settle(screen);
    screen.state_mut().0.select(Some(NodePath(vec![0])));
    settle(screen);
    let rect = screen.get_by_label("Model view").rect();
    let view = screen.state().0.camera.view(Vec2::new(rect.width(), rect.height()));
    let place = |x: f32, z: f32| {
        let at = view.screen_from_model(Vec3::new(x, 0.0, z)).expect("before the eye");
        rect.min + vec2(at.x, at.y)
    };
    screen.hover_at(place(22.0, 18.0));
    screen.drag_at(place(22.0, 18.0));
    screen.hover_at(place(0.5, 10.4));
    settle(screen);
}

/// What is on a screen: its name, and how to get there from the empty page.
const SCREENS: [(&str, egui::Vec2, Prepare); 9] = [
    ("empty", SIZE, |_| ()),
    ("sketch", SIZE, draw_circle),
    ("small", SMALL, |screen| {
        open(screen, 0);
        draw_circle(screen);
    }),
    ("parts", SIZE, |screen| {
        open(screen, 0);
        screen.state_mut().0.select_all([NodePath(vec![0, 0, 2]), NodePath(vec![0, 1, 0])]);
        screen.state_mut().0.settings.tool = Tool::Select;
        settle(screen);
    }),
    ("looks", SIZE, |screen| {
        open(screen, 4);
        screen.state_mut().0.settings.shows_overhang = true;
        screen.state_mut().0.settings.look = Look::Shaded;
        screen.state_mut().0.select(Some(NodePath(vec![1])));
        settle(screen);
    }),
    ("dragged", SIZE, drag_to_rest),
    ("left-handed", SIZE, |screen| {
        screen.state_mut().0.settings.left_handed = true;
        settle(screen);
        draw_circle(screen);
    }),
    ("lens", SIZE, |screen| {
        open(screen, 7);
        screen.state_mut().0.toggle_lens();
        settle(screen);
    }),
    ("help", SIZE, |screen| {
        screen.state_mut().0.dialog = Some(Dialog::Help);
        // The window takes some frames to find its size.
        screen.run_steps(10);
    }),
];

#[test]
fn the_main_screens_look_as_they_did_in_light_and_dark() {
    let Some(state) = card() else {
        eprintln!("SKIPPED: there is no graphics driver; on Debian and Ubuntu, install mesa-vulkan-drivers");
        return;
    };
    let mut wrong = Vec::new();
    for (name, size, prepare) in SCREENS {
        for (theme, tone) in [(Theme::Light, "light"), (Theme::Dark, "dark")] {
            let mut screen = screen(&state, size, theme);
            prepare(&mut screen);
            wrong.extend(compare(&screen, &state, &format!("{name}-{tone}")));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
