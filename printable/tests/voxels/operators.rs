//! The operators against plain loops that follow their definitions.

use super::reference::{Plain, blobs, cubic, elements, grid_of, noise};
use fastrand::Rng;
use printable::{
    Element, GroundPaths, OverhangAngle, PathCost, PathMap, Paths, UnderBed, VoxelGrid, Why, add_supported,
    grow, preserve, smooth, trim, trim_with_changes, unsupported,
};

/// 4096 grids of 4 × 4, with room between them, in one layer of 512²; number n starts at `n0`.
fn fields(layer: usize, words: &mut [u64], field: impl Fn(usize) -> u16) {
    for n in 0..4096 {
        let (x, y) = (n % 64 * 8 + 2, n / 64 * 8 + 2);
        for row in 0..4 {
            let bits = u64::from(field(n) >> (4 * row) & 15);
            words[(layer * 512 + y + row) * 8 + x / 64] |= bits << (x % 64);
        }
    }
}

/// What a 4 × 4 grid carries of another.
fn carried(base: u16, element: &Element) -> u16 {
    let at = |x: i32, y: i32| (0..4).contains(&x) && (0..4).contains(&y) && base >> (4 * y + x) & 1 == 1;
    let offsets = element.offsets(0);
    (0..16)
        .filter(|&n| offsets.iter().any(|[dx, dy]| at(n % 4 + dx, n / 4 + dy)))
        .fold(0, |all, n| all | 1 << n)
}

#[test]
fn all_65536_grids_of_4_by_4_over_many_bases_are_trimmed_to_what_the_base_carries() {
    // Each voxel alone, rows, diagonals, frames, halves, and some at random: all bases would be 65536 times as many.
    let mut bases: Vec<u16> = (0..16).map(|bit| 1 << bit).collect();
    bases.extend([0, 0xffff, 0x000f, 0x1111, 0x8421, 0x0660, 0x9009, 0xa5a5, 0x0f0f, 0x0033, 0xf99f]);
    let mut rng = Rng::with_seed(1);
    bases.extend((0..13).map(|_| rng.u16(..)));
    for (name, element) in elements() {
        for &base in &bases {
            let carried = carried(base, &element);
            for block in 0..16 {
                let top = |n: usize| (block * 4096 + n) as u16;
                let mut words = vec![0; 2 * 512 * 8];
                fields(0, &mut words, |_| base);
                let mut expected = words.clone();
                fields(1, &mut words, top);
                fields(1, &mut expected, |n| top(n) & carried);
                let mut grid = VoxelGrid::from_words(cubic([512, 512, 2]), &words);
                trim(&mut grid, &element);
                assert!(grid.to_words() == expected, "{name}, base {base:#06x}, block {block}");
            }
        }
    }
}

#[test]
fn trim_leaves_the_largest_supported_part_is_idempotent_and_monotone() {
    for seed in 0..2000 {
        let mut rng = Rng::with_seed(seed);
        let all = elements();
        let (name, element) = &all[seed as usize % all.len()];
        let before = noise(&mut rng, 48);
        let mut after = before.clone();
        let removed = trim(&mut after, element);
        assert_eq!(before.count() - after.count(), removed, "seed {seed}, {name}");
        assert!(after.solid_voxels().all(|voxel| before.is_solid(voxel)), "seed {seed}: trim added");
        assert!(unsupported(&after, element).is_empty(), "seed {seed}, {name}: left something hanging");
        assert_eq!(trim(&mut after.clone(), element), 0, "seed {seed}: a second trim removed more");
        if seed % 200 == 0 {
            let mut plain = Plain::of(&before);
            plain.remove_until_supported(element);
            assert!(plain == Plain::of(&after), "seed {seed}, {name}: not the largest");
        }
        if seed % 20 == 0 {
            let mut more = before.clone();
            (0..500).for_each(|_| more.set_solid(std::array::from_fn(|_| rng.usize(0..48)), true));
            trim(&mut more, element);
            assert!(after.solid_voxels().all(|voxel| more.is_solid(voxel)), "seed {seed}: not monotone");
        }
    }
}

#[test]
fn trimming_with_changes_is_the_same_and_can_be_undone_and_done_again() {
    for seed in 0..15 {
        let before = grid_of(&blobs(&mut Rng::with_seed(seed), [70, 48, 48]));
        for (name, element) in elements() {
            let mut plain = before.clone();
            let removed = trim(&mut plain, &element);
            let mut grid = before.clone();
            let mut changes = trim_with_changes(&mut grid, &element);
            assert!(grid.same_solid(&plain), "seed {seed}, {name}");
            assert_eq!((changes.removed(), changes.taken(), changes.added()), (removed, removed, 0));
            changes.swap(&mut grid);
            assert!(grid.same_solid(&before), "seed {seed}, {name}: not undone");
            changes.swap(&mut grid);
            assert!(grid.same_solid(&plain), "seed {seed}, {name}: not done again");
        }
    }
}

#[test]
fn adding_what_is_carried_equals_adding_all_and_trimming() {
    for seed in 0..15 {
        let mut rng = Rng::with_seed(seed);
        for (name, element) in elements() {
            let mut before = grid_of(&blobs(&mut rng, [70, 48, 48]));
            trim(&mut before, &element);
            let add = grid_of(&blobs(&mut rng, [70, 48, 48]));
            let mut all = before.clone();
            add.solid_voxels().for_each(|voxel| all.set_solid(voxel, true));
            trim(&mut all, &element);
            let mut grid = before.clone();
            add_supported(&mut grid, &add, &element, 3);
            assert!(grid.same_solid(&all), "seed {seed}, {name}");
            let added = grid.solid_voxels().filter(|&voxel| !before.is_solid(voxel));
            assert!(added.into_iter().all(|voxel| grid.material(voxel) == 3));
        }
    }
}

#[test]
fn preserve_equals_the_erosion_of_each_layer_from_the_top_down() {
    for seed in 0..8 {
        let mut rng = Rng::with_seed(seed);
        let before = grid_of(&blobs(&mut rng, [70, 48, 40]));
        let within = grid_of(&blobs(&mut rng, [70, 48, 40]));
        for (name, element) in elements() {
            for within in [None, Some(&within)] {
                let mut grid = before.clone();
                let added = preserve(&mut grid, &element, within);
                let mut plain = Plain::of(&before);
                plain.preserve(&element, within.map(Plain::of).as_ref());
                assert!(plain == Plain::of(&grid), "seed {seed}, {name}");
                assert_eq!(grid.count() - before.count(), added);
            }
        }
    }
}

#[test]
fn preserve_and_trim_leave_nothing_hanging() {
    for seed in 0..15 {
        let mut grid = noise(&mut Rng::with_seed(seed), 48);
        for (name, element) in elements() {
            preserve(&mut grid, &element, None);
            trim(&mut grid, &element);
            assert!(unsupported(&grid, &element).is_empty(), "seed {seed}, {name}");
        }
    }
}

#[test]
fn smoothing_equals_counting_27_neighbours() {
    for seed in 0..20 {
        let before = noise(&mut Rng::with_seed(seed), 40);
        for under_bed in [UnderBed::Nothing, UnderBed::LowestLayer] {
            let after = smooth(&before, under_bed);
            let expected = Plain::of(&before).smoothed(under_bed == UnderBed::LowestLayer);
            assert!(expected == Plain::of(&after), "seed {seed}, {under_bed:?}");
        }
    }
}

/// All ways to find paths.
fn all_paths(grid: &VoxelGrid, element: &Element) -> Vec<(&'static str, Box<dyn Paths>)> {
    vec![
        ("ground", Box::new(GroundPaths::new(grid, element))),
        ("climbed", Box::new(PathMap::new(grid, element, PathCost::Climbed))),
        ("in slice", Box::new(PathMap::new(grid, element, PathCost::InSlice))),
    ]
}

#[test]
fn grow_leaves_nothing_hanging_and_every_grown_voxel_is_on_a_supporting_path() {
    for seed in 0..5 {
        let before = grid_of(&blobs(&mut Rng::with_seed(seed), [70, 48, 48]));
        for (name, element) in elements() {
            for (paths, map) in all_paths(&before, &element) {
                let case = format!("seed {seed}, {name}, {paths}");
                let mut grid = before.clone();
                let mut changes = grow(&mut grid, &element, &*map, 7);
                assert!(unsupported(&grid, &element).is_empty(), "{case}: left something hanging");
                assert!(before.solid_voxels().all(|voxel| grid.is_solid(voxel)), "{case}: removed");
                for [x, y, z] in grid.solid_voxels().filter(|&voxel| !before.is_solid(voxel)) {
                    assert_eq!(grid.material([x, y, z]), 7, "{case}");
                    let near = (-4..=4).flat_map(|dy| (-4..=4).map(move |dx| [x as i32 + dx, y as i32 + dy]));
                    let near = near
                        .filter(|place| place.iter().all(|&n| n >= 0))
                        .map(|place| place.map(|n| n as usize));
                    let mut above = near.filter(|&[x, y]| grid.is_solid([x, y, z + 1]));
                    let carries = above.any(|place| element.carriers(z, place, [70, 48]).contains(&[x, y]));
                    assert!(carries, "{case}: [{x}, {y}, {z}] carries nothing");
                    let Some(Why::GrownFor(cause)) = changes.why(&grid, &element, [x, y, z]) else {
                        panic!("{case}: no reason for [{x}, {y}, {z}]")
                    };
                    assert!(before.is_solid(cause) && cause[2] > z, "{case}: grown for {cause:?}");
                }
                changes.swap(&mut grid);
                assert!(grid.same_solid(&before), "{case}: not undone");
            }
        }
    }
}

#[test]
fn the_distance_on_the_bed_gives_the_cost_in_closed_form() {
    for seed in 0..4 {
        let grid = grid_of(&blobs(&mut Rng::with_seed(seed), [64, 40, 40]));
        for (name, element) in elements() {
            let paths = GroundPaths::new(&grid, &element);
            let costs = Plain::ground_costs(&grid, &element, &paths);
            for (z, layer) in costs.iter().enumerate() {
                for (at, &cost) in layer.iter().enumerate() {
                    let [x, y] = [at % 64, at / 64];
                    let distance = usize::from(paths.distance([x, y]));
                    // Exact for the square, and wherever the bed's solid can be reached.
                    if name == "square" || distance <= z {
                        assert_eq!(cost, z.max(distance), "seed {seed}, {name}: [{x}, {y}, {z}]");
                    }
                    if z > 0 {
                        let [px, py] = paths.below([x, y, z]);
                        let below = costs[z - 1][py * 64 + px];
                        let carriers = element.carriers(z - 1, [x, y], [64, 40]);
                        let best = Plain::cheapest_below(&costs[z - 1], &carriers, 64);
                        if name == "square" || distance <= z {
                            assert_eq!(below, best, "seed {seed}, {name}: the path from [{x}, {y}, {z}]");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_path_map_finds_the_cheapest_paths() {
    for seed in 0..3 {
        let grid = grid_of(&blobs(&mut Rng::with_seed(seed), [70, 33, 30]));
        for (name, element) in elements() {
            let ground = GroundPaths::new(&grid, &element);
            for cost in [PathCost::Climbed, PathCost::InSlice] {
                let map = PathMap::new(&grid, &element, cost);
                let costs = Plain::solid_costs(&grid, &element, &ground, cost == PathCost::InSlice);
                for z in 1..30 {
                    for (x, y) in (0..33).flat_map(|y| (0..70).map(move |x| (x, y))) {
                        let [px, py] = map.below([x, y, z]);
                        let carriers = element.carriers(z - 1, [x, y], [70, 33]);
                        assert!(carriers.contains(&[px, py]), "seed {seed}, {name}: {px}, {py}");
                        let best = Plain::cheapest_below(&costs[z - 1], &carriers, 70);
                        assert_eq!(costs[z - 1][py * 70 + px], best, "seed {seed}, {name}: [{x}, {y}, {z}]");
                    }
                }
            }
        }
    }
}

#[test]
fn islands_and_overhangs_are_told_apart() {
    let element = Element::round(OverhangAngle::from_degrees(45.0).expect("legal"), super::reference::size())
        .expect("legal");
    let mut grid = VoxelGrid::new(cubic([32, 32, 4]));
    for x in 0..8 {
        grid.set_solid([x, 8, 0], true);
    }
    for x in 0..16 {
        grid.set_solid([x, 8, 1], true);
    }
    grid.set_solid([20, 20, 2], true);
    let changes = trim_with_changes(&mut grid, &element);
    assert_eq!(changes.why(&grid, &element, [15, 8, 1]), Some(Why::TooSteep));
    assert_eq!(changes.why(&grid, &element, [20, 20, 2]), Some(Why::Island));
    assert_eq!(changes.why(&grid, &element, [3, 8, 1]), None);
    assert_eq!(changes.why(&grid, &element, [99, 8, 1]), None);
}
