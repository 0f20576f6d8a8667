//! Phases two to four: from the vertices of all bricks to the triangles, for all of them or where an edit was felt.

use std::convert::Infallible;
use std::ops::RangeInclusive;
use std::sync::Arc;

use blobtree::{Aabb, Field, Sampler};
use rayon::prelude::*;

use crate::lattice::BrickKey;
use crate::place::Batch;
use crate::ring::Around;
use crate::settle::{fitting_alone, settle};
use crate::split::{Stitched, accept, cut, propose, suspects};
use crate::stitch::stitch;
use crate::surface::{Entry, GRAIN, PREVIOUS, Surface};
use crate::workers::run_tasks;

/// Offsets of a brick and those around it.
const ALL: RangeInclusive<i32> = -1..=1;

/// Offsets of the bricks that may have triangles with a brick's vertices.
const NEXT: RangeInclusive<i32> = 0..=1;

impl Surface {
    /// The later phases for all bricks.
    pub(crate) fn finish_all(&mut self, field: &dyn Field) {
        let all: Vec<usize> = (0..self.bricks.len()).collect();
        self.settle_alone(&all);
        self.settle_together(&all);
        self.stitch_entries(&all);
        self.propose_splits(field, &all);
        self.accept_splits(&all);
        self.cut_entries(&all);
    }

    /// The later phases after a change of phase one in the bricks with keys `touched`, and of the field in the boxes that
    /// `touch` says: each for the bricks that see something different, as far as the differences spread. Returns the
    /// keys of all that are different now.
    pub(crate) fn finish_around(
        &mut self,
        field: &dyn Field,
        touched: &[BrickKey],
        touch: &mut dyn FnMut(&Aabb) -> bool,
    ) -> Vec<BrickKey> {
        let mut unsettled = touched.to_vec();
        unsettled.extend(self.settle_alone(&self.entries_near(touched, ALL)));
        let mut moved = touched.to_vec();
        moved.extend(self.settle_together(&self.entries_near(&unsettled, ALL)));
        let stitched = self.stitch_entries(&self.entries_near(&moved, NEXT));
        let felt = (0..self.bricks.len()).filter(|&i| touch(&self.bricks[i].seen));
        let mut splitting = self.entries_near(&moved, ALL);
        splitting.extend(self.entries_near(&stitched, PREVIOUS));
        splitting.extend(felt);
        sort_and_dedup(&mut splitting);
        let proposed = self.propose_splits(field, &splitting);
        splitting.extend(self.entries_near(&proposed, ALL));
        sort_and_dedup(&mut splitting);
        moved.extend(self.accept_splits(&splitting));
        let mut different = touched.to_vec();
        different.extend(self.cut_entries(&self.entries_near(&moved, NEXT)));
        // A chunk also holds vertices of the bricks before it.
        self.entries_near(&different, NEXT).into_iter().map(|i| self.bricks[i].key).collect()
    }

    /// The entries whose keys are any of `keys` plus an offset in `offsets` along each axis, ascending.
    fn entries_near(&self, keys: &[BrickKey], offsets: RangeInclusive<i32>) -> Vec<usize> {
        let mut near: Vec<usize> =
            keys.iter().flat_map(|&key| self.indices_around(key, offsets.clone())).flatten().collect();
        sort_and_dedup(&mut near);
        near
    }

    /// The first half of phase two for the entries with these indices: bold vertices on their own. This and the
    /// following return the keys of those entries that are different now.
    fn settle_alone(&mut self, indices: &[usize]) -> Vec<BrickKey> {
        let alone = self.for_entries(indices, |surface, entry| {
            if entry.surface.bold.is_empty() {
                return Arc::default();
            }
            let around = surface.indices_around(entry.key, ALL);
            let surfaces = around.map(|n| n.map(|n| &*surface.bricks[n].surface));
            Arc::new(fitting_alone(&surfaces, surface.cell().mm()))
        });
        self.renew(indices, alone, |entry, bold| renew(&mut entry.bold, bold))
    }

    /// The second half of phase two: bold vertices among others.
    fn settle_together(&mut self, indices: &[usize]) -> Vec<BrickKey> {
        let settled = self.for_entries(indices, |surface, entry| {
            if entry.bold.is_empty() {
                return Arc::clone(&entry.surface.vertices);
            }
            let around = surface.indices_around(entry.key, ALL);
            let surfaces = around.map(|n| n.map(|n| &*surface.bricks[n].surface));
            let bold = around.map(|n| n.map(|n| &surface.bricks[n].bold[..]));
            Arc::new(settle(&surfaces, &bold, surface.cell().mm()))
        });
        self.renew(indices, settled, |entry, vertices| renew(&mut entry.settled, vertices))
    }

    /// Phase three for the entries with these indices, and which of the triangles may cut off edges.
    fn stitch_entries(&mut self, indices: &[usize]) -> Vec<BrickKey> {
        let stitched = self.for_entries(indices, |surface, entry| {
            let around = surface.indices_around(entry.key, PREVIOUS);
            let surfaces = around.map(|n| n.map(|n| &*surface.bricks[n].surface));
            let vertices = around.map(|n| n.map(|n| &surface.bricks[n].settled[..]));
            let triangles = stitch(&surfaces, &vertices, surface.cell().mm());
            let stitched = around.map(|index| {
                let entry = &surface.bricks[index?];
                let (surface, vertices) = (&*entry.surface, &entry.settled[..]);
                Some(Stitched { surface, vertices, triangles: &triangles, suspects: &[] })
            });
            let suspects = suspects(&stitched, surface.cell().mm());
            (Arc::new(triangles), Arc::new(suspects))
        });
        self.renew(indices, stitched, |entry, (triangles, suspects)| {
            renew(&mut entry.stitched, triangles) | renew(&mut entry.suspects, suspects)
        })
    }

    /// The first part of phase four: vertices that might be on the lines of the entries with these indices.
    fn propose_splits(&mut self, field: &dyn Field, indices: &[usize]) -> Vec<BrickKey> {
        let run = |(sampler, batch): &mut (Box<dyn Sampler + '_>, Batch), task: usize| {
            let around = self.indices_around(self.bricks[indices[task]].key, ALL);
            let proposed = propose(&self.stitched(&around), &mut **sampler, self.cell().mm(), batch);
            Ok::<_, Infallible>(Some(proposed))
        };
        let Ok(all) = run_tasks(indices.len(), GRAIN, || (field.sampler(), Batch::default()), run);
        self.renew(indices, all, |entry, (proposals, seen)| {
            entry.seen = seen;
            renew(&mut entry.proposals, Arc::new(proposals))
        })
    }

    /// The second part of phase four: which of them may be there.
    fn accept_splits(&mut self, indices: &[usize]) -> Vec<BrickKey> {
        let accepted = self.for_entries(indices, |surface, entry| {
            let around = surface.indices_around(entry.key, ALL);
            let proposals = around.map(|n| n.map(|n| &surface.bricks[n].proposals[..]));
            Arc::new(accept(&surface.stitched(&around), &proposals, surface.cell().mm()))
        });
        self.renew(indices, accepted, |entry, splits| renew(&mut entry.splits, splits))
    }

    /// The third part of phase four: all vertices, and the triangles cut along them.
    fn cut_entries(&mut self, indices: &[usize]) -> Vec<BrickKey> {
        let all = self.for_entries(indices, |surface, entry| {
            let around = surface.indices_around(entry.key, PREVIOUS);
            let splits = around.map(|n| n.map(|n| &surface.bricks[n].splits[..]));
            let vertices = if entry.splits.is_empty() {
                Arc::clone(&entry.settled)
            } else {
                let own = entry.settled.iter().copied();
                Arc::new(own.chain(entry.splits.iter().map(|split| split.vertex)).collect())
            };
            let triangles = if splits.iter().flatten().all(|s| s.is_empty()) {
                Arc::clone(&entry.stitched)
            } else {
                Arc::new(cut(&surface.stitched(&around), &splits))
            };
            (vertices, triangles)
        });
        self.renew(indices, all, |entry, (vertices, triangles)| {
            renew(&mut entry.vertices, vertices) | renew(&mut entry.triangles, triangles)
        })
    }

    fn stitched(&self, around: &Around<usize>) -> Around<Stitched<'_>> {
        around.map(|index| {
            let entry = &self.bricks[index?];
            Some(Stitched {
                surface: &entry.surface,
                vertices: &entry.settled,
                triangles: &entry.stitched,
                suspects: &entry.suspects,
            })
        })
    }

    /// What `work` makes of each of these entries, in parallel.
    fn for_entries<T: Send>(&self, indices: &[usize], work: impl Fn(&Self, &Entry) -> T + Sync) -> Vec<T> {
        indices.par_iter().with_min_len(2).map(|&i| work(self, &self.bricks[i])).collect()
    }

    /// Hands each of these entries its result, and returns the keys of those that `take` says are different now.
    fn renew<T>(
        &mut self,
        indices: &[usize],
        results: Vec<T>,
        take: impl Fn(&mut Entry, T) -> bool,
    ) -> Vec<BrickKey> {
        let entries = indices.iter().zip(results);
        entries
            .filter_map(|(&i, result)| {
                let entry = &mut self.bricks[i];
                take(entry, result).then_some(entry.key)
            })
            .collect()
    }
}

/// Puts `new` in the place of `old`; returns whether it is different.
fn renew<T: PartialEq>(old: &mut Arc<T>, new: Arc<T>) -> bool {
    let differs = !Arc::ptr_eq(old, &new) && **old != *new;
    *old = new;
    differs
}

fn sort_and_dedup(indices: &mut Vec<usize>) {
    indices.sort_unstable();
    indices.dedup();
}
