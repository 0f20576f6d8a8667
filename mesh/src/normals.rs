//! Outward directions for every face, edge and corner of a mesh, such that their sign tells inside from outside.

use glam::{DVec3, Vec3};

use crate::Mesh;
use crate::closest::Feature;
use crate::edges::EdgeTable;

/// Unit normals of faces, sums of them along edges, and sums weighted by angle at vertices.
///
/// For a closed, oriented mesh without crossings, the sign of `(p − closest) · normal(feature)` is exact.
/// **Source:** Bærentzen & Aanæs 2005, *Signed Distance Computation Using the Angle Weighted Pseudonormal*.
#[derive(Clone, Debug)]
pub(crate) struct Normals {
    triangles: Vec<[u32; 3]>,
    faces: Vec<Vec3>,
    /// Per triangle and side.
    edges: Vec<[Vec3; 3]>,
    vertices: Vec<Vec3>,
}

impl Normals {
    /// All indices must exist.
    pub fn new(mesh: &Mesh) -> Self {
        let mut faces = Vec::with_capacity(mesh.triangles.len());
        let mut vertices = vec![DVec3::ZERO; mesh.positions.len()];
        for &triangle in &mesh.triangles {
            let corners = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for i in 0..3 {
                let (to_next, to_previous) =
                    (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
                let angle = to_next.cross(to_previous).length().atan2(to_next.dot(to_previous));
                vertices[triangle[i] as usize] += normal * angle;
            }
            faces.push(normal.as_vec3());
        }
        let mut edges: Vec<[Vec3; 3]> = faces.iter().map(|&n| [n; 3]).collect();
        for edge in EdgeTable::new(mesh).iter() {
            let sum: Vec3 = edge.halves.iter().map(|h| faces[h.triangle as usize]).sum();
            for half in edge.halves {
                edges[half.triangle as usize][usize::from(half.side)] = sum;
            }
        }
        let vertices = vertices.into_iter().map(DVec3::as_vec3).collect();
        Self { triangles: mesh.triangles.clone(), faces, edges, vertices }
    }

    /// Not of length 1 on edges and corners, and zero where the mesh gives no direction.
    pub fn at(&self, triangle: u32, feature: Feature) -> Vec3 {
        let t = triangle as usize;
        match feature {
            Feature::Face => self.faces[t],
            Feature::Edge(side) => self.edges[t][usize::from(side)],
            Feature::Corner(corner) => self.vertices[self.triangles[t][usize::from(corner)] as usize],
        }
    }
}
