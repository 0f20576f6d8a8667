//! The outlines of layers before they are filled, for those who look at a small part of them only.

use super::clip::{Region, doubled_area, pairs};
use super::cut;
use super::error::SliceError;
use super::grid::{Grid, Point};
use super::planes::{Bottom, Planes};
use super::rect::Rect;
use super::watch::Watch;
use crate::LayerHeight;
use mesh::Mesh;
use std::collections::HashMap;

/// A closed outline with the solid on its left; outlines of a layer may cross.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline {
    pub(crate) ring: Vec<Point>,
    pub(crate) rect: Rect,
}

/// A part cut into layers whose outlines are not filled: a place is solid where they wind around it a positive
/// number of times.
#[derive(Clone, Debug)]
pub(crate) struct Outlines {
    pub(crate) planes: Planes,
    pub(crate) grid: Grid,
    /// From the bottom up.
    pub(crate) layers: Vec<Vec<Outline>>,
}

impl Outlines {
    /// The outlines of a mesh from its lowest point up.
    ///
    /// Promises and errors: as [`Slices::new`](super::Slices::new).
    pub(crate) fn new(mesh: &Mesh, height: LayerHeight, watch: &Watch) -> Result<Self, SliceError> {
        super::check(mesh)?;
        let bounds = mesh.bounds();
        let planes = Planes::new(&bounds, height, Bottom::LowestPoint)?;
        let grid = Grid::over(&bounds)?;
        let layers = cut(mesh, &planes.heights, grid, watch, |_, loops| {
            outlines_of(loops.closed.into_iter().flat_map(apart))
        })?;
        Ok(Self { planes, grid, layers })
    }

    /// Cuts these layers, in ascending order, anew after a change of the mesh that left its lowest point where it was.
    ///
    /// Errors: as [`Self::new`].
    pub(crate) fn renew(&mut self, mesh: &Mesh, layers: &[usize], watch: &Watch) -> Result<(), SliceError> {
        super::check(mesh)?;
        let heights: Vec<f64> = layers.iter().map(|layer| self.planes.heights[*layer]).collect();
        let cut = cut(mesh, &heights, self.grid, watch, |_, loops| {
            outlines_of(loops.closed.into_iter().flat_map(apart))
        })?;
        for (layer, new) in layers.iter().zip(cut) {
            self.layers[*layer] = new;
        }
        Ok(())
    }
}

fn outlines_of(rings: impl IntoIterator<Item = Vec<Point>>) -> Vec<Outline> {
    let outline = |ring: Vec<Point>| Some(Outline { rect: Rect::of_points(&ring)?, ring });
    rings.into_iter().filter_map(outline).collect()
}

/// A ring as rings that go through no place twice: what hangs together at a place only is not connected.
pub(super) fn apart(ring: Vec<Point>) -> Vec<Vec<Point>> {
    let mut sorted: Vec<[i32; 2]> = ring.iter().map(|p| [p.x, p.y]).collect();
    sorted.sort_unstable();
    if sorted.windows(2).all(|pair| pair[0] != pair[1]) {
        return vec![ring];
    }
    let mut apart = Vec::new();
    let mut way: Vec<Point> = Vec::new();
    let mut places = HashMap::new();
    for p in ring {
        if let Some(&first) = places.get(&[p.x, p.y]) {
            let between = way.split_off(first);
            for p in &between {
                places.remove(&[p.x, p.y]);
            }
            apart.push(between);
        }
        places.insert([p.x, p.y], way.len());
        way.push(p);
    }
    apart.push(way);
    apart.retain(|ring| ring.len() > 2);
    apart
}

impl Outline {
    /// Whether the solid is inside.
    pub(crate) fn is_outer(&self) -> bool {
        doubled_area(&self.ring) > 0
    }

    /// How often it winds around a place, counter-clockwise; 0 on the outline itself.
    pub(crate) fn winding(&self, p: Point) -> i32 {
        if self.rect.contains(p) { winding(&self.ring, p).unwrap_or(0) } else { 0 }
    }
}

/// What of these outlines lies in a box; see [`Rect::clipped`].
pub(crate) fn clipped(outlines: &[Outline], rect: &Rect) -> Vec<Outline> {
    let near = outlines.iter().filter(|outline| rect.is_near(&outline.rect, 0));
    outlines_of(near.map(|outline| rect.clipped(&outline.ring)))
}

/// The rings of outlines, for the clipper.
pub(crate) fn rings(outlines: &[Outline]) -> Vec<&[Point]> {
    outlines.iter().map(|outline| outline.ring.as_slice()).collect()
}

/// Whether a place is in one of these regions, off its rim.
pub(crate) fn is_in(regions: &[Region], p: Point) -> bool {
    regions.iter().any(|region| {
        let windings = region.iter().map(|ring| winding(ring, p));
        windings.sum::<Option<i32>>().is_some_and(|winding| winding > 0)
    })
}

/// How often a ring winds around a place, counter-clockwise; none on the ring itself.
///
/// Source: Sunday 2001, "Inclusion of a point in a polygon".
fn winding(ring: &[Point], p: Point) -> Option<i32> {
    let mut winding = 0;
    for (a, b) in pairs(ring) {
        let upward = a.y <= p.y && p.y < b.y;
        let downward = b.y <= p.y && p.y < a.y;
        let level = a.y == p.y && b.y == p.y;
        if !(upward || downward || level) {
            continue;
        }
        let [ax, ay, bx, by, px, py] = [a.x, a.y, b.x, b.y, p.x, p.y].map(i64::from);
        let left = (bx - ax) * (py - ay) - (px - ax) * (by - ay);
        match left.signum() {
            0 if level && (px < ax.min(bx) || px > ax.max(bx)) => {}
            0 => return None,
            1 if upward => winding += 1,
            -1 if downward => winding -= 1,
            _ => {}
        }
    }
    Some(winding)
}
