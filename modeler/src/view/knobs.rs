//! Knobs for numbers, in the view: how thick the selected part is, how sharply it is blended, how deep a sketch lies.
//!
//! A knob stands off the part in the direction in which its number grows, as seen on the screen, so that it follows the
//! hand. Where that direction points to the eye, it stands below, to the left, and grows outwards.

use crate::cutting::Cut;
use crate::modeler::Modeler;
use crate::placing::world_from_node;
use blobtree::{Command, NewShape, NodePath, NodeRef, Operator, Primitive, Shape, Sharpness, SketchPlane};
use glam::{Vec2, Vec3};
use sketch::suggest::View;

/// How near a pen must come to a knob, points.
pub const REACH: f32 = 15.0;

/// How far from the middle of the part a knob stands at least, beyond the arrows, points.
const NEAREST: f32 = 112.0;

/// How far it stands off the part, points.
const GAP: f32 = 24.0;

/// Half the width of the text beside a knob, points.
const HALF_A_TEXT: f32 = 52.0;

/// Where a knob stands whose direction is not seen.
const ASIDE: Vec2 = Vec2::new(-std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2);

/// A direction is seen if a mm along it is at least so many of a mm on the screen.
const SEEN: f32 = 0.3;

/// How far a drag goes for twice the sharpness, points.
const TWICE: f32 = 80.0;

/// The least thickness or radius that a hand makes, mm.
const LEAST: f32 = 0.2;

/// The greatest, mm.
const GREATEST: f32 = 10_000.0;

/// What a knob changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turns {
    /// The thickness or the radius of the selected part.
    Size,
    /// The sharpness of the blend that it is part of.
    Blend,
    /// How far the sketch lies before the eye that drew it.
    Depth,
    /// Where the field lens stands.
    Lens,
}

/// A knob.
#[derive(Clone, Debug)]
pub struct Knob {
    /// What it changes.
    pub turns: Turns,
    /// What the user reads.
    pub label: &'static str,
    /// In points of the view.
    pub at: Vec2,
    /// Where its line to the part begins, in points of the view.
    pub from: Vec2,
    /// Where the number grows, a unit vector.
    pub grows: Vec2,
    /// How much it grows with a point of the drag, in its unit; with a blend, in powers of two.
    pub per_point: f32,
    /// What it is now: mm, or a sharpness.
    pub value: f32,
}

impl Knob {
    /// All knobs there are now.
    pub fn all(modeler: &Modeler) -> Vec<Self> {
        if !modeler.pad.is_empty() {
            return depth(modeler).into_iter().collect();
        }
        let root = &modeler.bench.shown().root;
        let of_part =
            modeler.bench.selected().map(|path| [size(modeler, root, path), blend(modeler, root, path)]);
        let all = of_part.into_iter().flatten().chain([lens(modeler)]).flatten();
        // With its text, each can be reached.
        let lo = Vec2::new(HALF_A_TEXT, GAP);
        let hi = (modeler.view.screen - Vec2::new(HALF_A_TEXT, 2.0 * GAP)).max(lo);
        all.map(|knob| Self { at: knob.at.clamp(lo, hi), ..knob }).collect()
    }

    /// The knob at a place of the view, if there is one.
    pub fn at(modeler: &Modeler, at: Vec2) -> Option<Self> {
        Self::all(modeler).into_iter().find(|knob| knob.at.distance(at) <= REACH)
    }

    /// The number after a drag by so many points, where it was `start`.
    pub fn dragged(&self, start: f32, by: Vec2) -> f32 {
        let by = by.dot(self.grows) * self.per_point;
        match self.turns {
            Turns::Size => (start + by).clamp(LEAST, GREATEST),
            Turns::Blend => (start * by.clamp(-10.0, 10.0).exp2()).clamp(1.0, 64.0),
            Turns::Depth | Turns::Lens => start + by,
        }
    }

    /// The text beside it.
    pub fn text(&self) -> String {
        match self.turns {
            Turns::Size | Turns::Lens => format!("{} {:.1} mm", self.label, self.value),
            Turns::Blend => format!("{} {:.1}", self.label, self.value),
            Turns::Depth => self.label.into(),
        }
    }
}

/// What gives a number of the selected part another value; `None` if there is no such number.
pub fn command(modeler: &Modeler, turns: Turns, value: f32) -> Option<Command> {
    let root = &modeler.bench.scene().root;
    let selected = modeler.bench.selected()?;
    match turns {
        Turns::Size => {
            let path = primitive_at(root, selected)?;
            let Shape::Primitive(primitive) = &path.find(root)?.shape else { return None };
            let shape = NewShape::Primitive(sized(primitive, value)?);
            Some(Command::SetShape { path, shape })
        }
        Turns::Blend => {
            let path = blend_at(root, selected)?;
            let Shape::Operator(operator, _) = &path.find(root)?.shape else { return None };
            let sharpness = Sharpness::new(value).ok()?;
            let operator = match operator {
                Operator::Blend(_) => Operator::Blend(sharpness),
                Operator::BlendDifference(_) => Operator::BlendDifference(sharpness),
                Operator::BlendIntersection(_) => Operator::BlendIntersection(sharpness),
                _ => return None,
            };
            Some(Command::SetShape { path, shape: NewShape::Operator(operator) })
        }
        Turns::Depth | Turns::Lens => None,
    }
}

/// The primitive at a path, or below the warps there.
pub fn primitive_at(root: &NodeRef, path: &NodePath) -> Option<NodePath> {
    let mut path = path.clone();
    loop {
        match &path.find(root)?.shape {
            Shape::Primitive(_) => return Some(path),
            Shape::Warp(..) => path = path.child(0),
            _ => return None,
        }
    }
}

/// The blend at a path, or the one above it and its warps.
fn blend_at(root: &NodeRef, path: &NodePath) -> Option<NodePath> {
    let is_blend = |path: &NodePath| {
        matches!(&path.find(root)?.shape, Shape::Operator(o, _) if sharpness(o).is_some()).then_some(())
    };
    if is_blend(path).is_some() {
        return Some(path.clone());
    }
    let mut above = path.parent()?;
    while matches!(above.find(root)?.shape, Shape::Warp(..)) {
        above = above.parent()?;
    }
    is_blend(&above).map(|()| above)
}

fn sharpness(operator: &Operator) -> Option<Sharpness> {
    match operator {
        Operator::Blend(s) | Operator::BlendDifference(s) | Operator::BlendIntersection(s) => Some(*s),
        _ => None,
    }
}

/// The name of the number of a primitive, what it is, and in which plane the primitive was drawn.
fn number(primitive: &Primitive) -> Option<(&'static str, Option<f32>, Option<&SketchPlane>)> {
    Some(match primitive {
        Primitive::LinearSweep(sweep) => ("Thickness", Some(sweep.length), Some(&sweep.plane)),
        Primitive::Inflation(inflation) => ("Thickness", inflation.thickness, Some(&inflation.plane)),
        Primitive::Point(point) => ("Radius", Some(point.radius), None),
        Primitive::Segment(segment) => ("Radius", Some(segment.radius), None),
        Primitive::Cylinder(cylinder) => ("Radius", Some(cylinder.radius), None),
        Primitive::Torus(torus) => ("Thickness", Some(2.0 * torus.minor_radius), None),
        _ => return None,
    })
}

fn sized(primitive: &Primitive, value: f32) -> Option<Primitive> {
    let mut primitive = primitive.clone();
    match &mut primitive {
        Primitive::LinearSweep(sweep) => {
            sweep.length = value;
            sweep.fillet = sweep.fillet.min(0.5 * value);
        }
        Primitive::Inflation(inflation) => inflation.thickness = Some(value),
        Primitive::Point(point) => point.radius = value,
        Primitive::Segment(segment) => segment.radius = value,
        Primitive::Cylinder(cylinder) => cylinder.radius = value,
        Primitive::Torus(torus) => torus.minor_radius = 0.5 * value,
        _ => return None,
    }
    Some(primitive)
}

fn size(modeler: &Modeler, root: &NodeRef, selected: &NodePath) -> Option<Knob> {
    // The length of what goes through everything says nothing.
    if modeler.selected_cut().is_some_and(Cut::is_through) {
        return None;
    }
    let path = primitive_at(root, selected)?;
    let Shape::Primitive(primitive) = &path.find(root)?.shape else { return None };
    let (label, value, plane) = number(primitive)?;
    let bounds = modeler.selected_box()?;
    let view = modeler.camera.view(modeler.view.screen);
    let from = view.screen_from_model(bounds.center())?;
    let mm_per_point = view.mm_per_px(view.depth(bounds.center()));
    let world = world_from_node(root, &path)?;
    // Both faces move, so the number grows twice as fast as the hand. A radius grows with it.
    let (along, times) = match plane {
        Some(plane) => (world.transform_vector3(plane.right.cross(plane.up).normalize_or(Vec3::Y)), 2.0),
        None => (Vec3::ZERO, 1.0),
    };
    let stretch = if plane.is_some() { along.length() } else { world.matrix3.determinant().abs().cbrt() };
    let unit = along.normalize_or_zero();
    let seen = Vec2::new(unit.dot(view.right()), -unit.dot(view.up));
    // The end that is nearer to the eye, which nothing hides.
    let seen = if unit.dot(view.forward) > 0.0 { -seen } else { seen };
    let half = 0.5 * bounds.size();
    let (grows, extent, shortening) = if seen.length() >= SEEN {
        (seen.normalize(), unit.abs().dot(half) * seen.length(), seen.length())
    } else {
        (aside(modeler), half.max_element(), 1.0)
    };
    let value = value.unwrap_or(2.0 * unit.abs().dot(half) / stretch.max(1e-6));
    Some(Knob {
        turns: Turns::Size,
        label,
        at: from + grows * (extent / mm_per_point + GAP).clamp(NEAREST, 3.0 * NEAREST),
        from,
        grows,
        per_point: times * mm_per_point / shortening / stretch.max(1e-6),
        value,
    })
}

/// Away from the hand that draws.
fn aside(modeler: &Modeler) -> Vec2 {
    if modeler.settings.left_handed { Vec2::new(-ASIDE.x, ASIDE.y) } else { ASIDE }
}

fn blend(modeler: &Modeler, root: &NodeRef, selected: &NodePath) -> Option<Knob> {
    let path = blend_at(root, selected)?;
    let Shape::Operator(operator, children) = &path.find(root)?.shape else { return None };
    let value = sharpness(operator).filter(|_| children.len() > 1)?.get();
    let bounds = modeler.selected_box()?;
    let view = modeler.camera.view(modeler.view.screen);
    let from = view.screen_from_model(bounds.center())?;
    let below = 0.5 * bounds.size().z / view.mm_per_px(view.depth(bounds.center())) + GAP;
    Some(Knob {
        turns: Turns::Blend,
        label: "Sharpness",
        at: from + Vec2::Y * below.clamp(NEAREST, 2.0 * NEAREST),
        from,
        grows: Vec2::X,
        per_point: 1.0 / TWICE,
        value,
    })
}

/// The corners of the plane in which the sketch lies, around it, in the model; none without a sketch whose place is
/// known.
pub fn ghost_plane(modeler: &Modeler) -> Option<[Vec3; 4]> {
    let (pad, found) = (&modeler.pad, modeler.pad.expectations.as_ref()?);
    let drawn = pad.drawn_in()?;
    let [lo, hi] = pad.sketch().bounds()?;
    let (lo, hi) = (lo - GAP, hi + GAP);
    let depth = pad.depth.unwrap_or(found.depth);
    let corners = [lo, Vec2::new(hi.x, lo.y), hi, Vec2::new(lo.x, hi.y)];
    Some(corners.map(|corner| drawn.at_depth(corner, depth)))
}

/// At the middle of the lens's lower rim, or as near to it as the view shows.
fn lens(modeler: &Modeler) -> Option<Knob> {
    let lens = modeler.lens.as_ref()?;
    let [a, b, ..] = lens.framed()?.corners();
    let middle = 0.5 * (a + b);
    let view = modeler.camera.view(modeler.view.screen);
    let from = view.screen_from_model(middle)?;
    let mut along = Vec3::ZERO;
    along[lens.facing.axis()] = 1.0;
    let (grows, shortening) = seen_along(&view, along).unwrap_or((Vec2::NEG_Y, 1.0));
    Some(Knob {
        turns: Turns::Lens,
        label: "Lens",
        at: from,
        from,
        grows,
        per_point: view.mm_per_px(view.depth(middle)) / shortening,
        value: lens.at_in(modeler.bounds()),
    })
}

/// Where a direction of the model points on the screen, and how much shorter a mm along it seems; `None` if it points
/// to the eye or away from it.
fn seen_along(view: &View, along: Vec3) -> Option<(Vec2, f32)> {
    let seen = Vec2::new(along.dot(view.right()), -along.dot(view.up));
    (seen.length() >= SEEN).then(|| (seen.normalize(), seen.length()))
}

fn depth(modeler: &Modeler) -> Option<Knob> {
    let [left, right, right_too, left_too] = ghost_plane(modeler)?;
    // Away from the hand that draws, and from what it chooses.
    let [a, d] = if modeler.settings.left_handed { [right, right_too] } else { [left, left_too] };
    let drawn = modeler.pad.drawn_in()?;
    let value = modeler.pad.depth.or(modeler.pad.expectations.as_ref().map(|found| found.depth))?;
    let view = modeler.camera.view(modeler.view.screen);
    let from = view.screen_from_model(0.5 * (a + d))?;
    let mm_per_point = view.mm_per_px(view.depth(0.5 * (a + d)));
    // As on a desk, what is farther away is farther up.
    let (grows, shortening) = seen_along(&view, drawn.forward).unwrap_or((Vec2::NEG_Y, 1.0));
    Some(Knob {
        turns: Turns::Depth,
        label: "Nearer or farther",
        at: from,
        from,
        grows,
        per_point: mm_per_point / shortening,
        value,
    })
}
