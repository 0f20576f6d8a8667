//! The stroke that is drawn besides an outline: a path, an axis, or mere decoration.

use super::commands::path_of;
use crate::stroke::{Placement, Sketch};
use blobtree::Template;
use glam::Vec2;

/// The most that a straight stroke may leave the line between its ends, as a part of it: an axis is drawn with
/// care, 0.03; a path that bends by 0.1 is meant to bend.
const STRAIGHT: f32 = 0.06;

/// The least distance of a path from the outline, as a part of the outline's larger side. Tails, sticks and
/// stalks touch what they belong to or miss it by up to 0.03; people leave room for what they mean to pull.
const APART: f32 = 0.05;

/// The least part that the longest stroke makes up of all beside the outline: slips of the pen are less than a
/// tenth; wheels, whiskers and rays come in numbers.
const ALONE: f32 = 0.9;

/// The shortest path, as a part of the outline's larger side: shorter ones do not leave the outline's own room.
const SHORTEST: f32 = 0.5;

/// The longest of the strokes that are no part of the outline.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Companion {
    /// Its places, pixels, thinned out; empty without such a stroke.
    pub path: Vec<Vec2>,
    /// Whether it is straight.
    pub straight: bool,
    /// Whether it can only be meant for the outline to be moved along or turned about: alone, long enough, and
    /// clear of the outline; a straight one may also go through all of it, from one side to the other.
    pub meant: bool,
}

impl Companion {
    /// Looks at the strokes of the sketch that the outline of this template leaves out.
    pub fn of(sketch: &Sketch, left_out: &[usize], template: &Template, placement: &Placement) -> Self {
        let strokes = left_out.iter().filter_map(|&place| sketch.strokes.get(place)).map(path_of);
        let paths: Vec<(f32, Vec<Vec2>)> = strokes.map(|path| (length(&path), path)).collect();
        let all: f32 = paths.iter().map(|(length, _)| length).sum();
        let longest =
            paths.into_iter().filter(|(length, _)| *length > 0.0).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((length, path)) = longest else { return Self::default() };
        let straight = is_straight(&path);
        let size = extent(template);
        let apart = (APART * size).min(template.falloff);
        let clear = |px: &Vec2| template.distance.value(placement.mm_from_px(*px)) >= apart;
        let ends = [path.first(), path.last()];
        let is_clear = if straight { ends.into_iter().flatten().all(clear) } else { path.iter().all(clear) };
        let long = length * placement.mm_per_px >= SHORTEST * size;
        Self { straight, meant: is_clear && long && length >= ALONE * all, path }
    }

    /// Whether the outline is to be turned about it.
    pub fn is_axis(&self) -> bool {
        self.straight && self.meant
    }
}

fn length(path: &[Vec2]) -> f32 {
    path.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// The larger side of the box around the curve, mm.
fn extent(template: &Template) -> f32 {
    let bounds = crate::stroke::bounds(template.contours.iter().flatten().copied());
    bounds.map_or(0.0, |[low, high]| (high - low).max_element())
}

fn is_straight(path: &[Vec2]) -> bool {
    let (Some(first), Some(last)) = (path.first(), path.last()) else { return false };
    let along = *last - *first;
    let chord = along.length();
    chord > 0.0 && path.iter().all(|p| (*p - *first).perp_dot(along).abs() <= STRAIGHT * chord * chord)
}
