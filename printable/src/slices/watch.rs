//! Stopping long work and watching it.

use polygonizer::Cancel;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How to run long work; by default it cannot be stopped and reports nothing.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    /// Stops the work early.
    pub cancel: Option<&'a Cancel>,
    /// Called with the share of the work done, from 0 to 1, from any thread and not always in order.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl Watch<'_> {
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(Cancel::is_cancelled)
    }
}

/// Counts what is done of a known number of equal pieces.
pub(crate) struct Tally<'a> {
    watch: &'a Watch<'a>,
    done: AtomicUsize,
    pieces: usize,
}

impl<'a> Tally<'a> {
    pub(crate) fn new(watch: &'a Watch<'a>, pieces: usize) -> Self {
        Self { watch, done: AtomicUsize::new(0), pieces }
    }

    /// One piece more is done.
    pub(crate) fn step(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(progress) = self.watch.progress {
            progress(done as f32 / self.pieces.max(1) as f32);
        }
    }
}
