//! Contours of a sampled function, traced and sampled by arc length.

use crate::thin_plate::Grid;
use glam::DVec2;

/// Places on the contours where a function sampled on a grid takes a level, about `spacing` apart along them.
/// Every contour gives at least one, and those that go around at least three.
pub(super) fn sample(values: &[f64], grid: &Grid, level: f64, spacing: f64) -> Vec<DVec2> {
    let mut places = Vec::new();
    for line in trace(values, grid, level) {
        let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
        let count = (length / spacing).round().max(3.0);
        let step = length / count;
        let mut ahead = 0.5 * step;
        for w in line.windows(2) {
            let piece = w[0].distance(w[1]);
            while ahead < piece {
                places.push(w[0].lerp(w[1], ahead / piece));
                ahead += step;
            }
            ahead -= piece;
        }
    }
    places
}

/// The contours as lines of places; a closed one ends where it begins.
fn trace(values: &[f64], grid: &Grid, level: f64) -> Vec<Vec<DVec2>> {
    let mut steps = steps(values, grid, level);
    steps.sort_unstable_by_key(|step| step.from);
    let next = |edge: usize| steps.binary_search_by_key(&edge, |step| step.from).ok();
    let mut entered = vec![false; steps.len()];
    for step in &steps {
        if let Some(next) = next(step.to) {
            entered[next] = true;
        }
    }
    let mut done = vec![false; steps.len()];
    let mut lines = Vec::new();
    // Lines that come in at the border first, then those that go around.
    let starts = (0..steps.len()).filter(|&i| !entered[i]).chain((0..steps.len()).filter(|&i| entered[i]));
    for start in starts {
        if done[start] {
            continue;
        }
        let mut line = vec![place(values, grid, level, steps[start].from)];
        let mut current = Some(start);
        while let Some(i) = current.filter(|&i| !done[i]) {
            done[i] = true;
            line.push(place(values, grid, level, steps[i].to));
            current = next(steps[i].to);
        }
        lines.push(line);
    }
    lines
}

/// A contour's way through a cell, from one crossed edge to another, with what is below the level to its left.
/// Edges are numbered by twice the sample they begin at, plus 1 for those along y.
struct Step {
    from: usize,
    to: usize,
}

fn steps(values: &[f64], grid: &Grid, level: f64) -> Vec<Step> {
    let [width, height] = grid.size;
    let mut steps = Vec::new();
    for y in 0..height.saturating_sub(1) {
        for x in 0..width.saturating_sub(1) {
            let at = y * width + x;
            // Counter-clockwise from the lowest x and y; edge i leads from corner i to the next.
            let corners = [at, at + 1, at + width + 1, at + width];
            let below = corners.map(|corner| values[corner] < level);
            let crossed = (0..4).filter(|&i| below[i] != below[(i + 1) % 4]).count();
            if crossed == 0 {
                continue;
            }
            let edges = [2 * at, 2 * (at + 1) + 1, 2 * (at + width), 2 * at + 1];
            let joined = crossed == 4 && corners.iter().map(|&c| values[c]).sum::<f64>() < 4.0 * level;
            for i in (0..4).filter(|&i| below[i] && !below[(i + 1) % 4]) {
                // Leaves by the edge where what is below begins: the last one before i, or, where two corners
                // below are joined through the middle, the next one after.
                let back = |k: usize| !below[(i + k) % 4] && below[(i + k + 1) % 4];
                let exits: Vec<usize> = (1..4).filter(|&k| back(k)).collect();
                let exit = if joined { exits.first() } else { exits.last() };
                steps.extend(exit.map(|k| Step { from: edges[i], to: edges[(i + k) % 4] }));
            }
        }
    }
    steps
}

fn place(values: &[f64], grid: &Grid, level: f64, edge: usize) -> DVec2 {
    let width = grid.size[0];
    let from = edge / 2;
    let to = if edge.is_multiple_of(2) { from + 1 } else { from + width };
    let share = (level - values[from]) / (values[to] - values[from]);
    let [from, to] = [from, to].map(|i| grid.at(i % width, i / width));
    from.lerp(to, share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contours_of_two_discs_are_sampled_evenly() {
        let grid = Grid { origin: DVec2::splat(-4.0), pixel: 0.05, size: [200, 160] };
        let centres = [DVec2::ZERO, DVec2::new(4.0, 1.0)];
        let distance = |p: DVec2| centres.map(|c| p.distance(c) - 1.0).into_iter().fold(f64::MAX, f64::min);
        let values: Vec<f64> = (0..200 * 160).map(|i| distance(grid.at(i % 200, i / 200))).collect();
        let lines = trace(&values, &grid, 0.5);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| line.first() == line.last()));
        let places = sample(&values, &grid, 0.5, 0.25);
        assert_eq!(places.len(), 2 * (3.0 * std::f64::consts::PI / 0.25).round() as usize);
        assert!(places.iter().all(|p| (distance(*p) - 0.5).abs() < 2e-3));
        for c in centres {
            let area: f64 = lines
                .iter()
                .filter(|line| line[0].distance(c) < 2.0)
                .flat_map(|line| line.windows(2))
                .map(|w| 0.5 * (w[0] - c).perp_dot(w[1] - c))
                .sum();
            assert!((area - 2.25 * std::f64::consts::PI).abs() < 0.01, "{area}");
        }
    }

    #[test]
    fn saddles_and_open_ends_are_followed_through() {
        let grid = Grid { origin: DVec2::ZERO, pixel: 1.0, size: [3, 2] };
        for middle in [0.1, 0.9] {
            let values = [0.0, 1.0, 0.0, 1.0 + middle, 0.0, 1.0 + middle];
            let lines = trace(&values, &grid, 0.6);
            let pieces: usize = lines.iter().map(|line| line.len() - 1).sum();
            assert_eq!(pieces, 4);
        }
    }
}
