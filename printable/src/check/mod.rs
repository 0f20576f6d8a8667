//! Does it print without supports? An answer from the mesh alone, whatever made it.
//!
//! Reach for [`PrintCheck::new`] with a mesh and its [`Slices`]. It tests equation 1 on exact polygons, layer by
//! layer, and looks for islands, steep facets, closed voids, thin walls and whether the part stands. Nothing here
//! knows how support-free shapes are made, so it can judge those who make them. Bridges are not credited: a flat
//! ceiling hangs, however short it is.
//!
//! ```
//! use mesh::shapes::cuboid;
//! use printable::check::{CheckSettings, PrintCheck};
//! use printable::slices::{Slices, Watch};
//!
//! let mut table = cuboid([-5.0, -5.0, 0.0].into(), [5.0, 5.0, 20.0].into());
//! table.append(&cuboid([-20.0, -20.0, 20.0].into(), [20.0, 20.0, 25.0].into()));
//! let settings = CheckSettings::default();
//! let slices = Slices::new(&table, settings.rule.layer_height, settings.bottom, &Watch::default())?;
//! let check = PrintCheck::new(&table, &slices, &settings, &Watch::default())?;
//! assert!(!check.is_printable());
//! assert_eq!(check.findings[0].layer, Some(80));
//! # Ok::<(), printable::slices::SliceError>(())
//! ```
//!
//! A [`Certificate`] is what such a check said, as text that travels with the part.

mod certificate;
mod excess;
mod facets;
mod finding;
mod layers;
mod stance;
mod walls;

pub use certificate::{Certificate, CertificateError, Doubt};
pub use facets::{Steep, Void};
pub use finding::{Finding, Kind, MOST_FINDINGS};
pub use layers::{LayerCheck, Spot};
pub use stance::Stance;
pub use walls::Walls;

use crate::SupportRule;
use crate::slices::{Bottom, SliceError, Slices, Watch};
use glam::DVec3;
use layers::Judged;
use mesh::Mesh;

/// Unsupported area of one layer that still prints, mm².
pub const LAYER_TOLERANCE: f64 = 0.1;
/// Unsupported area of a whole part that counts as none, mm².
pub const PART_TOLERANCE: f64 = 0.05;

/// What is asked of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckSettings {
    /// Layer height and largest overhang.
    pub rule: SupportRule,
    /// Where the bed is.
    pub bottom: Bottom,
    /// What is added to the rule's reach before something counts as unsupported, mm.
    pub tolerance_mm: f64,
    /// What is added to the rule's overhang before a facet counts as steep, radians.
    pub angle_tolerance: f64,
    /// Unsupported area wider than this is also told apart, mm.
    pub sliver_mm: f64,
    /// How far above the bed still counts as contact, mm.
    pub contact_mm: f64,
    /// Walls thinner than this are told, mm.
    pub thin_wall_mm: f64,
}

impl Default for CheckSettings {
    /// The default rule, a tolerance of 0.01 mm and 0.5°, slivers of 0.1 mm, contact up to 0.05 mm, and walls of
    /// 0.4 mm, one line of the usual nozzle.
    fn default() -> Self {
        Self {
            rule: SupportRule::default(),
            bottom: Bottom::default(),
            tolerance_mm: 0.01,
            angle_tolerance: 0.5_f64.to_radians(),
            sliver_mm: 0.1,
            contact_mm: 0.05,
            thin_wall_mm: 0.4,
        }
    }
}

impl CheckSettings {
    /// How far a layer may reach beyond the one below, without tolerance, mm.
    pub(crate) fn rule_reach_mm(&self) -> f64 {
        // As degrees and millimetres were meant, not as the nearest `f32`: 45° has a tangent of 1.
        let degrees = (f64::from(self.rule.overhang.degrees()) * 1e4).round() / 1e4;
        let layer_height = (f64::from(self.rule.layer_height.mm()) * 1e6).round() / 1e6;
        layer_height * degrees.to_radians().tan()
    }

    /// How far a layer may reach beyond the one below before it counts as unsupported, mm.
    pub(crate) fn reach_mm(&self) -> f64 {
        self.rule_reach_mm() + self.tolerance_mm
    }
}

/// What the check found out about a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintCheck {
    /// What was asked.
    pub settings: CheckSettings,
    /// Each layer, from the bottom up.
    pub layers: Vec<LayerCheck>,
    /// The largest hanging places, largest first; at most 20 of each layer.
    pub spots: Vec<Spot>,
    /// Facets that lean out too far.
    pub steep: Steep,
    /// Closed voids.
    pub voids: Vec<Void>,
    /// How it stands.
    pub stance: Stance,
    /// How thick its walls are; none if no ray met a facing wall.
    pub walls: Option<Walls>,
    /// Everything worth telling, kind by kind, the largest first.
    pub findings: Vec<Finding>,
}

impl PrintCheck {
    /// Checks a part. `slices` must be those of `mesh` at the layer height and from the bottom in `settings`.
    ///
    /// - **Definition:** S(k+1) must lie within S(k) grown by a disc of h · tan θ plus a tolerance, with S(k) the
    ///   slice in the middle of layer k. Layer 0 lies on the bed.
    /// - **Errors:** [`SliceError::Cancelled`], and what keeps a mesh from being sliced just above the bed.
    /// - **Cost:** O(n log n) in the points of all outlines for ordinary shapes. Growing an outline that curves
    ///   inwards is quadratic in the number of its points within the rule's reach of each other.
    /// - **Source:** Reiner & Lefebvre 2016, equation 1. **Departs:** exact polygons, where they have voxels; a
    ///   tolerance, as meshes are made of rounded numbers.
    pub fn new(
        mesh: &Mesh,
        slices: &Slices,
        settings: &CheckSettings,
        watch: &Watch,
    ) -> Result<Self, SliceError> {
        let judged = layers::judge(slices, settings, watch)?;
        let facets = facets::look(mesh, slices.planes.bottom, settings);
        let mut spots: Vec<Spot> = judged.iter().flat_map(|judged| judged.spots.iter().copied()).collect();
        spots.sort_by(|a, b| b.area.total_cmp(&a.area));
        let mut check = Self {
            settings: *settings,
            layers: judged.iter().map(|Judged { layer, .. }| *layer).collect(),
            spots,
            steep: facets.steep,
            voids: facets.voids,
            stance: stance::stance(mesh, slices.planes.bottom, settings.contact_mm)?,
            walls: walls::walls(mesh, settings.thin_wall_mm),
            findings: Vec::new(),
        };
        check.findings = finding::findings(&check, &check.spots, &open_outlines(slices));
        Ok(check)
    }

    /// Unsupported area of all layers together, mm².
    pub fn unsupported(&self) -> f64 {
        self.layers.iter().map(|layer| layer.unsupported).sum()
    }

    /// The layer with the most unsupported area.
    pub fn worst_layer(&self) -> Option<(usize, &LayerCheck)> {
        let layers = self.layers.iter().enumerate().rev();
        layers.max_by(|a, b| a.1.unsupported.total_cmp(&b.1.unsupported))
    }

    /// Unsupported area that is wider than a sliver, mm².
    pub fn wide(&self) -> f64 {
        self.layers.iter().map(|layer| layer.wide).sum()
    }

    /// Regions that share no area with the layer below.
    pub fn islands(&self) -> usize {
        self.layers.iter().map(|layer| layer.islands).sum()
    }

    /// How far the farthest point lies beyond the reach of the layer below, mm; 0 if nothing hangs over something.
    pub fn largest_excess(&self) -> f64 {
        self.spots.iter().filter_map(|spot| spot.excess).fold(0.0, f64::max)
    }

    /// Whether no layer has any area.
    pub fn is_empty(&self) -> bool {
        self.layers.iter().all(|layer| layer.area == 0.0)
    }

    /// Whether every layer holds the next, but for what prints tolerate: no islands, and nowhere more than
    /// [`LAYER_TOLERANCE`] in one layer. All layers must be complete, and not all may be empty.
    pub fn is_printable(&self) -> bool {
        !self.is_empty()
            && self
                .layers
                .iter()
                .all(|l| l.islands == 0 && l.open_outlines == 0 && l.unsupported <= LAYER_TOLERANCE)
    }

    /// Whether every layer holds the next: as [`Self::is_printable`], with no more than [`PART_TOLERANCE`] in all
    /// layers together. This is what keeps slicers from adding a single support.
    pub fn is_support_free(&self) -> bool {
        self.is_printable() && self.unsupported() <= PART_TOLERANCE
    }
}

/// Where outlines begin that do not close, with their layers.
fn open_outlines(slices: &Slices) -> Vec<(usize, DVec3)> {
    let layers = slices.layers.iter().zip(&slices.planes.heights).enumerate();
    layers.flat_map(|(k, (layer, &z))| layer.open.iter().map(move |p| (k, p.extend(z)))).collect()
}

#[cfg(test)]
mod tests;
