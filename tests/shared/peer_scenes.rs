//! The benchmark scenes give the values that the peers' neutral scenes define.

use crate::shared;
use blobtree::{Field, NoSources, Scene, Tree};
use fastrand::Rng;
use glam::{Mat3, Vec3};
use serde_json::Value;

fn number(v: &Value) -> f32 {
    v.as_f64().expect("a number") as f32
}

fn vector(v: &Value) -> Vec3 {
    Vec3::new(number(&v[0]), number(&v[1]), number(&v[2]))
}

fn falloff(e: f32, reach: f32) -> f32 {
    (1.0 - e * e / (reach * reach)).max(0.0).powi(3)
}

/// The reference: the definition of the neutral scenes, one point at a time.
fn reference(node: &Value, p: Vec3) -> f32 {
    let reach = || number(&node["R"]);
    let children = || node["k"].as_array().expect("children").iter().map(|child| reference(child, p));
    let solid = |distance: &dyn Fn(Vec3) -> f32| {
        let from_center = p - vector(&node["c"]);
        let q = match node.get("rot") {
            Some(m) => {
                let rows: [f32; 9] = std::array::from_fn(|i| number(&m[i]));
                Mat3::from_cols_array(&rows).transpose() * from_center
            }
            None => from_center,
        };
        let half_at = (1.0 - 0.5f64.powf(1.0 / 3.0)).sqrt() as f32;
        falloff((distance(q) + reach() * half_at).max(0.0), reach())
    };
    match node["op"].as_str().expect("an operation") {
        "point" => falloff(p.distance(vector(&node["c"])), reach()),
        "segment" => {
            let (a, b) = (vector(&node["a"]), vector(&node["b"]));
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            falloff(p.distance(a + (b - a) * t), reach())
        }
        "sphere" => solid(&|q| q.length() - number(&node["r"])),
        "box" => solid(&|q| (q.abs() - vector(&node["h"])).max_element()),
        "cylinder" => solid(&|q| {
            let axis = node["axis"].as_u64().expect("an axis") as usize;
            let (u, v) = (q[(axis + 1) % 3], q[(axis + 2) % 3]);
            (u.hypot(v) - number(&node["r"])).max(q[axis].abs() - number(&node["hl"]))
        }),
        "sum" => children().sum(),
        "max" => children().fold(f32::MIN, f32::max),
        "min" => children().fold(f32::MAX, f32::min),
        "ricci" => {
            let s = number(&node["s"]);
            children().map(|f| f.powf(s)).sum::<f32>().powf(1.0 / s)
        }
        // Fields of solids do not go below 0, also where blends of what is cut away exceed 1.
        "diff" => reference(&node["a"], p).min(1.0 - reference(&node["b"], p)).max(0.0),
        other => panic!("unknown operation {other}"),
    }
}

#[test]
fn the_benchmark_scenes_equal_the_peers_to_one_in_a_hundred_thousand() {
    for name in ["spheres30", "csg20", "character100", "points100"] {
        let text =
            std::fs::read_to_string(shared(&format!("peerbench/scenes/{name}.json"))).expect("readable");
        let neutral: Value = serde_json::from_str(&text).expect("JSON");
        let path = format!("{}/benches/scenes/{name}.trullo", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(path).expect("in the repository");
        let scene = Scene::from_bytes(&bytes, &mut NoSources).expect("a legal scene");
        let tree = Tree::new(&scene.root);
        let mut rng = Rng::with_seed(1);
        let points: Vec<Vec3> =
            (0..50_000).map(|_| Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 2.0 - 1.0).collect();
        let mut values = vec![0.0; points.len()];
        tree.sampler().values(&points, &mut values);
        let worst = points.iter().zip(&values).map(|(p, f)| (f - reference(&neutral["root"], *p)).abs());
        let worst = worst.fold(0.0, f32::max);
        println!("{name}: largest difference {worst:.1e}");
        assert!(worst < 1e-5, "{name}: {worst}");
    }
}
