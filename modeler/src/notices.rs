//! What the user is told: a few lines that go away by themselves, and warnings that stay until they are read.

use crate::theme::card_width;
use egui::{Align2, Area, Color32, Frame, Id, Label, Order, RichText, Ui};

/// How long a line stays, seconds.
const STAYS: f64 = 5.0;

/// The width at which a text goes on in a new line, points.
const WIDEST: f32 = 560.0;

/// Around a text, points.
const MARGINS: f32 = 40.0;

/// Most lines at a time.
const MOST: usize = 4;

/// Lines on the screen.
#[derive(Debug, Default)]
pub struct Notices {
    lines: Vec<Notice>,
}

#[derive(Debug)]
struct Notice {
    text: String,
    is_warning: bool,
    /// When it was first shown, seconds.
    since: Option<f64>,
}

impl Notices {
    /// Says something that need not be answered.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.add(text.into(), false);
    }

    /// Says something that the user must read.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.add(text.into(), true);
    }

    fn add(&mut self, text: String, is_warning: bool) {
        self.lines.retain(|line| line.text != text);
        self.lines.push(Notice { text, is_warning, since: None });
        if self.lines.len() > MOST {
            let oldest = self.lines.iter().position(|line| !line.is_warning).unwrap_or(0);
            self.lines.remove(oldest);
        }
    }

    /// The texts, the oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().map(|line| &*line.text)
    }

    /// Shows the lines at the bottom.
    pub fn show(&mut self, ui: &mut Ui) {
        let now = ui.input(|input| input.time);
        self.lines.retain_mut(|line| line.is_warning || now - *line.since.get_or_insert(now) < STAYS);
        if self.lines.is_empty() {
            return;
        }
        let mut read = None;
        let area = Area::new(Id::unique("notices")).order(Order::Foreground);
        area.anchor(Align2::CENTER_BOTTOM, [0.0, -36.0]).show(ui.ctx(), |ui| {
            for (i, line) in self.lines.iter().enumerate() {
                let fill =
                    if line.is_warning { Color32::from_rgb(150, 50, 40) } else { Color32::from_gray(50) };
                let frame = Frame::new().fill(fill).corner_radius(6.0).inner_margin(8.0).outer_margin(3.0);
                frame.show(ui, |ui| {
                    let room = ui.ctx().content_rect().width() - MARGINS;
                    ui.set_max_width(card_width(WIDEST, room));
                    ui.add(Label::new(RichText::new(&line.text).color(Color32::WHITE)).wrap());
                    if line.is_warning && ui.button("I see").clicked() {
                        read = Some(i);
                    }
                });
            }
        });
        if let Some(read) = read {
            self.lines.remove(read);
        }
        ui.ctx().request_repaint_after_secs(0.5);
    }
}
