//! The greatest value within reach in a layer: grey dilation by a disc of at most one lattice step.

/// Cosine and sine of 22.5°, and of 45°.
const C22: f32 = 0.923_879_5;
const S22: f32 = 0.382_683_43;
const C45: f32 = 0.707_106_77;

/// A layer's values, row by row; beyond its border the nearest value goes on.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub width: usize,
    pub values: Vec<f32>,
}

impl Layer {
    /// A layer of one value.
    pub fn new(width: usize, depth: usize, value: f32) -> Self {
        Self { width, values: vec![value; width * depth] }
    }

    /// The values along x in this row; of the nearest row for one beyond the border.
    pub fn row(&self, row: isize) -> &[f32] {
        let last = (self.values.len() / self.width) as isize - 1;
        let start = row.clamp(0, last) as usize * self.width;
        &self.values[start..start + self.width]
    }

    /// Writes, for each place of a row, the least value as far as `reach` steps from it along x and y.
    pub fn least(&self, row: usize, reach: usize, out: &mut Vec<f32>) {
        let mut lowest = self.row(row as isize).to_vec();
        for other in (1..=reach as isize).flat_map(|by| [row as isize - by, row as isize + by]) {
            let values = self.row(other);
            lowest.iter_mut().zip(values).for_each(|(lowest, value)| *lowest = lowest.min(*value));
        }
        out.clear();
        out.extend_from_slice(&lowest);
        for by in 1..=reach.min(lowest.len() - 1) {
            let [first, last] = [by, lowest.len() - by];
            out[..last].iter_mut().zip(&lowest[first..]).for_each(|(out, value)| *out = out.min(*value));
            out[first..].iter_mut().zip(&lowest[..last]).for_each(|(out, value)| *out = out.min(*value));
        }
    }

    /// The greatest values within reach, as [`dilate_row`] finds them.
    pub fn dilated(&self, radius: f32) -> Self {
        let mut all = self.clone();
        let rows = all.values.chunks_exact_mut(self.width).enumerate();
        rows.for_each(|(y, row)| dilate_row(self, y, radius, row));
        all
    }

    /// The least values within reach.
    pub fn eroded(&self, radius: f32) -> Self {
        let mut negative = self.clone();
        negative.values.iter_mut().for_each(|value| *value = -*value);
        let mut all = negative.dilated(radius);
        all.values.iter_mut().for_each(|value| *value = -*value);
        all
    }
}

/// Writes, for each place of a row, the greatest value of `layer` on the circle of `radius` steps, at most 1, around
/// it and in its middle.
///
/// The circle is looked at in 16 directions, between places by bilinear interpolation, which never overshoots. So a
/// straight front moves by 0.981 to 1 times the radius, whatever its direction.
pub(super) fn dilate_row(layer: &Layer, row: usize, radius: f32, out: &mut [f32]) {
    let row = row as isize;
    let (south, here, north) = (layer.row(row - 1), layer.row(row), layer.row(row + 1));
    let last = out.len() - 1;
    let at = |x: usize, before: usize, after: usize| {
        let rows = [south, here, north].map(|row| [row[before], row[x], row[after]]);
        greatest(rows, radius)
    };
    out[0] = at(0, 0, 1.min(last));
    out[last] = at(last, last.saturating_sub(1), last);
    let rows = south.windows(3).zip(here.windows(3)).zip(north.windows(3));
    for (out, ((s, h), n)) in out[1..].iter_mut().zip(rows) {
        *out = greatest([[s[0], s[1], s[2]], [h[0], h[1], h[2]], [n[0], n[1], n[2]]], radius);
    }
}

/// The greatest value on the circle around the middle one, and in it, of 3 × 3 places.
#[inline(always)]
pub(super) fn greatest([south, here, north]: [[f32; 3]; 3], radius: f32) -> f32 {
    let middle = here[1];
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let [c22, s22, c45] = [radius * C22, radius * S22, radius * C45];
    let quadrant = |side: f32, ahead: f32, corner: f32| {
        let slanted = |x: f32, y: f32| {
            (1.0 - y) * ((1.0 - x) * middle + x * side) + y * ((1.0 - x) * ahead + x * corner)
        };
        larger(larger(slanted(c22, s22), slanted(s22, c22)), slanted(c45, c45))
    };
    let axes = larger(larger(here[0], here[2]), larger(south[1], north[1]));
    let axes = radius * axes + (1.0 - radius) * middle;
    let northern = larger(quadrant(here[2], north[1], north[2]), quadrant(here[0], north[1], north[0]));
    let southern = larger(quadrant(here[2], south[1], south[2]), quadrant(here[0], south[1], south[0]));
    larger(larger(middle, axes), larger(northern, southern))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_fronts_move_by_the_radius_in_every_direction() {
        for degrees in (0..360).step_by(5) {
            let (sin, cos) = (degrees as f32).to_radians().sin_cos();
            let mut layer = Layer::new(9, 9, 0.0);
            for (i, value) in layer.values.iter_mut().enumerate() {
                *value = cos * (i % 9) as f32 + sin * (i / 9) as f32;
            }
            let mut out = [0.0; 9];
            dilate_row(&layer, 4, 1.0, &mut out);
            let moved = out[4] - layer.values[4 * 9 + 4];
            assert!((0.980..=1.000_1).contains(&moved), "{degrees}°: {moved}");
        }
    }

    #[test]
    fn nothing_is_lost_or_made_up() {
        let mut rng = fastrand::Rng::with_seed(1);
        let mut layer = Layer::new(12, 7, 0.0);
        layer.values.iter_mut().for_each(|value| *value = rng.f32());
        let mut out = [0.0; 12];
        for row in 0..7 {
            dilate_row(&layer, row, 0.98, &mut out);
            for (x, value) in out.iter().enumerate() {
                let near = |r: isize| &layer.row(r)[x.saturating_sub(1)..(x + 2).min(12)];
                let rows = [row as isize - 1, row as isize, row as isize + 1];
                let most = rows.iter().flat_map(|r| near(*r)).fold(0.0f32, |a, b| a.max(*b));
                assert!(*value >= layer.row(row as isize)[x] && *value <= most, "{row}, {x}");
            }
        }
    }
}
