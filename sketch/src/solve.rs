//! The whole way from a drawing to the field that a sketched primitive sweeps.

use crate::curve::{self, NoOutline};
use crate::suggest::Outlines;
use crate::template;
use blobtree::{Drawing, DrawnStroke, Primitive, Template};
use glam::DVec2;
use std::sync::Arc;

/// Most places of the pen whose pressure the template hears of.
const MOST_PRESSURES: usize = 4000;

/// The template of a drawing: its outline found, smoothed and made a field.
///
/// - **Units:** mm; `falloff` is how far the influence reaches beyond the curve, by itself where none is given.
/// - **Errors:** [`NoOutline`], in words for whoever drew it.
/// - **Cost:** that of [`curve::fit`] and [`template::solve`].
pub fn solve(drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, NoOutline> {
    let curve = curve::fit(drawing)?;
    let template = template::solve(&curve, falloff, &pressures(drawing, &curve.left_out));
    template.map(Arc::new).map_err(|reason| NoOutline::NoField { reason: reason.to_string() })
}

/// The strokes of a drawn primitive; `None` for other primitives.
pub fn drawing_of(primitive: &Primitive) -> Option<&Arc<Drawing>> {
    match primitive {
        Primitive::Inflation(p) => Some(&p.drawing),
        Primitive::LinearSweep(p) => Some(&p.drawing),
        Primitive::Revolution(p) => Some(&p.drawing),
        Primitive::PathSweep(p) => Some(&p.drawing),
        _ => None,
    }
}

/// A drawn primitive with other strokes in its drawing, solved again; all else stays. One that is not drawn stays
/// as it is.
///
/// Errors: strokes without an outline. **Cost:** that of [`solve`].
pub fn redrawn(mut primitive: Primitive, strokes: Vec<DrawnStroke>) -> Result<Primitive, NoOutline> {
    let (drawing, falloff, template) = match &mut primitive {
        Primitive::Inflation(p) => (&mut p.drawing, p.falloff, &mut p.template),
        Primitive::LinearSweep(p) => (&mut p.drawing, p.falloff, &mut p.template),
        Primitive::Revolution(p) => (&mut p.drawing, p.falloff, &mut p.template),
        Primitive::PathSweep(p) => (&mut p.drawing, p.falloff, &mut p.template),
        _ => return Ok(primitive),
    };
    *drawing = Arc::new(Drawing { strokes, ..Drawing::clone(drawing) });
    template.0 = solve(drawing, falloff)?;
    Ok(primitive)
}

/// Finds outlines for suggestions as [`solve`] does when the scene is read again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Solver;

impl Outlines for Solver {
    type Reason = NoOutline;

    fn left_out(&self, drawing: &Drawing) -> Result<Vec<usize>, NoOutline> {
        curve::fit(drawing).map(|curve| curve.left_out)
    }

    fn template(&self, drawing: &Drawing) -> Result<Arc<Template>, NoOutline> {
        solve(drawing, None)
    }
}

/// How hard the pen pressed along the strokes of the outline.
fn pressures(drawing: &Drawing, left_out: &[usize]) -> Vec<(DVec2, f32)> {
    let strokes = drawing.strokes.iter().enumerate().filter(|(i, _)| !left_out.contains(i));
    let points = strokes.flat_map(|(_, stroke)| &stroke.points);
    let pressed = |point: &&blobtree::DrawnPoint| point.at.is_finite() && point.pressure.is_finite();
    let all: Vec<(DVec2, f32)> =
        points.filter(pressed).map(|point| (point.at.as_dvec2(), point.pressure.clamp(0., 1.))).collect();
    let step = all.len().div_ceil(MOST_PRESSURES).max(1);
    all.into_iter().step_by(step).collect()
}
