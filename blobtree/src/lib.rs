//! The implicit tree: solids as fields, and everything that can be asked of them.
//!
//! A shape is a tree of primitives, operators and warps. Each node is a *field*, a number for every place; the
//! solid is where it is at least [`ISO`]. This crate builds trees, evaluates them, edits them, and reads and
//! writes scene files. It knows nothing of screens, of printers, or of how a mesh is made.
//!
//! Everywhere: mm; right-handed, **z up is the build direction, the bed is z = 0**; fields are ≥ 0, exactly 0
//! outside their support, **solid where ≥ 0.5**; angles are radians in the code, degrees in files and in names
//! that end in `_degrees`; fields are `f32`. The same input gives the same bits, whatever the way of asking.
//!
//! # Build
//!
//! [`build`] makes trees in a few lines; sizes are those of the surface.
//!
//! ```
//! use blobtree::build::*;
//! use blobtree::{Field, ISO, NodeRef, Tree};
//! use glam::Vec3;
//!
//! let block = cuboid([0., 0., 10.], [40., 40., 20.]);
//! let bored: NodeRef = block.subtract(cylinder([0., 0., -1.], [0., 0., 21.], 8.)).into();
//!
//! let tree = Tree::new(&bored);
//! assert!(tree.value(Vec3::new(15., 0., 10.)) >= ISO);
//! assert!(tree.value(Vec3::new(0., 0., 10.)) < ISO);
//! ```
//!
//! # Evaluate
//!
//! A [`Tree`] is a node compiled for evaluation, and a [`Field`]. For more than a few points, make one
//! [`Sampler`] for each thread, enter the region of interest, and ask for a [`Brick`] or a batch.
//!
//! ```
//! use blobtree::build::point;
//! use blobtree::{BRICK_SAMPLES, Brick, Field, ISO, Tree};
//!
//! let tree = Tree::new(&point([0., 0., 0.], 5.));
//! let mut sampler = tree.sampler();
//! let brick = Brick { origin: [-8, -8, -8], spacing: 1.0 };
//! let bound = sampler.enter(brick.region());
//! assert!(bound.may_cross(ISO));
//! let mut values = [0.0; BRICK_SAMPLES];
//! sampler.fill(&brick, &mut values);
//! assert!(values.iter().all(|value| (bound.lo..=bound.hi).contains(value)));
//! ```
//!
//! # Ask why
//!
//! [`explain()`] tells every node's part in the value at a place; [`pick()`] finds what a ray meets and which
//! primitive made it, through holes too.
//!
//! ```
//! use blobtree::build::*;
//! use blobtree::{NodeRef, Tree, pick};
//! use glam::Vec3;
//!
//! let block = cuboid([0., 0., 10.], [40., 40., 20.]);
//! let bored: NodeRef = block.subtract(cylinder([0., 0., -1.], [0., 0., 21.], 8.)).into();
//! let into_the_hole = Vec3::new(0.45, 0., -1.);
//! let found = pick(&bored, &Tree::new(&bored), Vec3::new(-6., 0., 40.), into_the_hole).expect("a wall");
//! assert_eq!(found.contributors[0].0.to_string(), "/1");
//! ```
//!
//! # Keep
//!
//! A [`Scene`] is a tree with a title, and the content of a `.trullo` file.
//!
//! ```
//! use blobtree::build::point;
//! use blobtree::{NoSources, Scene};
//!
//! let scene = Scene::new(point([0., 0., 10.], 10.)).titled("Ball");
//! let text = scene.to_text()?;
//! assert_eq!(Scene::from_bytes(text.as_bytes(), &mut NoSources)?, scene);
//! # Ok::<(), blobtree::SceneError>(())
//! ```
//!
//! # Edit
//!
//! Nodes never change. A [`Document`] applies [`Command`]s, which make new roots that share the rest, and can
//! undo them. [`changed_region`] says where an edit can be felt, and a [`CacheStore`] keeps samples of costly
//! parts from one version to the next.
//!
//! ```
//! use blobtree::build::{point, union};
//! use blobtree::{Command, Document, NodePath, Scene, changed_region};
//!
//! let two = union([point([-9., 0., 0.], 5.), point([9., 0., 0.], 5.)]);
//! let mut document = Document::new(Scene::new(two)).expect("legal");
//! let first = NodePath::default().child(0);
//! let change = document.apply(Command::SetMuted { path: first, muted: true }).expect("there is one");
//! assert!(changed_region(&change.before, &change.after).max.x < 9.);
//! assert!(document.undo().is_some());
//! ```

pub mod build;
mod cache;
mod changes;
mod checks;
mod combine;
mod document;
mod eval;
mod explain;
mod extent;
mod falloff;
mod field;
mod field_picture;
mod imported;
mod leaf;
mod materials;
mod node;
mod operator;
mod owners;
mod palette;
mod pick;
mod primitive;
pub mod random;
mod scalar;
mod scene;
mod sketched;
mod support_free;
mod warp;
mod warp_map;

pub use cache::{CachePolicy, CacheStore};
pub use changes::{ChangedPlaces, changed_region};
pub use checks::ParameterError;
pub use document::{
    Change, Command, CommandError, DEFAULT_OLDER_VERSIONS, Document, HISTORY_LIMIT, JournalEntry, NewShape,
    SaveError, write_atomically,
};
pub use eval::{Tree, support};
pub use explain::{Part, explain, explain_in};
pub use extent::solid_box;
pub use field::{Aabb, BRICK, BRICK_SAMPLES, Brick, Dirty, Field, ISO, Interval, Sample, Sampler};
pub use field_picture::FieldPicture;
pub use imported::ImportedMesh;
pub use materials::{MaterialFinder, Materials};
pub use node::{Color, Node, NodePath, NodePathError, NodeRef, Shape};
pub use operator::{Operator, Sharpness};
pub use owners::{OwnerFinder, Owners};
pub use palette::{Painter, Palette, STONE};
pub use pick::{Hit, Pick, cast_ray, pick};
pub use primitive::{
    Cone, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Point, Polygon, Polyline, PolylinePoint, Primitive,
    Segment, Torus,
};
pub use scene::{
    ColorError, DrawingsBy, MAX_DEPTH, MAX_FILE_BYTES, MAX_NODES, MAX_OBJECTS, MeshReference, NoSources,
    Scene, SceneError, SceneProblem, SceneSources, TYPE_NAMES, TextPosition, VERSION, scene_schema,
};
pub use sketched::{
    Drawing, DrawnPoint, DrawnStroke, FieldImage, Holes, Inflation, LinearSweep, PathSweep, Profile,
    Revolution, RevolutionAxis, Side, SketchPlane, Solved, Template,
};
pub use support_free::{
    Bake, BakeError, BakeStore, Baker, Beyond, BrushKind, BrushStroke, BrushTip, Brushed, GROWN_FALLOFF,
    GROWN_MATERIAL, MAX_NODE_DABS, SupportFree, SupportMode, VOXEL_BRICK, VOXEL_SAMPLES, VoxelBrick,
    VoxelImage, VoxelMaterials,
};
pub use warp::{AffineMap, Axis, Bend, Taper, Transform, Twist, Warp};
