//! What a pen says beyond what a mouse says, and the hand that rests on the screen beside it.
//!
//! egui knows a pen as a mouse, or as a finger that presses more or less. Whoever hears more from the platform puts it
//! into a [`Pen`]: which end of the pen is down, its button, how it leans. Without such a source, the pressure is that
//! of the touch, and what moves the pointer without touching is taken for a pen.
//!
//! While a pen is near the screen, and shortly after, fingers are not heard: they are the hand that holds it.

use egui::{
    Context, Event, Modifiers, Plugin, PointerButton, Pos2, RawInput, TouchDeviceId, TouchId, TouchPhase,
};
use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long after a pen was near fingers are not heard, seconds.
const SHORTLY: f64 = 0.4;

/// A touch within this distance of the pen is the pen itself, where the platform tells of it twice, points.
const ITSELF: f32 = 24.0;

/// A pen that hovers and says nothing for so long has gone away.
const STILL: Duration = Duration::from_millis(800);

/// How many of the things that a pen has said are remembered.
const RECENT: usize = 128;

/// Two places that are nearer to each other than this are the same, points.
const SAME_PLACE: f32 = 0.6;

/// Where nothing is that could be clicked.
const ELSEWHERE: Pos2 = Pos2::new(-1e4, -1e4);

/// What a pen says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenState {
    /// Whether it is near enough to the screen to be felt.
    pub is_near: bool,
    /// Where, points of the window, if that is known.
    pub at: Option<Pos2>,
    /// How hard it presses, 0 to 1, if it can tell.
    pub pressure: Option<f32>,
    /// How far it leans to the right and towards the user, degrees.
    pub tilt: [f32; 2],
    /// Whether its eraser end is down.
    pub eraser: bool,
    /// Whether the button on its side is held.
    pub barrel: bool,
}

/// The pen of a window: one end is told of it by the platform, the other asks. Clones are the same pen.
#[derive(Clone, Debug, Default)]
pub struct Pen(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    /// What the platform has said, and when; none if it has never said anything.
    told: Option<(PenState, Instant)>,
    /// What it has said of places shortly before, the latest last.
    recent: VecDeque<PenState>,
    /// When a pen was last near, in seconds of the screen's clock.
    last_near: Option<f64>,
    /// Whether something that is held is held by a hand that is no longer heard.
    is_cancelled: bool,
    is_guarding: bool,
}

impl Known {
    /// What the pen says that is near. Not all platforms tell when it goes away, but a pen that hovers is never still.
    fn near(&self) -> Option<PenState> {
        let (state, since) = self.told?;
        let presses = state.pressure.is_some_and(|pressure| pressure > 0.0);
        (state.is_near && (presses || since.elapsed() < STILL)).then_some(state)
    }
}

impl Pen {
    fn known(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells what the pen says now. Whoever tells it also asks for a new frame.
    pub fn tell(&self, state: PenState) {
        let mut known = self.known();
        known.told = Some((state, Instant::now()));
        if known.recent.len() == RECENT {
            known.recent.pop_front();
        }
        known.recent.push_back(state);
    }

    /// What the pen says; nothing but its usual self without a source that knows.
    pub fn state(&self) -> PenState {
        self.known().near().unwrap_or_default()
    }

    /// What the pen said when it was at this place of the window: a slow frame hears of many places at once.
    pub fn state_at(&self, place: Pos2) -> PenState {
        let known = self.known();
        let Some(now) = known.near() else { return PenState::default() };
        let was_there = |state: &&PenState| state.at.is_some_and(|at| at.distance(place) < SAME_PLACE);
        known.recent.iter().rev().find(was_there).copied().unwrap_or(now)
    }

    /// From now on, fingers are not heard while the pen is near.
    pub fn guard(&self, ctx: &Context) {
        if !std::mem::replace(&mut self.known().is_guarding, true) {
            ctx.add_plugin(PalmGuard { pen: self.clone(), ..PalmGuard::default() });
        }
    }

    /// Whether what is held must be let go, because it was held by the hand and not by the pen. Asked once.
    pub fn is_cancelled(&self) -> bool {
        std::mem::take(&mut self.known().is_cancelled)
    }
}

/// Takes fingers out of what egui hears while a pen is near.
#[derive(Debug, Default)]
struct PalmGuard {
    pen: Pen,
    /// Fingers on the screen that are heard.
    heard: BTreeSet<(TouchDeviceId, TouchId)>,
    /// Fingers on the screen that are not.
    unheard: BTreeSet<(TouchDeviceId, TouchId)>,
    /// Where the last event was a touch, and whether it was heard: the mouse that is played after it comes next.
    after: Option<(Pos2, bool)>,
    /// Whether that mouse has its button down.
    is_pressed: bool,
}

impl Plugin for PalmGuard {
    fn debug_name(&self) -> &'static str {
        "palm rejection"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let now = input.time.unwrap_or_else(|| ctx.input(|i| i.time) + f64::from(input.predicted_dt));
        let events = std::mem::take(&mut input.events);
        input.events.reserve(events.len());
        for event in events {
            self.hear(event, now, &mut input.events);
        }
    }
}

impl PalmGuard {
    /// Passes an event on, unless it comes from a finger that is not to be heard.
    fn hear(&mut self, event: Event, now: f64, out: &mut Vec<Event>) {
        let is_heard = match (&event, self.after) {
            (Event::Touch { device_id, id, phase, pos, .. }, _) => {
                let is_heard = self.touched((*device_id, *id), *phase, *pos, now);
                self.after = Some((*pos, is_heard));
                is_heard
            }
            (Event::PointerMoved(to), Some((at, is_heard))) if *to == at => is_heard,
            (Event::PointerButton { pressed, .. }, Some((_, is_heard))) => {
                self.is_pressed = *pressed && is_heard;
                is_heard
            }
            (Event::PointerGone, Some((_, is_heard))) => is_heard,
            (Event::PointerMoved(_) | Event::PointerButton { .. }, _) => {
                self.after = None;
                self.pen_is_near(now, out);
                true
            }
            _ => {
                self.after = None;
                true
            }
        };
        if is_heard {
            out.push(event);
        }
    }

    /// Whether what a finger does is heard.
    fn touched(&mut self, finger: (TouchDeviceId, TouchId), phase: TouchPhase, at: Pos2, now: f64) -> bool {
        if phase == TouchPhase::Start {
            let is_heard = self.is_pen_itself(at) || !self.is_pen_near(now);
            if is_heard { &mut self.heard } else { &mut self.unheard }.insert(finger);
        }
        let is_heard = !self.unheard.contains(&finger);
        if matches!(phase, TouchPhase::End | TouchPhase::Cancel) {
            self.heard.remove(&finger);
            self.unheard.remove(&finger);
        }
        is_heard
    }

    /// Whether a pen is near, or was until shortly.
    fn is_pen_near(&self, now: f64) -> bool {
        let mut known = self.pen.known();
        if known.near().is_some() {
            known.last_near = Some(now);
        }
        known.last_near.is_some_and(|last| now - last < SHORTLY)
    }

    fn is_pen_itself(&self, touch: Pos2) -> bool {
        self.pen.known().near().and_then(|state| state.at).is_some_and(|at| at.distance(touch) < ITSELF)
    }

    /// A pen has come: what fingers hold is let go.
    fn pen_is_near(&mut self, now: f64, out: &mut Vec<Event>) {
        let mut known = self.pen.known();
        // A platform that tells of pens tells them from mice.
        if known.told.is_some() && known.near().is_none() {
            return;
        }
        known.last_near = Some(now);
        known.is_cancelled |= !self.heard.is_empty();
        for (device_id, id) in std::mem::take(&mut self.heard) {
            out.push(Event::Touch { device_id, id, phase: TouchPhase::Cancel, pos: Pos2::ZERO, force: None });
            self.unheard.insert((device_id, id));
        }
        if std::mem::take(&mut self.is_pressed) {
            // Far away, so that nothing is clicked.
            out.extend([Event::PointerMoved(ELSEWHERE), released(ELSEWHERE)]);
        }
    }
}

/// A button is let go.
fn released(pos: Pos2) -> Event {
    let button = PointerButton::Primary;
    Event::PointerButton { pos, button, pressed: false, modifiers: Modifiers::NONE }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    const PALM: Pos2 = pos2(300.0, 400.0);

    fn touch(phase: TouchPhase) -> Event {
        Event::Touch { device_id: TouchDeviceId(1), id: TouchId(7), phase, pos: PALM, force: None }
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        let button = PointerButton::Primary;
        Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
    }

    /// A touch with the mouse that is played after it.
    fn touched(phase: TouchPhase) -> Vec<Event> {
        let after = match phase {
            TouchPhase::Start => vec![Event::PointerMoved(PALM), button(PALM, true)],
            TouchPhase::Move => vec![Event::PointerMoved(PALM)],
            TouchPhase::End => vec![button(PALM, false), Event::PointerGone],
            TouchPhase::Cancel => vec![Event::PointerGone],
        };
        [vec![touch(phase)], after].concat()
    }

    fn heard(guard: &mut PalmGuard, events: Vec<Event>, now: f64) -> Vec<Event> {
        let mut out = Vec::new();
        events.into_iter().for_each(|event| guard.hear(event, now, &mut out));
        out
    }

    #[test]
    fn fingers_alone_are_heard() {
        let mut guard = PalmGuard::default();
        for phase in [TouchPhase::Start, TouchPhase::Move, TouchPhase::End] {
            assert_eq!(heard(&mut guard, touched(phase), 1.0), touched(phase));
        }
    }

    #[test]
    fn a_palm_beside_the_pen_is_not_heard_until_it_is_lifted_long_after_the_pen() {
        let mut guard = PalmGuard::default();
        let pen = || vec![Event::PointerMoved(pos2(100.0, 100.0)), button(pos2(100.0, 100.0), true)];
        assert_eq!(heard(&mut guard, pen(), 1.0), pen());
        assert!(heard(&mut guard, touched(TouchPhase::Start), 1.1).is_empty());
        assert!(heard(&mut guard, touched(TouchPhase::Move), 2.0).is_empty(), "it is still the palm");
        assert!(heard(&mut guard, touched(TouchPhase::End), 2.1).is_empty());
        assert_eq!(heard(&mut guard, touched(TouchPhase::Start), 2.2), touched(TouchPhase::Start));
    }

    #[test]
    fn a_palm_that_lies_down_before_the_pen_comes_lets_go_of_what_it_held() {
        let mut guard = PalmGuard::default();
        assert_eq!(heard(&mut guard, touched(TouchPhase::Start), 1.0).len(), 3);
        guard.pen.tell(PenState { is_near: true, at: Some(pos2(90.0, 90.0)), ..PenState::default() });
        assert!(!guard.pen.is_cancelled());
        let pen = Event::PointerMoved(pos2(90.0, 90.0));
        let out = heard(&mut guard, vec![pen.clone()], 1.2);
        assert!(matches!(out[0], Event::Touch { phase: TouchPhase::Cancel, .. }), "{out:?}");
        assert_eq!(out[1..], [Event::PointerMoved(ELSEWHERE), released(ELSEWHERE), pen]);
        assert!(guard.pen.is_cancelled() && !guard.pen.is_cancelled());
        assert!(heard(&mut guard, touched(TouchPhase::Move), 1.3).is_empty());
        assert!(heard(&mut guard, touched(TouchPhase::End), 1.4).is_empty());
    }

    #[test]
    fn where_pens_are_told_from_mice_a_mouse_silences_no_finger_and_a_pen_that_is_a_touch_is_heard() {
        let mut guard = PalmGuard::default();
        guard.pen.tell(PenState::default());
        heard(&mut guard, vec![Event::PointerMoved(pos2(90.0, 90.0))], 1.0);
        assert_eq!(heard(&mut guard, touched(TouchPhase::Start), 1.1).len(), 3);
        assert_eq!(heard(&mut guard, touched(TouchPhase::End), 1.2).len(), 3);
        let at = Some(PALM + egui::vec2(3.0, 0.0));
        guard.pen.tell(PenState { is_near: true, at, ..PenState::default() });
        assert_eq!(heard(&mut guard, touched(TouchPhase::Start), 1.3).len(), 3, "it is the pen itself");
        assert_eq!(heard(&mut guard, touched(TouchPhase::End), 1.4).len(), 3);
        guard.pen.tell(PenState { is_near: true, at: Some(pos2(9.0, 9.0)), ..PenState::default() });
        assert!(heard(&mut guard, touched(TouchPhase::Start), 1.5).is_empty());
    }
}
