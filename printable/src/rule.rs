//! The support rule's two numbers.

/// Height of a layer, mm; 0.02 to 2.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct LayerHeight(f32);

impl LayerHeight {
    /// Errors: [`RuleError::LayerHeight`] outside 0.02 to 2 mm (so NaN is refused too).
    pub fn from_mm(mm: f32) -> Result<Self, RuleError> {
        if (0.02..=2.0).contains(&mm) { Ok(Self(mm)) } else { Err(RuleError::LayerHeight { mm }) }
    }

    /// In mm.
    pub fn mm(self) -> f32 {
        self.0
    }
}

/// Largest overhang that prints without support, in radians from the vertical; 20° to 70°.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct OverhangAngle(f32);

impl OverhangAngle {
    /// Errors: [`RuleError::OverhangAngle`] outside 20° to 70° (so NaN is refused too).
    pub fn from_degrees(degrees: f32) -> Result<Self, RuleError> {
        if (20.0..=70.0).contains(&degrees) {
            Ok(Self(degrees.to_radians()))
        } else {
            Err(RuleError::OverhangAngle { degrees })
        }
    }

    /// In radians.
    pub fn radians(self) -> f32 {
        self.0
    }

    /// In degrees.
    pub fn degrees(self) -> f32 {
        self.0.to_degrees()
    }
}

/// What a printer can make without supports.
///
/// **Source:** Reiner & Lefebvre 2016, equation 1. The default is theirs: 0.25 mm and 45°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportRule {
    /// Height of a layer.
    pub layer_height: LayerHeight,
    /// Largest overhang.
    pub overhang: OverhangAngle,
}

impl SupportRule {
    /// Errors: a layer height outside 0.02 to 2 mm, an angle outside 20° to 70°.
    pub fn new(layer_height_mm: f32, overhang_degrees: f32) -> Result<Self, RuleError> {
        let layer_height = LayerHeight::from_mm(layer_height_mm)?;
        let overhang = OverhangAngle::from_degrees(overhang_degrees)?;
        Ok(Self { layer_height, overhang })
    }

    /// How far a layer may reach beyond the one below: `r = h · tan θ`, mm.
    pub fn reach_mm(self) -> f32 {
        self.layer_height.mm() * self.overhang.radians().tan()
    }
}

impl Default for SupportRule {
    fn default() -> Self {
        Self { layer_height: LayerHeight(0.25), overhang: OverhangAngle(std::f32::consts::FRAC_PI_4) }
    }
}

/// Why a support rule cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RuleError {
    /// No printer makes such layers.
    #[error("layer height is {mm} mm, not 0.02 to 2 mm; 0.2 mm suits most printers")]
    LayerHeight {
        /// As asked for.
        mm: f32,
    },
    /// The overhang angle is outside what the rule can keep.
    #[error("overhang angle is {degrees}°, not 20° to 70°; 45° suits most printers")]
    OverhangAngle {
        /// As asked for, from the vertical.
        degrees: f32,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reach_is_that_of_equation_1_and_numbers_out_of_range_are_refused() {
        assert!((SupportRule::default().reach_mm() - 0.25).abs() < 1e-7);
        let steep = SupportRule::new(0.2, 60.0).expect("legal");
        assert!((steep.reach_mm() - 0.2 * 3.0_f32.sqrt()).abs() < 1e-6);
        for mm in [0.0, -0.2, 0.019, 2.1, f32::NAN, f32::INFINITY] {
            assert!(matches!(SupportRule::new(mm, 45.0), Err(RuleError::LayerHeight { .. })), "{mm}");
        }
        for degrees in [19.9, 70.1, -45.0, f32::NAN] {
            assert!(
                matches!(SupportRule::new(0.2, degrees), Err(RuleError::OverhangAngle { .. })),
                "{degrees}"
            );
        }
    }
}
