//! From a drawing to closed smooth curves with corners.
//!
//! [`fit`] reads strokes the way a person does: it joins them by their ends, closes gaps, cuts overshoots, leaves
//! decorations out and takes loops inside loops as holes. What is left is smoothed as far as the strokes are
//! shaky, corners kept, and refined on a thin-plate spline through the samples. [`fit_open`] gives lines that do
//! not close, for trajectories and previews. Neither knows what the curve will become.

mod banded;
mod chains;
mod closing;
mod corners;
mod cut_corners;
mod fair;
mod folds;
mod groups;
mod holders;
mod line;
mod lobes;
mod outline;
mod polygon;
mod raster;
mod silhouette;
mod variational;
mod way;

use blobtree::{Drawing, Holes};
use corners::Wishes;
use glam::DVec2;
use line::Frame;

/// The closed curves of a drawing, mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Outlines and holes, the largest first; they neither cross nor touch each other.
    pub contours: Vec<Contour>,
    /// Strokes that are not part of an outline, by their place in the drawing, ascending.
    pub left_out: Vec<usize>,
}

/// One closed curve, dense enough to be read as a polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contour {
    /// The curve in order, mm, without repeating the first point: counter-clockwise around what is solid,
    /// clockwise around holes.
    pub points: Vec<DVec2>,
    /// Which of the points are sharp corners, ascending.
    pub corners: Vec<usize>,
}

impl Contour {
    /// Whether what is solid lies outside.
    pub fn is_hole(&self) -> bool {
        polygon::area(&self.points) < 0.0
    }
}

/// Why a drawing has no outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoOutline {
    /// There is no stroke with a finite point.
    #[error("nothing is drawn yet; draw a closed outline")]
    Nothing,
    /// All strokes are dots.
    #[error("there are only dots; draw a line that comes back to where it began")]
    Dots,
    /// No line comes back to itself.
    #[error("the line does not close: its ends are {gap:.1} mm apart; bring them together")]
    Open {
        /// Distance between the ends of the longest line, mm.
        gap: f64,
    },
    /// The strokes lie on a straight line, or go back the way they came.
    #[error("the lines go there and back and leave no room inside; draw around an area")]
    Flat,
    /// There is an outline, but no field can be made of it.
    #[error("{reason}")]
    NoField {
        /// What the template says.
        reason: String,
    },
}

/// The lines of a drawing that do not close, from end to end, mm: for trajectories and previews.
///
/// Strokes that follow each other are joined; each line is smoothed as far as it is shaky, its ends kept.
pub fn fit_open(drawing: &Drawing) -> Vec<Vec<DVec2>> {
    let Some(frame) = Frame::of(drawing) else { return Vec::new() };
    let chains = chains::chains(line::clean(drawing, &frame));
    let open = chains.iter().filter(|chain| !chain.closed);
    let smooth = open.map(|chain| fair::fair_open(&chain.samples));
    smooth.map(|line| line.into_iter().map(|p| frame.global(p)).collect()).collect()
}

/// The closed curves that a drawing means.
///
/// - **Promises:** contours are simple and apart from each other; which way strokes run does not matter.
/// - **Cost:** some ms for an ordinary drawing, whatever its number of samples is beyond a few thousand.
/// - **Source:** Schmidt & Wyvill 2011, §11.2.2. **Departs:** corners are kept; strokes are put in order and
///   smoothed along their length before the plane's spline sees them, so that noise cannot tear the curve.
pub fn fit(drawing: &Drawing) -> Result<Curve, NoOutline> {
    let frame = Frame::of(drawing).ok_or(NoOutline::Nothing)?;
    let lines = line::clean(drawing, &frame);
    if lines.is_empty() {
        return Err(NoOutline::Dots);
    }
    let local = |places: &[glam::Vec2]| {
        places.iter().filter(|p| p.is_finite()).map(|p| frame.local(p.as_dvec2())).collect()
    };
    let wishes = Wishes { rounded: local(&drawing.rounded), sharpened: local(&drawing.sharpened) };
    let found =
        outline::outline(lines, &wishes, drawing.holes == Holes::Fill).map_err(|reason| match reason {
            NoOutline::Open { gap } => NoOutline::Open { gap: gap * frame.size() },
            other => other,
        })?;
    let global = |contour: Contour| Contour {
        points: contour.points.into_iter().map(|p| frame.global(p)).collect(),
        ..contour
    };
    Ok(Curve {
        contours: variational::refined(found.contours).into_iter().map(global).collect(),
        left_out: (0..drawing.strokes.len()).filter(|stroke| !found.used.contains(stroke)).collect(),
    })
}
