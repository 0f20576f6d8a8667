//! The expectation list: what is suggested where, and that the commands do what their sentences say.

mod front;

use blobtree::build::{Build, cuboid, point, union};
use blobtree::{
    Command, Document, Drawing, DrawnStroke, Field, FieldImage, ISO, NodePath, NodeRef, Scene, Template, Tree,
};
use front::{SCREEN, empty_scene, front};
use glam::{Vec2, Vec3};
use sketch::stroke::{PenSample, Sketch, Stroke};
use sketch::suggest::{Coverage, Expectations, Icon, Outlines, Projection, Request, View, suggest};
use std::f32::consts::TAU;
use std::sync::Arc;

/// A round outline about a place of the model's x-z plane, mm, as seen from the front.
fn ring(x: f32, z: f32, radius: f32) -> Stroke {
    let place = |i| px(Vec2::new(x, z) + radius * Vec2::from_angle(TAU * i as f32 / 48.0));
    Stroke::through((0..=48).map(place))
}

fn line(from: [f32; 2], to: [f32; 2]) -> Stroke {
    Stroke::through((0..=40).map(|i| px(Vec2::from(from).lerp(to.into(), i as f32 / 40.0))))
}

/// Where a place of the x-z plane shows from the front.
fn px(place: Vec2) -> Vec2 {
    0.5 * SCREEN + 10.0 * Vec2::new(place.x, -place.y)
}

/// Takes each stroke that ends where it began as an outline, by distances to its polygon.
struct Loops;

impl Outlines for Loops {
    type Reason = &'static str;

    fn left_out(&self, drawing: &Drawing) -> Result<Vec<usize>, &'static str> {
        let open: Vec<usize> = (0..drawing.strokes.len()).filter(|&i| !closes(&drawing.strokes[i])).collect();
        if open.len() < drawing.strokes.len() { Ok(open) } else { Err("not closed") }
    }

    fn template(&self, drawing: &Drawing) -> Result<Arc<Template>, &'static str> {
        assert!(drawing.strokes.iter().all(closes), "the template is of the outline alone");
        Ok(template(drawing).into())
    }
}

fn closes(stroke: &DrawnStroke) -> bool {
    let points = &stroke.points;
    points.len() > 8 && points[0].at.distance(points[points.len() - 1].at) < 0.2
}

fn template(drawing: &Drawing) -> Template {
    let contours: Vec<Vec<Vec2>> =
        drawing.strokes.iter().map(|stroke| stroke.points.iter().map(|point| point.at).collect()).collect();
    let [lo, hi] =
        contours.iter().flatten().fold([Vec2::MAX, Vec2::MIN], |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
    let depth = 0.5 * (hi - lo).min_element();
    let falloff = 1.2 * depth;
    let (origin, size) = (lo - 1.5 * falloff, (hi - lo).max_element() + 3.0 * falloff);
    let pixel = size / 128.0;
    let place = |i: usize| origin + pixel * Vec2::new((i % 129) as f32, (i / 129) as f32);
    let samples = (0..129 * 129).map(|i| signed_distance(&contours, place(i))).collect();
    let distance = FieldImage::new(origin, pixel, [129, 129], samples).expect("finite samples");
    let bulge = distance.bulge(depth);
    Template { distance, bulge, pressure: None, falloff, depth, contours, corners: Vec::new() }
}

fn signed_distance(contours: &[Vec<Vec2>], p: Vec2) -> f32 {
    let (mut nearest, mut inside) = (f32::MAX, false);
    for pair in contours.iter().flat_map(|contour| contour.windows(2)) {
        let (a, b) = (pair[0], pair[1]);
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        nearest = nearest.min(p.distance(a.lerp(b, t)));
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    if inside { -nearest } else { nearest }
}

fn expected(strokes: &[Stroke], root: &NodeRef) -> Expectations<&'static str> {
    expected_of(strokes, root, None, None)
}

fn expected_of(
    strokes: &[Stroke],
    root: &NodeRef,
    selected: Option<&NodePath>,
    depth: Option<f32>,
) -> Expectations<&'static str> {
    let sketch = Sketch::from_strokes(strokes);
    suggest(&Request { sketch: &sketch, view: front(), root, selected, depth }, &Loops)
}

fn icons(expectations: &Expectations<&'static str>) -> Vec<Icon> {
    expectations.suggestions.iter().map(|suggestion| suggestion.icon).collect()
}

/// The field after the suggestion was taken.
fn taken(expectations: &Expectations<&'static str>, icon: Icon, root: &NodeRef) -> Tree {
    let found = expectations.suggestions.iter().find(|suggestion| suggestion.icon == icon);
    let command = found.unwrap_or_else(|| panic!("no {icon:?} in {:?}", icons(expectations))).command.clone();
    let mut document = Document::new(Scene::new(root.clone())).expect("legal");
    document.apply(command).expect("the command can be carried out");
    let tree = Tree::new(&document.scene().root);
    assert!(document.undo().is_some() && document.undo().is_none(), "one command is one step");
    tree
}

fn is_solid(tree: &Tree, place: [f32; 3]) -> bool {
    tree.value(place.into()) >= ISO
}

#[test]
fn an_outline_beside_everything_becomes_a_shape_of_its_own() {
    let root = empty_scene();
    let seen = expected(&[ring(5.0, 3.0, 6.0)], &root);
    assert_eq!(icons(&seen), [Icon::Inflate, Icon::Sweep, Icon::Revolve]);
    assert_eq!((seen.coverage, seen.no_outline), (Coverage::Beside, None));
    assert!((seen.depth - 100.0).abs() < 1e-3, "without evidence the plane goes through the origin");
    for icon in [Icon::Inflate, Icon::Revolve] {
        let ball = taken(&seen, icon, &root);
        assert!(is_solid(&ball, [5.0, 0.0, 3.0]) && is_solid(&ball, [10.5, 0.0, 3.0]), "{icon:?}");
        assert!(
            is_solid(&ball, [5.0, -5.5, 3.0]) && !is_solid(&ball, [9.9, -4.9, 3.0]),
            "{icon:?} is a ball"
        );
        assert!(!is_solid(&ball, [11.5, 0.0, 3.0]) && !is_solid(&ball, [5.0, -6.5, 3.0]), "{icon:?}");
    }
    let disc = taken(&seen, Icon::Sweep, &root);
    // Half of 12 mm thick, in the middle of the plane.
    assert!(is_solid(&disc, [10.0, 2.9, 3.0]) && is_solid(&disc, [10.0, -2.9, 3.0]));
    assert!(!is_solid(&disc, [5.0, 3.2, 3.0]) && !is_solid(&disc, [5.0, -3.2, 3.0]));
}

#[test]
fn an_outline_inside_the_silhouette_first_offers_a_hole_which_goes_right_through() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).into();
    let seen = expected(&[ring(5.0, 3.0, 6.0)], &root);
    assert_eq!(seen.coverage, Coverage::Inside);
    assert_eq!(icons(&seen)[..3], [Icon::CutHole, Icon::BlendOn, Icon::DrawOn]);
    assert!((seen.depth - 94.0).abs() < 0.01, "the plane lies on the front, not at {}", seen.depth);
    let bored = taken(&seen, Icon::CutHole, &root);
    for y in [-5.9, 0.0, 5.9] {
        assert!(!is_solid(&bored, [5.0, y, 3.0]), "skin at {y}");
        assert!(!is_solid(&bored, [10.7, y, 3.0]) && is_solid(&bored, [11.3, y, 3.0]), "edge at {y}");
    }
    let grown = taken(&seen, Icon::BlendOn, &root);
    assert!(is_solid(&grown, [5.0, -11.0, 3.0]), "a bump of 6 mm sticks out of the front");
    assert!(!is_solid(&grown, [-15.0, -7.0, 3.0]), "far away, the front stays");
}

#[test]
fn an_outline_across_the_silhouette_grows_first_and_can_cut_a_piece_off() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).into();
    let seen = expected(&[ring(20.0, 0.0, 8.0)], &root);
    assert_eq!(seen.coverage, Coverage::Across);
    assert_eq!(icons(&seen)[..3], [Icon::BlendOn, Icon::CutAcross, Icon::DrawOn]);
    assert!(!icons(&seen).contains(&Icon::CutHole));
    let cut = taken(&seen, Icon::CutAcross, &root);
    assert!(!is_solid(&cut, [19.0, 0.0, 0.0]) && !is_solid(&cut, [12.6, 5.0, 0.0]));
    assert!(is_solid(&cut, [11.4, 5.0, 0.0]) && is_solid(&cut, [19.0, 0.0, 12.0]));
    assert!(is_solid(&taken(&seen, Icon::BlendOn, &root), [26.0, -6.0, 0.0]));
}

#[test]
fn an_open_stroke_on_the_model_is_drawn_onto_it_thinner_at_its_ends() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [60.0, 12.0, 40.0]).into();
    let seen = expected(&[line([-20.0, 0.0], [20.0, 0.0])], &root);
    assert_eq!(icons(&seen), [Icon::DrawOn]);
    assert_eq!(seen.no_outline, Some("not closed"));
    let drawn = taken(&seen, Icon::DrawOn, &root);
    // The tube's radius is a fortieth of 40 mm in its middle, and a third of that at its tips.
    assert!(is_solid(&drawn, [0.0, -6.9, 0.0]) && !is_solid(&drawn, [0.0, -7.1, 0.0]));
    assert!(is_solid(&drawn, [20.0, -6.3, 0.0]) && !is_solid(&drawn, [20.0, -6.5, 0.0]));
    assert!(!is_solid(&drawn, [0.0, -6.5, 5.0]));
}

#[test]
fn tubes_on_the_surface_are_thinner_where_the_pen_pressed_less() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [60.0, 12.0, 40.0]).into();
    let mut stroke = line([-20.0, 0.0], [20.0, 0.0]);
    for sample in &mut stroke.samples {
        let right = sample.x > 0.5 * SCREEN.x;
        *sample = PenSample { pressure: if right { 1.0 } else { 0.0 }, ..*sample };
    }
    let drawn = taken(&expected(&[stroke], &root), Icon::DrawOn, &root);
    assert!(is_solid(&drawn, [8.0, -6.8, 0.0]) && !is_solid(&drawn, [-8.0, -6.3, 0.0]));
}

#[test]
fn a_stroke_over_two_depths_becomes_two_tubes_without_a_bridge() {
    let near = cuboid([-10.0, -20.0, 0.0], [20.0, 4.0, 20.0]);
    let far = cuboid([10.0, 20.0, 0.0], [20.0, 4.0, 20.0]);
    let root: NodeRef = union([near, far]).into();
    let drawn = taken(&expected(&[line([-15.0, 0.0], [15.0, 0.0])], &root), Icon::DrawOn, &root);
    assert!(is_solid(&drawn, [-8.0, -22.5, 0.0]) && is_solid(&drawn, [8.0, 17.5, 0.0]));
    assert!((-15..15).all(|y| !is_solid(&drawn, [0.0, y as f32, 0.0])), "there is a bridge");
}

#[test]
fn construction_nodes_are_drawn_on_though_they_are_no_part_of_the_solid() {
    let root: NodeRef = union([point([0.0, 0.0, 0.0], 15.0).construction()]).into();
    let seen = expected(&[line([-10.0, 0.0], [10.0, 0.0])], &root);
    assert_eq!((seen.coverage, icons(&seen)), (Coverage::Beside, vec![Icon::DrawOn]));
    let drawn = taken(&seen, Icon::DrawOn, &root);
    assert!(is_solid(&drawn, [0.0, -15.0, 0.0]), "the tube bends over the ball's front");
    assert!(is_solid(&drawn, [7.0, -13.27, 0.0]) && !is_solid(&drawn, [7.0, -15.0, 0.0]));
    assert!(!is_solid(&drawn, [0.0, 0.0, 0.0]), "the ball itself is not there");
}

#[test]
fn an_outline_with_an_open_stroke_beside_it_is_pulled_along_that_stroke() {
    let root = empty_scene();
    let bend = Stroke::through((0..=30).map(|i| {
        px(Vec2::new(-20.0, 0.0) + 20.0 * Vec2::from_angle(TAU / 4.0 * i as f32 / 30.0 - TAU / 8.0))
    }));
    let seen = expected(&[ring(20.0, 10.0, 2.0), bend], &root);
    assert_eq!(icons(&seen)[0], Icon::SweepAlong);
    let pulled = taken(&seen, Icon::SweepAlong, &root);
    for degrees in [-40.0f32, 0.0, 40.0] {
        let place = Vec2::new(-20.0, 0.0) + 20.0 * Vec2::from_angle(degrees.to_radians());
        assert!(is_solid(&pulled, [place.x, 0.0, place.y]), "not at {degrees}°");
        assert!(is_solid(&pulled, [place.x, 1.7, place.y]), "thin at {degrees}°");
        assert!(!is_solid(&pulled, [place.x, 2.3, place.y]), "thick at {degrees}°");
    }
    assert!(!is_solid(&pulled, [20.0, 0.0, 10.0]), "the outline itself stays a plan");
}

#[test]
fn a_straight_stroke_beside_an_outline_is_the_axis_about_which_it_turns() {
    let root = empty_scene();
    let seen = expected(&[ring(10.0, 0.0, 3.0), line([0.0, -10.0], [0.0, 10.0])], &root);
    assert_eq!(icons(&seen)[..2], [Icon::Revolve, Icon::SweepAlong]);
    let ring = taken(&seen, Icon::Revolve, &root);
    for place in [[10.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [0.0, 10.0, 2.5], [0.0, -10.0, 0.0]] {
        assert!(is_solid(&ring, place), "{place:?}");
    }
    assert!(!is_solid(&ring, [0.0, 0.0, 0.0]) && !is_solid(&ring, [0.0, 10.0, 3.5]));
}

#[test]
fn the_plane_lies_at_the_depth_of_the_selected_part_or_where_the_caller_says() {
    let back = cuboid([0.0, 30.0, 0.0], [60.0, 2.0, 60.0]);
    let root: NodeRef = union([point([0.0, 0.0, 0.0], 5.0), back]).into();
    let strokes = [ring(0.0, 0.0, 1.0)];
    let front = expected(&strokes, &root);
    assert!((front.depth - (100.0 - 4.9)).abs() < 0.05, "on the ball, not at {}", front.depth);
    let wall = NodePath::default().child(1);
    let behind = expected_of(&strokes, &root, Some(&wall), None);
    assert!((behind.depth - 129.0).abs() < 0.05, "on the wall, not at {}", behind.depth);
    let bored = taken(&behind, Icon::CutHole, &root);
    assert!(!is_solid(&bored, [0.0, 30.0, 0.0]), "the selected wall is bored");
    assert!(is_solid(&bored, [0.0, 0.0, 0.0]), "the ball before it is not");
    let said = expected_of(&strokes, &root, Some(&wall), Some(80.0));
    assert_eq!((said.depth, said.coverage), (80.0, Coverage::Inside));
    assert!(is_solid(&taken(&said, Icon::Inflate, &root), [0.0, -20.0, 0.0]));
}

#[test]
fn commands_on_a_part_below_a_warp_work_where_they_were_seen() {
    let turned = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).translate([15.0, 0.0, 0.0]);
    let root: NodeRef = union([turned]).into();
    let block = NodePath::default().child(0).child(0);
    let seen = expected_of(&[ring(25.0, 0.0, 4.0)], &root, Some(&block), None);
    assert_eq!(icons(&seen)[0], Icon::CutHole);
    let bored = taken(&seen, Icon::CutHole, &root);
    assert!(!is_solid(&bored, [25.0, 0.0, 0.0]) && is_solid(&bored, [15.0, 0.0, 0.0]));
}

#[test]
fn like_commands_go_into_one_operator_and_others_around_it() {
    let root: NodeRef = union([point([0.0, 0.0, 0.0], 5.0)]).into();
    let seen = expected(&[ring(20.0, 0.0, 3.0)], &root);
    assert!(matches!(&seen.suggestions[0].command, Command::Insert { index: 1, .. }));
    let alone: NodeRef = point([0.0, 0.0, 0.0], 5.0).into();
    let seen = expected(&[ring(20.0, 0.0, 3.0)], &alone);
    assert!(matches!(&seen.suggestions[0].command, Command::Replace { .. }));
    assert!(is_solid(&taken(&seen, Icon::Inflate, &alone), [0.0, 0.0, 0.0]), "what was there stays");
}

#[test]
fn a_perspective_view_puts_the_outline_where_it_was_seen() {
    let eye = Vec3::new(30.0, -80.0, 50.0);
    let view = View::look_at(eye, Vec3::ZERO, SCREEN, Projection::Perspective { height_degrees: 40.0 });
    for place in [Vec3::new(3.0, 4.0, 5.0), Vec3::new(-20.0, 0.0, 10.0), Vec3::ZERO] {
        let seen = view.screen_from_model(place).expect("before the eye");
        assert!(view.at_depth(seen, view.depth(place)).distance(place) < 1e-3, "{place}");
        let ray = view.ray(seen);
        assert!((place - ray.origin).cross(ray.direction).length() < 1e-3, "{place}");
    }
    assert_eq!(view.screen_from_model(eye - view.forward), None);
    let root: NodeRef = point([0.0, 0.0, 0.0], 20.0).into();
    let around = (0..=48).map(|i| 0.5 * SCREEN + 60.0 * Vec2::from_angle(TAU * i as f32 / 48.0));
    let sketch = Sketch::from_strokes(&[Stroke::through(around)]);
    let seen = suggest(&Request { sketch: &sketch, view, root: &root, selected: None, depth: None }, &Loops);
    assert_eq!(icons(&seen)[0], Icon::CutHole);
    let bored = taken(&seen, Icon::CutHole, &root);
    for t in [-19.0, 0.0, 19.0] {
        assert!(bored.value(view.forward * t) < ISO, "skin at {t}");
    }
}

#[test]
fn every_suggestion_has_its_own_words_and_picture() {
    let all = [
        Icon::Inflate,
        Icon::Sweep,
        Icon::Revolve,
        Icon::CutHole,
        Icon::CutAcross,
        Icon::BlendOn,
        Icon::DrawOn,
        Icon::SweepAlong,
    ];
    for (i, icon) in all.into_iter().enumerate() {
        assert!(icon.sentence().ends_with('.') && !icon.name().is_empty());
        for other in &all[..i] {
            assert_ne!(
                (icon.name(), icon.id(), icon.sentence()),
                (other.name(), other.id(), other.sentence())
            );
        }
    }
    assert_eq!(Icon::CutHole.sentence(), "Cut a hole here.");
}

#[test]
fn odd_sketches_views_and_models_give_no_suggestion_or_a_sane_one() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).into();
    let nowhere = NodePath(vec![7, 7]);
    let no_view = View { eye: Vec3::NAN, screen: Vec2::ZERO, ..front() };
    let sketches = [
        vec![],
        vec![Stroke::default()],
        vec![Stroke::through([Vec2::NAN])],
        vec![Stroke::through([0.5 * SCREEN])],
        vec![Stroke::through([Vec2::ZERO, SCREEN])],
        vec![Stroke::through((0..3000).map(|i| Vec2::splat((i * i % 977) as f32)))],
    ];
    for strokes in &sketches {
        let sketch = Sketch::from_strokes(strokes);
        for (view, selected, depth) in
            [(front(), None, None), (no_view, None, None), (front(), Some(&nowhere), Some(f32::NAN))]
        {
            for root in [&root, &empty_scene()] {
                let seen = suggest(&Request { sketch: &sketch, view, root, selected, depth }, &Loops);
                for suggestion in &seen.suggestions {
                    let mut document = Document::new(Scene::new(root.clone())).expect("legal");
                    let _ = document.apply(suggestion.command.clone());
                }
            }
        }
    }
    assert!(expected(&sketches[0], &root).suggestions.is_empty());
}
