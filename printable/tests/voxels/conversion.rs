//! Voxels of fields and meshes, against asking at every centre.

use blobtree::build::*;
use blobtree::{Field, ISO, NodeRef, Tree};
use glam::Vec3;
use mesh::{Mesh, MeshDistance, shapes};
use printable::{GridShape, LayerHeight, MAX_VOXELS, VoxelError, VoxelGrid, VoxelSize};

fn size(width: f32, height: f32) -> VoxelSize {
    VoxelSize::new(width, LayerHeight::from_mm(height).expect("legal")).expect("legal")
}

/// All voxels of a grid.
fn voxels(grid: &VoxelGrid) -> impl Iterator<Item = [usize; 3]> + use<> {
    let [nx, ny, nz] = grid.shape().voxels();
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

#[test]
fn a_voxel_is_solid_where_the_field_is_at_its_centre() {
    let block = cuboid([3., -2., 6.], [17., 13., 12.]);
    let bored: NodeRef = block.subtract(cylinder([3., -2., -1.], [9., 1., 20.], 3.)).into();
    let tree = Tree::new(&bored);
    for size in [size(0.31, 0.25), size(0.25, 0.25), size(0.2, 0.4)] {
        let grid = VoxelGrid::from_field(&tree, size).expect("it stands on the bed");
        let mut values = vec![0.0; voxels(&grid).count()];
        let places: Vec<Vec3> = voxels(&grid).map(|voxel| grid.shape().center(voxel)).collect();
        let mut sampler = tree.sampler();
        sampler.enter(tree.support());
        sampler.values(
            &places.iter().map(|&p| p.clamp(tree.support().min, tree.support().max)).collect::<Vec<_>>(),
            &mut values,
        );
        for (voxel, (place, value)) in voxels(&grid).zip(places.iter().zip(values)) {
            assert_eq!(
                grid.is_solid(voxel),
                tree.support().contains(*place) && value >= ISO,
                "{voxel:?} at {place}"
            );
        }
        let voxel_mm3 = size.width() * size.width() * size.height();
        let volume = grid.count() as f32 * voxel_mm3;
        let exact = 17. * 13. * 12. - std::f32::consts::PI * 9. * 12. * 478.0f32.sqrt() / 21.0;
        assert!((volume - exact).abs() < 0.04 * exact, "{volume} mm³, not {exact} mm³");
    }
}

#[test]
fn a_large_support_does_not_count_as_a_large_solid() {
    let ball = Tree::new(&point([0., 0., 10.], 10.));
    assert!(ball.support().size().x > 30.0);
    let grid = VoxelGrid::from_field(&ball, size(0.05, 0.05)).expect("400 voxels a side");
    assert!(grid.shape().voxels().iter().all(|&n| n <= 450), "{:?}", grid.shape().voxels());
    let volume = grid.count() as f64 * 0.05f64.powi(3);
    assert!((volume - 4188.8).abs() < 5.0, "{volume} mm³");
}

#[test]
fn what_is_too_large_below_the_bed_floating_or_empty_is_refused_with_the_remedy() {
    let size = size(0.25, 0.25);
    let of = |node: blobtree::Node| VoxelGrid::from_field(&Tree::new(&node), size);
    let Err(VoxelError::TooLarge { factor, .. }) = of(point([0., 0., 100.], 100.)) else {
        panic!("200 mm fit")
    };
    assert!((1.56..1.75).contains(&factor), "{factor}");
    assert!(
        matches!(of(point([0., 0., 5.], 8.)), Err(VoxelError::BelowBed { by }) if (3.0..4.6).contains(&by))
    );
    assert!(
        matches!(of(point([0., 0., 20.], 8.)), Err(VoxelError::Floating { by }) if (11.75..12.5).contains(&by))
    );
    assert!(matches!(of(union([] as [NodeRef; 0])), Err(VoxelError::Empty)));
    assert!(of(point([0., 0., 7.99], 8.)).is_ok());
    let block = |z: f32| shapes::cuboid(Vec3::new(0., 0., z), Vec3::new(10., 10., z + 10.));
    assert!(
        matches!(VoxelGrid::from_mesh(&block(-3.0), size), Err(VoxelError::BelowBed { by }) if by == 3.0)
    );
    assert!(matches!(VoxelGrid::from_mesh(&block(3.0), size), Err(VoxelError::Floating { by }) if by == 3.0));
    assert!(matches!(VoxelGrid::from_mesh(&Mesh::default(), size), Err(VoxelError::Mesh(_))));
    let huge = shapes::cuboid(Vec3::ZERO, Vec3::splat(1e9));
    assert!(matches!(VoxelGrid::from_mesh(&huge, size), Err(VoxelError::TooLarge { .. })));
    let mut broken = block(0.0);
    broken.positions[3].x = f32::NAN;
    assert!(matches!(VoxelGrid::from_mesh(&broken, size), Err(VoxelError::Mesh(_))));
    assert!(GridShape::new([MAX_VOXELS + 1, 1, 1], size, [0.0; 2]).is_err());
    assert!(VoxelSize::new(f32::NAN, LayerHeight::from_mm(0.2).expect("legal")).is_err());
}

/// Solid where the winding number says, away from the surface, and from one half by more than `slack`.
fn agrees_with_winding(mesh: &Mesh, grid: &VoxelGrid, slack: f64) {
    let distance = MeshDistance::new(mesh).expect("a mesh");
    let mut compared = 0;
    for voxel in voxels(grid).step_by(7) {
        let place = grid.shape().center(voxel);
        let winding = distance.winding_number(place);
        if distance.signed_distance(place).abs() > 1e-3 && (winding - 0.5).abs() > slack {
            compared += 1;
            assert_eq!(grid.is_solid(voxel), winding > 0.5, "{voxel:?} at {place}");
        }
    }
    assert!(compared > 1000);
}

#[test]
fn closed_meshes_are_filled_where_they_wrap() {
    let ball = shapes::uv_sphere(Vec3::new(0., 0., 8.), 8., 40, 30);
    let mut two = ball.clone();
    two.append(&shapes::cuboid(Vec3::new(2., -3., 0.), Vec3::new(14., 5., 10.)));
    for mesh in [ball, two] {
        let grid = VoxelGrid::from_mesh(&mesh, size(0.33, 0.25)).expect("on the bed");
        agrees_with_winding(&mesh, &grid, 0.1);
        let mut inward = mesh.clone();
        inward.flip();
        assert!(VoxelGrid::from_mesh(&inward, size(0.33, 0.25)).expect("on the bed").same_solid(&grid));
    }
}

#[test]
fn columns_through_corners_and_edges_count_once() {
    // Corners and edges lie exactly on lines through the centres of voxels.
    let block = shapes::cuboid(Vec3::new(0.5, 0.5, 0.), Vec3::new(8.5, 8.5, 8.));
    let grid = VoxelGrid::from_mesh(&block, size(1.0, 1.0)).expect("on the bed");
    assert_eq!(grid.count(), 8 * 8 * 8);
    let mut pair = block;
    pair.append(&shapes::cuboid(Vec3::new(8.5, 0.5, 0.), Vec3::new(16.5, 8.5, 8.)));
    assert_eq!(VoxelGrid::from_mesh(&pair, size(1.0, 1.0)).expect("on the bed").count(), 16 * 8 * 8);
}

#[test]
fn holes_are_closed_where_they_look_closed_from_within() {
    let mut open = shapes::uv_sphere(Vec3::new(0., 0., 8.), 8., 40, 30);
    let whole = VoxelGrid::from_mesh(&open, size(0.4, 0.4)).expect("on the bed");
    // A window in the side, and one in the top.
    open.triangles.retain(|&t| {
        let middle = t.iter().map(|&v| open.positions[v as usize]).sum::<Vec3>() / 3.0;
        !(middle.x > 7.0 || middle.z > 15.3)
    });
    assert!(!open.is_closed_manifold());
    let grid = VoxelGrid::from_mesh(&open, size(0.4, 0.4)).expect("on the bed");
    agrees_with_winding(&open, &grid, 0.05);
    let lost = whole.count().abs_diff(grid.count()) as f64 / whole.count() as f64;
    assert!(lost < 0.05, "{lost}");
}

#[test]
fn words_of_a_grid_make_the_same_grid() {
    for side in [1, 63, 64, 65, 129, 300] {
        let shape = GridShape::new([side, 7, 5], size(0.2, 0.2), [-3.0, 4.0]).expect("legal");
        let mut rng = fastrand::Rng::with_seed(side as u64);
        let mut grid = VoxelGrid::new(shape);
        for _ in 0..200 {
            grid.set_solid([rng.usize(0..side), rng.usize(0..7), rng.usize(0..5)], rng.bool());
        }
        grid.set_solid([side, 0, 0], true);
        let again = VoxelGrid::from_words(shape, &grid.to_words());
        assert!(again.same_solid(&grid), "{side} voxels along x");
        assert_eq!(grid.solid_voxels().count(), grid.count());
    }
}

#[test]
fn materials_are_kept_only_where_they_are_not_the_default() {
    let shape = GridShape::new([512; 3], size(0.2, 0.2), [0.0; 2]).expect("legal");
    let mut grid = VoxelGrid::new(shape);
    let before = grid.bytes();
    grid.set_material([100, 200, 300], 0);
    assert_eq!(grid.bytes(), before);
    grid.set_material([100, 200, 300], 9);
    assert_eq!(grid.bytes(), before + 4096);
    assert_eq!(grid.material([100, 200, 300]), 9);
    assert_eq!(grid.material([101, 200, 300]), 0);
    assert_eq!(grid.material([600, 200, 300]), 0);
}
