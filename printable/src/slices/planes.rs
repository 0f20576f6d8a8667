//! At which heights a part is sliced.

use super::error::{MOST_LAYERS, SliceError};
use crate::LayerHeight;
use mesh::Bounds;

/// Where the first layer begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bottom {
    /// At the part's lowest point, which is put on the bed to print.
    #[default]
    LowestPoint,
    /// At the bed, z = 0. What is below it is not printed; a part that begins above it floats.
    Bed,
}

/// The layers of a part: layer k reaches from `bottom + k h` to `bottom + (k + 1) h` and is sliced in its middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// Where layer 0 begins, mm.
    pub bottom: f64,
    /// Height of a layer, mm.
    pub layer_height: f64,
    /// Where each layer is sliced, mm; at least one.
    pub heights: Vec<f64>,
}

impl Planes {
    /// The layers of a part in `bounds`: all whose middle lies below its highest point, and at least one.
    ///
    /// Errors: [`SliceError::TooManyLayers`].
    pub fn new(bounds: &Bounds, height: LayerHeight, bottom: Bottom) -> Result<Self, SliceError> {
        // What was meant, 0.2 mm and not the nearest binary number: planes agree with other programs' that way.
        let layer_height = (f64::from(height.mm()) * 1e6).round() / 1e6;
        let bottom = match bottom {
            Bottom::LowestPoint => f64::from(bounds.min.z),
            Bottom::Bed => 0.0,
        };
        let layers = ((f64::from(bounds.max.z) - bottom) / layer_height - 0.5 - 1e-9).ceil().max(1.0);
        if layers > MOST_LAYERS as f64 {
            return Err(SliceError::TooManyLayers { layers, layer_height_mm: layer_height });
        }
        let middle = |layer: usize| bottom + (layer as f64 + 0.5) * layer_height;
        Ok(Self { bottom, layer_height, heights: (0..layers as usize).map(middle).collect() })
    }
}
