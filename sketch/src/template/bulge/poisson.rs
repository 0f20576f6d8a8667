//! Poisson's equation inside a curve, by multigrid.
//!
//! Nodes beside the curve have shorter arms, to where the distance is 0 (Shortley & Weller 1938): parabolas come out
//! exactly. Each level has every other node of the one below, and keeps the slits between them; thin parts that it
//! misses are solved by the relaxation alone, which is quick where the curve is near.

/// Fewest nodes along a side of a coarser level.
const FEWEST: usize = 6;

/// Relaxations before and after a correction from the coarser level, and on the coarsest.
const BEFORE: usize = 2;
const AFTER: usize = 2;
const COARSEST: usize = 24;

/// Corrections on each level but the finest, and there.
const CYCLES: usize = 1;
const FINE_CYCLES: usize = 3;

/// Shortest arm: 0 would divide by 0.
const SHORTEST: f32 = 1e-3;

/// `∇²h = −4` where a distance is below 0, `h = 0` elsewhere; in units of a pixel.
pub(super) struct Poisson {
    /// From fine to coarse, over the part of the image that holds the inside.
    levels: Vec<Level>,
    /// Where the first node of the levels lies in the image.
    first: [usize; 2],
    image: [usize; 2],
}

/// A grid with nodes inside and outside; those on its border are outside.
struct Level {
    size: [usize; 2],
    /// Stretches of nodes in a row whose four neighbours are inside too: from and to.
    runs: Vec<[usize; 2]>,
    cuts: Vec<Cut>,
    /// What is solved for, and what should come out.
    values: Vec<f32>,
    wanted: Vec<f32>,
    left: Vec<f32>,
}

/// A node with neighbours outside.
struct Cut {
    at: usize,
    /// What the neighbours in −x, +x, −y and +y count; 0 for those outside.
    weights: [f32; 4],
    inverse: f32,
}

impl Poisson {
    /// The problem for distances at the nodes of an image, in pixels.
    pub fn new(distance: &[f32], image: [usize; 2]) -> Self {
        let (mut low, mut high) = (image, [0, 0]);
        for (y, row) in distance.chunks(image[0]).enumerate() {
            let Some(left) = row.iter().position(|d| *d < 0.0) else { continue };
            let right = row.iter().rposition(|d| *d < 0.0).unwrap_or(left);
            low = [low[0].min(left), low[1].min(y)];
            high = [high[0].max(right), high[1].max(y)];
        }
        let first = low.map(|x| x.saturating_sub(1));
        let size: [usize; 2] =
            std::array::from_fn(|a| (high[a] + 2).min(image[a]).saturating_sub(first[a]).max(1));
        let row = |y: usize| &distance[(first[1] + y) * image[0] + first[0]..][..size[0]];
        let mut nodes: Vec<f32> =
            if low[0] < image[0] { (0..size[1]).flat_map(row).copied().collect() } else { vec![1.0] };
        let mut size = if low[0] < image[0] { size } else { [1, 1] };
        let mut between = [(); 2].map(|()| vec![f32::NEG_INFINITY; nodes.len()]);
        let mut levels = vec![Level::new(&nodes, &between, size)];
        while size[0].min(size[1]) >= 2 * FEWEST {
            between = between_coarser(&nodes, &between, size);
            (nodes, size) = coarser(&nodes, size);
            let level = Level::new(&nodes, &between, size);
            if level.runs.is_empty() && level.cuts.is_empty() {
                break;
            }
            levels.push(level);
        }
        Self { levels, first, image }
    }

    /// The solution at the nodes of the image.
    pub fn solve(mut self) -> Vec<f32> {
        let coarsest = self.levels.len() - 1;
        for number in (0..=coarsest).rev() {
            let (fine, coarse) = self.levels.split_at_mut(number + 1);
            let level = &mut fine[number];
            // The square of the distance between nodes, in pixels.
            level.wanted.fill(4.0 * 4f32.powi(number as i32));
            if let Some(coarse) = coarse.first() {
                level.correct(coarse);
            }
            for _ in 0..if number == 0 { FINE_CYCLES } else { CYCLES } {
                guarded_cycle(&mut self.levels[number..]);
            }
        }
        let level = &self.levels[0];
        let mut solution = vec![0.0; self.image[0] * self.image[1]];
        for (y, row) in level.values.chunks(level.size[0]).enumerate() {
            let start = (self.first[1] + y) * self.image[0] + self.first[0];
            solution[start..start + row.len()].copy_from_slice(row);
        }
        solution
    }
}

/// As [`cycle`], but never for the worse: outside of slits that coarser levels do not see, corrections can grow without
/// bound. Of one that leaves more to be done than before, the share is kept that leaves the least.
fn guarded_cycle(levels: &mut [Level]) {
    levels[0].look_back();
    let (values, left) = (levels[0].values.clone(), levels[0].left.clone());
    cycle(levels);
    let level = &mut levels[0];
    level.look_back();
    let sum = |of: &dyn Fn(usize) -> f64| (0..left.len()).map(of).sum::<f64>();
    let [before, after] = [&left, &level.left].map(|left| sum(&|i| f64::from(left[i]).powi(2)));
    if after <= before {
        return;
    }
    // What is left changes linearly on the way from the values before to those after.
    let change = |i: usize| f64::from(left[i]) - f64::from(level.left[i]);
    let share = sum(&|i| f64::from(left[i]) * change(i)) / sum(&|i| change(i).powi(2));
    let share = if share.is_finite() { share.clamp(0.0, 1.0) as f32 } else { 0.0 };
    for (value, old) in level.values.iter_mut().zip(values) {
        *value = if share > 0.0 { old + share * (*value - old) } else { old };
    }
    (0..COARSEST).for_each(|_| level.relax());
}

/// One correction of the first level by all coarser ones.
fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    if coarser.is_empty() {
        (0..COARSEST).for_each(|_| level.relax());
        return;
    }
    (0..BEFORE).for_each(|_| level.relax());
    level.look_back();
    coarser[0].ask(level);
    cycle(coarser);
    level.correct(&coarser[0]);
    (0..AFTER).for_each(|_| level.relax());
}

/// Every other node, from the first, and what lies beyond the last as outside.
fn coarser(nodes: &[f32], size: [usize; 2]) -> (Vec<f32>, [usize; 2]) {
    let half = size.map(|n| n / 2 + 1);
    let at = |i: usize| {
        let [x, y] = [2 * (i % half[0]), 2 * (i / half[0])];
        let inner = x + 1 < size[0] && y + 1 < size[1] && x > 0 && y > 0;
        if inner {
            0.5 * nodes[y * size[0] + x]
        } else {
            0.5 * nodes[y.min(size[1] - 1) * size[0] + x.min(size[0] - 1)].max(1.0)
        }
    };
    ((0..half[0] * half[1]).map(at).collect(), half)
}

/// The largest distance on the way from each coarser node to the one in +x, and to the one in +y: slits between nodes
/// that are both inside.
fn between_coarser(nodes: &[f32], between: &[Vec<f32>; 2], size: [usize; 2]) -> [Vec<f32>; 2] {
    let half = size.map(|n| n / 2 + 1);
    let way = |a: usize, i: usize| {
        let at = [2 * (i % half[0]), 2 * (i / half[0])];
        let middle = [at[0] + usize::from(a == 0), at[1] + usize::from(a == 1)];
        if middle[0] >= size[0] || middle[1] >= size[1] {
            return f32::NEG_INFINITY;
        }
        let [from, middle] = [at, middle].map(|[x, y]| y * size[0] + x);
        0.5 * between[a][from].max(nodes[middle]).max(between[a][middle])
    };
    [0, 1].map(|a| (0..half[0] * half[1]).map(|i| way(a, i)).collect())
}

impl Level {
    fn new(distance: &[f32], between: &[Vec<f32>; 2], size: [usize; 2]) -> Self {
        let [width, height] = size;
        let (mut runs, mut cuts): (Vec<[usize; 2]>, Vec<Cut>) = (Vec::new(), Vec::new());
        for y in 1..height.saturating_sub(1) {
            for i in y * width + 1..(y + 1) * width - 1 {
                if distance[i] >= 0.0 {
                    continue;
                }
                let ways = [between[0][i - 1], between[0][i], between[1][i - width], between[1][i]];
                let mut beside = [i - 1, i + 1, i - width, i + width].map(|n| distance[n]);
                for (beside, way) in beside.iter_mut().zip(ways) {
                    if *beside < 0.0 && way >= 0.0 {
                        // An arm to the curve somewhere on the first half of the way.
                        *beside = 2.0 * way - distance[i];
                    }
                }
                if beside.iter().any(|d| *d >= 0.0) {
                    cuts.push(Cut::new(i, distance[i], beside));
                } else if let Some(run) = runs.last_mut().filter(|run| run[1] == i) {
                    run[1] = i + 1;
                } else {
                    runs.push([i, i + 1]);
                }
            }
        }
        let nodes = width * height;
        Self { size, runs, cuts, values: vec![0.0; nodes], wanted: vec![0.0; nodes], left: vec![0.0; nodes] }
    }

    /// Solves each node for its neighbours: first those of one colour of a chessboard, then the others.
    fn relax(&mut self) {
        let width = self.size[0];
        for colour in 0..2 {
            for &[from, to] in &self.runs {
                let row = from / width * width;
                let first = from + (from - row + row / width + colour) % 2;
                let (above, rest) = self.values.split_at_mut(row);
                let (line, below) = rest.split_at_mut(width);
                let (above, below) = (&above[row - width..], &below[..width]);
                let wanted = &self.wanted[row..row + width];
                let mut x = first - row;
                let end = to - row;
                while x < end {
                    line[x] = 0.25 * ((line[x - 1] + line[x + 1]) + (above[x] + below[x]) + wanted[x]);
                    x += 2;
                }
            }
            for cut in self.cuts.iter().filter(|cut| (cut.at % width + cut.at / width) % 2 == colour) {
                self.values[cut.at] = cut.inverse * (cut.pull(&self.values, width) + self.wanted[cut.at]);
            }
        }
    }

    /// What is left to be done at each node.
    fn look_back(&mut self) {
        let width = self.size[0];
        for &[from, to] in &self.runs {
            let side = |by: usize| (&self.values[from - by..to - by], &self.values[from + by..to + by]);
            let ((before, after), (above, below)) = (side(1), side(width));
            let (values, wanted) = (&self.values[from..to], &self.wanted[from..to]);
            for (i, left) in self.left[from..to].iter_mut().enumerate() {
                *left = wanted[i] + (before[i] + after[i]) + (above[i] + below[i]) - 4.0 * values[i];
            }
        }
        for cut in &self.cuts {
            let left =
                cut.pull(&self.values, width) + self.wanted[cut.at] - self.values[cut.at] / cut.inverse;
            // As if it had four whole arms: short ones would shout down all others.
            self.left[cut.at] = 4.0 * cut.inverse * left;
        }
    }

    /// Calls `act` with node, column and row of every node inside.
    fn each(runs: &[[usize; 2]], cuts: &[Cut], width: usize, mut act: impl FnMut(usize, usize, usize)) {
        for &[from, to] in runs {
            let (row, first) = (from / width, from % width);
            (from..to).zip(first..).for_each(|(i, column)| act(i, column, row));
        }
        cuts.iter().for_each(|cut| act(cut.at, cut.at % width, cut.at / width));
    }

    /// Wants what is left of the finer level, a mean of nine nodes, and starts from 0.
    fn ask(&mut self, finer: &Self) {
        self.values.fill(0.0);
        let (fine, left, wanted) = (finer.size[0], &finer.left, &mut self.wanted);
        Self::each(&self.runs, &self.cuts, self.size[0], |i, x, y| {
            let at = 2 * (y * fine + x);
            let row = |at: usize| left[at - 1] + 2.0 * left[at] + left[at + 1];
            // Nodes are twice as far apart: four times as much.
            wanted[i] = 0.25 * (row(at - fine) + 2.0 * row(at) + row(at + fine));
        });
    }

    /// Adds the values of the coarser level, linearly between its nodes.
    fn correct(&mut self, coarser: &Self) {
        let (coarse, from, values) = (coarser.size[0], &coarser.values, &mut self.values);
        Self::each(&self.runs, &self.cuts, self.size[0], |i, x, y| {
            let at = y / 2 * coarse + x / 2;
            let (right, down) = (x % 2, y % 2 * coarse);
            values[i] += 0.25 * ((from[at] + from[at + right]) + (from[at + down] + from[at + down + right]));
        });
    }
}

impl Cut {
    fn new(at: usize, here: f32, beside: [f32; 4]) -> Self {
        let arm = |d: f32| if d < 0.0 { 1.0 } else { (here / (here - d)).max(SHORTEST) };
        let arms = beside.map(arm);
        let along = |a: usize| 2.0 / (arms[a] + arms[a ^ 1]);
        let weights = std::array::from_fn(|a| if beside[a] < 0.0 { along(a) / arms[a] } else { 0.0 });
        let own = along(0) / arms[0] + along(1) / arms[1] + along(2) / arms[2] + along(3) / arms[3];
        Self { at, weights, inverse: own.recip() }
    }

    /// What the neighbours add up to.
    fn pull(&self, values: &[f32], width: usize) -> f32 {
        let at = self.at;
        let [left, right, above, below] = self.weights;
        (left * values[at - 1] + right * values[at + 1])
            + (above * values[at - width] + below * values[at + width])
    }
}
