//! Values of options, checked as they are read.

use glam::Vec3;
use printable::{LayerHeight, OverhangAngle};
use sketch::stroke::DoodleChoice;

/// Most pixels in a picture, which bounds memory: about 64 bytes each.
const MOST_PIXELS: u32 = 1 << 23;

/// Three finite numbers with commas between.
pub fn point(text: &str) -> Result<Vec3, String> {
    let wrong = || "a point is three numbers with commas between, such as 0,-2.5,10".to_owned();
    let numbers: Vec<f32> =
        text.split(',').map(|n| n.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
    let p = Vec3::from_array(numbers.try_into().map_err(|_| wrong())?);
    if p.is_finite() { Ok(p) } else { Err(wrong()) }
}

/// A length that a shape can have.
pub fn length(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|mm| (1e-4..=1e6).contains(mm));
    legal.ok_or_else(|| "a length is a number of millimetres from 0.0001 to 1000000".to_owned())
}

/// A coordinate that a shape can have.
pub fn coordinate(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|mm: &f64| mm.abs() <= 1e5);
    legal.ok_or_else(|| "a coordinate is a number of millimetres from -100000 to 100000".to_owned())
}

pub fn layer_height(text: &str) -> Result<LayerHeight, String> {
    let mm = text.parse().map_err(|_| "a layer height is a number of millimetres, such as 0.2".to_owned())?;
    LayerHeight::from_mm(mm).map_err(|e| e.to_string())
}

pub fn overhang(text: &str) -> Result<OverhangAngle, String> {
    let degrees = text.parse().map_err(|_| "an overhang is a number of degrees, such as 45".to_owned())?;
    OverhangAngle::from_degrees(degrees).map_err(|e| e.to_string())
}

pub fn share(text: &str) -> Result<f32, String> {
    let legal = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    legal.ok_or_else(|| "a share is a number from 0 to 1".to_owned())
}

pub fn contrast(text: &str) -> Result<f32, String> {
    share(text)
        .ok()
        .filter(|&share| share <= 0.9)
        .ok_or_else(|| "a contrast is a number from 0 to 0.9".to_owned())
}

/// Lines are counted from 1; what is too large for a line is a key.
pub fn doodle(text: &str) -> Result<DoodleChoice, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("lines are counted from 1".to_owned()),
        Ok(line) if line < 1_000_000 => Ok(DoodleChoice::Index(line - 1)),
        _ => Ok(DoodleChoice::Key(text.to_owned())),
    }
}

/// Width and height of a picture.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let legal = sides.filter(|sides| sides.iter().all(|side| (16..=4096).contains(side)));
    legal.filter(|[width, height]| width * height <= MOST_PIXELS).ok_or_else(|| {
        "a size is WIDTHxHEIGHT in pixels, such as 1200x900: each 16 to 4096, and no more than 8 million in all"
            .to_owned()
    })
}

pub fn color(text: &str) -> Result<blobtree::Color, String> {
    text.parse().map_err(|e: blobtree::ColorError| e.to_string())
}
