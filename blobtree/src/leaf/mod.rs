//! Primitives compiled for evaluation: each a formula for value and gradient, bounds, and its place.

mod chain;
mod extrusion;
mod frame;
mod import;
mod inflated;
mod pipe;
pub(crate) mod polygon;
mod reach;
mod revolved;
mod section;
mod skeleton;
mod sketched;
mod solid;
mod voxels;

use crate::eval::Crease;
use crate::falloff::Falloff;
use crate::field::{Aabb, Interval};
use crate::primitive::Primitive;
use crate::scalar::{Scalar, Slope, Triple};
use chain::Chain;
use extrusion::Extrusion;
pub(crate) use frame::Frame;
use frame::upright;
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use import::Import;
use inflated::Inflated;
use pipe::Pipe;
use polygon::Outline;
pub(crate) use reach::support;
use revolved::Revolved;
pub(crate) use skeleton::PurePoint;
use skeleton::{Circle, Line, Origin, Plate, PureSkeletal, Skeletal};
use solid::{Fallen, Frustum, Ground, RoundBox, SharpBox, Spheroid, Tube};
pub(crate) use voxels::Voxels;

/// What every leaf can do, in the space of evaluation.
pub(crate) trait Kernel: Send + Sync {
    /// Value and gradient. Written once for plain numbers and for jets; unused parts cost nothing.
    fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S>;

    /// Bounds of the values in `region`; never too tight.
    fn bound(&self, region: &Aabb) -> Interval;

    /// Whether the gradient may jump somewhere in `region`.
    fn creased(&self, region: &Aabb) -> bool;

    /// Whether it is creased at the edges of many facets, most of them faint, so that only samples tell where that
    /// matters.
    fn is_faceted(&self) -> bool {
        false
    }
}

/// A compiled primitive.
#[derive(Clone, Debug)]
pub(crate) enum Leaf {
    PurePoint(PurePoint),
    PureBall(PureSkeletal<Origin>),
    Ball(Skeletal<Origin>),
    PureLine(PureSkeletal<Line>),
    Line(Skeletal<Line>),
    PurePlate(PureSkeletal<Plate>),
    Plate(Skeletal<Plate>),
    PureCircle(PureSkeletal<Circle>),
    Circle(Skeletal<Circle>),
    PureOutline(PureSkeletal<Outline>),
    Outline(Skeletal<Outline>),
    Chain(Fallen<Chain>),
    SharpBox(Fallen<SharpBox>),
    RoundBox(Fallen<RoundBox>),
    Tube(Fallen<Tube>),
    Frustum(Fallen<Frustum>),
    Spheroid(Fallen<Spheroid>),
    Ground(Fallen<Ground>),
    Import(Import),
    Inflated(Inflated),
    Extrusion(Fallen<Extrusion>),
    Revolved(Fallen<Revolved>),
    Pipe(Fallen<Pipe>),
    Voxels(Voxels),
}

/// Runs `$body` with `$kernel` bound to the leaf's own type, so that loops over samples are compiled for it.
macro_rules! with_kernel {
    ($leaf:expr, $kernel:ident => $body:expr) => {
        match $leaf {
            $crate::leaf::Leaf::PurePoint($kernel) => $body,
            $crate::leaf::Leaf::PureBall($kernel) => $body,
            $crate::leaf::Leaf::Ball($kernel) => $body,
            $crate::leaf::Leaf::PureLine($kernel) => $body,
            $crate::leaf::Leaf::Line($kernel) => $body,
            $crate::leaf::Leaf::PurePlate($kernel) => $body,
            $crate::leaf::Leaf::Plate($kernel) => $body,
            $crate::leaf::Leaf::PureCircle($kernel) => $body,
            $crate::leaf::Leaf::Circle($kernel) => $body,
            $crate::leaf::Leaf::PureOutline($kernel) => $body,
            $crate::leaf::Leaf::Outline($kernel) => $body,
            $crate::leaf::Leaf::Chain($kernel) => $body,
            $crate::leaf::Leaf::SharpBox($kernel) => $body,
            $crate::leaf::Leaf::RoundBox($kernel) => $body,
            $crate::leaf::Leaf::Tube($kernel) => $body,
            $crate::leaf::Leaf::Frustum($kernel) => $body,
            $crate::leaf::Leaf::Spheroid($kernel) => $body,
            $crate::leaf::Leaf::Ground($kernel) => $body,
            $crate::leaf::Leaf::Import($kernel) => $body,
            $crate::leaf::Leaf::Inflated($kernel) => $body,
            $crate::leaf::Leaf::Extrusion($kernel) => $body,
            $crate::leaf::Leaf::Revolved($kernel) => $body,
            $crate::leaf::Leaf::Pipe($kernel) => $body,
            $crate::leaf::Leaf::Voxels($kernel) => $body,
        }
    };
}
pub(crate) use with_kernel;

impl Leaf {
    /// Compiles a primitive whose space is reached from that of evaluation by `child_from_world`.
    pub fn new(primitive: &Primitive, child_from_world: &DAffine3) -> Self {
        let place = |origin: Vec3, turn: DMat3| {
            let local_from_child = DAffine3::from_mat3(turn) * DAffine3::from_translation(-origin.as_dvec3());
            Frame::new(local_from_child * *child_from_world)
        };
        let flat = |origin| place(origin, DMat3::IDENTITY);
        match primitive {
            Primitive::Point(p) => match (p.falloff, even_scale(child_from_world)) {
                (None, Some(scale)) => {
                    let center = child_from_world.inverse().transform_point3(p.center.as_dvec3());
                    let reach = f64::from(Falloff::of_depth(p.radius).reach) / scale;
                    let inv_reach2 = reach.powi(-2) as f32;
                    Self::PurePoint(PurePoint { center: center.as_vec3().to_array(), inv_reach2 })
                }
                (None, None) => Self::PureBall(PureSkeletal::new(flat(p.center), Origin, p.radius)),
                (Some(width), _) => {
                    let falloff = Falloff::of_width(width);
                    Self::Ball(Skeletal::new(flat(p.center), Origin, p.radius, falloff))
                }
            },
            Primitive::Segment(p) => {
                let frame = place(p.from, along(p.from, p.to));
                let line = Line { length: p.from.distance(p.to) };
                match p.falloff {
                    None => Self::PureLine(PureSkeletal::new(frame, line, p.radius)),
                    Some(w) => Self::Line(Skeletal::new(frame, line, p.radius, Falloff::of_width(w))),
                }
            }
            Primitive::Polyline(p) => {
                let points: Vec<_> = p.points.iter().map(|p| (p.at, p.radius)).collect();
                let widest = points.iter().fold(0.0f32, |r, p| r.max(p.1));
                let frame = flat(Vec3::ZERO);
                Self::Chain(Fallen::new(frame, Chain::new(&points), Falloff::new(p.falloff, widest)))
            }
            Primitive::Disc(p) => {
                let (frame, depth) = (place(p.center, facing(p.normal)), 0.5 * p.thickness);
                let plate = Plate { radius: p.radius - depth };
                match p.falloff {
                    None => Self::PurePlate(PureSkeletal::new(frame, plate, depth)),
                    Some(w) => Self::Plate(Skeletal::new(frame, plate, depth, Falloff::of_width(w))),
                }
            }
            Primitive::Polygon(p) => {
                let (normal, origin) = polygon::plane(&p.points).unwrap_or((Vec3::Z, p.points[0]));
                let turn = facing(normal);
                let flatten = |q: &Vec3| (turn * (*q - origin).as_dvec3()).as_vec3();
                let corners = p.points.iter().map(flatten).map(|q| Vec2::new(q.x, q.y)).collect();
                let (frame, outline) = (place(origin, turn), Outline::new(corners));
                let depth = 0.5 * p.thickness;
                match p.falloff {
                    None => Self::PureOutline(PureSkeletal::new(frame, outline, depth)),
                    Some(w) => Self::Outline(Skeletal::new(frame, outline, depth, Falloff::of_width(w))),
                }
            }
            Primitive::Box(p) => {
                let (frame, half) = (flat(p.center), p.size * 0.5);
                let falloff = Falloff::new(p.falloff, half.min_element());
                if p.rounding > 0.0 {
                    let inner = SharpBox { half: half - p.rounding };
                    let solid = RoundBox { inner, rounding: p.rounding };
                    Self::RoundBox(Fallen::new(frame, solid, falloff))
                } else {
                    Self::SharpBox(Fallen::new(frame, SharpBox { half }, falloff))
                }
            }
            Primitive::Cylinder(p) => {
                let half = 0.5 * p.from.distance(p.to);
                let frame = place(0.5 * (p.from + p.to), along(p.from, p.to));
                let falloff = Falloff::new(p.falloff, p.radius.min(half));
                Self::Tube(Fallen::new(frame, Tube { radius: p.radius, half }, falloff))
            }
            Primitive::Cone(p) => {
                let length = p.from.distance(p.to);
                let solid = Frustum { radius_from: p.radius_from, radius_to: p.radius_to, length };
                let deepest = 0.5 * p.radius_from.max(p.radius_to).min(length);
                let frame = place(p.from, along(p.from, p.to));
                Self::Frustum(Fallen::new(frame, solid, Falloff::new(p.falloff, deepest)))
            }
            Primitive::Torus(p) => {
                let (frame, circle) = (place(p.center, facing(p.normal)), Circle { radius: p.major_radius });
                match p.falloff {
                    None => Self::PureCircle(PureSkeletal::new(frame, circle, p.minor_radius)),
                    Some(w) => {
                        Self::Circle(Skeletal::new(frame, circle, p.minor_radius, Falloff::of_width(w)))
                    }
                }
            }
            Primitive::Ellipsoid(p) => {
                let falloff = Falloff::new(p.falloff, p.radii.min_element());
                Self::Spheroid(Fallen::new(flat(p.center), Spheroid { radii: p.radii }, falloff))
            }
            Primitive::HalfSpace(p) => {
                let frame = place(p.point, facing(p.normal));
                Self::Ground(Fallen::new(frame, Ground { extent: p.extent }, Falloff::of_width(p.falloff)))
            }
            Primitive::Mesh(p) => {
                Self::Import(Import::new(flat(Vec3::ZERO), p.distance.clone(), Falloff::of_width(p.falloff)))
            }
            Primitive::Inflation(p) => sketched::inflation(p, child_from_world),
            Primitive::LinearSweep(p) => sketched::linear_sweep(p, child_from_world),
            Primitive::Revolution(p) => sketched::revolution(p, child_from_world),
            Primitive::PathSweep(p) => sketched::path_sweep(p, child_from_world),
        }
    }

    pub fn bound(&self, region: &Aabb) -> Interval {
        with_kernel!(self, kernel => kernel.bound(region))
    }

    pub fn crease(&self, region: &Aabb) -> Crease {
        with_kernel!(self, kernel => match kernel.creased(region) {
            false => Crease::None,
            true if kernel.is_faceted() => Crease::Faceted,
            true => Crease::Sharp,
        })
    }

    pub fn at<S: Scalar>(&self, p: Triple<S>) -> Slope<S> {
        with_kernel!(self, kernel => kernel.at(p))
    }
}

/// The rotation that turns this direction upright.
fn facing(normal: Vec3) -> DMat3 {
    upright(normal.as_dvec3().normalize_or(DVec3::Z))
}

/// The rotation that turns the direction from one point to the other upright.
fn along(from: Vec3, to: Vec3) -> DMat3 {
    facing(to - from)
}

/// The factor by which a map scales all lengths alike; `None` if it does not.
pub(crate) fn even_scale(map: &DAffine3) -> Option<f64> {
    let square = map.matrix3.transpose() * map.matrix3;
    let mean = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    let off = (square - DMat3::from_diagonal(DVec3::splat(mean))).to_cols_array();
    off.iter().all(|x| x.abs() <= 1e-6 * mean).then(|| mean.sqrt())
}
