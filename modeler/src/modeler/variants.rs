//! States of the document side by side.

use super::Modeler;
use crate::variants::Vary;
use blobtree::NodeRef;

impl Modeler {
    /// Does something to variants, and tells the user if it cannot be done.
    pub fn vary(&mut self, vary: Vary) {
        if let Err(error) = self.bench.vary(vary) {
            self.notices.warn(error.to_string());
        }
        self.form = None;
        self.hovered = None;
    }

    /// The pictures of trees, as far as they are drawn.
    pub(crate) fn portraits(
        &mut self,
        roots: &[NodeRef],
        ctx: &egui::Context,
    ) -> Vec<Option<egui::TextureHandle>> {
        self.portraits.get(roots, ctx, &self.wake)
    }
}
