//! Binary STL: an 80-byte header, a count, and 50 bytes a triangle.
//!
//! Normals and colours are not read: the corners' order says which side is outside.

use std::io::{BufWriter, Read, Write};

use glam::Vec3;

use super::builder::{MeshBuilder, check};
use super::number::finite;
use super::weld::Welder;
use super::{Format, Loaded, Notice, Place, ReadError, ReadLimits, WriteError, count_for};
use crate::Mesh;

const HEADER: u64 = 84;
const RECORD: u64 = 50;
const RECORD_BYTES: usize = RECORD as usize;

/// Whether the length of a file is exactly what the count in its header announces (a header that begins with
/// `solid` proves nothing: many exporters write one).
pub(super) fn length_fits_count(beginning: &[u8], length: u64) -> bool {
    announced(beginning).is_some_and(|count| count > 0 && HEADER + RECORD * u64::from(count) == length)
}

fn announced(beginning: &[u8]) -> Option<u32> {
    let count = beginning.get(80..84)?;
    Some(u32::from_le_bytes(count.try_into().expect("the slice is four bytes long")))
}

pub(super) fn read(mut reader: impl Read, length: u64, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let mut header = Vec::new();
    reader.by_ref().take(HEADER).read_to_end(&mut header)?;
    let Some(count) = announced(&header) else {
        let missing = format!("a binary STL header is {HEADER} bytes long, this file has {length}");
        return Err(ReadError::Truncated { place: Place::Byte(length), missing });
    };
    let count = u64::from(count);
    let end = HEADER + RECORD * count;
    if length < end {
        let whole = (length - HEADER.min(length)) / RECORD;
        let missing = format!(
            "the header announces {count} triangles ({end} bytes), the file has {length} bytes, enough for {whole}; \
             or this is not an STL file"
        );
        return Err(ReadError::Truncated { place: Place::Byte(length), missing });
    }
    check(count, limits.max_triangles, "triangles", || Place::Byte(80))?;

    let mut builder = MeshBuilder::new(limits);
    read_records(reader, count, &mut builder)?;
    let mut notices = Vec::new();
    if length > end {
        notices.push(Notice::TrailingBytes { at: end, count: length - end });
    }
    builder.finish(Format::Stl, notices, || match length - HEADER {
        0 => "the header announces none".to_owned(),
        rest => format!("the header announces none although {rest} bytes follow it"),
    })
}

fn read_records(mut reader: impl Read, count: u64, builder: &mut MeshBuilder) -> Result<(), ReadError> {
    // A closed mesh has half as many vertices as triangles, and the file is long enough for its triangles.
    let mut welder = Welder::with_room(count as usize / 2);
    let mut chunk = vec![0; 1024 * RECORD_BYTES];
    let mut triangle = 0;
    while triangle < count {
        let records = (count - triangle).min(1024) as usize;
        let bytes = &mut chunk[..records * RECORD_BYTES];
        reader.read_exact(bytes)?;
        for record in bytes.chunks_exact(RECORD_BYTES) {
            triangle += 1;
            let place = || Place::Triangle(triangle);
            let mut corners = [0; 3];
            for (corner, index) in corners.iter_mut().enumerate() {
                let position = finite(corner_of(record, corner), place)?;
                *index = builder.welded(&mut welder, position, place)?;
            }
            builder.triangle(corners, place)?;
        }
    }
    Ok(())
}

/// A corner of a record; the normal comes first.
fn corner_of(record: &[u8], corner: usize) -> Vec3 {
    let number = |axis: usize| {
        let at = 12 * (corner + 1) + 4 * axis;
        f32::from_le_bytes(record[at..at + 4].try_into().expect("the slice is four bytes long"))
    };
    Vec3::new(number(0), number(1), number(2))
}

pub(super) fn write(writer: impl Write, mesh: &Mesh) -> Result<(), WriteError> {
    let count = count_for(Format::Stl, "triangles", mesh.triangles.len(), u32::MAX)?;
    let mut out = BufWriter::with_capacity(1 << 16, writer);
    // The header must not begin with "solid", or some readers take the file for text.
    let mut header = [b' '; 80];
    let text = b"Trullo, binary STL, millimetres";
    header[..text.len()].copy_from_slice(text);
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    for &corners in &mesh.triangles {
        let corners = corners.map(|index| mesh.positions[index as usize]);
        let mut record = [0; RECORD_BYTES];
        let numbers = [normal(corners), corners[0], corners[1], corners[2]].map(|v| v.to_array());
        for (bytes, number) in record.chunks_exact_mut(4).zip(numbers.as_flattened()) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    out.flush()?;
    Ok(())
}

/// The unit normal of a triangle, or zero where it has none; f64 so that tiny and huge triangles have one too.
pub(super) fn normal(corners: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}
