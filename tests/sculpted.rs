//! The sculpted examples: scenes of little but brush strokes, replayed when they are baked.

mod geometry;

use blobtree::{BakeStore, DrawingsBy, NodeRef, Scene, Shape, Tree};
use geometry::*;
use printable::Rebaker;

/// How many strokes the support-free nodes of a tree have.
fn strokes(root: &NodeRef) -> usize {
    let own = match &root.shape {
        Shape::SupportFree(rule, _) => rule.strokes.len(),
        _ => 0,
    };
    own + root.children().iter().map(strokes).sum::<usize>()
}

#[test]
fn sculpted_examples_are_sound_and_their_strokes_are_felt() {
    for name in ["shaun", "pumpkin"] {
        let file = format!("{}/examples/sculpted/{name}.trullo", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{file}: {e}"));
        let root =
            Scene::from_bytes(&bytes, &mut DrawingsBy(sketch::solve)).unwrap_or_else(|e| panic!("{e}")).root;
        assert!(strokes(&root) > 5, "{name} is sculpted");
        let tree = BakeStore::new().tree(&root, &Rebaker::new()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mm = 0.5;
        let mesh = surface(&tree, mm).mesh();
        assert_sound(&mesh, mm, name);
        let drawn = surface(&Tree::new(&root), mm).mesh().volume();
        let share = mesh.volume() / drawn;
        println!("{name}: {} triangles, {share:.2} of what is drawn", mesh.triangles.len());
        assert!((share - 1.0).abs() > 0.05, "{name}: strokes change {share}");
    }
}
