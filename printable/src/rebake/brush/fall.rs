//! What would fall if something was not there, and whether that is of note.

use super::canvas::{Canvas, Lowered};
use super::stamp::Stamp;
use blobtree::ISO;
use std::collections::HashSet;

/// The share of a tip that may fall beside what the tip takes, as crumbs.
const CRUMBS: f32 = 0.01;

/// How often that share may have fallen in the end: what falls is judged by places that are solid or not, and falls by
/// values.
const AT_MOST: usize = 4;

/// How far what falls may be, along x and y, from what fell below it.
const NEAR: usize = 2;

/// What is at stake with a dab that takes away.
pub(super) struct Stakes<'a> {
    carve: &'a Stamp,
    /// How many places may still fall beside the tip.
    crumbs: usize,
    /// What was given up.
    fallen: HashSet<[usize; 3]>,
}

impl<'a> Stakes<'a> {
    pub fn of(carve: &'a Stamp) -> Self {
        let taken = carve.values.iter().filter(|value| **value < ISO).count();
        Self { carve, crumbs: (CRUMBS * taken as f32) as usize, fallen: HashSet::new() }
    }

    /// Whether more than crumbs would fall beside the tip if these places of a layer were not solid, and all that was
    /// given up before. If not, they are given up, too.
    pub fn are_high(&mut self, canvas: &Canvas, places: impl Iterator<Item = [usize; 2]>, z: usize) -> bool {
        let solid = |at: [usize; 3]| canvas.value.value(at) >= ISO && !self.fallen.contains(&at);
        let mut falling = Falling::new(places, z);
        let mut fallen = Vec::new();
        let mut beside = 0;
        while !falling.is_empty() {
            fallen.extend(falling.places());
            beside += falling.places().filter(|at| self.is_beside(*at)).count();
            if beside > self.crumbs {
                return true;
            }
            if falling.z + 1 == canvas.sides()[2] {
                break;
            }
            falling = falling.above(solid, canvas.sides());
        }
        self.crumbs -= beside;
        self.fallen.extend(fallen);
        false
    }

    /// Whether hardly more than crumbs fell beside the tip.
    pub fn stand(&self, canvas: &Canvas, lowered: &[Lowered]) -> bool {
        let fell = |lowered: &&Lowered| {
            let at = lowered.at.map(usize::from);
            lowered.value >= ISO && canvas.value.value(at) < ISO && self.is_beside(at)
        };
        lowered.iter().filter(fell).count() <= AT_MOST * self.crumbs
    }

    /// Whether the tip does not take a place.
    fn is_beside(&self, at: [usize; 3]) -> bool {
        let block = &self.carve.block;
        let inside = (0..3).all(|a| (block.low[a]..block.end[a]).contains(&at[a]));
        !inside || self.carve.values[block.index(at)] >= ISO
    }
}

/// Places of a layer, in a box of it.
struct Falling {
    z: usize,
    low: [usize; 2],
    width: usize,
    falls: Vec<bool>,
}

impl Falling {
    fn new(places: impl Iterator<Item = [usize; 2]>, z: usize) -> Self {
        let places: Vec<[usize; 2]> = places.collect();
        let least = |a: usize| places.iter().map(|at| at[a]).min().unwrap_or(0);
        let most = |a: usize| places.iter().map(|at| at[a] + 1).max().unwrap_or(0);
        let low = [least(0), least(1)];
        let [width, depth] = [most(0) - low[0], most(1) - low[1]];
        let mut falls = vec![false; width * depth];
        places.iter().for_each(|at| falls[at[0] - low[0] + width * (at[1] - low[1])] = true);
        Self { z, low, width, falls }
    }

    fn is_empty(&self) -> bool {
        self.falls.is_empty()
    }

    fn places(&self) -> impl Iterator<Item = [usize; 3]> {
        let place = |n: usize| [self.low[0] + n % self.width, self.low[1] + n / self.width, self.z];
        (0..self.falls.len()).filter(|n| self.falls[*n]).map(place)
    }

    fn contains(&self, [x, y]: [usize; 2]) -> bool {
        let (Some(x), Some(y)) = (x.checked_sub(self.low[0]), y.checked_sub(self.low[1])) else {
            return false;
        };
        x < self.width && self.falls.get(x + self.width * y).copied().unwrap_or(false)
    }

    /// What falls with these in the layer above: what is near, but has nothing else below it, nor beside that, where
    /// every second layer reaches along one axis only, which is about as far as a layer may reach.
    fn above(&self, solid: impl Fn([usize; 3]) -> bool, [nx, ny, _]: [usize; 3]) -> Self {
        let depth = self.falls.len() / self.width;
        let around = |low: usize, side: usize, by: usize, most: usize| {
            low.saturating_sub(by)..(low + side + by).min(most)
        };
        let near = |[x, y]: [usize; 2], by: usize| {
            around(y, 1, by, ny).flat_map(move |y| around(x, 1, by, nx).map(move |x| [x, y]))
        };
        let reaches = |a: [usize; 2], b: [usize; 2]| self.z.is_multiple_of(2) || a[0] == b[0] || a[1] == b[1];
        let falls = |at: [usize; 2]| {
            let carries = |below: [usize; 2]| {
                reaches(at, below) && !self.contains(below) && solid([below[0], below[1], self.z])
            };
            solid([at[0], at[1], self.z + 1])
                && near(at, NEAR).any(|below| self.contains(below))
                && !near(at, 1).any(carries)
        };
        let rows = around(self.low[1], depth, NEAR, ny);
        let all = rows.flat_map(|y| around(self.low[0], self.width, NEAR, nx).map(move |x| [x, y]));
        Self::new(all.filter(|at| falls(*at)), self.z + 1)
    }
}
