//! Outlines of an SVG picture as strokes.
//!
//! usvg resolves groups, transforms, styles, units, reused parts and basic shapes; what is left are paths.
//! Each of their contours is a stroke, filled ones closed. Text, pictures in the picture, clips, masks and
//! patterns are left out, arrow heads too, and nothing is loaded from outside the file.

mod links;
mod reuse;

use super::error::{ReadError, ReadProblem};
use super::{MAX_SAMPLES, MAX_STROKES};
use crate::stroke::{Stroke, bounds};
use blobtree::TextPosition;
use glam::Vec2;
use usvg::roxmltree::{Document, ParsingOptions};
use usvg::tiny_skia_path::{PathSegment, Point, Transform};

/// Most XML nodes in a picture: fifty for each stroke that could be used.
const MAX_NODES: u32 = 200_000;

/// Deepest nesting of elements; drawing programs nest groups a dozen deep. Readers recurse, so that deeper
/// files could exhaust the stack.
const MAX_DEPTH: usize = 256;

/// The stack for reading, bytes: elements in elements in reused parts.
const STACK: usize = 64 << 20;

/// How far lines may leave the curves for which they stand, as a part of the picture's larger side: half a
/// pixel of the template's usual field image, and half of what the curve fit is held to.
const FLATNESS: f32 = 1.0 / 4000.0;

/// Most lines for one piece of a curve.
const MAX_LINES: f32 = 1000.0;

/// The outlines of the picture in the text. Errors: as [`super::read`].
pub(super) fn strokes(text: &str) -> Result<Vec<Stroke>, ReadError> {
    let text = &*links::without_links(text);
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let pos = error.pos();
        let said = error.to_string();
        let said = said.rsplit_once(" at ").map_or(&*said, |(what, _)| what).to_owned();
        let at = TextPosition { line: pos.row as usize, column: pos.col as usize };
        ReadError { at: Some(at), problem: ReadProblem::Xml(said) }
    })?;
    check_depth(&document)?;
    check_links(&document)?;
    let tree = with_room(|| {
        reuse::check_reuse(&document)?;
        usvg::Tree::from_xmltree(&document, &nothing_from_outside())
            .map_err(|error| ReadError::from(ReadProblem::Svg(error.to_string())))
    })??;
    let mut contours = Vec::new();
    collect(tree.root(), &mut contours)?;
    let size = bounds(contours.iter().flat_map(|contour| contour.hull()))
        .map_or(0.0, |[lo, hi]| (hi - lo).max_element());
    if contours.is_empty() || !size.is_finite() {
        return Err(ReadProblem::NoOutlines.into());
    }
    let mut samples = 0;
    let mut strokes = Vec::with_capacity(contours.len());
    for contour in &contours {
        let stroke = Stroke::through(contour.flattened(FLATNESS * size));
        samples += stroke.samples.len();
        if samples > MAX_SAMPLES {
            return Err(ReadProblem::TooManySamples.into());
        }
        strokes.push(stroke);
    }
    Ok(strokes)
}

fn nothing_from_outside() -> usvg::Options<'static> {
    let image_href_resolver = usvg::ImageHrefResolver {
        resolve_data: Box::new(|_, _, _| None),
        resolve_string: Box::new(|_, _| None),
    };
    usvg::Options { image_href_resolver, ..usvg::Options::default() }
}

/// Runs it on a thread of its own, whose stack is large enough.
fn with_room<T: Send>(read: impl FnOnce() -> T + Send) -> Result<T, ReadError> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, read);
        thread.ok().and_then(|thread| thread.join().ok())
    })
    .ok_or_else(|| ReadProblem::Svg("there is not enough memory to read it".into()).into())
}

/// Errors: a link that was not taken out, because its letters are not written as letters.
fn check_links(document: &Document) -> Result<(), ReadError> {
    let mut values = document.descendants().flat_map(|node| node.attributes().map(|a| a.value()));
    if values.any(links::has_link) || document.descendants().filter_map(|n| n.text()).any(links::has_link) {
        let problem = "it hides a link, url(…), behind character references; write it in plain letters";
        return Err(ReadProblem::Svg(problem.into()).into());
    }
    Ok(())
}

fn check_depth(document: &Document) -> Result<(), ReadError> {
    let mut open = vec![(document.root(), 0)];
    while let Some((node, depth)) = open.pop() {
        if depth > MAX_DEPTH {
            let pos = document.text_pos_at(node.range().start);
            let at = TextPosition { line: pos.row as usize, column: pos.col as usize };
            let problem = ReadProblem::Svg(format!("elements are nested more than {MAX_DEPTH} deep"));
            return Err(ReadError { at: Some(at), problem });
        }
        open.extend(node.children().filter(|child| child.is_element()).map(|child| (child, depth + 1)));
    }
    Ok(())
}

/// One contour of a path, in the picture's own frame.
struct Contour {
    start: Vec2,
    pieces: Vec<Piece>,
    closed: bool,
}

/// A piece of a contour from the end of the one before.
enum Piece {
    Line(Vec2),
    Quadratic(Vec2, Vec2),
    Cubic(Vec2, Vec2, Vec2),
}

fn collect(group: &usvg::Group, to: &mut Vec<Contour>) -> Result<(), ReadError> {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => collect(group, to)?,
            usvg::Node::Path(path) => add_path(path, to),
            usvg::Node::Image(_) | usvg::Node::Text(_) => {}
        }
        if to.len() > MAX_STROKES {
            return Err(ReadProblem::TooManyStrokes(to.len()).into());
        }
    }
    Ok(())
}

fn add_path(path: &usvg::Path, to: &mut Vec<Contour>) {
    let transform = path.abs_transform();
    let at = |point: Point| placed(&transform, point);
    // What is filled but not drawn has an edge all around.
    let closed = path.fill().is_some() && path.stroke().is_none();
    for segment in path.data().segments() {
        if let PathSegment::MoveTo(p) = segment {
            to.push(Contour { start: at(p), pieces: Vec::new(), closed });
            continue;
        }
        let Some(contour) = to.last_mut() else { continue };
        match segment {
            PathSegment::LineTo(p) => contour.pieces.push(Piece::Line(at(p))),
            PathSegment::QuadTo(a, p) => contour.pieces.push(Piece::Quadratic(at(a), at(p))),
            PathSegment::CubicTo(a, b, p) => contour.pieces.push(Piece::Cubic(at(a), at(b), at(p))),
            PathSegment::Close => contour.closed = true,
            PathSegment::MoveTo(_) => {}
        }
    }
}

fn placed(transform: &Transform, point: Point) -> Vec2 {
    let Transform { sx, kx, ky, sy, tx, ty } = *transform;
    Vec2::new(sx * point.x + kx * point.y + tx, ky * point.x + sy * point.y + ty)
}

impl Contour {
    /// Points that the contour does not leave.
    fn hull(&self) -> impl Iterator<Item = Vec2> + '_ {
        let points = self.pieces.iter().flat_map(|piece| match *piece {
            Piece::Line(p) => [p, p, p],
            Piece::Quadratic(a, p) => [a, p, p],
            Piece::Cubic(a, b, p) => [a, b, p],
        });
        std::iter::once(self.start).chain(points)
    }

    /// Points on the contour between which lines leave it by at most `flatness`.
    fn flattened(&self, flatness: f32) -> Vec<Vec2> {
        let mut points = vec![self.start];
        let mut from = self.start;
        for piece in &self.pieces {
            // A curve's second difference bounds how far its chords can be from it.
            let (to, bend) = match *piece {
                Piece::Line(p) => (p, 0.0),
                Piece::Quadratic(a, p) => (p, 0.25 * (from - 2.0 * a + p).length()),
                Piece::Cubic(a, b, p) => {
                    (p, 0.75 * (from - 2.0 * a + b).length().max((a - 2.0 * b + p).length()))
                }
            };
            let lines = (bend / flatness).sqrt().ceil().clamp(1.0, MAX_LINES) as usize;
            points.extend((1..lines).map(|i| piece.at(from, i as f32 / lines as f32)));
            points.push(to);
            from = to;
        }
        if self.closed && from != self.start {
            points.push(self.start);
        }
        points
    }
}

impl Piece {
    fn at(&self, from: Vec2, t: f32) -> Vec2 {
        match *self {
            Self::Line(p) => from.lerp(p, t),
            Self::Quadratic(a, p) => from.lerp(a, t).lerp(a.lerp(p, t), t),
            Self::Cubic(a, b, p) => {
                let (first, middle, last) = (from.lerp(a, t), a.lerp(b, t), b.lerp(p, t));
                first.lerp(middle, t).lerp(middle.lerp(last, t), t)
            }
        }
    }
}
