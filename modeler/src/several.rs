//! Commands on one or several parts at once, each one step of the history.
//!
//! Paths are sorted and none is below another one. Commands of a step are put in an order in which no one moves what
//! a later one names: the last parts come first.

use blobtree::{Command, NodePath, NodeRef, Operator, Shape};

/// Adds a part to those that are chosen, or takes it away if it is one of them. What is above or below it is no longer
/// chosen, because it would be moved twice.
pub fn toggle(paths: &mut Vec<NodePath>, path: NodePath) {
    if let Some(known) = paths.iter().position(|known| *known == path) {
        paths.remove(known);
        return;
    }
    paths.retain(|known| !known.0.starts_with(&path.0) && !path.0.starts_with(&known.0));
    let at = paths.partition_point(|known| *known < path);
    paths.insert(at, path);
}

/// One command as it is, several as one step, none as none.
pub fn together(commands: impl IntoIterator<Item = Command>) -> Option<Command> {
    let mut commands: Vec<Command> = commands.into_iter().collect();
    match commands.len() {
        0 | 1 => commands.pop(),
        _ => Some(Command::Together(commands)),
    }
}

/// The part that holds all of these: the parent of a single one. None above the root.
pub fn parent(paths: &[NodePath]) -> Option<NodePath> {
    let (first, rest) = paths.split_first()?;
    if rest.is_empty() {
        return first.parent();
    }
    let common = |length: usize| rest.iter().all(|path| path.0.get(..length) == first.0.get(..length));
    let length = (0..=first.0.len()).rev().find(|length| common(*length))?;
    Some(NodePath(first.0[..length].to_vec()))
}

/// What takes the parts away, with all below them and the warps that bend only them. None if that is all there is.
pub fn remove(root: &NodeRef, paths: &[NodePath]) -> Option<Command> {
    let mut paths = takeable(root, paths)?;
    paths.reverse();
    together(paths.into_iter().map(|path| Command::Remove { path }))
}

/// What puts a copy of each part beside it, and where the copies then are. None for parts that nothing can stand
/// beside.
pub fn duplicate(root: &NodeRef, paths: &[NodePath]) -> Option<(Command, Vec<NodePath>)> {
    beside(root, paths, |path| {
        let (parent, index) = (path.parent()?, *path.0.last()?);
        let is_operator = matches!(parent.find(root)?.shape, Shape::Operator(..));
        let node = path.find(root)?.clone();
        is_operator.then_some(Command::Insert { parent, index: index + 1, node })
    })
}

/// What does an [`Command::Insert`] beside each of the parts, and where that which is inserted then is.
pub fn beside(
    root: &NodeRef,
    paths: &[NodePath],
    insert: impl Fn(&NodePath) -> Option<Command>,
) -> Option<(Command, Vec<NodePath>)> {
    let (mut commands, mut places) = (Vec::new(), Vec::<NodePath>::new());
    for path in paths.iter().rev().filter(|path| path.find(root).is_some()) {
        let command = insert(path)?;
        let Command::Insert { parent, index, .. } = &command else { return None };
        for place in &mut places {
            shift(place, parent, *index);
        }
        places.push(parent.child(*index));
        commands.push(command);
    }
    places.reverse();
    Some((together(commands)?, places))
}

/// What moves the parts into an operator, in their order, in front of its child `index`, and where they then are; the
/// warps that bend only them come along. None if one of them is all there is.
pub fn moved(
    root: &NodeRef,
    paths: &[NodePath],
    mut parent: NodePath,
    mut index: usize,
) -> Option<(Command, Vec<NodePath>)> {
    let mut waiting = takeable(root, paths)?;
    let (mut commands, mut places) = (Vec::new(), Vec::<NodePath>::new());
    while !waiting.is_empty() {
        let from = waiting.remove(0);
        commands.push(Command::Move { from: from.clone(), parent: parent.clone(), index });
        let (&gone, old_parent) = from.0.split_last()?;
        index -= usize::from(parent.0 == old_parent && gone < index);
        close_up(&mut parent, &from);
        for path in waiting.iter_mut().chain(&mut places) {
            close_up(path, &from);
            shift(path, &parent, index);
        }
        places.push(parent.child(index));
        index += 1;
    }
    Some((together(commands)?, places))
}

/// Where a part is after another one was taken away.
fn close_up(path: &mut NodePath, gone: &NodePath) {
    let Some((&index, parent)) = gone.0.split_last() else { return };
    if path.0.starts_with(parent)
        && let Some(own) = path.0.get_mut(parent.len())
        && *own > index
    {
        *own -= 1;
    }
}

/// Where a part is after something was inserted.
fn shift(path: &mut NodePath, parent: &NodePath, index: usize) {
    if path.0.starts_with(&parent.0)
        && let Some(own) = path.0.get_mut(parent.0.len())
        && *own >= index
    {
        *own += 1;
    }
}

/// What puts the parts into a new operator in the place of the first one, and where that is. None for parts that
/// cannot be taken from where they are, or that other warps bend than the first.
pub fn group(root: &NodeRef, paths: &[NodePath], operator: Operator) -> Option<(Command, NodePath)> {
    let [only] = paths else { return group_several(root, paths, operator) };
    Some((Command::WrapInOperator { path: only.clone(), operator }, only.clone()))
}

fn group_several(root: &NodeRef, paths: &[NodePath], operator: Operator) -> Option<(Command, NodePath)> {
    let paths = takeable(root, paths)?;
    let (first, rest) = paths.split_first()?;
    let bent = |path: &NodePath| warps_above(root, path);
    if rest.iter().any(|path| bent(path) != bent(first)) {
        return None;
    }
    let wrap = Command::WrapInOperator { path: first.clone(), operator };
    let moved =
        rest.iter().rev().map(|path| Command::Move { from: path.clone(), parent: first.clone(), index: 1 });
    Some((together(std::iter::once(wrap).chain(moved))?, first.clone()))
}

/// Where the warps above a part stand.
fn warps_above(root: &NodeRef, path: &NodePath) -> Vec<NodePath> {
    let above = (0..path.0.len()).map(|length| NodePath(path.0[..length].to_vec()));
    let is_warp = |path: &NodePath| path.find(root).is_some_and(|node| matches!(node.shape, Shape::Warp(..)));
    above.filter(is_warp).collect()
}

/// The parts, each with the nodes above it that hold nothing else, so that they are children of operators; sorted,
/// none below another one. None if one of them is all there is.
fn takeable(root: &NodeRef, paths: &[NodePath]) -> Option<Vec<NodePath>> {
    let mut all = Vec::new();
    for path in paths {
        let mut path = path.clone();
        loop {
            let parent = path.parent()?;
            if matches!(parent.find(root)?.shape, Shape::Operator(..)) {
                break;
            }
            path = parent;
        }
        all.push(path);
    }
    all.sort();
    all.dedup();
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, point, union};
    use blobtree::{Document, Node, Scene};

    fn path(text: &str) -> NodePath {
        text.parse().expect("a path")
    }

    fn paths<const N: usize>(texts: [&str; N]) -> Vec<NodePath> {
        texts.into_iter().map(path).collect()
    }

    /// a, a moved b, and a group of c, d and e.
    fn root() -> NodeRef {
        let named = |name: &str| point([0., 0., 0.], 1.).named(name);
        union([named("a"), named("b").translate([1., 0., 0.]), union([named("c"), named("d"), named("e")])])
            .into()
    }

    /// The names of all parts after a command, operators as brackets.
    fn outline(node: &Node) -> String {
        match &node.name {
            Some(name) => name.clone(),
            None => {
                let below: Vec<String> = node.children().iter().map(|child| outline(child)).collect();
                format!("({})", below.join(" "))
            }
        }
    }

    fn after(command: Command) -> NodeRef {
        let mut document = Document::new(Scene::new(root())).expect("legal");
        document.apply(command).expect("it can be done");
        document.scene().root.clone()
    }

    #[test]
    fn what_is_above_or_below_a_chosen_part_is_not_chosen_with_it() {
        let mut chosen = Vec::new();
        for text in ["/2/1", "/0", "/2/0"] {
            toggle(&mut chosen, path(text));
        }
        assert_eq!(chosen, paths(["/0", "/2/0", "/2/1"]));
        assert_eq!(parent(&chosen), Some(path("/")));
        assert_eq!(parent(&chosen[1..]), Some(path("/2")));
        toggle(&mut chosen, path("/0"));
        toggle(&mut chosen, path("/2"));
        assert_eq!(chosen, paths(["/2"]));
        toggle(&mut chosen, path("/2/2"));
        assert_eq!(chosen, paths(["/2/2"]));
    }

    #[test]
    fn several_parts_are_removed_with_the_warps_that_bend_only_them() {
        let command = remove(&root(), &paths(["/0", "/1/0", "/2/0", "/2/2"])).expect("there is a rest");
        assert_eq!(outline(&after(command)), "((d))");
        assert_eq!(remove(&root(), &paths(["/"])), None);
    }

    #[test]
    fn copies_stand_beside_their_originals_and_are_where_it_is_said() {
        let (command, copies) = duplicate(&root(), &paths(["/0", "/2/0", "/2/1"])).expect("all can have one");
        let root = after(command);
        assert_eq!(outline(&root), "(a a (b) (c c d d e))");
        let names: Vec<String> =
            copies.iter().map(|path| outline(path.find(&root).expect("a copy"))).collect();
        assert_eq!(
            (copies, names),
            (paths(["/1", "/3/1", "/3/3"]), vec!["a".into(), "c".into(), "d".into()])
        );
    }

    #[test]
    fn parts_are_moved_in_their_order_with_what_bends_them_and_are_where_it_is_said() {
        let of = |root: &NodeRef, places: &[NodePath]| -> Vec<String> {
            places.iter().map(|path| outline(path.find(root).expect("a part"))).collect()
        };
        for (chosen, parent, index, expected, moved_parts) in [
            (vec!["/0", "/1/0"], "/2", 1, "((c a (b) d e))", vec!["a", "(b)"]),
            (vec!["/2/0", "/2/2"], "/", 1, "(a c e (b) (d))", vec!["c", "e"]),
            (vec!["/0", "/2/1", "/2/2"], "/2", 3, "((b) (c a d e))", vec!["a", "d", "e"]),
            (vec!["/2/0", "/2/1"], "/2", 3, "(a (b) (e c d))", vec!["c", "d"]),
            (vec!["/1/0"], "/", 0, "((b) a (c d e))", vec!["(b)"]),
        ] {
            let chosen: Vec<NodePath> = chosen.into_iter().map(path).collect();
            let (command, places) = moved(&root(), &chosen, path(parent), index).expect("they can move");
            let root = after(command);
            assert_eq!(
                (outline(&root).as_str(), of(&root, &places)),
                (expected, moved_parts.iter().map(|s| (*s).to_owned()).collect())
            );
        }
        assert_eq!(moved(&root(), &paths(["/"]), path("/2"), 0), None);
    }

    #[test]
    fn a_group_stands_where_its_first_part_stood_and_keeps_their_order() {
        let several = paths(["/0", "/1/0", "/2/1", "/2/2"]);
        let (command, place) = group(&root(), &several, Operator::Union).expect("nothing bends them");
        assert_eq!((outline(&after(command)), place), ("((a (b) d e) (c))".into(), path("/0")));
    }
}
