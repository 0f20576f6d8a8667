//! The operators on 512³ voxels, timed: one JSON line per case, in the form that the peer comparison's report reads
//! (`bench`, `case`, `peer`, `threads`, times in ms over the rounds).
//!
//! `FIELD_DIR=folder cargo bench -p printable --bench voxels [-- trim|preserve|smooth27|pathmap|dab|field]`, with the
//! peers' `voxels_512.bits` in that folder; without `FIELD_DIR` a scene of balls stands in, and the peers' counts are
//! not asserted. `REPS` sets the rounds (15).

use blobtree::build::{point, union};
use blobtree::{NodeRef, Tree};
use glam::Vec3;
use printable::{
    Action, Brush, Changes, Dab, Element, GridShape, GroundPaths, LayerHeight, PathCost, PathMap,
    SupportRule, Tip, UnderBed, VoxelGrid, VoxelSize, preserve, smooth, trim, unsupported,
};
use serde_json::{Value, json};
use std::time::Instant;

const SIDE: usize = 512;

/// What the peers count in their sample.
const SOLID: usize = 18_014_992;
const TRIMMED: usize = 13_186_937;
const PRESERVED: usize = 18_437_897;
const SMOOTHED: usize = 18_014_899;
const GROUND_DISTANCES: usize = 17_751_538;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let wants = |case: &str| wanted.is_empty() || wanted.iter().any(|w| w == case);
    let (sample, peers) = sample();
    let elements = [("square", Element::square()), ("round", round())];
    let mut trimmed = sample.clone();
    trim(&mut trimmed, &elements[0].1);
    assert!(!peers || (sample.count() == SOLID && trimmed.count() == TRIMMED), "not what the peers count");
    if wants("trim") {
        time_trim(&sample, &elements);
    }
    if wants("preserve") {
        time_preserve(&sample, &elements, peers);
    }
    if wants("smooth27") {
        time_smooth(&sample, peers);
    }
    if wants("pathmap") {
        time_paths(&sample, &elements, peers);
    }
    if wants("dab") {
        for (name, element) in &elements {
            time_dabs(&sample, name, element);
        }
    }
    if wants("field") {
        time_field();
    }
}

fn round() -> Element {
    Element::for_rule(SupportRule::default()).expect("cubic voxels are coarse enough")
}

fn shape() -> GridShape {
    GridShape::new([SIDE; 3], size(), [0.0; 2]).expect("the largest there is")
}

fn size() -> VoxelSize {
    VoxelSize::cubic(LayerHeight::from_mm(0.25).expect("legal"))
}

/// The peers' sample, or balls on legs; and whether it is the peers'.
fn sample() -> (VoxelGrid, bool) {
    if let Ok(folder) = std::env::var("FIELD_DIR") {
        let bytes =
            std::fs::read(format!("{folder}/voxels_512.bits")).expect("the peers' sample is in FIELD_DIR");
        let words: Vec<u64> = bytes.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
        return (VoxelGrid::from_words(shape(), &words), true);
    }
    (VoxelGrid::from_field(&balls(), size()).expect("it stands on the bed"), false)
}

fn balls() -> Tree {
    let mut rng = fastrand::Rng::with_seed(5);
    let mut ball = |radius: f32| {
        let [x, y] = std::array::from_fn(|_| 30.0 + 60.0 * rng.f32());
        point([x, y, 20.0 + 60.0 * rng.f32()], radius)
    };
    let mut all: Vec<_> = (0..40).map(|_| ball(8.0)).collect();
    all.extend([point([64., 64., 20.], 20.1), point([64., 64., 64.], 40.), point([64., 64., 110.], 10.)]);
    let root: NodeRef = union(all).into();
    Tree::new(&root)
}

/// Times a job over the rounds, after one to warm up, and prints its line. `again` makes ready for the next round.
fn report<R>(case: &str, threads: usize, more: &Value, mut job: impl FnMut() -> R, mut again: impl FnMut(R)) {
    let rounds: usize = std::env::var("REPS").ok().and_then(|reps| reps.parse().ok()).unwrap_or(15);
    let result = job();
    again(result);
    let mut times: Vec<f64> = (0..rounds.max(1))
        .map(|_| {
            let start = Instant::now();
            let result = job();
            let ms = start.elapsed().as_secs_f64() * 1e3;
            again(result);
            ms
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let mut line = json!({
        "bench": "voxel", "case": case, "peer": "trullo", "threads": threads, "n": times.len(),
        "median_ms": times[times.len() / 2], "min_ms": times[0], "max_ms": times[times.len() - 1],
    });
    if let (Some(line), Some(more)) = (line.as_object_mut(), more.as_object()) {
        line.extend(more.clone());
    }
    println!("{line}");
}

/// A case's name: the peers' for their element.
fn case(name: &str, element: &str) -> String {
    if element == "square" { name.into() } else { format!("{name}-{element}") }
}

/// Trimming what is trimmed already costs the same, and is what the peers time.
fn time_trim(sample: &VoxelGrid, elements: &[(&str, Element)]) {
    for (name, element) in elements {
        let mut grid = sample.clone();
        trim(&mut grid, element);
        assert!(unsupported(&grid, element).is_empty());
        report(
            &case("trim", name),
            1,
            &json!({ "bytes": grid.bytes() }),
            || trim(&mut grid, element),
            |_| (),
        );
    }
}

fn time_preserve(sample: &VoxelGrid, elements: &[(&str, Element)], peers: bool) {
    for (name, element) in elements {
        let mut grid = sample.clone();
        preserve(&mut grid, element, None);
        assert!(!peers || *name != "square" || grid.count() == PRESERVED, "not what the peers count");
        report(&case("preserve", name), 1, &json!({}), || preserve(&mut grid, element, None), |_| ());
    }
}

fn time_smooth(sample: &VoxelGrid, peers: bool) {
    for threads in [1, 2] {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads can be had");
        let job = || pool.install(|| smooth(sample, UnderBed::Nothing));
        report("smooth27", threads, &json!({}), job, |result| {
            assert!(!peers || result.count() == SMOOTHED, "not what the peers count");
        });
    }
}

fn time_paths(sample: &VoxelGrid, elements: &[(&str, Element)], peers: bool) {
    for (name, element) in elements {
        let ground = GroundPaths::new(sample, element);
        if *name == "square" {
            let places = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [x, y]));
            let sum: usize = places.map(|place| usize::from(ground.distance(place))).sum();
            assert!(!peers || sum == GROUND_DISTANCES, "not what the peers measure");
        }
        let job = || GroundPaths::new(sample, element);
        report(&case("ground-distance", name), 1, &json!({}), job, drop);
        for (kind, cost) in [("pathmap", PathCost::Climbed), ("pathmap-in-slice", PathCost::InSlice)] {
            let mut map = PathMap::new(sample, element, cost);
            let more = json!({ "knows": "solids", "bytes": map.bytes() + sample.bytes() });
            report(&case(kind, name), 1, &more, || map.update(sample, element, cost), drop);
        }
    }
}

/// A ball of radius 24 voxels, put down in a leg and in the body, with all that follows; undone outside the time.
fn time_dabs(sample: &VoxelGrid, name: &str, element: &Element) {
    let mut grid = sample.clone();
    trim(&mut grid, element);
    let paths = GroundPaths::new(&grid, element);
    let actions = [
        ("remove-trim", Action::RemoveTrim),
        ("add-trim", Action::AddTrim),
        ("remove-preserve", Action::RemovePreserve),
        ("smooth-trim", Action::SmoothTrim),
        ("add-grow", Action::AddGrow(&paths)),
    ];
    for (what, action) in actions {
        for (place, [x, y, z]) in
            [("leg", [160, 180, 60]), ("body", [256, 256, 210]), ("air", [100, 100, 300])]
        {
            let center = grid.shape().center([x, y, z]);
            let dab = Dab::new(center, 24.0 * 0.25, 1.0).expect("legal");
            let brush = Brush { action, tip: Tip::Ball, material: 0, grown_material: 1 };
            let before = grid.clone();
            let changes = brush.dab(&mut grid, element, &dab);
            assert!(unsupported(&grid, element).is_empty(), "{what} left something hanging");
            check_removal(&before, &grid, what, center, element);
            let more =
                json!({ "removed": changes.removed(), "added": changes.added(), "bytes": changes.bytes() });
            undo(&mut grid, changes);
            assert!(grid.same_solid(&before), "{what} was not undone");
            let cell = std::cell::RefCell::new(&mut grid);
            let job = || brush.dab(&mut cell.borrow_mut(), element, &dab);
            let case = case(&format!("dab-{what}-{place}"), name);
            report(&case, 1, &more, job, |changes| undo(&mut cell.borrow_mut(), changes));
        }
    }
}

fn undo(grid: &mut VoxelGrid, mut changes: Changes) {
    changes.swap(grid);
}

/// What a removing dab leaves must be what removing the ball and trimming everything leaves.
fn check_removal(before: &VoxelGrid, after: &VoxelGrid, what: &str, center: Vec3, element: &Element) {
    if what == "remove-trim" {
        let mut expected = before.clone();
        let in_ball = |&voxel: &[usize; 3]| before.shape().center(voxel).distance(center) <= 24.0 * 0.25;
        before.solid_voxels().filter(in_ball).for_each(|voxel| expected.set_solid(voxel, false));
        trim(&mut expected, element);
        assert!(after.same_solid(&expected), "the dab differs from trimming everything");
    }
}

/// Voxels of a field.
fn time_field() {
    let tree = balls();
    for threads in [1, 2] {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads can be had");
        let job = || pool.install(|| VoxelGrid::from_field(&tree, size()).expect("it stands on the bed"));
        report("from-field", threads, &json!({ "scene": "43 balls" }), job, drop);
    }
}
