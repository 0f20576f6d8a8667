//! How the user likes to work, from one start to the next.

use super::Modeler;
use crate::kept::Kept;
use std::path::Path;

impl Modeler {
    /// Keeps settings and files in a folder from now on, and takes up those that are there.
    pub fn keep_in(&mut self, folder: &Path) {
        match Kept::open(folder, self.wake.clone()) {
            Ok((kept, settings)) => (self.kept, self.settings) = (kept, settings),
            Err(error) => self.notices.warn(format!("Settings cannot be kept: {error}")),
        }
    }

    /// Has everything look as the settings say. Keys may have changed the size; a hand that is changing it goes first.
    pub(super) fn dress(&mut self, ctx: &egui::Context) {
        let scale = ctx.zoom_factor();
        if (scale - self.dressed.1).abs() > 1e-3 {
            (self.settings.scale, self.dressed.1) = (scale, scale);
        }
        let wanted = (self.settings.theme, self.settings.scale);
        if wanted != self.dressed && !ctx.egui_is_using_pointer() {
            self.settings.dress(ctx);
            self.dressed = wanted;
        }
    }
}
