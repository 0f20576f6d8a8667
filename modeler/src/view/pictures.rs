//! Pictures of the suggestions on their way to the screen.

use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use std::sync::Arc;

/// The pictures of one list of suggestions.
#[derive(Default)]
pub struct Pictures {
    version: u64,
    loaded: Vec<Option<TextureHandle>>,
}

impl Pictures {
    /// The picture of a suggestion of the list with this version, if it is drawn yet.
    pub fn get(
        &mut self,
        ctx: &Context,
        version: u64,
        suggestion: usize,
        image: Option<&Arc<ColorImage>>,
    ) -> Option<TextureHandle> {
        if self.version != version {
            (self.version, self.loaded) = (version, Vec::new());
        }
        if self.loaded.len() <= suggestion {
            self.loaded.resize(suggestion + 1, None);
        }
        let place = &mut self.loaded[suggestion];
        if let (None, Some(image)) = (&place, image) {
            *place = Some(ctx.load_texture("suggestion", image.clone(), TextureOptions::LINEAR));
        }
        place.clone()
    }
}
