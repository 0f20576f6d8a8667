//! The implicit tree.

pub mod build;
mod cache;
mod changes;
mod checks;
mod combine;
mod document;
mod eval;
mod explain;
mod falloff;
mod field;
mod imported;
mod leaf;
mod node;
mod operator;
mod pick;
mod primitive;
pub mod random;
mod scalar;
mod scene;
mod warp;
mod warp_map;

pub use cache::{CachePolicy, CacheStore};
pub use changes::changed_region;
pub use checks::ParameterError;
pub use document::{
    Change, Command, CommandError, DEFAULT_OLDER_VERSIONS, Document, HISTORY_LIMIT, NewShape, SaveError,
    write_atomically,
};
pub use eval::{Tree, support};
pub use explain::{Part, explain};
pub use field::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, ISO, Interval, Sample, Sampler};
pub use imported::ImportedMesh;
pub use node::{Color, Node, NodePath, NodePathError, NodeRef, Shape};
pub use operator::{Operator, Sharpness};
pub use pick::{Hit, Pick, cast_ray, pick};
pub use primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, PolylinePoint, Primitive,
    Segment, Torus,
};
pub use scene::{
    ColorError, MAX_DEPTH, MAX_FILE_BYTES, MAX_NODES, MAX_OBJECTS, MeshReference, MeshSource, NoMeshes,
    Scene, SceneError, SceneProblem, TYPE_NAMES, TextPosition, VERSION, scene_schema,
};
pub use warp::{AffineMap, Axis, Bend, Taper, Transform, Twist, Warp};
