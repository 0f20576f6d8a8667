//! `trullo check`.

use super::values::length;
use super::{Common, RuleArgs, ShapeArgs};
use clap::Args;
use std::path::PathBuf;

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
    pub shape: ShapeArgs,
    #[command(flatten)]
    pub common: Common,
}
