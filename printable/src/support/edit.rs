//! Changes in a part of the grid, kept supported: one sweep upwards over what they can reach.

use super::carry::Carrier;
use super::{Changes, Element};
use crate::VoxelGrid;
use crate::voxels::{Bits, Block, Rows, for_width};
use std::ops::Range;

/// What is to be added and removed.
pub(crate) struct Edit<'a> {
    pub add: Option<&'a Bits>,
    pub remove: Option<&'a Bits>,
    /// Of what is added.
    pub material: u8,
}

/// Does an edit from the bed upwards. Of `add`, only what the layer below carries is let in. Where removing took
/// away what carried something, that is removed as well, and so on upwards.
///
/// **Promises:** no voxel is added outside `add`; none is removed but those of `remove` and those that had lost
/// something that carried them. A grid without unsupported voxels has none afterwards.
/// **Cost:** proportional to the rows of the edit and of what loses its support.
pub(crate) fn apply(grid: &mut VoxelGrid, element: &Element, edit: &Edit, changes: &mut Changes) {
    for_width!(grid.solid.words, W => Sweep::<W>::new(grid, element, changes).run(edit));
}

/// An upward sweep.
struct Sweep<'a, const W: usize> {
    grid: &'a mut VoxelGrid,
    element: &'a Element,
    changes: &'a mut Changes,
    carrier: Carrier<W>,
    /// What the layer below has lost.
    lost_below: Block<W>,
    /// What this layer has lost so far.
    lost: Block<W>,
    /// Voxels that may have lost their support.
    doubtful: Block<W>,
    carried: Block<W>,
}

impl<'a, const W: usize> Sweep<'a, W> {
    fn new(grid: &'a mut VoxelGrid, element: &'a Element, changes: &'a mut Changes) -> Self {
        let carrier = Carrier::new(&grid.solid);
        let [lost_below, lost, doubtful, carried] = std::array::from_fn(|_| Block::default());
        Self { grid, element, changes, carrier, lost_below, lost, doubtful, carried }
    }

    fn run(&mut self, edit: &Edit) {
        let edited = layers_of(edit);
        for z in edited.start..self.grid.solid.size[2] {
            if z >= edited.end && self.lost_below.rows.is_empty() {
                break;
            }
            let removed = edit.remove.map_or(0..0, |bits| bits.kept(z));
            let shaken = self.carrier.widened(self.lost_below.range(), self.element.reach());
            self.lost.reset(crate::voxels::join(removed, shaken));
            if let Some(remove) = edit.remove {
                self.remove(z, remove);
            }
            if let Some(add) = edit.add {
                self.add(z, add, edit.material);
            }
            self.drop_unsupported(z);
            self.lost.tighten();
            std::mem::swap(&mut self.lost, &mut self.lost_below);
        }
    }

    fn remove(&mut self, z: usize, remove: &Bits) {
        let remove = remove.layers[z].rows::<W>();
        for y in remove.range() {
            let (here, remove) = (self.grid.solid.layers[z].rows::<W>().at(y), remove.at(y));
            let gone = std::array::from_fn(|w| here[w] & remove[w]);
            *self.lost.at_mut(y) = gone;
            let left = std::array::from_fn(|w| here[w] & !gone[w]);
            self.changes.write::<W>(self.grid, [y, z], [here, left]);
        }
    }

    fn add(&mut self, z: usize, add: &Bits, material: u8) {
        let add = add.layers[z].rows::<W>();
        self.carry(z, add.range());
        let full = self.grid.solid.full_row::<W>();
        for y in add.range() {
            let here = self.grid.solid.layers[z].rows::<W>().at(y);
            let carried = if z == 0 { full } else { self.carried.as_rows().at(y) };
            let wanted: [u64; W] = std::array::from_fn(|w| add.at(y)[w] & full[w] & !here[w]);
            let added: [u64; W] = std::array::from_fn(|w| wanted[w] & carried[w]);
            self.changes.take::<W>(self.grid, [y, z], std::array::from_fn(|w| wanted[w] & !carried[w]));
            let all = std::array::from_fn(|w| here[w] | added[w]);
            self.changes.write::<W>(self.grid, [y, z], [here, all]);
            self.changes.paint::<W>(self.grid, [y, z], added, material);
        }
    }

    /// Looks at what the lost voxels of the layer below may have carried.
    fn drop_unsupported(&mut self, z: usize) {
        if z == 0 || self.lost_below.rows.is_empty() {
            return;
        }
        let kept = self.grid.solid.kept(z);
        let steps = self.element.steps(z - 1);
        self.carrier.carried(steps, self.lost_below.as_rows(), kept, &mut self.doubtful);
        let here = self.grid.solid.layers[z].rows::<W>();
        for (n, row) in self.doubtful.rows.iter_mut().enumerate() {
            let here = here.at(self.doubtful.first + n);
            *row = std::array::from_fn(|w| row[w] & here[w]);
        }
        self.doubtful.tighten();
        self.carry(z, self.doubtful.range());
        for y in self.doubtful.range() {
            let here = self.grid.solid.layers[z].rows::<W>().at(y);
            let (doubtful, carried) = (self.doubtful.as_rows().at(y), self.carried.as_rows().at(y));
            let gone: [u64; W] = std::array::from_fn(|w| doubtful[w] & !carried[w]);
            if gone != [0; W] {
                let lost = self.lost.at_mut(y);
                *lost = std::array::from_fn(|w| lost[w] | gone[w]);
                self.changes.take::<W>(self.grid, [y, z], gone);
                let left = std::array::from_fn(|w| here[w] & !gone[w]);
                self.changes.write::<W>(self.grid, [y, z], [here, left]);
            }
        }
    }

    /// What the layer below z carries in these rows; nothing on the bed.
    fn carry(&mut self, z: usize, rows: Range<usize>) {
        let below = z.checked_sub(1).map_or(Rows::EMPTY, |z| self.grid.solid.layers[z].rows::<W>());
        let steps = self.element.steps(z.saturating_sub(1));
        self.carrier.carried(steps, below, rows, &mut self.carried);
    }
}

/// The layers from the first to the last that an edit names.
fn layers_of(edit: &Edit) -> Range<usize> {
    let named = [edit.add, edit.remove]
        .into_iter()
        .flatten()
        .flat_map(|bits| (0..bits.size[2]).filter(|&z| !bits.kept(z).is_empty()).map(|z| z..z + 1));
    named.fold(0..0, crate::voxels::join)
}
