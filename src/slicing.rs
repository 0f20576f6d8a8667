//! Slicing and checking, as stages of a job.

use crate::failure::Failure;
use crate::job::Job;
use mesh::Mesh;
use printable::LayerHeight;
use printable::check::{CheckSettings, PrintCheck};
use printable::slices::{Bottom, SliceError, Slices, Watch};

/// Slices a mesh. Stage "slice".
///
/// Errors: [`Failure::Interrupted`]. What else keeps a mesh from being sliced is the inner result's.
pub fn slice(
    mesh: &Mesh,
    height: LayerHeight,
    bottom: Bottom,
    job: &mut Job,
) -> Result<Result<Slices, SliceError>, Failure> {
    job.stage("slice", |watch| {
        let progress = |share| watch.report(share);
        let watch = Watch { cancel: Some(watch.cancel), progress: Some(&progress) };
        unless_stopped(Slices::new(mesh, height, bottom, &watch))
    })
}

/// Slices a mesh and checks whether it prints. Stages "slice" and "judge".
///
/// Errors: as [`slice()`].
pub fn check(
    mesh: &Mesh,
    settings: &CheckSettings,
    job: &mut Job,
) -> Result<Result<PrintCheck, SliceError>, Failure> {
    let slices = match slice(mesh, settings.rule.layer_height, settings.bottom, job)? {
        Ok(slices) => slices,
        Err(error) => return Ok(Err(error)),
    };
    job.stage("judge", |watch| {
        let progress = |share| watch.report(share);
        let watch = Watch { cancel: Some(watch.cancel), progress: Some(&progress) };
        unless_stopped(PrintCheck::new(mesh, &slices, settings, &watch))
    })
}

fn unless_stopped<T>(result: Result<T, SliceError>) -> Result<Result<T, SliceError>, Failure> {
    match result {
        Err(SliceError::Cancelled) => Err(Failure::Interrupted),
        other => Ok(other),
    }
}
