//! What a sketch might become, to be chosen: a list that hides neither strokes nor the model.
//!
//! Beside the sketch, if there is room that nothing else needs; else above the parameters; and where no panels are,
//! in a strip below the view.

use super::knobs::{Knob, REACH};
use crate::expecting::{self, Expectations};
use crate::modeler::Modeler;
use egui::{
    Align2, Area, Button, Color32, CornerRadius, FontId, Id, Order, Pos2, Rect, Response, RichText,
    ScrollArea, Stroke, TextureHandle, Ui, pos2, vec2,
};
use glam::Vec2;
use sketch::suggest::Suggestion;

/// The size of a card in a list, points: large enough to be struck through.
const CARD: egui::Vec2 = vec2(168.0, 50.0);

/// The size of a card in a strip, points.
const SMALL_CARD: egui::Vec2 = vec2(84.0, 66.0);

/// The size of the picture on a card, points.
const PICTURE: egui::Vec2 = vec2(0.5 * expecting::PICTURE[0] as f32, 0.5 * expecting::PICTURE[1] as f32);

/// Between a sketch and its suggestions, points.
const GAP: f32 = 18.0;

/// Between suggestions, and between them and what else is in the view, points.
const NARROW_GAP: f32 = 4.0;

/// Corners of triangles that are looked at to learn where the model is on the screen.
const CORNERS: usize = 4000;

/// Where suggestions are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Place {
    /// In the view, with this upper left corner, points.
    Beside(Vec2),
    /// Outside of the view.
    #[default]
    Docked,
}

/// Finds where the suggestions of this frame are shown. Without panels there is a strip for them.
pub fn find_place(modeler: &mut Modeler, has_panels: bool) {
    if modeler.pad.expectations.is_none() {
        modeler.view.buttons.clear();
    }
    let size = |found: &Expectations| {
        let rows = found.suggestions.len().max(1) as f32;
        CARD * vec2(1.0, rows) + vec2(0.0, (rows - 1.0) * NARROW_GAP)
    };
    let found = modeler.pad.expectations.as_ref().filter(|_| has_panels).map(size);
    let place = found.and_then(|size| {
        let view = modeler.camera.view(modeler.view.screen);
        let strokes = around(modeler.pad.sketch().places().filter_map(|p| modeler.pad.shown(p, &view)))?;
        let corners = modeler.solid().map_or(&[][..], |solid| &solid.corners);
        let some = corners.iter().step_by((corners.len() / CORNERS).max(1));
        let model = around(some.filter_map(|corner| view.screen_from_model(corner.position.into())));
        let knobs = Knob::all(modeler)
            .into_iter()
            .map(|knob| Rect::from_center_size(pos2(knob.at.x, knob.at.y), vec2(2.0 * REACH, 4.0 * REACH)));
        let others: Vec<Rect> = knobs.chain(model).chain(modeler.view.sides).collect();
        let room = Rect::from_min_size(Pos2::ZERO, vec2(modeler.view.screen.x, modeler.view.screen.y));
        let right_first = !modeler.settings.left_handed;
        free_place(size, strokes, &others, room, right_first)
    });
    modeler.view.suggests = place.map_or(Place::Docked, |at| Place::Beside(Vec2::new(at.x, at.y)));
}

/// A box around places.
fn around(places: impl Iterator<Item = Vec2>) -> Option<Rect> {
    let mut all = Rect::NOTHING;
    places.for_each(|p| all.extend_with(pos2(p.x, p.y)));
    all.is_positive().then_some(all)
}

/// The upper left corner of a list of this size in the room, free of strokes and of others: the nearest to the strokes
/// on the preferred side, else on the other.
fn free_place(
    size: egui::Vec2,
    strokes: Rect,
    others: &[Rect],
    room: Rect,
    right_first: bool,
) -> Option<Pos2> {
    let room = room.shrink(NARROW_GAP);
    let kept = others.iter().map(|other| other.expand(NARROW_GAP));
    let kept: Vec<Rect> = kept.chain([strokes.expand2(vec2(GAP, NARROW_GAP))]).collect();
    let lowest = (room.bottom() - size.y).max(room.top());
    let levels = kept.iter().map(|other| other.bottom()).chain([strokes.top()]);
    let levels: Vec<f32> = levels.map(|y| y.clamp(room.top(), lowest)).collect();
    let free = |right: bool| {
        let xs = kept.iter().map(|other| if right { other.right() } else { other.left() - size.x });
        let places = xs.flat_map(|x| levels.iter().map(move |y| Rect::from_min_size(pos2(x, *y), size)));
        let is_beside = |list: &Rect| {
            let beside = if right { list.left() >= strokes.right() } else { list.right() <= strokes.left() };
            beside
                && room.contains_rect(*list)
                && !kept.iter().any(|other| other.shrink(0.1).intersects(*list))
        };
        let far = |list: &Rect| {
            let across = if right { list.left() - strokes.right() } else { strokes.left() - list.right() };
            across + (list.top() - strokes.top()).abs()
        };
        places.filter(is_beside).min_by(|a, b| far(a).total_cmp(&far(b))).map(|list| list.min)
    };
    free(right_first).or_else(|| free(!right_first))
}

/// Shows them in the view, if that is their place.
pub fn beside(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let Place::Beside(at) = modeler.view.suggests else { return };
    let at = super::on_screen(at, response);
    let area = Area::new(Id::unique("suggestions")).order(Order::Middle).fixed_pos(at);
    area.show(ui.ctx(), |ui| list(modeler, ui));
}

/// Whether there are some to be shown outside of the view.
pub fn are_docked(modeler: &Modeler) -> bool {
    modeler.view.suggests == Place::Docked && modeler.pad.expectations.is_some()
}

/// Shows them above what is in a panel, if that is their place.
pub fn above(modeler: &mut Modeler, ui: &mut Ui) {
    if are_docked(modeler) {
        list(modeler, ui);
        ui.separator();
    }
}

/// The height of the strip, points.
pub fn strip_height(ui: &Ui) -> f32 {
    SMALL_CARD.y + 2.0 * NARROW_GAP + ui.spacing().scroll.allocated_width()
}

/// Shows them in a strip that is always there.
pub fn strip(modeler: &mut Modeler, ui: &mut Ui) {
    let Some(found) = modeler.pad.expectations.clone() else {
        ui.weak("What a sketch may become shows here.");
        return;
    };
    ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
        ui.horizontal(|ui| {
            if let Some(text) = missing(&found) {
                ui.label(RichText::new(text).color(ui.visuals().strong_text_color()));
            }
            choices(modeler, ui, &found, small_card);
        });
    });
}

/// One below the other.
fn list(modeler: &mut Modeler, ui: &mut Ui) {
    let Some(found) = modeler.pad.expectations.clone() else { return };
    ui.spacing_mut().item_spacing.y = NARROW_GAP;
    if let Some(text) = missing(&found) {
        egui::Frame::popup(ui.style()).inner_margin(8.0).show(ui, |ui| {
            ui.set_max_width(CARD.x);
            ui.label(RichText::new(text).color(ui.visuals().strong_text_color()));
        });
    }
    choices(modeler, ui, &found, card);
}

/// Why there is nothing to choose.
fn missing(found: &Expectations) -> Option<String> {
    let reason = found.no_outline.as_ref().filter(|_| found.suggestions.is_empty())?;
    Some(format!("No solid of it yet: {reason}."))
}

/// How a card is shown.
type Card = fn(&mut Ui, &Suggestion, Option<&TextureHandle>) -> Response;

/// All cards, each to be tapped or struck through.
fn choices(modeler: &mut Modeler, ui: &mut Ui, found: &Expectations, card: Card) {
    let (mut chosen, mut buttons) = (None, Vec::new());
    for (i, suggestion) in found.suggestions.iter().enumerate() {
        let image = found.pictures.get(i).and_then(Option::as_ref);
        let picture = modeler.view.pictures.get(ui.ctx(), found.version, i, image);
        let button = card(ui, suggestion, picture.as_ref());
        let rect = button.rect.intersect(ui.clip_rect()).translate(-modeler.view.origin.to_vec2());
        buttons.push(sketch::gesture::Button {
            min: Vec2::new(rect.min.x, rect.min.y),
            max: Vec2::new(rect.max.x, rect.max.y),
        });
        if button.clicked() {
            chosen = Some(i);
        }
    }
    modeler.view.buttons = buttons;
    if let Some(chosen) = chosen {
        modeler.choose(chosen);
    }
}

/// Its colour at the edge, the picture of what would come of it, and its name.
fn card(ui: &mut Ui, suggestion: &Suggestion, picture: Option<&TextureHandle>) -> Response {
    let (response, edge) = blank(ui, suggestion, CARD);
    let (painter, rect) = (ui.painter(), response.rect);
    let side = Rect::from_min_size(rect.min, vec2(7.0, rect.height()));
    painter.rect_filled(side, CornerRadius { nw: 3, sw: 3, ne: 0, se: 0 }, edge);
    let frame = Rect::from_center_size(rect.left_center() + vec2(12.0 + 0.5 * PICTURE.x, 0.0), PICTURE);
    paint_picture(ui, frame, picture);
    let at = pos2(frame.right() + 8.0, rect.center().y);
    let color = ui.visuals().strong_text_color();
    painter.text(at, Align2::LEFT_CENTER, suggestion.name, FontId::proportional(15.0), color);
    response
}

/// The same, with the name below the picture.
fn small_card(ui: &mut Ui, suggestion: &Suggestion, picture: Option<&TextureHandle>) -> Response {
    let (response, edge) = blank(ui, suggestion, SMALL_CARD);
    let (painter, rect) = (ui.painter(), response.rect);
    let side = Rect::from_min_size(rect.min, vec2(rect.width(), 5.0));
    painter.rect_filled(side, CornerRadius { nw: 3, ne: 3, sw: 0, se: 0 }, edge);
    let frame = Rect::from_center_size(rect.center_top() + vec2(0.0, 5.0 + 0.5 * PICTURE.y), PICTURE);
    paint_picture(ui, frame, picture);
    let at = rect.center_bottom() - vec2(0.0, 2.0);
    let color = ui.visuals().strong_text_color();
    painter.text(at, Align2::CENTER_BOTTOM, suggestion.name, FontId::proportional(13.0), color);
    response
}

/// A card with nothing on it, and the colour of its edge.
fn blank(ui: &mut Ui, suggestion: &Suggestion, size: egui::Vec2) -> (Response, Color32) {
    let [r, g, b] = suggestion.color.0;
    let edge = Color32::from_rgb(r, g, b);
    let button = Button::new("").fill(ui.visuals().window_fill).min_size(size);
    let response = ui.add(button.stroke(Stroke::new(1.5, edge))).on_hover_text(suggestion.sentence);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, suggestion.name));
    (response, edge)
}

fn paint_picture(ui: &Ui, frame: Rect, picture: Option<&TextureHandle>) {
    if let Some(picture) = picture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        ui.painter().image(picture.id(), frame, whole, Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: egui::Vec2 = vec2(168.0, 158.0);

    fn rect(min: [f32; 2], max: [f32; 2]) -> Rect {
        Rect::from_min_max(min.into(), max.into())
    }

    #[test]
    fn a_list_stands_where_it_hides_nothing_or_nowhere() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut found = 0;
        for case in 0..2000 {
            let room = rect([0.0; 2], [random.f32() * 1500.0 + 200.0, random.f32() * 900.0 + 200.0]);
            let mut within = || {
                let mut place = || pos2(random.f32() * room.right(), random.f32() * room.bottom());
                Rect::from_two_pos(place(), place())
            };
            let (strokes, others) = (within(), [within(), within()]);
            let Some(at) = free_place(LIST, strokes, &others, room, case % 2 == 0) else { continue };
            found += 1;
            let list = Rect::from_min_size(at, LIST);
            let hides = others.iter().chain([&strokes]).any(|other| other.intersects(list));
            assert!(room.contains_rect(list) && !hides, "case {case}: {list:?} in {room:?}");
        }
        assert!(found > 300, "{found}");
    }

    #[test]
    fn a_list_stands_close_to_the_strokes_on_the_side_of_the_hand() {
        let room = rect([0.0; 2], [800.0, 600.0]);
        let strokes = rect([300.0, 200.0], [500.0, 400.0]);
        let right = free_place(LIST, strokes, &[], room, true);
        assert_eq!(right, Some(pos2(500.0 + GAP, 200.0)));
        let left = free_place(LIST, strokes, &[], room, false);
        assert_eq!(left, Some(pos2(300.0 - GAP - LIST.x, 200.0)));
        // What is in the way on the right leaves the left.
        let model = rect([400.0, 100.0], [700.0, 500.0]);
        let beside = free_place(LIST, strokes, &[model], room, true);
        assert_eq!(beside, Some(pos2(300.0 - GAP - LIST.x, 200.0)));
        // Named views in the corner push it down.
        let sides = rect([600.0, 0.0], [800.0, 240.0]);
        let below = free_place(LIST, strokes, &[sides], room, true);
        assert_eq!(below, Some(pos2(500.0 + GAP, 240.0 + NARROW_GAP)));
        assert_eq!(free_place(LIST, rect([100.0, 100.0], [700.0, 500.0]), &[], room, true), None);
    }
}
