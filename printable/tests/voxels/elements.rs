//! The element is round in effect: the steepest overhang that trim lets through is the one that was set.

use printable::{Element, GridShape, LayerHeight, OverhangAngle, VoxelGrid, VoxelSize, trim, unsupported};

/// Compass directions that are judged.
const DIRECTIONS: usize = 16;
/// Radius of the stem from which solids are let grow, in voxels.
const STEM: f32 = 12.0;

/// A block over a round stem on the bed, trimmed: the widest solid that can stand on the stem.
fn widest(element: &Element, size: VoxelSize, side: usize, layers: usize) -> VoxelGrid {
    let shape = GridShape::new([side, side, layers], size, [0.0; 2]).expect("legal");
    let mut grid = VoxelGrid::new(shape);
    let middle = side as f32 / 2.0;
    for y in 0..side {
        for x in 0..side {
            let (dx, dy) = (x as f32 + 0.5 - middle, y as f32 + 0.5 - middle);
            let on_stem = dx.hypot(dy) <= STEM;
            (0..layers).filter(|&z| z > 0 || on_stem).for_each(|z| grid.set_solid([x, y, z], true));
        }
    }
    trim(&mut grid, element);
    assert!(unsupported(&grid, element).is_empty());
    grid
}

/// How far the solid reaches in a layer, in each compass direction, in voxels.
fn reaches(grid: &VoxelGrid, z: usize) -> [f32; DIRECTIONS] {
    let [nx, ny, _] = grid.shape().voxels();
    let mut reaches = [0.0f32; DIRECTIONS];
    for y in 0..ny {
        for x in (0..nx).filter(|&x| grid.is_solid([x, y, z])) {
            let (dx, dy) = ((x as f32 + 0.5) - nx as f32 / 2.0, (y as f32 + 0.5) - ny as f32 / 2.0);
            for (n, reach) in reaches.iter_mut().enumerate() {
                let angle = std::f32::consts::TAU * n as f32 / DIRECTIONS as f32;
                *reach = reach.max(dx * angle.cos() + dy * angle.sin());
            }
        }
    }
    reaches
}

/// The overhang in each direction between the lowest layer and the highest that stays clear of the grid's sides.
fn overhangs(element: &Element, size: VoxelSize, degrees: f32) -> Vec<f32> {
    const SIDE: usize = 256;
    let per_layer = size.height() * degrees.to_radians().tan() / size.width();
    let layers = ((SIDE as f32 / 2.0 - STEM - 4.0) / per_layer / 1.5) as usize;
    let grid = widest(element, size, SIDE, layers);
    let (low, high) = (reaches(&grid, 0), reaches(&grid, layers - 1));
    let height = (layers - 1) as f32 * size.height();
    low.iter()
        .zip(high)
        .map(|(low, high)| ((high - low) * size.width() / height).atan().to_degrees())
        .collect()
}

fn spread(values: &[f32]) -> (f32, f32) {
    values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

#[test]
fn the_steepest_overhang_is_the_one_that_was_set_in_16_compass_directions() {
    for layer_height in [0.1, 0.2, 0.25] {
        let height = LayerHeight::from_mm(layer_height).expect("legal");
        for degrees in [30.0, 45.0, 60.0] {
            let angle = OverhangAngle::from_degrees(degrees).expect("legal");
            for wider in [1.0, 0.5, 0.8, 1.6] {
                let size = VoxelSize::new(layer_height * wider, height).expect("legal");
                let element = Element::round(angle, size).expect("coarse enough");
                let (low, high) = spread(&overhangs(&element, size, degrees));
                println!("h {layer_height}, θ {degrees}°, width {wider} h: {low:.2}° to {high:.2}°");
                assert!(low > degrees - 1.5 && high < degrees + 1.5, "{low}° to {high}° for {degrees}°");
            }
        }
    }
}

#[test]
fn every_angle_from_20_to_70_degrees_is_let_through_as_set() {
    let height = LayerHeight::from_mm(0.2).expect("legal");
    let size = VoxelSize::cubic(height);
    for degrees in (20..=70).step_by(5).map(|degrees| degrees as f32) {
        let angle = OverhangAngle::from_degrees(degrees).expect("legal");
        let (low, high) = spread(&overhangs(&Element::round(angle, size).expect("legal"), size, degrees));
        assert!(low > degrees - 1.5 && high < degrees + 1.5, "{low}° to {high}° for {degrees}°");
    }
}

#[test]
fn the_papers_square_lets_54_7_degrees_through_along_the_diagonals() {
    let size = VoxelSize::cubic(LayerHeight::from_mm(0.25).expect("legal"));
    let (low, high) = spread(&overhangs(&Element::square(), size, 45.0));
    assert!((low - 45.0).abs() < 1.0 && (high - 54.7).abs() < 1.0, "{low}° to {high}°");
}

#[test]
fn sums_of_elements_stay_near_the_disc_from_any_layer_on() {
    let cases = [(20.0, 1.0, 2.0), (30.0, 0.5, 2.0), (45.0, 1.0, 2.0), (60.0, 1.0, 2.0), (70.0, 0.5, 3.5)];
    for (degrees, wider, within) in cases {
        let height = LayerHeight::from_mm(0.2).expect("legal");
        let size = VoxelSize::new(0.2 * wider, height).expect("legal");
        let element =
            Element::round(OverhangAngle::from_degrees(degrees).expect("legal"), size).expect("legal");
        let reach = degrees.to_radians().tan() / wider;
        let mut worst = 0.0f32;
        for direction in 0..64 {
            let angle = std::f32::consts::PI * direction as f32 / 64.0;
            let along = |[x, y]: [i32; 2]| x as f32 * angle.cos() + y as f32 * angle.sin();
            let farthest = |below: usize| element.offsets(below).into_iter().map(along).fold(0.0, f32::max);
            let steps: Vec<f32> = (0..60).map(farthest).collect();
            for first in 0..40 {
                let mut sum = 0.0;
                for (n, step) in steps[first..].iter().take(20).enumerate() {
                    sum += step;
                    worst = worst.max((sum - (n + 1) as f32 * reach).abs());
                }
            }
        }
        println!("{degrees}°, width {wider} h: off by {worst:.2} voxels at most");
        assert!(worst < within, "{degrees}°, width {wider} h: off by {worst} voxels");
    }
}

#[test]
fn a_layer_never_reaches_further_than_the_next_whole_number_of_voxels() {
    for degrees in 20..=70 {
        for wider in [0.4, 0.7, 1.0, 3.0] {
            let height = LayerHeight::from_mm(0.2).expect("legal");
            let size = VoxelSize::new(0.2 * wider, height).expect("legal");
            let angle = OverhangAngle::from_degrees(degrees as f32).expect("legal");
            let element = Element::round(angle, size).expect("coarse enough");
            let reach = (degrees as f32).to_radians().tan() / wider;
            assert!(element.reach() as f32 <= (reach - 1e-3).ceil().max(1.0), "{degrees}°, width {wider} h");
            for below in 0..100 {
                let offsets = element.offsets(below);
                assert!(offsets.iter().flatten().all(|n| n.unsigned_abs() as usize <= element.reach()));
                assert!(offsets.iter().all(|&[x, y]| offsets.contains(&[-x, -y])), "not its own opposite");
            }
        }
    }
}

#[test]
fn voxels_too_fine_for_an_element_are_refused_with_the_width_that_works() {
    let height = LayerHeight::from_mm(0.2).expect("legal");
    let angle = OverhangAngle::from_degrees(70.0).expect("legal");
    let error = Element::round(angle, VoxelSize::new(0.02, height).expect("legal")).expect_err("too fine");
    let printable::ElementError::TooFine { least, .. } = error else { panic!("{error}") };
    assert!(Element::round(angle, VoxelSize::new(least, height).expect("legal")).is_ok());
    assert!(error.to_string().contains("take voxels of at least"), "{error}");
}
