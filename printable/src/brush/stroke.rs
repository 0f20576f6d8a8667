//! From a pen's samples to dabs.

use blobtree::BrushStroke;
use glam::Vec3;

/// Most dabs in a stroke.
pub const MAX_DABS: usize = 100_000;

/// The tip at a place, at a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dab {
    center: Vec3,
    radius: f32,
    strength: f32,
}

/// Why there is no dab, or no stroke.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DabError {
    /// The place is not one.
    #[error("the brush is at {center}, which is no place; coordinates must be finite")]
    Center {
        /// As asked for, mm.
        center: Vec3,
    },
    /// The size is not one.
    #[error("the brush has a radius of {radius} mm, not 0.001 to 1000 mm")]
    Radius {
        /// As asked for, mm.
        radius: f32,
    },
    /// The strength is not one.
    #[error("the brush has a strength of {strength}, not 0 to 1")]
    Strength {
        /// As asked for.
        strength: f32,
    },
    /// The stroke is too long for its spacing.
    #[error(
        "the stroke takes {dabs} dabs, more than {MAX_DABS}; draw it in parts, or with a larger brush or spacing"
    )]
    TooLong {
        /// How many it would take.
        dabs: usize,
    },
}

impl Dab {
    /// A dab of the tip at `center` (mm), scaled by `radius` (mm).
    ///
    /// `strength`, 0 to 1, is how far the surface moves at most, in radii: a tip pushed into a surface at a strength
    /// of 0.1 takes only a skin off it. At 1 the whole tip counts. When smoothing, it is a third for each pass.
    ///
    /// Errors: a place that is not finite, a radius outside 0.001 to 1000 mm, a strength outside 0 to 1.
    pub fn new(center: Vec3, radius: f32, strength: f32) -> Result<Self, DabError> {
        if !center.is_finite() {
            return Err(DabError::Center { center });
        }
        if !(0.001..=1000.0).contains(&radius) {
            return Err(DabError::Radius { radius });
        }
        if !(0.0..=1.0).contains(&strength) {
            return Err(DabError::Strength { strength });
        }
        Ok(Self { center, radius, strength })
    }

    /// The middle of the tip, mm.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// The tip's radius, mm.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// How far the surface moves at most, in radii.
    pub fn strength(&self) -> f32 {
        self.strength
    }
}

/// The dabs of a stroke as scenes keep it.
///
/// Errors: as [`StrokeShape::dabs`].
pub fn dabs_of(stroke: &BrushStroke) -> Result<Vec<Dab>, DabError> {
    let shape = StrokeShape {
        radius: PressureRange { light: stroke.light_radius.unwrap_or(stroke.radius), full: stroke.radius },
        strength: PressureRange {
            light: stroke.light_strength.unwrap_or(stroke.strength),
            full: stroke.strength,
        },
        spacing: stroke.spacing.unwrap_or(1.0),
    };
    let sample = |(n, place): (usize, &Vec3)| StrokeSample { place: *place, pressure: stroke.pressure(n) };
    let samples: Vec<StrokeSample> = stroke.places.iter().enumerate().map(sample).collect();
    if stroke.spacing.is_some() {
        return shape.dabs(&samples);
    }
    samples.iter().map(|sample| shape.dab(sample.place, sample.pressure)).collect()
}

/// What a quantity is at no pressure and at full pressure; in between it is linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureRange {
    /// At pressure 0.
    pub light: f32,
    /// At pressure 1.
    pub full: f32,
}

impl PressureRange {
    /// The same at any pressure.
    pub fn always(value: f32) -> Self {
        Self { light: value, full: value }
    }

    /// At this pressure; one outside 0 to 1 is taken for the nearest, and one that is not a number for 0.
    fn at(self, pressure: f32) -> f32 {
        self.light + (self.full - self.light) * pressure.clamp(0.0, 1.0).max(0.0)
    }
}

/// A sample of the pen on the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeSample {
    /// Where, mm.
    pub place: Vec3,
    /// How hard, 0 to 1; 1 for a mouse.
    pub pressure: f32,
}

/// How samples become dabs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeShape {
    /// The tip's radius, mm.
    pub radius: PressureRange,
    /// The strength, 0 to 1.
    pub strength: PressureRange,
    /// Distance from dab to dab, in radii; at least 0.01 is taken.
    pub spacing: f32,
}

impl StrokeShape {
    /// The dabs of a stroke: one at its beginning, and then one for each spacing along the line through the samples.
    /// Samples that are not finite are passed over; a stroke of a single place is one dab.
    ///
    /// Errors: radii and strengths that [`Dab::new`] refuses; more than [`MAX_DABS`].
    pub fn dabs(&self, samples: &[StrokeSample]) -> Result<Vec<Dab>, DabError> {
        let mut samples = samples.iter().filter(|sample| sample.place.is_finite());
        let Some(first) = samples.next() else { return Ok(Vec::new()) };
        let mut dabs = vec![self.dab(first.place, first.pressure)?];
        let mut last = first;
        // How far the pen is to go before the next dab, mm.
        let mut ahead = self.step(&dabs[0]);
        for next in samples {
            let way = next.place - last.place;
            let length = way.length();
            let mut done = ahead;
            while done <= length {
                if dabs.len() == MAX_DABS {
                    let more = (length - done) / self.step(&dabs[MAX_DABS - 1]);
                    return Err(DabError::TooLong { dabs: MAX_DABS + 1 + more as usize });
                }
                let share = done / length.max(f32::MIN_POSITIVE);
                let pressure = last.pressure + (next.pressure - last.pressure) * share;
                let dab = self.dab(last.place + way * share, pressure)?;
                done += self.step(&dab);
                dabs.push(dab);
            }
            ahead = done - length;
            last = next;
        }
        Ok(dabs)
    }

    fn dab(&self, place: Vec3, pressure: f32) -> Result<Dab, DabError> {
        Dab::new(place, self.radius.at(pressure), self.strength.at(pressure))
    }

    fn step(&self, dab: &Dab) -> f32 {
        dab.radius * self.spacing.max(0.01)
    }
}
