//! What scene files promise.

mod broken;
mod messages;
mod published;
mod round_trip;
mod strokes;

use super::{Scene, SceneError};
use crate::random::PolygonSources;

fn read(text: &str) -> Result<Scene, SceneError> {
    Scene::from_bytes(text.as_bytes(), &mut PolygonSources)
}

/// A file with this root.
fn file(root: &str) -> String {
    format!(r#"{{"format": "trullo", "version": 1, "root": {root}}}"#)
}

/// A file with a node of every type that needs no mesh.
const ALL_TYPES: &str = include_str!("all_types.trullo");
