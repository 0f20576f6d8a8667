//! Strokes stay in the node: adding, erasing and smoothing single samples later solves it again, through the
//! document's commands and through the scene's text.

use blobtree::{
    Command, Document, Drawing, DrawingsBy, DrawnPoint, DrawnStroke, Field, ISO, JournalEntry, NewShape,
    Node, NodePath, NodeRef, Primitive, Scene, Shape, SketchPlane, Tree,
};
use glam::{Vec2, Vec3};
use sketch::solid::Outline;
use sketch::stroke::{OrientedBox, Placement, Sketch, Stroke};
use std::f32::consts::TAU;
use std::sync::Arc;

/// A pixel is a mm about the origin, so that strokes come back with the same bits.
const PLACEMENT: Placement = Placement { origin_px: Vec2::ZERO, mm_per_px: 1.0 };

/// A round outline of 20 mm about the origin with a bump of 1.5 mm to the right, 3 mm wide; it begins at the left.
fn bumpy() -> DrawnStroke {
    let point = |i| {
        let angle = TAU * i as f32 / 240.0;
        let bump = 1.5 * (-(20.0 * (angle - TAU / 2.0) / 1.5).powi(2)).exp();
        DrawnPoint::at((20.0 + bump) * -Vec2::from_angle(angle))
    };
    DrawnStroke { points: (0..=240).map(point).collect() }
}

fn square() -> DrawnStroke {
    let corners =
        [[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0], [-20.0, -20.0]].map(Vec2::from);
    let side = |w: &[Vec2]| (0..40).map(|i| w[0].lerp(w[1], i as f32 / 40.0)).collect::<Vec<_>>();
    let points = corners.windows(2).flat_map(side).chain([corners[4]]);
    DrawnStroke { points: points.map(DrawnPoint::at).collect() }
}

/// A plate of 10 mm in the x-z plane, in a scene of its own.
fn plate(strokes: Vec<DrawnStroke>) -> Document {
    let drawing = Arc::new(Drawing { strokes, ..Drawing::default() });
    let template = sketch::solve(&drawing, None).expect("it closes");
    let outline = Outline { drawing, plane: SketchPlane::default(), template };
    let sweep = blobtree::LinearSweep { length: 10.0, ..outline.sweep() };
    let root: NodeRef = Node::new(Shape::Primitive(Primitive::LinearSweep(sweep))).into();
    Document::new(Scene::new(root)).expect("legal")
}

fn primitive(scene: &Scene) -> &Primitive {
    let Shape::Primitive(primitive) = &scene.root.shape else { panic!("a single primitive") };
    primitive
}

fn strokes(scene: &Scene) -> &[DrawnStroke] {
    &sketch::drawing_of(primitive(scene)).expect("it is drawn").strokes
}

/// Changes the sketch of the one node in one command, and returns that command's line in the journal.
fn edit(document: &mut Document, change: impl FnOnce(&mut Sketch)) -> String {
    let old = primitive(document.scene());
    let mut sketch = PLACEMENT.sketch(sketch::drawing_of(old).expect("it is drawn"));
    change(&mut sketch);
    let new = sketch::redrawn(old.clone(), PLACEMENT.drawing(&sketch).strokes).expect("it still closes");
    let command = Command::SetShape { path: NodePath::default(), shape: NewShape::Primitive(new) };
    let line = JournalEntry::Command(command.clone()).to_line(document.scene()).expect("it can be written");
    document.apply(command).expect("a primitive for a primitive");
    line
}

/// How far the solid reaches from the origin in a direction of the plane, mm.
fn reach(scene: &Scene, degrees: f32) -> f32 {
    let tree = Tree::new(&scene.root);
    let way = Vec2::from_angle(degrees.to_radians());
    let at = |radius: f32| SketchPlane::default().point(radius * way);
    let inside = |radius: &f32| tree.value(at(*radius)) >= ISO;
    (0..4000).map(|i| 0.01 * i as f32).take_while(inside).last().unwrap_or(0.0)
}

fn assert_equal_fields(a: &Scene, b: &Scene, what: &str) {
    let (a, b) = (Tree::new(&a.root), Tree::new(&b.root));
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..500 {
        let place = Vec3::from_array([(); 3].map(|()| 60.0 * random.f32() - 30.0));
        assert_eq!(a.value(place), b.value(place), "{what}: another field at {place}");
    }
}

/// That the scene, its text read again, and the journal's line repeated on the scene before give one field.
fn assert_reads_back(document: &mut Document, line: &str) {
    let text = document.scene().to_text().expect("a scene can be written");
    let read = Scene::from_bytes(text.as_bytes(), &mut DrawingsBy(sketch::solve)).expect("it can be read");
    assert_eq!(strokes(&read), strokes(document.scene()), "all samples with their smoothing");
    assert_equal_fields(&read, document.scene(), "read again");
    let edited = document.scene().clone();
    document.undo().expect("there is an edit");
    let mut repeated = Document::new(document.scene().clone()).expect("legal");
    let entry = JournalEntry::from_line(line.as_bytes(), repeated.scene(), &mut DrawingsBy(sketch::solve))
        .expect("a line of ours");
    repeated.repeat(entry).expect("it fits");
    assert_equal_fields(repeated.scene(), &edited, "repeated from the journal");
    document.redo().expect("it was undone");
    assert_equal_fields(document.scene(), &edited, "done again");
}

#[test]
fn smoothing_some_samples_flattens_the_bump_there_and_leaves_the_rest() {
    let mut document = plate(vec![bumpy()]);
    let before = document.scene().clone();
    assert!((reach(&before, 0.0) - 21.5).abs() < 0.1);
    let line = edit(&mut document, |sketch| {
        let around = [[14.0, -9.0], [26.0, -9.0], [26.0, 9.0], [14.0, 9.0]].map(Vec2::from);
        for _ in 0..3 {
            assert!((20..40).contains(&sketch.smooth(&around)), "some samples");
        }
    });
    let smoothed = strokes(document.scene())[0].points.iter().filter(|p| p.smoothing == 3.0).count();
    assert!((20..40).contains(&smoothed), "{smoothed} samples are smoothed");
    assert!(reach(document.scene(), 0.0) < 20.7, "{}", reach(document.scene(), 0.0));
    for degrees in [60.0, 120.0, 180.0, 240.0, 300.0] {
        let moved = reach(document.scene(), degrees) - reach(&before, degrees);
        assert!(moved.abs() < 0.05, "{moved} mm at {degrees}°");
    }
    assert_reads_back(&mut document, &line);
}

#[test]
fn a_corner_whose_samples_are_smoothed_is_round_and_the_others_stay_sharp() {
    let mut document = plate(vec![square()]);
    let corners = |scene: &Scene| match primitive(scene) {
        Primitive::LinearSweep(sweep) => sweep.template.corners.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(corners(document.scene()).len(), 4);
    let line = edit(&mut document, |sketch| {
        // Pixels have y down: this is the upper right corner.
        let around = [[15.0, -25.0], [25.0, -25.0], [25.0, -15.0], [15.0, -15.0]].map(Vec2::from);
        assert!(sketch.smooth(&around) > 4 && sketch.smooth(&around) > 4);
    });
    let left = corners(document.scene());
    assert!(left.len() == 3 && left.iter().all(|c| c.x < 0.0 || c.y < 0.0), "{left:?}");
    let sharp = 20.0 * 2f32.sqrt();
    let (round, kept) = (reach(document.scene(), 45.0), reach(document.scene(), 225.0));
    assert!(round < sharp - 0.5 && (kept - sharp).abs() < 0.15, "{round} and {kept} mm");
    assert_reads_back(&mut document, &line);
}

#[test]
fn smoothing_written_into_a_scene_file_by_hand_is_solved_when_it_is_read() {
    let points = |smoothing: f32| -> String {
        let point = |p: &DrawnPoint| {
            let near = p.at.distance(Vec2::new(22.0, 0.0)) < 9.0;
            let smoothing = if near { smoothing } else { 0.0 };
            format!("[{}, {}, 1, {smoothing}]", p.at.x, p.at.y)
        };
        bumpy().points.iter().map(point).collect::<Vec<_>>().join(", ")
    };
    let scene = |smoothing: f32| {
        let points = points(smoothing);
        let text = format!(
            r#"{{"format": "trullo", "version": 1, "root": {{"type": "sweep", "length": 10,
                "drawing": {{"strokes": [{{"points": [{points}]}}]}}}}}}"#
        );
        Scene::from_bytes(text.as_bytes(), &mut DrawingsBy(sketch::solve)).expect("a legal scene")
    };
    let reaches = [0.0, 1.0, 2.0, 4.0].map(|smoothing| reach(&scene(smoothing), 0.0));
    assert!((reaches[0] - 21.5).abs() < 0.1, "{reaches:?}");
    assert!(reaches.is_sorted_by(|less, more| *more < less - 0.2) && reaches[3] < 20.5, "{reaches:?}");
}

#[test]
fn a_stroke_drawn_later_is_a_hole_and_erasing_it_fills_the_hole_again() {
    let mut document = plate(vec![bumpy()]);
    let whole = document.scene().clone();
    let ring = Stroke::through((0..=60).map(|i| 6.0 * Vec2::from_angle(TAU * i as f32 / 60.0)));
    let line = edit(&mut document, |sketch| sketch.add(&ring));
    assert_eq!(strokes(document.scene()).len(), 2);
    let tree = Tree::new(&document.scene().root);
    assert!(tree.value(Vec3::ZERO) < ISO && tree.value(Vec3::new(7.0, 0.0, 0.0)) >= ISO, "it is a hole");
    assert_reads_back(&mut document, &line);
    let line = edit(&mut document, |sketch| {
        let area = OrientedBox { center: Vec2::ZERO, half: Vec2::splat(8.0), axis: Vec2::X };
        assert!(sketch.erase(&area));
    });
    assert_equal_fields(document.scene(), &whole, "the hole is erased");
    assert_reads_back(&mut document, &line);
}

#[test]
fn an_erased_stretch_is_closed_by_what_is_drawn_there_next() {
    let mut document = plate(vec![bumpy()]);
    let line = edit(&mut document, |sketch| {
        let area = OrientedBox { center: Vec2::new(22.0, 0.0), half: Vec2::new(8.0, 10.0), axis: Vec2::X };
        assert!(sketch.erase(&area));
        assert_eq!(sketch.strokes.len(), 2, "the outline falls into two");
        let dent = (0..=30).map(|i| {
            let y = -10.0 + 20.0 * i as f32 / 30.0;
            Vec2::new(17.3 - 4.0 * (1.0 - (0.1 * y).powi(2)), y)
        });
        sketch.add(&Stroke::through(dent));
    });
    assert!((reach(document.scene(), 0.0) - 13.3).abs() < 0.3, "{}", reach(document.scene(), 0.0));
    assert!((reach(document.scene(), 180.0) - 20.0).abs() < 0.2);
    assert_reads_back(&mut document, &line);
}

#[test]
fn strokes_that_no_longer_close_are_refused_and_the_node_stays() {
    let document = plate(vec![bumpy()]);
    let old = primitive(document.scene());
    let mut sketch = PLACEMENT.sketch(sketch::drawing_of(old).expect("it is drawn"));
    assert_eq!(PLACEMENT.drawing(&sketch).strokes, strokes(document.scene()), "there and back");
    let most = OrientedBox { center: Vec2::new(10.0, 0.0), half: Vec2::new(25.0, 30.0), axis: Vec2::X };
    assert!(sketch.erase(&most));
    let refused = sketch::redrawn(old.clone(), PLACEMENT.drawing(&sketch).strokes).map(drop);
    assert!(matches!(refused, Err(sketch::curve::NoOutline::Open { .. })), "{refused:?}");
}
