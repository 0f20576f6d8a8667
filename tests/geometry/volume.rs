//! The volume of a solid from its field alone: stratified random points.

use blobtree::{Aabb, Field, ISO, Sampler};
use fastrand::Rng;
use glam::Vec3;

/// Strata along each side of the regions that are sampled together.
const STRATA: usize = 8;

/// A Monte-Carlo estimate, mm³.
#[derive(Clone, Copy, Debug, Default)]
pub struct Volume {
    /// The estimate.
    pub estimate: f64,
    /// Its standard error.
    pub error: f64,
}

impl Volume {
    /// The standard error as a share of the estimate; infinite for nothing.
    pub fn relative_error(&self) -> f64 {
        if self.estimate > 0.0 { self.error / self.estimate } else { f64::INFINITY }
    }
}

/// The volume of the solid of `field` from two random points in every cubic stratum `stratum` mm wide.
///
/// Regions that the field's bounds decide get one random point each, at which the bounds are checked.
pub fn sampled(field: &dyn Field, stratum: f32, seed: u64) -> Volume {
    let support = field.support();
    if support.is_empty() {
        return Volume::default();
    }
    let leaf = stratum * STRATA as f32;
    let levels = (support.size().max_element() / leaf).log2().ceil().max(0.0) as u32;
    let side = leaf * 2.0_f32.powi(levels as i32);
    let mut work =
        Work { sampler: field.sampler(), rng: Rng::with_seed(seed), inside: 0.0, variance: 0.0, leaf };
    work.visit(Aabb { min: support.min, max: support.min + side }, levels);
    Volume { estimate: work.inside, error: work.variance.sqrt() }
}

/// As [`sampled`], with strata fine enough for a standard error below `share`, or as fine as `finest` mm.
pub fn sampled_to(field: &dyn Field, coarsest: f32, finest: f32, share: f64, seed: u64) -> Volume {
    let mut stratum = coarsest;
    loop {
        let volume = sampled(field, stratum, seed);
        if volume.relative_error() < share || stratum / 2.0 < finest {
            return volume;
        }
        stratum /= 2.0;
    }
}

struct Work<'a> {
    sampler: Box<dyn Sampler + 'a>,
    rng: Rng,
    inside: f64,
    variance: f64,
    /// Width of the regions that are sampled, mm.
    leaf: f32,
}

impl Work<'_> {
    fn visit(&mut self, region: Aabb, levels: u32) {
        let bound = self.sampler.enter(region);
        if bound.lo >= ISO || bound.hi < ISO {
            let mut value = [0.0];
            let p = super::point_in(&mut self.rng, &region);
            self.sampler.values(&[p], &mut value);
            assert_eq!(value[0] >= ISO, bound.lo >= ISO, "{} at {p} is not in {bound:?}", value[0]);
            if bound.lo >= ISO {
                self.inside += region.size().as_dvec3().element_product();
            }
        } else if levels == 0 {
            self.sample(&region);
        } else {
            let middle = region.center();
            for corner in region.corners() {
                self.visit(Aabb::from_corners(corner, middle), levels - 1);
            }
        }
        self.sampler.leave();
    }

    fn sample(&mut self, region: &Aabb) {
        let width = self.leaf / STRATA as f32;
        let mut points = Vec::with_capacity(2 * STRATA.pow(3));
        for i in 0..STRATA.pow(3) {
            let at =
                Vec3::new((i % STRATA) as f32, (i / STRATA % STRATA) as f32, (i / STRATA / STRATA) as f32);
            let stratum = Aabb { min: region.min + at * width, max: region.min + (at + 1.0) * width };
            for _ in 0..2 {
                points.push(super::point_in(&mut self.rng, &stratum).clamp(region.min, region.max));
            }
        }
        let mut values = vec![0.0; points.len()];
        self.sampler.values(&points, &mut values);
        let volume = f64::from(width).powi(3);
        for pair in values.chunks_exact(2) {
            let [a, b] = [pair[0] >= ISO, pair[1] >= ISO].map(|inside| f64::from(u8::from(inside)));
            self.inside += volume * (a + b) / 2.0;
            self.variance += (volume * (a - b) / 2.0).powi(2);
        }
    }
}
