//! A surface that follows the edits of a document equals a fresh one, to the last bit.
//!
//! `TRULLO_SWEEP=full` makes 200 edits on each of 20 scenes; without it, 20.

mod geometry;

use blobtree::random::RandomTree;
use blobtree::{
    CachePolicy, CacheStore, Change, ChangedPlaces, Command, Dirty, Document, NewShape, Node, NodePath,
    NodeRef, Primitive, Scene, Shape, Tree, changed_region,
};
use fastrand::Rng;
use geometry::*;
use glam::Vec3;
use mesh::Mesh;
use polygonizer::{Options, Surface};
use std::time::Instant;

/// The examples, and random trees up to 20 scenes; each with a cell size that shows it coarsely.
fn scenes() -> Vec<(String, Scene, f32)> {
    let mut scenes: Vec<(String, Scene)> =
        example_names().into_iter().map(|name| (name.clone(), example(&name))).collect();
    let mut seed = 0;
    while scenes.len() < 20 {
        let mut random = RandomTree::new(seed);
        random.depth = 5;
        let tree = random.tree();
        if size_of(&tree) >= 6 && !solid_box(&Tree::new(&tree)).is_empty() {
            scenes.push((format!("random tree {seed}"), Scene::new(tree)));
        }
        seed += 1;
    }
    let sized = |(name, scene): (String, Scene)| {
        let longest = solid_box(&Tree::new(&scene.root)).size().max_element();
        let mm = if longest > 0.0 { longest / 40.0 } else { 2.0 };
        (name, scene, mm)
    };
    scenes.into_iter().map(sized).collect()
}

fn size_of(node: &Node) -> usize {
    1 + node.children().iter().map(|child| size_of(child)).sum::<usize>()
}

/// The paths of all nodes, the root first.
fn paths(root: &NodeRef) -> Vec<NodePath> {
    let mut paths = vec![NodePath::default()];
    let mut next = 0;
    while let Some(path) = paths.get(next).cloned() {
        let children = path.find(root).map_or(0, |node| node.children().len());
        paths.extend((0..children).map(|i| path.child(i)));
        next += 1;
    }
    paths
}

/// A primitive moved and resized a little, as by dragging.
fn dragged(primitive: &Primitive, rng: &mut Rng) -> Primitive {
    let by = direction(rng) * 6.0 * rng.f32();
    let grow = 0.8 + 0.5 * rng.f32();
    let mut primitive = primitive.clone();
    match &mut primitive {
        Primitive::Point(p) => (p.center, p.radius) = (p.center + by, p.radius * grow),
        Primitive::Segment(p) => (p.from, p.radius) = (p.from + by, p.radius * grow),
        Primitive::Polyline(p) => p.points.iter_mut().for_each(|q| q.at += by),
        Primitive::Disc(p) => p.center += by,
        Primitive::Polygon(p) => p.points.iter_mut().for_each(|q| *q += by),
        Primitive::Box(p) => (p.center, p.size, p.rounding) = (p.center + by, p.size * grow, 0.0),
        Primitive::Cylinder(p) => (p.from, p.radius) = (p.from + by, p.radius * grow),
        Primitive::Cone(p) => (p.to, p.radius_from) = (p.to + by, p.radius_from * grow + 0.1),
        Primitive::Torus(p) => (p.center, p.minor_radius) = (p.center + by, p.minor_radius * grow),
        Primitive::Ellipsoid(p) => (p.center, p.radii) = (p.center + by, p.radii * grow),
        Primitive::HalfSpace(p) => p.point += by,
        Primitive::Mesh(p) => p.falloff *= grow,
        Primitive::Inflation(p) => p.plane.origin += by,
        Primitive::LinearSweep(p) => (p.plane.origin, p.length) = (p.plane.origin + by, p.length * grow),
        Primitive::Revolution(p) => p.plane.origin += by,
        Primitive::PathSweep(p) => p.path.iter_mut().for_each(|q| *q += by),
    }
    primitive
}

/// A random command, which need not be possible.
fn command(root: &NodeRef, rng: &mut Rng, random: &mut RandomTree) -> Command {
    let paths = paths(root);
    let path = paths[rng.usize(..paths.len())].clone();
    let other = paths[rng.usize(..paths.len())].clone();
    let node = path.find(root).expect("one of its paths");
    let place = |path: &NodePath, rng: &mut Rng| {
        rng.usize(..=path.find(root).map_or(0, |node| node.children().len()))
    };
    match rng.u32(..14) {
        0..5 => Command::SetShape {
            shape: match &node.shape {
                Shape::Primitive(primitive) => NewShape::Primitive(dragged(primitive, rng)),
                Shape::Operator(..) => NewShape::Operator(random.operator()),
                Shape::Warp(..) => NewShape::Warp(random.warp()),
                Shape::SupportFree(..) => NewShape::SupportFree(random.rule()),
            },
            path,
        },
        5 => Command::SetMuted { muted: !node.muted, path },
        6 => Command::SetConstruction { construction: !node.construction, path },
        7 => Command::Insert { index: place(&path, rng), parent: path, node: random.leaf().into() },
        8 => Command::Remove { path },
        9 => Command::Move { index: place(&other, rng), from: path, parent: other },
        10 => Command::Replace { path, node: random.leaf().into() },
        11 => Command::WrapInOperator { path, operator: random.operator() },
        12 => Command::WrapInWarp { path, warp: random.warp() },
        _ => Command::Unwrap { path },
    }
}

/// The next thing that a restless user does, who mostly takes back what made everything disappear.
fn edit(document: &mut Document, rng: &mut Rng, random: &mut RandomTree, empty: bool) -> Change {
    loop {
        let change = match rng.u32(..12) {
            0 | 1 => document.undo(),
            3..10 if empty => document.undo(),
            2 => document.redo(),
            _ => {
                let command = command(&document.scene().root, rng, random);
                document.apply(command).ok()
            }
        };
        if let Some(change) = change {
            return change;
        }
    }
}

/// Runs `work` on this many threads.
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(work)
}

/// Panics unless the meshes are equal in every bit, signs of zeros included.
fn assert_same(updated: &Mesh, fresh: &Mesh, name: &str) {
    let bits = |mesh: &Mesh| -> Vec<[u32; 3]> {
        mesh.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    assert!(updated.triangles == fresh.triangles, "{name}: other triangles");
    assert!(bits(updated) == bits(fresh), "{name}: other positions");
}

#[test]
fn after_random_edits_the_updated_surface_equals_a_fresh_one() {
    let edits = ordinary_or_full(20, 200);
    let mut counts = [0; 2];
    for (number, (name, scene, mm)) in scenes().into_iter().enumerate() {
        let started = Instant::now();
        let mut rng = Rng::with_seed(number as u64);
        let mut random = RandomTree::new(number as u64);
        let mut document = Document::new(scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut followed = surface(&Tree::new(&document.scene().root), mm);
        for n in 0..edits {
            let change = edit(&mut document, &mut rng, &mut random, followed.triangle_count() == 0);
            let name = format!("{name}, edit {n} ({})", change.name);
            let tree = Tree::new(&change.after);
            let dirty = ChangedPlaces::between(&change.before, &change.after);
            let fresh = on_threads(1, || surface(&tree, mm));
            on_threads(2, || followed.update(&tree, &dirty, &Options::default()))
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_same(&followed.mesh(), &fresh.mesh(), &name);
            assert!(followed == fresh, "{name}: equal meshes, other normals or kinds of vertices");
            counts[0] += 1;
            counts[1] += usize::from(fresh.triangle_count() > 0);
        }
        println!("{name}: {edits} edits, {:.1} s", started.elapsed().as_secs_f32());
    }
    println!("{} edits, {} of them left something to see", counts[0], counts[1]);
    assert!(counts[1] * 2 > counts[0], "most edits must leave a solid, or nothing is tested");
}

#[test]
fn a_drag_of_many_small_steps_equals_a_fresh_surface_at_its_end() {
    for (name, scene, mm) in scenes().into_iter().take(9) {
        let mut document = Document::new(scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut followed = surface(&Tree::new(&document.scene().root), mm);
        let leaves: Vec<NodePath> = paths(&document.scene().root)
            .into_iter()
            .filter(|path| path.find(&document.scene().root).is_some_and(|node| node.children().is_empty()))
            .collect();
        let path = leaves[leaves.len() / 2].clone();
        for step in 0..10 {
            let Shape::Primitive(primitive) = &path.find(&document.scene().root).expect("it stays").shape
            else {
                unreachable!("leaves are primitives")
            };
            let mut rng = Rng::with_seed(step);
            let shape = NewShape::Primitive(dragged(primitive, &mut rng));
            let Ok(change) = document.apply(Command::SetShape { path: path.clone(), shape }) else {
                continue;
            };
            let dirty = ChangedPlaces::between(&change.before, &change.after);
            followed
                .update(&Tree::new(&change.after), &dirty, &Options::default())
                .unwrap_or_else(|e| panic!("{name}: {e}"));
        }
        let fresh = surface(&Tree::new(&document.scene().root), mm);
        assert_same(&followed.mesh(), &fresh.mesh(), &name);
    }
}

#[test]
fn through_caches_an_updated_surface_equals_a_fresh_one_through_the_same_caches() {
    let policy = CachePolicy { least_cost: 2, cells: 128 };
    for name in ["snowman", "bracket", "dog-head", "chess-pawn"] {
        let scene = example(name);
        let mm = solid_box(&Tree::new(&scene.root)).size().max_element() / 48.0;
        let mut document = Document::new(scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut store = CacheStore::new(policy);
        let mut followed = surface(&store.tree(&document.scene().root), mm);
        let mut rng = Rng::with_seed(9);
        for n in 0..ordinary_or_full(8, 60) {
            let paths = paths(&document.scene().root);
            let path = paths[rng.usize(..paths.len())].clone();
            let node = path.find(&document.scene().root).expect("one of its paths");
            let command = match &node.shape {
                Shape::Primitive(p) => {
                    Command::SetShape { shape: NewShape::Primitive(dragged(p, &mut rng)), path }
                }
                _ => Command::SetMuted { muted: !node.muted, path },
            };
            let Ok(change) = document.apply(command) else { continue };
            let tree = store.tree(&change.after);
            let dirty = changed_region(&change.before, &change.after);
            followed.update(&tree, &dirty, &Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            let fresh = surface(&tree, mm);
            assert_same(&followed.mesh(), &fresh.mesh(), &format!("{name}, edit {n} ({})", change.name));
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    for (name, scene, mm) in scenes() {
        let tree = Tree::new(&scene.root);
        let one = on_threads(1, || surface(&tree, mm / 1.7)).mesh();
        for threads in [2, 5] {
            let many = on_threads(threads, || surface(&tree, mm / 1.7)).mesh();
            assert_same(&many, &one, &format!("{name} on {threads} threads"));
        }
    }
}

#[test]
fn an_edit_far_away_leaves_every_brick_alone() {
    let near = |x: f32| blobtree::build::point([x, 0.0, 0.0], 5.0);
    let before: NodeRef = blobtree::build::union([near(0.0), near(200.0)]).into();
    let mut after = Node::clone(&before);
    let Shape::Operator(_, children) = &mut after.shape else { unreachable!("a union") };
    children[1] = blobtree::build::point([200.0, 1.0, 0.0], 5.0).into();
    let after: NodeRef = after.into();
    let dirty = ChangedPlaces::between(&before, &after);
    let bounds = dirty.bounds();
    assert!(!bounds.contains(Vec3::ZERO) && bounds.contains(Vec3::new(200.0, 0.0, 0.0)));
    let mut followed: Surface = surface(&Tree::new(&before), 0.5);
    let far: Vec<_> = followed.bricks().filter(|key| key[0] > 10).collect();
    let changes =
        followed.update(&Tree::new(&after), &dirty, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(!far.is_empty() && changes.changed.iter().chain(&changes.removed).all(|key| key[0] > 10));
}
