//! Stanford PLY, as text or binary of either byte order: vertex positions and face corners.
//!
//! Everything else (colours, normals, other elements) is stepped over. Triangle strips are not read.

mod data;
mod header;

use std::io::{BufRead, BufWriter, Write};

use glam::Vec3;

use self::data::Data;
use self::header::{Element, Header, Kind, Scalar};
use super::builder::{MeshBuilder, check};
use super::number::{AXES, finite};
use super::polygon::{Faces, check_corners};
use super::{Format, Loaded, ReadError, ReadLimits, WriteError, count_for};
use crate::Mesh;

pub(super) fn read(reader: impl BufRead, length: u64, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let (header, lines) = Header::read(reader)?;
    let mut data = Data::new(lines, header.encoding, length);
    let mut builder = MeshBuilder::new(limits);
    let mut faces = Faces::new(0);
    for element in &header.elements {
        data.check_announced(element)?;
        let coordinates = AXES.map(|axis| element.position(&axis.to_string()));
        let corners = element.position("vertex_indices").or_else(|| element.position("vertex_index"));
        match (element.name.as_str(), coordinates, corners) {
            ("vertex", [Some(x), Some(y), Some(z)], _) => {
                check(element.count, limits.max_vertices, "vertices", || element.place.clone())?;
                vertices(&mut data, element, [x, y, z], &mut builder)?;
            }
            ("vertex", ..) => return Err(element.lacks("the properties x, y and z, one number each")),
            ("face", _, Some(corners)) => {
                read_faces(&mut data, element, corners, &mut builder, &mut faces)?;
            }
            ("face", ..) => return Err(element.lacks("a list property vertex_indices")),
            _ => data.skip_element(element)?,
        }
    }
    let mut notices = Vec::new();
    faces.finish(builder.vertices(), &mut notices)?;
    let names = || header.elements.iter().map(|element| element.name.as_str()).collect::<Vec<_>>().join(", ");
    let hint = || format!("its elements are: {}; faces must be in an element named face", names());
    builder.finish(Format::Ply, notices, hint)
}

fn vertices(
    data: &mut Data<impl BufRead>,
    element: &Element,
    coordinates: [usize; 3],
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    for axis in coordinates {
        if let Kind::List { .. } = element.properties[axis].kind {
            return Err(element.lacks("the properties x, y and z, one number each"));
        }
    }
    for _ in 0..element.count {
        let mut position = Vec3::ZERO;
        for (i, property) in element.properties.iter().enumerate() {
            match (coordinates.iter().position(|&axis| axis == i), property.kind) {
                (Some(axis), Kind::Scalar(kind)) => position[axis] = data.coordinate(kind, AXES[axis])?,
                (_, kind) => data.skip(kind)?,
            }
        }
        let position = finite(position, || data.place())?;
        builder.vertex(position, || data.place())?;
    }
    Ok(())
}

fn read_faces(
    data: &mut Data<impl BufRead>,
    element: &Element,
    corner_list: usize,
    builder: &mut MeshBuilder,
    faces: &mut Faces,
) -> Result<(), ReadError> {
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for (i, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { count, item } if i == corner_list => {
                    let (length, place) = data.list_length(count, item)?;
                    check_corners(length, || place.clone())?;
                    corners.clear();
                    for _ in 0..length {
                        corners.push(corner(data, item, builder.vertices())?);
                    }
                    faces.add(builder, &corners, place)?;
                }
                Kind::Scalar(_) if i == corner_list => {
                    return Err(element.lacks("a list property vertex_indices"));
                }
                kind => data.skip(kind)?,
            }
        }
    }
    Ok(())
}

fn corner(data: &mut Data<impl BufRead>, kind: Scalar, vertices: usize) -> Result<u32, ReadError> {
    let (index, place) = data.integer(kind, "a vertex number, counted from 0")?;
    u32::try_from(index).ok().filter(|&index| index < i32::MAX as u32).ok_or(ReadError::IndexOutOfRange {
        place,
        index,
        vertices: vertices as u64,
        first: 0,
    })
}

pub(super) fn write(writer: impl Write, mesh: &Mesh) -> Result<(), WriteError> {
    let vertices = count_for(Format::Ply, "vertices", mesh.positions.len(), i32::MAX as u32)?;
    let triangles = count_for(Format::Ply, "triangles", mesh.triangles.len(), u32::MAX)?;
    let mut out = BufWriter::with_capacity(1 << 16, writer);
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment Trullo, millimetres, z up\n\
         element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n"
    )?;
    for number in mesh.positions.iter().flat_map(|position| position.to_array()) {
        out.write_all(&number.to_le_bytes())?;
    }
    for corners in &mesh.triangles {
        out.write_all(&[3])?;
        for index in corners {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    out.flush()?;
    Ok(())
}
