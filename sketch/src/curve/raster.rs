//! A small grid of cells that lines are painted on.

use glam::{DVec2, IVec2};

/// More steps than any raster has.
const FAR: f64 = 1e6;

/// Square cells over a box.
pub(super) struct Raster {
    pub origin: DVec2,
    pub cell: f64,
    pub width: usize,
    pub height: usize,
}

impl Raster {
    /// Over a box, with about `cells` cells along its longer side and a margin on all sides.
    pub fn over(least: DVec2, most: DVec2, cells: usize, margin: f64) -> Self {
        let (least, most) = (least - margin, most + margin);
        let cell = (most - least).max_element() / cells as f64;
        let size = ((most - least) / cell).ceil();
        Self { origin: least, cell, width: size.x as usize + 1, height: size.y as usize + 1 }
    }

    pub fn count(&self) -> usize {
        self.width * self.height
    }

    fn cell_of(&self, at: DVec2) -> IVec2 {
        ((at - self.origin) / self.cell).floor().as_ivec2()
    }

    /// The cells along a path, those outside left away.
    pub fn paint(&self, path: &[DVec2], mut each: impl FnMut(usize)) {
        for pair in path.windows(2) {
            let steps = (pair[0].distance(pair[1]) / (0.5 * self.cell)).ceil().max(1.) as usize;
            for i in 0..=steps {
                let cell = self.cell_of(pair[0].lerp(pair[1], i as f64 / steps as f64));
                let inside =
                    (0..self.width as i32).contains(&cell.x) && (0..self.height as i32).contains(&cell.y);
                if inside {
                    each(cell.y as usize * self.width + cell.x as usize);
                }
            }
        }
    }

    /// Which cells can be reached from the border over cells that are open, by steps along x and y.
    ///
    /// **Cost:** linear; whole runs along x are taken at once.
    pub fn outside(&self, open: impl Fn(usize) -> bool) -> Vec<bool> {
        let width = self.width;
        let mut reached = vec![false; self.count()];
        let rows = [0, self.height - 1].into_iter().flat_map(|y| (0..width).map(move |x| y * width + x));
        let columns = (0..self.height).flat_map(|y| [y * width, (y + 1) * width - 1]);
        let mut waiting: Vec<usize> = rows.chain(columns).collect();
        while let Some(i) = waiting.pop() {
            if reached[i] || !open(i) {
                continue;
            }
            let row = i - i % width;
            let free = |k: &usize| open(*k) && !reached[*k];
            let first = (row..i).rev().take_while(free).last().unwrap_or(i);
            let last = (i + 1..row + width).take_while(free).last().unwrap_or(i);
            reached[first..=last].fill(true);
            for beside in [row.checked_sub(width), Some(row + width).filter(|r| *r < self.count())] {
                let Some(beside) = beside else { continue };
                let run = (beside + first - row)..=(beside + last - row);
                let mut before = false;
                for k in run {
                    let free = open(k) && !reached[k];
                    if free && !before {
                        waiting.push(k);
                    }
                    before = free;
                }
            }
        }
        reached
    }

    /// Distance from each cell's middle to the nearest marked cell's middle.
    ///
    /// **Source:** Felzenszwalb & Huttenlocher 2012, lower envelopes of parabolas, along y and then along x.
    pub fn distances(&self, marked: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut squares: Vec<f64> = (0..self.count()).map(|i| if marked(i) { 0. } else { FAR }).collect();
        // Along y first: between marked cells of a column the nearest is found by going up and down.
        for row in 1..self.height {
            let (before, here) = squares.split_at_mut(row * self.width);
            let before = &before[(row - 1) * self.width..];
            for (value, above) in here[..self.width].iter_mut().zip(before) {
                *value = value.min(above + 1.);
            }
        }
        for row in (0..self.height - 1).rev() {
            let (here, after) = squares.split_at_mut((row + 1) * self.width);
            for (value, below) in here[row * self.width..].iter_mut().zip(&after[..self.width]) {
                *value = value.min(below + 1.);
            }
        }
        squares.iter_mut().for_each(|steps| *steps *= *steps);
        let mut envelope = Envelope::default();
        squares.chunks_mut(self.width).for_each(|row| envelope.lower(row));
        squares.into_iter().map(|square| square.sqrt() * self.cell).collect()
    }

    /// Closed paths around where the values exceed `level`, counter-clockwise, between the cells' middles.
    ///
    /// What exceeds the level must not reach the border. Where four cells meet crosswise, the high ones are apart.
    pub fn contours(&self, values: &[f64], level: f64) -> Vec<Vec<DVec2>> {
        let high = |x: usize, y: usize| values[y * self.width + x] > level;
        let mut done = vec![false; self.count()];
        let mut contours = Vec::new();
        for y in 1..self.height {
            for x in 1..self.width {
                // Each contour crosses some upright pair of cells with the high one above.
                if high(x, y) && !high(x, y - 1) && !done[y * self.width + x] {
                    contours.extend(self.follow(values, level, [x, y], &mut done));
                }
            }
        }
        contours
    }

    /// Follows a contour with the high cells on the left, from the cell `start`, which is high above a low one.
    fn follow(&self, values: &[f64], level: f64, start: [usize; 2], done: &mut [bool]) -> Option<Vec<DVec2>> {
        const AROUND: [IVec2; 4] = [IVec2::NEG_Y, IVec2::X, IVec2::Y, IVec2::NEG_X];
        let value = |at: IVec2| values[at.y as usize * self.width + at.x as usize];
        let begin = IVec2::new(start[0] as i32, start[1] as i32);
        let (mut at, mut side) = (begin, 0);
        let mut points = Vec::new();
        loop {
            let low = at + AROUND[side];
            let inner =
                |p: IVec2| p.x > 0 && p.y > 0 && p.x + 1 < self.width as i32 && p.y + 1 < self.height as i32;
            if !inner(at) {
                return None;
            }
            if side == 0 {
                done[at.y as usize * self.width + at.x as usize] = true;
            }
            let share = (value(at) - level) / (value(at) - value(low));
            let (a, b) = (self.place(at), self.place(low));
            points.push(a.lerp(b, share.clamp(0., 1.)));
            // On to the next side of the same cell, or around the corner to the cell ahead.
            let ahead = AROUND[(side + 1) % 4];
            if value(at + ahead) <= level {
                side = (side + 1) % 4;
            } else if value(low + ahead) <= level {
                at += ahead;
            } else {
                at = low + ahead;
                side = (side + 3) % 4;
            }
            if at == begin && side == 0 {
                return Some(points);
            }
        }
    }

    fn place(&self, at: IVec2) -> DVec2 {
        self.origin + self.cell * (at.as_dvec2() + 0.5)
    }
}

/// The lower envelope of parabolas; keeps its memory from lane to lane.
#[derive(Default)]
struct Envelope {
    /// Which parabola is the lowest, the value at its middle, and up to where.
    hull: Vec<(f64, f64, f64)>,
}

impl Envelope {
    /// Puts for each i the least of `values[j]` + (i − j)².
    fn lower(&mut self, values: &mut [f64]) {
        self.hull.clear();
        for (i, &value) in values.iter().enumerate() {
            if value >= FAR * FAR {
                continue;
            }
            let at = i as f64;
            let mut from = f64::NEG_INFINITY;
            while let Some(&(last, lowest, begins)) = self.hull.last() {
                from = ((value + at * at) - (lowest + last * last)) / (2. * (at - last));
                if from > begins {
                    break;
                }
                self.hull.pop();
                from = f64::NEG_INFINITY;
            }
            self.hull.push((at, value, from));
        }
        let Some(&first) = self.hull.first() else { return };
        let (mut k, mut current) = (0, first);
        for (i, value) in values.iter_mut().enumerate() {
            let at = i as f64;
            while self.hull.get(k + 1).is_some_and(|next| next.2 <= at) {
                k += 1;
                current = self.hull[k];
            }
            *value = current.1 + (at - current.0).powi(2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster() -> Raster {
        Raster::over(DVec2::ZERO, DVec2::ONE, 40, 0.1)
    }

    fn place(raster: &Raster, i: usize) -> DVec2 {
        raster.place(IVec2::new((i % raster.width) as i32, (i / raster.width) as i32))
    }

    #[test]
    fn distances_equal_those_by_trying_all() {
        let raster = raster();
        let mut random = fastrand::Rng::with_seed(4);
        let marked: Vec<bool> = (0..raster.count()).map(|_| random.u32(0..90) == 0).collect();
        let distances = raster.distances(|i| marked[i]);
        for (i, distance) in distances.iter().enumerate() {
            let at = place(&raster, i);
            let least = (0..raster.count()).filter(|&j| marked[j]).map(|j| place(&raster, j).distance(at));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!((least - distance).abs() < 1e-9, "cell {i}: {distance}, not {least}");
        }
    }

    #[test]
    fn the_contour_of_a_disc_is_a_circle_and_two_discs_have_two() {
        let raster = raster();
        let value = |i: usize| {
            let at = place(&raster, i);
            (0.2 - at.distance(DVec2::new(0.25, 0.5))).max(0.2 - at.distance(DVec2::new(0.75, 0.5)))
        };
        let values: Vec<f64> = (0..raster.count()).map(value).collect();
        let contours = raster.contours(&values, 0.);
        assert_eq!(contours.len(), 2);
        for contour in contours {
            let area = super::super::polygon::area(&contour);
            assert!((area - std::f64::consts::PI * 0.04).abs() < 0.002, "{area}");
        }
    }
}
