//! `trullo eval`: the field at points.

use crate::cli::EvalArgs;
use crate::failure::Failure;
use crate::input;
use crate::job::Job;
use crate::output::{Report, number, vector};
use blobtree::{Field, ISO, Sample, Tree};
use glam::Vec3;
use serde_json::{Value, json};

/// Evaluates a scene.
///
/// Errors: a scene that cannot be read.
pub fn run(args: &EvalArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let scene = input::open_scene(&args.scene, job)?;
    let tree = job.stage("compile", |_| Ok(Tree::new(&scene.root)))?;
    let samples = job.stage("eval", |_| {
        let mut samples = vec![Sample::default(); args.at.len()];
        tree.sampler().samples(&args.at, &mut samples);
        Ok(samples)
    })?;
    let mut points = Vec::new();
    for (&at, sample) in args.at.iter().zip(&samples) {
        report.line(told(at, sample));
        points.push(json!({
            "at": vector(at),
            "value": number(sample.value),
            "gradient": vector(sample.gradient),
            "inside": sample.value >= ISO,
        }));
    }
    report.put("points", Value::Array(points));
    Ok(report)
}

fn told(at: Vec3, sample: &Sample) -> String {
    let side = if sample.value >= ISO { "inside" } else { "outside" };
    let Vec3 { x, y, z } = sample.gradient;
    format!("{},{},{}: value {}, {side}, gradient {x},{y},{z} per mm", at.x, at.y, at.z, sample.value)
}
