//! `trullo sketch`.

use super::values::{contrast, coordinate, doodle, length, point, share};
use super::{Common, ResolutionArgs};
use clap::{Args, ValueEnum};
use glam::Vec3;
use sketch::stroke::DoodleChoice;
use std::path::PathBuf;

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
