use super::*;
use crate::slices::Planes;
use glam::DVec2;
use mesh::Bounds;
use std::f64::consts::PI;

const REACH: f64 = 0.258;

/// Layers of rings of places, mm, each with the solid on its left.
fn outlines(layers: &[Vec<Vec<DVec2>>]) -> Outlines {
    let bounds = Bounds { min: glam::Vec3::splat(-50.0), max: glam::Vec3::splat(50.0) };
    let grid = Grid::over(&bounds).expect("not too wide");
    let outline = |ring: &Vec<DVec2>| {
        let ring: Vec<_> = ring.iter().map(|p| grid.point(*p)).collect();
        Outline { rect: Rect::of_points(&ring).expect("not empty"), ring }
    };
    let heights = (0..layers.len()).map(|layer| 0.25 * (layer as f64 + 0.5)).collect();
    Outlines {
        planes: Planes { bottom: 0.0, layer_height: 0.25, heights },
        grid,
        layers: layers.iter().map(|rings| rings.iter().map(outline).collect()).collect(),
    }
}

fn rectangle([left, front]: [f64; 2], [right, back]: [f64; 2]) -> Vec<DVec2> {
    [[left, front], [right, front], [right, back], [left, back]].map(DVec2::from).to_vec()
}

fn square(x: f64, y: f64, half: f64) -> Vec<DVec2> {
    rectangle([x - half, y - half], [x + half, y + half])
}

fn circle(x: f64, y: f64, radius: f64) -> Vec<DVec2> {
    let point = |i: usize| DVec2::new(x, y) + radius * DVec2::from_angle(i as f64 / 720.0 * 2.0 * PI);
    (0..720).map(point).collect()
}

fn hole(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.reverse();
    ring
}

fn look(outlines: &Outlines) -> Hanging {
    Hanging::new(&Rebaker::new(), outlines, REACH).expect("no cancel")
}

fn found(hanging: &Hanging, outlines: &Outlines) -> Vec<Piece> {
    hanging.pieces(&Rebaker::new(), outlines, 0.2).expect("no cancel")
}

fn pieces(layers: &[Vec<Vec<DVec2>>]) -> Vec<Piece> {
    let outlines = outlines(layers);
    found(&look(&outlines), &outlines)
}

fn area(pieces: &[Piece], island: bool) -> f64 {
    pieces.iter().filter(|piece| piece.island == island).map(|piece| piece.area).sum()
}

#[test]
fn a_plate_hangs_beyond_the_reach_of_its_pillar_wherever_tiles_begin() {
    let carried = 36.0 + 4.0 * 6.0 * REACH + PI * REACH * REACH;
    for shift in [0.0, 0.3, 1.03, 1.7, -2.9] {
        let found = pieces(&[vec![square(shift, -shift, 3.0)], vec![square(shift, -shift, 10.0)]]);
        assert_eq!(area(&found, true), 0.0, "an island at {shift}");
        let hanging = area(&found, false);
        assert!((hanging - (400.0 - carried)).abs() < 1e-3, "{shift}: {hanging} mm²");
    }
}

#[test]
fn rings_hang_by_what_is_beyond_reach_and_discs_within_it_do_not() {
    for (beyond, hangs) in [(0.2, false), (0.25, false), (0.28, true), (0.4, true)] {
        let found = pieces(&[vec![circle(1.0, 2.0, 5.0)], vec![circle(1.0, 2.0, 5.0 + beyond)]]);
        let expected = if hangs { PI * ((5.0 + beyond).powi(2) - (5.0 + REACH).powi(2)) } else { 0.0 };
        assert!((area(&found, false) - expected).abs() < 2e-3, "{beyond}: {}", area(&found, false));
    }
}

#[test]
fn a_covered_hole_hangs_in_its_middle_only() {
    let below = vec![square(0.0, 0.0, 8.0), hole(circle(0.5, 0.5, 2.0))];
    let found = pieces(&[below, vec![square(0.0, 0.0, 8.0)]]);
    let expected = PI * (2.0 - REACH).powi(2);
    assert!((area(&found, false) - expected).abs() < 2e-3, "{}", area(&found, false));
}

#[test]
fn regions_without_anything_below_are_islands_once_and_whole() {
    let below = vec![square(0.0, 0.0, 9.0), hole(square(0.0, 0.0, 7.0))];
    // A column in the hole of a ring, a dot beside it, and a sliver that leans out within reach of the ring.
    let sliver = rectangle([9.05, -6.0], [9.2, 6.0]);
    let mut layer = below.clone();
    layer.extend([square(0.0, 0.0, 3.0), square(20.0, 0.0, 0.1), sliver]);
    let found = pieces(&[below, layer]);
    let islands: Vec<f64> = found.iter().filter(|piece| piece.island).map(|piece| piece.area).collect();
    assert_eq!(islands.len(), 3, "{islands:?}");
    assert!((area(&found, true) - (36.0 + 0.04 + 1.8)).abs() < 1e-4, "{islands:?}");
    assert!(area(&found, false) < 1e-6, "{}", area(&found, false));
}

#[test]
fn what_stands_on_what_hangs_goes_with_it() {
    // A wall that leans out by 0.2 mm a layer, on a first one that leans out by 1 mm.
    let edge = |out: f64| vec![rectangle([-4.0, -4.0], [4.0 + out, 4.0])];
    let layers: Vec<Vec<Vec<DVec2>>> = [0.0, 1.0, 1.2, 1.4, 1.6].map(edge).to_vec();
    let found = pieces(&layers);
    for layer in 1..layers.len() {
        let z = 0.25 * (layer as f64 + 0.5);
        let far = found.iter().filter(|piece| (piece.places[0].z - z).abs() < 1e-9);
        let reaches = far.flat_map(|piece| &piece.places).map(|p| p.x).fold(f64::INFINITY, f64::min);
        let allowed = 4.0 + layer as f64 * REACH;
        let out = 4.0 + 0.2 * (layer as f64 - 1.0) + 1.0;
        if out > allowed + 0.01 {
            assert!((reaches - allowed).abs() < 0.01, "layer {layer}: from {reaches}, not {allowed}");
        } else {
            assert!(reaches.is_infinite(), "layer {layer}: from {reaches}");
        }
    }
}

#[test]
fn following_a_change_finds_what_a_fresh_look_finds() {
    let mut rng = fastrand::Rng::with_seed(7);
    let dot =
        |rng: &mut fastrand::Rng| circle(16.0 * rng.f64() - 8.0, 16.0 * rng.f64() - 8.0, 0.3 + rng.f64());
    let layer = |rng: &mut fastrand::Rng| (0..12).map(|_| dot(rng)).collect::<Vec<_>>();
    let mut layers: Vec<_> = (0..5).map(|_| layer(&mut rng)).collect();
    let before = outlines(&layers);
    let mut kept = look(&before);
    for _ in 0..4 {
        let changed = rng.usize(..layers.len());
        let number = rng.usize(..12);
        let new = dot(&mut rng);
        let old = std::mem::replace(&mut layers[changed][number], new.clone());
        let after = outlines(&layers);
        let mut tiles = vec![Vec::new(); layers.len()];
        for ring in [old, new] {
            let points: Vec<_> = ring.iter().map(|p| after.grid.point(*p)).collect();
            tiles[changed].extend(kept.reach.tiling.tiles(&Rect::of_points(&points).expect("points")));
        }
        kept.renew(&Rebaker::new(), &after, &tiles).expect("no cancel");
        assert_eq!(found(&kept, &after), found(&look(&after), &after));
    }
}

#[test]
fn a_speck_that_touches_what_is_below_by_a_corner_is_an_island() {
    let touching = 1e-4;
    let layer = vec![square(0.0, 0.0, 1.9), square(2.03 - touching, 2.03 - touching, 0.03)];
    let found = pieces(&[vec![square(0.0, 0.0, 2.0)], layer]);
    assert!((area(&found, true) - 0.0036).abs() < 1e-6, "{}", area(&found, true));
}
