//! The named views, in the corner of the hand that draws.

use crate::camera::Side;
use crate::modeler::Modeler;
use egui::{Align2, Area, Button, Id, Order, Response, Ui, vec2};

/// Views narrower or lower than this have one button, which opens to all sides, points.
const ROOMY: egui::Vec2 = vec2(480.0, 340.0);

/// The size of a button, points.
const BUTTON: egui::Vec2 = vec2(54.0, 22.0);

/// Shows them.
pub fn show(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let (pivot, corner) = if modeler.settings.left_handed {
        (Align2::LEFT_TOP, response.rect.left_top() + vec2(8.0, 8.0))
    } else {
        (Align2::RIGHT_TOP, response.rect.right_top() + vec2(-8.0, 8.0))
    };
    let area = Area::new(Id::unique("views")).order(Order::Middle).pivot(pivot).fixed_pos(corner);
    let is_roomy = response.rect.width() >= ROOMY.x && response.rect.height() >= ROOMY.y;
    let shown = area.show(ui.ctx(), |ui| {
        if is_roomy {
            egui::Frame::popup(ui.style()).inner_margin(4.0).show(ui, |ui| all(modeler, ui));
        } else {
            ui.menu_button("Look from", |ui| all(modeler, ui));
        }
    });
    modeler.view.sides = Some(shown.response.rect.translate(-response.rect.min.to_vec2()));
}

fn all(modeler: &mut Modeler, ui: &mut Ui) {
    egui::Grid::new("sides").spacing([3.0, 3.0]).show(ui, |ui| {
        let rows: [&[Side]; 3] = [
            &[Side::Left, Side::Top, Side::Right],
            &[Side::Front, Side::Corner, Side::Back],
            &[Side::Bottom],
        ];
        for row in rows {
            for &side in row {
                if ui.add(Button::new(side.name()).min_size(BUTTON)).clicked() {
                    modeler.look_from(side);
                }
            }
            if row.len() == 1 {
                if ui.button("See all").on_hover_text("See everything (F)").clicked() {
                    let bounds = modeler.bounds();
                    modeler.camera.show(bounds);
                }
                let mut flat = !modeler.camera.perspective;
                if ui.checkbox(&mut flat, "Flat").on_hover_text("Far things as large as near ones").changed()
                {
                    modeler.camera.perspective = !flat;
                }
            }
            ui.end_row();
        }
    });
}
