//! `trullo tree`.

use super::{Common, ConstraintArgs};
use clap::Args;
use std::path::PathBuf;

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
