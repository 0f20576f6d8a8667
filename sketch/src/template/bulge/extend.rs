//! The slope of the bulge on the curve, spread over what lies outside.

use rayon::prelude::*;

/// Nodes nearer to the curve than this, in pixels, tell nothing of the slope.
const NEAREST: f32 = 0.25;

/// Rounds of smoothing on each level but the finest.
const ROUNDS: usize = 2;

/// Slopes where they are known, and how well: 1 or 0 for nodes, up to 1 for the mean of several.
pub(super) struct Slopes {
    width: usize,
    slopes: Vec<f32>,
    known: Vec<f32>,
}

impl Slopes {
    /// The slopes on the curve, at nodes inside beside it; in pixels.
    pub fn new(bulge: &[f32], distance: &[f32], width: usize) -> Self {
        let (mut slopes, mut known) = (vec![0.0; bulge.len()], vec![0.0; bulge.len()]);
        for y in 1..bulge.len() / width - 1 {
            for i in y * width + 1..(y + 1) * width - 1 {
                let beside = [i - 1, i + 1, i - width, i + width].map(|n| distance[n]);
                if distance[i] > -NEAREST || beside.iter().all(|d| *d < 0.0) {
                    continue;
                }
                // Rounding may leave a node beside a gap of less than a pixel a little below 0.
                let (inside, mean) = (-distance[i], bulge[i].max(0.0) / -distance[i]);
                // On the way from the curve the bulge bends by −4 less what the curve's own bend takes.
                let bend = (beside.iter().sum::<f32>() - 4.0 * distance[i]).clamp(-0.5, 0.5);
                let slope = mean + inside * (2.0 - 0.5 * bend * mean);
                (slopes[i], known[i]) = (slope.clamp(mean, 2.0 * mean), 1.0);
            }
        }
        Self { width, slopes, known }
    }

    /// Slopes everywhere: those known as they are, between them a smooth mean of those around.
    ///
    /// Means of 2 × 2 nodes, then of 2 × 2 of these and so on; on the way back each level is filled from the coarser
    /// one where it knows nothing, and smoothed there.
    pub fn spread(self) -> Vec<f32> {
        let mut levels = vec![self];
        while levels[levels.len() - 1].slopes.len() > 1 {
            let next = levels[levels.len() - 1].coarser();
            levels.push(next);
        }
        let mut filled = levels.pop().expect("there is a first level");
        while let Some(mut finer) = levels.pop() {
            finer.fill(&filled);
            if !levels.is_empty() {
                (0..ROUNDS).for_each(|_| finer.smooth());
            }
            filled = finer;
        }
        filled.slopes
    }

    fn height(&self) -> usize {
        self.slopes.len() / self.width
    }

    fn coarser(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height().div_ceil(2));
        let mut coarse = Self { width, slopes: vec![0.0; width * height], known: vec![0.0; width * height] };
        for (y, (slopes, known)) in
            self.slopes.chunks(self.width).zip(self.known.chunks(self.width)).enumerate()
        {
            for (x, (slope, known)) in slopes.iter().zip(known).enumerate() {
                let at = y / 2 * width + x / 2;
                coarse.slopes[at] += slope * known;
                coarse.known[at] += known;
            }
        }
        for (slope, known) in coarse.slopes.iter_mut().zip(&mut coarse.known) {
            if *known > 0.0 {
                *slope /= *known;
                *known = known.min(1.0);
            }
        }
        coarse
    }

    /// Fills what is not known, linearly between the means of the coarser level.
    fn fill(&mut self, coarse: &Self) {
        let (width, height) = (coarse.width, coarse.height());
        let beside = |x: usize, count: usize| {
            let other = if x.is_multiple_of(2) { (x / 2).saturating_sub(1) } else { x / 2 + 1 };
            (x / 2, other.min(count - 1))
        };
        let fine = self.width;
        let rows = self.slopes.par_chunks_mut(fine).zip(self.known.par_chunks(fine)).enumerate();
        rows.for_each(|(y, (slopes, known))| {
            let (y, other_y) = beside(y, height);
            let rows = [y, other_y].map(|y| &coarse.slopes[y * width..][..width]);
            for (x, (slope, known)) in slopes.iter_mut().zip(known).enumerate() {
                let (x, other_x) = beside(x, width);
                let across = |x: usize| 0.75 * rows[0][x] + 0.25 * rows[1][x];
                let mean = 0.75 * across(x) + 0.25 * across(other_x);
                *slope = mean + known * (*slope - mean);
            }
        });
    }

    /// Draws what is not known to the mean of its neighbours.
    fn smooth(&mut self) {
        let (width, height) = (self.width, self.height());
        for y in 1..height.saturating_sub(1) {
            for i in y * width + 1..(y + 1) * width - 1 {
                let mean = 0.25
                    * ((self.slopes[i - 1] + self.slopes[i + 1])
                        + (self.slopes[i - width] + self.slopes[i + width]));
                self.slopes[i] += (1.0 - self.known[i]) * (mean - self.slopes[i]);
            }
        }
    }
}
