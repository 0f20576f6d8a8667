//! Wavefront OBJ: vertices and faces. Texture, normals, groups and materials are not read.

use std::io::{BufRead, BufWriter, Write};

use glam::Vec3;

use super::builder::MeshBuilder;
use super::error::quoted;
use super::number::{AXES, coordinate, write_point};
use super::polygon::{Faces, check_corners};
use super::text::{Lines, words};
use super::{Format, Loaded, Notice, Place, ReadError, ReadLimits, WriteError};
use crate::Mesh;

/// Statements that describe looks or groups and say nothing about the surface.
const SILENT: [&[u8]; 11] =
    [b"vt", b"vn", b"g", b"o", b"s", b"mtllib", b"usemtl", b"mg", b"lod", b"shadow_obj", b"usemap"];

/// After this many unknown statements and not one vertex, a file is not read to its end.
const ENOUGH_FOREIGN: u64 = 10_000;

pub(super) fn read(reader: impl BufRead, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let mut lines = Lines::new(reader);
    let mut builder = MeshBuilder::new(limits);
    let mut faces = Faces::new(1);
    let mut corners = Vec::new();
    let mut skipped = 0;
    let mut first_skipped = 0;
    while lines.next_continued()?.is_some() {
        let place = lines.place();
        let mut words = words(lines.line());
        match words.next() {
            None => {}
            Some(b"v") => {
                let position = vertex(words, &place)?;
                builder.vertex(position, || place)?;
            }
            Some(b"f") => {
                face(words, builder.vertices(), &place, &mut corners)?;
                faces.add(&mut builder, &corners, place)?;
            }
            Some(word) if word.starts_with(b"#") || SILENT.contains(&word) || is_mark(lines.number, word) => {
            }
            Some(_) => {
                skipped += 1;
                first_skipped = if skipped == 1 { lines.number } else { first_skipped };
                if skipped >= ENOUGH_FOREIGN && builder.vertices() == 0 {
                    break;
                }
            }
        }
    }
    let mut notices = Vec::new();
    faces.finish(builder.vertices(), &mut notices)?;
    if skipped > 0 {
        notices.push(Notice::SkippedStatements { count: skipped, first: first_skipped });
    }
    let vertices = builder.vertices();
    builder.finish(Format::Obj, notices, || match vertices {
        0 => "it has no `v` and `f` statements and is perhaps no OBJ file".to_owned(),
        count => format!("it has {count} vertices, but no faces"),
    })
}

/// A comment after a byte order mark, which only the first line can have.
fn is_mark(line: u64, word: &[u8]) -> bool {
    line == 1 && word.starts_with(b"\xEF\xBB\xBF")
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a [u8]>, place: &Place) -> Result<Vec3, ReadError> {
    let mut position = Vec3::ZERO;
    for (axis, name) in AXES.into_iter().enumerate() {
        let Some(word) = words.next() else {
            let found = format!("a vertex without a {name} coordinate");
            return Err(ReadError::Malformed { place: place.clone(), found, expected: "v x y z".to_owned() });
        };
        position[axis] = coordinate(word, name, || place.clone())?;
    }
    Ok(position)
}

/// Reads the corners of a face, counted from 0: `7`, `7/3`, `7//2`, `7/3/2`, or from the end, `-1`.
fn face<'a>(
    words: impl Iterator<Item = &'a [u8]>,
    vertices: usize,
    place: &Place,
    corners: &mut Vec<u32>,
) -> Result<(), ReadError> {
    corners.clear();
    for word in words.take_while(|word| !word.starts_with(b"#")) {
        let number = word.split(|&byte| byte == b'/').next().unwrap_or_default();
        let parsed = std::str::from_utf8(number).ok().and_then(|text| text.parse::<i64>().ok());
        let Some(index) = parsed.filter(|&index| index != 0) else {
            let expected = "a vertex number from 1, or from -1 backwards".to_owned();
            return Err(ReadError::Malformed { place: place.clone(), found: quoted(word), expected });
        };
        let counted = if index > 0 { index - 1 } else { index.saturating_add(vertices as i64) };
        // The highest indices cannot be counted, so no file can have as many vertices.
        let corner =
            u32::try_from(counted).ok().filter(|&corner| corner < i32::MAX as u32).ok_or_else(|| {
                ReadError::IndexOutOfRange {
                    place: place.clone(),
                    index,
                    vertices: vertices as u64,
                    first: 1,
                }
            })?;
        corners.push(corner);
    }
    check_corners(corners.len() as u64, || place.clone())
}

pub(super) fn write(writer: impl Write, mesh: &Mesh) -> Result<(), WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, writer);
    out.write_all(b"# Trullo, millimetres, z up\n")?;
    for &position in &mesh.positions {
        out.write_all(b"v")?;
        write_point(&mut out, position)?;
        out.write_all(b"\n")?;
    }
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|index| u64::from(index) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    out.flush()?;
    Ok(())
}
