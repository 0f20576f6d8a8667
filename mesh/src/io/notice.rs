//! What a reader noticed in a file that it could read all the same.

use std::fmt;

use super::{Format, Place};

/// Something worth telling the user about a file that was read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// The content is of another format than the name says; the content was believed.
    NamedOtherwise {
        /// What the name says.
        named: Format,
        /// What was read.
        found: Format,
    },
    /// Bytes after the end of the mesh were ignored.
    TrailingBytes {
        /// Where they begin.
        at: u64,
        /// How many there are.
        count: u64,
    },
    /// Triangles with two corners in the same vertex were left out.
    CollapsedTriangles {
        /// How many.
        count: u64,
        /// The first of them, counted from 1.
        first: u64,
    },
    /// An ASCII STL file ends without `endsolid`; it may have been cut off.
    MissingEnd {
        /// The last line.
        line: u64,
    },
    /// The file is not in millimetres; its coordinates were converted.
    Converted {
        /// The unit's name.
        unit: &'static str,
        /// Its length, mm.
        millimetres: f64,
    },
    /// Lines, curves, points or statements without a surface were left out.
    SkippedStatements {
        /// How many.
        count: u64,
        /// The line of the first.
        first: u64,
    },
    /// 3MF objects that are not part of the model (supports, modifiers) were left out.
    SkippedObjects {
        /// How many times one was placed.
        count: u64,
    },
    /// The 3MF build section is empty; every object was read where it is defined.
    NothingBuilt,
    /// Polygons that were cut into a fan although they may not be convex.
    FannedPolygons {
        /// How many.
        count: u64,
        /// The first of them.
        first: Place,
    },
    /// Vertices at open edges were joined with others in the same place, which closed edges.
    JoinedVertices {
        /// How many are gone.
        count: u64,
        /// How far apart they were at most, mm; 0 if in exactly the same place.
        within: f64,
        /// How many triangles went because they lost a side.
        collapsed: u64,
        /// How many edges were open.
        open: u64,
        /// How many edges still are.
        left: u64,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NamedOtherwise { named, found } => {
                write!(f, "named as {named}, but the content is {found}; read as {found}")
            }
            Self::TrailingBytes { at, count } => {
                write!(f, "{count} bytes after the end of the mesh (from byte {at}) were ignored")
            }
            Self::CollapsedTriangles { count, first } => write!(
                f,
                "{count} triangles with two corners in one point were left out, the first is triangle {first}"
            ),
            Self::MissingEnd { line } => {
                write!(f, "line {line}: the file ends without endsolid and may have been cut off")
            }
            Self::Converted { unit, millimetres } => {
                write!(f, "converted from {unit} ({millimetres} mm)")
            }
            Self::SkippedStatements { count, first } => {
                write!(f, "{count} statements without a surface were left out, the first on line {first}")
            }
            Self::SkippedObjects { count } => {
                write!(
                    f,
                    "{count} objects that are not part of the model (supports, modifiers) were left out"
                )
            }
            Self::NothingBuilt => {
                f.write_str("the build section is empty; every object was read where it is defined")
            }
            Self::FannedPolygons { count, first } => write!(
                f,
                "{count} polygons were cut into fans, which is wrong if they are not convex; the first is at {first}"
            ),
            Self::JoinedVertices { count, within, collapsed, open, left } => {
                if *within > 0.0 {
                    write!(f, "{count} vertices within {within:.1e} mm of another were joined with it")?;
                } else {
                    write!(f, "{count} vertices in exactly the same place as another were joined with it")?;
                }
                match left {
                    0 => write!(f, ", which closed all {open} open edges")?,
                    _ => write!(f, ", which left {left} of {open} open edges")?,
                }
                match collapsed {
                    0 => Ok(()),
                    _ => write!(f, "; {collapsed} triangles that lost a side by it were left out"),
                }
            }
        }
    }
}
