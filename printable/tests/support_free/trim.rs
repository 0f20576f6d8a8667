//! Trim: the angle, in every direction; what stays as it was; what is smooth.

use crate::common::{Slices, baked, ball_on_stem, constrained, junction, radius, trimming};
use blobtree::build::{Build, cone, cuboid, cylinder, half_space, point, truncated_cone, union};
use blobtree::{Field, ISO, NodeRef, Tree};
use glam::{Vec2, Vec3};
use polygonizer::{CellSize, Options, Surface};

#[test]
fn the_overhang_let_through_is_the_one_that_was_set_in_sixteen_directions() {
    for degrees in [30.0_f32, 45.0, 60.0] {
        for layer in [0.1, 0.2, 0.25] {
            // Steeper than any of these angles all around.
            let tree = constrained(ball_on_stem(3.0, 14.0), trimming(degrees, layer));
            let low = junction(3.0, 14.0) + 1.0;
            let high = low + 1.0;
            for direction in 0..16 {
                let direction = Vec2::from_angle(direction as f32 * std::f32::consts::TAU / 16.0);
                let grown = radius(&tree, direction, high, 13.0) - radius(&tree, direction, low, 13.0);
                let found = (grown / (high - low)).atan().to_degrees();
                assert!(
                    (degrees - 1.5..=degrees + 0.2).contains(&found),
                    "{found}° for {degrees}° in layers of {layer} towards {direction}"
                );
            }
        }
    }
}

#[test]
fn slices_at_any_height_are_carried_by_those_below() {
    let scenes = [
        ball_on_stem(3.0, 7.0),
        ball_on_stem(1.5, 5.0),
        cuboid([0., 0., 4.], [4., 4., 8.]).union(cuboid([0., 0., 10.], [12., 12., 4.])),
        cylinder([0., 0., 0.], [0., 0., 3.], 6.).blend(point([0., 0., 9.], 6.)),
    ];
    for (number, scene) in scenes.into_iter().enumerate() {
        let tree = constrained(scene, trimming(45.0, 0.25));
        for offset in [0.125, 0.2, 0.06] {
            let slices = Slices::new(&tree, 0.25, offset, 8.0, 20.0, 0.04);
            // Half a pitch is the squares' own.
            let hanging = slices.unsupported(0.25 + 0.01 + 0.03);
            assert!(hanging < 0.15, "scene {number} cut from {offset} mm on: {hanging} mm²");
        }
    }
}

#[test]
fn a_shape_turned_about_the_vertical_loses_the_same() {
    let shape = || cylinder([0., 0., 0.], [0., 0., 6.], 2.).union(cuboid([0., 0., 9.], [14., 8., 6.]));
    let volume = |degrees: f32| {
        let tree = constrained(shape().rotate_degrees([0., 0., degrees]), trimming(45.0, 0.25));
        let cell = CellSize::from_mm(0.25).expect("legal");
        Surface::build(&tree, cell, &Options::default()).expect("small").mesh().volume()
    };
    let straight = volume(0.0);
    for degrees in [22.5, 45.0] {
        let turned = volume(degrees);
        assert!((turned / straight - 1.0).abs() < 5e-3, "{turned} mm³ at {degrees}°, {straight} mm³ at 0°");
    }
}

#[test]
fn what_prints_anyway_is_not_touched() {
    for (name, shape) in [
        ("box", cuboid([0., 0., 5.], [10., 12., 10.])),
        ("cone that opens by 40°", truncated_cone([0., 0., 0.], [0., 0., 10.], 4., 12.39)),
        ("dome", point([0., 0., 0.], 9.).subtract(half_space([0., 0., 0.], [0., 0., 1.]))),
        ("foot", truncated_cone([0., 0., 0.], [0., 0., 2.], 9., 2.)),
    ] {
        let (root, store) = baked(shape, trimming(45.0, 0.25));
        let bake = store.of(&root).expect("it was baked");
        // Close to the limit, interpolation takes up to half a thousandth.
        let close = name.starts_with("cone");
        let untouched = bake.limit.is_none() && bake.removed_mm3 == 0.0;
        assert!(untouched || close && bake.removed_mm3 < 1.5, "{name}: {} mm³", bake.removed_mm3);
    }
}

#[test]
fn far_from_what_was_taken_the_field_outside_is_the_childs_to_the_last_bit() {
    let child: NodeRef =
        union([cuboid([-30., 0., 10.], [10., 10., 20.]), ball_on_stem(3.0, 7.0).translate([20., 0., 0.])])
            .into();
    let (plain, tree) = (Tree::new(&child), constrained(child, trimming(45.0, 0.25)));
    let mut rng = fastrand::Rng::with_seed(1);
    for _ in 0..5000 {
        let p = Vec3::new(-40.0 + 20.0 * rng.f32(), -8.0 + 16.0 * rng.f32(), -2.0 + 25.0 * rng.f32());
        let (before, after) = (plain.value(p), tree.value(p));
        // Just above a flat bottom, what is inside may be limited a little.
        assert!(before == after || before > ISO && (before - after).abs() < 0.01, "{p}: {before}, {after}");
    }
    // And on the trimmed part's own sides: to 0.01 mm.
    for z in [2.0, 6.0, 17.5, 20.0] {
        let wide = |tree: &Tree| {
            let inside = |x: f32| tree.value(Vec3::new(20.0 + x, 0.0, z)) >= ISO;
            (0..2000).map(|i| i as f32 * 0.005).take_while(|x| inside(*x)).count() as f32 * 0.005
        };
        assert!((wide(&plain) - wide(&tree)).abs() < 0.01, "{} and {} at {z}", wide(&plain), wide(&tree));
    }
}

#[test]
fn trimmed_surfaces_are_as_smooth_as_cones() {
    for (stem, ball, degrees, layer, most) in [
        (3.0, 7.0, 45.0_f32, 0.25, 3.0),
        // The thinner the stem, the fewer steps of the lattice around it.
        (2.0, 9.0, 45.0, 0.25, 3.2),
        (4.0, 8.0, 45.0, 0.2, 3.0),
        (3.0, 12.0, 40.0, 0.25, 3.0),
        (3.0, 12.0, 55.0, 0.25, 3.0),
        (2.5, 10.0, 50.0, 0.2, 3.0),
    ] {
        let tree = constrained(ball_on_stem(stem, ball), trimming(degrees, layer));
        let low = junction(stem, ball) + 5.0 * layer;
        let (mut sum, mut count) = (0.0, 0);
        for step in 0..40 {
            let z = low + 0.02 * step as f32;
            for angle in 0..36 {
                let direction = Vec2::from_angle((angle as f32 + 0.3).to_radians() * 10.0);
                let r = radius(&tree, direction, z, 11.0);
                let normal = -tree.sample((direction * r).extend(z)).gradient.normalize();
                let (sin, cos) = degrees.to_radians().sin_cos();
                let expected = (direction * cos).extend(-sin);
                sum += normal.angle_between(expected).to_degrees().powi(2);
                count += 1;
            }
        }
        let off = (sum / count as f32).sqrt();
        assert!(off < most, "stem {stem}, ball {ball}, {degrees}°: {off}°");
    }
}

#[test]
fn what_stands_on_nothing_is_taken_away_and_what_reaches_below_the_bed_is_cut() {
    let (root, store) = baked(point([0., 0., 20.], 5.), trimming(45.0, 0.25));
    let tree = store.compile(&root);
    assert!((0..400).all(|i| tree.value(Vec3::new(0.1, 0.2, i as f32 * 0.1)) < ISO));
    let bake = store.of(&root).expect("it was baked");
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 125.0;
    assert!((bake.removed_mm3 / ball - 1.0).abs() < 0.01, "{} mm³", bake.removed_mm3);

    let (root, store) = baked(cone([0., 0., -6.], [0., 0., 6.], 6.), trimming(45.0, 0.25));
    let tree = store.compile(&root);
    assert!(store.of(&root).is_some_and(|bake| bake.cut_at_bed));
    assert!(tree.value(Vec3::new(0.0, 0.0, -0.01)) < ISO && tree.value(Vec3::new(0.0, 0.0, 0.01)) >= ISO);
}

#[test]
fn a_second_node_on_top_has_little_left_to_take() {
    let once = ball_on_stem(3.0, 7.0).support_free(trimming(45.0, 0.25));
    let (root, store) = baked(once, trimming(45.0, 0.25));
    let again = store.of(&root).expect("it was baked").removed_mm3;
    let first = store.of(&root.children()[0]).expect("so was the inner one").removed_mm3;
    // Interpolating a second time draws the cone in by a tenth of a layer.
    assert!(again < 0.3 * first, "{again} mm³ after {first} mm³");
}

#[test]
fn empty_shapes_and_shapes_under_the_bed_are_ordinary() {
    let nothing = point([0.; 3], 5.).subtract(point([0.; 3], 9.));
    for shape in [nothing, point([0., 0., -40.], 5.), point([0., 0., 5e4], 5.)] {
        let tree = constrained(shape, trimming(45.0, 0.25));
        assert!(tree.value(Vec3::new(0.0, 0.0, 1.0)) < ISO);
    }
}
