//! Gestures as people draw them are recognised, and what only resembles them is not.

use glam::Vec2;
use sketch::gesture::{Button, Context, Gesture, recognise};
use sketch::stroke::{PenSample, Sketch, Stroke};
use std::f32::consts::{PI, TAU};

const SCREEN: Vec2 = Vec2::new(1280.0, 800.0);

/// Samples a second of a common pen.
const RATE: f32 = 120.0;

/// The shaking of a hand, as a part of the gesture's size.
const TREMOR: f32 = 0.012;

/// A hand that draws: it shakes, it strays, and its device reports whole pixels.
struct Hand {
    random: fastrand::Rng,
}

impl Hand {
    fn new(seed: u64) -> Self {
        Self { random: fastrand::Rng::with_seed(seed) }
    }

    fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.random.f32()
    }

    /// Draws along `path`, a function of 0 to 1, of this size and length in pixels, at a speed in pixels a
    /// second; slower at the ends, as hands are.
    fn draw(&mut self, path: impl Fn(f32) -> Vec2, size: f32, length: f32, speed: f32) -> Stroke {
        let seconds = length / speed;
        let count = ((seconds * RATE) as usize).max(4);
        let waves: Vec<[f32; 4]> = (0..4)
            .map(|_| {
                [
                    self.between(4.0, 12.0),
                    self.between(0.0, TAU),
                    self.between(0.0, TAU),
                    self.between(0.3, 1.0),
                ]
            })
            .collect();
        let samples = (0..=count)
            .map(|i| {
                let time = seconds * i as f32 / count as f32;
                let even = i as f32 / count as f32;
                let eased = even - 0.6 * (TAU * even).sin() / TAU;
                let shake: Vec2 = waves
                    .iter()
                    .map(|[hertz, x, y, strength]| {
                        let turn = TAU * hertz * time;
                        Vec2::new((turn + x).sin(), (turn + y).sin()) * *strength
                    })
                    .sum();
                let place = path(eased) + 0.5 * TREMOR * size * shake;
                PenSample { time: Some(time), ..PenSample::at(place.round()) }
            })
            .collect();
        Stroke { samples, eraser: false }
    }
}

/// A sketch of a round outline of this radius about the middle of the screen.
fn round_sketch(radius: f32) -> Sketch {
    let around = (0..=60).map(|i| 0.5 * SCREEN + radius * Vec2::from_angle(PI + TAU * i as f32 / 60.0));
    Sketch::from_strokes(&[Stroke::through(around)])
}

fn context(sketch: &Sketch) -> Context<'_> {
    Context { screen: SCREEN, sketch, selected: None, buttons: &[] }
}

/// Outline of a selected node.
fn selection() -> [Vec2; 4] {
    let [lo, hi] = [0.2 * SCREEN, 0.8 * SCREEN];
    [lo, Vec2::new(hi.x, lo.y), hi, Vec2::new(lo.x, hi.y)]
}

/// Rubs over the outline's right side: passes at any slant that crosses it, uneven and with round turns.
fn scribble(hand: &mut Hand, size: f32, speed: f32) -> Stroke {
    let passes = hand.between(7.0, 13.0).floor();
    let (advance, slant) = (hand.between(0.04, 0.14), hand.between(-PI / 3.0, PI / 3.0));
    let uneven: Vec<f32> = (0..=passes as usize + 1).map(|_| hand.between(0.8, 1.1)).collect();
    let across = Vec2::from_angle(slant);
    let spot = 0.5 * SCREEN + Vec2::new(200.0, hand.between(-40.0, 40.0));
    let path = move |t: f32| {
        let along = t * passes;
        let reach = uneven[along as usize] * 0.5 * size;
        spot + across * reach * (PI * along).cos() + across.perp() * (along - 0.5 * passes) * advance * size
    };
    hand.draw(path, size, passes * size, speed)
}

/// Circles two to four times, uneven and wandering, either way round.
fn circles(hand: &mut Hand, size: f32, speed: f32) -> Stroke {
    let (turns, flat, tilt) = (hand.between(2.0, 3.6), hand.between(0.6, 1.0), hand.between(0.0, PI));
    let (growth, start) = (hand.between(-0.12, 0.12), hand.between(0.0, TAU));
    let way = if hand.random.bool() { 1.0 } else { -1.0 };
    let wander = Vec2::new(hand.between(-0.1, 0.1), hand.between(-0.1, 0.1)) * size;
    let spot = 0.5 * SCREEN + Vec2::new(200.0, 0.0);
    let path = move |t: f32| {
        let (turn, radius) = (start + way * TAU * turns * t, 0.5 * size * (1.0 + growth * turns * (t - 0.5)));
        let flat = Vec2::new(turn.cos(), flat * turn.sin()) * radius;
        spot + Vec2::from_angle(tilt).rotate(flat) + wander * t
    };
    hand.draw(path, size, turns * PI * size, speed)
}

/// A straight stroke along a direction that is missed by up to `stray`, slightly bent.
fn straight(hand: &mut Hand, from: Vec2, towards: Vec2, stray: f32, length: f32, speed: f32) -> Stroke {
    let along = towards.rotate(Vec2::from_angle(hand.between(-stray, stray)));
    let sag = hand.between(-0.04, 0.04) * length;
    let path = move |t: f32| from + along * length * t + along.perp() * sag * (PI * t).sin();
    hand.draw(path, length, length, speed)
}

const SIZES: [f32; 3] = [0.08, 0.16, 0.32];
const PACES: [f32; 3] = [0.7, 1.0, 1.6];

/// Eighty trials of a gesture at three sizes and three speeds; how many are recognised.
fn recognised(name: &str, mut trial: impl FnMut(&mut Hand, f32, f32) -> bool) -> usize {
    let mut missed = Vec::new();
    for seed in 0..80 {
        let mut hand = Hand::new(seed);
        let (size, pace) = (SIZES[seed as usize % 3], PACES[seed as usize / 3 % 3]);
        if !trial(&mut hand, size, pace) {
            missed.push((seed, size, pace));
        }
    }
    println!("{name}: {} of 80; missed (seed, size, pace): {missed:?}", 80 - missed.len());
    80 - missed.len()
}

#[test]
fn of_four_hundred_gestures_by_a_shaking_hand_at_least_ninety_seven_in_a_hundred_are_recognised() {
    let (sketch, empty, outline) = (round_sketch(200.0), Sketch::default(), selection());
    let erased = recognised("erase", |hand, size, pace| {
        let stroke = scribble(hand, size * SCREEN.y, pace * 2.0 * SCREEN.y);
        matches!(recognise(&stroke, &context(&sketch)), Some(Gesture::Erase(_)))
    });
    let smoothed = recognised("smooth", |hand, size, pace| {
        let stroke = circles(hand, size * SCREEN.y, pace * SCREEN.y);
        matches!(recognise(&stroke, &context(&sketch)), Some(Gesture::Smooth(_)))
    });
    let undone = recognised("undo", |hand, size, pace| {
        let length = 1.4 * size * SCREEN.x;
        let stroke = straight(hand, 0.6 * SCREEN, Vec2::NEG_X, 0.26, length, pace * 2.2 * SCREEN.x);
        recognise(&stroke, &context(&sketch)) == Some(Gesture::Undo)
    });
    let risen = recognised("parent", |hand, size, pace| {
        let length = 1.4 * size * SCREEN.y;
        let stroke = straight(hand, 0.7 * SCREEN, Vec2::NEG_Y, 0.17, length, pace * 2.2 * SCREEN.y);
        let context = Context { selected: Some(&outline), ..context(&empty) };
        recognise(&stroke, &context) == Some(Gesture::SelectParent)
    });
    let pressed = recognised("press", |hand, size, pace| crosses_a_button(hand, size, pace, &sketch));
    let all = erased + smoothed + undone + risen + pressed;
    assert!(all * 100 >= 400 * 97, "only {all} of 400");
    for (name, count) in
        [("erase", erased), ("smooth", smoothed), ("undo", undone), ("parent", risen), ("press", pressed)]
    {
        assert!(count >= 75, "{name}: only {count} of 80");
    }
}

fn crosses_a_button(hand: &mut Hand, size: f32, pace: f32, sketch: &Sketch) -> bool {
    let side = hand.between(40.0, 64.0);
    let buttons: Vec<Button> = (0..6)
        .map(|i| {
            let min = Vec2::new(16.0 + 30.0, 60.0 + 90.0 * i as f32);
            Button { min, max: min + side }
        })
        .collect();
    let meant = hand.random.usize(0..6);
    let middle = 0.5 * (buttons[meant].min + buttons[meant].max);
    let miss = Vec2::new(hand.between(-0.2, 0.2), hand.between(-0.2, 0.2)) * side;
    let towards = [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y][hand.random.usize(0..4)];
    // Strokes of 1.9 to 3 sides, which at this distance do not reach the next button's far side.
    let length = side * (1.5 + 4.8 * size);
    let from = middle + miss - 0.5 * length * towards;
    let stroke = straight(hand, from, towards, 0.3, length, pace * 400.0);
    let context = Context { buttons: &buttons, ..context(sketch) };
    recognise(&stroke, &context) == Some(Gesture::Press(meant))
}

#[test]
fn an_erasing_scribble_takes_away_what_lies_under_it_and_splits_the_outline() {
    let mut sketch = round_sketch(200.0);
    let stroke = scribble(&mut Hand::new(3), 100.0, 1200.0);
    let Some(Gesture::Erase(area)) = recognise(&stroke, &context(&sketch)) else { panic!("not recognised") };
    let inside = sketch.places().filter(|p| area.contains(*p)).count();
    assert!(inside > 0, "the box {area:?} holds nothing");
    assert!(sketch.erase(&area));
    let slightly_less = sketch::stroke::OrientedBox { half: area.half * 0.999, ..area };
    assert!(sketch.places().all(|p| !slightly_less.contains(p)), "samples are left in {area:?}");
    assert_eq!(sketch.strokes.len(), 2, "a round outline that starts elsewhere falls into two");
    assert!(sketch.undo_last_stroke() && sketch.is_empty(), "both pieces are one stroke");
}

/// Rubs back and forth along the outline's right side, as tight as a hand does; along a straight line there if
/// `radius` is infinite.
fn rub_along(hand: &mut Hand, radius: f32, size: f32, speed: f32) -> Stroke {
    let passes = hand.between(6.0, 11.0).floor();
    let (width, slant) = (hand.between(0.03, 0.4), hand.between(-0.15, 0.15));
    let uneven: Vec<f32> = (0..=passes as usize + 1).map(|_| hand.between(0.8, 1.1)).collect();
    let miss = Vec2::new(hand.between(-0.05, 0.05) * size, hand.between(-20.0, 20.0));
    let path = move |t: f32| {
        let way = t * passes;
        let along = uneven[way as usize] * 0.5 * size * (PI * way).cos();
        let inwards = 0.5 * along * along / radius;
        let straight = Vec2::new((t - 0.5) * width * size - inwards, along);
        0.5 * SCREEN + Vec2::new(200.0, 0.0) + miss + straight.rotate(Vec2::from_angle(slant))
    };
    hand.draw(path, size, passes * size, speed)
}

#[test]
fn rubbing_along_a_line_erases_it_and_hatching_along_one_does_not() {
    let upright = line_sketch([0.0, -300.0], [0.0, 300.0]);
    let round = round_sketch(200.0);
    for (name, sketch, radius) in
        [("a straight line", &upright, f32::INFINITY), ("a round outline", &round, 200.0)]
    {
        let erased = recognised(name, |hand, size, pace| {
            let stroke = rub_along(hand, radius, size * SCREEN.y, pace * 2.0 * SCREEN.y);
            matches!(recognise(&stroke, &context(sketch)), Some(Gesture::Erase(_)))
        });
        assert!(erased >= 76, "{name}: {erased} of 80");
    }
    // A box filled with hatching along its long sides, up to its edges.
    let sides = [[-30.0, -100.0], [30.0, -100.0], [30.0, 100.0], [-30.0, 100.0], [-30.0, -100.0]];
    let at = |p: [f32; 2]| 0.5 * SCREEN + Vec2::from(p);
    let sketch = Sketch::from_strokes(&[Stroke::through(sides.map(at))]);
    let filled = recognised("hatching", |hand, _, pace| {
        let passes = hand.between(6.0, 11.0).floor();
        let reach = hand.between(0.85, 0.97);
        let path = |t: f32| {
            let across = 2.0 * t - 1.0;
            at([27.0 * across, 100.0 * reach * (PI * t * passes).cos()])
        };
        let stroke = hand.draw(path, 60.0, passes * 200.0, pace * 2.0 * SCREEN.y);
        recognise(&stroke, &context(&sketch)).is_none()
    });
    assert!(filled >= 76, "hatching: {filled} of 80 are left alone");
}

/// A sketch of one straight line, given from where the round outline's right side is.
fn line_sketch(from: [f32; 2], to: [f32; 2]) -> Sketch {
    let spot = 0.5 * SCREEN + Vec2::new(200.0, 0.0);
    let place = |i| spot + Vec2::from(from).lerp(to.into(), i as f32 / 30.0);
    Sketch::from_strokes(&[Stroke::through((0..=30).map(place))])
}

#[test]
fn circling_twice_smooths_what_is_inside_and_nothing_else() {
    let mut sketch = round_sketch(200.0);
    let stroke = circles(&mut Hand::new(5), 120.0, 900.0);
    let Some(Gesture::Smooth(polygon)) = recognise(&stroke, &context(&sketch)) else {
        panic!("not recognised")
    };
    let smoothed = sketch.smooth(&polygon);
    assert!((1..20).contains(&smoothed), "{smoothed} samples were smoothed");
    let spot = 0.5 * SCREEN + Vec2::new(200.0, 0.0);
    for sample in sketch.strokes.iter().flat_map(|stroke| &stroke.samples) {
        let away = sample.pen.place().distance(spot);
        // The circles are 60 px wide about their wandering middle, at most 40 % flatter across.
        assert!(sample.smoothing == 1.0 || away > 24.0, "{away} px from the middle and not smoothed");
        assert!(sample.smoothing == 0.0 || away < 96.0, "{away} px from the middle and smoothed");
    }
}

#[test]
fn a_gesture_is_seen_only_where_it_can_mean_something() {
    let (sketch, empty, outline) = (round_sketch(200.0), Sketch::default(), selection());
    let rub = scribble(&mut Hand::new(1), 120.0, 3000.0);
    let round = circles(&mut Hand::new(1), 120.0, 800.0);
    let flick = straight(&mut Hand::new(1), 0.6 * SCREEN, Vec2::NEG_X, 0.1, 300.0, 3000.0);
    let line_up = straight(&mut Hand::new(1), 0.6 * SCREEN, Vec2::NEG_Y, 0.1, 250.0, 2000.0);
    for stroke in [&rub, &round, &flick, &line_up] {
        assert_eq!(recognise(stroke, &context(&empty)), None, "nothing is drawn or selected");
    }
    let selected = Context { selected: Some(&outline), ..context(&empty) };
    assert_eq!(recognise(&rub, &selected), Some(Gesture::Remove));
    assert_eq!(recognise(&line_up, &selected), Some(Gesture::SelectParent));
    let while_sketching = Context { selected: Some(&outline), ..context(&sketch) };
    assert_eq!(recognise(&line_up, &while_sketching), None, "the line belongs to the sketch");
    assert_eq!(recognise(&flick, &while_sketching), Some(Gesture::Undo));
}

#[test]
fn slow_strokes_and_strokes_without_times_are_no_flicks() {
    let sketch = round_sketch(200.0);
    let slow = straight(&mut Hand::new(2), 0.6 * SCREEN, Vec2::NEG_X, 0.1, 300.0, 500.0);
    assert_eq!(recognise(&slow, &context(&sketch)), None);
    let quick = straight(&mut Hand::new(2), 0.6 * SCREEN, Vec2::NEG_X, 0.1, 300.0, 3000.0);
    assert_eq!(recognise(&quick, &context(&sketch)), Some(Gesture::Undo));
    assert_eq!(recognise(&Stroke::through(quick.places()), &context(&sketch)), None);
}

#[test]
fn a_button_is_pressed_from_side_to_side_only() {
    let button = Button { min: Vec2::new(100.0, 100.0), max: Vec2::new(150.0, 140.0) };
    let empty = Sketch::default();
    let context = Context { buttons: &[button], ..context(&empty) };
    let press = |from: [f32; 2], to: [f32; 2]| {
        recognise(&Stroke::through([from.into(), to.into()]), &context) == Some(Gesture::Press(0))
    };
    assert!(press([80.0, 120.0], [170.0, 125.0]), "rightwards");
    assert!(press([170.0, 120.0], [80.0, 125.0]), "leftwards");
    assert!(press([120.0, 80.0], [125.0, 170.0]), "downwards");
    assert!(!press([120.0, 120.0], [170.0, 125.0]), "starts in it");
    assert!(!press([80.0, 120.0], [130.0, 120.0]), "ends in it");
    assert!(!press([85.0, 130.0], [125.0, 85.0]), "cuts a corner");
    assert!(!press([80.0, 150.0], [170.0, 150.0]), "passes below");
    assert!(!press([-300.0, 120.0], [500.0, 120.0]), "a long line of a drawing");
}

#[test]
fn strokes_that_are_hardly_strokes_are_no_gestures() {
    let (sketch, outline) = (round_sketch(200.0), selection());
    let button = Button { min: Vec2::splat(f32::NAN), max: Vec2::INFINITY };
    let context = Context { selected: Some(&outline), buttons: &[button], ..context(&sketch) };
    let odd = [
        vec![],
        vec![Vec2::ZERO],
        vec![Vec2::ONE; 1000],
        vec![Vec2::NAN, Vec2::INFINITY],
        vec![Vec2::ZERO, Vec2::NAN, Vec2::splat(1e30)],
        vec![Vec2::ZERO, Vec2::splat(1e-30)],
        (0..1_000_000).map(|i| Vec2::new((i % 7) as f32, (i % 11) as f32)).collect(),
    ];
    for places in odd {
        let count = places.len();
        assert!(
            recognise(&Stroke::through(places), &context).is_none_or(|_| count > 1000),
            "{count} samples"
        );
    }
}

#[test]
fn single_loops_spirals_and_zigzags_beside_the_sketch_are_drawings() {
    let sketch = round_sketch(200.0);
    let spot = 0.5 * SCREEN + Vec2::new(200.0, 0.0);
    let loop_once = (0..80).map(|i| spot + 60.0 * Vec2::from_angle(1.4 * TAU * i as f32 / 80.0));
    let spiral = (0..200).map(|i| spot + 0.5 * i as f32 * Vec2::from_angle(3.0 * TAU * i as f32 / 200.0));
    let teeth = (0..20).map(|i| 0.1 * SCREEN + Vec2::new(20.0 * i as f32, 40.0 * (i % 2) as f32));
    let inside = (0..20).map(|i| 0.5 * SCREEN + Vec2::new(3.0 * i as f32, 60.0 * (i % 2) as f32));
    for (name, stroke) in [
        ("a loop", Stroke::through(loop_once)),
        ("a spiral", Stroke::through(spiral)),
        ("teeth", Stroke::through(teeth)),
        ("hatching inside the outline", Stroke::through(inside)),
    ] {
        assert_eq!(recognise(&stroke, &context(&sketch)), None, "{name}");
    }
}
