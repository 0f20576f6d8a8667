//! Settling: what is meshed and sliced hangs nowhere, by the print check, which knows nothing of how it was made.

use crate::common::{ball_on_stem, growing, trimming};
use blobtree::build::{Build, cuboid, cylinder, point, segment};
use blobtree::{BakeStore, Node, NodeRef, SupportFree};
use polygonizer::{CellSize, Options, Surface};
use printable::check::{CheckSettings, PrintCheck};
use printable::slices::{Slices, Watch};
use printable::{Rebaker, SupportRule};

/// The print check of a shape's mesh in cells as wide as layers are high; and what was taken away, mm³.
pub fn settled(shape: Node, rule: SupportFree) -> (PrintCheck, f64) {
    let cell = CellSize::from_mm(rule.layer_height).expect("legal");
    let root: NodeRef = shape.support_free(rule.clone()).into();
    let mut store = BakeStore::new();
    let tree = store.tree(&root, &Rebaker::new().settling(cell)).expect("it can be baked");
    let mesh = Surface::build(&tree, cell, &Options::default()).expect("small").mesh();
    let rule = SupportRule::new(rule.layer_height, rule.overhang_degrees).expect("legal");
    let settings = CheckSettings { rule, ..CheckSettings::default() };
    let slices = Slices::new(&mesh, rule.layer_height, settings.bottom, &Watch::default()).expect("solid");
    let check = PrintCheck::new(&mesh, &slices, &settings, &Watch::default()).expect("solid");
    (check, store.of(&root).expect("it was baked").removed_mm3)
}

/// Shapes that the lattice alone leaves hanging: rounded bottoms, creases in ceilings, thin tips.
fn shapes() -> [(&'static str, Node); 4] {
    let block = || cuboid([0., 0., 6.], [14., 10., 12.]);
    [
        ("ball on a stem", ball_on_stem(3.0, 7.0)),
        ("tunnel", block().subtract(cylinder([-9., 0., 5.], [9., 0., 5.], 3.))),
        (
            "pips in the bottom",
            block().blend_subtract(point([-3., 0., -1.], 3.).union(point([3., 0., -1.], 3.))),
        ),
        (
            "arms",
            block().union(segment([0., 0., 9.], [14., 1., 8.], 0.6)).union(segment(
                [0., 2., 10.],
                [-13., 4., 5.],
                0.4,
            )),
        ),
    ]
}

#[test]
fn settled_shapes_are_support_free_in_the_eyes_of_the_print_check() {
    for (name, shape) in shapes() {
        for rule in [trimming(45.0, 0.25), growing(45.0, 0.25)] {
            let (check, _) = settled(shape.clone(), rule.clone());
            let worst = check.findings.first().map(ToString::to_string);
            assert!(check.is_support_free(), "{name}, {:?}: {worst:?}", rule.mode);
            // Slicers put supports under any sliver.
            let hanging = check.unsupported();
            assert!(hanging < 1e-6, "{name}, {:?}: {hanging} mm² hang", rule.mode);
        }
    }
}

/// The bytes of a settled shape's mesh, made by so many threads.
fn bytes(shape: &Node, rule: SupportFree, threads: usize) -> Vec<u8> {
    let cell = CellSize::from_mm(rule.layer_height).expect("legal");
    let make = || {
        let root: NodeRef = shape.clone().support_free(rule.clone()).into();
        let tree = BakeStore::new().tree(&root, &Rebaker::new().settling(cell)).expect("it can be baked");
        let mesh = Surface::build(&tree, cell, &Options::default()).expect("small").mesh();
        let corners = mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes);
        corners.chain(mesh.triangles.into_iter().flatten().flat_map(u32::to_le_bytes)).collect()
    };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(make)
}

#[test]
fn one_thread_and_many_settle_to_the_same_bytes() {
    for (name, shape) in shapes() {
        let rule = trimming(45.0, 0.25);
        let one = bytes(&shape, rule.clone(), 1);
        for threads in [2, 5] {
            assert!(bytes(&shape, rule.clone(), threads) == one, "{name}: {threads} threads differ");
        }
    }
}
