//! The exact signed distance to a curve of straight pieces.

use crate::curve::Curve;
use crate::thin_plate::Grid;
use glam::DVec2;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// A straight piece: where it begins, where it leads, and 1 over its squared length.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: DVec2,
    along: DVec2,
    inverse: f64,
}

/// The straight pieces of all contours.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    pieces: Vec<Piece>,
}

/// Samples along the side of the largest and of the smallest blocks of a distance image.
const LARGEST: usize = 64;
const SMALLEST: usize = 8;

impl Outline {
    pub fn new(curve: &Curve) -> Self {
        let mut pieces = Vec::new();
        for contour in &curve.contours {
            let n = contour.points.len();
            for (i, &from) in contour.points.iter().enumerate() {
                let along = contour.points[(i + 1) % n] - from;
                let inverse = along.length_squared().recip();
                if inverse.is_finite() {
                    pieces.push(Piece { from, along, inverse });
                }
            }
        }
        Self { pieces }
    }

    /// The signed distance at a place, below 0 inside. O(pieces).
    pub fn distance(&self, p: DVec2) -> f64 {
        let squared = Arch::new().dispatch(Nearest { pieces: &self.pieces, p });
        let crossings = self.pieces.iter().filter(|piece| piece.crosses_right_of(p)).count();
        if crossings % 2 == 1 { -squared.sqrt() } else { squared.sqrt() }
    }

    /// The signed distance on a grid, row by row, in parallel; more than `reach` outside, up to a fifth too large.
    ///
    /// Blocks of samples are halved, and a block hands down only pieces that may be the nearest somewhere in it:
    /// those no farther from its middle than the nearest plus its diagonal.
    pub fn image(&self, grid: &Grid, reach: f64) -> Vec<f64> {
        let [width, _] = grid.size;
        let mut samples = vec![0.0; width * grid.size[1]];
        samples.par_chunks_mut(width * LARGEST).enumerate().for_each(|(band, rows)| {
            for column in 0..width.div_ceil(LARGEST) {
                let first = [column * LARGEST, band * LARGEST];
                descend(grid, reach, first, LARGEST, &self.pieces, &mut |x, y, squared| {
                    if let Some(sample) = rows.get_mut((y - first[1]) * width + x) {
                        *sample = squared.sqrt();
                    }
                });
            }
        });
        self.sign(grid, &mut samples);
        samples
    }

    /// Turns what is inside to below 0: left of an odd number of crossings on its row.
    fn sign(&self, grid: &Grid, samples: &mut [f64]) {
        let [width, height] = grid.size;
        let mut crossings = vec![Vec::new(); height];
        let row_of = |y: f64| ((y - grid.origin.y) / grid.pixel).clamp(0.0, height as f64);
        for piece in &self.pieces {
            let ends = [piece.from.y, piece.from.y + piece.along.y];
            let rows =
                row_of(ends[0].min(ends[1])).floor() as usize..=row_of(ends[0].max(ends[1])).ceil() as usize;
            for row in rows.filter(|&row| row < height) {
                crossings[row].extend(piece.crossing(grid.at(0, row).y));
            }
        }
        samples.par_chunks_mut(width).zip(crossings).enumerate().for_each(
            |(row, (samples, mut crossings))| {
                crossings.sort_unstable_by(f64::total_cmp);
                let mut passed = 0;
                for (column, sample) in samples.iter_mut().enumerate() {
                    let x = grid.at(column, row).x;
                    passed += crossings[passed..].iter().take_while(|&&at| at <= x).count();
                    if passed % 2 == 1 {
                        *sample = -*sample;
                    }
                }
            },
        );
    }
}

impl Piece {
    #[inline(always)]
    fn squared_distance(&self, p: DVec2) -> f64 {
        let (x, y) = (p.x - self.from.x, p.y - self.from.y);
        let t = (x * self.along.x + y * self.along.y) * self.inverse;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        let (x, y) = (x - t * self.along.x, y - t * self.along.y);
        x * x + y * y
    }

    /// Where the piece crosses a horizontal line.
    fn crossing(&self, y: f64) -> Option<f64> {
        let crosses = (self.from.y <= y) != (self.from.y + self.along.y <= y);
        crosses.then(|| self.from.x + (y - self.from.y) / self.along.y * self.along.x)
    }

    fn crosses_right_of(&self, p: DVec2) -> bool {
        self.crossing(p.y).is_some_and(|x| x > p.x)
    }
}

/// Calls `set` with column, row and squared distance for every sample of the block of `side` from `first` (some
/// may lie beyond the grid).
fn descend(
    grid: &Grid,
    reach: f64,
    first: [usize; 2],
    side: usize,
    pieces: &[Piece],
    set: &mut impl FnMut(usize, usize, f64),
) {
    if first[0] >= grid.size[0] || first[1] >= grid.size[1] {
        return;
    }
    let [low, high] = [0, side - 1].map(|i| grid.at(first[0] + i, first[1] + i));
    let middle = 0.5 * (low + high);
    let mut squared = vec![0.0; pieces.len()];
    let nearest = Arch::new().dispatch(Distances { pieces, p: middle, out: &mut squared }).sqrt();
    let diagonal = low.distance(high);
    // Farther out than anyone looks, missing the nearest piece by a little does no harm.
    let margin = if nearest - 0.5 * diagonal > reach { 0.2 } else { 1.0 };
    let limit = ((nearest + margin * diagonal) * (1.0 + 1e-9)).powi(2);
    let kept: Vec<Piece> =
        pieces.iter().zip(&squared).filter(|&(_, d)| *d <= limit).map(|(piece, _)| *piece).collect();
    if side > SMALLEST {
        for quarter in 0..4 {
            let from = [first[0] + side / 2 * (quarter % 2), first[1] + side / 2 * (quarter / 2)];
            descend(grid, reach, from, side / 2, &kept, set);
        }
        return;
    }
    let mut squared = [f64::INFINITY; SMALLEST * SMALLEST];
    Arch::new().dispatch(NearestInBlock { pieces: &kept, low, pixel: grid.pixel, out: &mut squared });
    for (i, squared) in squared.into_iter().enumerate() {
        let (x, y) = (first[0] + i % SMALLEST, first[1] + i / SMALLEST);
        if x < grid.size[0] && y < grid.size[1] {
            set(x, y, squared);
        }
    }
}

/// The least squared distance of a place.
struct Nearest<'a> {
    pieces: &'a [Piece],
    p: DVec2,
}

impl NullaryFnOnce for Nearest<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut nearest = f64::INFINITY;
        for piece in self.pieces {
            let squared = piece.squared_distance(self.p);
            nearest = if squared < nearest { squared } else { nearest };
        }
        nearest
    }
}

/// The squared distances of a place from all pieces, and the least.
struct Distances<'a> {
    pieces: &'a [Piece],
    p: DVec2,
    out: &'a mut [f64],
}

impl NullaryFnOnce for Distances<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut nearest = f64::INFINITY;
        for (out, piece) in self.out.iter_mut().zip(self.pieces) {
            *out = piece.squared_distance(self.p);
            nearest = if *out < nearest { *out } else { nearest };
        }
        nearest
    }
}

/// The least squared distance of each sample of a smallest block.
struct NearestInBlock<'a> {
    pieces: &'a [Piece],
    low: DVec2,
    pixel: f64,
    out: &'a mut [f64; SMALLEST * SMALLEST],
}

impl NullaryFnOnce for NearestInBlock<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let x: [f64; SMALLEST] = std::array::from_fn(|i| self.low.x + self.pixel * i as f64);
        for piece in self.pieces {
            for (row, line) in self.out.as_chunks_mut::<SMALLEST>().0.iter_mut().enumerate() {
                let y = self.low.y + self.pixel * row as f64;
                for i in 0..SMALLEST {
                    let squared = piece.squared_distance(DVec2::new(x[i], y));
                    line[i] = if squared < line[i] { squared } else { line[i] };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Contour;

    fn square_with_a_hole() -> Outline {
        let corners = |half: f64, turn: f64| -> Vec<DVec2> {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| half * DVec2::new(x, y * turn))
                .to_vec()
        };
        let contour = |points| Contour { points, corners: vec![0, 1, 2, 3] };
        let contours = vec![contour(corners(10.0, 1.0)), contour(corners(4.0, -1.0))];
        Outline::new(&Curve { contours, left_out: Vec::new() })
    }

    fn exact(p: DVec2) -> f64 {
        let to_square = |half: f64| {
            let q = p.abs() - half;
            q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
        };
        to_square(10.0).max(-to_square(4.0))
    }

    #[test]
    fn the_distance_of_a_framed_square_is_exact_at_places_and_on_grids() {
        let outline = square_with_a_hole();
        let grid = Grid { origin: DVec2::new(-14.03, -15.17), pixel: 0.173, size: [163, 171] };
        let image = outline.image(&grid, f64::INFINITY);
        for (i, sample) in image.iter().enumerate() {
            let p = grid.at(i % grid.size[0], i / grid.size[0]);
            assert!((sample - exact(p)).abs() < 1e-9, "{p}: {sample}");
            if i % 17 == 0 {
                assert!((outline.distance(p) - exact(p)).abs() < 1e-9, "{p}");
            }
        }
    }
}
