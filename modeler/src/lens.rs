//! The field lens: a plane through the model that shows the field, and each part's share in the value at a place.

use crate::newest::{Answering, Newest};
use crate::panels::{rule, title};
use blobtree::{Aabb, Field as _, FieldPicture, NodeRef, Shape, SketchPlane, Tree, explain};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use glam::Vec3;
use std::sync::Arc;

/// Pixels along the longer side of the picture.
const PIXELS: usize = 384;

/// How far the picture reaches beyond the solid, as a share of its longest side.
const BEYOND: f32 = 0.25;

/// Most parts that are explained.
const MOST_PARTS: usize = 400;

/// Shares below this are not worth a line.
const LEAST_SHARE: f32 = 0.005;

/// Which way the plane faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Facing {
    /// The front, as who looks from there.
    #[default]
    Front,
    /// The right side.
    Side,
    /// Up.
    Above,
}

impl Facing {
    /// All, in the order of the buttons.
    pub const ALL: [Self; 3] = [Self::Front, Self::Side, Self::Above];

    /// The name on the button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "Front",
            Self::Side => "Side",
            Self::Above => "Above",
        }
    }

    /// The axis that it lies across.
    pub fn axis(self) -> usize {
        match self {
            Self::Front => 1,
            Self::Side => 0,
            Self::Above => 2,
        }
    }

    /// The plane at a place of that axis, mm.
    fn plane(self, at: f32) -> SketchPlane {
        let (right, up) = match self {
            Self::Front => (Vec3::X, Vec3::Z),
            Self::Side => (Vec3::Y, Vec3::Z),
            Self::Above => (Vec3::X, Vec3::Y),
        };
        let mut origin = Vec3::ZERO;
        origin[self.axis()] = at;
        SketchPlane { origin, right, up }
    }
}

/// A field seen in a plane.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Where.
    pub framed: FieldPicture,
    /// What.
    image: ColorImage,
}

/// The value at a place, and where it comes from.
#[derive(Clone, Debug)]
pub struct Explained {
    /// The place, mm.
    pub place: Vec3,
    /// The value there.
    pub value: f32,
    /// The parts that have something to do with it, operators before what they combine; empty if there are too many
    /// parts to tell.
    pub shares: Vec<Share>,
}

/// A part's share in a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// How many operators it is in that are listed.
    pub depth: usize,
    /// What the user calls it.
    pub title: String,
    /// How an operator makes its value of its parts'; none for others.
    pub rule: Option<&'static str>,
    /// Its own value.
    pub value: f32,
    /// How much of the whole value it makes, 0 to 1.
    pub share: f32,
}

/// What is looked at.
#[derive(Clone, Debug, PartialEq)]
struct Looked {
    root: NodeRef,
    plane: SketchPlane,
    region: Aabb,
}

/// The lens.
pub struct Lens {
    /// Which way it faces.
    pub facing: Facing,
    /// Where it is on the axis that it lies across, mm; none for the middle of the model.
    pub at: Option<f32>,
    planes: Newest<(u64, Looked), (u64, Option<Seen>)>,
    places: Newest<(NodeRef, Vec3), Explained>,
    looked: Option<Looked>,
    asked: u64,
    answered: u64,
    seen: Option<Seen>,
    texture: Option<TextureHandle>,
    /// The place that the pointer shows, in what it was asked of, mm.
    pointed: Option<(NodeRef, Vec3)>,
    explained: Option<Explained>,
}

impl Lens {
    /// A lens in the middle of the model. `wake` is called when there is something to see.
    ///
    /// Errors: a system without threads to spare.
    pub fn new(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let look = |(version, looked): (u64, Looked), answering: &Answering<_>| {
            answering.give((version, look(&looked)));
        };
        let tell = |(root, place): (NodeRef, Vec3), answering: &Answering<_>| {
            answering.give(explained(&root, place));
        };
        Ok(Self {
            facing: Facing::default(),
            at: None,
            planes: Newest::start("lens", wake.clone(), look)?,
            places: Newest::start("shares", wake, tell)?,
            looked: None,
            asked: 0,
            answered: 0,
            seen: None,
            texture: None,
            pointed: None,
            explained: None,
        })
    }

    /// Takes in what was seen since the last look.
    pub fn hear(&mut self) {
        if let Some((version, seen)) = self.planes.answers().last() {
            (self.answered, self.seen, self.texture) = (version, seen, None);
        }
        if let Some(explained) = self.places.answers().last() {
            self.explained = Some(explained);
        }
    }

    /// Looks at a tree whose solid is in `bounds`, if that is something new.
    pub fn look(&mut self, root: &NodeRef, bounds: Aabb) {
        let plane = self.facing.plane(self.at_in(bounds));
        let region = bounds.grown(BEYOND * bounds.size().max_element());
        let looked = Looked { root: root.clone(), plane, region };
        let is_known = |known: &Looked| {
            NodeRef::ptr_eq(&known.root, root) && (known.plane, known.region) == (plane, region)
        };
        if !self.looked.as_ref().is_some_and(is_known) {
            self.asked += 1;
            self.planes.ask((self.asked, looked.clone()));
            self.looked = Some(looked);
        }
    }

    /// Where it is on its axis, for a solid with these bounds, mm.
    pub fn at_in(&self, bounds: Aabb) -> f32 {
        let middle = if bounds.is_empty() { Vec3::ZERO } else { bounds.center() };
        self.at.unwrap_or(middle[self.facing.axis()])
    }

    /// The part of the plane that is seen.
    pub fn framed(&self) -> Option<&FieldPicture> {
        self.seen.as_ref().map(|seen| &seen.framed)
    }

    /// The picture, as the screen has it.
    pub fn texture(&mut self, ctx: &Context) -> Option<TextureHandle> {
        if let (Some(seen), None) = (&self.seen, &self.texture) {
            self.texture = Some(ctx.load_texture("lens", seen.image.clone(), TextureOptions::LINEAR));
        }
        self.texture.clone()
    }

    /// Asks what is at a place of a tree; nothing shows without a place.
    pub fn point_at(&mut self, root: &NodeRef, place: Option<Vec3>) {
        let Some(place) = place else {
            (self.pointed, self.explained) = (None, None);
            self.places.stop();
            return;
        };
        let is_known = |(of, known): &(NodeRef, Vec3)| NodeRef::ptr_eq(of, root) && *known == place;
        if !self.pointed.as_ref().is_some_and(is_known) {
            self.pointed = Some((root.clone(), place));
            self.places.ask((root.clone(), place));
        }
    }

    /// What is at the place that was pointed at last, as far as that is known.
    pub fn explained(&self) -> Option<&Explained> {
        self.explained.as_ref().filter(|_| self.pointed.is_some())
    }

    /// Whether all that was asked is answered.
    pub fn is_at_rest(&self) -> bool {
        let told = |(_, place): &(NodeRef, Vec3)| self.explained.as_ref().is_some_and(|e| e.place == *place);
        self.answered == self.asked && self.pointed.as_ref().is_none_or(told)
    }
}

fn look(looked: &Looked) -> Option<Seen> {
    let tree = Tree::new(&looked.root);
    let region = looked.region.intersection(&tree.support());
    let framed = FieldPicture::framing(&region, &looked.plane, PIXELS)?;
    let image = ColorImage::from_rgb(framed.size, &framed.paint(&tree));
    Some(Seen { framed, image })
}

fn explained(root: &NodeRef, place: Vec3) -> Explained {
    let tree = Tree::new(root);
    let value = tree.value(place);
    let few = tree.primitives() <= MOST_PARTS;
    let shares = if few { shares(root, place) } else { Vec::new() };
    Explained { place, value, shares }
}

/// The parts with a share in the value at a place. Warps and what they bend are one part to whoever looks.
fn shares(root: &NodeRef, place: Vec3) -> Vec<Share> {
    let parts = explain(root, place);
    let mut shares: Vec<Share> = Vec::new();
    for part in parts.iter().filter(|part| part.share >= LEAST_SHARE) {
        let Some(node) = part.path.find(root) else { continue };
        let above: Vec<_> = std::iter::successors(part.path.parent(), |path| path.parent())
            .filter_map(|p| p.find(root))
            .collect();
        let is_warped = above.first().is_some_and(|parent| matches!(parent.shape, Shape::Warp(..)));
        if is_warped && !matches!(node.shape, Shape::Operator(..)) {
            continue;
        }
        let rule = match &node.shape {
            Shape::Operator(operator, children) if children.len() > 1 => Some(rule(operator)),
            _ => None,
        };
        let operators = above.iter().filter(|node| matches!(node.shape, Shape::Operator(..)));
        shares.push(Share {
            depth: operators.count(),
            title: title(node),
            rule,
            value: part.sample.value,
            share: part.share,
        });
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, point, sum, union};
    use std::time::{Duration, Instant};

    #[test]
    fn halfway_between_two_balls_both_have_half_a_share() {
        let root: NodeRef =
            sum([point([-9., 0., 0.], 5.).with_falloff(9.0), point([9., 0., 0.], 5.).with_falloff(9.0)])
                .into();
        let told = explained(&root, Vec3::ZERO);
        let [whole, a, b] = &told.shares[..] else { panic!("{told:?}") };
        assert_eq!((whole.share, a.share, b.share), (1.0, 0.5, 0.5));
        assert_eq!((whole.depth, a.depth), (0, 1));
        assert!((a.value + b.value - told.value).abs() < 1e-6 && whole.rule.is_some() && a.rule.is_none());
    }

    #[test]
    fn in_a_union_only_what_decides_is_told_and_a_warped_part_once() {
        let ball = point([0.; 3], 5.).translate([1., 0., 0.]).named("ball");
        let root: NodeRef = union([ball, point([4., 0., 0.], 2.)]).into();
        let told = explained(&root, Vec3::ZERO);
        let titles: Vec<&str> = told.shares.iter().map(|share| &*share.title).collect();
        assert_eq!(titles, ["Together", "ball"]);
    }

    #[test]
    fn the_lens_shows_the_field_where_it_stands() {
        let root: NodeRef = union([point([3., 20., 7.], 5.)]).into();
        let mut lens = Lens::new(Arc::new(|| ())).expect("threads");
        let bounds = blobtree::solid_box(&Tree::new(&root));
        lens.look(&root, bounds);
        lens.point_at(&root, Some(Vec3::new(3., 20., 7.)));
        let until = Instant::now() + Duration::from_secs(60);
        while !lens.is_at_rest() {
            assert!(Instant::now() < until, "nothing is seen");
            std::thread::sleep(Duration::from_millis(2));
            lens.hear();
        }
        let framed = lens.framed().expect("a picture");
        assert!((framed.plane.origin.y - 20.0).abs() < 0.1, "it stands in the middle");
        assert!(framed.corners().iter().all(|corner| (corner.x - 3.0).abs() > 5.0));
        assert_eq!(lens.explained().map(|e| e.value), Some(1.0));
    }
}
