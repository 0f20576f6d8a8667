//! Many constraints by parts: splines on overlapping patches, joined by smooth weights that sum to 1.

use super::system::{Site, Spline, Unsolvable};
use glam::DVec2;
use rayon::prelude::*;

/// Most sites that are solved as one system: beyond, the solution takes more than 25 ms.
const MOST_IN_ONE: usize = 1300;

/// Most sites in a patch, the anchors apart.
const MOST_IN_PATCH: usize = 330;

/// Sites from all over that every patch knows, so that none is at a loss outside its own.
const ANCHORS: usize = 40;

/// Half of the width of the overlap, as a share of the extent that is cut.
const OVERLAP: f64 = 0.08;

/// A spline and where it counts.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub spline: Spline,
    cuts: Vec<Cut>,
}

/// One side of a straight cut through the plane, fading over a strip around it.
#[derive(Clone, Copy, Debug)]
struct Cut {
    axis: usize,
    at: f64,
    half: f64,
    /// 1 for the side of the larger coordinates, −1 for the other.
    side: f64,
}

impl Cut {
    /// The weight (0 to 1) and its slope along the axis.
    fn weight(self, p: DVec2) -> (f64, f64) {
        let t = (0.5 + 0.5 * self.side * (p[self.axis] - self.at) / self.half).clamp(0.0, 1.0);
        let slope = 30.0 * t * t * (1.0 - t) * (1.0 - t) * 0.5 * self.side / self.half;
        (t * t * t * (10.0 + t * (6.0 * t - 15.0)), slope)
    }
}

impl Patch {
    /// Fits one patch if that is quick enough, else as many as it takes.
    pub fn fit(sites: &[Site]) -> Result<Vec<Self>, Unsolvable> {
        if sites.len() <= MOST_IN_ONE {
            return Ok(vec![Self { spline: Spline::fit(sites)?, cuts: Vec::new() }]);
        }
        let mut parts = Vec::new();
        divide((0..sites.len()).collect(), Vec::new(), sites, &mut parts);
        let anchors = (0..ANCHORS).map(|i| i * sites.len() / ANCHORS);
        parts
            .into_par_iter()
            .map(|(mut members, cuts)| {
                members.extend(anchors.clone());
                members.sort_unstable();
                members.dedup();
                let members: Vec<Site> = members.into_iter().map(|i| sites[i]).collect();
                Ok(Self { spline: Spline::fit(&members)?, cuts })
            })
            .collect()
    }

    /// The share of this patch at a place, 0 to 1, and its gradient. Over all patches, shares sum to 1.
    pub fn share(&self, p: DVec2) -> (f64, DVec2) {
        let (mut share, mut gradient) = (1.0, DVec2::ZERO);
        for cut in &self.cuts {
            let (weight, slope) = cut.weight(p);
            gradient *= weight;
            gradient[cut.axis] += share * slope;
            share *= weight;
        }
        (share, gradient)
    }

    /// Whether this patch alone counts, or not at all, in a box; none if its share may vary.
    pub fn share_in_box(&self, low: DVec2, high: DVec2) -> Option<bool> {
        let mut alone = true;
        for cut in &self.cuts {
            let ends = [low[cut.axis], high[cut.axis]].map(|x| cut.side * (x - cut.at) / cut.half);
            if ends[0].max(ends[1]) <= -1.0 {
                return Some(false);
            }
            alone &= ends[0].min(ends[1]) >= 1.0;
        }
        alone.then_some(true)
    }
}

/// Halves a set of sites until each is small, along the longer side.
fn divide(members: Vec<usize>, cuts: Vec<Cut>, sites: &[Site], parts: &mut Vec<(Vec<usize>, Vec<Cut>)>) {
    let halves = if members.len() <= MOST_IN_PATCH { None } else { halve(&members, sites) };
    let Some((cut, below, above)) = halves else {
        parts.push((members, cuts));
        return;
    };
    for (half, side) in [(below, -1.0), (above, 1.0)] {
        let mut cuts = cuts.clone();
        cuts.push(Cut { side, ..cut });
        divide(half, cuts, sites, parts);
    }
}

/// The cut and the sites that matter on either side; none if no cut makes the sets much smaller.
fn halve(members: &[usize], sites: &[Site]) -> Option<(Cut, Vec<usize>, Vec<usize>)> {
    let places = || members.iter().map(|&i| sites[i].at);
    let extent = places().fold(DVec2::MIN, DVec2::max) - places().fold(DVec2::MAX, DVec2::min);
    let longer = usize::from(extent.y > extent.x);
    for axis in [longer, 1 - longer] {
        let mut along: Vec<f64> = places().map(|p| p[axis]).collect();
        along.sort_unstable_by(f64::total_cmp);
        let at = along[along.len() / 2];
        let mut half = OVERLAP * extent[axis];
        for _ in 0..6 {
            let side = |sign: f64| -> Vec<usize> {
                members.iter().copied().filter(|&i| sign * (sites[i].at[axis] - at) >= -half).collect()
            };
            let (below, above) = (side(-1.0), side(1.0));
            if half > 0.0 && 5 * below.len().max(above.len()) <= 4 * members.len() {
                return Some((Cut { axis, at, half, side: 1.0 }, below, above));
            }
            half *= 0.5;
        }
    }
    None
}
