//! Imported meshes: signed distance to triangles, then the falloff of every solid.

use super::Kernel;
use super::frame::Frame;
use super::skeleton::falloff_bound;
use crate::falloff::Falloff;
use crate::field::{Aabb, Interval};
use crate::scalar::{Scalar, Slope, Triple, dot, scaled};
use glam::Vec3;
use mesh::MeshDistance;
use std::sync::Arc;

/// A mesh with its place and falloff.
#[derive(Clone, Debug)]
pub(crate) struct Import {
    frame: Frame,
    distance: Arc<MeshDistance>,
    falloff: Falloff,
    inv_reach2: f32,
}

impl Import {
    pub fn new(frame: Frame, distance: Arc<MeshDistance>, falloff: Falloff) -> Self {
        Self { frame, distance, falloff, inv_reach2: falloff.reach.powi(-2) }
    }
}

impl Kernel for Import {
    /// The direction to the surface counts as constant: exact over faces, and over edges and corners of the
    /// mesh in value and gradient, though not in second derivatives.
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        let q = self.frame.apply(p);
        let place = Vec3::from_array(q.map(S::value));
        // Far from the surface, on both sides, the field is constant, and the search for it short.
        let limit = self.falloff.width().max(self.falloff.core);
        let signed = self.distance.signed_distance_within(place, limit);
        if signed >= self.falloff.width() || signed <= -self.falloff.core {
            return Slope::constant(if signed > 0.0 { 0.0 } else { 1.0 });
        }
        let Some(nearest) = self.distance.nearest(place) else {
            return Slope::constant(0.0);
        };
        let out = nearest.gradient.to_array().map(S::of);
        // The distance with its derivatives: how far `q` moves along the gradient from where it is.
        let moved = std::array::from_fn(|a| q[a] - S::of(place[a]));
        let d = S::of(nearest.signed_distance) + dot(moved, out);
        let e = (d + S::of(self.falloff.core)).larger(S::of(0.0));
        let t = (S::of(1.0) - e * e * S::of(self.inv_reach2)).larger(S::of(0.0));
        let slope = S::of(-6.0 * self.inv_reach2) * t * t * e;
        Slope::new(t * t * t, self.frame.pull_back(scaled(out, slope))).on(nearest.triangle)
    }

    fn bound(&self, region: &Aabb) -> Interval {
        let range = self.frame.range(region);
        let (lo, hi) = self.distance.bound(range.center, range.radius());
        let core = self.falloff.core;
        falloff_bound(lo + core, hi + core, self.inv_reach2)
    }

    fn creased(&self, _region: &Aabb) -> bool {
        true
    }

    fn is_faceted(&self) -> bool {
        true
    }
}
