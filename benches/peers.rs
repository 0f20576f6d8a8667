//! The benchmark scenes of the peer comparison, timed: one JSON line per case, in the form that its report
//! reads (`bench`, `case`, `peer`, `threads`, times in ms over the rounds).
//!
//! `cargo bench --bench peers [-- eval|mesh|edit]`; `REPS` sets the rounds (15).

use blobtree::{
    Aabb, BRICK, BRICK_SAMPLES, Brick, ChangedPlaces, Field, NoSources, Node, NodeRef, Scene, Shape,
    Transform, Tree, Warp,
};
use glam::Vec3;
use polygonizer::{CellSize, Options, Surface};
use rayon::ThreadPool;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::time::Instant;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let wants = |bench: &str| wanted.is_empty() || wanted.iter().any(|w| w == bench);
    if wants("eval") {
        for name in ["points100", "spheres30", "csg20", "character100"] {
            eval(name);
        }
    }
    if wants("mesh") {
        for name in ["spheres30", "csg20", "character100"] {
            mesh(name);
        }
    }
    if wants("edit") {
        edit("character100", 128);
    }
}

fn scene(name: &str) -> NodeRef {
    let path = format!("{}/benches/scenes/{name}.trullo", env!("CARGO_MANIFEST_DIR"));
    let bytes = std::fs::read(&path).expect("the benchmark scenes are in the repository");
    Scene::from_bytes(&bytes, &mut NoSources).expect("the benchmark scenes are legal").root
}

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads can always be had")
}

fn rounds() -> usize {
    std::env::var("REPS").ok().and_then(|reps| reps.parse().ok()).unwrap_or(15).max(1)
}

/// Times a job over the rounds, after one to warm up, and prints its line.
fn report(bench: &str, case: &str, threads: usize, more: &Value, mut job: impl FnMut()) -> f64 {
    job();
    let mut times: Vec<f64> = (0..rounds())
        .map(|_| {
            let start = Instant::now();
            job();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let median = times[times.len() / 2];
    let mut line = json!({
        "bench": bench, "case": case, "peer": "trullo", "threads": threads, "n": times.len(),
        "median_ms": median, "min_ms": times[0], "max_ms": times[times.len() - 1],
    });
    if let (Some(line), Some(more)) = (line.as_object_mut(), more.as_object()) {
        line.extend(more.clone());
    }
    println!("{line}");
    median
}

/// The field on 256³ samples of [−1, 1]³, into bricks of 16³.
fn eval(name: &str) {
    const N: usize = 256;
    let tree = Tree::new(&scene(name));
    let mut bricks = vec![[0.0f32; BRICK_SAMPLES]; (N / BRICK).pow(3)];
    for threads in [1, 2] {
        let pool = pool(threads);
        let more = json!({ "points": N.pow(3) });
        report("eval", &format!("{name}/{N}"), threads, &more, || {
            pool.install(|| fill_blocks(&tree, N, &mut bricks));
        });
    }
    check_against_points(&tree, N, &bricks);
}

/// Fills blocks of 64³ samples, each in bricks.
fn fill_blocks(tree: &Tree, n: usize, bricks: &mut [[f32; BRICK_SAMPLES]]) {
    let spacing = 2.0 / n as f32;
    bricks.par_chunks_mut(64).enumerate().for_each_init(
        || tree.sampler(),
        |sampler, (block, bricks)| {
            let corner = block_corner(block, n);
            let end = corner.map(|c| c + 63);
            let region =
                Aabb { min: Brick::lattice_point(corner, spacing), max: Brick::lattice_point(end, spacing) };
            sampler.enter(region);
            for (at, values) in bricks.iter_mut().enumerate() {
                let brick = Brick { origin: brick_corner(corner, at), spacing };
                sampler.enter(brick.region());
                sampler.fill(&brick, values);
                sampler.leave();
            }
            sampler.leave();
        },
    );
}

fn block_corner(block: usize, n: usize) -> [i32; 3] {
    let blocks = n / 64;
    [block % blocks, block / blocks % blocks, block / blocks / blocks].map(|b| (b * 64) as i32 - n as i32 / 2)
}

fn brick_corner(corner: [i32; 3], at: usize) -> [i32; 3] {
    let offset = [at % 4, at / 4 % 4, at / 16];
    std::array::from_fn(|a| corner[a] + (offset[a] * BRICK) as i32)
}

/// Bricks must hold what single points give.
fn check_against_points(tree: &Tree, n: usize, bricks: &[[f32; BRICK_SAMPLES]]) {
    let spacing = 2.0 / n as f32;
    for (at, values) in bricks.iter().enumerate().step_by(37) {
        let brick = Brick { origin: brick_corner(block_corner(at / 64, n), at % 64), spacing };
        let place = [at % BRICK, at / 3 % BRICK, at / 7 % BRICK];
        let index = place[0] + BRICK * (place[1] + BRICK * place[2]);
        assert_eq!(values[index], tree.value(brick.point(place)), "a brick differs from a point");
    }
}

/// Scene to mesh in [−1, 1]³.
fn mesh(name: &str) {
    let root = scene(name);
    let (one, two) = (pool(1), pool(2));
    for n in [64u16, 128, 256] {
        let cell = CellSize::from_mm(2.0 / f32::from(n)).expect("a legal cell");
        let make = || {
            let tree = Tree::new(&root);
            Surface::build(&tree, cell, &Options::default()).expect("the scene is meshed").mesh()
        };
        let whole = make();
        assert!(whole.is_closed_manifold() && whole.volume() > 0.0, "{name} at {n} is not a solid");
        let more = json!({ "tris": whole.triangles.len(), "verts": whole.positions.len() });
        for (threads, pool) in [(1, &one), (2, &two)] {
            report("mesh", &format!("{name}/{n}"), threads, &more, || {
                std::hint::black_box(pool.install(make));
            });
        }
    }
}

/// Every primitive of a scene moved in turn, and the mesh brought up to date each time: of each primitive the best
/// round, of these the median, the nine tenths that take least, and the worst, and their shares of the whole mesh's
/// best.
fn edit(name: &str, n: u16) {
    let before = scene(name);
    let cell = CellSize::from_mm(2.0 / f32::from(n)).expect("a legal cell");
    let options = Options::default();
    let build =
        |root: &NodeRef| Surface::build(&Tree::new(root), cell, &options).expect("the scene is meshed");
    for threads in [1, 2] {
        pool(threads).install(|| {
            let whole = best_of(2 * rounds(), || {
                std::hint::black_box(build(&before));
            });
            let surface = build(&before);
            let mut times: Vec<f64> = (0..Tree::new(&before).primitives())
                .map(|number| {
                    let after = with_primitive_moved(&before, &mut Some(number), Vec3::new(0.02, 0.01, 0.015));
                    let dirty = || ChangedPlaces::between(&before, &after);
                    let updated = || {
                        let mut updated = surface.clone();
                        updated.update(&Tree::new(&after), &dirty(), &options).expect("it follows");
                        updated
                    };
                    assert!(number % 10 != 0 || updated() == build(&after), "an update differs from a fresh surface");
                    best_of(rounds(), || {
                        std::hint::black_box(updated());
                    })
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let (median, most) = (times[times.len() / 2], times[times.len() * 9 / 10]);
            let worst = times[times.len() - 1];
            println!(
                "{}",
                json!({
                    "bench": "edit", "case": format!("{name}/{n}/update"), "peer": "trullo", "threads": threads,
                    "n": times.len(), "whole_ms": whole, "median_ms": median, "tenth_largest_ms": most,
                    "max_ms": worst, "median_ratio": median / whole, "tenth_largest_ratio": most / whole,
                    "max_ratio": worst / whole,
                })
            );
        });
    }
}

/// The least time of a job over some rounds, in ms.
fn best_of(rounds: usize, mut job: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        job();
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..rounds).map(time).fold(f64::INFINITY, f64::min)
}

/// The tree with primitive `number` (counted in order) moved; `number` is `None` once it was met.
fn with_primitive_moved(node: &NodeRef, number: &mut Option<usize>, by: Vec3) -> NodeRef {
    match (&node.shape, *number) {
        (_, None) => node.clone(),
        (Shape::Primitive(_), Some(0)) => {
            *number = None;
            let warp = Warp::Transform(Transform { translate: by, ..Transform::default() });
            Node::new(Shape::Warp(warp, node.clone())).into()
        }
        (Shape::Primitive(_), Some(left)) => {
            *number = Some(left - 1);
            node.clone()
        }
        (_, Some(_)) => {
            let mut copy = Node::clone(node);
            match &mut copy.shape {
                Shape::Operator(_, children) => {
                    children.iter_mut().for_each(|child| *child = with_primitive_moved(child, number, by));
                }
                Shape::Warp(_, child) | Shape::SupportFree(_, child) => {
                    *child = with_primitive_moved(child, number, by);
                }
                Shape::Primitive(_) => unreachable!("primitives are dealt with above"),
            }
            // What does not hold the primitive stays the same node.
            if number.is_none() { copy.into() } else { node.clone() }
        }
    }
}
