//! What drawings by many people are first offered to become.
//!
//! `cargo test -p sketch --features shared --test doodle_suggestions -- --nocapture`. Needs `../shared/doodles`.

mod doodles;

use blobtree::{Node, NodeRef, Operator, Shape};
use glam::{Vec2, Vec3};
use sketch::Solver;
use sketch::stroke::Sketch;
use sketch::suggest::{Icon, Projection, Request, View, suggest};
use std::collections::BTreeMap;

/// Every how manieth drawing is judged.
const SAMPLE: usize = 43;

#[test]
fn doodles_on_an_empty_bed_are_offered_to_be_blown_up_before_all_else() {
    let root: NodeRef = Node::new(Shape::Operator(Operator::Union, Vec::new())).into();
    let projection = Projection::Orthographic { mm_per_px: 0.25 };
    let view = View::look_at(Vec3::new(0.0, -100.0, 0.0), Vec3::ZERO, Vec2::splat(256.0), projection);
    let mut first: BTreeMap<Option<Icon>, Vec<String>> = BTreeMap::new();
    for (name, strokes) in doodles::every(SAMPLE) {
        let sketch = Sketch::from_strokes(&strokes);
        let request = Request { sketch: &sketch, view, root: &root, selected: None, depth: None };
        let seen = suggest(&request, &Solver);
        assert_eq!(seen.suggestions.is_empty(), seen.no_outline.is_some(), "{name}");
        first.entry(seen.suggestions.first().map(|s| s.icon)).or_default().push(name);
    }
    let of = |icon: Option<Icon>| first.get(&icon).map_or(0, Vec::len);
    let outlines: usize = first.values().map(Vec::len).sum::<usize>() - of(None);
    let inflated = of(Some(Icon::Inflate));
    println!("{inflated} of {outlines} drawings with an outline are first offered to be blown up");
    assert!(outlines > 90 && inflated * 20 >= outlines * 19, "{inflated} of {outlines}: {first:#?}");
}
