//! Small pictures of whole trees, drawn in the background when they are wanted.

use crate::camera::Camera;
use crate::newest::{Answering, Newest};
use crate::thumbnail;
use blobtree::NodeRef;
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use glam::Vec2;
use std::sync::Arc;

/// The size of a picture, pixels.
pub const SIZE: [usize; 2] = [96, 72];

/// Pictures of trees, for as long as somebody wants them.
#[derive(Default)]
pub struct Portraits {
    worker: Option<Newest<Vec<NodeRef>, (NodeRef, ColorImage)>>,
    drawn: Vec<(NodeRef, TextureHandle)>,
    asked: Vec<NodeRef>,
}

impl Portraits {
    /// The pictures of these trees as far as they are drawn; has the others drawn. `wake` is called for each that is.
    pub fn get(
        &mut self,
        roots: &[NodeRef],
        ctx: &Context,
        wake: &Arc<dyn Fn() + Send + Sync>,
    ) -> Vec<Option<TextureHandle>> {
        if self.worker.is_none() {
            // A system without a thread to spare has no pictures.
            self.worker = Newest::start("portraits", wake.clone(), draw).ok();
        }
        for (root, picture) in self.worker.iter().flat_map(Newest::answers) {
            self.drawn.push((root, ctx.load_texture("portrait", picture, TextureOptions::LINEAR)));
        }
        let is_among = |roots: &[NodeRef], root: &NodeRef| roots.iter().any(|one| NodeRef::ptr_eq(one, root));
        self.drawn.retain(|(root, _)| is_among(roots, root));
        let texture = |root: &NodeRef| {
            self.drawn
                .iter()
                .find(|(known, _)| NodeRef::ptr_eq(known, root))
                .map(|(_, texture)| texture.clone())
        };
        let found: Vec<_> = roots.iter().map(texture).collect();
        let missing: Vec<NodeRef> = roots
            .iter()
            .zip(&found)
            .filter(|(_, found)| found.is_none())
            .map(|(root, _)| root.clone())
            .collect();
        if missing.iter().any(|root| !is_among(&self.asked, root))
            && let Some(worker) = &self.worker
        {
            self.asked.clone_from(&missing);
            worker.ask(missing);
        }
        found
    }
}

fn draw(roots: Vec<NodeRef>, answering: &Answering<(NodeRef, ColorImage)>) {
    let view = Camera::default().view(Vec2::new(SIZE[0] as f32, SIZE[1] as f32));
    for root in roots {
        if let Some(picture) = thumbnail::picture(&root, &view, SIZE, &answering.cancel) {
            answering.give((root, picture));
        }
    }
}
