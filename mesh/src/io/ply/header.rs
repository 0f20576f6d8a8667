//! The header of a PLY file: its encoding, and what each element is made of.

use std::io::BufRead;

use super::super::builder::check;
use super::super::error::quoted;
use super::super::text::{Lines, words};
use super::super::{Place, ReadError};

/// Most lines of a header; real ones have a few dozen.
const MAX_HEADER_LINES: u64 = 10_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Both spellings of a type name.
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a value in a binary file.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The line that announces it.
    pub(super) place: Place,
}

impl Element {
    /// The index of the first property of that name.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name)
    }

    pub(super) fn lacks(&self, expected: &str) -> ReadError {
        let names: Vec<&str> = self.properties.iter().map(|property| property.name.as_str()).collect();
        let found =
            format!("element {} with the properties {}", self.name, quoted(names.join(", ").as_bytes()));
        ReadError::Malformed { place: self.place.clone(), found, expected: expected.to_owned() }
    }

    /// The least number of bytes one of these takes.
    pub(super) fn least_size(&self, encoding: Encoding) -> u64 {
        let least = |kind: Kind| match (encoding, kind) {
            // A digit and a blank.
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(scalar)) => scalar.size(),
            (_, Kind::List { count, .. }) => count.size(),
        };
        self.properties.iter().map(|property| least(property.kind)).sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// Reads up to and including `end_header`; hands back the reader at the first byte of the data.
    pub(super) fn read<R: BufRead>(reader: R) -> Result<(Self, Lines<R>), ReadError> {
        let mut lines = Lines::new(reader);
        if lines.next()?.map(<[u8]>::trim_ascii) != Some(b"ply") {
            return Err(wrong(&lines, "`ply`, the first line of a PLY file"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while lines.next()?.is_some() {
            check(lines.number, MAX_HEADER_LINES, "header lines", || lines.place())?;
            let statement: Vec<&[u8]> = words(lines.line()).take(6).collect();
            match statement[..] {
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"end_header"] => {
                    let encoding = encoding.ok_or_else(|| wrong(&lines, "a format line before it"))?;
                    return Ok((Self { encoding, elements }, lines));
                }
                [b"format", name, b"1.0"] if encoding.is_none() => {
                    encoding = Some(encoding_named(name, &lines)?);
                }
                [b"element", name, count] => elements.push(element(name, count, &lines)?),
                [b"property", ref kind @ .., name] => {
                    let property = property(kind, name, &lines)?;
                    match elements.last_mut() {
                        Some(element) => element.properties.push(property),
                        None => return Err(wrong(&lines, "an element before its properties")),
                    }
                }
                _ => return Err(wrong(&lines, "format, element, property, comment or end_header")),
            }
        }
        let missing = "the header has no end_header line".to_owned();
        Err(ReadError::Truncated { place: lines.place(), missing })
    }
}

fn wrong<R: BufRead>(lines: &Lines<R>, expected: &str) -> ReadError {
    ReadError::Malformed { place: lines.place(), found: quoted(lines.line()), expected: expected.to_owned() }
}

fn encoding_named<R: BufRead>(name: &[u8], lines: &Lines<R>) -> Result<Encoding, ReadError> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(wrong(lines, "ascii, binary_little_endian or binary_big_endian")),
    }
}

fn element<R: BufRead>(name: &[u8], count: &[u8], lines: &Lines<R>) -> Result<Element, ReadError> {
    let count = std::str::from_utf8(count).ok().and_then(|text| text.parse().ok());
    let count = count.ok_or_else(|| wrong(lines, "element NAME COUNT"))?;
    let name = String::from_utf8_lossy(name).into_owned();
    Ok(Element { name, count, properties: Vec::new(), place: lines.place() })
}

fn property<R: BufRead>(kind: &[&[u8]], name: &[u8], lines: &Lines<R>) -> Result<Property, ReadError> {
    let kind = match *kind {
        [scalar] => Scalar::named(scalar).map(Kind::Scalar),
        [b"list", count, item] => Scalar::named(count)
            .filter(|count| !matches!(count, Scalar::F32 | Scalar::F64))
            .zip(Scalar::named(item))
            .map(|(count, item)| Kind::List { count, item }),
        _ => None,
    };
    let kind =
        kind.ok_or_else(|| wrong(lines, "property TYPE NAME or property list COUNT_TYPE TYPE NAME"))?;
    Ok(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}
