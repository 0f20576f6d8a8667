//! Dents: places where the field is lowered a little, on a lattice twice as fine as that of the limit.

use super::TOP;
use super::hanging::Piece;
use blobtree::{
    Aabb, Beyond, Brick, Field, ISO, ParameterError, Sample, Sampler, SupportFree, VOXEL_BRICK,
    VOXEL_SAMPLES, VoxelBrick, VoxelImage,
};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How far around a hanging place a dent is as deep as there, and where it ends, in lattice steps.
const BOTTOM: f32 = 1.0;
const RIM: f32 = 2.5;

/// Where a dent ends below a hanging place, in lattice steps: not as far down as the layer below, or that would carry
/// less in turn.
const UNDER: f32 = 2.0;

/// How much deeper dents are than what hangs: as much again as the filter of the image takes from them.
const DEEPER: f32 = 1.25;

/// How far the surface is moved beyond what hangs, mm; and beyond an island, which must not come back elsewhere.
const MARGIN_MM: f32 = 0.005;
const ISLAND_MARGIN_MM: f32 = 0.03;

const SIDE: usize = VOXEL_BRICK + 2;

/// Samples along each side of what is looked at for a brick: one more again, to sharpen by.
const WIDE: usize = SIDE + 2;

/// Dents close together, not yet made.
#[derive(Debug)]
pub(super) struct Pressed {
    /// A box in the node's own space, outside which they are not felt.
    pub dirty: Aabb,
    /// Keys and samples of bricks.
    bricks: Vec<([i32; 3], Vec<f32>)>,
}

/// A limit that consists of dents.
#[derive(Debug)]
pub(super) struct Dents {
    spacing: f32,
    upright_from_node: DAffine3,
    /// By key, as in [`VoxelBrick`].
    bricks: BTreeMap<[i32; 3], Vec<f32>>,
}

impl Dents {
    /// None yet.
    pub fn new(rule: &SupportFree) -> Self {
        let stretch = rule.overhang_degrees.to_radians().tan();
        let steps = 2.0 * (stretch - 1e-3).ceil().max(1.0);
        let spacing = rule.layer_height * stretch / steps;
        Self { spacing, upright_from_node: rule.upright_from_child(), bricks: BTreeMap::new() }
    }

    /// How far apart the places of a piece may be, mm.
    pub fn pitch(&self) -> f64 {
        f64::from(self.spacing)
    }

    /// What is to be made for `node`, in its own space, to be lower where pieces of it hang.
    pub fn press(&self, node: &dyn Field, pieces: &[Piece]) -> Vec<Pressed> {
        let depths = self.depths(node, pieces);
        let mut keys = BTreeSet::new();
        for place in depths.keys() {
            // Samples beside a brick's own are kept in it, too.
            let near = |a: usize| [-1, 1].map(|by| (place[a] + by).div_euclid(VOXEL_BRICK as i32));
            for z in near(2) {
                for y in near(1) {
                    keys.extend(near(0).map(|x| [x, y, z]));
                }
            }
        }
        let press = |sampler: &mut Box<dyn Sampler + '_>, cluster: Vec<[i32; 3]>| {
            let dirty = self.reach_of(&cluster);
            let pressed = |key| (key, self.pressed(&mut **sampler, key, &depths));
            Pressed { dirty, bricks: cluster.into_iter().map(pressed).collect() }
        };
        clusters(keys).into_par_iter().map_init(|| node.sampler(), press).collect()
    }

    /// Makes dents.
    pub fn add(&mut self, pressed: &Pressed) {
        for (key, pressed) in &pressed.bricks {
            let samples = self.bricks.entry(*key).or_insert_with(|| vec![TOP; VOXEL_SAMPLES]);
            samples.iter_mut().zip(pressed).for_each(|(sample, pressed)| *sample = sample.min(*pressed));
        }
    }

    /// The box, in the node's space, in which any of these bricks can be felt.
    fn reach_of(&self, keys: &[[i32; 3]]) -> Aabb {
        let corner = |key: &[i32; 3], by: i32, beyond: f32| {
            let index = key.map(|key| (key + by) * VOXEL_BRICK as i32);
            Brick::lattice_point(index, self.spacing) + beyond * self.spacing
        };
        let ends = keys.iter().flat_map(|key| [corner(key, 0, -1.0), corner(key, 1, 0.0)]);
        let upright = Aabb::of_points(ends);
        let node_from_upright = self.upright_from_node.inverse();
        Aabb::of_points(
            upright.corners().map(|corner| node_from_upright.transform_point3(corner.as_dvec3()).as_vec3()),
        )
    }

    /// All dents.
    ///
    /// Errors: dents too far apart for one image.
    pub fn image(&self) -> Result<VoxelImage, ParameterError> {
        let bricks: Vec<VoxelBrick> = self
            .bricks
            .iter()
            .map(|(key, samples)| VoxelBrick { key: *key, samples: samples.clone() })
            .collect();
        // Outside there is no limit, so the box ends where there are no bricks.
        let step = VOXEL_BRICK as i32;
        let low = |a: usize| bricks.iter().map(|brick| brick.key[a]).min().unwrap_or(0) - 1;
        let high = |a: usize| bricks.iter().map(|brick| brick.key[a]).max().unwrap_or(0) + 1;
        let ends =
            [std::array::from_fn(|a| low(a) * step), std::array::from_fn(|a| high(a) * step + step - 1)];
        VoxelImage::new(self.spacing, TOP, Beyond::NoLimit, ends, &bricks)
    }

    /// By how much the field is to be lowered at places of the lattice.
    fn depths(&self, node: &dyn Field, pieces: &[Piece]) -> BTreeMap<[i32; 3], f32> {
        let sampled = |sampler: &mut Box<dyn Sampler + '_>, piece: &Piece| {
            let places: Vec<Vec3> = piece.places.iter().map(|place| place.as_vec3()).collect();
            let mut samples = vec![Sample::default(); places.len()];
            sampler.enter(Aabb::of_points(places.iter().copied()));
            sampler.samples(&places, &mut samples);
            sampler.leave();
            samples
        };
        let samples: Vec<Vec<Sample>> = pieces.par_iter().map_init(|| node.sampler(), sampled).collect();
        let mut depths = BTreeMap::new();
        for (piece, samples) in pieces.iter().zip(&samples) {
            let margin = if piece.island { ISLAND_MARGIN_MM } else { MARGIN_MM };
            for (place, sample) in piece.places.iter().zip(samples) {
                let depth = (sample.value - ISO).abs() + margin * sample.gradient.length();
                self.dent(*place, DEEPER * depth, &mut depths);
            }
        }
        depths
    }

    /// One dent.
    fn dent(&self, place: DVec3, depth: f32, depths: &mut BTreeMap<[i32; 3], f32>) {
        let middle = (self.upright_from_node.transform_point3(place) / f64::from(self.spacing)).as_vec3();
        let span = |x: f32, down: f32| (x - down).ceil() as i32..=(x + RIM).floor() as i32;
        let slope = |x: f32| ((RIM - x) / (RIM - BOTTOM)).clamp(0.0, 1.0);
        for z in span(middle.z, UNDER) {
            let up = z as f32 - middle.z;
            let share = if up < 0.0 { 1.0 + up / UNDER } else { slope(up) };
            for y in span(middle.y, RIM) {
                for x in span(middle.x, RIM) {
                    let depth = depth * share * slope((x as f32 - middle.x).hypot(y as f32 - middle.y));
                    if depth > 0.0 {
                        let deepest = depths.entry([x, y, z]).or_insert(0.0);
                        *deepest = depth.max(*deepest);
                    }
                }
            }
        }
    }

    /// The samples of a brick with these dents only, sharpened as the limit's are.
    fn pressed(
        &self,
        sampler: &mut dyn Sampler,
        key: [i32; 3],
        depths: &BTreeMap<[i32; 3], f32>,
    ) -> Vec<f32> {
        let first = key.map(|key| key * VOXEL_BRICK as i32 - 2);
        let depths: Vec<Option<f32>> = (0..WIDE * WIDE * WIDE)
            .map(|i| {
                let at = at(i, WIDE);
                let index: [i32; 3] = std::array::from_fn(|a| first[a] + at[a] as i32);
                depths.get(&index).copied()
            })
            .collect();
        let own: Vec<usize> = (0..VOXEL_SAMPLES).map(wide).filter(|i| depths[*i].is_some()).collect();
        let mut needed: Vec<usize> =
            own.iter().flat_map(|i| BESIDE.iter().flat_map(move |step| [i - step, i + step])).collect();
        needed.extend(&own);
        needed.sort_unstable();
        needed.dedup();
        let node_from_upright = self.upright_from_node.inverse();
        let place = |i: &usize| {
            let at = at(*i, WIDE);
            let index = std::array::from_fn(|a| first[a] + at[a] as i32);
            let upright = Brick::lattice_point(index, self.spacing).as_dvec3();
            node_from_upright.transform_point3(upright).as_vec3()
        };
        let places: Vec<Vec3> = needed.iter().map(place).collect();
        let mut found = vec![0.0; places.len()];
        sampler.enter(Aabb::of_points(places.iter().copied()));
        sampler.values(&places, &mut found);
        sampler.leave();
        let mut values = vec![0.0; WIDE * WIDE * WIDE];
        for (i, value) in needed.into_iter().zip(found) {
            values[i] = value - depths[i].unwrap_or(0.0);
        }
        let sample = |i: usize| {
            let own = wide(i);
            let beside = BESIDE.map(|step| values[own - step] + values[own + step]);
            let sharp = values[own] - 0.125 * (beside.iter().sum::<f32>() - 6.0 * values[own]);
            if depths[own].is_some() { sharp.clamp(0.0, TOP) } else { TOP }
        };
        (0..VOXEL_SAMPLES).map(sample).collect()
    }
}

/// Steps to the next sample along each axis, of those that are looked at.
const BESIDE: [usize; 3] = [1, WIDE, WIDE * WIDE];

fn at(i: usize, side: usize) -> [usize; 3] {
    [i % side, i / side % side, i / side / side]
}

/// The number, of those that are looked at, of a sample of the brick.
fn wide(i: usize) -> usize {
    let [x, y, z] = at(i, SIDE);
    x + 1 + WIDE * (y + 1 + WIDE * (z + 1))
}

/// Bricks that touch each other, together.
fn clusters(mut keys: BTreeSet<[i32; 3]>) -> Vec<Vec<[i32; 3]>> {
    let mut clusters = Vec::new();
    while let Some(first) = keys.pop_first() {
        let mut cluster = vec![first];
        let mut next = 0;
        while let Some(&[x, y, z]) = cluster.get(next) {
            next += 1;
            for dz in -1..=1 {
                for dy in -1..=1 {
                    cluster.extend((-1..=1).filter_map(|dx| keys.take(&[x + dx, y + dy, z + dz])));
                }
            }
        }
        clusters.push(cluster);
    }
    clusters
}
