//! Suggestions with outlines that are really found and solved: drawn by a shaking hand, taken, solved again.

mod front;

use blobtree::build::cuboid;
use blobtree::{Document, Field, ISO, NodeRef, Primitive, Scene, Shape, Tree};
use front::{SCREEN, empty_scene, front};
use glam::{Vec2, Vec3};
use sketch::Solver;
use sketch::curve::NoOutline;
use sketch::stroke::{Sketch, Stroke};
use sketch::suggest::{Coverage, Expectations, Icon, Request, suggest};
use std::f32::consts::TAU;

/// Draws along a path of the x-z plane, mm, a function of 0 to 1, with the tremor of a hand: about 1 px.
fn draw(seed: u64, path: impl Fn(f32) -> Vec2) -> Stroke {
    let mut random = fastrand::Rng::with_seed(seed);
    let waves: Vec<[f32; 3]> =
        (0..4).map(|_| [4.0 + 8.0 * random.f32(), TAU * random.f32(), TAU * random.f32()]).collect();
    Stroke::through((0..=120).map(|i| {
        let t = i as f32 / 120.0;
        let shake = waves.iter().map(|[w, x, y]| Vec2::new((w * TAU * t + x).sin(), (w * TAU * t + y).sin()));
        let place = path(t) + 0.05 * shake.sum::<Vec2>();
        (0.5 * SCREEN + 10.0 * Vec2::new(place.x, -place.y)).round()
    }))
}

/// A round outline that overshoots its beginning a little.
fn ring(seed: u64, x: f32, z: f32, radius: f32) -> Stroke {
    draw(seed, |t| Vec2::new(x, z) + radius * Vec2::from_angle(1.02 * TAU * t + seed as f32))
}

fn line(seed: u64, from: [f32; 2], to: [f32; 2]) -> Stroke {
    draw(seed, |t| Vec2::from(from).lerp(to.into(), t))
}

fn expected(strokes: &[Stroke], root: &NodeRef) -> Expectations<NoOutline> {
    let sketch = Sketch::from_strokes(strokes);
    suggest(&Request { sketch: &sketch, view: front(), root, selected: None, depth: None }, &Solver)
}

fn icons(expectations: &Expectations<NoOutline>) -> Vec<Icon> {
    expectations.suggestions.iter().map(|suggestion| suggestion.icon).collect()
}

/// The field after a suggestion was taken, whose template is what its strokes will give when the scene is read.
fn taken(expectations: &Expectations<NoOutline>, icon: Icon, root: &NodeRef) -> Tree {
    let found = expectations.suggestions.iter().find(|suggestion| suggestion.icon == icon);
    let command = found.unwrap_or_else(|| panic!("no {icon:?} in {:?}", icons(expectations))).command.clone();
    let mut document = Document::new(Scene::new(root.clone())).expect("legal");
    document.apply(command).expect("the command can be carried out");
    let tops = document.scene().root.children();
    let new = tops.last().expect("there is something new");
    let Shape::Primitive(primitive) = &new.shape else { panic!("{icon:?} makes {:?}", new.shape) };
    let (drawing, template) = match primitive {
        Primitive::Inflation(p) => (&p.drawing, &p.template),
        Primitive::LinearSweep(p) => (&p.drawing, &p.template),
        Primitive::Revolution(p) => (&p.drawing, &p.template),
        Primitive::PathSweep(p) => (&p.drawing, &p.template),
        other => panic!("{icon:?} makes {other:?}"),
    };
    let again = sketch::solve(drawing, None).expect("it has an outline");
    assert!(again == template.0, "{icon:?}: its strokes give another field when they are read again");
    Tree::new(&document.scene().root)
}

fn is_solid(tree: &Tree, place: [f32; 3]) -> bool {
    tree.value(place.into()) >= ISO
}

#[test]
fn a_drawn_ring_becomes_a_ball_or_a_disc() {
    let root = empty_scene();
    for seed in 0..3 {
        let seen = expected(&[ring(seed, 5.0, 3.0, 6.0)], &root);
        assert_eq!(icons(&seen), [Icon::Inflate, Icon::Sweep, Icon::Revolve], "seed {seed}");
        assert_eq!((seen.coverage, &seen.no_outline), (Coverage::Beside, &None));
        for icon in [Icon::Inflate, Icon::Revolve] {
            let ball = taken(&seen, icon, &root);
            let around =
                (0..24).map(|i| Vec3::new((i as f32).cos(), (i as f32).sin(), (1.7 * i as f32).sin()));
            for direction in around.map(Vec3::normalize_or_zero) {
                let at = |radius: f32| (Vec3::new(5.0, 0.0, 3.0) + radius * direction).to_array();
                assert!(is_solid(&ball, at(5.7)) && !is_solid(&ball, at(6.3)), "{icon:?}, seed {seed}");
            }
        }
        let disc = taken(&seen, Icon::Sweep, &root);
        assert!(is_solid(&disc, [10.6, 2.8, 3.0]) && !is_solid(&disc, [10.6, 3.2, 3.0]), "seed {seed}");
    }
}

#[test]
fn an_outline_drawn_in_two_strokes_inside_the_silhouette_becomes_a_hole() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).into();
    let half = |seed, start: f32| {
        draw(seed, move |t| Vec2::new(5.0, 3.0) + 6.0 * Vec2::from_angle(start + 0.49 * TAU * t))
    };
    let seen = expected(&[half(1, 0.0), half(2, 0.5 * TAU)], &root);
    assert_eq!((icons(&seen)[0], seen.coverage), (Icon::CutHole, Coverage::Inside));
    let bored = taken(&seen, Icon::CutHole, &root);
    for y in [-5.9, 0.0, 5.9] {
        assert!(!is_solid(&bored, [5.0, y, 3.0]) && !is_solid(&bored, [10.6, y, 3.0]), "skin at {y}");
        assert!(is_solid(&bored, [11.4, y, 3.0]), "edge at {y}");
    }
    let grown = taken(&seen, Icon::BlendOn, &root);
    assert!(is_solid(&grown, [5.0, -11.0, 3.0]) && !is_solid(&grown, [-15.0, -7.0, 3.0]));
}

#[test]
fn an_outline_across_the_silhouette_cuts_off_what_it_covers() {
    let root: NodeRef = cuboid([0.0, 0.0, 0.0], [40.0, 12.0, 40.0]).into();
    let seen = expected(&[ring(4, 20.0, 0.0, 8.0)], &root);
    assert_eq!(icons(&seen)[..2], [Icon::BlendOn, Icon::CutAcross]);
    let cut = taken(&seen, Icon::CutAcross, &root);
    assert!(!is_solid(&cut, [19.0, 0.0, 0.0]) && !is_solid(&cut, [12.7, 5.0, 0.0]));
    assert!(is_solid(&cut, [11.3, 5.0, 0.0]) && is_solid(&cut, [19.0, 0.0, 12.0]));
}

#[test]
fn a_bent_stroke_beside_an_outline_is_a_path_and_a_straight_one_an_axis() {
    let root = empty_scene();
    let bend = draw(5, |t| Vec2::new(-20.0, 0.0) + 20.0 * Vec2::from_angle(0.25 * TAU * t - 0.125 * TAU));
    let seen = expected(&[ring(6, 20.0, 10.0, 3.0), bend], &root);
    assert_eq!(icons(&seen)[0], Icon::SweepAlong);
    let pulled = taken(&seen, Icon::SweepAlong, &root);
    for degrees in [-40.0f32, 0.0, 40.0] {
        let place = Vec2::new(-20.0, 0.0) + 20.0 * Vec2::from_angle(degrees.to_radians());
        assert!(is_solid(&pulled, [place.x, 2.5, place.y]), "thin at {degrees}°");
        assert!(!is_solid(&pulled, [place.x, 3.5, place.y]), "thick at {degrees}°");
    }
    for axis in [line(7, [0.0, -12.0], [0.0, 12.0]), line(8, [0.0, 12.0], [0.0, -12.0])] {
        let seen = expected(&[ring(9, 10.0, 0.0, 3.0), axis], &root);
        assert_eq!(icons(&seen)[0], Icon::Revolve);
        let turned = taken(&seen, Icon::Revolve, &root);
        for place in [[10.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [0.0, 10.0, 2.4], [0.0, -12.4, 0.0]] {
            assert!(is_solid(&turned, place), "{place:?}");
        }
        assert!(!is_solid(&turned, [0.0, 0.0, 0.0]) && !is_solid(&turned, [0.0, 10.0, 3.6]));
    }
}

#[test]
fn an_axis_drawn_through_a_figure_turns_it_about_its_middle() {
    let root = empty_scene();
    let egg = draw(10, |t| {
        let way = Vec2::from_angle(1.01 * TAU * t + 2.0);
        Vec2::new(4.0 + 5.0 * way.x, 8.0 * way.y)
    });
    let seen = expected(&[egg, line(11, [4.0, -11.0], [4.0, 11.0])], &root);
    assert_eq!(icons(&seen)[0], Icon::Revolve);
    let turned = taken(&seen, Icon::Revolve, &root);
    assert!(is_solid(&turned, [4.0, 4.6, 0.0]) && !is_solid(&turned, [4.0, 5.4, 0.0]));
    assert!(is_solid(&turned, [4.0, 0.0, 7.5]) && !is_solid(&turned, [4.0, 0.0, 8.5]));
}

#[test]
fn tails_smiles_and_whiskers_are_neither_paths_nor_axes() {
    let root = empty_scene();
    let head = || ring(12, 0.0, 0.0, 10.0);
    let smile = draw(13, |t| 5.0 * Vec2::from_angle(-0.1 * TAU - 0.3 * TAU * t));
    let stick = line(14, [0.0, -10.0], [0.3, -25.0]);
    let whiskers = [line(15, [6.0, 0.0], [16.0, 2.0]), line(16, [-6.0, 0.0], [-16.0, 2.0])];
    let tail = draw(17, |t| Vec2::new(10.0 + 12.0 * t, 5.0 * (4.0 * t).sin()));
    let rays = [0.0f32, 1.0, 2.0].map(|i| {
        let way = Vec2::from_angle(i);
        draw(18, move |t| way * (13.0 + 12.0 * t))
    });
    for (name, besides) in [
        ("a smile", vec![smile]),
        ("a stick", vec![stick]),
        ("whiskers", whiskers.to_vec()),
        ("a tail", vec![tail]),
        ("rays", rays.to_vec()),
    ] {
        let seen = expected(&[vec![head()], besides].concat(), &root);
        assert_eq!(icons(&seen)[0], Icon::Inflate, "{name}");
        assert_eq!(icons(&seen).last(), Some(&Icon::SweepAlong), "{name} could still be meant as a path");
        let ball = taken(&seen, Icon::Inflate, &root);
        assert!(is_solid(&ball, [9.3, 0.0, 0.0]) && !is_solid(&ball, [11.5, 0.0, 1.0]), "{name}");
    }
}

#[test]
fn what_has_no_outline_says_why() {
    let root = empty_scene();
    let seen = expected(&[line(19, [-10.0, 0.0], [10.0, 4.0])], &root);
    assert!(seen.suggestions.is_empty() && matches!(seen.no_outline, Some(NoOutline::Open { .. })));
    let dot = Stroke::through([0.5 * SCREEN]);
    assert_eq!(expected(&[dot], &root).no_outline, Some(NoOutline::Dots));
    assert_eq!(expected(&[], &root).no_outline, Some(NoOutline::Nothing));
}
