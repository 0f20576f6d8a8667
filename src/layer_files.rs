//! Layers as SVG and PNG.

use crate::cli::LayerKind;
use crate::failure::Failure;
use crate::job::Watch;
use glam::DVec2;
use printable::slices::Slices;
use std::fmt::Write;
use std::path::Path;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Transform};

/// Most files in a folder.
const MOST_FILES: usize = 20_000;
/// Most bytes of one SVG file.
const MOST_BYTES: usize = 1 << 30;
/// Most pixels along a side of a PNG file.
const MOST_PIXELS: f64 = 8192.0;
/// Around the shape in pictures, mm.
const MARGIN: f64 = 1.0;

/// Why layers cannot be drawn.
#[derive(Debug)]
pub enum DrawError {
    /// They would be too many or too large, or there is nothing to draw.
    Refused(String),
    /// Somebody asked to stop.
    Failed(Failure),
}

impl DrawError {
    /// As a failure about a file.
    pub fn about(self, file: &Path) -> Failure {
        match self {
            Self::Refused(what) => Failure::of(file, what),
            Self::Failed(failure) => failure,
        }
    }
}

/// The part of the plane that all layers of a part are drawn in.
#[derive(Clone, Copy, Debug)]
struct Window {
    min: DVec2,
    max: DVec2,
}

impl Window {
    fn around(slices: &Slices) -> Result<Self, DrawError> {
        let outlines = (0..slices.layers.len()).flat_map(|k| slices.regions(k)).flatten().flatten();
        let none = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
        let all = outlines.fold(none, |w, p| Self { min: w.min.min(p), max: w.max.max(p) });
        if all.min.x > all.max.x {
            return Err(DrawError::Refused(
                "no layer has any area: the shape is thinner than a layer, or not closed".into(),
            ));
        }
        let margin = DVec2::splat(MARGIN);
        Ok(Self { min: all.min - margin, max: all.max + margin })
    }

    fn size(&self) -> DVec2 {
        self.max - self.min
    }
}

/// One SVG file with a group for each layer, from the bottom up.
///
/// Lengths are mm; rows run down, so y is mirrored. Each group has its number and height as `id` and `data-z`.
pub fn whole_svg(slices: &Slices, watch: &Watch) -> Result<String, DrawError> {
    let window = Window::around(slices)?;
    let mut svg = svg_head(&window);
    for layer in 0..slices.layers.len() {
        watch.go_on().map_err(DrawError::Failed)?;
        watch.report(layer as f32 / slices.layers.len() as f32);
        svg_layer(&mut svg, slices, layer, &window);
        if svg.len() > MOST_BYTES {
            let what =
                format!("the SVG file would be larger than {} MiB; use thicker layers", MOST_BYTES >> 20);
            return Err(DrawError::Refused(what));
        }
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn svg_head(window: &Window) -> String {
    let size = window.size();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3}mm\" height=\"{1:.3}mm\" viewBox=\"0 0 {0:.3} {1:.3}\">\n",
        size.x, size.y
    )
}

fn svg_layer(svg: &mut String, slices: &Slices, layer: usize, window: &Window) {
    let z = slices.planes.heights[layer];
    let mut write =
        |text: std::fmt::Arguments| svg.write_fmt(text).expect("strings take all that is written");
    write(format_args!("<g id=\"layer-{layer}\" data-z=\"{z:.4}\" fill-rule=\"evenodd\">\n"));
    for region in slices.regions(layer) {
        write(format_args!("<path d=\""));
        for ring in &region {
            for (i, p) in ring.iter().enumerate() {
                let (x, y) = (p.x - window.min.x, window.max.y - p.y);
                write(format_args!("{}{x:.4} {y:.4}", if i == 0 { 'M' } else { 'L' }));
            }
            write(format_args!("Z"));
        }
        write(format_args!("\"/>\n"));
    }
    write(format_args!("</g>\n"));
}

/// The files of a folder, one for each layer.
pub struct LayerFiles<'a> {
    slices: &'a Slices,
    window: Window,
    kind: LayerKind,
    /// Width and height in pixels, and pixels to a mm.
    raster: ([u32; 2], f64),
}

impl<'a> LayerFiles<'a> {
    /// Pixels are `pixel_mm` wide.
    pub fn new(slices: &'a Slices, kind: LayerKind, pixel_mm: f64) -> Result<Self, DrawError> {
        let layers = slices.layers.len();
        if layers > MOST_FILES {
            let what = format!("{layers} layers are more than {MOST_FILES} files; use thicker layers");
            return Err(DrawError::Refused(what));
        }
        let window = Window::around(slices)?;
        let size = (window.size() / pixel_mm).ceil();
        if kind == LayerKind::Png && size.max_element() > MOST_PIXELS {
            let least = window.size().max_element() / MOST_PIXELS;
            let what = format!(
                "pictures of {:.0} × {:.0} pixels are too large; take a --pixel of {least:.3} mm or more",
                size.x, size.y
            );
            return Err(DrawError::Refused(what));
        }
        let raster = ([size.x as u32, size.y as u32], pixel_mm.recip());
        Ok(Self { slices, window, kind, raster })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.slices.layers.len()
    }

    /// The name and content of a layer's file.
    pub fn file(&self, layer: usize) -> Result<(String, Vec<u8>), Failure> {
        match self.kind {
            LayerKind::Svg => {
                let mut svg = svg_head(&self.window);
                svg_layer(&mut svg, self.slices, layer, &self.window);
                svg.push_str("</svg>\n");
                Ok((format!("layer-{layer:05}.svg"), svg.into_bytes()))
            }
            LayerKind::Png => Ok((format!("layer-{layer:05}.png"), self.png(layer)?)),
        }
    }

    fn png(&self, layer: usize) -> Result<Vec<u8>, Failure> {
        let ([width, height], scale) = self.raster;
        let mut pixels = Pixmap::new(width, height)
            .ok_or_else(|| Failure::Input(format!("no picture can be {width} × {height} pixels")))?;
        pixels.fill(Color::BLACK);
        let mut paint = Paint::default();
        paint.set_color(Color::WHITE);
        for region in self.slices.regions(layer) {
            let mut path = PathBuilder::new();
            for ring in &region {
                for (i, p) in ring.iter().enumerate() {
                    let (x, y) = (scale * (p.x - self.window.min.x), scale * (self.window.max.y - p.y));
                    if i == 0 { path.move_to(x as f32, y as f32) } else { path.line_to(x as f32, y as f32) }
                }
                path.close();
            }
            if let Some(path) = path.finish() {
                pixels.fill_path(&path, &paint, FillRule::EvenOdd, Transform::identity(), None);
            }
        }
        let grey: Vec<u8> = pixels.pixels().iter().map(|pixel| pixel.red()).collect();
        encode(&grey, width, height).map_err(|e| Failure::Input(format!("the picture of layer {layer}: {e}")))
    }
}

/// A grey PNG file.
fn encode(grey: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(grey)?;
    writer.finish()?;
    Ok(bytes)
}
