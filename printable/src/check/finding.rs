//! What the check found, with places and words.

use super::{CheckSettings, LAYER_TOLERANCE, PART_TOLERANCE, PrintCheck, Spot};
use glam::DVec3;
use std::fmt;

/// Most findings of one kind that are listed.
pub const MOST_FINDINGS: usize = 100;

/// One thing that was found, and where. Its `Display` says both in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// What it is.
    pub kind: Kind,
    /// The layer, counted from 0, where it is about one.
    pub layer: Option<usize>,
    /// Where, mm.
    pub place: DVec3,
}

/// What can be found. Lengths in mm, areas in mm², volumes in mm³, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Kind {
    /// No layer has any area: the part is flat, thinner than a layer everywhere, or not closed.
    Nothing,
    /// An outline does not close, so its layer is incomplete.
    OpenOutline,
    /// A region with nothing below it.
    Island {
        /// Its area.
        area: f64,
    },
    /// A place beyond the reach of the layer below.
    Hangs {
        /// Its area.
        area: f64,
        /// How far beyond the reach it goes.
        excess: f64,
        /// Whether its layer hangs by more than prints tolerate, [`LAYER_TOLERANCE`].
        serious: bool,
    },
    /// Facets lean out too far, but lie between two slices, so that no layer shows it.
    SteepBetweenLayers {
        /// Their area.
        area: f64,
        /// The largest overhang.
        worst: f64,
    },
    /// The centre of mass is not above the support polygon.
    FallsOver {
        /// How far outside it is; none if the part touches the bed with no area at all.
        outside: Option<f64>,
    },
    /// A wall is thinner than asked for.
    ThinWall {
        /// How thin.
        thickness: f64,
        /// The share of the surface with such walls.
        share: f64,
    },
    /// A void without an opening: what is in it stays in it.
    ClosedVoid {
        /// Its volume.
        volume: f64,
    },
}

impl Kind {
    /// Whether it keeps the part from being printed without supports; the others are good to know.
    pub fn is_serious(&self) -> bool {
        matches!(
            self,
            Self::Nothing | Self::OpenOutline | Self::Island { .. } | Self::Hangs { serious: true, .. }
        )
    }

    /// A short name for programs.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::OpenOutline => "open_outline",
            Self::Island { .. } => "island",
            Self::Hangs { .. } => "hangs",
            Self::SteepBetweenLayers { .. } => "steep_between_layers",
            Self::FallsOver { .. } => "falls_over",
            Self::ThinWall { .. } => "thin_wall",
            Self::ClosedVoid { .. } => "closed_void",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.place;
        match self.layer {
            Some(layer) => write!(f, "layer {layer}, z = {z:.2} mm, at ({x:.2}, {y:.2}): ")?,
            None => write!(f, "at ({x:.2}, {y:.2}, {z:.2}): ")?,
        }
        match self.kind {
            Kind::Nothing => f.write_str("no layer has any area; is the unit right?"),
            Kind::OpenOutline => f.write_str("the outline does not close; the mesh has a hole there"),
            Kind::Island { area } => write!(f, "an island of {area:.2} mm² begins with nothing below it"),
            Kind::Hangs { area, excess, .. } => {
                write!(f, "{area:.2} mm² hangs in the air, up to {excess:.2} mm beyond reach")
            }
            Kind::SteepBetweenLayers { area, worst } => {
                let worst = worst.to_degrees();
                write!(f, "facets of {area:.2} mm² lean out by up to {worst:.1}°, but between two layers; ")?;
                f.write_str("check thinner layers")
            }
            Kind::FallsOver { outside: Some(outside) } => {
                write!(f, "the centre of mass is {outside:.2} mm beside the base; the part falls over")
            }
            Kind::FallsOver { outside: None } => {
                f.write_str("the part touches the bed with no area to stand on")
            }
            Kind::ThinWall { thickness, share } => {
                let share = 100.0 * share;
                write!(f, "the wall is {thickness:.2} mm thin; {share:.1} % of the surface has thin walls")
            }
            Kind::ClosedVoid { volume } => {
                write!(f, "a closed void of {volume:.1} mm³; what is in it stays in it")
            }
        }
    }
}

/// Everything worth telling, kind by kind in the order of [`Kind`], the largest first.
pub(super) fn findings(check: &PrintCheck, spots: &[Spot], open: &[(usize, DVec3)]) -> Vec<Finding> {
    let settings = &check.settings;
    let open = open.iter().take(MOST_FINDINGS);
    let open = open.map(|&(layer, place)| Finding { kind: Kind::OpenOutline, layer: Some(layer), place });
    let at = |spot: &Spot, kind| Finding { kind, layer: Some(spot.layer), place: spot.place };
    let islands = spots.iter().filter(|spot| spot.island).take(MOST_FINDINGS);
    let islands = islands.map(|spot| at(spot, Kind::Island { area: spot.area }));
    let told = if check.unsupported() > PART_TOLERANCE { MOST_FINDINGS } else { 0 };
    let hanging = spots.iter().filter(|spot| !spot.island).take(told).map(|spot| {
        let serious = check.layers[spot.layer].unsupported > LAYER_TOLERANCE;
        at(spot, Kind::Hangs { area: spot.area, excess: spot.excess.unwrap_or(0.0), serious })
    });
    let nothing = Finding { kind: Kind::Nothing, layer: None, place: check.stance.foot };
    let nothing = check.is_empty().then_some(nothing).into_iter();
    let mut all: Vec<Finding> = nothing.chain(open).chain(islands).chain(hanging).collect();
    all.extend(steep(check));
    all.extend(falls_over(check));
    all.extend(thin_wall(check, settings));
    all.extend(check.voids.iter().take(MOST_FINDINGS).map(|void| {
        let kind = Kind::ClosedVoid { volume: void.volume };
        Finding { kind, layer: None, place: void.place }
    }));
    all
}

/// Steep facets that no layer shows, if they are larger than rounding explains.
fn steep(check: &PrintCheck) -> Option<Finding> {
    let area = check.steep.outside + check.steep.inside;
    let hidden = area > 1.0 && check.unsupported() == 0.0;
    let (place, worst) = check.steep.place.zip(check.steep.worst)?;
    hidden.then_some(Finding { kind: Kind::SteepBetweenLayers { area, worst }, layer: None, place })
}

fn falls_over(check: &PrintCheck) -> Option<Finding> {
    let place = check.stance.centre?;
    let outside = check.stance.margin.map(|margin| -margin);
    let falls = outside.is_none_or(|outside| outside > 0.0);
    falls.then_some(Finding { kind: Kind::FallsOver { outside }, layer: None, place })
}

/// A wall that is too thin, unless only single rays met it: those may have met the rim of something sharp.
fn thin_wall(check: &PrintCheck, settings: &CheckSettings) -> Option<Finding> {
    let walls =
        check.walls.filter(|walls| walls.thinnest < settings.thin_wall_mm && walls.thin_share > 0.001)?;
    let kind = Kind::ThinWall { thickness: walls.thinnest, share: walls.thin_share };
    Some(Finding { kind, layer: None, place: walls.place })
}
