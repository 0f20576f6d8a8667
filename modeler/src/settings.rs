//! How the user likes to work.

use crate::desk::ExportOptions;
use crate::stage::Look;
use egui::{Context, ThemePreference};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// What the pen does on the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Draws; a tap selects.
    #[default]
    Draw,
    /// Selects several parts: each that is tapped, and all that are struck through.
    Select,
    /// Rubs out strokes.
    Erase,
    /// Turns the model; for pens without buttons.
    Turn,
    /// Moves the view.
    Pan,
}

impl Tool {
    /// All, in the order of the bar.
    pub const ALL: [Self; 5] = [Self::Draw, Self::Select, Self::Erase, Self::Turn, Self::Pan];

    /// The name on the button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draw => "Draw",
            Self::Select => "Select",
            Self::Erase => "Erase",
            Self::Turn => "Turn",
            Self::Pan => "Move view",
        }
    }

    /// What it does.
    pub fn help(self) -> &'static str {
        match self {
            Self::Draw => "Draw with the pen; tap a part to select it (D)",
            Self::Select => {
                "Tap parts, or strike through them, to select several (S); Shift and Ctrl always do"
            }
            Self::Erase => "Rub out strokes (E)",
            Self::Turn => "Turn the model by dragging; the right mouse button always does (T)",
            Self::Pan => "Move the view by dragging; the middle mouse button always does (V)",
        }
    }

    /// Its key.
    pub fn key(self) -> egui::Key {
        match self {
            Self::Draw => egui::Key::D,
            Self::Select => egui::Key::S,
            Self::Erase => egui::Key::E,
            Self::Turn => egui::Key::T,
            Self::Pan => egui::Key::V,
        }
    }
}

/// Which buttons turn and move the view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Habit {
    /// As in slicers: the right button turns, the middle one moves.
    #[default]
    Slicer,
    /// As in Blender: the middle button turns, with Shift it moves.
    Blender,
    /// As in Tinkercad: the right button turns, with Shift or the middle one it moves.
    Tinkercad,
}

impl Habit {
    /// All, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Slicer, Self::Blender, Self::Tinkercad];

    /// The name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slicer => "Like slicers",
            Self::Blender => "Like Blender",
            Self::Tinkercad => "Like Tinkercad",
        }
    }

    /// What a drag with a mouse button does to the view, if anything.
    pub fn drag(self, button: egui::PointerButton, shift: bool) -> Option<Tool> {
        use egui::PointerButton::{Middle, Secondary};
        match (self, button) {
            (Self::Slicer, Secondary) => Some(Tool::Turn),
            (Self::Slicer, Middle) => Some(Tool::Pan),
            (Self::Blender, Middle) => Some(if shift { Tool::Pan } else { Tool::Turn }),
            (Self::Blender, Secondary) => Some(Tool::Pan),
            (Self::Tinkercad, Secondary) => Some(if shift { Tool::Pan } else { Tool::Turn }),
            (Self::Tinkercad, Middle) => Some(Tool::Pan),
            _ => None,
        }
    }
}

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

impl Theme {
    /// All, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::System, Self::Light, Self::Dark];

    /// The name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::System => "As the system",
            Self::Light => "Light",
            Self::Dark => "Dark",
        }
    }

    fn preference(self) -> ThemePreference {
        match self {
            Self::System => ThemePreference::System,
            Self::Light => ThemePreference::Light,
            Self::Dark => ThemePreference::Dark,
        }
    }
}

/// How large everything may be, times its usual size.
pub const SCALES: RangeInclusive<f32> = 0.6..=2.5;

/// What may be tinted, degrees from the vertical.
pub const OVERHANGS: RangeInclusive<f32> = 20.0..=70.0;

/// All that is not part of the document. It is kept from one start to the next, but for the tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What the pen does.
    #[serde(skip)]
    pub tool: Tool,
    /// Which buttons turn and move the view.
    pub habit: Habit,
    /// How the model is drawn.
    pub look: Look,
    /// Whether what leans out too far is tinted.
    pub shows_overhang: bool,
    /// From where on it is tinted, degrees from the vertical.
    pub overhang: f32,
    /// Whether lines on the model show where parts meet.
    pub shows_seams: bool,
    /// Whether the ground is shown.
    pub shows_ground: bool,
    /// The printer's room, mm.
    pub room: [f32; 3],
    /// Whether what is dragged comes to rest on the bed, the middle and whole steps.
    pub snaps: bool,
    /// Whether the tree is on the right and the parameters are on the left.
    pub left_handed: bool,
    /// Light or dark.
    pub theme: Theme,
    /// How large everything is, times its usual size.
    pub scale: f32,
    /// How meshes are written.
    pub export: ExportOptions,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tool: Tool::Draw,
            habit: Habit::Slicer,
            look: Look::Shaded,
            shows_overhang: false,
            overhang: 45.0,
            shows_seams: true,
            shows_ground: true,
            room: [220.0, 220.0, 250.0],
            snaps: true,
            left_handed: false,
            theme: Theme::System,
            scale: 1.0,
            export: ExportOptions::default(),
        }
    }
}

impl Settings {
    /// Those with every number in its range.
    pub(crate) fn in_range(self) -> Self {
        let within = |value: f32, range: &RangeInclusive<f32>| value.clamp(*range.start(), *range.end());
        let export = ExportOptions {
            cell_mm: self.export.cell_mm.map(|cell| within(cell, &ExportOptions::CELLS)),
            tolerance_mm: within(self.export.tolerance_mm, &ExportOptions::TOLERANCES),
            ..self.export
        };
        Self {
            overhang: within(self.overhang, &OVERHANGS),
            room: self.room.map(|side| side.clamp(10.0, 2000.0)),
            scale: within(self.scale, &SCALES),
            export,
            ..self
        }
    }

    /// Has everything look as they say.
    pub(crate) fn dress(&self, ctx: &Context) {
        ctx.set_theme(self.theme.preference());
        ctx.set_zoom_factor(self.scale);
    }
}
