//! Strokes of real drawings, none of them meant as a gesture, are hardly ever taken for one.
//!
//! `cargo test -p sketch --features shared --test doodle_gestures -- --nocapture`. Needs `../shared/doodles`.

mod doodles;

use glam::Vec2;
use sketch::gesture::{Button, Context, Gesture, recognise};
use sketch::stroke::{Sketch, Stroke};

const SCREEN: Vec2 = Vec2::new(1280.0, 800.0);

/// Where the doodles' box of 256 units lies on the screen.
const CORNER: Vec2 = Vec2::new(340.0, 100.0);
const SIDE: f32 = 600.0;

/// Largest share of strokes that may be taken for a gesture where it would be accepted.
const MISTAKEN: f32 = 0.005;

/// All doodles, on the screen.
fn drawings() -> Vec<Vec<Stroke>> {
    let mut all: Vec<Vec<Stroke>> = doodles::every(1).into_iter().map(|(_, strokes)| strokes).collect();
    for sample in all.iter_mut().flatten().flat_map(|stroke| &mut stroke.samples) {
        let place = CORNER + sample.place() * SIDE / 255.0;
        (sample.x, sample.y) = (place.x, place.y);
    }
    all
}

/// Gives a stroke the times of a hand that draws this many pixels a second.
fn timed(stroke: &Stroke, speed: f32) -> Stroke {
    let mut stroke = stroke.clone();
    let (mut time, mut last) = (0.0, stroke.samples.first().map(|sample| sample.place()));
    for sample in &mut stroke.samples {
        time += last.map_or(0.0, |last| last.distance(sample.place())) / speed;
        (sample.time, last) = (Some(time), Some(sample.place()));
    }
    stroke
}

/// How often each gesture was seen, and how often it would have been accepted.
#[derive(Default)]
struct Counts {
    seen: [usize; 6],
    accepted: [usize; 6],
}

const NAMES: [&str; 6] = ["press", "erase", "remove", "smooth", "undo", "parent"];

impl Counts {
    fn add(&mut self, gesture: Option<&Gesture>, context: &Context) {
        let (sketch, selected) = (!context.sketch.is_empty(), context.selected.is_some());
        let accepted = [true, sketch, !sketch && selected, sketch, sketch, !sketch && selected];
        for (count, accepted) in self.accepted.iter_mut().zip(accepted) {
            *count += usize::from(accepted);
        }
        let place = match gesture {
            None => return,
            Some(Gesture::Press(_)) => 0,
            Some(Gesture::Erase(_)) => 1,
            Some(Gesture::Remove) => 2,
            Some(Gesture::Smooth(_)) => 3,
            Some(Gesture::Undo) => 4,
            Some(Gesture::SelectParent) => 5,
        };
        self.seen[place] += 1;
    }

    fn print_and_check(&self, title: &str) {
        println!("{title}");
        let shares = self.seen.iter().zip(self.accepted).map(|(seen, of)| *seen as f32 / of as f32);
        for (i, share) in shares.enumerate() {
            println!("  {:7} {:4} of {:5}: {:.2} %", NAMES[i], self.seen[i], self.accepted[i], share * 100.0);
            assert!(share < MISTAKEN, "{}: {} of {}", NAMES[i], self.seen[i], self.accepted[i]);
        }
    }
}

/// Reads every stroke in the context of those before it, on a selected node, with a button somewhere on the
/// drawing. `units` is the pen's typical speed in sides of the doodle's box a second.
fn read_all(units: Option<f32>) -> Counts {
    let mut random = fastrand::Rng::with_seed(1);
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let outline: Vec<Vec2> = corners.into_iter().map(|corner| CORNER + SIDE * corner).collect();
    let mut counts = Counts::default();
    for strokes in drawings() {
        let at = CORNER + Vec2::new(random.f32(), random.f32()) * (SIDE - 48.0);
        let button = [Button { min: at, max: at + 48.0 }];
        let mut sketch = Sketch::default();
        for stroke in strokes {
            // Half to twice the typical speed.
            let speed = units.map(|units| units * SIDE * (random.f32() * 2.0 - 1.0).exp2());
            let stroke = speed.map_or(stroke.clone(), |speed| timed(&stroke, speed));
            let context =
                Context { screen: SCREEN, sketch: &sketch, selected: Some(&outline), buttons: &button };
            counts.add(recognise(&stroke, &context).as_ref(), &context);
            sketch.add(&stroke);
        }
    }
    counts
}

#[test]
fn fewer_than_one_in_two_hundred_strokes_of_doodles_are_taken_for_a_gesture() {
    read_all(None).print_and_check("times unknown");
    // The doodles were drawn in at most 20 s each, at about a side of the box a second; hardly at half that or twice.
    for speed in [0.5, 1.0, 2.0] {
        let title = format!("{} to {} sides of the box a second", 0.5 * speed, 2.0 * speed);
        read_all(Some(speed)).print_and_check(&title);
    }
}
