//! Compiling scenes with their support-free nodes kept, or switched off.

use crate::cli::ConstraintArgs;
use crate::failure::Failure;
use crate::job::Job;
use blobtree::{BakeError, BakeStore, Node, NodeRef, Shape, SupportMode, Tree};
use polygonizer::CellSize;
use printable::Rebaker;
use std::path::Path;

/// What is said of a shape whose support-free nodes are switched off.
pub const UNCONSTRAINED: &str = "without the support-free constraint, this shape may need supports";

/// Bakes the support-free nodes of a scene, unless they are to be left as drawn; for a mesh in cells of this size, or
/// without that last look. Stage "constrain".
///
/// Errors: a node that cannot be baked.
pub fn bakes(
    path: &Path,
    root: &NodeRef,
    args: ConstraintArgs,
    cell: Option<CellSize>,
    job: &mut Job,
) -> Result<BakeStore, Failure> {
    let mut bakes = BakeStore::new();
    if args.no_constraint || finest_layer(root).is_none() {
        return Ok(bakes);
    }
    job.stage("constrain", |watch| {
        let quick = Rebaker::with_cancel(watch.cancel);
        let baker = cell.map_or(quick, |cell| quick.settling(cell));
        bakes.bake(root, &baker).map_err(|error| match error {
            BakeError::Cancelled => Failure::Interrupted,
            other => Failure::of(path, other),
        })?;
        Ok(bakes)
    })
}

/// Compiles a scene as [`bakes`] says. Stages "constrain" and "compile".
///
/// Errors: as [`bakes`].
pub fn compile(path: &Path, root: &NodeRef, args: ConstraintArgs, job: &mut Job) -> Result<Tree, Failure> {
    let bakes = bakes(path, root, args, None, job)?;
    job.stage("compile", |_| Ok(bakes.compile(root)))
}

/// The least layer height of support-free nodes that are heard and switched on, mm; none if there are none.
pub fn finest_layer(node: &Node) -> Option<f32> {
    if !node.is_heard() {
        return None;
    }
    let own = match &node.shape {
        Shape::SupportFree(rule, _) if rule.mode != SupportMode::Off => Some(rule.layer_height),
        _ => None,
    };
    let below = node.children().iter().filter_map(|child| finest_layer(child));
    own.into_iter().chain(below).min_by(f32::total_cmp)
}
