//! `trullo eval`.

use super::values::point;
use super::{Common, ConstraintArgs};
use clap::Args;
use glam::Vec3;
use std::path::PathBuf;

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
