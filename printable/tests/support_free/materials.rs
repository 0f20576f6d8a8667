//! What the solid is made of, in scenes whose answers are known.

use crate::common::{growing, letter_t, trimming};
use blobtree::build::{Build, cuboid, point, union};
use blobtree::{Axis, BakeStore, BrushKind, BrushStroke, Field, ISO, Materials, NodeRef, SupportFree};
use fastrand::Rng;
use glam::{Quat, Vec3};
use printable::Rebaker;
use std::sync::Arc;

fn bakes(root: &NodeRef) -> BakeStore {
    let mut store = BakeStore::new();
    store.bake(root, &Rebaker::new()).expect("it can be baked");
    store
}

/// Those of so many random places, within 14 mm of the middle along each axis, that are solid.
fn places_in(solid: &dyn Field, middle: Vec3, count: usize) -> Vec<Vec3> {
    let mut rng = Rng::with_seed(5);
    let mut coordinate = || rng.f32() * 28.0 - 14.0;
    let mut places: Vec<Vec3> =
        (0..count).map(|_| middle + Vec3::from([(); 3].map(|()| coordinate()))).collect();
    places.retain(|place| solid.value(*place) >= ISO);
    places
}

#[test]
fn what_grew_is_of_its_own_material_wherever_its_node_stands() {
    let grown: NodeRef = letter_t().support_free(growing(45.0, 0.5)).translate([0., 0., -10.]).into();
    let apart = || point([0., 12., 0.], 2.0);
    let roots: [(&str, NodeRef); 7] = [
        ("moved", grown.clone()),
        ("turned and scaled", grown.clone().rotate_degrees([90., 20., 0.]).scale([1.1, -0.9, 1.0]).into()),
        ("twisted", grown.clone().translate([1., 0., 0.]).twist(Axis::Z, 4.0).into()),
        ("beside another part", apart().union(grown.clone()).rotate_degrees([0., 0., 30.]).into()),
        ("cut", grown.clone().subtract(cuboid([7., 0., 0.], [3., 9., 30.])).into()),
        ("cut to a box", cuboid([4., 0., 0.], [12., 9., 30.]).intersect(grown.clone()).into()),
        ("trimmed again", grown.support_free(trimming(45.0, 0.5)).into()),
    ];
    for (name, root) in roots {
        let store = bakes(&root);
        let materials = Materials::new(&root, &store);
        let drawn = BakeStore::new().compile(&root);
        let places = places_in(&store.compile(&root), Vec3::ZERO, 20_000);
        let found = materials.finder().materials(&places);
        let mut counts = [0, 0];
        for (place, material) in places.iter().zip(found) {
            let is_grown = drawn.value(*place) < ISO;
            assert_eq!(material, u8::from(is_grown), "{name}: at {place}");
            counts[usize::from(is_grown)] += 1;
        }
        assert!(counts.iter().all(|count| *count > 30), "{name}: {counts:?}");
    }
}

#[test]
fn nobody_needs_to_ask_where_nothing_was_added() {
    let plain: [NodeRef; 3] = [
        letter_t(),
        cuboid([0., 0., 5.], [10., 10., 10.]).support_free(growing(45.0, 0.5)).into(),
        union([letter_t().support_free(growing(45.0, 0.5)).muted(), point([0., 0., 9.], 9.0)]).into(),
    ];
    for root in plain {
        let materials = Materials::new(&root, &bakes(&root));
        assert!(materials.is_plain());
        assert_eq!(materials.finder().materials(&[Vec3::new(6., 0., 14.)]), [0]);
    }
}

/// A block of 20 × 12 × 20 mm with strokes of several materials on it.
fn painted_block() -> NodeRef {
    let of = |stroke, material, grown_material| BrushStroke { material, grown_material, ..stroke };
    let on_top = |kind, x: f32, z: f32| BrushStroke::new(kind, 2.0, [[x, 0.0, z]]);
    let strokes = [
        of(on_top(BrushKind::AddTrim, -6.0, 20.0), 2, 1),
        of(on_top(BrushKind::AddTrim, -6.0, 21.5), 5, 1),
        of(on_top(BrushKind::AddTrim, 6.0, 20.0), 0, 1),
        of(on_top(BrushKind::AddTrim, 0.0, 20.0), 7, 1),
        on_top(BrushKind::RemoveTrim, 0.0, 21.0),
        of(on_top(BrushKind::AddTrim, 0.0, 20.0), 6, 1),
        of(BrushStroke::new(BrushKind::AddGrow, 1.5, [[0., 14., 12.]]), 3, 4),
    ];
    let strokes = strokes.map(Arc::new).to_vec();
    let rule = SupportFree { strokes, ..trimming(45.0, 0.25) };
    cuboid([0., 0., 10.], [20., 12., 20.]).support_free(rule).into()
}

/// What a place in it is made of; none where that is too near to tell.
fn material_of_block(p: Vec3) -> Option<u8> {
    const NEAR: f32 = 0.3;
    let from = |x: f32, y: f32, z: f32| p.distance(Vec3::new(x, y, z));
    match p {
        _ if (p - Vec3::Z * 10.0).abs().cmple(Vec3::new(10., 6., 10.)).all() => Some(0),
        _ if from(-6., 0., 20.) < 2.0 - NEAR => Some(2),
        _ if from(-6., 0., 20.) > 2.0 + NEAR && from(-6., 0., 21.5) < 2.0 - NEAR => Some(5),
        _ if from(6., 0., 20.) < 2.0 - NEAR => Some(0),
        _ if from(0., 0., 20.) < 2.0 - NEAR && from(0., 0., 21.) < 2.0 - NEAR => Some(6),
        _ if from(0., 14., 12.) < 1.5 - NEAR => Some(3),
        _ if p.y > 6.0 + NEAR && from(0., 14., 12.) > 1.5 + NEAR => Some(4),
        _ => None,
    }
}

#[test]
fn what_strokes_added_is_of_their_materials_wherever_their_node_stands() {
    let node = painted_block();
    let store = bakes(&node);
    let mut places = places_in(&store.compile(&node), Vec3::Z * 12.0, 80_000);
    places.retain(|place| material_of_block(*place).is_some());
    let turn = Quat::from_rotation_x(1.0);
    let (moved, twisted) = (Vec3::new(3., -40., 7.), 2.0_f32);
    let roots: [(NodeRef, &dyn Fn(Vec3) -> Vec3); 3] = [
        (node.clone(), &|p| p),
        (
            node.clone()
                .scale([1., 1., -2.])
                .rotate_degrees([1.0_f32.to_degrees(), 0., 0.])
                .translate(moved)
                .into(),
            &|p| turn * (p * Vec3::new(1., 1., -2.)) + moved,
        ),
        (node.translate(moved).twist(Axis::Z, twisted).into(), &|p| {
            Quat::from_rotation_z((twisted * (p + moved).z).to_radians()) * (p + moved)
        }),
    ];
    for (number, (root, root_from_node)) in roots.into_iter().enumerate() {
        let materials = Materials::new(&root, &bakes(&root));
        let asked: Vec<Vec3> = places.iter().map(|place| root_from_node(*place)).collect();
        let found = materials.finder().materials(&asked);
        let mut counts = [0; 8];
        for (place, material) in places.iter().zip(found) {
            let expected = material_of_block(*place);
            assert_eq!(Some(material), expected, "root {number}: at {place} of the node");
            counts[usize::from(material)] += 1;
        }
        let enough = |material: usize| counts[material] > 5;
        assert!([0, 2, 3, 4, 5, 6].into_iter().all(enough), "{counts:?}");
    }
}
