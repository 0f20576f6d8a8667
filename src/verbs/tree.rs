//! `trullo tree`: the nodes of a scene.

use crate::cli::TreeArgs;
use crate::failure::Failure;
use crate::job::Job;
use crate::output::{Report, aabb, counted, short};
use crate::{constraint, input};
use blobtree::{Aabb, NodePath, NodeRef, solid_box};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Most nodes that are listed: a scene can share one node in a million places.
const MOST_LISTED: usize = 20_000;

/// A node where it stands.
struct Place<'a> {
    path: NodePath,
    node: &'a NodeRef,
}

/// Lists a scene's nodes.
///
/// Errors: a scene that cannot be read.
pub fn run(args: &TreeArgs, job: &mut Job) -> Result<Report, Failure> {
    let scene = input::open_scene(&args.scene, job)?;
    let bakes = constraint::bakes(&args.scene, &scene.root, args.constraint, None, job)?;
    let (places, boxes) = job.stage("measure", |watch| {
        let mut places = Vec::new();
        collect(&scene.root, NodePath::default(), &mut places);
        let measured = places.par_iter().map(|place| {
            watch.go_on()?;
            Ok(place
                .path
                .find_alone(&scene.root)
                .map_or(Aabb::EMPTY, |alone| solid_box(&bakes.compile(&alone))))
        });
        let boxes = measured.collect::<Result<Vec<Aabb>, Failure>>()?;
        Ok((places, boxes))
    })?;
    let mut report = Report::default();
    if let Some(title) = &scene.title {
        report.line(title);
    }
    places.iter().zip(&boxes).for_each(|(place, solid)| report.line(told(place, solid)));
    if places.len() == MOST_LISTED {
        report.notices.push(format!("only the first {} are listed", counted(MOST_LISTED, "node")));
    }
    report.put("title", scene.title.clone());
    report.put("nodes", places.iter().zip(&boxes).map(|(p, b)| listed(p, b)).collect::<Vec<_>>());
    Ok(report)
}

/// Parents before children, children in order.
fn collect<'a>(node: &'a NodeRef, path: NodePath, places: &mut Vec<Place<'a>>) {
    if places.len() == MOST_LISTED {
        return;
    }
    places.push(Place { path: path.clone(), node });
    for (index, child) in node.children().iter().enumerate() {
        collect(child, path.child(index), places);
    }
}

/// `/0/2  sphere "head"  #ffffff  10 × 10 × 10 mm around 0, 0, 5`.
fn told(place: &Place, solid: &Aabb) -> String {
    let node = place.node;
    let indent = "  ".repeat(place.path.0.len());
    let mut line = format!("{indent}{} {}", place.path, node.type_name());
    if let Some(name) = &node.name {
        line += &format!(" \"{name}\"");
    }
    if let Some(color) = &node.color {
        line += &format!(" {color}");
    }
    line += if node.muted { " (muted)" } else { "" };
    line += if node.construction { " (construction)" } else { "" };
    if solid.is_empty() {
        return line + ": no solid";
    }
    let [size, center] = [solid.size(), solid.center()].map(|v| v.to_array().map(short));
    line + &format!(": {} mm around {}", size.join(" × "), center.join(", "))
}

fn listed(place: &Place, solid: &Aabb) -> Value {
    let node = place.node;
    json!({
        "id": place.path.to_string(),
        "type": node.type_name(),
        "name": node.name,
        "color": node.color.map(|c| c.to_string()),
        "muted": node.muted,
        "construction": node.construction,
        "children": node.children().len(),
        "box": aabb(solid),
    })
}
