//! The field lens in the view: its picture where its plane is, and the card that tells of the place under the pen.

use super::hand::Hold;
use super::{in_view, on_screen};
use crate::lens::{Explained, Facing, Lens};
use crate::modeler::Modeler;
use crate::theme::card_width;
use blobtree::{FieldPicture, ISO};
use egui::epaint::{Mesh, Vertex};
use egui::{
    Align, Align2, Area, Color32, DragValue, Frame, Id, Layout, Order, Painter, Response, RichText, Sense,
    Stroke, TextureHandle, Ui, pos2, vec2,
};
use glam::{Vec2, Vec3};
use sketch::suggest::View;

/// The picture is drawn in so many pieces along each side, as nearer ones are larger.
const PIECES: usize = 24;

/// The model shows a little through the picture.
const GLASS: Color32 = Color32::from_rgba_premultiplied(215, 215, 215, 215);

/// Smaller values read as 0.
const FELT: f32 = 0.005;

/// The most lines of a card.
const MOST_LINES: usize = 12;

/// The width of the card, and of a whole share's bar in it, points.
const WIDTH: f32 = 250.0;
const BAR: f32 = 48.0;

/// Shows the lens, if there is one.
pub fn show(modeler: &mut Modeler, ui: &Ui, view: &View, response: &Response) {
    let root = modeler.bench.shown().root.clone();
    let is_free = modeler.pad.is_empty() && matches!(modeler.view.hold, Hold::Nothing);
    let Some(lens) = &mut modeler.lens else { return };
    let painter = ui.painter_at(response.rect);
    let framed = lens.framed().cloned();
    if let (Some(framed), Some(texture)) = (&framed, lens.texture(ui.ctx())) {
        paint(&painter, framed, &texture, view, response);
        let pointer = response.hover_pos().filter(|_| is_free);
        let place = pointer.and_then(|at| place_at(framed, view, in_view(at, response)));
        lens.point_at(&root, place);
    }
    card(modeler, ui, response);
}

/// Where a place of the view is in the plane, if the picture shows it, mm.
fn place_at(framed: &FieldPicture, view: &View, at: Vec2) -> Option<Vec3> {
    let ray = view.ray(at);
    let across = framed.plane.axes()[2];
    let t = (framed.plane.origin - ray.origin).dot(across) / ray.direction.dot(across);
    let place = ray.origin + ray.direction * t;
    let (seen, _) = framed.plane.project(place);
    let within = (seen - framed.low) / framed.pixel;
    let [width, height] = framed.size.map(|n| n as f32);
    let is_seen = t.is_finite() && (0.0..=width).contains(&within.x) && (0.0..=height).contains(&within.y);
    is_seen.then_some(place)
}

fn paint(
    painter: &Painter,
    framed: &FieldPicture,
    texture: &TextureHandle,
    view: &View,
    response: &Response,
) {
    let [low_left, low_right, _, high_left] = framed.corners();
    let mut mesh = Mesh::with_texture(texture.id());
    for row in 0..=PIECES {
        for column in 0..=PIECES {
            let [u, v] = [column, row].map(|n| n as f32 / PIECES as f32);
            let place = low_left + (low_right - low_left) * u + (high_left - low_left) * v;
            let Some(at) = view.screen_from_model(place) else { return };
            mesh.vertices.push(Vertex { pos: on_screen(at, response), uv: pos2(u, 1.0 - v), color: GLASS });
        }
    }
    let number = |row: usize, column: usize| (row * (PIECES + 1) + column) as u32;
    for row in 0..PIECES {
        for column in 0..PIECES {
            let [a, b] = [number(row, column), number(row, column + 1)];
            let [c, d] = [number(row + 1, column + 1), number(row + 1, column)];
            mesh.add_triangle(a, b, c);
            mesh.add_triangle(a, c, d);
        }
    }
    let rim = [number(0, 0), number(0, PIECES), number(PIECES, PIECES), number(PIECES, 0), number(0, 0)];
    let rim = rim.map(|n| mesh.vertices[n as usize].pos).to_vec();
    painter.add(mesh);
    painter.line(rim, Stroke::new(1.0, Color32::from_gray(90)));
}

/// What the lens says, in the corner towards the parameters, away from the hand.
fn card(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let bounds = modeler.bounds();
    let (pivot, corner) = if modeler.settings.left_handed {
        (Align2::LEFT_BOTTOM, response.rect.left_bottom() + vec2(12.0, -12.0))
    } else {
        (Align2::RIGHT_BOTTOM, response.rect.right_bottom() + vec2(-12.0, -12.0))
    };
    let Some(lens) = &mut modeler.lens else { return };
    let mut closes = false;
    let area = Area::new(Id::unique("lens")).order(Order::Middle).pivot(pivot).fixed_pos(corner);
    area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.set_width(card_width(WIDTH, response.rect.width() - 50.0));
            ui.horizontal(|ui| {
                ui.strong("Field lens");
                let end = Layout::right_to_left(Align::Center);
                closes = ui.with_layout(end, |ui| ui.button("Close").clicked()).inner;
            });
            ui.horizontal(|ui| {
                for facing in Facing::ALL {
                    if ui.selectable_label(lens.facing == facing, facing.name()).clicked() {
                        (lens.facing, lens.at) = (facing, None);
                    }
                }
                let mut at = lens.at_in(bounds);
                let axis = ["x", "y", "z"][lens.facing.axis()];
                let label = ui.label(axis);
                let drag = DragValue::new(&mut at).speed(0.1).max_decimals(1).suffix(" mm");
                if ui.add(drag).labelled_by(label.id).changed() {
                    lens.at = Some(at);
                }
            });
            tell(ui, lens);
        });
    });
    if closes {
        modeler.lens = None;
    }
}

fn tell(ui: &mut Ui, lens: &Lens) {
    let Some(told) = lens.explained() else {
        ui.weak(
            "The bold line is the surface, where the field is 0.5. Point at a place to see what makes it.",
        );
        return;
    };
    ui.label(RichText::new(sentence(told)).size(14.0));
    if told.value < FELT {
        return;
    }
    for share in told.shares.iter().take(MOST_LINES) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.add_space(12.0 * share.depth.min(6) as f32);
            let (bar, _) = ui.allocate_exact_size(vec2(BAR, 10.0), Sense::hover());
            ui.painter().rect_filled(bar, 2.0, ui.visuals().extreme_bg_color);
            let mut full = bar;
            full.set_width(BAR * share.share);
            ui.painter().rect_filled(full, 2.0, Color32::from_rgb(47, 125, 225));
            ui.label(&share.title);
            ui.weak(format!("{:.2}", share.value));
        });
        if let Some(rule) = share.rule {
            ui.horizontal(|ui| {
                ui.add_space(12.0 * share.depth.min(6) as f32);
                ui.weak(RichText::new(rule).small());
            });
        }
    }
    if told.shares.len() > MOST_LINES {
        ui.weak(format!("and {} more", told.shares.len() - MOST_LINES));
    }
}

/// The value at a place in words.
fn sentence(told: &Explained) -> String {
    let place = match told.value {
        v if v < FELT => "nothing reaches here",
        v if v < ISO => "outside",
        _ => "inside",
    };
    format!("{:.2} here: {place}.", told.value)
}
