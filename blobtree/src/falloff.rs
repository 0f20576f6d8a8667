//! From distances to field values.

/// `√(1 − ½^⅓)`: where `(1 − t²)³` is one half, as a share of the support radius.
pub const HALF_AT: f32 = 0.454_202_34;

/// How a distance becomes a field value: `g(max(0, sd + core))` with `g(e) = (1 − e²/reach²)³`.
///
/// `sd` is the signed distance to the surface, so that the value is exactly ½ on it.
///
/// **Source:** Schmidt & Wyvill 2011, eq. 3. **Departs:** the paper ties the width of the influence to the
/// size of the skeleton's hull; here it is a parameter of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// Depth below the surface at which the field reaches 1, mm.
    pub core: f32,
    /// Distance from there to where the field ends, mm.
    pub reach: f32,
}

impl Falloff {
    /// The falloff whose influence ends `width` mm outside the surface.
    pub fn of_width(width: f32) -> Self {
        let reach = width / (1.0 - HALF_AT);
        Self { core: reach * HALF_AT, reach }
    }

    /// The falloff whose field reaches 1 exactly `depth` mm below the surface: the paper's skeletal
    /// primitive, where `depth` is the distance from the surface to the skeleton.
    pub fn of_depth(depth: f32) -> Self {
        Self { core: depth, reach: depth / HALF_AT }
    }

    /// `width` mm where one is given, else the natural falloff for a shape `depth` mm deep.
    pub fn new(width: Option<f32>, depth: f32) -> Self {
        width.map_or_else(|| Self::of_depth(depth), Self::of_width)
    }

    /// How far the influence reaches outside the surface, mm.
    pub fn width(&self) -> f32 {
        self.reach - self.core
    }
}

/// The larger of two numbers that are not NaN: one instruction, which `f32::max` is not.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are not NaN.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn cube(t: f32) -> f32 {
    t * t * t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(falloff: Falloff, sd: f32) -> f32 {
        let e = larger(sd + falloff.core, 0.0);
        cube(larger(1.0 - e * e / (falloff.reach * falloff.reach), 0.0))
    }

    #[test]
    fn the_surface_is_at_one_half_and_the_width_is_where_it_ends() {
        for width in [0.1, 1.0, 7.5, 300.0] {
            let falloff = Falloff::of_width(width);
            assert!((value(falloff, 0.0) - 0.5).abs() < 1e-6);
            assert_eq!(value(falloff, width * 1.000_001), 0.0);
            assert!(value(falloff, width * 0.99) > 0.0);
            assert!((falloff.width() - width).abs() < 1e-5 * width);
        }
        let natural = Falloff::of_depth(10.0);
        assert!((value(natural, -10.0) - 1.0).abs() < 1e-6 && (value(natural, 0.0) - 0.5).abs() < 1e-6);
    }
}
