//! `trullo convert`.

use super::{Common, ShapeArgs};
use clap::Args;
use std::path::PathBuf;

/// `trullo convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The mesh or scene to read.
    pub input: PathBuf,
    /// The file to write: .stl, .obj, .ply, .3mf or .trullo.
    pub output: PathBuf,
    #[command(flatten)]
    pub shape: ShapeArgs,
    #[command(flatten)]
    pub common: Common,
}
