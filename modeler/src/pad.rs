//! The sketch in the air: strokes that have not become a shape yet.
//!
//! They are kept in points of the view in which the first was drawn. If the camera moves, they stay on the sketch
//! plane in the model, and further strokes are carried back to that first view.

use crate::expecting::{Curves, Expectations, Thought};
use glam::{Vec2, Vec3};
use sketch::gesture::{Button, Context, Gesture, recognise};
use sketch::stroke::{PenSample, Sketch, Stroke};
use sketch::suggest::View;

/// Samples nearer than this to the one before are left out, points.
const NEAREST: f32 = 0.4;

/// Most samples of one stroke; a hand needs an hour for them.
const MOST_SAMPLES: usize = 400_000;

/// Strokes being collected.
#[derive(Debug, Default)]
pub struct Pad {
    sketch: Sketch,
    /// The states before each change since the sketch was begun.
    before: Vec<Sketch>,
    /// How the model was seen when the first stroke was drawn; none without any stroke.
    drawn_in: Option<View>,
    /// The stroke under the pen, in points of the present view.
    current: Option<Stroke>,
    /// The depth of the sketch plane, if somebody has moved it, mm.
    pub depth: Option<f32>,
    /// The curves that the strokes mean.
    pub curves: Option<Curves>,
    /// What they might become.
    pub expectations: Option<Expectations>,
}

/// What a finished stroke was.
#[derive(Clone, Debug, PartialEq)]
pub enum Stroked {
    /// The sketch has changed.
    Sketched,
    /// It presses one of the buttons.
    Pressed(usize),
    /// It removes what is selected.
    Removed,
    /// It takes back the last thing done to the document.
    UndoneStep,
    /// It selects the parent of what is selected.
    ParentSelected,
    /// It was nothing.
    Nothing,
}

/// What is on the screen beside the sketch, for gestures.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// The outline of what is selected, in points of the view.
    pub selected: Option<&'a [Vec2]>,
    /// The buttons over the view.
    pub buttons: &'a [Button],
}

impl Pad {
    /// The strokes so far, in points of [`Self::drawn_in`].
    pub fn sketch(&self) -> &Sketch {
        &self.sketch
    }

    /// How the model was seen when the first stroke was drawn.
    pub fn drawn_in(&self) -> Option<&View> {
        self.drawn_in.as_ref()
    }

    /// The stroke under the pen, in points of the present view.
    pub fn current(&self) -> Option<&Stroke> {
        self.current.as_ref()
    }

    /// Whether there is nothing, not even a stroke under the pen.
    pub fn is_empty(&self) -> bool {
        self.sketch.is_empty() && self.current.is_none()
    }

    /// The pen touches down.
    pub fn begin(&mut self, sample: PenSample, eraser: bool) {
        self.current = Some(Stroke { samples: vec![sample], eraser });
    }

    /// The pen moves on; without a stroke, it does nothing.
    pub fn go_on(&mut self, sample: PenSample) {
        let Some(stroke) = &mut self.current else { return };
        let is_new =
            stroke.samples.last().is_none_or(|last| last.place().distance(sample.place()) >= NEAREST);
        if is_new && sample.place().is_finite() && stroke.samples.len() < MOST_SAMPLES {
            stroke.samples.push(sample);
        }
    }

    /// The stroke under the pen is not meant.
    pub fn drop_current(&mut self) {
        self.current = None;
    }

    /// The pen lifts off. `view` is the present one.
    pub fn end(&mut self, view: &View, around: &Around) -> Stroked {
        let Some(stroke) = self.current.take() else { return Stroked::Nothing };
        let seen = self.seen_in(view);
        let context = Context {
            screen: view.screen,
            sketch: &seen,
            selected: around.selected,
            buttons: around.buttons,
        };
        let gesture = recognise(&stroke, &context);
        let before = self.sketch.clone();
        let stroked = match gesture {
            Some(Gesture::Press(button)) => return Stroked::Pressed(button),
            Some(Gesture::Remove) => return Stroked::Removed,
            // Without anything selected it is a line, such as a string of a harp.
            Some(Gesture::SelectParent) if around.selected.is_some() => return Stroked::ParentSelected,
            Some(Gesture::Undo) if self.sketch.is_empty() => return Stroked::UndoneStep,
            Some(Gesture::Undo) => self.sketch.undo_last_stroke(),
            Some(Gesture::Erase(area)) => self.with(view, seen, |sketch| sketch.erase(&area)),
            Some(Gesture::Smooth(polygon)) => self.with(view, seen, |sketch| sketch.smooth(&polygon) > 0),
            Some(Gesture::SelectParent) | None => self.with(view, seen, |sketch| {
                let old = sketch.clone();
                sketch.add(&stroke);
                *sketch != old
            }),
        };
        if !stroked {
            return Stroked::Nothing;
        }
        self.before.push(before);
        self.changed();
        Stroked::Sketched
    }

    /// Takes back the last change of the sketch; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.before.pop() else { return false };
        self.sketch = before;
        self.changed();
        true
    }

    /// Puts a sketch from elsewhere on the pad, in the middle of the view, three quarters as large as it.
    pub fn put(&mut self, sketch: Sketch, view: &View) {
        let Some([lo, hi]) = sketch.bounds() else { return };
        let by = 0.75 * view.screen.min_element() / (hi - lo).max_element().max(1e-6);
        let (from, to) = (0.5 * (lo + hi), 0.5 * view.screen);
        let sketch = self.carried(&sketch, |place| Some(to + by * (place - from)).filter(|p| p.is_finite()));
        *self = Self { sketch, before: vec![Sketch::default()], drawn_in: Some(*view), ..Self::default() };
    }

    /// Puts everything away.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Takes in what came to mind.
    pub fn hear(&mut self, thought: Thought) {
        match thought {
            Thought::Curves(curves) => self.curves = Some(curves),
            Thought::Expectations(expectations) => self.expectations = Some(expectations),
            Thought::Picture(picture) => {
                let found = self.expectations.as_mut().filter(|found| found.version == picture.version);
                if let Some(place) = found.and_then(|found| found.pictures.get_mut(picture.suggestion)) {
                    *place = Some(picture.image);
                }
            }
        }
    }

    /// Where a place of the sketch shows in the present view, points; `None` behind the eye.
    pub fn shown(&self, place: Vec2, view: &View) -> Option<Vec2> {
        match &self.drawn_in {
            Some(drawn) if drawn != view => {
                view.screen_from_model(drawn.at_depth(place, self.plane_depth(drawn)))
            }
            _ => Some(place),
        }
    }

    /// The depth of the sketch plane before the eye that drew it, mm.
    fn plane_depth(&self, drawn: &View) -> f32 {
        let found = self.expectations.as_ref().map(|expectations| expectations.depth);
        self.depth.or(found).unwrap_or_else(|| drawn.depth(Vec3::ZERO))
    }

    /// The sketch as it shows in the present view.
    fn seen_in(&self, view: &View) -> Sketch {
        self.carried(&self.sketch, |place| self.shown(place, view))
    }

    /// Changes the sketch as it is seen in the present view; whether it changed.
    fn with(&mut self, view: &View, mut seen: Sketch, change: impl FnOnce(&mut Sketch) -> bool) -> bool {
        if !change(&mut seen) {
            return false;
        }
        let drawn = *self.drawn_in.get_or_insert(*view);
        self.sketch = if drawn == *view {
            seen
        } else {
            let depth = self.plane_depth(&drawn);
            let plane = drawn.plane(depth);
            let normal = plane.right.cross(plane.up);
            self.carried(&seen, |place| {
                let ray = view.ray(place);
                let t = (plane.origin - ray.origin).dot(normal) / ray.direction.dot(normal);
                drawn.screen_from_model(ray.origin + ray.direction * t).filter(|p| t > 0.0 && p.is_finite())
            })
        };
        true
    }

    /// The sketch with every place moved; samples that go nowhere are left out.
    fn carried(&self, sketch: &Sketch, to: impl Fn(Vec2) -> Option<Vec2>) -> Sketch {
        let mut sketch = sketch.clone();
        for stroke in &mut sketch.strokes {
            stroke.samples.retain_mut(|sample| {
                let place = to(sample.pen.place());
                place.inspect(|p| (sample.pen.x, sample.pen.y) = (p.x, p.y)).is_some()
            });
        }
        sketch.strokes.retain(|stroke| !stroke.samples.is_empty());
        sketch
    }

    fn changed(&mut self) {
        (self.curves, self.expectations) = (None, None);
        if self.sketch.is_empty() {
            (self.drawn_in, self.depth) = (None, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use std::f32::consts::TAU;

    const SCREEN: Vec2 = Vec2::new(800.0, 600.0);
    const NOTHING: Around<'static> = Around { selected: None, buttons: &[] };

    /// Draws a stroke in one second.
    fn draw(pad: &mut Pad, view: &View, places: impl ExactSizeIterator<Item = Vec2>) -> Stroked {
        let last = places.len().max(2) - 1;
        for (i, place) in places.enumerate() {
            let sample = PenSample { time: Some(i as f32 / last as f32), ..PenSample::at(place) };
            if i == 0 { pad.begin(sample, false) } else { pad.go_on(sample) }
        }
        pad.end(view, &NOTHING)
    }

    fn circle(middle: Vec2, radius: f32) -> impl ExactSizeIterator<Item = Vec2> {
        (0..=80_u16).map(move |i| middle + radius * Vec2::from_angle(TAU * f32::from(i) / 80.0))
    }

    #[test]
    fn a_sketch_stays_on_its_plane_while_the_camera_moves_and_can_be_gone_on_with() {
        let mut camera = Camera::default();
        let (mut pad, drawn) = (Pad::default(), camera.view(SCREEN));
        assert_eq!(draw(&mut pad, &drawn, circle(0.5 * SCREEN, 100.0)), Stroked::Sketched);
        camera.orbit(Vec2::new(60.0, 25.0), SCREEN);
        let turned = camera.view(SCREEN);
        assert_eq!(draw(&mut pad, &turned, circle(Vec2::new(300.0, 280.0), 30.0)), Stroked::Sketched);
        assert_eq!((pad.sketch().strokes.len(), pad.drawn_in()), (2, Some(&drawn)));
        // What was drawn in the turned view shows there where it was drawn.
        for sample in &pad.sketch().strokes[1].samples {
            let shown = pad.shown(sample.pen.place(), &turned).expect("before the eye");
            assert!((shown.distance(Vec2::new(300.0, 280.0)) - 30.0).abs() < 0.5, "{shown}");
        }
    }

    #[test]
    fn undo_takes_back_one_stroke_after_the_other() {
        let (mut pad, view) = (Pad::default(), Camera::default().view(SCREEN));
        draw(&mut pad, &view, circle(Vec2::new(200.0, 200.0), 60.0));
        draw(&mut pad, &view, circle(Vec2::new(500.0, 200.0), 60.0));
        assert!(pad.undo() && pad.sketch().strokes.len() == 1);
        assert!(pad.undo() && pad.is_empty() && !pad.undo());
        assert_eq!(pad.drawn_in(), None);
    }

    #[test]
    fn a_pen_that_goes_mad_leaves_a_stroke_that_can_be_used() {
        let (mut pad, view) = (Pad::default(), Camera::default().view(SCREEN));
        let mad = [f32::NAN, 10.0, f32::INFINITY, -1e30, 20.0, 1e30];
        draw(&mut pad, &view, mad.into_iter().map(|x| Vec2::new(x, 2.0 * x)));
        assert!(pad.sketch().places().all(|p| p.is_finite()));
    }
}
