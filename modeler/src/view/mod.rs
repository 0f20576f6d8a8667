//! The model view: the picture, what lies over it, and the hand in it.

mod hand;
mod handles;
mod knobs;
mod lens;
mod overlay;
mod pictures;
mod selecting;
mod sides;
mod snapping;
pub(crate) mod suggestions;

#[cfg(test)]
pub use handles::colors as handle_colors;
pub use selecting::meant;

use crate::ground;
use crate::modeler::Modeler;
use crate::stage::{Line, Picture, Stage};
use crate::theme;
use egui::{CentralPanel, Color32, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo};
use glam::Vec2;
use sketch::gesture::Button;

/// What the view remembers from frame to frame.
#[derive(Default)]
pub struct ViewState {
    /// Its size, points.
    pub screen: Vec2,
    /// Its upper left corner in the window, points.
    pub(super) origin: Pos2,
    /// Whether the next solid is to be shown whole.
    pub shows_new: bool,
    /// Whether the window has its colours.
    pub is_dressed: bool,
    /// Whether a control had the keyboard in the last frame.
    pub had_focus: bool,
    /// Whether the user wants to quit, and nothing is lost by it.
    pub quits: bool,
    /// Whether the user wants panels at the sides of the view; none where the window's width decides.
    pub(crate) panels: Option<bool>,
    /// Where suggestions are shown.
    pub(super) suggests: suggestions::Place,
    /// The suggestions' buttons as they were shown last, in points of the view.
    pub(super) buttons: Vec<Button>,
    /// Around the named views, in points of the view.
    pub(super) sides: Option<Rect>,
    /// Pictures of the suggestions, as the screen has them.
    pub(super) pictures: pictures::Pictures,
    /// What the hand holds.
    pub(super) hold: hand::Hold,
    /// On what the dragged parts rest.
    pub(crate) guides: Vec<snapping::Guide>,
    /// Fingers that touch together.
    pub(super) fingers: Option<hand::Fingers>,
    /// The last tap: where, and which of the nodes there it selected.
    pub(super) tapped: Option<(Vec2, usize)>,
}

/// Shows the model and lets the hand at it.
pub fn show(modeler: &mut Modeler, ui: &mut Ui, stage: &mut dyn Stage) {
    CentralPanel::no_frame().show(ui, |ui| {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Model view"));
        modeler.view.screen = Vec2::new(rect.width().max(1.0), rect.height().max(1.0));
        modeler.view.origin = rect.min;
        hand::heed(modeler, ui, &response);
        point(modeler, &response);
        picture(modeler, ui, rect, stage);
        overlay::show(modeler, ui, &response);
        crate::lesson::show(modeler, ui, rect);
    });
}

/// Looks what is under the pointer, unless the hand is at work.
fn point(modeler: &mut Modeler, response: &Response) {
    let is_free = modeler.view.hold == hand::Hold::Nothing && modeler.pad.is_empty();
    let at = response.hover_pos().filter(|_| is_free).map(|at| in_view(at, response));
    let ray = at.map(|at| modeler.camera.view(modeler.view.screen).ray(at));
    let root = &modeler.bench.scene().root;
    modeler.pointing.at(root, ray.map(|ray| (ray.origin, ray.direction)));
}

/// The knobs: what they say, and where they are.
pub fn knobs(modeler: &Modeler) -> Vec<(String, Vec2)> {
    knobs::Knob::all(modeler).into_iter().map(|knob| (knob.text(), knob.at)).collect()
}

pub use knobs::primitive_at;

/// A place of the view on the screen.
fn on_screen(place: Vec2, response: &Response) -> Pos2 {
    response.rect.min + egui::vec2(place.x, place.y)
}

/// A place of the screen in the view.
fn in_view(place: Pos2, response: &Response) -> Vec2 {
    let from = place - response.rect.min;
    Vec2::new(from.x, from.y)
}

fn picture(modeler: &Modeler, ui: &Ui, rect: Rect, stage: &mut dyn Stage) {
    let dark = ui.visuals().dark_mode;
    let background = theme::background(dark);
    let scale = ui.ctx().pixels_per_point();
    let mut lines = ground::lines(&modeler.settings, dark);
    let (seams, shown) = modeler.seams();
    lines.extend(seams.iter().map(|line| {
        let [r, g, b, a] = line.color;
        Line { color: [r, g, b, (f32::from(a) * shown) as u8], ..*line }
    }));
    if !seams.is_empty() && shown < 1.0 {
        ui.ctx().request_repaint();
    }
    let picture = Picture {
        view: modeler.camera.view(modeler.view.screen),
        pixels: [rect.width(), rect.height()].map(|points| ((points * scale).round() as u32).clamp(1, 8192)),
        background,
        solid: modeler.solid(),
        look: modeler.settings.look,
        overhang: modeler.settings.shows_overhang.then_some(modeler.settings.overhang),
        lines: &lines,
    };
    match stage.show(&picture) {
        Some(texture) => {
            let whole = Rect::from_min_max(Pos2::ZERO, egui::pos2(1.0, 1.0));
            ui.painter().image(texture, rect, whole, Color32::WHITE);
        }
        None => {
            let [r, g, b] = background;
            ui.painter().rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
        }
    }
}
