//! The lowest point of what is selected, which comes to rest on the bed: found on a thread as soon as something is
//! selected, so that it is known when the hand takes hold of it.

use crate::extent;
use crate::newest::{Answering, Newest};
use blobtree::{NodePath, NodeRef};
use std::sync::Arc;

/// Some nodes of a tree.
#[derive(Clone, Debug)]
struct Asked {
    number: u64,
    root: NodeRef,
    nodes: Vec<NodePath>,
}

/// The lowest point of the selected nodes.
#[derive(Debug)]
pub struct Lowest {
    worker: Newest<Asked, (u64, Option<f32>)>,
    asked: Option<Asked>,
    number: u64,
    answered: u64,
    found: Option<f32>,
}

impl Lowest {
    /// Starts the thread; `wake` is called when there is an answer.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let worker = Newest::start("lowest", wake, |asked: Asked, answering: &Answering<_>| {
            let found = of(&asked.root, &asked.nodes, || answering.cancel.is_cancelled());
            answering.give((asked.number, found));
        })?;
        Ok(Self { worker, asked: None, number: 0, answered: 0, found: None })
    }

    /// These nodes are selected.
    pub fn follow(&mut self, root: &NodeRef, nodes: &[NodePath]) {
        if let Some((number, found)) = self.worker.answers().last() {
            (self.answered, self.found) = (number, found);
        }
        if nodes.is_empty() {
            self.asked = None;
        } else if !self.is_asked(root, nodes) {
            self.number += 1;
            let asked = Asked { number: self.number, root: root.clone(), nodes: nodes.to_vec() };
            self.worker.ask(asked.clone());
            self.asked = Some(asked);
        }
    }

    /// Its height, mm, if it is known and there is one.
    pub fn found(&self) -> Option<f32> {
        self.found.filter(|_| self.is_at_rest())
    }

    /// The height of the lowest point of these nodes, mm, if there is one; if it is not known yet, the frame waits for it.
    pub fn wait(&self, root: &NodeRef, nodes: &[NodePath]) -> Option<f32> {
        let is_known = self.is_asked(root, nodes) && self.is_at_rest();
        if is_known { self.found } else { of(root, nodes, || false) }
    }

    fn is_asked(&self, root: &NodeRef, nodes: &[NodePath]) -> bool {
        let same = |asked: &Asked| NodeRef::ptr_eq(&asked.root, root) && asked.nodes == nodes;
        self.asked.as_ref().is_some_and(same)
    }

    /// Whether it is known.
    pub fn is_at_rest(&self) -> bool {
        self.asked.as_ref().is_none_or(|asked| asked.number == self.answered)
    }
}

fn of(root: &NodeRef, nodes: &[NodePath], stops: impl Fn() -> bool) -> Option<f32> {
    let each = nodes.iter().take_while(|_| !stops());
    each.filter_map(|path| extent::lowest(root, path)).reduce(f32::min)
}
