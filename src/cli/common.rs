//! What several verbs take.

use super::values::{layer_height, length, overhang};
use clap::{Args, ValueEnum};
use printable::slices::Bottom;
use printable::{LayerHeight, OverhangAngle};

/// Most worker threads that can be asked for.
const MOST_THREADS: i64 = 1024;

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

/// How a shape is read from a mesh's or a scene's file.
#[derive(Debug, Args)]
pub struct ShapeArgs {
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
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
