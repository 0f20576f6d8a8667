//! What stands above dents and leans on them follows them up, until the field carries it again.
//!
//! This is the trim rule, on the dents' own lattice and only where dents take something from what carries a place. So
//! one round of settling does what slices would ask for layer by layer. A place is lowered by no more than that: what
//! the field itself lacks is for the slices to say.

use super::TOP;
use super::disc::greatest;
use blobtree::{Aabb, Field, ISO, Sampler};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// By how much the field is to be lowered, by layer, row and column of the lattice; less than nothing where it could
/// be higher and still be carried.
pub(super) type Depths = BTreeMap<[i32; 3], f32>;

/// How far a layer of the lattice may reach beyond the one below, in steps. Less than what the field was trimmed with,
/// and dents go up to the end of all that leans out; more, and slices find more: at 1, dice take a round more.
const REACH: f32 = 0.97;

/// A dent that is less deep is none. With ten times as much, the cones' sharp rims make meshes so rough that a bunny
/// is not settled in 16 rounds; with less, cones get larger.
const FELT: f32 = 1e-4;

/// How much higher the field might be at a place of the rim that is still written down.
const SLACK: f32 = 0.05;

/// Values so far from ½ are nowhere near the surface.
const NEAR_SURFACE: f32 = 0.15;

/// Places that are looked at in one go.
const PLACES: usize = 64;

/// The field at places of the lattice where it was looked at.
pub(super) struct Known<'a, P> {
    field: &'a dyn Field,
    place: P,
    values: HashMap<[i32; 3], f32>,
}

impl<'a, P: Fn([i32; 3]) -> Vec3 + Sync> Known<'a, P> {
    /// Nothing yet; `place` says where in the field's space the lattice's places are.
    pub fn new(field: &'a dyn Field, place: P) -> Self {
        Self { field, place, values: HashMap::new() }
    }

    /// Looks at these places, too.
    pub fn look(&mut self, places: impl Iterator<Item = [i32; 3]>) {
        let mut new: Vec<[i32; 3]> = places.filter(|at| !self.values.contains_key(at)).collect();
        new.sort_unstable();
        new.dedup();
        let look = |sampler: &mut Box<dyn Sampler + '_>, chunk: &[[i32; 3]]| {
            let places: Vec<Vec3> = chunk.iter().map(|at| (self.place)(*at)).collect();
            let mut values = vec![0.0; places.len()];
            sampler.enter(Aabb::of_points(places.iter().copied()));
            sampler.values(&places, &mut values);
            sampler.leave();
            values
        };
        let values: Vec<Vec<f32>> = new.par_chunks(PLACES).map_init(|| self.field.sampler(), look).collect();
        self.values.extend(new.into_iter().zip(values.into_iter().flatten()));
    }

    /// The value at a place that was looked at; 0 at others.
    pub fn value(&self, at: [i32; 3]) -> f32 {
        self.values.get(&at).copied().unwrap_or(0.0)
    }

    /// Lets what is above dents follow them.
    pub fn follow(&mut self, depths: &mut Depths) {
        let mut next = depths.keys().next().map(|at| at[0]);
        while let Some(layer) = next {
            self.follow_once(layer, depths);
            next = depths.range(first_of(layer + 1)..).next().map(|(at, _)| at[0]);
        }
    }

    /// Lets the layer above this one follow it.
    fn follow_once(&mut self, layer: i32, depths: &mut Depths) {
        let dents = depths.range(first_of(layer)..first_of(layer + 1)).filter(|(_, depth)| **depth > FELT);
        let leaning: BTreeSet<[i32; 3]> = dents.flat_map(|([z, y, x], _)| around([z + 1, *y, *x])).collect();
        let carrying = leaning.iter().flat_map(|[z, y, x]| around([z - 1, *y, *x]));
        self.look(leaning.iter().copied().chain(carrying));
        let followed = leaning.iter().filter_map(|at| {
            let own = self.value(*at).min(TOP);
            let [before, after] = self.carried(*at, depths);
            let depth = own.min(before) - after;
            let near = own > ISO - NEAR_SURFACE && after < ISO + NEAR_SURFACE;
            (near && depth > -SLACK).then_some((*at, depth))
        });
        let followed: Vec<([i32; 3], f32)> = followed.collect();
        for (at, depth) in followed {
            deepen(depths, at, depth);
        }
    }

    /// What the layer below carries at a place, before and after it is dented.
    fn carried(&self, [z, y, x]: [i32; 3], depths: &Depths) -> [f32; 2] {
        let below = [-1, 0, 1].map(|dy| [-1, 0, 1].map(|dx| [z - 1, y + dy, x + dx]));
        let before = below.map(|row| row.map(|at| self.value(at).min(TOP)));
        let mut after = before;
        for (value, at) in after.as_flattened_mut().iter_mut().zip(below.as_flattened()) {
            *value -= depths.get(at).map_or(0.0, |depth| depth.max(0.0));
        }
        [before, after].map(|patch| greatest(patch, REACH))
    }
}

/// Makes a dent at least so deep.
pub(super) fn deepen(depths: &mut Depths, at: [i32; 3], depth: f32) {
    let deepest = depths.entry(at).or_insert(depth);
    *deepest = depth.max(*deepest);
}

fn first_of(layer: i32) -> [i32; 3] {
    [layer, i32::MIN, i32::MIN]
}

/// A place and the eight beside it in its layer.
fn around([z, y, x]: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| [z, y + dy, x + dx]))
}
