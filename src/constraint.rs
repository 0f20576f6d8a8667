//! Compiling scenes with their support-free nodes kept, or switched off.

use crate::cli::ConstraintArgs;
use crate::failure::Failure;
use crate::job::Job;
use blobtree::{BakeError, BakeStore, Node, NodeRef, Shape, SupportMode, Tree};
use printable::Rebaker;
use std::path::Path;

/// What is said of a shape whose support-free nodes are switched off.
pub const UNCONSTRAINED: &str = "without the support-free constraint, this shape may need supports";

/// Bakes the support-free nodes of a scene, unless they are to be left as drawn. Stage "constrain".
///
/// Errors: a node that cannot be baked.
pub fn bakes(path: &Path, root: &NodeRef, args: ConstraintArgs, job: &mut Job) -> Result<BakeStore, Failure> {
    let mut bakes = BakeStore::new();
    if args.no_constraint || !is_constrained(root) {
        return Ok(bakes);
    }
    job.stage("constrain", |watch| {
        let cancelled = || watch.cancel.is_cancelled();
        bakes.bake(root, &Rebaker::with_cancel(&cancelled)).map_err(|error| match error {
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
    let bakes = bakes(path, root, args, job)?;
    job.stage("compile", |_| Ok(bakes.compile(root)))
}

fn is_constrained(node: &Node) -> bool {
    let own = matches!(&node.shape, Shape::SupportFree(rule, _) if rule.mode != SupportMode::Off);
    node.is_heard() && (own || node.children().iter().any(|child| is_constrained(child)))
}
