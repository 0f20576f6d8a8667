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

/// A tree and its picture; none if nothing is to be seen of it.
type Drawn = (NodeRef, Option<ColorImage>);

/// Pictures of trees, for as long as somebody wants them.
#[derive(Default)]
pub struct Portraits {
    worker: Option<Newest<Vec<NodeRef>, Drawn>>,
    /// None of trees of which nothing is to be seen.
    drawn: Vec<(NodeRef, Option<TextureHandle>)>,
    asked: Vec<NodeRef>,
}

fn is_among(roots: &[NodeRef], root: &NodeRef) -> bool {
    roots.iter().any(|one| NodeRef::ptr_eq(one, root))
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
            let load = |picture| ctx.load_texture("portrait", picture, TextureOptions::LINEAR);
            // It may be wanted again after it was forgotten.
            self.asked.retain(|asked| !NodeRef::ptr_eq(asked, &root));
            self.drawn.push((root, picture.map(load)));
        }
        self.drawn.retain(|(root, _)| is_among(roots, root));
        let is_drawn = |root: &NodeRef| self.drawn.iter().any(|(known, _)| NodeRef::ptr_eq(known, root));
        let missing: Vec<NodeRef> = roots.iter().filter(|root| !is_drawn(root)).cloned().collect();
        if missing.iter().any(|root| !is_among(&self.asked, root))
            && let Some(worker) = &self.worker
        {
            self.asked.clone_from(&missing);
            worker.ask(missing);
        }
        roots.iter().map(|root| self.of(root).cloned()).collect()
    }

    /// The picture of a tree, if it is wanted, drawn, and there is something to be seen.
    pub fn of(&self, root: &NodeRef) -> Option<&TextureHandle> {
        let known = self.drawn.iter().find(|(known, _)| NodeRef::ptr_eq(known, root));
        known.and_then(|(_, texture)| texture.as_ref())
    }

    /// Whether all of these are drawn.
    pub fn has(&self, roots: &[NodeRef]) -> bool {
        roots.iter().all(|root| self.drawn.iter().any(|(known, _)| NodeRef::ptr_eq(known, root)))
    }
}

fn draw(roots: Vec<NodeRef>, answering: &Answering<Drawn>) {
    let view = Camera::default().view(Vec2::new(SIZE[0] as f32, SIZE[1] as f32));
    for root in roots {
        let picture = thumbnail::picture(&root, &view, SIZE, &answering.cancel);
        answering.give((root, picture));
    }
}
