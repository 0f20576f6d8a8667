//! What lies over the picture: strokes, curves, and the selection with its handles.

use super::hand::Hold;
use super::handles::{ALL, Handle, Handles};
use super::knobs::{self, Knob, Turns};
use super::{in_view, on_screen, sides, snapping, suggestions};
use crate::modeler::Modeler;
use crate::theme;
use blobtree::Aabb;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Response, Stroke, Ui, vec2};
use glam::{Vec2, Vec3};
use sketch::suggest::View;

/// Strokes as they are drawn.
const STROKE: Color32 = Color32::from_rgba_premultiplied(30, 60, 130, 130);

/// What the eraser has passed over.
const ERASED: Color32 = Color32::from_rgba_premultiplied(120, 40, 40, 120);

/// How far boxes around parts go beyond the model, as a share of its longest side.
const BEYOND: f32 = 0.15;

/// Shows it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui, response: &Response) {
    let painter = ui.painter_at(response.rect);
    let view = modeler.camera.view(modeler.view.screen);
    let dark = ui.visuals().dark_mode;
    // A sketch in the air has the view for itself.
    if modeler.pad.is_empty() {
        let selected = modeler.selected_boxes().map(|bounds| (bounds, theme::selected(dark)));
        let hovered = modeler.hovered_box().map(|bounds| (bounds, theme::pointed(dark)));
        for (bounds, color) in selected.chain(hovered) {
            paint_box(&painter, &within(&bounds, &modeler.bounds()), &view, response, color);
        }
        paint_handles(modeler, &painter, response);
        snapping::paint(modeler, &painter, &view, response);
    }
    super::lens::show(modeler, ui, &view, response);
    paint_ghost_plane(modeler, &painter, &view, response);
    paint_knobs(modeler, &painter, response);
    paint_sketch(modeler, &painter, &view, response);
    suggestions::beside(modeler, ui, response);
    sides::show(modeler, ui, response);
}

/// A box without what lies far outside the model: what cuts goes far beyond it.
fn within(bounds: &Aabb, model: &Aabb) -> Aabb {
    if model.is_empty() {
        return *bounds;
    }
    let beyond = Vec3::splat(BEYOND * model.size().max_element());
    Aabb { min: bounds.min.max(model.min - beyond), max: bounds.max.min(model.max + beyond) }
}

fn paint_box(painter: &Painter, bounds: &Aabb, view: &View, response: &Response, color: Color32) {
    let corners = bounds.corners().map(|corner| view.screen_from_model(corner));
    for a in 0..8_usize {
        // Corners are neighbours if they differ along one axis.
        for b in [a ^ 1, a ^ 2, a ^ 4].into_iter().filter(|b| *b > a) {
            if let (Some(a), Some(b)) = (corners[a], corners[b]) {
                painter.line_segment(
                    [on_screen(a, response), on_screen(b, response)],
                    Stroke::new(1.0, color.gamma_multiply(0.7)),
                );
            }
        }
    }
}

fn paint_handles(modeler: &Modeler, painter: &Painter, response: &Response) {
    let Some(handles) = Handles::of(modeler) else { return };
    let dark = painter.ctx().global_style().visuals.dark_mode;
    let held = match modeler.view.hold {
        Hold::Handle(handle, _) => Some(handle),
        Hold::Nothing => response.hover_pos().and_then(|at| Handle::at(modeler, in_view(at, response))),
        _ => None,
    };
    for handle in ALL.into_iter().rev() {
        let width = if held == Some(handle) { 4.0 } else { 2.0 };
        let color = handle.color(dark);
        let stroke = Stroke::new(width, color);
        let line: Vec<Pos2> = handles.line(handle).into_iter().map(|p| on_screen(p, response)).collect();
        match (handle, &line[..]) {
            (Handle::Arrow(_), [from, to]) => painter.arrow(*from, *to - *from, stroke),
            (Handle::Square, [at]) => {
                let square = Rect::from_center_size(*at, vec2(14.0, 14.0));
                painter.rect_filled(square, 2.0, color);
            }
            (Handle::Middle, [at]) => {
                painter.circle_filled(*at, if held == Some(handle) { 9.0 } else { 7.0 }, color);
            }
            (_, []) => {}
            (_, many) => {
                painter.line(many.to_vec(), Stroke::new(width, color.gamma_multiply(0.8)));
            }
        }
    }
}

/// The plane in which the sketch lies, as a pane of glass.
fn paint_ghost_plane(modeler: &Modeler, painter: &Painter, view: &View, response: &Response) {
    let Some(corners) = knobs::ghost_plane(modeler) else { return };
    let seen = corners.map(|corner| view.screen_from_model(corner).map(|at| on_screen(at, response)));
    let [Some(a), Some(b), Some(c), Some(d)] = seen else { return };
    let glass = Color32::from_rgba_unmultiplied(70, 130, 220, 18);
    let edge = Stroke::new(1.0, Color32::from_rgba_unmultiplied(70, 130, 220, 110));
    painter.add(egui::Shape::convex_polygon(vec![a, b, c, d], glass, edge));
}

fn paint_knobs(modeler: &Modeler, painter: &Painter, response: &Response) {
    let held = match modeler.view.hold {
        Hold::Knob(turns, ..) => Some(turns),
        Hold::Nothing => {
            let over = response.hover_pos().and_then(|at| Knob::at(modeler, in_view(at, response)));
            over.map(|knob| knob.turns)
        }
        // Nothing is in the way of a pen that draws.
        _ => return,
    };
    let dark = painter.ctx().global_style().visuals.dark_mode;
    let ink = if dark { Color32::from_gray(230) } else { Color32::from_gray(40) };
    for knob in Knob::all(modeler) {
        let color = Color32::from_rgb(20, 150, 140);
        let (at, from) = (on_screen(knob.at, response), on_screen(knob.from, response));
        painter.add(egui::Shape::dashed_line(&[from, at], Stroke::new(1.0, color), 4.0, 4.0));
        let grows = vec2(knob.grows.x, knob.grows.y);
        let radius = if held == Some(knob.turns) { 10.0 } else { 8.0 };
        painter.circle(at, radius, color, Stroke::new(1.5, Color32::WHITE));
        for side in [-1.0, 1.0] {
            painter.arrow(at + side * (radius + 2.0) * grows, side * 9.0 * grows, Stroke::new(2.0, color));
        }
        if knob.turns == Turns::Depth && held.is_none() {
            continue;
        }
        let beside = at + vec2(0.0, radius + 4.0 + 10.0 * grows.y.abs());
        painter.text(beside, Align2::CENTER_TOP, knob.text(), FontId::proportional(13.0), ink);
    }
}

fn paint_sketch(modeler: &Modeler, painter: &Painter, view: &View, response: &Response) {
    let pad = &modeler.pad;
    let shown = |line: &mut dyn Iterator<Item = Vec2>| -> Vec<Pos2> {
        line.filter_map(|p| pad.shown(p, view)).map(|p| on_screen(p, response)).collect()
    };
    for stroke in &pad.sketch().strokes {
        let line = shown(&mut stroke.samples.iter().map(|sample| sample.pen.place()));
        paint_line(painter, line, Stroke::new(5.0, STROKE));
    }
    if let Some(curves) = &pad.curves {
        let ink =
            if painter.ctx().global_style().visuals.dark_mode { Color32::WHITE } else { Color32::BLACK };
        for closed in &curves.closed {
            paint_line(
                painter,
                shown(&mut closed.iter().chain(closed.first()).copied()),
                Stroke::new(1.6, ink),
            );
        }
        for open in &curves.open {
            paint_line(painter, shown(&mut open.iter().copied()), Stroke::new(1.6, ink));
        }
    }
    if let Some(current) = pad.current() {
        let line = current.places().map(|p| on_screen(p, response)).collect();
        let color = if current.eraser { ERASED } else { STROKE };
        paint_line(painter, line, Stroke::new(5.0, color));
    }
}

fn paint_line(painter: &Painter, line: Vec<Pos2>, stroke: Stroke) {
    match line[..] {
        [] => {}
        [only] => {
            painter.circle_filled(only, 0.5 * stroke.width, stroke.color);
        }
        _ => {
            painter.line(line, stroke);
        }
    }
}
