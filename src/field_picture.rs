//! Pictures of a field in a plane, as files: what a template looks like before it becomes a solid.

use crate::failure::Failure;
use crate::render;
use blobtree::{Field, FieldPicture, SketchPlane, Tree};
use std::path::Path;

/// The longer side of a picture, pixels.
const SIDE: usize = 800;

/// A PNG file of the field of `tree` in `plane`, on all of its support there.
///
/// Errors: a field that is nowhere above 0.
pub fn png(path: &Path, tree: &Tree, plane: &SketchPlane) -> Result<Vec<u8>, Failure> {
    let framed = FieldPicture::framing(&tree.support(), plane, SIDE)
        .ok_or_else(|| Failure::of(path, "the field is 0 everywhere, so there is nothing to show"))?;
    let size = framed.size.map(|pixels| pixels as u32);
    render::png(&framed.paint(tree), size).map_err(|e| Failure::of(path, e))
}
