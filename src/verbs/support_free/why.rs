//! `--why`: what was changed at a place, and for what reason.

use crate::failure::Failure;
use crate::job::Job;
use crate::output::{Report, number, vector};
use blobtree::{BakeError, BakeStore, Field, ISO, NodeRef, Tree};
use glam::Vec3;
use printable::{Cause, Change, Rebaker};
use serde_json::{Value, json};
use std::path::Path;

/// Tells why matter was taken away or added at each of these places, mm. Stage "why".
///
/// Errors: only [`Failure::Interrupted`], in fact; the shape was baked before.
pub fn tell(
    path: &Path,
    root: &NodeRef,
    bakes: &BakeStore,
    places: &[Vec3],
    job: &mut Job,
    report: &mut Report,
) -> Result<(), Failure> {
    if places.is_empty() {
        return Ok(());
    }
    let answers = job.stage("why", |watch| {
        let rebaker = Rebaker::with_cancel(watch.cancel);
        let answers = rebaker.why(root, bakes, places);
        answers.map_err(|error| match error {
            BakeError::Cancelled => Failure::Interrupted,
            other => Failure::of(path, other),
        })
    })?;
    let (drawn, made) = (Tree::new(root), bakes.compile(root));
    let mut listed = Vec::new();
    for (place, changes) in places.iter().zip(&answers) {
        let solid = made.value(*place) >= ISO;
        told(*place, changes, solid).iter().for_each(|line| report.line(line));
        listed.push(json!({
            "at": vector(*place),
            "drawn": drawn.value(*place) >= ISO,
            "solid": solid,
            "changes": changes.iter().map(as_json).collect::<Vec<_>>(),
        }));
    }
    report.put("why", Value::Array(listed));
    Ok(())
}

fn told(place: Vec3, changes: &[Change], solid: bool) -> Vec<String> {
    let [x, y, z] = place.to_array();
    if changes.is_empty() {
        let side = if solid { "solid" } else { "empty" };
        return vec![format!("{x},{y},{z}: nothing was changed here; {side}, as drawn")];
    }
    let line = |change: &Change| {
        let did = if change.added { "added" } else { "taken away" };
        let node = match change.node.0.is_empty() {
            true => String::new(),
            false => format!(" by the node {}", change.node),
        };
        format!("{x},{y},{z}: {did}{node}: {}", change.cause)
    };
    changes.iter().map(line).collect()
}

fn as_json(change: &Change) -> Value {
    let mut json = json!({
        "node": change.node.to_string(),
        "change": if change.added { "added" } else { "taken" },
        "cause": change.cause.name(),
        "told": change.cause.to_string(),
    });
    match &change.cause {
        Cause::Overhang { lean_degrees, underside, .. } => {
            json["lean_degrees"] = number(*lean_degrees);
            json["underside"] = vector(*underside);
        }
        Cause::Grown { holds } => json["holds"] = holds.map_or(Value::Null, vector),
        Cause::Stroke { number, brush, under_tip, .. } => {
            json["stroke"] = (number + 1).into();
            json["brush"] = brush.name().into();
            json["under_tip"] = (*under_tip).into();
        }
        _ => {}
    }
    json
}
