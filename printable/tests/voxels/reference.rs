//! Operators one voxel at a time, random grids, and the elements that are tried.

use fastrand::Rng;
use printable::{Element, GridShape, GroundPaths, LayerHeight, OverhangAngle, VoxelGrid, VoxelSize};

/// 0.25 mm cubes.
pub fn size() -> VoxelSize {
    VoxelSize::cubic(LayerHeight::from_mm(0.25).expect("legal"))
}

/// That many cubes.
pub fn cubic(voxels: [usize; 3]) -> GridShape {
    GridShape::new(voxels, size(), [0.0; 2]).expect("legal")
}

/// The square, and discs of less than a voxel, of a voxel, and of several steps.
pub fn elements() -> Vec<(&'static str, Element)> {
    let round = |degrees: f32, width: f32| {
        let size = VoxelSize::new(width, LayerHeight::from_mm(0.25).expect("legal")).expect("legal");
        Element::round(OverhangAngle::from_degrees(degrees).expect("legal"), size).expect("coarse enough")
    };
    vec![
        ("square", Element::square()),
        ("30°", round(30.0, 0.25)),
        ("45°", round(45.0, 0.25)),
        ("60°", round(60.0, 0.25)),
        ("60°, fine", round(60.0, 0.125)),
    ]
}

/// A grid, one voxel after the other.
#[derive(Clone, PartialEq)]
pub struct Plain {
    pub size: [usize; 3],
    pub solid: Vec<bool>,
}

impl Plain {
    pub fn new(size: [usize; 3]) -> Self {
        Self { size, solid: vec![false; size.iter().product()] }
    }

    pub fn of(grid: &VoxelGrid) -> Self {
        let mut plain = Self::new(grid.shape().voxels());
        for [x, y, z] in grid.solid_voxels() {
            let at = plain.index([x, y, z]);
            plain.solid[at] = true;
        }
        plain
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// Whether a voxel is solid; those outside are not.
    pub fn at(&self, voxel: [i32; 3]) -> bool {
        let inside = (0..3).all(|axis| (0..self.size[axis] as i32).contains(&voxel[axis]));
        inside && self.solid[self.index(voxel.map(|n| n as usize))]
    }

    pub fn voxels(&self) -> impl Iterator<Item = [i32; 3]> + use<> {
        let [nx, ny, nz] = self.size.map(|n| n as i32);
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    pub fn set(&mut self, voxel: [i32; 3], solid: bool) {
        let at = self.index(voxel.map(|n| n as usize));
        self.solid[at] = solid;
    }

    /// Removes unsupported voxels, in whatever order, until there are none.
    pub fn remove_until_supported(&mut self, element: &Element) {
        loop {
            let hanging: Vec<_> = self
                .voxels()
                .filter(|&[x, y, z]| z > 0 && self.at([x, y, z]))
                .filter(|&[x, y, z]| {
                    let carriers = element.carriers(
                        z as usize - 1,
                        [x, y].map(|n| n as usize),
                        [self.size[0], self.size[1]],
                    );
                    !carriers.into_iter().any(|[x, y]| self.at([x as i32, y as i32, z - 1]))
                })
                .collect();
            if hanging.is_empty() {
                return;
            }
            hanging.into_iter().for_each(|voxel| self.set(voxel, false));
        }
    }

    /// Layer by layer from the top: what the layer above needs.
    pub fn preserve(&mut self, element: &Element, within: Option<&Self>) {
        for z in (0..self.size[2] as i32 - 1).rev() {
            let offsets = element.offsets(z as usize);
            for [x, y, _] in self.voxels().filter(|voxel| voxel[2] == 0) {
                let needed = offsets.iter().all(|[dx, dy]| self.at([x + dx, y + dy, z + 1]));
                if needed && within.is_none_or(|within| within.at([x, y, z])) {
                    self.set([x, y, z], true);
                }
            }
        }
    }

    /// The majority of 27.
    pub fn smoothed(&self, bed_is_solid: bool) -> Self {
        let mut result = Self::new(self.size);
        for [x, y, z] in self.voxels() {
            let around =
                (-1..=1).flat_map(|dz| (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| [dx, dy, dz])));
            let lowest = if bed_is_solid { 0 } else { -1 };
            let count = around.filter(|[dx, dy, dz]| self.at([x + dx, y + dy, (z + dz).max(lowest)])).count();
            result.set([x, y, z], count >= 14);
        }
        result
    }

    /// The least cost of the places of a layer that carry one of the next.
    pub fn cheapest_below(costs: &[usize], carriers: &[[usize; 2]], nx: usize) -> usize {
        carriers.iter().map(|[x, y]| costs[y * nx + x]).min().expect("the place itself")
    }

    /// Layers climbed plus the distance on the bed, by dynamic programming.
    pub fn ground_costs(grid: &VoxelGrid, element: &Element, ground: &GroundPaths) -> Vec<Vec<usize>> {
        let [nx, ny, nz] = grid.shape().voxels();
        let places = move || (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y]));
        let mut costs = vec![places().map(|place| usize::from(ground.distance(place))).collect::<Vec<_>>()];
        for z in 1..nz {
            let below = &costs[z - 1];
            let cost = |at| Self::cheapest_below(below, &element.carriers(z - 1, at, [nx, ny]), nx) + 1;
            costs.push(places().map(cost).collect());
        }
        costs
    }

    /// The same with paths that may start on any solid, and with distances in slices.
    pub fn solid_costs(
        grid: &VoxelGrid,
        element: &Element,
        ground: &GroundPaths,
        slices: bool,
    ) -> Vec<Vec<usize>> {
        let [nx, ny, nz] = grid.shape().voxels();
        let places = move || (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y]));
        let bed = places().map(|place| usize::from(ground.distance(place)).min(4095));
        let mut costs = vec![bed.collect::<Vec<_>>()];
        for z in 1..nz {
            let solid: Vec<_> = places().filter(|&[x, y]| grid.is_solid([x, y, z])).collect();
            let cost = |[x, y]: [usize; 2]| {
                let apart = |&[sx, sy]: &[usize; 2]| sx.abs_diff(x) + sy.abs_diff(y);
                let nearest = solid.iter().map(apart).min().unwrap_or(nx + ny);
                let further = if slices { nearest } else { 0 };
                let carriers = element.carriers(z - 1, [x, y], [nx, ny]);
                let below = Self::cheapest_below(&costs[z - 1], &carriers, nx);
                if nearest == 0 { 0 } else { (below + 1 + further).min(4095) }
            };
            let layer = places().map(cost).collect();
            costs.push(layer);
        }
        costs
    }
}

/// The grid with these voxels.
pub fn grid_of(plain: &Plain) -> VoxelGrid {
    let mut grid = VoxelGrid::new(cubic(plain.size));
    for voxel in plain.voxels().filter(|&voxel| plain.at(voxel)) {
        grid.set_solid(voxel.map(|n| n as usize), true);
    }
    grid
}

/// Voxels at random, of any density in sixteenths, in a grid of at most 64 voxels a side.
pub fn noise(rng: &mut Rng, side: usize) -> VoxelGrid {
    let density = rng.u8(1..16);
    // From the lowest bit of the density on: and-ing halves, or-ing fills half of what is left.
    let word = |rng: &mut Rng| {
        (0..4).fold(
            0u64,
            |word, bit| if density >> bit & 1 == 0 { word & rng.u64(..) } else { word | rng.u64(..) },
        )
    };
    let words: Vec<u64> = (0..side * side).map(|_| word(rng)).collect();
    VoxelGrid::from_words(cubic([side; 3]), &words)
}

/// Balls and boxes, some of them standing on the bed.
pub fn blobs(rng: &mut Rng, size: [usize; 3]) -> Plain {
    let mut plain = Plain::new(size);
    for n in 0..10 {
        let middle: [i32; 3] = std::array::from_fn(|axis| rng.i32(0..size[axis] as i32));
        let middle = if n % 3 == 0 { [middle[0], middle[1], 0] } else { middle };
        let (radius, ball) = (rng.i32(2..11), rng.bool());
        for voxel in plain.voxels() {
            let d: [i32; 3] = std::array::from_fn(|axis| (voxel[axis] - middle[axis]).abs());
            let squares: i32 = d.iter().map(|d| d * d).sum();
            if if ball { squares <= radius * radius } else { d.iter().all(|&d| d <= radius / 2) } {
                plain.set(voxel, true);
            }
        }
    }
    plain
}
