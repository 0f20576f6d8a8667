//! Dents: places where the field is lowered a little, on a lattice twice as fine as that of the limit.

use super::TOP;
use super::hanging::Piece;
use blobtree::{
    Aabb, Beyond, Brick, Field, ISO, ParameterError, Sample, SupportFree, VOXEL_BRICK, VOXEL_SAMPLES,
    VoxelBrick, VoxelImage,
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

    /// Lowers `node`, in its own space, where pieces of it hang.
    pub fn press(&mut self, node: &dyn Field, pieces: &[Piece]) {
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
        let keys: Vec<[i32; 3]> = keys.into_iter().collect();
        let pressed: Vec<Vec<f32>> = keys.par_iter().map(|key| self.pressed(node, *key, &depths)).collect();
        for (key, pressed) in keys.iter().zip(pressed) {
            let samples = self.bricks.entry(*key).or_insert_with(|| vec![TOP; VOXEL_SAMPLES]);
            samples.iter_mut().zip(pressed).for_each(|(sample, pressed)| *sample = sample.min(pressed));
        }
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
        let mut depths = BTreeMap::new();
        let mut sampler = node.sampler();
        for piece in pieces {
            let places: Vec<Vec3> = piece.places.iter().map(|place| place.as_vec3()).collect();
            let mut samples = vec![Sample::default(); places.len()];
            sampler.samples(&places, &mut samples);
            let margin = if piece.island { ISLAND_MARGIN_MM } else { MARGIN_MM };
            for (place, sample) in piece.places.iter().zip(&samples) {
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
    fn pressed(&self, node: &dyn Field, key: [i32; 3], depths: &BTreeMap<[i32; 3], f32>) -> Vec<f32> {
        let first = key.map(|key| key * VOXEL_BRICK as i32 - 2);
        let at = |i: usize, side: usize| [i % side, i / side % side, i / side / side];
        let index = |i: usize| {
            let at = at(i, WIDE);
            std::array::from_fn::<i32, 3, _>(|a| first[a] + at[a] as i32)
        };
        let node_from_upright = self.upright_from_node.inverse();
        let place = |index| {
            let upright = Brick::lattice_point(index, self.spacing).as_dvec3();
            node_from_upright.transform_point3(upright).as_vec3()
        };
        let places: Vec<Vec3> = (0..WIDE * WIDE * WIDE).map(|i| place(index(i))).collect();
        let mut values = vec![0.0; places.len()];
        let mut sampler = node.sampler();
        sampler.enter(Aabb::of_points(places.iter().copied()));
        sampler.values(&places, &mut values);
        let depth = |i: usize| depths.get(&index(i)).copied();
        for (i, value) in values.iter_mut().enumerate() {
            *value -= depth(i).unwrap_or(0.0);
        }
        let sample = |i: usize| {
            let [x, y, z] = at(i, SIDE);
            let own = x + 1 + WIDE * (y + 1 + WIDE * (z + 1));
            let beside = [1, WIDE, WIDE * WIDE].map(|step| values[own - step] + values[own + step]);
            let sharp = values[own] - 0.125 * (beside.iter().sum::<f32>() - 6.0 * values[own]);
            if depth(own).is_some() { sharp.clamp(0.0, TOP) } else { TOP }
        };
        (0..VOXEL_SAMPLES).map(sample).collect()
    }
}
