//! Drawn solids become closed meshes that keep the corners of the drawing.

mod common;

use blobtree::build::{self, Build};
use blobtree::random::{polygon_template, stroke};
use blobtree::{Drawing, Field, Node, Tree};
use common::*;
use glam::{Vec2, Vec3};
use mesh::Mesh;
use polygonizer::{CellSize, polygonize};

fn turned(points: &[[f32; 2]]) -> Vec<Vec2> {
    points.iter().map(|p| Vec2::from_angle(0.35).rotate(Vec2::from(*p))).collect()
}

fn square() -> Vec<Vec2> {
    turned(&[[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]])
}

/// With corners that point inwards, too.
fn arrow() -> Vec<Vec2> {
    turned(&[[-12.0, -4.0], [0.0, -4.0], [0.0, -10.0], [13.0, 0.0], [0.0, 10.0], [0.0, 4.0], [-12.0, 4.0]])
}

fn meshed(node: &Node, cells: u32) -> (Mesh, f32) {
    let tree = Tree::new(node);
    let size = CellSize::across(tree.support().size().max_element(), cells).expect("positive");
    (polygonize(&tree, size).expect("small"), size.mm())
}

/// How far points of the segment are from the mesh.
fn offsets(mesh: &Mesh, a: Vec3, b: Vec3) -> impl Iterator<Item = f32> {
    (0..=60).map(move |i| distance_to_mesh(a.lerp(b, i as f32 / 60.0), mesh))
}

#[test]
fn swept_polygons_keep_their_edges_to_about_a_pixel() {
    for outline in [square(), arrow()] {
        let drawing = Drawing { strokes: vec![stroke(outline.iter().copied())], ..Drawing::default() };
        let template = polygon_template(&drawing, Some(5.0), 400).expect("it encloses something");
        let pixel = template.distance.pixel();
        for cells in [24, 48] {
            let sweep = build::linear_sweep(drawing.clone(), template.clone(), 14.0).with_falloff(5.0);
            let (mesh, cell) = meshed(&sweep, cells);
            assert_sound(&mesh, &format!("{cells} cells"));
            let place = |i: usize, y: f32| {
                let p = outline[i % outline.len()];
                Vec3::new(p.x, y, p.y)
            };
            let allowed = 1.5 * pixel + 0.05 * cell;
            let (mut points, mut off) = (0, 0);
            for i in 0..outline.len() {
                let edges = [
                    (place(i, -7.0), place(i, 7.0)),
                    (place(i, -7.0), place(i + 1, -7.0)),
                    (place(i, 7.0), place(i + 1, 7.0)),
                ];
                for (number, (a, b)) in edges.into_iter().enumerate() {
                    let offsets: Vec<f32> = offsets(&mesh, a, b).collect();
                    // Away from the ends, where several edges meet, those across keep to the drawing's corners.
                    let middle = offsets[10..50].iter().fold(0.0f32, |worst, off| worst.max(*off));
                    assert!(
                        number > 0 || middle < allowed,
                        "{cells} cells: corner {i} is {middle} mm off, of {cell}"
                    );
                    points += offsets.len();
                    off += offsets.iter().filter(|off| **off > allowed).count();
                }
            }
            println!("{cells} cells: {off} of {points} points are off the edges");
            // Triangles cut off parts of edges where several of them meet in neighbouring cells.
            let most = if cells == 24 { 0.05 } else { 0.01 };
            assert!(
                off as f32 <= most * points as f32,
                "{cells} cells: {off} of {points} points are off the edges"
            );
        }
    }
}

#[test]
fn every_kind_of_drawn_solid_becomes_a_sound_mesh() {
    let drawing = Drawing { strokes: vec![stroke(arrow())], ..Drawing::default() };
    let template = polygon_template(&drawing, None, 200).expect("it encloses something");
    let spiral = (0..40).map(|i| {
        let t = 0.15 * i as f32;
        [25.0 * t.cos() - 25.0, 25.0 * t.sin(), 1.5 * i as f32]
    });
    for (name, node) in [
        ("inflation", build::inflation(drawing.clone(), template.clone())),
        ("sweep", build::linear_sweep(drawing.clone(), template.clone(), 9.0)),
        ("revolution", build::revolution(drawing.clone(), template.clone())),
        ("path sweep", build::path_sweep(drawing, template, spiral)),
    ] {
        let start = std::time::Instant::now();
        let (mesh, _) = meshed(&node, 64);
        println!("{name}: {} triangles in {:?}", mesh.triangles.len(), start.elapsed());
        assert_sound(&mesh, name);
        assert!(mesh.triangles.len() > 1000, "{name}: {} triangles", mesh.triangles.len());
    }
}
