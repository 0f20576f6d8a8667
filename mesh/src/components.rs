//! Connected parts of a mesh and the facts about each.

use glam::Vec3;

use crate::Mesh;
use crate::edges::{EdgeTable, is_collapsed};
use crate::measure::Bounds;

/// Which connected part every triangle belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// For each triangle its part, numbered from 0 in the order of each part's first triangle.
    pub labels: Vec<u32>,
    /// The number of parts.
    pub count: usize,
}

/// One part of a mesh, connected across edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Index of its first triangle.
    pub first_triangle: u32,
    /// Number of triangles.
    pub triangles: usize,
    /// Signed volume, mm³; negative when the part faces inward. Means nothing unless `closed`.
    pub volume: f64,
    /// Surface area, mm².
    pub area: f64,
    /// Its box, mm.
    pub bounds: Bounds,
    /// Vertices − edges + triangles.
    pub euler_characteristic: i64,
    /// Whether every edge has exactly two triangles, running in opposite directions.
    pub closed: bool,
}

impl Body {
    /// The number of handles of a closed part; none for an open one or one pinched at a vertex.
    pub fn genus(&self) -> Option<u64> {
        let twice = 2 - self.euler_characteristic;
        if self.closed && twice >= 0 && twice % 2 == 0 { u64::try_from(twice / 2).ok() } else { None }
    }
}

impl Mesh {
    /// Parts connected across shared edges: cubes that touch in a corner are two. O(n log n).
    pub fn components_by_edges(&self) -> Components {
        components_of(self.triangles.len(), &EdgeTable::new(self))
    }

    /// Parts connected through shared vertices: cubes that touch in a corner are one. O(n α(n)).
    pub fn components_by_vertices(&self) -> Components {
        let mut sets = DisjointSets::new(self.triangles.len());
        let mut first_user = vec![u32::MAX; self.positions.len()];
        for (t, triangle) in (0u32..).zip(&self.triangles) {
            for &v in triangle {
                let Some(user) = first_user.get_mut(v as usize) else { continue };
                if *user == u32::MAX {
                    *user = t;
                } else {
                    sets.join(*user, t);
                }
            }
        }
        sets.into_components()
    }

    /// The parts connected across edges, each with its measures, ordered by first triangle. O(n log n).
    ///
    /// Triangles with a repeated or missing vertex form parts of their own without edges.
    pub fn bodies(&self) -> Vec<Body> {
        let edges = EdgeTable::new(self);
        let components = components_of(self.triangles.len(), &edges);
        bodies_of(self, &edges, &components)
    }
}

pub(crate) fn components_of(triangles: usize, edges: &EdgeTable) -> Components {
    let mut sets = DisjointSets::new(triangles);
    for edge in edges.iter() {
        for pair in edge.halves.windows(2) {
            sets.join(pair[0].triangle, pair[1].triangle);
        }
    }
    sets.into_components()
}

pub(crate) fn bodies_of(mesh: &Mesh, edges: &EdgeTable, components: &Components) -> Vec<Body> {
    let empty = Body {
        first_triangle: u32::MAX,
        triangles: 0,
        volume: 0.0,
        area: 0.0,
        bounds: Bounds::EMPTY,
        euler_characteristic: 0,
        closed: true,
    };
    let mut bodies = vec![empty; components.count];
    let mut users = Vec::with_capacity(3 * mesh.triangles.len());
    for ((t, &triangle), &label) in (0u32..).zip(&mesh.triangles).zip(&components.labels) {
        let body = &mut bodies[label as usize];
        body.first_triangle = body.first_triangle.min(t);
        body.triangles += 1;
        body.euler_characteristic += 1;
        body.closed &= !is_collapsed(triangle);
        let Some(corners) = mesh.corners(triangle) else {
            body.closed = false;
            continue;
        };
        corners.into_iter().for_each(|p| body.bounds.include(p));
        users.extend(triangle.map(|v| (label, v)));
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        body.area += 0.5 * (b - a).cross(c - a).length();
    }
    add_volumes(mesh, components, &mut bodies);
    users.sort_unstable();
    users.dedup();
    for (label, _) in users {
        bodies[label as usize].euler_characteristic += 1;
    }
    for edge in edges.iter() {
        let body = &mut bodies[components.labels[edge.halves[0].triangle as usize] as usize];
        body.euler_characteristic -= 1;
        body.closed &= edge.halves.len() == 2 && edge.balance() == 0;
    }
    bodies
}

/// Signed tetrahedra from each body's own box centre, so that a body far away loses no digits.
fn add_volumes(mesh: &Mesh, components: &Components, bodies: &mut [Body]) {
    for (&triangle, &label) in mesh.triangles.iter().zip(&components.labels) {
        let body = &mut bodies[label as usize];
        if let Some(corners) = mesh.corners(triangle) {
            let centre = body.bounds.centre();
            let [a, b, c] = corners.map(|p| p.as_dvec3() - centre);
            body.volume += a.dot(b.cross(c)) / 6.0;
        }
    }
}

/// Union-find with path halving; the smaller index is always the root, so the result has one form only.
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    pub fn new(count: usize) -> Self {
        Self { parent: (0u32..).take(count).collect() }
    }

    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grand = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grand;
            i = grand;
        }
        i
    }

    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn into_components(mut self) -> Components {
        let mut labels = vec![0u32; self.parent.len()];
        let mut count = 0u32;
        for i in (0u32..).take(labels.len()) {
            let root = self.root(i);
            if root == i {
                labels[i as usize] = count;
                count += 1;
            } else {
                // A root is the smallest of its set, so it was labelled before.
                labels[i as usize] = labels[root as usize];
            }
        }
        Components { labels, count: count as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, torus};

    #[test]
    fn cubes_touching_in_a_corner_are_one_by_vertices_and_two_by_edges() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        let other = cuboid(Vec3::ONE, Vec3::splat(2.0));
        mesh.append(&other);
        // The second cube's lowest corner (index 8) becomes the first one's highest (index 7).
        for t in &mut mesh.triangles {
            *t = t.map(|v| if v == 8 { 7 } else { v });
        }
        assert_eq!(mesh.components_by_vertices().count, 1);
        assert_eq!(mesh.components_by_edges().count, 2);
        assert!(mesh.bodies().iter().all(|b| b.genus() == Some(0) && (b.volume - 1.0).abs() < 1e-12));
    }

    #[test]
    fn bodies_tell_a_torus_from_a_box_and_an_open_part_from_a_closed_one() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.append(&torus(Vec3::splat(50.0), 5.0, 1.0, 32, 16));
        mesh.append(&Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] });
        let bodies = mesh.bodies();
        assert_eq!(bodies.iter().map(Body::genus).collect::<Vec<_>>(), [Some(0), Some(1), None]);
        assert_eq!(bodies.iter().map(|b| b.first_triangle).collect::<Vec<_>>(), [0, 12, 12 + 1024]);
        assert_eq!(bodies[2].area, 0.5);
    }

    #[test]
    fn labels_follow_the_order_of_first_triangles() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.append(&cuboid(Vec3::splat(5.0), Vec3::splat(6.0)));
        mesh.triangles.swap(0, 20);
        let components = mesh.components_by_edges();
        assert_eq!((components.labels[0], components.labels[1], components.labels[20]), (0, 1, 1));
    }

    #[test]
    fn indices_out_of_range_do_no_harm() {
        let mesh = Mesh { positions: vec![Vec3::ZERO], triangles: vec![[0, 1, 9], [0, 0, 0]] };
        assert_eq!(mesh.components_by_vertices().count, 1);
        assert_eq!(mesh.bodies().len(), 2);
    }
}
