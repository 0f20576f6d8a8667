//! `trullo tree`: the nodes of a scene.

use crate::cli::TreeArgs;
use crate::failure::Failure;
use crate::input;
use crate::job::Job;
use crate::output::{Report, aabb, counted, number};
use blobtree::{Field, Node, NodePath, NodeRef, Tree, Warp};
use serde_json::{Value, json};

/// Lists a scene's nodes.
///
/// Errors: a scene that cannot be read.
pub fn run(args: &TreeArgs, job: &mut Job) -> Result<Report, Failure> {
    let scene = input::open_scene(&args.scene, job)?;
    let mut report = Report::default();
    Ok(report)
}
