//! Scenes: reading, writing, evaluating.

use blobtree::random::PolygonSources;
use blobtree::{Aabb, Drawing, Field, MeshReference, Node, Scene, SceneSources, Template, Tree};
use glam::Vec3;
use mesh::MeshDistance;
use std::sync::Arc;

/// The largest tree that is evaluated; shared nodes count wherever they stand.
const MOST_NODES: usize = 2000;

/// Reads a scene; if there is one, it must be legal, come back the same from its text, and have a finite field.
pub fn read_scene(data: &[u8]) {
    let Ok(scene) = Scene::from_bytes(data, &mut FewPoints) else {
        return;
    };
    scene.check().expect("what was read is legal");
    let text = scene.to_text().expect("what was read is writable");
    let back = Scene::from_bytes(text.as_bytes(), &mut FewPoints).expect("what was written is readable");
    assert!(back == scene, "the scene changed");
    assert!(back.to_text().as_ref() == Ok(&text), "the text changed");
    if has_at_most(&scene.root, &mut { MOST_NODES }) {
        evaluate(&scene.root);
    }
}

/// Solves drawings as polygons, unless that would take long.
struct FewPoints;

impl SceneSources for FewPoints {
    fn mesh(&mut self, reference: &MeshReference) -> Result<Arc<MeshDistance>, String> {
        PolygonSources.mesh(reference)
    }

    fn template(&mut self, drawing: &Drawing, falloff: Option<f32>) -> Result<Arc<Template>, String> {
        if drawing.strokes.iter().map(|stroke| stroke.points.len()).sum::<usize>() > 1000 {
            return Err("it has many points".into());
        }
        PolygonSources.template(drawing, falloff)
    }
}

/// Whether no more nodes are in a tree than are left, and takes them away.
fn has_at_most(node: &Node, left: &mut usize) -> bool {
    *left > 0 && {
        *left -= 1;
        node.children().iter().all(|child| has_at_most(child, left))
    }
}

/// The field at a few points keeps what [`Field`] promises.
fn evaluate(root: &Node) {
    let tree = Tree::new(root);
    let support = tree.support();
    let inside = [0.1, 0.5, 0.77].map(|share| support.min + share * support.size());
    for p in
        support.corners().into_iter().chain(inside).chain([Vec3::ZERO, Vec3::splat(1.5), Vec3::splat(-2e5)])
    {
        if !p.is_finite() {
            assert!(support.is_empty(), "the field reaches to {p}");
            continue;
        }
        let (value, sample) = (tree.value(p), tree.sample(p));
        assert!(value.is_finite() && value >= 0.0, "{value} at {p}");
        assert!(value == 0.0 || support.contains(p), "{value} at {p}, outside {support:?}");
        assert!(sample.value.to_bits() == value.to_bits(), "{value} and {sample:?} at {p}");
        assert!(sample.gradient.is_finite(), "{sample:?} at {p}");
        let bound = tree.bound(Aabb::around(p, Vec3::ONE));
        assert!(bound.lo <= value && value <= bound.hi, "{value} at {p}, beyond {bound:?}");
    }
}
