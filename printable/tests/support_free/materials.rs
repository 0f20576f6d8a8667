//! What the solid is made of, in scenes whose answers are known.

use crate::common::{growing, letter_t, trimming};
use blobtree::build::{Build, cuboid, point, union};
use blobtree::{Axis, BakeStore, Field, ISO, Materials, NodeRef};
use fastrand::Rng;
use glam::Vec3;
use printable::Rebaker;

fn bakes(root: &NodeRef) -> BakeStore {
    let mut store = BakeStore::new();
    store.bake(root, &Rebaker::new()).expect("it can be baked");
    store
}

/// Random places of a solid, within 14 mm of the middle.
fn places_in(solid: &dyn Field) -> Vec<Vec3> {
    let mut rng = Rng::with_seed(5);
    let mut coordinate = || rng.f32() * 28.0 - 14.0;
    let mut places: Vec<Vec3> = (0..20_000).map(|_| Vec3::from([(); 3].map(|()| coordinate()))).collect();
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
        let places = places_in(&store.compile(&root));
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
