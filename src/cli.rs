//! The command line as the user writes it.

use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::Vec3;
use printable::slices::Bottom;
use printable::{LayerHeight, OverhangAngle};
use sketch::stroke::DoodleChoice;
use std::path::PathBuf;

/// Most pixels in a picture, which bounds memory: about 64 bytes each.
const MOST_PIXELS: u32 = 1 << 23;
/// Most worker threads that can be asked for.
const MOST_THREADS: i64 = 1024;

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

/// `trullo eval`.
#[derive(Debug, Args)]
pub struct EvalArgs {
    /// The scene file.
    pub scene: PathBuf,
    /// Where to evaluate, mm; can be given several times.
    #[arg(long, value_name = "X,Y,Z", required = true, allow_hyphen_values = true, value_parser = point)]
    pub at: Vec<Vec3>,
    /// Also list every node with its value, and whether it decided the result.
    #[arg(long)]
    pub explain: bool,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo tree`.
#[derive(Debug, Args)]
pub struct TreeArgs {
    /// The scene file.
    pub scene: PathBuf,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo mesh`.
#[derive(Debug, Args)]
pub struct MeshArgs {
    /// The scene file.
    pub scene: PathBuf,
    /// The mesh file to write: .stl, .obj, .ply or .3mf. A 3MF file carries the scene along.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    /// Leave out triangles while the surface moves by no more than this, mm.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub simplify: Option<f64>,
    /// Check that the mesh prints without supports, and say so in the file, which must be .3mf. If it does not, it is
    /// written without, and the exit code is 1.
    #[arg(long)]
    pub certify: bool,
    #[command(flatten)]
    pub rule: RuleArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo support-free`.
#[derive(Debug, Args)]
pub struct SupportFreeArgs {
    /// The scene or mesh.
    pub input: PathBuf,
    /// The scene to write, a .trullo file, or a mesh: .stl, .obj, .ply or .3mf.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// What happens where supports would be needed.
    #[arg(long, value_name = "OPERATOR", value_enum, default_value_t)]
    pub operator: SupportOperator,
    /// Height of a layer, mm: 0.02 to 2.
    #[arg(long, value_name = "MM", default_value_t = 0.25)]
    pub layer_height: f32,
    /// The largest overhang that prints, degrees from the vertical: 20 to 70.
    #[arg(long, value_name = "DEGREES", default_value_t = 45.0)]
    pub max_overhang: f32,
    /// Scale a mesh to this height, mm.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub height: Option<f64>,
    /// Lift or lower a mesh so that its lowest point lies on the bed.
    #[arg(long)]
    pub drop: bool,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub common: Common,
}

/// What happens where supports would be needed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SupportOperator {
    /// What the layer below cannot carry is taken away.
    #[default]
    Trim,
    /// Matter grows below it.
    Grow,
}

impl SupportOperator {
    /// As in `--operator`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trim => "trim",
            Self::Grow => "grow",
        }
    }
}

impl From<SupportOperator> for blobtree::SupportMode {
    fn from(operator: SupportOperator) -> Self {
        match operator {
            SupportOperator::Trim => Self::Trim,
            SupportOperator::Grow => Self::Grow,
        }
    }
}

/// `trullo sketch`.
#[derive(Debug, Args)]
pub struct SketchArgs {
    /// The drawings: .svg, .ndjson or .json files.
    #[arg(required = true, value_name = "DRAWING")]
    pub drawings: Vec<PathBuf>,
    /// The scene to write, a .trullo file, or a mesh: .stl, .obj, .ply or .3mf.
    #[arg(short, long, value_name = "OUT", required_unless_present_any = ["preview", "field"])]
    pub output: Option<PathBuf>,
    /// A picture to write, a .png file: the strokes in blue, the curves made of them in black.
    #[arg(long, value_name = "OUT.png")]
    pub preview: Option<PathBuf>,
    /// A picture to write, a .png file: the first solid's field in the plane of its drawing, with a line at every
    /// tenth and a bold one on the surface.
    #[arg(long, value_name = "OUT.png")]
    pub field: Option<PathBuf>,
    /// What becomes of the drawings; once for all, or once for each.
    #[arg(long = "as", value_name = "KIND", value_enum)]
    pub kinds: Vec<SolidKind>,
    /// Where a drawing's lowest edge stands, mm; once for each drawing. Without it, they stand in a row.
    #[arg(long = "place", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    pub places: Vec<Vec3>,
    /// The larger side of each drawing, mm.
    #[arg(long, value_name = "MM", default_value = "60", value_parser = length)]
    pub size: f64,
    /// How thick the solid is, mm: as thick as it is wide if not given.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub thickness: Option<f64>,
    /// How much thinner an inflation's thin parts are, 0 to 0.9.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = contrast)]
    pub contrast: f32,
    /// How much of an inflation's thickness follows the pen's pressure, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    pub pressure: f32,
    /// Round the edges of a sweep with this radius, mm.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub fillet: Option<f64>,
    /// How far to the right of the drawing's middle the axis of a revolution stands, mm: in the middle if not
    /// given.
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = coordinate)]
    pub axis: Option<f64>,
    /// How far the solids reach to blend with others, mm: 1.2 times their depth if not given.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub falloff: Option<f64>,
    /// Fill the holes that closed lines inside an outline make.
    #[arg(long)]
    pub fill_holes: bool,
    /// Let the solids flow into each other.
    #[arg(long)]
    pub blend: bool,
    /// Which doodle of an .ndjson file: its line, counted from 1, or its `key_id` [default: 1].
    #[arg(long, value_name = "LINE|KEY", value_parser = doodle)]
    pub doodle: Option<DoodleChoice>,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub common: Common,
}

/// What a drawing becomes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SolidKind {
    /// Inflated if it has an outline, else a tube.
    #[default]
    Auto,
    /// Blown up like a balloon.
    Inflate,
    /// Thick like a biscuit, with flat sides.
    Sweep,
    /// Turned round like a vase.
    Revolve,
    /// Tubes along the lines.
    Line,
}

impl SolidKind {
    /// As in `--as`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Inflate => "inflate",
            Self::Sweep => "sweep",
            Self::Revolve => "revolve",
            Self::Line => "line",
        }
    }
}

/// `trullo convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The mesh or scene to read.
    pub input: PathBuf,
    /// The file to write: .stl, .obj, .ply, .3mf or .trullo.
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene or mesh to draw.
    pub input: PathBuf,
    /// The picture to write, a .png file.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    /// From where to look: `iso`, `front`, `back`, `left`, `right`, `top`, `bottom`, or AZIMUTH,ELEVATION in
    /// degrees, where 0,0 is the front and 90,0 the right.
    #[arg(long, default_value = "iso", allow_hyphen_values = true, value_parser = crate::render::View::parse)]
    pub view: crate::render::View,
    /// The size of the picture in pixels, each side 16 to 4096, at most 8 million in all.
    #[arg(long, value_name = "WxH", default_value = "1200x900", value_parser = picture_size)]
    pub size: [u32; 2],
    /// The colour behind everything, `#rrggbb`; a soft grey if not given.
    #[arg(long, value_name = "COLOUR", value_parser = color)]
    pub background: Option<blobtree::Color>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The mesh or scene to check.
    pub input: PathBuf,
    #[command(flatten)]
    pub rule: RuleArgs,
    /// Tell walls thinner than this, mm.
    #[arg(long, value_name = "MM", default_value = "0.4", value_parser = length)]
    pub thin_wall: f64,
    /// A picture to write, a .png file, that shows the shape from below: what leans out too far in orange to red,
    /// what comes close in blue.
    #[arg(long, value_name = "OUT.png")]
    pub picture: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// `trullo slice`.
#[derive(Debug, Args)]
pub struct SliceArgs {
    /// The mesh or scene to slice.
    pub input: PathBuf,
    /// The .svg file or the folder to write. A folder must be new or empty.
    #[arg(short, long, value_name = "DIR|FILE.svg")]
    pub output: PathBuf,
    /// Height of a layer, mm.
    #[arg(long, value_name = "MM", default_value = "0.25", value_parser = layer_height)]
    pub layer_height: LayerHeight,
    /// Where the first layer begins.
    #[arg(long, value_enum, default_value_t)]
    pub bed: Bed,
    /// What the files in a folder are.
    #[arg(long = "as", value_name = "KIND", value_enum, default_value_t)]
    pub kind: LayerKind,
    /// How wide a pixel of a PNG file is, mm.
    #[arg(long, value_name = "MM", default_value = "0.1", value_parser = length)]
    pub pixel: f64,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}

/// What the files of layers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LayerKind {
    /// Outlines in mm.
    #[default]
    Svg,
    /// Pictures, white where the layer is solid.
    Png,
}

/// Where the bed is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Bed {
    /// Under the lowest point of the shape.
    #[default]
    Lowest,
    /// At z = 0: what begins above it floats, what is below it is not printed.
    Zero,
}

impl From<Bed> for Bottom {
    fn from(bed: Bed) -> Self {
        match bed {
            Bed::Lowest => Self::LowestPoint,
            Bed::Zero => Self::Bed,
        }
    }
}

/// What a printer can make without supports.
#[derive(Clone, Copy, Debug, Args)]
pub struct RuleArgs {
    /// Height of a layer, mm: 0.02 to 2 [default: that of the file's certificate, else 0.25].
    #[arg(long, value_name = "MM", value_parser = layer_height)]
    pub layer_height: Option<LayerHeight>,
    /// Largest overhang that prints without supports, degrees from the vertical: 20 to 70 [default: that of the
    /// file's certificate, else 45].
    #[arg(long, value_name = "DEG", value_parser = overhang)]
    pub max_overhang: Option<OverhangAngle>,
    /// Where the first layer begins [default: as in the file's certificate, else lowest].
    #[arg(long, value_enum)]
    pub bed: Option<Bed>,
}

/// How meshes are read.
#[derive(Debug, Args)]
pub struct ReadingArgs {
    /// Scale the mesh to this height, mm.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub height: Option<f64>,
}

/// Whether support-free nodes are kept.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct ConstraintArgs {
    /// Take the shape as it was drawn, even where it would need supports.
    #[arg(long)]
    pub no_constraint: bool,
}

/// How finely scenes are meshed.
#[derive(Clone, Copy, Debug, Args)]
pub struct ResolutionArgs {
    /// How wide a cell is, mm: details smaller than that can get lost.
    #[arg(long, value_name = "MM", conflicts_with = "cells", value_parser = length)]
    pub cell: Option<f64>,
    /// How many cells fit along the longest side of the shape [default: 128].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65536))]
    pub cells: Option<u32>,
}

/// What every verb takes.
#[derive(Clone, Copy, Debug, Args)]
pub struct Common {
    /// Write the result as JSON, for programs.
    #[arg(long)]
    pub json: bool,
    /// Also say where the time went, in milliseconds.
    #[arg(long)]
    pub timings: bool,
    /// How many threads work [default: one for each processor]. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    pub threads: Option<u16>,
    /// Write nothing but errors and what was asked for.
    #[arg(short, long)]
    pub quiet: bool,
    /// Do the work this often; the timings are the medians.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub repeat: u32,
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

/// Three finite numbers with commas between.
fn point(text: &str) -> Result<Vec3, String> {
    let wrong = || "a point is three numbers with commas between, such as 0,-2.5,10".to_owned();
    let numbers: Vec<f32> =
        text.split(',').map(|n| n.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
    let p = Vec3::from_array(numbers.try_into().map_err(|_| wrong())?);
    if p.is_finite() { Ok(p) } else { Err(wrong()) }
}

/// A length that a shape can have.
fn length(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|mm| (1e-4..=1e6).contains(mm));
    legal.ok_or_else(|| "a length is a number of millimetres from 0.0001 to 1000000".to_owned())
}

/// A coordinate that a shape can have.
fn coordinate(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|mm: &f64| mm.abs() <= 1e5);
    legal.ok_or_else(|| "a coordinate is a number of millimetres from -100000 to 100000".to_owned())
}

fn layer_height(text: &str) -> Result<LayerHeight, String> {
    let mm = text.parse().map_err(|_| "a layer height is a number of millimetres, such as 0.2".to_owned())?;
    LayerHeight::from_mm(mm).map_err(|e| e.to_string())
}

fn overhang(text: &str) -> Result<OverhangAngle, String> {
    let degrees = text.parse().map_err(|_| "an overhang is a number of degrees, such as 45".to_owned())?;
    OverhangAngle::from_degrees(degrees).map_err(|e| e.to_string())
}

fn share(text: &str) -> Result<f32, String> {
    let legal = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    legal.ok_or_else(|| "a share is a number from 0 to 1".to_owned())
}

fn contrast(text: &str) -> Result<f32, String> {
    share(text)
        .ok()
        .filter(|&share| share <= 0.9)
        .ok_or_else(|| "a contrast is a number from 0 to 0.9".to_owned())
}

/// Lines are counted from 1; what is too large for a line is a key.
fn doodle(text: &str) -> Result<DoodleChoice, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("lines are counted from 1".to_owned()),
        Ok(line) if line < 1_000_000 => Ok(DoodleChoice::Index(line - 1)),
        _ => Ok(DoodleChoice::Key(text.to_owned())),
    }
}

/// Width and height of a picture.
fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let legal = sides.filter(|sides| sides.iter().all(|side| (16..=4096).contains(side)));
    legal.filter(|[width, height]| width * height <= MOST_PIXELS).ok_or_else(|| {
        "a size is WIDTHxHEIGHT in pixels, such as 1200x900: each 16 to 4096, and no more than 8 million in all"
            .to_owned()
    })
}

fn color(text: &str) -> Result<blobtree::Color, String> {
    text.parse().map_err(|e: blobtree::ColorError| e.to_string())
}
