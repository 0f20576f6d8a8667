//! What the five brushes do.

use super::{Dab, Tip};
use crate::support::{Edit, apply, grow_below, is_carried, leave_needed, smooth_within};
use crate::voxels::{Bits, Block, Row, for_width, moved_row};
use crate::{Changes, Element, Paths, VoxelGrid};

/// What a brush does with the voxels of its tip.
#[derive(Clone, Copy)]
pub enum Action<'a> {
    /// Adds those that are carried. Changes nothing outside the tip.
    AddTrim,
    /// Removes them, and then whatever that leaves hanging. Changes nothing below the tip, nor outside the cone of the
    /// element above it.
    RemoveTrim,
    /// Removes them but for what is needed to carry the solid above, and then whatever still hangs.
    RemovePreserve,
    /// Adds them all, and grows what they need to stand on along these paths.
    AddGrow(&'a dyn Paths),
    /// Lets each go with the majority of the 27 around it, and then removes whatever that leaves hanging.
    SmoothTrim,
}

impl std::fmt::Debug for Action<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AddTrim => "AddTrim",
            Self::RemoveTrim => "RemoveTrim",
            Self::RemovePreserve => "RemovePreserve",
            Self::AddGrow(_) => "AddGrow",
            Self::SmoothTrim => "SmoothTrim",
        })
    }
}

/// A brush.
#[derive(Clone, Debug)]
pub struct Brush<'a> {
    /// What it does.
    pub action: Action<'a>,
    /// Its shape.
    pub tip: Tip,
    /// What it adds is made of this.
    pub material: u8,
    /// What grows below what it adds is made of this.
    pub grown_material: u8,
}

impl Brush<'_> {
    /// Puts the brush down once.
    ///
    /// - **Promises:** a grid without unsupported voxels has none afterwards, with the element it was made with. What
    ///   else holds, the [`Action`] says.
    /// - **Cost:** proportional to the rows of voxels that the tip meets and that change with it.
    pub fn dab(&self, grid: &mut VoxelGrid, element: &Element, dab: &Dab) -> Changes {
        let mut changes = Changes::default();
        let mut tip = self.tip.stamp(dab, &grid.shape);
        let material = self.material;
        match self.action {
            Action::AddTrim => {
                near_surface(&mut tip, &grid.solid, dab, &grid.shape, true);
                apply(grid, element, &Edit { add: Some(&tip), remove: None, material }, &mut changes);
            }
            Action::RemoveTrim => {
                near_surface(&mut tip, &grid.solid, dab, &grid.shape, false);
                apply(grid, element, &Edit { add: None, remove: Some(&tip), material }, &mut changes);
            }
            Action::RemovePreserve => {
                near_surface(&mut tip, &grid.solid, dab, &grid.shape, false);
                keep_common(&mut tip, &grid.solid, true);
                leave_needed(grid, element, &mut tip);
                apply(grid, element, &Edit { add: None, remove: Some(&tip), material }, &mut changes);
            }
            Action::AddGrow(paths) => self.add_and_grow(grid, element, paths, tip, dab, &mut changes),
            Action::SmoothTrim => {
                for _ in 0..(3.0 * dab.strength()).ceil() as usize {
                    let after = smooth_within(&grid.solid, &tip);
                    let mut remove = tip.clone();
                    keep_common(&mut remove, &after, false);
                    let edit = Edit { add: Some(&after), remove: Some(&remove), material };
                    apply(grid, element, &edit, &mut changes);
                }
            }
        }
        changes
    }

    /// Adds the tip, puts it along the path down from its middle, and grows paths below what still hangs.
    fn add_and_grow(
        &self,
        grid: &mut VoxelGrid,
        element: &Element,
        paths: &dyn Paths,
        tip: Bits,
        dab: &Dab,
        changes: &mut Changes,
    ) {
        let mut added = Bits::new(grid.solid.size);
        add_moved(&mut added, &tip, [0, 0, 0]);
        let mut grown = Bits::new(grid.solid.size);
        let cause = voxel_at(grid, dab);
        if let Some([x, y, z]) = cause {
            for [px, py, pz] in path_down(grid, element, paths, [x, y, z]) {
                let moved = [px, py, pz].map(|n| n as i32);
                let [x, y, z] = [x, y, z].map(|n| n as i32);
                add_moved(&mut grown, &tip, [moved[0] - x, moved[1] - y, moved[2] - z]);
            }
        }
        keep_common(&mut added, &grid.solid, false);
        keep_common(&mut grown, &grid.solid, false);
        keep_common(&mut grown, &added, false);
        changes.add_all(grid, &added, self.material, None);
        changes.add_all(grid, &grown, self.grown_material, cause);
        add_moved(&mut added, &grown, [0, 0, 0]);
        grow_below(grid, element, paths, self.grown_material, Some(&added), changes);
    }
}

/// Puts a brush down along a stroke; one [`Changes`] for each dab, to be undone last first.
pub fn stroke(grid: &mut VoxelGrid, element: &Element, brush: &Brush, dabs: &[Dab]) -> Vec<Changes> {
    dabs.iter().map(|dab| brush.dab(grid, element, dab)).collect()
}

/// The voxel that a dab's middle lies in, if it lies in the grid.
fn voxel_at(grid: &VoxelGrid, dab: &Dab) -> Option<[usize; 3]> {
    let place = grid.shape.in_voxels(dab.center()).floor().to_array();
    let inside = (0..3).all(|axis| place[axis] >= 0.0 && place[axis] < grid.shape.voxels()[axis] as f32);
    inside.then(|| place.map(|n| n as usize))
}

/// The voxels of a path below `voxel`, down to the first that is carried; none if `voxel` is carried itself.
fn path_down(grid: &VoxelGrid, element: &Element, paths: &dyn Paths, voxel: [usize; 3]) -> Vec<[usize; 3]> {
    let mut path = Vec::new();
    let mut at = voxel;
    while at[2] > 0 && !is_carried(grid, element, at) {
        let [x, y] = paths.below(at);
        at = [x, y, at[2] - 1];
        path.push(at);
    }
    path
}

/// Adds the bits of another volume, moved; what leaves the volume is lost.
fn add_moved(into: &mut Bits, from: &Bits, [dx, dy, dz]: [i32; 3]) {
    let [_, ny, nz] = into.size;
    for_width!(into.words, W => {
        let full: Row<W> = into.full_row();
        for z in 0..nz {
            let rows = from.layers[z].rows::<W>();
            let Some(to) = z.checked_add_signed(dz as isize).filter(|&to| to < nz) else { continue };
            let moved = |y: usize| y.checked_add_signed(dy as isize).filter(|&to| to < ny);
            let targets = || rows.range().filter_map(|y| moved(y).map(|to| (y, to)));
            let (Some((_, first)), Some((_, last))) = (targets().next(), targets().next_back()) else { continue };
            into.layers[to].keep::<W>(first..last + 1);
            let (start, kept) = into.layers[to].rows_mut::<W>();
            for (y, to) in targets() {
                let row = moved_row(rows.at(y), dx);
                let kept = &mut kept[to - start];
                *kept = std::array::from_fn(|w| kept[w] | row[w] & full[w]);
            }
        }
    });
}

/// Clears the bits that are not set in another volume, or those that are.
fn keep_common(bits: &mut Bits, other: &Bits, common: bool) {
    let flip = if common { 0 } else { !0 };
    for_width!(bits.words, W => {
        for (layer, other) in bits.layers.iter_mut().zip(&other.layers) {
            let other = other.rows::<W>();
            let (first, rows) = layer.rows_mut::<W>();
            for (n, row) in rows.iter_mut().enumerate() {
                let other = other.at(first + n);
                *row = std::array::from_fn(|w| row[w] & (other[w] ^ flip));
            }
        }
    });
}

/// Leaves of the tip what lies within the dab's strength of the surface: outside the solid when adding, inside when
/// not. The bed counts as solid. Near is counted in voxels, over plus and square by turns, which is round enough here.
fn near_surface(tip: &mut Bits, solid: &Bits, dab: &Dab, shape: &crate::GridShape, adding: bool) {
    if dab.strength() >= 1.0 {
        return;
    }
    keep_common(tip, solid, !adding);
    let steps = (dab.strength() * dab.radius() / shape.size().width()).round() as usize;
    let mut near = Bits::new(tip.size);
    for step in 0..steps.min(crate::MAX_VOXELS) {
        near = for_width!(tip.words, W => nearer::<W>(tip, solid, &near, adding, step % 2 == 1));
    }
    *tip = near;
}

/// One step of [`near_surface`]: the voxels of the tip beside those of `near`, or beside the surface.
fn nearer<const W: usize>(tip: &Bits, solid: &Bits, near: &Bits, adding: bool, square: bool) -> Bits {
    let [_, ny, nz] = tip.size;
    let full: Row<W> = tip.full_row();
    // What the surface moves away from: the solid and the bed, or the air around it.
    let source = |y: Option<usize>, z: Option<usize>| -> Row<W> {
        let (Some(y), Some(z)) = (y, z) else {
            return if adding == z.is_none() { full } else { [0; W] };
        };
        if y >= ny || z >= nz {
            return if adding { [0; W] } else { full };
        }
        let (solid, near) = (solid.layers[z].rows::<W>().at(y), near.layers[z].rows::<W>().at(y));
        std::array::from_fn(|w| (if adding { solid[w] } else { !solid[w] & full[w] }) | near[w])
    };
    let mut result = Bits::new(tip.size);
    for z in 0..nz {
        let wanted = tip.layers[z].rows::<W>();
        let mut block = Block::<W>::default();
        block.reset(wanted.range());
        for y in wanted.range() {
            let beside = |row: Row<W>| -> Row<W> {
                let (up, down) = (moved_row(row, 1), moved_row(row, -1));
                std::array::from_fn(|w| row[w] | up[w] | down[w])
            };
            let here = beside(source(Some(y), Some(z)));
            let sides = [y.checked_sub(1), Some(y + 1)].map(|y| source(y, Some(z)));
            let sides = if square { sides.map(beside) } else { sides };
            let others = [z.checked_sub(1), Some(z + 1)].map(|z| source(Some(y), z));
            *block.at_mut(y) = std::array::from_fn(|w| {
                (here[w] | sides[0][w] | sides[1][w] | others[0][w] | others[1][w]) & wanted.at(y)[w]
            });
        }
        result.layers[z].set(&block);
    }
    result
}
