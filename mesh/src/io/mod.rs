//! Mesh files: STL, OBJ, PLY and 3MF to and from any [`Read`] or [`Write`].
//!
//! Reach for it whenever triangles enter or leave the program. [`read`] believes the content rather than the
//! name, converts to millimetres, joins what rounding took apart ([`close_cracks`]), and reports what it noticed;
//! [`write()`] refuses a mesh that no reader could take back. Neither opens files, fills holes, or judges whether
//! meshes print.
//!
//! Files come from strangers: no input panics, hangs, or makes a reader allocate by an announced count. What
//! is allocated grows with what was actually read, and [`ReadLimits`] bounds that.
//!
//! ```
//! use glam::Vec3;
//! use mesh::{Mesh, io};
//!
//! let tetrahedron = Mesh {
//!     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//! };
//! let mut file = std::io::Cursor::new(Vec::new());
//! io::write(&mut file, &tetrahedron, io::Format::ThreeMf, &io::Attachments::default())?;
//! let back = io::read(&mut file, io::Format::ThreeMf, &io::ReadLimits::default())?;
//! assert_eq!(back.mesh, tetrahedron);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod builder;
mod cracks;
mod error;
mod notice;
mod number;
mod obj;
mod ply;
mod polygon;
mod stl;
mod stl_ascii;
mod text;
mod threemf;
mod weld;

use std::fmt;
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crate::Mesh;

pub use cracks::close_cracks;
pub use error::{Place, ReadError, WriteError};
pub use notice::Notice;
pub use weld::weld;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Binary STL: triangles without connectivity, no unit (millimetres assumed).
    Stl,
    /// STL as text.
    StlAscii,
    /// Wavefront OBJ: text, indexed, no unit (millimetres assumed).
    Obj,
    /// Stanford PLY: indexed, no unit (millimetres assumed). All three encodings are read, binary
    /// little-endian is written.
    Ply,
    /// 3MF core: a package with a unit, build transforms, metadata and further parts.
    ThreeMf,
}

impl Format {
    /// The formats a user can name by extension; [`Format::StlAscii`] shares `stl` with [`Format::Stl`].
    pub const EXTENSIONS: [&'static str; 4] = ["stl", "obj", "ply", "3mf"];

    /// The format that a file name extension (without the dot, any case) stands for.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let formats = [Self::Stl, Self::Obj, Self::Ply, Self::ThreeMf];
        let known = Self::EXTENSIONS.iter().zip(formats);
        known.into_iter().find_map(|(known, format)| extension.eq_ignore_ascii_case(known).then_some(format))
    }

    /// The format that a path's extension stands for.
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::from_extension(path.extension()?.to_str()?)
    }

    /// The extension files of this format should have, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Stl | Self::StlAscii => "stl",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::ThreeMf => "3mf",
        }
    }

    /// The format that a file's beginning (its first kilobyte is enough) and whole length speak for, whatever
    /// its name. `None` where the content does not say: OBJ has no mark of its own, nor has a broken STL.
    pub fn sniff(beginning: &[u8], length: u64) -> Option<Self> {
        if beginning.starts_with(b"PK\x03\x04") || beginning.starts_with(b"PK\x05\x06") {
            Some(Self::ThreeMf)
        } else if beginning.starts_with(b"ply\n") || beginning.starts_with(b"ply\r") {
            Some(Self::Ply)
        } else if stl::length_fits_count(beginning, length) {
            Some(Self::Stl)
        } else {
            stl_ascii::looks_like(beginning).then_some(Self::StlAscii)
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stl => "binary STL",
            Self::StlAscii => "ASCII STL",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::ThreeMf => "3MF",
        })
    }
}

/// How much a reader takes before it says that a file is too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadLimits {
    /// Bytes in the file, and bytes unpacked from a 3MF package. A package is further held to a hundred times
    /// its packed size (but at least 16 MiB), which no honest model reaches and every zip bomb passes.
    pub max_bytes: u64,
    /// Triangles after polygons are cut and 3MF copies are placed.
    pub max_triangles: u64,
    /// Vertices after welding and after 3MF copies are placed.
    pub max_vertices: u64,
}

impl Default for ReadLimits {
    /// 2 GiB, 20 million triangles, 20 million vertices: about 0.5 GiB of mesh.
    fn default() -> Self {
        Self { max_bytes: 2 << 30, max_triangles: 20_000_000, max_vertices: 20_000_000 }
    }
}

/// What a 3MF package carries beside the mesh. The other formats carry none of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attachments {
    /// What the model is called.
    pub title: Option<String>,
    /// The scene that the mesh was made from, as a part that other programs are asked to preserve.
    pub scene: Option<Vec<u8>>,
    /// Further names and values. Names are XML names without a colon; those that 3MF does not define itself
    /// are written in Trullo's namespace. `Title` and `Application` are not among them.
    pub metadata: Vec<(String, String)>,
    /// What the triangles are made of, if something says so. Written, not read.
    pub materials: Option<TriangleMaterials>,
}

/// What each triangle of a mesh is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TriangleMaterials {
    /// The materials, the usual one first.
    pub materials: Vec<Material>,
    /// For each triangle, the number of its material.
    pub of_triangles: Vec<u32>,
}

/// A material, as other programs show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Material {
    /// What it is called.
    pub name: String,
    /// Red, green and blue (sRGB).
    pub color: [u8; 3],
}

/// A mesh that was read, with what was noticed on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The mesh, mm. Indices are in range, coordinates finite, no triangle uses a vertex twice; it has at
    /// least one triangle. It need not be closed or oriented.
    pub mesh: Mesh,
    /// The format that was actually read.
    pub format: Format,
    /// What the user may want to know, in a fixed order.
    pub notices: Vec<Notice>,
    /// What a 3MF package carried beside the mesh.
    pub attachments: Attachments,
}

/// Reads a mesh from the reader's beginning to its end.
///
/// - **Format:** `named` is what the file's name says; where the content clearly says otherwise
///   ([`Format::sniff`]) the content is read and [`Notice::NamedOtherwise`] reported.
/// - **Units:** millimetres; formats without a unit are taken to be in millimetres.
/// - **Order:** vertices and triangles in file order. STL corners that are bit-identical (`-0 = 0`) are welded in
///   order of first appearance; the other formats keep their own indices ([`weld()`] joins them on request).
/// - **Cracks:** where that closes edges, vertices are joined as in [`close_cracks`], with a
///   [`Notice::JoinedVertices`]. [`read_as_written`] leaves them.
/// - **Errors:** [`ReadError`], with the place. **Cost:** O(file), and sorting the edges of a mesh that is open;
///   memory by what is read, within `limits`.
pub fn read<R: Read + Seek>(reader: R, named: Format, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let mut loaded = read_as_written(reader, named, limits)?;
    loaded.notices.extend(close_cracks(&mut loaded.mesh));
    Ok(loaded)
}

/// As [`read`], but cracks stay open: every format but STL comes back with the vertices that it has.
pub fn read_as_written<R: Read + Seek>(
    mut reader: R,
    named: Format,
    limits: &ReadLimits,
) -> Result<Loaded, ReadError> {
    let length = reader.seek(SeekFrom::End(0))?;
    reader.rewind()?;
    if length > limits.max_bytes {
        let what = "bytes";
        return Err(ReadError::TooLarge { place: Place::File, what, found: length, limit: limits.max_bytes });
    }
    let mut beginning = Vec::new();
    reader.by_ref().take(1024).read_to_end(&mut beginning)?;
    reader.rewind()?;
    if beginning.is_empty() {
        return Err(ReadError::Empty);
    }

    let format = Format::sniff(&beginning, length).unwrap_or(named);
    let mut loaded = match format {
        Format::ThreeMf => threemf::read(reader, length, limits)?,
        Format::Stl => stl::read(reader, length, limits)?,
        Format::StlAscii => stl_ascii::read(BufReader::with_capacity(1 << 16, reader), limits)?,
        Format::Obj => obj::read(BufReader::with_capacity(1 << 16, reader), limits)?,
        Format::Ply => ply::read(BufReader::with_capacity(1 << 16, reader), length, limits)?,
    };
    if loaded.format.extension() != named.extension() {
        loaded.notices.insert(0, Notice::NamedOtherwise { named, found: loaded.format });
    }
    Ok(loaded)
}

/// Writes a mesh, and to 3MF its attachments too.
///
/// - **Promises:** the same mesh gives the same bytes; [`read_as_written`] gives the same mesh back (STL: the same
///   triangles, welded), and so does [`read`] if it is closed. Text holds the shortest numbers that read back exactly.
/// - **Units:** millimetres, which 3MF says and the others cannot.
/// - **Errors:** [`WriteError`]; a mesh with a coordinate that is not finite, an index out of range, a triangle
///   that uses a vertex twice, or no triangles is refused before the first byte. Whether it is closed is not asked.
pub fn write<W: Write + Seek>(
    writer: W,
    mesh: &Mesh,
    format: Format,
    attachments: &Attachments,
) -> Result<(), WriteError> {
    check_writable(mesh)?;
    match format {
        Format::Stl => stl::write(writer, mesh),
        Format::StlAscii => stl_ascii::write(writer, mesh),
        Format::Obj => obj::write(writer, mesh),
        Format::Ply => ply::write(writer, mesh),
        Format::ThreeMf => threemf::write(writer, mesh, attachments),
    }
}

fn check_writable(mesh: &Mesh) -> Result<(), WriteError> {
    if mesh.triangles.is_empty() {
        return Err(WriteError::NoTriangles);
    }
    if let Some((vertex, &value)) = mesh.positions.iter().enumerate().find(|(_, p)| !p.is_finite()) {
        return Err(WriteError::NotFinite { vertex, value });
    }
    let vertices = mesh.positions.len();
    for (triangle, &corners) in mesh.triangles.iter().enumerate() {
        if let Some(index) = corners.into_iter().find(|&index| index as usize >= vertices) {
            return Err(WriteError::IndexOutOfRange { triangle, index, vertices });
        }
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            let index = if b == c { b } else { a };
            return Err(WriteError::Collapsed { triangle, index });
        }
    }
    Ok(())
}

/// A count as the format's integer, or an error that names the format's limit.
fn count_for(format: Format, what: &'static str, count: usize, limit: u32) -> Result<u32, WriteError> {
    match u32::try_from(count) {
        Ok(counted) if counted <= limit => Ok(counted),
        _ => Err(WriteError::TooMany { what, count, format, limit: limit.into() }),
    }
}
