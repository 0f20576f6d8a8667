//! Bakes are kept by what they depend on, and do not depend on threads.

use crate::common::{ball_on_stem, growing, trimming};
use blobtree::build::{Build, cuboid, union};
use blobtree::{Bake, BakeError, BakeStore, Baker, Field, Node, NodeRef, SupportFree};
use polygonizer::Cancel;
use printable::Rebaker;
use std::cell::Cell;

/// A baker that counts its work.
#[derive(Default)]
struct Counting(Cell<usize>);

impl Baker for Counting {
    fn bake(&self, rule: &SupportFree, child: &dyn Field) -> Result<Bake, BakeError> {
        self.0.set(self.0.get() + 1);
        Rebaker::new().bake(rule, child)
    }
}

#[test]
fn edits_elsewhere_and_undone_edits_bake_nothing_again() {
    let child = ball_on_stem(2.0, 4.0).into_shared();
    let node = child.clone().support_free(trimming(45.0, 0.5));
    let scene = |node: Node, x: f32| NodeRef::from(union([node, cuboid([x, 0., 5.], [4., 4., 10.])]));
    let (mut store, baker) = (BakeStore::new(), Counting::default());
    let first = scene(node.clone(), 20.0);
    let tree = store.tree(&first, &baker).expect("it can be baked");
    assert_eq!((baker.0.get(), tree.unconstrained()), (1, 0));
    store.tree(&scene(node.named("ball"), 30.0), &baker).expect("it can be baked");
    assert_eq!(baker.0.get(), 1, "another name, and an edit elsewhere");
    let steeper = child.support_free(trimming(50.0, 0.5));
    store.tree(&scene(steeper, 30.0), &baker).expect("it can be baked");
    assert_eq!(baker.0.get(), 2, "another rule");
    store.tree(&first, &baker).expect("it can be baked");
    assert_eq!(baker.0.get(), 2, "undone");
}

#[test]
fn what_nobody_baked_is_said_to_be_unconstrained() {
    let node = ball_on_stem(2.0, 4.0).support_free(trimming(45.0, 0.5));
    assert_eq!(blobtree::Tree::new(&node).unconstrained(), 1);
}

#[test]
fn one_thread_and_three_bake_the_same_bytes() {
    for rule in [trimming(45.0, 0.25), growing(50.0, 0.4)] {
        let root: NodeRef =
            ball_on_stem(2.0, 5.0).translate([0.3, 0.1, 0.]).support_free(rule.clone()).into();
        let baked = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
            let mut store = BakeStore::new();
            pool.install(|| store.bake(&root, &Rebaker::new())).expect("it can be baked");
            Bake::clone(store.of(&root).expect("it was baked"))
        };
        assert!(baked(1) == baked(3), "{rule:?}");
    }
}

#[test]
fn baking_stops_when_asked() {
    let root: NodeRef = ball_on_stem(2.0, 5.0).support_free(trimming(45.0, 0.25)).into();
    let stop = Cancel::new();
    stop.cancel();
    let result = BakeStore::new().bake(&root, &Rebaker::with_cancel(&stop));
    assert_eq!(result, Err(BakeError::Cancelled));
}
