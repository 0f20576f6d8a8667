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

/// Offsets of the bricks that may have triangles with a brick's vertices.
const NEXT: RangeInclusive<i32> = 0..=1;

/// How far from a brick's cells its splits look at the field, in cells: triangles with a vertex in there reach two
/// cells further, their vertices may have left their cells by one, and the edges that they miss are two from those.
const SPLITS_SEE: f32 = 5.0;

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

    /// The later phases after a change of phase one in the bricks with keys `touched`, and of the field within
    /// `dirty`. Returns the keys of all that are different now.
    pub(crate) fn finish_around(
        &mut self,
        field: &dyn Field,
        touched: &[BrickKey],
        dirty: Aabb,
    ) -> Vec<BrickKey> {
        let (lattice, sees) = (self.lattice(), SPLITS_SEE * self.cell().mm());
        let feels = |key: BrickKey| lattice.apron(key).grown(sees).overlaps(&dirty);
        let felt: Vec<BrickKey> = self.bricks.iter().map(|b| b.key).filter(|key| feels(*key)).collect();
        let near = |reach: RangeInclusive<i32>, felt_reach: RangeInclusive<i32>| {
            let mut near = self.entries_near(touched, reach);
            near.extend(self.entries_near(&felt, felt_reach));
            near.sort_unstable();
            near.dedup();
            near
        };
        let (proposing, accepting, cut) = (near(-3..=3, 0..=0), near(-4..=4, -1..=1), near(-4..=5, -1..=2));
        let before: Vec<Entry> = cut.iter().map(|&i| self.bricks[i].clone()).collect();
        self.settle_alone(&self.entries_near(touched, -1..=1));
        self.settle_together(&self.entries_near(touched, -2..=2));
        self.stitch_entries(&self.entries_near(touched, -2..=3));
        self.propose_splits(field, &proposing);
        self.accept_splits(&accepting);
        self.cut_entries(&cut);
        let differs = |(i, old): &(&usize, &Entry)| {
            let new = &self.bricks[**i];
            touched.contains(&new.key) || new.vertices != old.vertices || new.triangles != old.triangles
        };
        let different: Vec<BrickKey> =
            cut.iter().zip(&before).filter(differs).map(|(_, old)| old.key).collect();
        // A chunk also holds vertices of the bricks before it.
        self.entries_near(&different, NEXT).into_iter().map(|i| self.bricks[i].key).collect()
    }

    /// The entries whose keys are any of `keys` plus an offset in `offsets` along each axis, ascending.
    fn entries_near(&self, keys: &[BrickKey], offsets: RangeInclusive<i32>) -> Vec<usize> {
        let near = keys.iter().flat_map(|&[x, y, z]| {
            let offsets = offsets.clone();
            offsets.clone().flat_map(move |dx| {
                let offsets = offsets.clone();
                offsets.clone().flat_map(move |dy| offsets.clone().map(move |dz| [x + dx, y + dy, z + dz]))
            })
        });
        let mut keys: Vec<BrickKey> = near.collect();
        keys.sort_unstable();
        keys.dedup();
        keys.into_iter().filter_map(|key| self.find(key)).collect()
    }

    /// The first half of phase two for the entries with these indices: bold vertices on their own.
    fn settle_alone(&mut self, indices: &[usize]) {
        let alone = self.for_entries(indices, |surface, entry| {
            if entry.surface.bold.is_empty() {
                return Arc::default();
            }
            let around = surface.indices_around(entry.key, -1..=1);
            let surfaces = around.map(|n| n.map(|n| &*surface.bricks[n].surface));
            Arc::new(fitting_alone(&surfaces, surface.cell().mm()))
        });
        for (&i, bold) in indices.iter().zip(alone) {
            self.bricks[i].bold = bold;
        }
    }

    /// The second half of phase two: bold vertices among others.
    fn settle_together(&mut self, indices: &[usize]) {
        let settled = self.for_entries(indices, |surface, entry| {
            if entry.bold.is_empty() {
                return Arc::clone(&entry.surface.vertices);
            }
            let around = surface.indices_around(entry.key, -1..=1);
            let surfaces = around.map(|n| n.map(|n| &*surface.bricks[n].surface));
            let bold = around.map(|n| n.map(|n| &surface.bricks[n].bold[..]));
            Arc::new(settle(&surfaces, &bold, surface.cell().mm()))
        });
        for (&i, vertices) in indices.iter().zip(settled) {
            self.bricks[i].settled = vertices;
        }
    }

    /// Phase three for the entries with these indices, and which of the triangles may cut off edges.
    fn stitch_entries(&mut self, indices: &[usize]) {
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
        for (&i, (triangles, suspects)) in indices.iter().zip(stitched) {
            self.bricks[i].stitched = triangles;
            self.bricks[i].suspects = suspects;
        }
    }

    /// The first part of phase four: vertices that might be on the lines of the entries with these indices.
    fn propose_splits(&mut self, field: &dyn Field, indices: &[usize]) {
        let run = |(sampler, batch): &mut (Box<dyn Sampler + '_>, Batch), task: usize| {
            let around = self.indices_around(self.bricks[indices[task]].key, -1..=1);
            let proposed = propose(&self.stitched(&around), &mut **sampler, self.cell().mm(), batch);
            Ok::<_, Infallible>(Some(Arc::new(proposed)))
        };
        let Ok(all) = run_tasks(indices.len(), GRAIN, || (field.sampler(), Batch::default()), run);
        for (&i, proposals) in indices.iter().zip(all) {
            self.bricks[i].proposals = proposals;
        }
    }

    /// The second part of phase four: which of them may be there.
    fn accept_splits(&mut self, indices: &[usize]) {
        let accepted = self.for_entries(indices, |surface, entry| {
            let around = surface.indices_around(entry.key, -1..=1);
            let proposals = around.map(|n| n.map(|n| &surface.bricks[n].proposals[..]));
            Arc::new(accept(&surface.stitched(&around), &proposals, surface.cell().mm()))
        });
        for (&i, splits) in indices.iter().zip(accepted) {
            self.bricks[i].splits = splits;
        }
    }

    /// The third part of phase four: all vertices, and the triangles cut along them.
    fn cut_entries(&mut self, indices: &[usize]) {
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
        for (&i, (vertices, triangles)) in indices.iter().zip(all) {
            self.bricks[i].vertices = vertices;
            self.bricks[i].triangles = triangles;
        }
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
        indices.par_iter().with_min_len(8).map(|&i| work(self, &self.bricks[i])).collect()
    }
}
