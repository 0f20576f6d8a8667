//! From a drawing's file to its curve, and from the curve to a node of the tree.

use crate::cli::{SketchArgs, SolidKind};
use crate::failure::Failure;
use crate::input;
use crate::job::Job;
use blobtree::{
    Drawing, Holes, Node, Polyline, PolylinePoint, Primitive, RevolutionAxis, Shape, SketchPlane,
};
use glam::{Vec2, Vec3};
use sketch::curve::{self, Curve, NoOutline};
use sketch::solid::Outline;
use sketch::stroke::{self, Placement, Sketch, Standing};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The radius of a tube along a line that does not close, as a share of the drawing's larger side.
const TUBE: f32 = 0.03;

/// Most points of a tube along one stroke.
const TUBE_POINTS: usize = 1024;

/// A drawing from a file, with the curve that its strokes mean.
#[derive(Debug)]
pub struct Drawn {
    /// The file.
    pub path: PathBuf,
    /// The strokes, mm: the middle of the lowest edge is the origin.
    pub drawing: Arc<Drawing>,
    curve: Result<Curve, NoOutline>,
}

/// What a drawing became.
#[derive(Debug)]
pub struct Solid {
    /// The node.
    pub node: Node,
    /// How it was made; never [`SolidKind::Auto`].
    pub kind: SolidKind,
    /// Strokes that are no part of it.
    pub left_out: usize,
}

/// Reads a drawing and fits its curve. Stages "read", "clean" and "curve".
///
/// Errors: a file that cannot be read or holds no strokes.
pub fn open(path: &Path, args: &SketchArgs, job: &mut Job) -> Result<Drawn, Failure> {
    let strokes = job.stage("read", |_| {
        let bytes = input::read_whole(path, stroke::MAX_FILE_BYTES)?;
        let format = stroke::detect(&bytes, Some(path)).map_err(|e| Failure::of(path, e))?;
        let choice = args.doodle.clone().unwrap_or_default();
        stroke::read(&bytes, format, &choice).map_err(|e| Failure::of(path, e))
    })?;
    let drawing = job.stage("clean", |_| {
        let sketch = Sketch::from_strokes(&strokes);
        let holes = if args.fill_holes { Holes::Fill } else { Holes::Keep };
        let placed = Placement::of_size(&sketch, args.size as f32, Standing::OnGround).drawing(&sketch);
        Ok(Arc::new(Drawing { holes, ..placed }))
    })?;
    let curve = job.stage("curve", |_| Ok(curve::fit(&drawing)))?;
    Ok(Drawn { path: path.to_owned(), drawing, curve })
}

impl Drawn {
    /// The outlines and holes, if there are any.
    pub fn curve(&self) -> Option<&Curve> {
        self.curve.as_ref().ok()
    }

    /// Why there is no outline, if there is none.
    pub fn no_outline(&self) -> Option<&NoOutline> {
        self.curve.as_ref().err()
    }

    /// The least and greatest coordinates of the strokes, mm.
    pub fn bounds(&self) -> [Vec2; 2] {
        let places = || self.drawing.strokes.iter().flat_map(|stroke| &stroke.points).map(|p| p.at);
        let Some(first) = places().next() else { return [Vec2::ZERO; 2] };
        places().fold([first; 2], |[low, high], p| [low.min(p), high.max(p)])
    }

    /// The solid of this kind that stands at `place`, mm. Stage "template".
    ///
    /// Errors: a kind that needs an outline where there is none.
    pub fn solid(
        &self,
        kind: SolidKind,
        args: &SketchArgs,
        place: Vec3,
        job: &mut Job,
    ) -> Result<Solid, Failure> {
        let plane = SketchPlane { origin: place, ..SketchPlane::default() };
        let kind = match (kind, &self.curve) {
            (SolidKind::Auto, Ok(_)) => SolidKind::Inflate,
            (SolidKind::Auto, Err(NoOutline::Open { .. })) => SolidKind::Line,
            (kind, _) => kind,
        };
        if kind == SolidKind::Line {
            return Ok(Solid { node: self.tubes(args, &plane)?, kind, left_out: 0 });
        }
        let curve = self.curve.as_ref().map_err(|e| Failure::of(&self.path, e))?;
        let outline = job.stage("template", |_| self.outline(curve, plane, args))?;
        let primitive = primitive(kind, &outline, args);
        Ok(Solid { node: Node::new(Shape::Primitive(primitive)), kind, left_out: curve.left_out.len() })
    }

    /// The outline alone, without the strokes beside it.
    fn outline(&self, curve: &Curve, plane: SketchPlane, args: &SketchArgs) -> Result<Outline, Failure> {
        let strokes = self.drawing.strokes.iter().enumerate();
        let own = strokes.filter(|(i, _)| !curve.left_out.contains(i)).map(|(_, stroke)| stroke.clone());
        let drawing = Arc::new(Drawing { strokes: own.collect(), ..(*self.drawing).clone() });
        let falloff = args.falloff.map(|mm| mm as f32);
        let template = sketch::solve(&drawing, falloff).map_err(|e| Failure::of(&self.path, e))?;
        Ok(Outline { drawing, plane, template })
    }

    /// Tubes along all strokes, in the plane.
    fn tubes(&self, args: &SketchArgs, plane: &SketchPlane) -> Result<Node, Failure> {
        let [low, high] = self.bounds();
        let radius = args.thickness.map_or(TUBE * (high - low).max_element(), |mm| 0.5 * mm as f32);
        let place = |p: Vec2| plane.point(p + Vec2::Y * radius);
        let lines = self.drawing.strokes.iter().map(|stroke| {
            let step = stroke.points.len().div_ceil(TUBE_POINTS).max(1);
            let kept = stroke.points.iter().enumerate();
            let kept = kept.filter(|(i, _)| i % step == 0 || i + 1 == stroke.points.len());
            let points = kept.map(|(_, p)| PolylinePoint { at: place(p.at), radius }).collect();
            Node::new(Shape::Primitive(Primitive::Polyline(Polyline { points, falloff: None })))
        });
        let lines: Vec<Node> = lines.collect();
        if lines.is_empty() {
            return Err(Failure::of(&self.path, NoOutline::Nothing));
        }
        Ok(blobtree::build::union(lines))
    }
}

/// The primitive of this kind, with the sizes that were asked for.
fn primitive(kind: SolidKind, outline: &Outline, args: &SketchArgs) -> Primitive {
    let mm = |length: Option<f64>| length.map(|mm| mm as f32);
    match kind {
        SolidKind::Sweep => {
            let sweep = outline.sweep();
            let length = mm(args.thickness).unwrap_or(sweep.length);
            let fillet = mm(args.fillet).unwrap_or(0.0).min(0.5 * length);
            Primitive::LinearSweep(blobtree::LinearSweep {
                length,
                fillet,
                falloff: mm(args.falloff),
                ..sweep
            })
        }
        SolidKind::Revolve => {
            let axis = args.axis.map(|x| RevolutionAxis { at: Vec2::new(x as f32, 0.0), direction: Vec2::Y });
            Primitive::Revolution(blobtree::Revolution {
                falloff: mm(args.falloff),
                ..outline.revolution(axis)
            })
        }
        SolidKind::Inflate | SolidKind::Auto | SolidKind::Line => Primitive::Inflation(blobtree::Inflation {
            thickness: mm(args.thickness),
            contrast: args.contrast,
            pressure: args.pressure,
            falloff: mm(args.falloff),
            ..outline.inflation()
        }),
    }
}
