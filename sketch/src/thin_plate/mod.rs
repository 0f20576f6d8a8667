//! Thin-plate splines: the smoothest function of the plane through given values.
//!
//! [`ThinPlate::fit`] takes values at places; [`ThinPlate::value`] reads the spline anywhere and
//! [`ThinPlate::sample_grid`] on a whole grid, far faster than place by place. A [`CornerRidge`] is the kink
//! that a sharp corner puts into a distance field, which no smooth spline can hold: take the ridges off the
//! values before the fit and put them back when reading.

mod corner;
mod image;
mod kernel;
mod patches;
mod system;

pub use corner::CornerRidge;
pub use image::Grid;

use glam::DVec2;
use patches::Patch;
use pulp::Arch;
use system::Site;

/// A value that the spline should take at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// The place, in any unit of length.
    pub at: DVec2,
    /// The value there.
    pub value: f64,
    /// How far the spline may leave the value to be smoother, from 0: not at all.
    ///
    /// The spline minimises `Σ (miss)²/smoothing + ∫|D²f|²/8π`, measured in lengths of twice the largest
    /// distance of a place from their middle, so that the size of the drawing does not matter. For a few hundred
    /// places 1e-5 takes off a tremor, 1e-3 rounds the shape.
    pub smoothing: f64,
}

/// Why no spline can be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Fewer than three different places.
    #[error("a spline needs values at three different places, not {found}")]
    TooFew {
        /// Different places.
        found: usize,
    },
    /// More constraints than [`ThinPlate::MOST_CONSTRAINTS`].
    #[error("{found} constraints are too many for a spline, which takes at most {most}; thin them out")]
    TooMany {
        /// As asked for.
        found: usize,
        /// What is allowed.
        most: usize,
    },
    /// A place, value or smoothing that is no finite number, or a smoothing below 0.
    #[error("constraint {index} has a number that is not finite, or a negative smoothing")]
    BadNumber {
        /// Which constraint, counted from 0.
        index: usize,
    },
    /// All places on one line.
    #[error("the constraints all lie on one line, which leaves the slope across it open")]
    OnALine,
}

/// A thin-plate spline.
///
/// Up to 1,300 constraints it is the exact one. Beyond, splines on overlapping patches of up to about 370
/// constraints are joined with C² weights.
///
/// **Source:** Duchon 1977; Schmidt & Wyvill 2011, §11.3.3 calls it variational interpolation.
#[derive(Clone, Debug)]
pub struct ThinPlate {
    middle: DVec2,
    /// Length of the unit inside.
    scale: f64,
    patches: Vec<Patch>,
}

impl ThinPlate {
    /// Most constraints of a fit.
    pub const MOST_CONSTRAINTS: usize = 4000;

    /// Fits the spline. Constraints at the same place (to a millionth of their extent) count as one with the
    /// mean of their values, weighed by their smoothing.
    ///
    /// - **Promises:** moving, turning and scaling the constraints does the same to the spline (exactly up to
    ///   1,300 constraints; the patches beyond are cut along the axes).
    /// - **Cost:** O(n³) to 1,300 constraints (3 ms for 600), then O(n).
    pub fn fit(constraints: &[Constraint]) -> Result<Self, FitError> {
        let (found, most) = (constraints.len(), Self::MOST_CONSTRAINTS);
        if found > most {
            return Err(FitError::TooMany { found, most });
        }
        let bad = |c: &Constraint| {
            !(c.at.is_finite() && c.value.is_finite() && c.smoothing.is_finite() && c.smoothing >= 0.0)
        };
        if let Some(index) = constraints.iter().position(bad) {
            return Err(FitError::BadNumber { index });
        }
        if constraints.is_empty() {
            return Err(FitError::TooFew { found });
        }
        let middle = constraints.iter().map(|c| c.at / found as f64).sum::<DVec2>();
        let reach = constraints.iter().map(|c| c.at.distance(middle)).fold(0.0, f64::max);
        let scale = 2.0 * reach;
        if !(scale.is_finite() && scale.recip().is_finite()) {
            return Err(FitError::TooFew { found: 1 });
        }
        let sites = merged(constraints, |p| (p - middle) / scale);
        if sites.len() < 3 {
            return Err(FitError::TooFew { found: sites.len() });
        }
        let patches = Patch::fit(&sites).map_err(|system::Unsolvable| FitError::OnALine)?;
        Ok(Self { middle, scale, patches })
    }

    /// The value at a place. O(constraints).
    pub fn value(&self, p: DVec2) -> f64 {
        let (arch, p) = (Arch::new(), self.inside(p));
        let part = |patch: &Patch| {
            let (share, _) = patch.share(p);
            if share > 0.0 { share * patch.spline.value(arch, p) } else { 0.0 }
        };
        self.patches.iter().map(part).sum()
    }

    /// The gradient at a place. O(constraints).
    pub fn gradient(&self, p: DVec2) -> DVec2 {
        let (arch, p) = (Arch::new(), self.inside(p));
        let mut gradient = DVec2::ZERO;
        for patch in &self.patches {
            let (share, slope) = patch.share(p);
            if share > 0.0 {
                gradient += share * patch.spline.gradient(p);
                if slope != DVec2::ZERO {
                    gradient += slope * patch.spline.value(arch, p);
                }
            }
        }
        gradient / self.scale
    }

    fn inside(&self, p: DVec2) -> DVec2 {
        (p - self.middle) / self.scale
    }
}

/// The constraints in the frame of the fit, those at the same place joined, ordered by place.
fn merged(constraints: &[Constraint], inside: impl Fn(DVec2) -> DVec2) -> Vec<Site> {
    const SAME: f64 = 1e-6;
    let mut sites: Vec<Site> = constraints
        .iter()
        .map(|c| Site { at: inside(c.at), value: c.value, smoothing: c.smoothing })
        .collect();
    sites.sort_by(|a, b| {
        a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)).then(a.value.total_cmp(&b.value))
    });
    let mut out: Vec<(Site, f64)> = Vec::with_capacity(sites.len());
    for site in sites {
        let near = out.iter_mut().rev().take_while(|(o, _)| site.at.x - o.at.x <= SAME);
        let same = near.into_iter().find(|(o, _)| (site.at.y - o.at.y).abs() <= SAME);
        // How much a constraint is to be believed; one without smoothing all but silences those with.
        let trust = (site.smoothing + 1e-15).recip();
        if let Some((other, sum)) = same {
            other.value += (site.value - other.value) * trust / (*sum + trust);
            *sum += trust;
            other.smoothing = if other.smoothing.min(site.smoothing) == 0.0 { 0.0 } else { sum.recip() };
        } else {
            out.push((site, trust));
        }
    }
    out.into_iter().map(|(site, _)| site).collect()
}

#[cfg(test)]
mod tests;
