//! Closed triangle meshes of simple solids: for tests, examples and anything that needs a mesh quickly.
//!
//! Every constructor gives a closed, edge-manifold, outward-oriented mesh as long as its sizes are positive.
//! Counts below what a solid needs are raised to it (three segments, two rings). The vertices of round shapes
//! lie on the true surface, so their volume is a little too small and converges with the square of the count.

use std::collections::HashMap;
use std::f32::consts::TAU;

use glam::Vec3;

use crate::Mesh;

/// An axis-aligned box between two opposite corners (mm): 8 vertices, 12 triangles.
pub fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let corner = |i: usize| {
        let pick = |bit: usize, low: f32, high: f32| if i & bit == 0 { low } else { high };
        Vec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// The tetrahedron of four points (mm), oriented outward whatever their order.
pub fn tetrahedron(corners: [Vec3; 4]) -> Mesh {
    let [a, b, c, d] = corners;
    let positive = (b - a).cross(c - a).dot(d - a) > 0.0;
    let positions = if positive { vec![a, b, c, d] } else { vec![a, c, b, d] };
    Mesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }
}

/// A sphere of meridians and parallels: `segments` around z (at least 3), `rings` from pole to pole (at least 2).
pub fn uv_sphere(centre: Vec3, radius: f32, segments: u32, rings: u32) -> Mesh {
    let (segments, rings) = (segments.max(3), rings.max(2));
    let mut positions = vec![centre - Vec3::Z * radius];
    for ring in 1..rings {
        let (sin, cos) = (TAU / 2.0 * ring as f32 / rings as f32).sin_cos();
        positions.extend(circle(segments).map(|d| centre + radius * (d * sin - Vec3::Z * cos)));
    }
    positions.push(centre + Vec3::Z * radius);
    let top = positions.len() as u32 - 1;
    let first = |ring: u32| 1 + (ring - 1) * segments;
    let mut triangles = Vec::new();
    for i in 0..segments {
        let j = (i + 1) % segments;
        triangles.push([0, first(1) + j, first(1) + i]);
        for ring in 1..rings - 1 {
            push_quad(
                &mut triangles,
                first(ring) + i,
                first(ring) + j,
                first(ring + 1) + j,
                first(ring + 1) + i,
            );
        }
        triangles.push([top, first(rings - 1) + i, first(rings - 1) + j]);
    }
    Mesh { positions, triangles }
}

/// A sphere from an icosahedron whose faces are split in four `subdivisions` times (at most 9: five million faces).
pub fn ico_sphere(centre: Vec3, radius: f32, subdivisions: u32) -> Mesh {
    let golden = f32::midpoint(1.0, 5.0_f32.sqrt());
    let mut positions = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        positions.extend([Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)]);
    }
    let mut mesh = Mesh { triangles: neighbours_of_icosahedron(&positions), positions };
    let onto_sphere = |p: &mut Vec3| *p = p.normalize_or_zero();
    mesh.positions.iter_mut().for_each(onto_sphere);
    for _ in 0..subdivisions.min(9) {
        mesh = subdivide(&mesh);
        mesh.positions.iter_mut().for_each(onto_sphere);
    }
    for p in &mut mesh.positions {
        *p = centre + radius * *p;
    }
    mesh
}

/// The faces of the icosahedron whose corners are given: all triples two apart (edge length 2), outward.
fn neighbours_of_icosahedron(corners: &[Vec3]) -> Vec<[u32; 3]> {
    let near = |i: usize, j: usize| corners[i].distance_squared(corners[j]) < 4.5;
    let mut faces = Vec::new();
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            for k in j + 1..corners.len() {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = corners[i].cross(corners[j]).dot(corners[k]) > 0.0;
                    let (j, k) = if outward { (j, k) } else { (k, j) };
                    faces.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    faces
}

/// A torus about z: `major` from the axis to the tube's middle, `minor` the tube's radius (mm);
/// `segments` around the axis, `sides` around the tube (at least 3 each).
pub fn torus(centre: Vec3, major: f32, minor: f32, segments: u32, sides: u32) -> Mesh {
    let (segments, sides) = (segments.max(3), sides.max(3));
    let mut positions = Vec::new();
    for outward in circle(segments) {
        positions.extend(
            circle(sides).map(|d| centre + outward * (major + minor * d.x) + Vec3::Z * (minor * d.y)),
        );
    }
    let at = |i: u32, j: u32| (i % segments) * sides + j % sides;
    let mut triangles = Vec::new();
    for i in 0..segments {
        for j in 0..sides {
            push_quad(&mut triangles, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    Mesh { positions, triangles }
}

/// A cylinder about z, standing with the middle of its base at `base`; `segments` (at least 3) around.
pub fn cylinder(base: Vec3, radius: f32, height: f32, segments: u32) -> Mesh {
    let n = segments.max(3);
    let rim: Vec<Vec3> = circle(n).map(|d| base + radius * d).collect();
    let mut positions = rim.clone();
    positions.extend(rim.iter().map(|p| p + Vec3::Z * height));
    positions.extend([base, base + Vec3::Z * height]);
    let mut triangles = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        push_quad(&mut triangles, i, j, n + j, n + i);
        triangles.extend([[2 * n, j, i], [2 * n + 1, n + i, n + j]]);
    }
    Mesh { positions, triangles }
}

/// The same surface with every triangle cut in four at the middles of its sides; shared sides stay shared.
///
/// Triangles that name a vertex that does not exist are left out.
pub fn subdivide(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions.clone();
    let mut middles = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for &[a, b, c] in mesh.triangles.iter().filter(|t| mesh.corners(**t).is_some()) {
        let mut middle = |i: u32, j: u32| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                let between = mesh.positions[i as usize].midpoint(mesh.positions[j as usize]);
                positions.push(between);
                positions.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { positions, triangles }
}

/// Unit vectors in the plane z = 0, counter-clockwise from x.
fn circle(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let (sin, cos) = (TAU * i as f32 / count as f32).sin_cos();
        Vec3::new(cos, sin, 0.0)
    })
}

fn push_quad(triangles: &mut Vec<[u32; 3]>, a: u32, b: u32, c: u32, d: u32) {
    triangles.extend([[a, b, c], [a, c, d]]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_closed_manifold_and_faces_outward() {
        let shapes = [
            cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)),
            tetrahedron([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]),
            tetrahedron([Vec3::ZERO, Vec3::Y, Vec3::X, Vec3::Z]),
            uv_sphere(Vec3::ONE, 2.0, 3, 2),
            uv_sphere(Vec3::ONE, 2.0, 24, 12),
            ico_sphere(Vec3::ONE, 2.0, 0),
            ico_sphere(Vec3::ONE, 2.0, 3),
            torus(Vec3::ONE, 5.0, 2.0, 16, 9),
            cylinder(Vec3::ONE, 5.0, 2.0, 7),
            subdivide(&cuboid(Vec3::ZERO, Vec3::ONE)),
        ];
        for (i, mesh) in shapes.iter().enumerate() {
            assert!(mesh.is_closed_manifold(), "shape {i}");
            assert!(mesh.volume() > 0.0, "shape {i}");
            assert_eq!(mesh.euler_characteristic(), if i == 7 { 0 } else { 2 }, "shape {i}");
        }
    }
}
