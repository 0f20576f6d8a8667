//! One thread's way into a cache.

use super::bricks::{CacheBrick, CacheSite, LEVELS, NodeCache};
use super::interpolation::tricubic;
use super::pages::Found;
use crate::eval::TreeSampler;
use crate::field::Field;
use crate::scalar::{Scalar, Slope, Triple, both_pieces};
use glam::Vec3;

/// Interpolated places of one cache are all on one piece, where nothing is creased.
const CACHED_PIECE: u32 = 0x5eed_cace;

/// Reads a cache, and fills it where nobody did before.
#[derive(Debug)]
pub(crate) struct CacheReader<'a> {
    site: &'a CacheSite,
    /// At each level the brick looked at last.
    last: [Option<([i32; 3], Found<'a>)>; LEVELS],
    /// What fills bricks.
    filler: Option<Box<TreeSampler<'a>>>,
}

impl<'a> CacheReader<'a> {
    pub fn new(site: &'a CacheSite) -> Self {
        Self { site, last: Default::default(), filler: None }
    }

    /// The interpolated field at `p`, in the space of evaluation; `None` where it must be evaluated exactly.
    ///
    /// `creased` says whether the region in question is creased somewhere: if so, no two bricks are on one piece,
    /// as there may be a crease between them.
    #[inline(always)]
    pub fn read<S: Scalar>(&mut self, p: Triple<S>, creased: bool) -> Option<Slope<S>> {
        let cache = &self.site.cache;
        let place = self.site.frame.apply(p);
        if !cache.exact.support().contains(Vec3::from_array(place.map(S::value))) {
            return Some(Slope::constant(0.0));
        }
        for level in 0..LEVELS {
            let per_cell = S::of(1.0 / cache.level_spacing(level));
            let q = place.map(|x| x * per_cell);
            let cell = NodeCache::cell_of(q.map(S::value));
            match self.brick(level, NodeCache::brick_of(cell)) {
                CacheBrick::Empty => return Some(Slope::constant(0.0)),
                CacheBrick::Samples { certified, samples }
                    if certified.contains(NodeCache::place_in_brick(cell)) =>
                {
                    let t = std::array::from_fn(|a| q[a] - S::of(cell[a] as f32));
                    let slope = tricubic(samples, NodeCache::place_in_brick(cell), t);
                    let gradient = self.site.frame.pull_back(slope.gradient.map(|g| g * per_cell));
                    // Interpolation may swing below 0, where fields never are.
                    return Some(if slope.value.value() > 0.0 {
                        Slope::new(slope.value, gradient).on(self.piece(level, cell, creased))
                    } else {
                        Slope::constant(0.0)
                    });
                }
                _ => {}
            }
        }
        None
    }

    fn piece(&self, level: usize, cell: [i32; 3], creased: bool) -> u32 {
        let piece = both_pieces(CACHED_PIECE, self.site.number);
        let brick = NodeCache::brick_of(cell).into_iter();
        let own = || brick.fold(both_pieces(piece, level as u32), |piece, k| both_pieces(piece, k as u32));
        // Not 0, which says nothing.
        (if creased { own() } else { piece }) << 1 | 1
    }

    #[inline(always)]
    fn brick(&mut self, level: usize, key: [i32; 3]) -> &CacheBrick {
        if self.last[level].as_ref().is_none_or(|(last, _)| *last != key) {
            self.look_at(level, key);
        }
        self.last[level].as_ref().map_or(&CacheBrick::Exact, |(_, found)| found.brick())
    }

    fn look_at(&mut self, level: usize, key: [i32; 3]) {
        let cache = &self.site.cache;
        let filler = &mut self.filler;
        let brick = cache.brick(level, key, || {
            let filler = filler.get_or_insert_with(|| Box::new(TreeSampler::new(&cache.exact)));
            cache.fill(level, key, filler)
        });
        self.last[level] = Some((key, brick));
    }
}
