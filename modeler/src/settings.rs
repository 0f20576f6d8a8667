//! How the user likes to work.

use crate::desk::ExportOptions;
use crate::stage::Look;

/// What the pen does on the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Draws; a tap selects.
    #[default]
    Draw,
    /// Rubs out strokes.
    Erase,
    /// Turns the model; for pens without buttons.
    Turn,
    /// Moves the view.
    Pan,
}

impl Tool {
    /// All, in the order of the bar.
    pub const ALL: [Self; 4] = [Self::Draw, Self::Erase, Self::Turn, Self::Pan];

    /// The name on the button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draw => "Draw",
            Self::Erase => "Erase",
            Self::Turn => "Turn",
            Self::Pan => "Move view",
        }
    }

    /// What it does.
    pub fn help(self) -> &'static str {
        match self {
            Self::Draw => "Draw with the pen; tap a part to select it (D)",
            Self::Erase => "Rub out strokes (E)",
            Self::Turn => "Turn the model by dragging; the right mouse button always does (T)",
            Self::Pan => "Move the view by dragging; the middle mouse button always does (V)",
        }
    }

    /// Its key.
    pub fn key(self) -> egui::Key {
        match self {
            Self::Draw => egui::Key::D,
            Self::Erase => egui::Key::E,
            Self::Turn => egui::Key::T,
            Self::Pan => egui::Key::V,
        }
    }
}

/// Which buttons turn and move the view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

/// All that is not part of the document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What the pen does.
    pub tool: Tool,
    /// Which buttons turn and move the view.
    pub habit: Habit,
    /// How the model is drawn.
    pub look: Look,
    /// Whether what leans out too far is tinted.
    pub shows_overhang: bool,
    /// From where on it is tinted, degrees from the vertical.
    pub overhang: f32,
    /// Whether the ground is shown.
    pub shows_ground: bool,
    /// The printer's room, mm.
    pub room: [f32; 3],
    /// Whether the tree is on the right and the parameters are on the left.
    pub left_handed: bool,
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
            shows_ground: true,
            room: [220.0, 220.0, 250.0],
            left_handed: false,
            export: ExportOptions::default(),
        }
    }
}
