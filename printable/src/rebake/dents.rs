//! Dents: places where the field is lowered a little, on a lattice twice as fine as that of the limit.

use super::TOP;
use super::cone::{Depths, Known, deepen};
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

    /// Lowers `node`, in its own space, where pieces of it hang; says in which boxes that can be felt.
    pub fn press(&mut self, node: &dyn Field, pieces: &[Piece]) -> Vec<Aabb> {
        let mut depths = self.depths(node, pieces);
        let node_from_upright = self.upright_from_node.inverse();
        let spacing = self.spacing;
        let mut known = Known::new(node, |[z, y, x]: [i32; 3]| {
            let upright = Brick::lattice_point([x, y, z], spacing).as_dvec3();
            node_from_upright.transform_point3(upright).as_vec3()
        });
        known.follow(&mut depths);
        known.look(depths.keys().flat_map(|at| with_beside(*at)));
        let mut keys = BTreeSet::new();
        for [z, y, x] in depths.keys() {
            // Samples beside a brick's own are kept in it, too.
            let near = |at: i32| [-1, 1].map(|by| (at + by).div_euclid(VOXEL_BRICK as i32));
            for z in near(*z) {
                for y in near(*y) {
                    keys.extend(near(*x).map(|x| [x, y, z]));
                }
            }
        }
        let keys: Vec<[i32; 3]> = keys.into_iter().collect();
        let pressed: Vec<Vec<f32>> =
            keys.par_iter().map(|key| pressed(*key, &depths, |at| known.value(at))).collect();
        for (key, pressed) in keys.iter().zip(pressed) {
            let samples = self.bricks.entry(*key).or_insert_with(|| vec![TOP; VOXEL_SAMPLES]);
            samples.iter_mut().zip(pressed).for_each(|(sample, pressed)| *sample = sample.min(pressed));
        }
        keys.iter().map(|key| self.reach_of(*key)).collect()
    }

    /// The box, in the node's space, in which this brick can be felt.
    fn reach_of(&self, key: [i32; 3]) -> Aabb {
        let corner = |by: i32, beyond: f32| {
            let index = key.map(|key| (key + by) * VOXEL_BRICK as i32);
            Brick::lattice_point(index, self.spacing) + beyond * self.spacing
        };
        let upright = Aabb { min: corner(0, -1.0), max: corner(1, 0.0) };
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
    fn depths(&self, node: &dyn Field, pieces: &[Piece]) -> Depths {
        let sampled = |sampler: &mut Box<dyn Sampler + '_>, piece: &Piece| {
            let places: Vec<Vec3> = piece.places.iter().map(|place| place.as_vec3()).collect();
            let mut samples = vec![Sample::default(); places.len()];
            sampler.enter(Aabb::of_points(places.iter().copied()));
            sampler.samples(&places, &mut samples);
            sampler.leave();
            samples
        };
        let samples: Vec<Vec<Sample>> = pieces.par_iter().map_init(|| node.sampler(), sampled).collect();
        let mut depths = Depths::new();
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
    fn dent(&self, place: DVec3, depth: f32, depths: &mut Depths) {
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
                        deepen(depths, [z, y, x], depth);
                    }
                }
            }
        }
    }
}

/// The samples of a brick with these dents only, sharpened as the limit's are; of a field with these values, by layer, row
/// and column.
fn pressed(key: [i32; 3], depths: &Depths, value: impl Fn([i32; 3]) -> f32) -> Vec<f32> {
    let mut samples = vec![TOP; VOXEL_SAMPLES];
    let first = key.map(|key| key * VOXEL_BRICK as i32 - 1);
    let lowered = |at: [i32; 3]| value(at) - depths.get(&at).copied().unwrap_or(0.0);
    for z in 0..SIDE {
        for y in 0..SIDE {
            let row = [first[2] + z as i32, first[1] + y as i32];
            let ends = [first[0], first[0] + SIDE as i32].map(|x| [row[0], row[1], x]);
            for (at, _) in depths.range(ends[0]..ends[1]) {
                let own = lowered(*at);
                let around: f32 = beside(*at).map(&lowered).sum();
                let x = (at[2] - first[0]) as usize;
                samples[x + SIDE * (y + SIDE * z)] = (own - 0.125 * (around - 6.0 * own)).clamp(0.0, TOP);
            }
        }
    }
    samples
}

/// The six places beside one.
fn beside(at: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (0..3).flat_map(move |a| {
        [-1, 1].map(|by| {
            let mut beside = at;
            beside[a] += by;
            beside
        })
    })
}

/// A place and the six beside it.
fn with_beside(at: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    beside(at).chain([at])
}
