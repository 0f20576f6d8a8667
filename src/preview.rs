//! Pictures of drawings: the strokes as they were drawn, and the curves that were made of them.

use crate::drawing::Drawn;
use crate::failure::Failure;
use crate::render;
use glam::{DVec2, Vec2};
use std::path::Path;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, PathStroker, Pixmap, Stroke, Transform,
};

/// The width of a picture of one drawing, pixels; of each of several, down to the least that shows anything.
const WIDTH: f32 = 800.0;
const LEAST_WIDTH: f32 = 160.0;
/// Widest picture, pixels.
const MOST: f32 = 4096.0;
/// Most drawings in a picture: ten rows of ten.
const MOST_DRAWINGS: usize = 100;
/// Free room on each side of a drawing, as a share of its cell.
const MARGIN: f32 = 0.08;

/// Red, green, blue and opacity.
type Ink = [u8; 4];
const PAPER: Ink = [0xfb, 0xfa, 0xf6, 0xff];
const STROKE: Ink = [0x2f, 0x7d, 0xe1, 0x90];
const LEFT_OUT: Ink = [0xc8, 0x6b, 0x1f, 0x90];
const INSIDE: Ink = [0x2f, 0x7d, 0xe1, 0x20];
const CURVE: Ink = [0x1b, 0x1b, 0x1f, 0xff];

/// A PNG file that shows drawings in rows: strokes in transparent blue (in transparent orange those that are not
/// part of an outline), curves in black with a dot on every corner, and a tint on what is inside.
///
/// Errors: more than 100 drawings.
pub fn png(path: &Path, drawings: &[Drawn]) -> Result<Vec<u8>, Failure> {
    if drawings.len() > MOST_DRAWINGS {
        let what = format!("a preview shows at most {MOST_DRAWINGS} drawings, not {}", drawings.len());
        return Err(Failure::of(path, what));
    }
    let columns = (drawings.len() as f32).sqrt().ceil().max(1.0);
    let rows = (drawings.len() as f32 / columns).ceil().max(1.0);
    let cell = (1.5 * WIDTH / columns).clamp(LEAST_WIDTH, WIDTH).min(MOST / columns).floor();
    let size = [(columns * cell) as u32, (rows * cell) as u32];
    let mut page = Pixmap::new(size[0], size[1]).ok_or_else(|| Failure::of(path, "the preview is empty"))?;
    page.fill(color(PAPER));
    for (i, drawn) in drawings.iter().enumerate() {
        let corner = Vec2::new((i % columns as usize) as f32, (i / columns as usize) as f32) * cell;
        draw(&mut page, drawn, corner, cell);
    }
    let opaque: Vec<u8> = page.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    render::png(&opaque, size).map_err(|e| Failure::of(path, e))
}

fn draw(page: &mut Pixmap, drawn: &Drawn, corner: Vec2, cell: f32) {
    let Some(pixel_from_mm) = fitted(drawn, corner, cell) else { return };
    let pen = cell / 400.0;
    if let Some(curve) = drawn.curve() {
        let contours: Vec<Vec<Vec2>> =
            curve.contours.iter().map(|c| placed(&c.points, &pixel_from_mm)).collect();
        fill(page, &contours, INSIDE);
    }
    for (i, stroke) in drawn.drawing.strokes.iter().enumerate() {
        let is_left_out = drawn.curve().is_some_and(|curve| curve.left_out.contains(&i));
        let line: Vec<Vec2> = stroke.points.iter().map(|p| pixel_from_mm(p.at)).collect();
        trace(page, &line, false, 3.0 * pen, if is_left_out { LEFT_OUT } else { STROKE });
    }
    for contour in drawn.curve().iter().flat_map(|curve| &curve.contours) {
        let line = placed(&contour.points, &pixel_from_mm);
        trace(page, &line, true, pen, CURVE);
        for &corner in &contour.corners {
            trace(page, &[line[corner]], false, 5.0 * pen, CURVE);
        }
    }
}

fn placed(points: &[DVec2], pixel_from_mm: &impl Fn(Vec2) -> Vec2) -> Vec<Vec2> {
    points.iter().map(|p| pixel_from_mm(p.as_vec2())).collect()
}

/// The map that puts a drawing's strokes and curves into its cell; `None` if there are no points.
fn fitted(drawn: &Drawn, corner: Vec2, cell: f32) -> Option<impl Fn(Vec2) -> Vec2 + use<>> {
    let strokes = drawn.drawing.strokes.iter().flat_map(|s| &s.points).map(|p| p.at);
    let curves = drawn.curve().into_iter().flat_map(|c| &c.contours).flat_map(|c| &c.points);
    let mut points = strokes.chain(curves.map(|p| p.as_vec2())).filter(|p| p.is_finite());
    let first = points.next()?;
    let [low, high] = points.fold([first; 2], |[low, high], p| [low.min(p), high.max(p)]);
    let extent = (high - low).max_element().max(f32::MIN_POSITIVE);
    let scale = cell * (1.0 - 2.0 * MARGIN) / extent;
    let (middle, center) = (0.5 * (low + high), corner + 0.5 * cell);
    Some(move |p: Vec2| center + (p - middle) * Vec2::new(scale, -scale))
}

fn fill(page: &mut Pixmap, contours: &[Vec<Vec2>], ink: Ink) {
    let mut path = PathBuilder::new();
    for contour in contours {
        add(&mut path, contour, true);
    }
    if let Some(path) = path.finish() {
        page.fill_path(&path, &paint(ink), FillRule::Winding, Transform::identity(), None);
    }
}

/// Draws a line; a dot if it has one point only.
fn trace(page: &mut Pixmap, line: &[Vec2], is_closed: bool, width: f32, ink: Ink) {
    let mut path = PathBuilder::new();
    match line {
        [dot] => path.push_circle(dot.x, dot.y, 0.5 * width),
        _ => add(&mut path, line, is_closed),
    }
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    let outline = path.finish().and_then(|path| match line {
        [_] => Some(path),
        // Stroked as one area, so that a line that crosses itself is not darker there.
        _ => PathStroker::new().stroke(&path, &stroke, 1.0),
    });
    if let Some(outline) = outline {
        page.fill_path(&outline, &paint(ink), FillRule::Winding, Transform::identity(), None);
    }
}

fn add(path: &mut PathBuilder, line: &[Vec2], is_closed: bool) {
    for (i, p) in line.iter().filter(|p| p.is_finite()).enumerate() {
        if i == 0 { path.move_to(p.x, p.y) } else { path.line_to(p.x, p.y) }
    }
    if is_closed {
        path.close();
    }
}

fn color([r, g, b, a]: Ink) -> Color {
    Color::from_rgba8(r, g, b, a)
}

fn paint(ink: Ink) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(color(ink));
    paint
}
