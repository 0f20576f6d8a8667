//! Colours in light and dark, and room for words, so that everything can be read.

use egui::{Color32, Context, Theme, Visuals};

/// How the window looks: egui's own looks, with weak texts and warnings strong enough to be read.
fn visuals(theme: Theme) -> Visuals {
    let (weak, warning) = match theme {
        Theme::Dark => (Color32::from_gray(160), Color32::from_rgb(255, 150, 40)),
        Theme::Light => (Color32::from_gray(95), Color32::from_rgb(170, 60, 0)),
    };
    let own = theme.default_visuals();
    Visuals { weak_text_color: Some(weak), warn_fg_color: warning, ..own }
}

/// Dresses the window.
pub fn dress(ctx: &Context) {
    for theme in [Theme::Light, Theme::Dark] {
        ctx.set_visuals_of(theme, visuals(theme));
    }
}

/// The colour of what is selected, in the view.
pub fn selected(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(240, 170, 40) } else { Color32::from_rgb(176, 104, 0) }
}

/// The colour of what is pointed at, in the view and in the tree.
pub fn pointed(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(100, 160, 240) } else { Color32::from_rgb(30, 100, 200) }
}

/// Behind the model.
pub fn background(dark: bool) -> [u8; 3] {
    if dark { [34, 36, 40] } else { [236, 238, 241] }
}

/// How wide a card is that would like to be so wide where there is so much room, points: never so narrow that no word fits,
/// even if the window is.
pub(crate) fn card_width(liked: f32, room: f32) -> f32 {
    liked.min(room).max(100.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::handle_colors;

    /// The contrast of two colours as WCAG 2 has it: 1 for the same, 21 for black on white.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let light = |color: Color32| {
            let linear = |c: u8| {
                let c = f32::from(c) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b()) + 0.05
        };
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn texts_can_be_read_in_light_and_dark() {
        for theme in [Theme::Light, Theme::Dark] {
            let look = visuals(theme);
            let grounds = [look.panel_fill, look.window_fill, look.extreme_bg_color, look.faint_bg_color];
            for (what, text) in [
                ("text", look.text_color()),
                ("weak", look.weak_text_color()),
                ("strong", look.strong_text_color()),
                ("warning", look.warn_fg_color),
            ] {
                for ground in grounds.iter().filter(|ground| ground.a() == 255) {
                    let contrast = contrast(text, *ground);
                    assert!(contrast >= 4.5, "{theme:?}: {what} has {contrast} on {ground:?}");
                }
            }
            let chosen = contrast(look.selection.stroke.color, look.selection.bg_fill);
            assert!(chosen >= 4.5, "{theme:?}: what is chosen has {chosen}");
            for widget in [look.widgets.inactive, look.widgets.hovered, look.widgets.active] {
                let contrast = contrast(widget.fg_stroke.color, widget.weak_bg_fill);
                assert!(contrast >= 4.5, "{theme:?}: a button has {contrast}");
            }
        }
    }

    #[test]
    fn what_can_be_held_in_the_view_stands_out_in_light_and_dark() {
        for dark in [false, true] {
            let [r, g, b] = background(dark);
            let ground = Color32::from_rgb(r, g, b);
            for color in handle_colors(dark).into_iter().chain([selected(dark), pointed(dark)]) {
                let contrast = contrast(color, ground);
                assert!(contrast >= 3.0, "dark {dark}: {color:?} has {contrast}");
            }
        }
    }
}
