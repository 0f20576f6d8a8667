//! Corners that rounding took apart come together again, and nothing else does.

use std::collections::BTreeMap;

use crate::support::*;
use glam::Vec3;
use mesh::Mesh;
use mesh::io::{Format, Loaded, Notice, close_cracks};
use mesh::shapes::{cuboid, ico_sphere, torus};

/// Every triangle with corners of its own, and each coordinate off by up to `units` units in the last place.
fn shaken(mesh: &Mesh, units: i32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut shake = |x: f32| {
        let by = random.below(2 * units as usize + 1) as i32 - units;
        (0..by.abs()).fold(x, |x, _| if by > 0 { x.next_up() } else { x.next_down() })
    };
    let corners = mesh.triangles.as_flattened().iter();
    let positions: Vec<Vec3> =
        corners.map(|&v| Vec3::from(mesh.positions[v as usize].to_array().map(&mut shake))).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { positions, triangles }
}

fn through(mesh: &Mesh, format: Format) -> Loaded {
    load(&bytes_of(mesh, format), format).expect("the file is whole")
}

/// Edges along which triangles do not run equally often in both directions.
fn open_edges(mesh: &Mesh) -> usize {
    let mut balance = BTreeMap::new();
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
        }
    }
    balance.values().filter(|&&balance| balance != 0).count()
}

#[test]
fn bodies_whose_corners_are_a_unit_off_read_closed_in_every_format() {
    let bodies = [
        ico_sphere(Vec3::ZERO, 10.0, 3),
        ico_sphere(Vec3::new(120.0, -80.0, 10.0), 10.0, 3),
        torus(Vec3::new(50.0, 50.0, 2.0), 20.0, 2.0, 64, 24),
        cuboid(Vec3::new(1e-3, 0.0, 0.0), Vec3::new(2e-3, 1e-3, 5e-4)),
        ico_sphere(Vec3::ZERO, 5e7, 2),
    ];
    for (seed, body) in (0..).zip(&bodies) {
        let file = shaken(body, 1, seed);
        for format in FORMATS {
            let read = through(&file, format);
            assert!(read.mesh.is_closed_manifold(), "{format}, seed {seed}: {:?}", read.notices);
            assert_eq!(read.mesh.triangles.len(), body.triangles.len(), "{format}, seed {seed}");
            assert_eq!(read.mesh.positions.len(), body.positions.len(), "{format}, seed {seed}");
            let (volume, truth) = (read.mesh.volume(), body.volume());
            assert!((volume / truth - 1.0).abs() < 1e-4, "{format}, seed {seed}: {volume}, not {truth}");
            let [Notice::JoinedVertices { within, left: 0, collapsed: 0, .. }] = read.notices[..] else {
                panic!("{format}, seed {seed}: {:?}", read.notices);
            };
            let longest = f64::from((read.mesh.bounds().max - read.mesh.bounds().min).max_element());
            assert!(within > 0.0 && within <= 1e-5 * longest, "{format}, seed {seed}: {within} of {longest}");
        }
    }
}

#[test]
fn the_notice_says_how_many_were_joined_and_how_near_they_were() {
    let split = through(&shaken(&cube(1.0), 0, 0), Format::Obj);
    assert_eq!(split.mesh.positions.len(), 8);
    assert_eq!(
        split.notices.iter().map(Notice::to_string).collect::<Vec<_>>(),
        [
            "28 vertices in exactly the same place as another were joined with it, which closed all 36 open edges"
        ]
    );
    let mut file = shaken(&cube(1.0), 0, 0);
    // One corner of the cube's last triangle, and a triangle gone.
    file.positions[35].x += 2e-7;
    file.triangles.remove(0);
    let read = through(&file, Format::Ply);
    assert_eq!(
        read.notices.iter().map(Notice::to_string).collect::<Vec<_>>(),
        ["25 vertices within 4.8e-7 mm of another were joined with it, which left 3 of 33 open edges"]
    );
}

#[test]
fn holes_stay_open_and_their_meshes_as_they_are() {
    let mut bowl = ico_sphere(Vec3::ZERO, 10.0, 3);
    let positions = bowl.positions.clone();
    bowl.triangles.retain(|t| t.iter().any(|&v| positions[v as usize].z < 0.0));
    let rim = open_edges(&bowl);
    assert!(rim > 20);
    for format in [Format::Obj, Format::Ply, Format::ThreeMf] {
        let read = through(&bowl, format);
        assert_eq!((&read.mesh, &read.notices[..]), (&bowl, &[][..]), "{format}");
    }
    let read = through(&shaken(&bowl, 1, 4), Format::Stl);
    assert_eq!(open_edges(&read.mesh), rim, "the cracks are closed, the hole is not");
}

#[test]
fn tiny_triangles_at_the_rim_of_a_hole_are_not_taken_for_cracks() {
    // A fan whose rim has one side far shorter than any distance tried, and a speck beside it.
    let mut sheet = Mesh {
        positions: [
            [0., 0., 0.],
            [9., 0., 0.],
            [9., 1e-7, 0.],
            [0., 9., 0.],
            [5., 5., 5.],
            [5., 5., 5.0000005],
        ]
        .map(Vec3::from)
        .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    sheet.positions.push(Vec3::new(5.0000005, 5.0, 5.0));
    sheet.triangles.push([4, 5, 6]);
    let read = through(&sheet, Format::Ply);
    assert_eq!((read.mesh, read.notices), (sheet, vec![]));
}

#[test]
fn bodies_nearer_than_the_distance_stay_apart() {
    let gap = 1e-6;
    let mut pair = cuboid(Vec3::ZERO, Vec3::splat(10.0));
    pair.append(&cuboid(Vec3::new(10.0 + gap, 0.0, 0.0), Vec3::new(20.0, 10.0, 10.0)));
    pair.append(&cuboid(Vec3::new(0.0, 10.0, 0.0), Vec3::new(10.0, 20.0, 10.0)));
    // A body with a crack makes the reader look, and it must look past those that are closed.
    let far = shaken(&ico_sphere(Vec3::splat(-20.0), 5.0, 1), 1, 9);
    let mut file = pair.clone();
    file.append(&far);
    for format in [Format::Obj, Format::Ply, Format::ThreeMf] {
        assert_eq!(through(&pair, format).notices, [], "{format}");
        let read = through(&file, format).mesh;
        assert!(read.is_closed_manifold(), "{format}");
        assert_eq!(read.bodies().len(), 4, "{format}");
        assert_eq!(read.positions[..24], pair.positions, "{format}");
    }
    // Both cracked, and nearer to each other than the largest distance: the smallest that closes wins.
    let mut cracked = cuboid(Vec3::ZERO, Vec3::splat(10.0));
    cracked.append(&cuboid(Vec3::new(10.0 + 2e-5, 0.0, 0.0), Vec3::new(20.0, 10.0, 10.0)));
    let read = through(&shaken(&cracked, 1, 2), Format::Stl).mesh;
    assert!(read.is_closed_manifold());
    assert_eq!(read.bodies().len(), 2);
}

#[test]
fn the_same_cracks_close_the_same_way_and_only_once() {
    for seed in 0..100 {
        let mut first = random_mesh(seed);
        let mut body = shaken(&ico_sphere(Vec3::splat(30.0), 10.0, 2), 1 + (seed % 3) as i32, seed);
        body.triangles.truncate(200 + seed as usize);
        if seed % 2 == 0 {
            first = body;
        }
        let mut second = first.clone();
        let before = open_edges(&first);
        let notice = close_cracks(&mut first);
        assert_eq!(notice, close_cracks(&mut second), "seed {seed}");
        assert_eq!(first, second, "seed {seed}");
        let after = open_edges(&first);
        assert!(if notice.is_some() { after < before } else { after == before }, "seed {seed}");
        // Without sense as they are, random meshes may have something to gain again.
        if seed % 2 == 0 {
            assert_eq!(close_cracks(&mut second), None, "seed {seed}");
        }
    }
}

#[test]
fn cracks_in_meshes_without_sense_do_no_harm() {
    let odd = Mesh {
        positions: vec![Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::MAX, Vec3::MIN, Vec3::ZERO, -Vec3::ZERO],
        triangles: vec![[0, 1, 2], [3, 4, 5], [0, 0, 1], [7, 8, u32::MAX], [6, 3, 4], [5, 3, 1], [2, 1, 0]],
    };
    let mut mesh = odd.clone();
    close_cracks(&mut mesh);
    assert!(mesh.triangles.len() >= odd.triangles.len() - 2);
    let mut empty = Mesh::default();
    assert_eq!(close_cracks(&mut empty), None);
}
