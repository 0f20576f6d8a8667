//! Choosing a colour: a palette to tap, and sliders for all others.

use blobtree::STONE;
use egui::ecolor::Hsva;
use egui::{
    Color32, Id, Popup, PopupCloseBehavior, Response, Role, Sense, Slider, Stroke, StrokeKind, Ui, vec2,
};

/// Hues of the palette, and where they are on the circle of hues, degrees.
const HUES: [(&str, f32); 8] = [
    ("red", 2.0),
    ("orange", 28.0),
    ("yellow", 50.0),
    ("green", 110.0),
    ("teal", 175.0),
    ("blue", 212.0),
    ("violet", 270.0),
    ("pink", 330.0),
];

/// Tones of each hue: what is said before its name, saturation and brightness.
const TONES: [(&str, f32, f32); 3] = [("light ", 0.4, 0.95), ("", 0.75, 0.85), ("dark ", 0.8, 0.5)];

/// What has no hue, or a shy one.
const PLAIN: [(&str, [u8; 3]); 8] = [
    ("white", [250, 250, 250]),
    ("silver", [190, 193, 198]),
    ("grey", [125, 128, 132]),
    ("dark grey", [70, 72, 76]),
    ("black", [28, 28, 30]),
    ("stone", STONE.0),
    ("sand", [222, 190, 140]),
    ("brown", [120, 78, 48]),
];

/// The size of a colour in the palette, points: large enough for a pen.
const SWATCH: egui::Vec2 = vec2(26.0, 22.0);

/// The size of the button, points.
const BUTTON: egui::Vec2 = vec2(40.0, 20.0);

/// A button that opens the palette; another colour if the hand, or the keyboard, goes to one.
pub fn choose(ui: &mut Ui, label: Id, color: [u8; 3]) -> Option<[u8; 3]> {
    let button = swatch(ui, color, BUTTON, "Colour").labelled_by(label);
    let mut chosen = None;
    Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        chosen = palette(ui, color).or_else(|| sliders(ui, color));
    });
    chosen.filter(|chosen| *chosen != color)
}

fn palette(ui: &mut Ui, now: [u8; 3]) -> Option<[u8; 3]> {
    let mut chosen = None;
    let mut offer = |ui: &mut Ui, name: &str, color: [u8; 3]| {
        let swatch = swatch(ui, color, SWATCH, name);
        if color == now {
            let ink = ui.visuals().strong_text_color();
            ui.painter().rect_stroke(swatch.rect, 3.0, Stroke::new(2.0, ink), StrokeKind::Outside);
        }
        if swatch.on_hover_text(name).clicked() {
            chosen = Some(color);
        }
    };
    egui::Grid::new("palette").spacing([4.0, 4.0]).show(ui, |ui| {
        for (tone, saturation, brightness) in TONES {
            for (hue, degrees) in HUES {
                let color = Hsva::new(degrees / 360.0, saturation, brightness, 1.0).to_srgb();
                offer(ui, &format!("{tone}{hue}"), color);
            }
            ui.end_row();
        }
        PLAIN.iter().for_each(|(name, color)| offer(ui, name, *color));
    });
    chosen
}

fn sliders(ui: &mut Ui, now: [u8; 3]) -> Option<[u8; 3]> {
    // Grey has no hue of its own: the last one is remembered.
    let id = ui.scope_id().with("hue");
    let known = ui.data(|data| data.get_temp::<Hsva>(id)).filter(|known| known.to_srgb() == now);
    let mut color = known.unwrap_or_else(|| Hsva::from_srgb(now));
    let mut changed = false;
    egui::Grid::new("sliders").num_columns(2).show(ui, |ui| {
        let parts = [
            ("Hue", &mut color.h, 360.0, "°"),
            ("Saturation", &mut color.s, 100.0, " %"),
            ("Brightness", &mut color.v, 100.0, " %"),
        ];
        for (name, part, most, unit) in parts {
            let label = ui.label(name);
            let mut number = *part * most;
            let slider = Slider::new(&mut number, 0.0..=most).fixed_decimals(0).suffix(unit);
            if ui.add(slider).labelled_by(label.id).changed() {
                (*part, changed) = (number / most, true);
            }
            ui.end_row();
        }
    });
    if changed {
        ui.data_mut(|data| data.insert_temp(id, color));
    }
    changed.then(|| color.to_srgb())
}

/// A button that is a colour.
fn swatch(ui: &mut Ui, [r, g, b]: [u8; 3], size: egui::Vec2, name: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Button, true, name));
    let edge = ui.style().interact(&response).fg_stroke.color.gamma_multiply(0.5);
    ui.painter().rect(rect, 3.0, Color32::from_rgb(r, g, b), Stroke::new(1.0, edge), StrokeKind::Inside);
    response
}
