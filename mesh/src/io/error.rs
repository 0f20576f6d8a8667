//! What can go wrong with a mesh file, told with the place, the value and what would be right.

use std::fmt;
use std::io;

use super::Format;

/// Where in a file something is. Lines, triangles and vertices count from 1, bytes from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text format.
    Line(u64),
    /// A byte offset of a binary format.
    Byte(u64),
    /// A triangle of a binary STL file.
    Triangle(u64),
    /// A byte offset inside one part of a 3MF package.
    Part {
        /// The part's name in the package.
        name: String,
        /// The byte in the unpacked part.
        byte: u64,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Triangle(triangle) => write!(f, "triangle {triangle}"),
            Self::Part { name, byte } => write!(f, "{name}, byte {byte}"),
        }
    }
}

/// Why a mesh file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The reader itself failed: no permission, a directory, a pulled-out stick.
    #[error("the file cannot be read: {0}")]
    Io(#[from] io::Error),
    /// There are no bytes.
    #[error("the file is empty; a mesh file has at least one triangle")]
    Empty,
    /// Something is not what the format asks for at that place.
    #[error("{place}: found {found}, expected {expected}")]
    Malformed {
        /// Where.
        place: Place,
        /// What is there, shortened.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// The file ends before its content does.
    #[error("{place}: the file ends too early: {missing}")]
    Truncated {
        /// Where the missing content would be.
        place: Place,
        /// What was announced or begun, and how much of it is there.
        missing: String,
    },
    /// A coordinate is NaN, infinite, or too large for a 32-bit float.
    #[error("{place}: the {axis} coordinate is {value}; coordinates must be finite numbers below 3.4e38")]
    NotFinite {
        /// Where.
        place: Place,
        /// `x`, `y` or `z`.
        axis: char,
        /// As written in the file, shortened.
        value: String,
    },
    /// A face names a vertex that does not exist.
    #[error("{place}: a face uses vertex {index}, but {}", vertex_range(*vertices, *first))]
    IndexOutOfRange {
        /// Where.
        place: Place,
        /// As written in the file.
        index: i64,
        /// How many vertices there are.
        vertices: u64,
        /// How the format counts: the number of the first vertex, 0 or 1.
        first: u64,
    },
    /// More of something than [`ReadLimits`](super::ReadLimits) allows.
    #[error("{place}: {found} {what}, more than the {limit} that are read")]
    TooLarge {
        /// Where the limit was passed.
        place: Place,
        /// What there is too much of.
        what: &'static str,
        /// How much of it there is, as far as is known.
        found: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// The file is readable but holds nothing that has a surface.
    #[error("no triangles in this {format} file; {hint}")]
    NoTriangles {
        /// The format it was read as.
        format: Format,
        /// What the file holds instead, or what to look for.
        hint: String,
    },
    /// The file is valid, but needs something that is not read here.
    #[error("{place}: {what} is not supported; {instead}")]
    Unsupported {
        /// Where.
        place: Place,
        /// The feature.
        what: String,
        /// What would work.
        instead: &'static str,
    },
}

fn vertex_range(vertices: u64, first: u64) -> String {
    match vertices {
        0 => "there are no vertices".to_owned(),
        _ => format!("vertices run from {first} to {}", vertices - 1 + first),
    }
}

/// Why a mesh is not written. Nothing but [`WriteError::Io`] can happen after the first byte.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The writer failed: no space, no permission.
    #[error("the file cannot be written: {0}")]
    Io(#[from] io::Error),
    /// There is nothing to write.
    #[error("the mesh has no triangles; nothing is written")]
    NoTriangles,
    /// A vertex is NaN or infinite.
    #[error("vertex {vertex} is not finite ({value}); nothing is written")]
    NotFinite {
        /// Index into the positions.
        vertex: usize,
        /// The position.
        value: glam::Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index} of {vertices}; nothing is written")]
    IndexOutOfRange {
        /// Index into the triangles.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many positions there are.
        vertices: usize,
    },
    /// A triangle uses the same vertex twice.
    #[error("triangle {triangle} uses vertex {index} twice; nothing is written")]
    Collapsed {
        /// Index into the triangles.
        triangle: usize,
        /// The index it holds twice.
        index: u32,
    },
    /// More elements than the format can count.
    #[error("{count} {what} are more than a {format} file can count ({limit}); nothing is written")]
    TooMany {
        /// Vertices or triangles.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// The format.
        format: Format,
        /// The most it can count.
        limit: u64,
    },
    /// A metadata entry that a 3MF file cannot carry.
    #[error("metadata {name:?}: {problem}; nothing is written")]
    Metadata {
        /// The entry's name.
        name: String,
        /// What is wrong with it, and what would be right.
        problem: &'static str,
    },
    /// Materials that a 3MF file cannot carry.
    #[error("the materials of the triangles: {problem}; nothing is written")]
    Materials {
        /// What is wrong with them.
        problem: &'static str,
    },
}

/// Text from a file, shortened and made printable for an error message.
pub(super) fn quoted(bytes: &[u8]) -> String {
    const SHOWN: usize = 48;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN)]);
    let mut shown: String = text.chars().take(SHOWN).collect();
    if shown.len() < bytes.len() {
        shown.push('…');
    }
    format!("{shown:?}")
}
