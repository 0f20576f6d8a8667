//! What the tests of geometry share: the example scenes, a referee for meshes, and volumes from the field.

#![allow(dead_code, reason = "each test file uses its own part")]

pub mod volume;

use blobtree::{Aabb, Field, NoSources, Node, Scene, Tree};
use fastrand::Rng;
use glam::Vec3;
use mesh::{Fault, Mesh, SelfIntersections, Validity};
use polygonizer::{CellSize, Options, Surface};
use std::path::Path;

/// Whether the tests do all they can, which takes an hour, or what fits into seconds.
pub fn full_sweep() -> bool {
    std::env::var("TRULLO_SWEEP").is_ok_and(|value| value == "full")
}

/// One of the two, by [`full_sweep`].
pub fn ordinary_or_full<T>(ordinary: T, full: T) -> T {
    if full_sweep() { full } else { ordinary }
}

/// The scene in `examples` of this name.
pub fn example(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("trullo");
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Scene::from_bytes(&bytes, &mut NoSources).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The names of all example scenes, sorted.
pub fn example_names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(&folder)
        .expect("the examples are there")
        .map(|file| file.expect("readable").path());
    let scenes = files.filter(|path| path.extension().is_some_and(|e| e == "trullo"));
    let mut names: Vec<String> =
        scenes.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

/// A cell size in mm, for tests that know theirs to be legal.
pub fn cell(mm: f32) -> CellSize {
    CellSize::from_mm(mm).unwrap_or_else(|e| panic!("{e}"))
}

/// The surface of a field in cells of `mm`.
pub fn surface(field: &dyn Field, mm: f32) -> Surface {
    Surface::build(field, cell(mm), &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The mesh of a node in cells of `mm`.
pub fn meshed(node: &Node, mm: f32) -> Mesh {
    surface(&Tree::new(node), mm).mesh()
}

/// The box of the solid, mm, to about a 64th of its field's longest side; empty if nothing is found.
pub fn solid_box(field: &dyn Field) -> Aabb {
    let support = field.support();
    if support.is_empty() {
        return Aabb::EMPTY;
    }
    let bounds = surface(field, support.size().max_element() / 64.0).mesh().bounds();
    Aabb { min: bounds.min, max: bounds.max }
}

/// A random point in a box.
pub fn point_in(rng: &mut Rng, region: &Aabb) -> Vec3 {
    region.min + region.size() * Vec3::new(rng.f32(), rng.f32(), rng.f32())
}

/// A random unit direction.
pub fn direction(rng: &mut Rng) -> Vec3 {
    loop {
        let p = Vec3::from_array(std::array::from_fn(|_| 2.0 * rng.f32() - 1.0));
        if (0.01..1.0).contains(&p.length()) {
            return p / p.length();
        }
    }
}

/// What keeps the mesh from being closed, edge-manifold and oriented outwards, or makes a triangle degenerate:
/// naming a vertex twice, repeating another one, or having a height within rounding or less than 5e-7 of the
/// area of a cell's face. Empty for a sound mesh.
pub fn faults_of(mesh: &Mesh, report: &Validity, cell_mm: f32) -> Vec<String> {
    let faults = [
        Fault::MissingVertex,
        Fault::NotFinite,
        Fault::CollapsedTriangle,
        Fault::ZeroArea,
        Fault::DuplicateTriangle,
        Fault::UnusedVertex,
        Fault::BoundaryEdge,
        Fault::NonManifoldEdge,
        Fault::MisorientedEdge,
        Fault::InvertedBody,
    ];
    let found = faults.into_iter().filter(|fault| report.count(*fault) > 0);
    let mut found: Vec<String> = found
        .map(|fault| {
            let first = report.findings().find(|f| f.fault == fault).map(ToString::to_string);
            format!("{} × {}", report.count(fault), first.unwrap_or_default())
        })
        .collect();
    let (least, triangle) = smallest_area(mesh);
    if least <= 5e-7 * f64::from(cell_mm).powi(2) {
        found.push(format!("triangle {triangle} has only {least:e} mm²"));
    }
    found
}

/// Panics unless the mesh has none of [`faults_of`].
pub fn assert_sound(mesh: &Mesh, cell_mm: f32, name: &str) -> Validity {
    let report = mesh.validity(SelfIntersections::Skip);
    let faults = faults_of(mesh, &report, cell_mm);
    assert!(faults.is_empty(), "{name}: {faults:?}");
    report
}

/// The area of the smallest triangle, mm², and its number.
fn smallest_area(mesh: &Mesh) -> (f64, usize) {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    let areas = mesh.triangles.iter().map(area).zip(0..);
    areas.fold((f64::INFINITY, 0), |least, next| if next.0 < least.0 { next } else { least })
}

/// Distance from a point to a triangle, mm.
pub fn distance_to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let normal = (b - a).cross(c - a);
    let inside =
        [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| (to - from).cross(p - from).dot(normal) >= 0.0);
    if inside && normal.length_squared() > 0.0 {
        return ((p - a).dot(normal) / normal.length()).abs();
    }
    [(a, b), (b, c), (c, a)]
        .map(|(from, to)| distance_to_segment(p, from, to))
        .into_iter()
        .fold(f32::INFINITY, f32::min)
}

/// Distance from a point to a line segment, mm.
pub fn distance_to_segment(p: Vec3, from: Vec3, to: Vec3) -> f32 {
    let along = to - from;
    let t = ((p - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(from + along * t)
}
