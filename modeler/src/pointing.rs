//! Which part the pointer is over in the view: found on a thread, because a frame must not wait for it.

use crate::newest::{Answering, Newest};
use crate::view::meant;
use blobtree::{NodePath, NodeRef, Tree, pick};
use glam::Vec3;
use std::sync::Arc;

/// A ray into a model.
#[derive(Clone, Debug)]
struct Asked {
    number: u64,
    root: NodeRef,
    origin: Vec3,
    direction: Vec3,
}

/// What is under the pointer.
#[derive(Debug)]
pub struct Pointing {
    worker: Newest<Asked, (u64, Option<NodePath>)>,
    asked: Option<Asked>,
    number: u64,
    answered: u64,
    found: Option<NodePath>,
}

impl Pointing {
    /// Starts the thread; `wake` is called when there is an answer.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let mut compiled: Option<(NodeRef, Tree)> = None;
        let look = move |asked: Asked, answering: &Answering<_>| {
            let (root, tree) = match compiled.take().filter(|(root, _)| NodeRef::ptr_eq(root, &asked.root)) {
                Some(known) => compiled.insert(known),
                None => compiled.insert((asked.root.clone(), Tree::new(&asked.root))),
            };
            let found = pick(root, tree, asked.origin, asked.direction);
            let path = found.and_then(|found| Some(meant(root, &found.contributors.first()?.0)));
            answering.give((asked.number, path));
        };
        let worker = Newest::start("pointing", wake, look)?;
        Ok(Self { worker, asked: None, number: 0, answered: 0, found: None })
    }

    /// The pointer is on this ray; none if it is elsewhere or has something else to do.
    pub fn at(&mut self, root: &NodeRef, ray: Option<(Vec3, Vec3)>) {
        let Some((origin, direction)) = ray else {
            (self.asked, self.found) = (None, None);
            return;
        };
        let same = |asked: &Asked| {
            NodeRef::ptr_eq(&asked.root, root) && (asked.origin, asked.direction) == (origin, direction)
        };
        if !self.asked.as_ref().is_some_and(same) {
            self.number += 1;
            let asked = Asked { number: self.number, root: root.clone(), origin, direction };
            self.worker.ask(asked.clone());
            self.asked = Some(asked);
        }
    }

    /// Takes in what was found since the last look.
    pub fn hear(&mut self) {
        if let Some((number, found)) = self.worker.answers().last() {
            self.answered = number;
            self.found = found.filter(|_| self.asked.is_some());
        }
    }

    /// The part under the pointer, if that is known.
    pub fn found(&self) -> Option<&NodePath> {
        self.found.as_ref()
    }

    /// Whether it is known what is under the pointer.
    pub fn is_at_rest(&self) -> bool {
        self.asked.as_ref().is_none_or(|asked| asked.number == self.answered)
    }
}
