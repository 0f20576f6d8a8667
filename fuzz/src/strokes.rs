//! Strokes: reading, keeping, finding outlines.

use glam::Vec2;
use sketch::curve;
use sketch::stroke::{
    DoodleChoice, FileFormat, MAX_SAMPLES, MAX_STROKES, Placement, Sketch, Standing, Stroke, detect, read,
    write_strokes,
};

/// The size to which drawings are brought, mm.
const SIZE: f32 = 60.0;

/// The byte that ends a stroke in [`draw`].
const LIFT: u8 = 0x80;

/// Reads a file of strokes; what there is must keep its promises on the way into a scene.
pub fn read_strokes(data: &[u8], format: FileFormat) {
    // What a file is can be asked of any bytes.
    let _ = detect(data, None);
    let Ok(strokes) = read(data, format, &DoodleChoice::default()) else {
        return;
    };
    assert!(strokes.len() <= MAX_STROKES, "{} strokes", strokes.len());
    let samples: usize = strokes.iter().map(|stroke| stroke.samples.len()).sum();
    assert!(samples <= MAX_SAMPLES, "{samples} samples");
    assert_comes_back(&strokes);
    let sketch = Sketch::from_strokes(&strokes);
    assert!(sketch.places().all(Vec2::is_finite), "{sketch:?}");
    let drawing = Placement::of_size(&sketch, SIZE, Standing::OnGround).drawing(&sketch);
    drawing.check().expect("what a sketch becomes is legal");
}

/// Strokes are written and read back without a change, but for samples whose place is not finite.
fn assert_comes_back(strokes: &[Stroke]) {
    let text = write_strokes(strokes);
    let back = read(text.as_bytes(), FileFormat::Strokes, &DoodleChoice::default())
        .expect("what was written is readable");
    assert!(write_strokes(&back) == text, "the strokes changed");
}

/// Draws with pairs of bytes as places; where an outline is found, its curves must be closed polygons.
pub fn draw(data: &[u8]) {
    crate::allow_for_products();
    let strokes = data.split(|byte| *byte == LIFT).take(12).map(|bytes| {
        let place = |pair: &[u8]| Vec2::new(f32::from(pair[0]), f32::from(pair[1]));
        Stroke::through(bytes.chunks_exact(2).take(60).map(place))
    });
    let strokes: Vec<Stroke> = strokes.collect();
    let sketch = Sketch::from_strokes(&strokes);
    let drawing = Placement::of_size(&sketch, SIZE, Standing::OnGround).drawing(&sketch);
    drawing.check().expect("what a sketch becomes is legal");
    let Ok(curve) = curve::fit(&drawing) else {
        return;
    };
    assert!(!curve.contours.is_empty(), "an outline without a curve");
    for contour in &curve.contours {
        assert!(contour.points.len() >= 3, "{contour:?}");
        assert!(contour.points.iter().all(|p| p.is_finite()), "{contour:?}");
        let far = 4.0 * f64::from(SIZE);
        assert!(contour.points.iter().all(|p| p.abs().max_element() < far), "{contour:?}");
        assert!(contour.corners.iter().all(|&i| i < contour.points.len()), "{contour:?}");
    }
    assert!(curve.left_out.iter().all(|&i| i < drawing.strokes.len()), "{:?}", curve.left_out);
}
