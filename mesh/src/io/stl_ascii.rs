//! STL as text: any case, any line ends, several solids; normals are not read.

use std::io::{BufRead, BufWriter, Write};

use glam::Vec3;

use super::builder::MeshBuilder;
use super::error::quoted;
use super::number::{AXES, write_point};
use super::stl::normal;
use super::text::{Lines, Words};
use super::weld::Welder;
use super::{Format, Loaded, Notice, ReadError, ReadLimits, WriteError};
use crate::Mesh;

/// Most words between `facet` and `outer`: `normal` and three numbers, with room for odd exporters.
const MAX_NORMAL_WORDS: usize = 8;

/// Whether a file begins like a text STL: the word `solid`, and no zero bytes, of which every binary STL has some.
pub(super) fn looks_like(beginning: &[u8]) -> bool {
    let text = beginning.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(beginning).trim_ascii_start();
    let starts = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    starts && !text.contains(&0)
}

pub(super) fn read(reader: impl BufRead, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let mut words = Words::new(Lines::new(reader));
    let mut builder = MeshBuilder::new(limits);
    let mut welder = Welder::with_room(0);
    let mut ended = false;
    while let Some(word) = words.next()? {
        let word = word.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(word);
        if word.eq_ignore_ascii_case(b"facet") {
            facet(&mut words, &mut welder, &mut builder)?;
        } else if word.eq_ignore_ascii_case(b"solid") {
            ended = false;
            words.skip_line();
        } else if word.eq_ignore_ascii_case(b"endsolid") {
            ended = true;
            words.skip_line();
        } else {
            let (found, expected) = (quoted(word), "facet, endsolid or solid".to_owned());
            return Err(ReadError::Malformed { place: words.place(), found, expected });
        }
    }
    let notices = if ended { Vec::new() } else { vec![Notice::MissingEnd { line: words.line_number() }] };
    builder.finish(Format::StlAscii, notices, || "it has no facets".to_owned())
}

/// Reads a facet, its first word being taken.
fn facet<R: BufRead>(
    words: &mut Words<R>,
    welder: &mut Welder,
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    let mut normal_words = 0;
    while !words.need("outer loop")?.eq_ignore_ascii_case(b"outer") {
        normal_words += 1;
        if normal_words > MAX_NORMAL_WORDS {
            let found = "more than a normal".to_owned();
            return Err(ReadError::Malformed {
                place: words.place(),
                found,
                expected: "outer loop".to_owned(),
            });
        }
    }
    words.keyword("loop")?;
    let mut corners = [0; 3];
    for index in &mut corners {
        words.keyword("vertex")?;
        let mut position = Vec3::ZERO;
        for (axis, name) in AXES.into_iter().enumerate() {
            position[axis] = words.coordinate(name)?;
        }
        *index = builder.welded(welder, position, || words.place())?;
    }
    words.keyword("endloop")?;
    words.keyword("endfacet")?;
    builder.triangle(corners, || words.place())
}

pub(super) fn write(writer: impl Write, mesh: &Mesh) -> Result<(), WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, writer);
    out.write_all(b"solid trullo\n")?;
    for &corners in &mesh.triangles {
        let corners = corners.map(|index| mesh.positions[index as usize]);
        out.write_all(b"facet normal")?;
        write_point(&mut out, normal(corners))?;
        out.write_all(b"\nouter loop\n")?;
        for corner in corners {
            out.write_all(b"vertex")?;
            write_point(&mut out, corner)?;
            out.write_all(b"\n")?;
        }
        out.write_all(b"endloop\nendfacet\n")?;
    }
    out.write_all(b"endsolid trullo\n")?;
    out.flush()?;
    Ok(())
}
