//! What the hand does in the view: drawing, selecting, turning, moving.

use super::handles::Handle;
use super::knobs::{self, Knob, Turns};
use super::{in_view, on_screen};
use super::{selecting, snapping};
use crate::modeler::Modeler;
use crate::pad::Around;
use crate::settings::Tool;
use crate::trace::Wait;
use egui::{Event, PointerButton, Response, Ui};
use glam::Vec2;
use sketch::stroke::PenSample;

/// A press that moves less than this is a tap, points.
const TAP: f32 = 4.0;

/// How much a notch of the wheel enlarges, as a power of the scrolled points.
const WHEEL: f32 = 0.0025;

/// What the hand holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// Nothing.
    #[default]
    Nothing,
    /// The pen on the paper.
    Pen,
    /// The model.
    View(Tool),
    /// A handle of the selected nodes, taken at a place of the view.
    Handle(Handle, Vec2),
    /// A knob, taken at a place of the view, and its number then.
    Knob(Turns, Vec2, f32),
}

/// Does what the hand does.
pub fn heed(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    if modeler.pen.is_cancelled() {
        modeler.pad.drop_current();
        (modeler.view.hold, modeler.view.fingers) = (Hold::Nothing, None);
    }
    fingers(modeler, ui, response);
    wheel(modeler, ui, response);
    press(modeler, ui, response);
    match modeler.view.hold {
        Hold::Nothing => {}
        Hold::Pen => pen(modeler, ui, response),
        Hold::View(tool) => drag(modeler, tool, ui.input(|input| input.pointer.delta())),
        Hold::Handle(handle, from) => handle_dragged(modeler, ui, response, handle, from),
        Hold::Knob(turns, from, start) => knob_dragged(modeler, ui, response, turns, from, start),
    }
    if !ui.input(|input| input.pointer.any_down()) {
        modeler.view.hold = Hold::Nothing;
        modeler.view.guides.clear();
    }
}

/// Fingers that touch together: how many at most, since when, and how far they have moved, points.
#[derive(Clone, Copy, Debug)]
pub struct Fingers {
    most: usize,
    since: f64,
    moved: f32,
}

/// A tap of several fingers is shorter than this, seconds.
const TAP_SECONDS: f64 = 0.35;

/// Two fingers move and size the view, and turn nothing into a stroke. A tap of two undoes, one of three does again.
fn fingers(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let (touch, now) = ui.input(|input| (input.multi_touch(), input.time));
    let Some(touch) = touch else {
        if let Some(tap) = modeler.view.fingers.take()
            && now - tap.since < TAP_SECONDS
            && tap.moved < 3.0 * TAP
        {
            if tap.most == 2 { modeler.undo() } else { modeler.redo() }
        }
        return;
    };
    if response.rect.contains(touch.center_pos) {
        let fingers = modeler.view.fingers.get_or_insert(Fingers { most: 0, since: now, moved: 0.0 });
        fingers.most = fingers.most.max(touch.num_touches);
        fingers.moved += touch.translation_delta.length() + 100.0 * (touch.zoom_delta - 1.0).abs();
    }
    if !response.rect.contains(touch.center_pos) {
        return;
    }
    modeler.pad.drop_current();
    modeler.view.hold = Hold::Nothing;
    let screen = modeler.view.screen;
    let by = Vec2::new(touch.translation_delta.x, touch.translation_delta.y);
    if touch.num_touches >= 3 {
        modeler.camera.orbit(by, screen);
    } else {
        modeler.camera.pan(by, screen);
    }
    modeler.camera.zoom(touch.zoom_delta, in_view(touch.center_pos, response), screen);
}

fn wheel(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let Some(at) = response.hover_pos() else { return };
    let (scrolled, pinched, shift) =
        ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta(), input.modifiers.shift));
    let screen = modeler.view.screen;
    if shift {
        modeler.camera.pan(Vec2::new(scrolled.x, scrolled.y), screen);
    } else if scrolled.y != 0.0 || pinched != 1.0 {
        modeler.camera.zoom(pinched * (WHEEL * scrolled.y).exp(), in_view(at, response), screen);
    }
}

/// Where a button was pressed in this frame. egui forgets it if the button is let go in the same frame.
fn pressed_at(events: &[Event]) -> Option<egui::Pos2> {
    events.iter().find_map(|event| match event {
        Event::PointerButton { pressed: true, pos, .. } => Some(*pos),
        _ => None,
    })
}

/// The hand takes hold of something.
fn press(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let pressed = |button| ui.input(|input| input.pointer.button_pressed(button));
    // Where the pen is by now may be over something else, if the frame was slow.
    let is_on_paper =
        |at: &egui::Pos2| response.rect.contains(*at) && ui.ctx().layer_id_at(*at) == Some(response.layer_id);
    let Some(at) = ui.input(|input| pressed_at(&input.events)).filter(is_on_paper) else { return };
    let (shift, space) = ui.input(|input| (input.modifiers.shift, input.key_down(egui::Key::Space)));
    for button in [PointerButton::Secondary, PointerButton::Middle] {
        if let Some(tool) = modeler.settings.habit.drag(button, shift).filter(|_| pressed(button)) {
            modeler.pad.drop_current();
            modeler.view.hold = Hold::View(tool);
        }
    }
    if !pressed(PointerButton::Primary) {
        return;
    }
    let at = in_view(at, response);
    modeler.view.hold = match modeler.settings.tool {
        _ if space || modeler.pen.state().barrel => Hold::View(Tool::Turn),
        tool if modeler.pen.state().eraser => {
            begin(modeler, at, tool, response, ui);
            Hold::Pen
        }
        tool @ (Tool::Turn | Tool::Pan) => Hold::View(tool),
        Tool::Draw | Tool::Select if let Some(knob) = Knob::at(modeler, at) => {
            Hold::Knob(knob.turns, at, knob.value)
        }
        Tool::Draw | Tool::Select if let Some(handle) = Handle::at(modeler, at) => Hold::Handle(handle, at),
        tool => {
            begin(modeler, at, tool, response, ui);
            Hold::Pen
        }
    };
}

fn drag(modeler: &mut Modeler, tool: Tool, by: egui::Vec2) {
    let (by, screen) = (Vec2::new(by.x, by.y), modeler.view.screen);
    match tool {
        Tool::Pan => modeler.camera.pan(by, screen),
        _ => modeler.camera.orbit(by, screen),
    }
}

/// The pen is on the paper, or has just been lifted.
fn pen(modeler: &mut Modeler, ui: &Ui, response: &Response) {
    let events = ui.input(|input| input.events.clone());
    if events.iter().any(|event| matches!(event, Event::PointerMoved(_))) {
        modeler.ends(Wait::PenToStroke, modeler.now, None);
    }
    // What the pen did before it touched down in this frame is no part of the stroke.
    let touches = |event: &Event| {
        matches!(event, Event::PointerButton { button: PointerButton::Primary, pressed: true, .. })
    };
    let first = events.iter().position(touches).map_or(0, |place| place + 1);
    for event in &events[first..] {
        match event {
            // A slow frame may have several strokes.
            Event::PointerButton { button: PointerButton::Primary, pressed: true, pos, .. } => {
                begin(modeler, in_view(*pos, response), modeler.settings.tool, response, ui);
                modeler.view.hold = Hold::Pen;
            }
            Event::PointerMoved(to) => {
                modeler.pad.go_on(sample(modeler, in_view(*to, response), response, ui));
            }
            Event::PointerButton { button: PointerButton::Primary, pressed: false, pos, .. } => {
                let at = in_view(*pos, response);
                modeler.pad.go_on(sample(modeler, at, response, ui));
                lift(modeler, ui);
            }
            // The pen has left the world.
            Event::PointerGone | Event::WindowFocused(false) => lift(modeler, ui),
            _ => {}
        }
    }
}

fn lift(modeler: &mut Modeler, ui: &Ui) {
    let Some(stroke) = modeler.pad.current() else { return };
    modeler.view.hold = Hold::Nothing;
    let start = stroke.samples[0].place();
    let is_tap = stroke.places().all(|place| place.distance(start) < TAP);
    if is_tap && !stroke.eraser {
        modeler.pad.drop_current();
        selecting::tap(modeler, start, ui.input(|input| input.modifiers));
        return;
    }
    if modeler.settings.tool == Tool::Select && !stroke.eraser {
        let places: Vec<Vec2> = stroke.places().collect();
        modeler.pad.drop_current();
        selecting::cross(modeler, places.into_iter());
        return;
    }
    let view = modeler.camera.view(modeler.view.screen);
    let outline = selected_outline(modeler);
    let around =
        Around { selected: outline.as_ref().map(|corners| &corners[..]), buttons: &modeler.view.buttons };
    let stroked = modeler.pad.end(&view, &around);
    modeler.stroked(stroked);
}

/// The corners on the screen of the box around the selected nodes, outside of which nothing of them is.
fn selected_outline(modeler: &Modeler) -> Option<[Vec2; 4]> {
    let bounds = modeler.selected_box()?;
    let view = modeler.camera.view(modeler.view.screen);
    let corners: Option<Vec<Vec2>> =
        bounds.corners().iter().map(|corner| view.screen_from_model(*corner)).collect();
    let corners = corners?;
    let lo = corners.iter().fold(Vec2::INFINITY, |lo, p| lo.min(*p));
    let hi = corners.iter().fold(Vec2::NEG_INFINITY, |hi, p| hi.max(*p));
    Some([lo, Vec2::new(hi.x, lo.y), hi, Vec2::new(lo.x, hi.y)])
}

fn handle_dragged(modeler: &mut Modeler, ui: &Ui, response: &Response, handle: Handle, from: Vec2) {
    let Some(at) = ui.input(|input| input.pointer.latest_pos()) else { return };
    let let_go = ui.input(|input| input.pointer.primary_released());
    let at = in_view(at, response);
    // Handles lie over parts: who only taps means those.
    if from.distance(at) < TAP && !modeler.bench.is_dragged() {
        if let_go {
            selecting::tap(modeler, at, ui.input(|input| input.modifiers));
        }
        return;
    }
    let motion = handle.motion(modeler, from, at);
    let (Some(motion), Some(mut part)) = (motion, modeler.held_box()) else { return };
    // Boxes around parts are a little too large, and parts would rest above the bed.
    let bench = &modeler.bench;
    let lowest = match let_go {
        true => modeler.lowest.wait(&bench.scene().root, bench.selection()),
        false => modeler.lowest.found(),
    };
    part.min.z = lowest.unwrap_or(part.min.z);
    let is_free = !modeler.settings.snaps || ui.input(|input| input.modifiers.command);
    let view = modeler.camera.view(modeler.view.screen);
    let (motion, guides) = if is_free {
        (motion, Vec::new())
    } else {
        snapping::snapped(motion, handle, &part, view.mm_per_px(view.depth(part.center())))
    };
    modeler.view.guides = guides;
    modeler.place(motion, let_go);
}

/// A knob follows the hand.
fn knob_dragged(modeler: &mut Modeler, ui: &Ui, response: &Response, turns: Turns, from: Vec2, start: f32) {
    let Some(at) = ui.input(|input| input.pointer.latest_pos()) else { return };
    let let_go = ui.input(|input| input.pointer.primary_released());
    let by = in_view(at, response) - from;
    let Some(knob) = Knob::all(modeler).into_iter().find(|knob| knob.turns == turns) else { return };
    let value = knob.dragged(start, by);
    if turns == Turns::Depth {
        if modeler.pad.depth != Some(value) && value.is_finite() {
            modeler.pad.depth = Some(value);
            modeler.think();
        }
    } else if let (Turns::Lens, Some(lens)) = (turns, &mut modeler.lens) {
        lens.at = Some(value).filter(|at| at.is_finite());
    } else if let Some(command) = knobs::command(modeler, turns, value) {
        modeler.try_out(command, let_go && by != Vec2::ZERO);
    }
}

/// The pen touches down: with its eraser end, whatever the tool is, it rubs out.
fn begin(modeler: &mut Modeler, at: Vec2, tool: Tool, response: &Response, ui: &Ui) {
    let sample = sample(modeler, at, response, ui);
    modeler.pad.begin(sample, tool == Tool::Erase || modeler.pen.state().eraser);
}

/// What the pen says now, with the time of this frame. Without a source that knows, it presses as the finger does.
fn sample(modeler: &Modeler, at: Vec2, response: &Response, ui: &Ui) -> PenSample {
    let (time, force) = ui.input(|input| {
        let forces = input.events.iter().rev().filter_map(|event| match event {
            Event::Touch { force, .. } => *force,
            _ => None,
        });
        (input.time, forces.take(1).next())
    });
    let pen = modeler.pen.state_at(on_screen(at, response));
    let pressure = pen.pressure.or(force).unwrap_or(1.0);
    PenSample { time: Some(time as f32), pressure, tilt: pen.tilt, ..PenSample::at(at) }
}
