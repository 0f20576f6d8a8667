//! Grow: nothing hangs, nothing is lost, and trimming finds little to take.

use crate::common::{Slices, baked, ball_on_stem, growing};
use blobtree::build::{Build, cuboid, cylinder, point, segment};
use blobtree::{Field, ISO, Node, NodeRef, Tree};
use glam::Vec3;

fn scenes() -> [(&'static str, Node); 5] {
    let plate = || cuboid([0., 0., 0.5], [12., 12., 1.]);
    [
        ("ball on a stem", ball_on_stem(3.0, 6.0)),
        ("ball in the air", point([0., 0., 11.], 5.)),
        ("ball over a plate", plate().union(point([0., 0., 12.], 4.))),
        ("table", cylinder([0., 0., 0.], [0., 0., 9.], 1.5).union(cuboid([0., 0., 10.], [10., 8., 2.]))),
        (
            "arm",
            cylinder([-4., 0., 0.], [-4., 0., 10.], 2.).union(segment([-4., 0., 10.], [5., 2., 12.], 1.5)),
        ),
    ]
}

#[test]
fn grown_shapes_are_carried_layer_by_layer() {
    for (name, scene) in scenes() {
        let (root, store) = baked(scene, growing(45.0, 0.25));
        let tree = store.compile(&root);
        let slices = Slices::new(&tree, 0.25, 0.125, 8.0, 18.0, 0.04);
        let hanging = slices.unsupported(0.25 + 0.01 + 0.03);
        assert!(hanging < 0.15, "{name}: {hanging} mm²");
    }
}

#[test]
fn growing_keeps_the_shape_and_adds_what_carries_it() {
    for (name, scene) in scenes() {
        let child: NodeRef = scene.into();
        let (root, store) = baked(child.clone(), growing(45.0, 0.25));
        let bake = store.of(&root).expect("it was baked");
        assert!(bake.added_mm3 > 1.0, "{name}: nothing was added");
        let (plain, grown) = (Tree::new(&child), store.compile(&root));
        let mut rng = fastrand::Rng::with_seed(1);
        let (mut solid, mut lost) = (0, 0);
        for _ in 0..20_000 {
            let p = Vec3::new(-8.0 + 16.0 * rng.f32(), -8.0 + 16.0 * rng.f32(), 18.0 * rng.f32());
            if plain.value(p) >= ISO {
                solid += 1;
                lost += usize::from(grown.value(p) < ISO);
            }
        }
        assert!((lost as f32) < 0.03 * solid as f32, "{name}: {lost} of {solid} places lost");
    }
}
