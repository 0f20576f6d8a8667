//! The mesh a reader is building: within the limits, without collapsed triangles.

use glam::Vec3;

use super::weld::Welder;
use super::{Attachments, Format, Loaded, Notice, Place, ReadError, ReadLimits};
use crate::Mesh;

pub(super) struct MeshBuilder {
    pub(super) mesh: Mesh,
    max_vertices: u64,
    max_triangles: u64,
    /// Triangles handed in so far, kept or not.
    seen: u64,
    collapsed: u64,
    first_collapsed: u64,
}

impl MeshBuilder {
    pub(super) fn new(limits: &ReadLimits) -> Self {
        Self {
            mesh: Mesh::default(),
            // Indices are 32-bit, and a face index must fit a signed one in PLY.
            max_vertices: limits.max_vertices.min(i32::MAX as u64),
            max_triangles: limits.max_triangles,
            seen: 0,
            collapsed: 0,
            first_collapsed: 0,
        }
    }

    pub(super) fn vertices(&self) -> usize {
        self.mesh.positions.len()
    }

    /// Adds a vertex as it is.
    pub(super) fn vertex(&mut self, position: Vec3, place: impl FnOnce() -> Place) -> Result<(), ReadError> {
        self.mesh.positions.push(position);
        self.check_vertices(place)
    }

    /// Adds a vertex unless its place is taken; its index either way.
    pub(super) fn welded(
        &mut self,
        welder: &mut Welder,
        position: Vec3,
        place: impl FnOnce() -> Place,
    ) -> Result<u32, ReadError> {
        let index = welder.index_of(position, &mut self.mesh.positions);
        self.check_vertices(place)?;
        Ok(index)
    }

    /// Adds a triangle unless two corners are the same vertex. Its indices are checked by the caller.
    pub(super) fn triangle(
        &mut self,
        corners: [u32; 3],
        place: impl FnOnce() -> Place,
    ) -> Result<(), ReadError> {
        self.seen += 1;
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            if self.collapsed == 0 {
                self.first_collapsed = self.seen;
            }
            self.collapsed += 1;
            return Ok(());
        }
        self.mesh.triangles.push(corners);
        let found = self.mesh.triangles.len() as u64;
        check(found, self.max_triangles, "triangles", place)
    }

    /// The finished mesh. Errors: [`ReadError::NoTriangles`] with `hint` if there is none.
    pub(super) fn finish(
        self,
        format: Format,
        mut notices: Vec<Notice>,
        hint: impl FnOnce() -> String,
    ) -> Result<Loaded, ReadError> {
        if self.mesh.triangles.is_empty() {
            let hint = match self.collapsed {
                0 => hint(),
                count => format!("all {count} have two corners in one point"),
            };
            return Err(ReadError::NoTriangles { format, hint });
        }
        if self.collapsed > 0 {
            notices.push(Notice::CollapsedTriangles { count: self.collapsed, first: self.first_collapsed });
        }
        Ok(Loaded { mesh: self.mesh, format, notices, attachments: Attachments::default() })
    }

    fn check_vertices(&self, place: impl FnOnce() -> Place) -> Result<(), ReadError> {
        check(self.mesh.positions.len() as u64, self.max_vertices, "vertices", place)
    }
}

/// Errors: [`ReadError::TooLarge`] if there is more than the limit.
pub(super) fn check(
    found: u64,
    limit: u64,
    what: &'static str,
    place: impl FnOnce() -> Place,
) -> Result<(), ReadError> {
    if found > limit { Err(ReadError::TooLarge { place: place(), what, found, limit }) } else { Ok(()) }
}
