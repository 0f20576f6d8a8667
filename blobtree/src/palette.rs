//! Which colour a scene has where.
//!
//! The parts of one colour are one field of their own. At a point of the surface, the part whose field is
//! closest to the surface's value is the one that made it: in a union the larger, in an intersection the
//! smaller, in a cut the tool. Where parts blend, their colours do.

use crate::eval::Tree;
use crate::field::{Aabb, Field, ISO, Sampler};
use crate::node::{Color, Node, NodeRef, Shape};
use crate::operator::Operator;
use crate::support_free::BakeStore;
use glam::Vec3;

/// The colour of what has none: the limestone of a trullo.
pub const STONE: Color = Color([226, 216, 200]);

/// Most colours told apart; a further one is shown as the most similar of those.
const MOST_COLORS: usize = 64;

/// How fast a colour's share falls as its field leaves the surface's value. At 25 a part that is 0.1 off
/// counts a twelfth: unions stay crisp, and blends change colour over about a third of their width.
const CRISPNESS: f32 = 25.0;

/// The coloured parts of a scene.
#[derive(Debug)]
pub struct Palette {
    parts: Vec<(Color, Tree)>,
}

impl Palette {
    /// The colours of the tree below and including `root`, in its parent's space.
    pub fn new(root: &NodeRef, bakes: &BakeStore) -> Self {
        let mut parts = Vec::new();
        collect(root, None, true, &mut Vec::new(), &mut parts);
        let mut grouped: Vec<(Color, Vec<NodeRef>)> = Vec::new();
        for (color, part) in parts {
            let same = grouped.iter().position(|(known, _)| *known == color);
            let full = grouped.len() == MOST_COLORS;
            let similar = || (0..MOST_COLORS).min_by_key(|&i| difference(grouped[i].0, color));
            match same.or_else(|| full.then(similar).flatten()) {
                Some(index) => grouped[index].1.push(part),
                None => grouped.push((color, vec![part])),
            }
        }
        // One colour needs no field.
        let alone = grouped.len() == 1;
        let field = |group: Vec<NodeRef>| if alone { Vec::new() } else { group };
        let tree = |group| bakes.compile(&Node::new(Shape::Operator(Operator::Union, field(group))));
        Self { parts: grouped.into_iter().map(|(color, group)| (color, tree(group))).collect() }
    }

    /// One thread's worker.
    pub fn painter(&self) -> Painter<'_> {
        let samplers = self.parts.iter().map(|(color, tree)| (*color, tree.sampler())).collect();
        Painter { samplers }
    }
}

/// The largest subtrees of one colour each, with the warps above them.
///
/// `own` is whether the subtree shows the colour of what is around it where it has none itself; the tool of a
/// cut does not.
fn collect(
    node: &NodeRef,
    inherited: Option<Color>,
    own: bool,
    warps: &mut Vec<NodeRef>,
    parts: &mut Vec<(Color, NodeRef)>,
) {
    if !node.is_heard() {
        return;
    }
    let color = node.color.or(inherited);
    let own = own || node.color.is_some();
    if !is_coloured_below(node) {
        if own {
            parts.push((color.unwrap_or(STONE), node.under(warps)));
        }
        return;
    }
    if let Shape::Warp(..) = node.shape {
        warps.push(node.clone());
    }
    for (index, child) in node.children().iter().enumerate() {
        let is_tool = index > 0
            && matches!(node.shape, Shape::Operator(Operator::Difference | Operator::BlendDifference(_), _));
        collect(child, color, own && !is_tool, warps, parts);
    }
    if let Shape::Warp(..) = node.shape {
        warps.pop();
    }
}

/// Whether something below may show another colour than the node itself: by its own, or as a tool without one.
fn is_coloured_below(node: &Node) -> bool {
    node.children()
        .iter()
        .any(|child| child.is_heard() && (child.color.is_some() || is_coloured_below(child)))
}

fn difference(a: Color, b: Color) -> u32 {
    a.0.iter().zip(b.0).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Finds the colours of points, for one thread.
pub struct Painter<'a> {
    samplers: Vec<(Color, Box<dyn Sampler + 'a>)>,
}

impl Painter<'_> {
    /// The colours of points on the surface, which should be near each other.
    pub fn colors(&mut self, points: &[Vec3]) -> Vec<[u8; 3]> {
        match &mut self.samplers[..] {
            [] => return vec![STONE.0; points.len()],
            [(only, _)] => return vec![only.0; points.len()],
            _ => {}
        }
        let region = Aabb::of_points(points.iter().copied());
        let mut sums = vec![[0.0f32; 4]; points.len()];
        let mut values = vec![0.0; points.len()];
        for (color, sampler) in &mut self.samplers {
            if sampler.enter(region).hi > 0.0 {
                sampler.values(points, &mut values);
                let linear = color.0.map(|c| f32::from(c).powi(2));
                for (sum, &value) in sums.iter_mut().zip(&values).filter(|(_, value)| **value > 0.0) {
                    let share = (-CRISPNESS * (value - ISO).abs()).exp();
                    (0..3).for_each(|c| sum[c] += share * linear[c]);
                    sum[3] += share;
                }
            }
            sampler.leave();
        }
        let mixed = |[r, g, b, all]: [f32; 4]| {
            if all > 0.0 { [r, g, b].map(|c| (c / all).sqrt().round() as u8) } else { STONE.0 }
        };
        sums.into_iter().map(mixed).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::*;

    /// Whether the surface of `root` at `p` has this colour, but for rounding and what others' edges mix in.
    fn is_at(color: [u8; 3], root: Node, p: [f32; 3]) -> bool {
        let found = Palette::new(&root.into(), &BakeStore::new()).painter().colors(&[p.into()])[0];
        found.iter().zip(color).all(|(&a, b)| a.abs_diff(b) <= 2)
    }

    const RED: [u8; 3] = [255, 0, 0];
    const BLUE: [u8; 3] = [0, 0, 255];

    #[test]
    fn the_part_that_makes_the_surface_gives_its_colour() {
        let small = || point([12.0, 0.0, 0.0], 6.0).colored("#0000ff");
        let both = || point([0.0; 3], 10.0).colored("#ff0000").union(small());
        assert!(is_at(RED, both(), [-10.0, 0.0, 0.0]));
        assert!(is_at(BLUE, both(), [18.0, 0.0, 0.0]));
        assert!(is_at(BLUE, both().translate([0.0, 5.0, 0.0]), [18.0, 5.0, 0.0]));
    }

    #[test]
    fn a_hole_has_the_colour_of_its_tool_if_that_has_one() {
        let hole = || cylinder([0.0, 0.0, -20.0], [0.0, 0.0, 20.0], 3.0);
        let cube = || cuboid([0.0; 3], [20.0; 3]).colored("#ff0000");
        assert!(is_at(BLUE, cube().subtract(hole().colored("#0000ff")), [3.0, 0.0, 0.0]));
        assert!(is_at(RED, cube().subtract(hole()), [3.0, 0.0, 0.0]));
    }

    #[test]
    fn what_has_no_colour_is_of_stone() {
        assert!(is_at(STONE.0, point([0.0; 3], 10.0), [10.0, 0.0, 0.0]));
    }
}
