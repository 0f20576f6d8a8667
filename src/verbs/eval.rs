//! `trullo eval`: the field at points.

use crate::cli::EvalArgs;
use crate::failure::Failure;
use crate::job::Job;
use crate::output::{Report, number, vector};
use crate::{constraint, input};
use blobtree::{Field, ISO, Node, Part, Sample, explain_in};
use glam::Vec3;
use serde_json::{Value, json};

/// Evaluates a scene.
///
/// Errors: a scene that cannot be read.
pub fn run(args: &EvalArgs, job: &mut Job) -> Result<Report, Failure> {
    let mut report = Report::default();
    let scene = input::open_scene(&args.scene, job)?;
    let tree = constraint::compile(&args.scene, &scene.root, args.constraint, job)?;
    if tree.unconstrained() > 0 {
        report.notices.push(constraint::UNCONSTRAINED.into());
    }
    let samples = job.stage("eval", |_| {
        let mut samples = vec![Sample::default(); args.at.len()];
        tree.sampler().samples(&args.at, &mut samples);
        Ok(samples)
    })?;
    let mut points = Vec::new();
    for (&at, sample) in args.at.iter().zip(&samples) {
        report.line(told(at, sample));
        let mut point = json!({
            "at": vector(at),
            "value": number(sample.value),
            "gradient": vector(sample.gradient),
            "inside": sample.value >= ISO,
        });
        if args.explain {
            let parts = job.stage("explain", |_| Ok(explain_in(&tree, &scene.root, at)))?;
            let nodes = parts.iter().filter_map(|part| Some((part, part.path.find(&scene.root)?)));
            nodes.clone().for_each(|(part, node)| report.line(told_part(part, node)));
            point["nodes"] = nodes.map(|(part, node)| listed(part, node)).collect();
        }
        points.push(point);
    }
    report.put("points", Value::Array(points));
    Ok(report)
}

/// One line for a node, further in the deeper it stands.
fn told_part(part: &Part, node: &Node) -> String {
    let indent = "  ".repeat(part.path.0.len() + 1);
    let name = node.name.as_ref().map_or(String::new(), |name| format!(" \"{name}\""));
    let decides = match part.share {
        _ if !part.heard => ", not heard".to_owned(),
        share if share > 0.0 => format!(", decides {:.0} %", 100.0 * share),
        _ => String::new(),
    };
    format!("{indent}{} {}{name}: value {}{decides}", part.path, node.type_name(), part.sample.value)
}

fn listed(part: &Part, node: &Node) -> Value {
    json!({
        "id": part.path.to_string(),
        "type": node.type_name(),
        "name": node.name,
        "value": number(part.sample.value),
        "gradient": vector(part.sample.gradient),
        "share": number(part.share),
        "decides": part.share > 0.0,
        "heard": part.heard,
    })
}

fn told(at: Vec3, sample: &Sample) -> String {
    let side = if sample.value >= ISO { "inside" } else { "outside" };
    let Vec3 { x, y, z } = sample.gradient;
    format!("{},{},{}: value {}, {side}, gradient {x},{y},{z} per mm", at.x, at.y, at.z, sample.value)
}
