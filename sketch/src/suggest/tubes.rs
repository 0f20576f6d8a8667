//! Drawing on the surface: tubes along strokes, lying on the model.

use super::surface::{Surface, Under, plain};
use super::view::View;
use crate::stroke::{Sketch, Stroke, resample};
use blobtree::{Node, NodeRef, Operator, Polyline, PolylinePoint, Primitive, Shape};

/// Rays along one stroke: more than tubes have visible bends.
const RAYS: usize = 256;

/// Rays for all strokes together, so that a page full of strokes takes no longer than a few.
const RAYS_IN_ALL: usize = 4096;

/// The most that a surface may run away in depth, as a multiple of the way along the screen, before a tube ends:
/// a ball's surface does that 5° from its silhouette. Beyond, the pen has jumped to another part of the model.
const STEEPEST: f32 = 12.0;

/// The stretch at each end over which a tube tapers, as a part of its length.
const TAPER: f32 = 0.15;

/// The radius at the very ends, as a part of the full one.
const TIP: f32 = 0.35;

/// The least part of the radius that the lightest touch leaves.
const LIGHTEST: f32 = 0.2;

/// The smallest radius that a shape may have, mm.
const THINNEST: f32 = 1e-3;

/// Tubes of this radius (mm) along the strokes, where they lie on the surface; `None` if none does. Two strokes
/// that a surface's jump in depth divides are separate.
pub(super) fn tubes(sketch: &Sketch, view: &View, surface: &Surface, radius: f32) -> Option<NodeRef> {
    let rays = (RAYS_IN_ALL / sketch.strokes.len().max(1)).clamp(1, RAYS);
    let nodes: Vec<NodeRef> = sketch
        .strokes
        .iter()
        .flat_map(|stroke| lines(&plain(stroke), view, surface, rays))
        .map(|line| {
            let polyline = Polyline { points: tapered(&line, radius), falloff: None };
            Node::new(Shape::Primitive(Primitive::Polyline(polyline))).into()
        })
        .collect();
    match nodes.len() {
        0 => None,
        1 => nodes.into_iter().next(),
        _ => Some(Node::new(Shape::Operator(Operator::Union, nodes)).into()),
    }
}

/// Places on the surface in a row, each with the pen's pressure, 0 to 1.
type Line = Vec<(Under, f32)>;

/// The stretches of a stroke that lie on one surface.
fn lines(stroke: &Stroke, view: &View, surface: &Surface, rays: usize) -> Vec<Line> {
    let stroke = resample(stroke, stroke.length() / rays as f32);
    let mut lines: Vec<Line> = vec![Vec::new()];
    for sample in &stroke.samples {
        let under = surface.under(view, sample.place());
        let line = lines.last_mut().expect("there is always a last line");
        match (under, line.last()) {
            (None, None) => {}
            (None, Some(_)) => lines.push(Vec::new()),
            (Some(under), last) => {
                let jumps = last.is_some_and(|(last, _)| {
                    let away = (under.depth - last.depth).abs();
                    let aside = (under.point.distance_squared(last.point) - away * away).max(0.0).sqrt();
                    away > STEEPEST * aside
                });
                if jumps {
                    lines.push(Vec::new());
                }
                let line = lines.last_mut().expect("there is always a last line");
                line.push((under, sample.pressure.clamp(0.0, 1.0)));
            }
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

/// The line with its radii: thinner where the pen pressed less, and towards the ends.
fn tapered(line: &Line, radius: f32) -> Vec<PolylinePoint> {
    let steps = line.windows(2).map(|pair| pair[0].0.point.distance(pair[1].0.point));
    let along: Vec<f32> = std::iter::once(0.0)
        .chain(steps.scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        }))
        .collect();
    let length = along[along.len() - 1];
    let taper = |at: f32| {
        if length <= 0.0 {
            return 1.0;
        }
        let from_end = (at.min(length - at) / (TAPER * length)).min(1.0);
        TIP + (1.0 - TIP) * from_end
    };
    line.iter()
        .zip(along)
        .map(|((under, pressure), at)| {
            let pressed = LIGHTEST + (1.0 - LIGHTEST) * pressure;
            PolylinePoint { at: under.point, radius: (radius * pressed * taper(at)).max(THINNEST) }
        })
        .collect()
}
