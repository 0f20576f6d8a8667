//! In which order definitions can be read: each after those that it uses.

use super::error::SceneProblem;
use super::locate::Step;
use super::read::Fault;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The names of all definitions, each after those that it uses. Names that are not defined are passed over.
///
/// Errors: definitions that use each other in a circle. Cost: linear in the definitions.
pub(super) fn in_order(definitions: &Map<String, Value>) -> Result<Vec<String>, Fault> {
    let uses: BTreeMap<&str, Vec<&str>> = definitions
        .iter()
        .map(|(name, value)| {
            let mut used = uses(value);
            used.retain(|name| definitions.contains_key(*name));
            (name.as_str(), used)
        })
        .collect();
    let mut states: BTreeMap<&str, State> = BTreeMap::new();
    let mut order = Vec::with_capacity(uses.len());
    for &start in uses.keys() {
        // Depth first without recursion: the names being read, each with how many of its uses were followed.
        let mut open = vec![(start, 0)];
        while let Some((name, followed)) = open.pop() {
            if states.get(name) == Some(&State::Done) {
                continue;
            }
            states.insert(name, State::Open);
            let Some(&next) = uses[name].get(followed) else {
                states.insert(name, State::Done);
                order.push(name.to_owned());
                continue;
            };
            open.push((name, followed + 1));
            match states.get(next) {
                None => open.push((next, 0)),
                Some(State::Done) => {}
                Some(State::Open) => return Err(circle(&open, next)),
            }
        }
    }
    Ok(order)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Open,
    Done,
}

fn circle(open: &[(&str, usize)], first: &str) -> Fault {
    let start = open.iter().position(|(name, _)| *name == first).unwrap_or(0);
    let mut names: Vec<String> =
        open[start..].iter().map(|(name, _)| super::error::shortened(name)).collect();
    if names.len() > 12 {
        names.truncate(12);
        names.push("…".into());
    }
    names.push(super::error::shortened(first));
    let steps = vec![Step::key("define"), Step::key(first)];
    Fault { steps, problem: SceneProblem::Cycle(names) }
}

/// Every name in a `use` field somewhere in `value`.
fn uses(value: &Value) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = vec![value];
    while let Some(value) = rest.pop() {
        match value {
            Value::Array(items) => rest.extend(items),
            Value::Object(map) => {
                found.extend(map.get("use").and_then(Value::as_str));
                rest.extend(map.values());
            }
            _ => {}
        }
    }
    found
}
