//! Pictures: the right size, the shape in the middle, in its colours.

mod common;

use common::{Folder, SNOWMAN};

/// Width and rows of red, green and blue.
fn decoded(bytes: &[u8]) -> (usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG file");
    let mut data = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut data).expect("whole");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width as usize, data.as_chunks().0.to_vec())
}

/// Whether a pixel is much more orange than grey.
fn is_orange([r, g, b]: [u8; 3]) -> bool {
    r > 100 && r > g.saturating_add(30) && g > b
}

#[test]
fn a_rendered_scene_is_centred_and_coloured() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    let arguments = [
        "render",
        "s.trullo",
        "-o",
        "s.png",
        "--size",
        "200x160",
        "--view",
        "front",
        "--background",
        "#0000ff",
    ];
    assert_eq!(folder.trullo(&arguments).status.code(), Some(0));
    let (width, pixels) = decoded(&folder.read("s.png"));
    assert_eq!((width, pixels.len() / width), (200, 160));
    let shape: Vec<(usize, usize)> =
        (0..pixels.len()).filter(|&i| pixels[i] != [0, 0, 255]).map(|i| (i % width, i / width)).collect();
    let middle = |side: fn(&(usize, usize)) -> usize| {
        let sides = || shape.iter().map(side);
        sides().min().zip(sides().max()).map_or(0, |(low, high)| (low + high).div_ceil(2))
    };
    let (x, y) = (middle(|p| p.0), middle(|p| p.1));
    assert!(x.abs_diff(100) <= 1 && y.abs_diff(80) <= 1, "the middle is at {x}, {y}");
    assert!(is_orange(pixels[40 * width + 100]), "the upper ball: {:?}", pixels[40 * width + 100]);
    assert!(!is_orange(pixels[110 * width + 100]), "the lower ball: {:?}", pixels[110 * width + 100]);
}

#[test]
fn a_mesh_covers_the_same_pixels_as_its_scene() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    folder.trullo(&["mesh", "s.trullo", "-o", "s.stl", "--cells", "64"]);
    let covered = |input: &str| {
        let arguments = [
            "render",
            input,
            "-o",
            "p.png",
            "--size",
            "160x120",
            "--view",
            "front",
            "--background",
            "#0000ff",
        ];
        assert_eq!(folder.trullo(&arguments).status.code(), Some(0), "{input}");
        let (_, pixels) = decoded(&folder.read("p.png"));
        pixels.into_iter().map(|p| p != [0, 0, 255]).collect::<Vec<_>>()
    };
    let (scene, mesh) = (covered("s.trullo"), covered("s.stl"));
    let different = scene.iter().zip(&mesh).filter(|(a, b)| a != b).count();
    let all = scene.iter().filter(|&&c| c).count();
    assert!(all > 2000 && different * 20 < all, "{different} of {all} pixels differ");
}

#[test]
fn every_named_view_draws() {
    let folder = Folder::with_scene("s.trullo", SNOWMAN);
    for view in ["iso", "front", "right", "back", "left", "top", "bottom", "-30,12.5"] {
        let out = folder.trullo(&["render", "s.trullo", "-o", "v.png", "--size", "48x32", "--view", view]);
        assert_eq!(out.status.code(), Some(0), "{view}");
    }
}
