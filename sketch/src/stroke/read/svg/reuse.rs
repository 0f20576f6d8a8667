//! How large a picture becomes when its reused parts are written out.

use super::{MAX_DEPTH, MAX_NODES};
use crate::stroke::read::error::{ReadError, ReadProblem};
use std::collections::HashMap;
use usvg::roxmltree::{Document, Node, NodeId};

/// Deepest nesting of reused parts in reused parts.
const MAX_USES: usize = MAX_DEPTH;

/// Most questions whether a style rule is meant for an element: about a second's worth. Drawing programs write
/// hundreds of rules for tens of thousands of elements.
const MAX_STYLINGS: u64 = 5_000_000;

/// Errors: parts that reuse each other until there are more than [`MAX_NODES`] nodes, or too many style rules for
/// them. Each part may use another one twice, so that thirty in a row could stand for a billion shapes.
///
/// **Cost:** linear in the nodes that are written down. Needs stack for [`MAX_DEPTH`] · [`MAX_USES`] calls.
pub(super) fn check_reuse(document: &Document) -> Result<(), ReadError> {
    let named = document.descendants().filter_map(|node| Some((node.attribute("id")?, node)));
    let mut counts = Counts { named: named.collect(), known: HashMap::new() };
    let nodes = counts.of(document.root(), 0);
    if nodes > u64::from(MAX_NODES) {
        let problem = format!("its reused parts make more than {MAX_NODES} nodes");
        return Err(ReadProblem::Svg(problem).into());
    }
    let rules = style_rules(document);
    if rules.saturating_mul(nodes) > MAX_STYLINGS {
        let problem =
            format!("its {rules} style rules for {nodes} nodes are too many; write styles as attributes");
        return Err(ReadProblem::Svg(problem).into());
    }
    Ok(())
}

/// At least as many selectors as the picture's style sheets have.
fn style_rules(document: &Document) -> u64 {
    let sheets = document.descendants().filter(|node| node.tag_name().name() == "style");
    let texts = sheets.flat_map(|sheet| sheet.descendants()).filter_map(|node| node.text());
    texts.map(|text| text.bytes().filter(|byte| matches!(byte, b'{' | b',')).count() as u64).sum()
}

struct Counts<'a, 'i> {
    named: HashMap<&'a str, Node<'a, 'i>>,
    /// Of parts that are reused; `None` while they are being counted, so that circles end.
    known: HashMap<NodeId, Option<u64>>,
}

impl<'a, 'i> Counts<'a, 'i> {
    /// The nodes of an element, with what it reuses.
    fn of(&mut self, node: Node<'a, 'i>, uses: usize) -> u64 {
        let own = node.children().fold(1u64, |sum, child| sum.saturating_add(self.of(child, uses)));
        let links = node.attributes().filter(|attribute| attribute.name() == "href");
        let reused: Vec<&'a str> = links.filter_map(|link| link.value().trim().strip_prefix('#')).collect();
        reused.into_iter().fold(own, |sum, name| sum.saturating_add(self.reused(name, uses + 1)))
    }

    fn reused(&mut self, name: &str, uses: usize) -> u64 {
        let Some(&node) = self.named.get(name) else { return 0 };
        if uses > MAX_USES {
            return u64::MAX;
        }
        match self.known.get(&node.id()) {
            Some(known) => known.unwrap_or(0),
            None => {
                self.known.insert(node.id(), None);
                let count = self.of(node, uses);
                self.known.insert(node.id(), Some(count));
                count
            }
        }
    }
}
