//! The gradient-based blend: no bulge, no reach across a gap, and still a blend.

mod geometry;

use blobtree::build::*;
use blobtree::{Field, Node, NodeRef, Tree};
use fastrand::Rng;
use geometry::*;
use glam::Vec3;

/// A way to combine two nodes.
type Combine = fn(Vec<Node>) -> Node;

/// The farthest the solid reaches from `from` along `direction`, at most `reach`, in steps of a 2000th of that
/// and then by bisection, mm; `None` if the ray meets nothing.
fn height(tree: &Tree, from: Vec3, direction: Vec3, reach: f32) -> Option<f32> {
    let steps = 2000;
    let points: Vec<Vec3> =
        (0..=steps).map(|i| from + direction * (reach * i as f32 / steps as f32)).collect();
    let mut values = vec![0.0; points.len()];
    tree.sampler().values(&points, &mut values);
    let last = values.iter().rposition(|&value| value >= 0.5)?;
    let (mut inside, mut outside) = (points[last], *points.get(last + 1)?);
    for _ in 0..20 {
        let middle = inside.midpoint(outside);
        *(if tree.value(middle) >= 0.5 { &mut inside } else { &mut outside }) = middle;
    }
    Some((inside.midpoint(outside) - from).dot(direction))
}

/// Two equal cylinders of radius 5 that cross at right angles; their tops lie at z = 5.
fn crossing(combine: Combine, falloff: Option<f32>) -> Tree {
    let tube = |to: [f32; 3]| {
        let tube = cylinder(Vec3::from(to) * -1.0, to, 5.0);
        match falloff {
            Some(width) => tube.with_falloff(width),
            None => tube,
        }
    };
    Tree::new(&combine(vec![tube([30.0, 0.0, 0.0]), tube([0.0, 30.0, 0.0])]))
}

#[test]
fn two_cylinders_that_cross_do_not_bulge() {
    for falloff in [None, Some(2.0), Some(5.0)] {
        let gradient = crossing(gradient_blend, falloff);
        let over = |tree: &Tree, at: [f32; 2]| {
            height(tree, Vec3::new(at[0], at[1], 0.0), Vec3::Z, 15.0).expect("the cylinders are there") / 5.0
        };
        let top = over(&gradient, [0.0, 0.0]);
        println!("falloff {falloff:?}: {top:.5} radii over the crossing");
        assert!((top - 1.0).abs() < 1e-3, "falloff {falloff:?}: {top} radii high over the crossing");
        // Nowhere around is it higher either, and along the crests it is as high as the cylinders.
        for x in -60..=60 {
            let crest = over(&gradient, [0.2 * x as f32, 0.0]);
            assert!((crest - 1.0).abs() < 1e-3, "falloff {falloff:?}: {crest} at {x}");
            for y in 0..=40 {
                let high = over_or_nothing(&gradient, [0.2 * x as f32, 0.2 * y as f32]);
                assert!(high < 1.001, "falloff {falloff:?}: {high} radii at {x}, {y}");
            }
        }
        let bulge = over(&crossing(blend, falloff), [0.0, 0.0]);
        let summed = over(&crossing(sum, falloff), [0.0, 0.0]);
        println!("  Ricci's blend: {bulge:.3} radii, the sum: {summed:.3}");
        assert!(bulge > 1.05 && summed > bulge, "the usual blends bulge");
    }
}

/// The height in radii, 0 where there is nothing.
fn over_or_nothing(tree: &Tree, [x, y]: [f32; 2]) -> f32 {
    height(tree, Vec3::new(x, y, 0.0), Vec3::Z, 15.0).unwrap_or(0.0) / 5.0
}

/// Two balls of radius 8 with a gap between their surfaces, mm.
fn apart(gap: f32, falloff: Option<f32>, combine: Combine) -> Tree {
    let ball = |x: f32| {
        let ball = point([x, 0.0, 0.0], 8.0);
        match falloff {
            Some(width) => ball.with_falloff(width),
            None => ball,
        }
    };
    let x = 8.0 + gap / 2.0;
    Tree::new(&combine(vec![ball(-x), ball(x)]))
}

#[test]
fn two_separated_spheres_stay_as_they_were() {
    let mut worst = (0.0_f32, String::new());
    // Up to the default: what is told to reach farther than that fills wider gaps.
    for falloff in [None, Some(2.0), Some(4.0), Some(8.0)] {
        for share in [0.05, 0.1, 0.2, 0.3, 0.5] {
            let gap = 8.0 * share;
            let tree = apart(gap, falloff, gradient_blend);
            let name = format!("gap of {share} radii, falloff {falloff:?}");
            let mut rng = Rng::with_seed(4);
            for _ in 0..600 {
                let d = direction(&mut rng);
                // No farther than the plane between the two, behind which the other one stands.
                let plane = if d.x > 0.0 { (8.0 + gap / 2.0) / d.x } else { f32::INFINITY };
                let center = Vec3::new(-8.0 - gap / 2.0, 0.0, 0.0);
                let off = match height(&tree, center, d, plane.min(14.0)) {
                    Some(found) => (found - 8.0).abs() / 8.0,
                    // Solid up to the plane: the two have joined.
                    None => (plane.min(14.0) - 8.0) / 8.0,
                };
                if off > worst.0 {
                    worst = (off, format!("{name}, along {d}"));
                }
            }
        }
    }
    println!("at most {:.4} % of the radius off: {}", 100.0 * worst.0, worst.1);
    assert!(worst.0 < 0.005, "{} of the radius off: {}", worst.0, worst.1);
}

#[test]
fn nothing_appears_in_a_gap_that_the_usual_blends_bridge() {
    for falloff in [None, Some(2.0), Some(4.0), Some(8.0)] {
        for share in [0.05, 0.1, 0.2, 0.3, 0.5] {
            let tree = apart(8.0 * share, falloff, gradient_blend);
            for i in 0..400 {
                let p = Vec3::Y * (0.05 * i as f32);
                let value = tree.value(p);
                assert!(value < 0.5, "gap of {share} radii, falloff {falloff:?}: {value} at {p}");
            }
        }
    }
    for usual in [blend as Combine, sum] {
        for share in [0.05, 0.1, 0.2] {
            let across = apart(8.0 * share, None, usual).value(Vec3::ZERO);
            assert!(across > 0.5, "gap of {share} radii: the usual blend has only {across} in its middle");
        }
    }
    let mesh = meshed(&gradient_blend([point([-8.2, 0.0, 0.0], 8.0), point([8.2, 0.0, 0.0], 8.0)]), 0.25);
    assert_eq!(assert_sound(&mesh, 0.25, "two balls with a gap").bodies, 2);
}

#[test]
fn a_crease_at_a_right_angle_is_filled() {
    // Centres √2 radii apart: the surfaces cross at a right angle, on a circle of radius r/√2.
    let x = 8.0 / 2.0_f32.sqrt();
    let pair = || [point([-x, 0.0, 0.0], 8.0), point([x, 0.0, 0.0], 8.0)];
    let filled = Tree::new(&gradient_blend(pair()));
    let plain = Tree::new(&union(pair()));
    let at = |tree: &Tree| height(tree, Vec3::ZERO, Vec3::Y, 16.0).expect("the balls are there") / 8.0;
    println!("the crease is at {:.3} radii, filled up to {:.3}", at(&plain), at(&filled));
    assert!((at(&plain) - 0.5_f32.sqrt()).abs() < 1e-3);
    assert!(at(&filled) > at(&plain) + 0.05);
    // Far from the crease, nothing changes.
    let tip = height(&filled, Vec3::new(-x, 0.0, 0.0), Vec3::NEG_X, 16.0).expect("the balls are there");
    assert!((tip - 8.0).abs() < 1e-3);
    // And the crease is gone: the surface normal turns gently where it jumped by 90°.
    let (mut last, mut jump) = (None, 0.0_f32);
    for i in -40..=40 {
        let from = Vec3::X * (0.05 * i as f32);
        let high = height(&filled, from, Vec3::Y, 16.0).expect("the balls are there");
        let normal = -filled.sample(from + Vec3::Y * high).gradient.normalize_or_zero();
        if let Some(last) = last.replace(normal) {
            jump = jump.max(normal.angle_between(last).to_degrees());
        }
    }
    println!("the normal turns by at most {jump:.1}° in 0.05 mm");
    assert!(jump < 10.0, "the normal jumps by {jump}°");
}

#[test]
fn the_order_of_two_operands_changes_nothing() {
    let (a, b): (NodeRef, NodeRef) =
        (point([0.0; 3], 8.0).into(), segment([9.0, 0.0, 0.0], [20.0, 4.0, 3.0], 5.0).into());
    let (one, other) =
        (Tree::new(&gradient_blend([a.clone(), b.clone()])), Tree::new(&gradient_blend([b, a])));
    let mut rng = Rng::with_seed(5);
    for _ in 0..3000 {
        let p = point_in(&mut rng, &one.support());
        let (f, g) = (one.value(p), other.value(p));
        assert!((f - g).abs() < 1e-6, "{f} and {g} at {p}");
    }
}
