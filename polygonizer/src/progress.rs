//! Stopping long work, watching it, and bounding what it may take.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A switch that stops running work: keep one clone, hand the other to the work.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A token that nobody has used yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the work to stop; it does so within one brick, some tens of microseconds per thread.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How to run: all optional, see [`Options::default`].
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Stops the work early with [`crate::PolygonizeError::Cancelled`].
    pub cancel: Option<&'a Cancel>,
    /// Called with the share of the work done, from 0 to 1, from any thread and not always in order.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// Most triangles allowed, which bounds memory: about 40 bytes each while meshing, 18 in the mesh.
    pub max_triangles: usize,
}

impl Default for Options<'_> {
    /// Cannot be cancelled, reports nothing, and allows 2²⁵ triangles (33 million).
    fn default() -> Self {
        Self { cancel: None, progress: None, max_triangles: 1 << 25 }
    }
}

impl Options<'_> {
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(Cancel::is_cancelled)
    }

    pub(crate) fn report(&self, share: f32) {
        if let Some(progress) = self.progress {
            progress(share);
        }
    }
}
