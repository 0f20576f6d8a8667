//! Where places are seen through a warp.

use super::places::{Cloud, Places, ROW, Row};
use super::sampler::TreeSampler;

impl TreeSampler<'_> {
    /// The places in the space of the child of this warp. The cloud goes back to the scratch memory when done.
    pub(crate) fn warped_cloud<P: Places>(&mut self, warp: u32, places: &P) -> Cloud {
        let warp = &self.tree.warps[warp as usize];
        let mut cloud = self.scratch.take_cloud(places.rows());
        for r in 0..places.rows() {
            let row = places.row(r);
            for i in 0..ROW {
                cloud.set(r, i, warp.child_from_parent(row.place(i)).place);
            }
        }
        cloud
    }
}
