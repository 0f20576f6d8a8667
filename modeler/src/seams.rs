//! Seams: lines on the surface where one part ends and another begins, in the colour of what combines them.

use crate::several;
use crate::stage::Line;
use blobtree::{NodePath, NodeRef, Operator, OwnerFinder, Owners, Shape};
use glam::Vec3;
use polygonizer::Cancel;
use rayon::prelude::*;

/// Places that are looked at together.
const TOGETHER: usize = 256;

/// How far seams lie above the surface, in cells, so that it does not hide them.
const ABOVE: f32 = 0.06;

/// The width of a seam, points.
const WIDTH: f32 = 2.0;

/// The colour of the seams that an operator makes, sRGB: teal for blends, orange for cuts, violet for what parts share,
/// blue for what merely touches.
pub fn color(operator: &Operator) -> [u8; 3] {
    match operator {
        Operator::Blend(_) | Operator::GradientBlend | Operator::Sum => [0, 140, 125],
        Operator::Difference | Operator::BlendDifference(_) => [216, 90, 10],
        Operator::Intersection | Operator::BlendIntersection(_) => [130, 70, 190],
        Operator::Union => [50, 95, 190],
    }
}

/// A surface as seams are drawn on it.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    /// The corners of its triangles, mm.
    pub positions: &'a [Vec3],
    /// Unit, outwards, or 0.
    pub normals: &'a [Vec3],
    /// Numbers of three corners each.
    pub triangles: &'a [[u32; 3]],
    /// The size of its cells, mm.
    pub cell: f32,
    /// How often the place where an edge changes its owner is halved: 5 times to a 32nd of the edge.
    pub halvings: usize,
}

/// The seams on a surface of this tree; `None` if it was cancelled.
///
/// **Cost:** the owners of all corners, and one more for each halving of each edge that a seam crosses.
pub fn seams(root: &NodeRef, owners: &Owners, ground: Ground, cancel: &Cancel) -> Option<Vec<Line>> {
    if owners.parts().len() < 2 {
        return Some(Vec::new());
    }
    let of = owned(owners, ground.positions, cancel);
    if cancel.is_cancelled() {
        return None;
    }
    let is_crossed = |[a, b, c]: &&[u32; 3]| {
        let [a, b, c] = [*a, *b, *c].map(|corner| of[corner as usize]);
        a != b || b != c
    };
    let crossed: Vec<&[u32; 3]> = ground.triangles.par_iter().filter(is_crossed).collect();
    let mut edges: Vec<[u32; 2]> = crossed
        .iter()
        .flat_map(|triangle| sides(triangle))
        .filter(|[a, b]| of[*a as usize] != of[*b as usize])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let crossings = crossings(owners, &of, &edges, ground, cancel);
    let mut lines = Vec::with_capacity(crossed.len());
    for triangle in crossed {
        let found: Vec<(Vec3, [u32; 2])> = sides(triangle)
            .filter_map(|edge| {
                let [a, b] = edge.map(|corner| of[corner as usize]);
                Some((crossings[edges.binary_search(&edge).ok()?], [a.min(b), a.max(b)]))
            })
            .collect();
        let middle = found.iter().map(|(place, _)| *place).sum::<Vec3>() / found.len().max(1) as f32;
        match found[..] {
            [(from, between), (to, _)] => lines.push((from, to, between)),
            _ => lines.extend(found.iter().map(|(from, between)| (*from, middle, *between))),
        }
    }
    let mut colors = std::collections::HashMap::new();
    let line = |(from, to, between): (Vec3, Vec3, [u32; 2])| {
        let [r, g, b] = *colors.entry(between).or_insert_with(|| {
            let paths = between.map(|part| owners.parts()[part as usize].clone());
            color(&joins(root, &paths))
        });
        Line { ends: [from, to], color: [r, g, b, 255], width: WIDTH }
    };
    let lines = lines.into_iter().map(line).collect();
    (!cancel.is_cancelled()).then_some(lines)
}

/// The sides of a triangle, each with its lower corner first.
fn sides(&[a, b, c]: &[u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[a, b], [b, c], [c, a]].into_iter().map(|[a, b]| [a.min(b), a.max(b)])
}

/// The owners of places; of no use if it was cancelled.
fn owned(owners: &Owners, places: &[Vec3], cancel: &Cancel) -> Vec<u32> {
    let find = |finder: &mut OwnerFinder, places: &[Vec3]| {
        if cancel.is_cancelled() { vec![0; places.len()] } else { finder.owners(places) }
    };
    places.par_chunks(TOGETHER).map_init(|| owners.finder(), find).flatten_iter().collect()
}

/// Where each edge changes its owner, a little above the surface.
fn crossings(owners: &Owners, of: &[u32], edges: &[[u32; 2]], ground: Ground, cancel: &Cancel) -> Vec<Vec3> {
    let at = |corner: u32| {
        let corner = corner as usize;
        ground.positions[corner] + ground.normals[corner] * (ABOVE * ground.cell)
    };
    // The owners are asked for on the surface itself.
    let mut ways: Vec<[f32; 2]> = vec![[0.0, 1.0]; edges.len()];
    for _ in 0..ground.halvings {
        let middles: Vec<Vec3> = edges
            .iter()
            .zip(&ways)
            .map(|([a, b], [from, to])| {
                ground.positions[*a as usize].lerp(ground.positions[*b as usize], 0.5 * (from + to))
            })
            .collect();
        for ((way, owner), [a, _]) in ways.iter_mut().zip(owned(owners, &middles, cancel)).zip(edges) {
            let middle = 0.5 * (way[0] + way[1]);
            if owner == of[*a as usize] { way[0] = middle } else { way[1] = middle }
        }
    }
    let place = |([a, b], [from, to]): (&[u32; 2], &[f32; 2])| at(*a).lerp(at(*b), 0.5 * (from + to));
    edges.iter().zip(&ways).map(place).collect()
}

/// The operator that combines two parts: the lowest one that holds both.
fn joins(root: &NodeRef, parts: &[NodePath; 2]) -> Operator {
    let mut path = several::parent(parts);
    while let Some(at) = path {
        match at.find(root).map(|node| &node.shape) {
            Some(Shape::Operator(operator, _)) => return *operator,
            _ => path = at.parent(),
        }
    }
    Operator::Union
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{Build as _, blend, cylinder, point};
    use blobtree::{BakeStore, Tree};
    use polygonizer::{CellSize, Options, Surface};

    fn seams_of(root: &NodeRef) -> Vec<Line> {
        let cell = CellSize::from_mm(0.7).expect("a size");
        let surface = Surface::build(&Tree::new(root), cell, &Options::default()).expect("not cancelled");
        let mesh = surface.mesh();
        let (positions, normals, triangles) = (&mesh.positions, &surface.normals(), &mesh.triangles);
        let ground = Ground { positions, normals, triangles, cell: cell.mm(), halvings: 5 };
        seams(root, &Owners::new(root, &BakeStore::new()), ground, &Cancel::new()).expect("not cancelled")
    }

    #[test]
    fn two_equal_balls_that_blend_have_a_seam_halfway_between_them() {
        let lines = seams_of(&blend([point([-8., 0., 0.], 10.), point([8., 0., 0.], 10.)]).into());
        assert!(lines.len() > 40, "{}", lines.len());
        for line in &lines {
            assert!(line.ends.iter().all(|end| end.x.abs() < 0.05), "{line:?}");
            assert_eq!(line.color[..3], color(&Operator::GradientBlend));
        }
        let around: f32 = lines.iter().map(|line| line.ends[0].distance(line.ends[1])).sum();
        let radius = lines[0].ends[0].length();
        assert!((around / (std::f32::consts::TAU * radius) - 1.0).abs() < 0.02, "{around} at {radius}");
    }

    #[test]
    fn the_rim_of_a_hole_is_a_seam_in_the_colour_of_cuts() {
        let hole = cylinder([0.0, 0.0, -20.0], [0.0, 0.0, 20.0], 4.0);
        let lines = seams_of(&point([0.0; 3], 10.0).subtract(hole).into());
        assert!(!lines.is_empty());
        for line in &lines {
            assert_eq!(line.color[..3], color(&Operator::Difference));
            for end in line.ends {
                // Both circles in which a cylinder of radius 4 meets a ball of radius 10.
                let off = (end.truncate().length() - 4.0).abs().max((end.length() - 10.0).abs());
                assert!(off < 0.3, "{end} is {off} off");
            }
        }
    }

    #[test]
    fn a_single_part_has_no_seams() {
        assert!(seams_of(&point([0.0; 3], 10.0).translate([1.0, 0.0, 0.0]).into()).is_empty());
    }
}
