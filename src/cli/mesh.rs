//! `trullo mesh`.

use super::values::length;
use super::{Common, ConstraintArgs, ResolutionArgs, RuleArgs};
use clap::Args;
use std::path::PathBuf;

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
