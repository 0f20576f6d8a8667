//! The distances at which the field of a template takes the values that the fit keeps to.

/// Distances, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels {
    /// The largest distance inside.
    pub depth: f64,
    /// Where the field ends outside: `g⁻¹(0)`.
    pub falloff: f64,
    /// Outside, where the field is a quarter: `g⁻¹(0.5 v)` for the surface at `v = ½`.
    pub between: f64,
    /// Inside, where the field is three quarters, `g⁻¹(1.5 v)`; above 0.
    pub inner: f64,
}

/// Where `(1 − e²)³` takes a value.
fn inverse(value: f64) -> f64 {
    (1.0 - value.cbrt()).sqrt()
}

impl Levels {
    /// The levels for a falloff of this width; without one, for the natural falloff, whose field reaches 1
    /// exactly at the deepest place.
    pub fn new(depth: f64, falloff: Option<f64>) -> Self {
        let half = inverse(0.5);
        let falloff = falloff.unwrap_or(depth * (1.0 - half) / half);
        let reach = falloff / (1.0 - half);
        Self {
            depth,
            falloff,
            between: reach * (inverse(0.25) - half),
            inner: reach * (half - inverse(0.75)),
        }
    }

    /// The signed distances whose contours carry constraints: the paper's three, and so many between them that
    /// each is about twice as far from the curve as the one before. Nearer than a tenth of the depth,
    /// the curve itself says enough.
    pub fn contours(&self) -> Vec<f64> {
        let least = 0.1 * self.depth;
        let mut levels = vec![self.falloff.max(least)];
        for level in [self.between, 0.35 * self.depth, 0.75 * self.depth] {
            if level >= least && levels.iter().all(|l| !(0.6..1.6).contains(&(l / level))) {
                levels.push(level);
            }
        }
        let inner = self.inner.clamp(least, 0.6 * self.depth);
        levels.push(-inner);
        if inner < 0.3 * self.depth {
            levels.push(-0.6 * self.depth);
        }
        // Around the deepest places, so that the spline does not flatten there.
        levels.push(-0.9 * self.depth);
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_levels_are_where_the_field_has_the_papers_values() {
        for (depth, falloff) in [(3.0, None), (3.0, Some(0.5)), (0.2, Some(7.0))] {
            let levels = Levels::new(depth, falloff);
            let reach = levels.falloff / (1.0 - inverse(0.5));
            let core = reach - levels.falloff;
            let field = |distance: f64| (1.0 - ((distance + core).max(0.0) / reach).powi(2)).max(0.0).powi(3);
            for (distance, value) in
                [(levels.falloff, 0.0), (levels.between, 0.25), (0.0, 0.5), (-levels.inner, 0.75)]
            {
                assert!((field(distance) - value).abs() < 1e-12);
            }
            assert_eq!(levels.falloff, falloff.unwrap_or(levels.falloff));
        }
        let natural = Levels::new(10.0, None);
        assert!((natural.falloff - 12.017).abs() < 1e-3);
    }
}
