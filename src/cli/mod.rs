//! The command line as the user writes it.

mod check;
mod common;
mod convert;
mod eval;
mod mesh;
mod render;
mod sketch;
mod slice;
mod support_free;
mod tree;
mod values;

pub use check::CheckArgs;
pub use common::{Bed, Common, ConstraintArgs, ReadingArgs, ResolutionArgs, RuleArgs, ShapeArgs};
pub use convert::ConvertArgs;
pub use eval::EvalArgs;
pub use mesh::MeshArgs;
pub use render::RenderArgs;
pub use sketch::{SketchArgs, SolidKind};
pub use slice::{LayerKind, SliceArgs};
pub use support_free::{SupportFreeArgs, SupportOperator};
pub use tree::TreeArgs;

use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Shapes that always 3D-print without supports: sketch, constrain, evaluate, mesh, render, convert and check them.
#[derive(Debug, Parser)]
#[command(name = "trullo", version, disable_help_subcommand = true, args_conflicts_with_subcommands = true)]
#[command(
    after_help = "Exit codes: 0 done, 1 the check found something, 2 bad input or usage, 3 interrupted.\n\
    Scenes are .trullo files, or 3MF files that Trullo wrote; meshes are STL, OBJ, PLY and 3MF.\n\
    Lengths are millimetres, and z points up from the bed."
)]
pub struct Cli {
    /// What to do without a window.
    #[command(subcommand)]
    pub verb: Option<Verb>,
    /// A scene, a mesh or a drawing to open in the modeler.
    pub file: Option<PathBuf>,
    /// Write down how long the modeler lets its user wait: a line of JSON for each wait and each frame.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Say what the field of a scene is at a point, and whether that is inside.
    #[command(after_help = "Example: trullo eval snowman.trullo --at 0,0,20 --explain")]
    Eval(EvalArgs),
    /// List the nodes of a scene with their places and sizes.
    #[command(after_help = "Example: trullo tree snowman.trullo")]
    Tree(TreeArgs),
    /// Turn a scene into a mesh for printing.
    #[command(after_help = "Example: trullo mesh snowman.trullo -o snowman.3mf --cell 0.4")]
    Mesh(MeshArgs),
    /// Make a scene or mesh print without supports.
    ///
    /// What the layer below cannot carry is taken away (trim), or matter grows below it (grow), smoothly. A scene
    /// keeps its parts: everything can still be changed, and the result follows. With the name of a mesh the result is
    /// meshed at once.
    #[command(after_help = "Examples:\n  trullo support-free snowman.trullo -o snowman.3mf\n  \
        trullo support-free bunny.stl -o bunny-printable.stl --height 50 --drop --operator grow --max-overhang 50")]
    SupportFree(SupportFreeArgs),
    /// Turn drawings into solids.
    ///
    /// Drawings are SVG pictures, doodles (.ndjson) or Trullo's own strokes (.json). An outline is blown up like
    /// a balloon, made thick like a biscuit, or turned round like a vase; a line that does not close becomes a
    /// tube. The scene keeps the strokes, so everything can still be changed. With the name of a mesh the scene is
    /// meshed at once.
    #[command(after_help = "Examples:\n  trullo sketch duck.svg -o duck.trullo\n  \
        trullo sketch body.svg ear.svg ear.svg -o dog.3mf --place 0,0,0 --place -15,0,50 --place 15,0,50 --blend\n  \
        trullo sketch vase.svg -o vase.stl --as revolve --preview vase.png")]
    Sketch(SketchArgs),
    /// Write a mesh in another format.
    ///
    /// The format follows from the name: .stl, .obj, .ply or .3mf. A scene is meshed first. Writing .trullo
    /// takes the scene out of a 3MF file that Trullo made.
    #[command(after_help = "Example: trullo convert bunny.stl bunny.3mf --height 60")]
    Convert(ConvertArgs),
    /// Draw a shaded picture of a scene or mesh.
    #[command(
        after_help = "Example: trullo render snowman.trullo -o snowman.png --view front --size 800x600"
    )]
    Render(RenderArgs),
    /// Say whether a shape prints without supports, and what it measures.
    ///
    /// Looks whether the mesh is the boundary of a solid, slices it, and looks in every layer for places that hang in
    /// the air and for islands; then for steep facets, closed voids, thin walls, and whether it stands. A scene is
    /// meshed first. A certificate in a 3MF file is put to the test. Exit code 1 if something is wrong.
    #[command(
        after_help = "Example: trullo check bunny.stl --height 60 --layer-height 0.2 --max-overhang 50 --picture bunny.png"
    )]
    Check(CheckArgs),
    /// Draw the layers of a shape as they are printed.
    ///
    /// Every layer is cut in the middle of its height. The output is one SVG file with a group for each layer, or a
    /// new folder with a file for each layer.
    #[command(after_help = "Example: trullo slice bunny.stl -o layers --as png --pixel 0.05")]
    Slice(SliceArgs),
}

impl Verb {
    /// The options that every verb has.
    pub fn common(&self) -> Common {
        match self {
            Self::Eval(a) => a.common,
            Self::Tree(a) => a.common,
            Self::Mesh(a) => a.common,
            Self::SupportFree(a) => a.common,
            Self::Sketch(a) => a.common,
            Self::Convert(a) => a.common,
            Self::Render(a) => a.common,
            Self::Check(a) => a.common,
            Self::Slice(a) => a.common,
        }
    }
}
