//! What a pen leaves behind: samples, cleaned, kept as a sketch, read from files.
//!
//! A [`Stroke`] is one movement of the pen as a device reports it, in pixels with y down. [`clean()`] takes out
//! what no hand drew. A [`Sketch`] holds the strokes of one drawing and what the eraser and the smoothing
//! gesture did to them; a [`Placement`] turns it into a [`blobtree::Drawing`] in mm with y up. [`read()`] takes
//! strokes from files. What strokes mean is decided elsewhere: by the curve that is fitted to them, by
//! [`crate::gesture`] and by [`crate::suggest`].

mod clean;
mod eraser;
mod placement;
mod read;
mod sketch;

pub use clean::{MAX_COORDINATE, clean, resample};
pub use eraser::ERASER_WIDTH;
pub use placement::{MAX_DRAWN_POINTS, Placement, Standing};
pub use read::{
    DoodleChoice, FileFormat, MAX_FILE_BYTES, MAX_SAMPLES, MAX_STROKES, ReadError, ReadProblem,
    STROKES_VERSION, detect, read, write_strokes,
};
pub(crate) use sketch::is_inside;
pub use sketch::{MAX_SMOOTHING, OrientedBox, Sketch, SketchSample, SketchStroke};

use glam::Vec2;

/// A place of the pen, as the device reports it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenSample {
    /// Pixels from the left edge of the screen.
    pub x: f32,
    /// Pixels from the top edge of the screen, downwards.
    pub y: f32,
    /// When, in seconds from any start; `None` if the device or the file does not say.
    pub time: Option<f32>,
    /// How hard the pen pressed, 0 to 1; 1 for devices that cannot tell.
    pub pressure: f32,
    /// How far the pen leaned to the right and towards the user, degrees; 0 for devices that cannot tell.
    pub tilt: [f32; 2],
}

impl PenSample {
    /// A sample at a place, pixels, of a device that tells nothing else.
    pub fn at(place: Vec2) -> Self {
        Self { x: place.x, y: place.y, time: None, pressure: 1.0, tilt: [0.0; 2] }
    }

    /// The place, pixels.
    pub fn place(&self) -> Vec2 {
        Vec2::new(self.x, self.y)
    }
}

/// One movement of the pen, from touching down to lifting off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stroke {
    /// The samples in the order in which they came.
    pub samples: Vec<PenSample>,
    /// Whether the pen was held by its eraser end.
    pub eraser: bool,
}

impl Stroke {
    /// A stroke through these places, pixels, without times.
    pub fn through(places: impl IntoIterator<Item = Vec2>) -> Self {
        Self { samples: places.into_iter().map(PenSample::at).collect(), eraser: false }
    }

    /// The places of the samples, pixels.
    pub fn places(&self) -> impl ExactSizeIterator<Item = Vec2> + Clone {
        self.samples.iter().map(PenSample::place)
    }

    /// The length of the line through the samples, pixels.
    pub fn length(&self) -> f32 {
        self.samples.windows(2).map(|pair| pair[0].place().distance(pair[1].place())).sum()
    }

    /// Seconds from the first to the last sample; `None` if either is unknown or time stands still.
    pub fn duration(&self) -> Option<f32> {
        let (first, last) = (self.samples.first()?.time?, self.samples.last()?.time?);
        Some(last - first).filter(|seconds| seconds.is_finite() && *seconds > 0.0)
    }
}

/// The smallest box around places, `[least, greatest]`; `None` without any.
pub(crate) fn bounds(places: impl IntoIterator<Item = Vec2>) -> Option<[Vec2; 2]> {
    places.into_iter().fold(None, |found, p| match found {
        None => Some([p, p]),
        Some([lo, hi]) => Some([lo.min(p), hi.max(p)]),
    })
}
