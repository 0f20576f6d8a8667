//! Phase four: vertices on sharp edges that pass between the vertices of cells.
//!
//! A cell has one vertex for each patch, so it cannot mark two edges. Where an edge is cut off by a line between
//! two joined vertices, that line gets a vertex on the edge, and both triangles along it are cut in two. A line
//! belongs to the brick of its first vertex: that proposes a vertex, the best for both triangles, and takes it if
//! all pieces are sound, whichever other lines of the two triangles are split.

use blobtree::{Aabb, Sampler};
use glam::Vec3;

use crate::brick_surface::BrickSurface;
use crate::crease::{End, cut_off, may_cut_off};
use crate::place::{Batch, Vertex, VertexKind, newton_step};
use crate::ring::{Around, OWN, VertexRef};

/// The least height of the pieces of a cut triangle as a share of the longest side.
const LEAST_HEIGHT: f32 = 2e-3;

/// The least area of the pieces, in squared cells.
const LEAST_AREA: f32 = 1e-5;

/// How close to the outward normals at its corners the normal of a piece must be, as a dot product. On the
/// sharpest edge that is kept whole, that of a wedge of 23°, normals are means and have 0.2. With 0.3, twice as
/// much of a box's edges is lost; with 0.1, a few more pieces cross where sheets are closer than a cell. Corners do
/// not tell: the cell of one that was found along an edge need not see all of its faces.
const AGREEMENT: f32 = 0.1;

/// How far an edge may be from the lines that are asked about, in cells: they see no more of the field.
const REACH: f32 = 2.0;

/// A stitched brick before its lines are split.
#[derive(Clone, Copy)]
pub(crate) struct Stitched<'a> {
    /// Where its vertices would be at home, and what is known of them.
    pub surface: &'a BrickSurface,
    pub vertices: &'a [Vertex],
    pub triangles: &'a [[VertexRef; 3]],
    /// The numbers of triangles with lines that may cut edges off, ascending.
    pub suspects: &'a [u32],
}

/// A vertex on the line between two others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    /// The ends, ascending. The first is in the brick itself.
    pub ends: [VertexRef; 2],
    pub vertex: Vertex,
}

/// The three lines of a triangle, each with its ends ascending.
fn lines_of(triangle: [VertexRef; 3]) -> [[VertexRef; 2]; 3] {
    [0, 1, 2].map(|i| {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        [a.min(b), a.max(b)]
    })
}

/// The vertex that a reference means.
fn vertex<'a>(around: &Around<Stitched<'a>>, of: VertexRef) -> Option<&'a Vertex> {
    around[of.brick()]?.vertices.get(of.number())
}

/// Whether a line may cut off an edge: two joined cells share a crossing, so one of them sees both faces.
fn is_suspect(around: &Around<Stitched>, line: [VertexRef; 2], spacing: f32) -> bool {
    let [Some(a), Some(b)] = line.map(|v| vertex(around, v)) else { return false };
    let sees_faces = |v: VertexRef| around[v.brick()].is_some_and(|b| b.surface.sees_faces(v.number()));
    may_cut_off(a, b, spacing) && line.into_iter().any(sees_faces)
}

/// The numbers of those of the middle brick's triangles that have lines that may cut off edges.
pub(crate) fn suspects(around: &Around<Stitched>, spacing: f32) -> Vec<u32> {
    let Some(own) = around[OWN] else { return Vec::new() };
    if around.iter().flatten().all(|brick| brick.surface.facets.is_empty()) {
        return Vec::new();
    }
    let has_suspect = |triangle: [VertexRef; 3]| {
        lines_of(triangle).into_iter().any(|line| is_suspect(around, line, spacing))
    };
    own.triangles.iter().zip(0..).filter(|(t, _)| has_suspect(**t)).map(|(_, number)| number).collect()
}

/// A triangle as seen from the middle brick, its vertices and its lines.
struct Face {
    corners: [Vertex; 3],
    lines: [[VertexRef; 2]; 3],
}

/// The triangles that have suspect lines of the middle brick, and these lines, ascending.
fn own_suspects(around: &Around<Stitched>, spacing: f32) -> (Vec<Face>, Vec<[VertexRef; 2]>) {
    let (mut faces, mut lines) = (Vec::new(), Vec::new());
    for (index, brick) in around.iter().enumerate() {
        let Some(brick) = brick.filter(|_| is_at_or_after_own(index)) else { continue };
        for &number in brick.suspects {
            let face = brick.triangles[number as usize].map(|v| v.seen_from_own(index));
            let is_own = |line: &[VertexRef; 2]| line[0].brick() == OWN && is_suspect(around, *line, spacing);
            let before = lines.len();
            lines.extend(lines_of(face).into_iter().filter(is_own));
            let corners = face.map(|v| vertex(around, v).copied());
            if let ([Some(a), Some(b), Some(c)], true) = (corners, lines.len() > before) {
                faces.push(Face { corners: [a, b, c], lines: lines_of(face) });
            }
        }
    }
    lines.sort_unstable();
    lines.dedup();
    (faces, lines)
}

/// Whether a brick of [`Around`] can have triangles with vertices of the middle one.
fn is_at_or_after_own(index: usize) -> bool {
    [index % 3, index / 3 % 3, index / 9].into_iter().all(|offset| offset > 0)
}

/// The best vertices for the lines of the middle brick that cut off edges, ascending by their ends, and the box in
/// which the field was looked at for them.
pub(crate) fn propose(
    around: &Around<Stitched>,
    sampler: &mut dyn Sampler,
    spacing: f32,
    batch: &mut Batch,
) -> (Vec<Split>, Aabb) {
    let (faces, lines) = own_suspects(around, spacing);
    if lines.is_empty() {
        return (Vec::new(), Aabb::EMPTY);
    }
    let corners = faces.iter().flat_map(|face| face.corners.map(|v| v.position));
    let region = Aabb::of_points(corners).grown(REACH * spacing);
    sampler.enter(region);
    let ends: Vec<[End; 2]> = lines.iter().map(|line| line.map(|v| end(around, v))).collect();
    let found = cut_off(sampler, &region, &ends, spacing, batch);
    let costs = costs(sampler, &faces, &lines, &found, spacing, batch);
    sampler.leave();
    let mut best: Vec<(f32, Split)> = Vec::new();
    for ((line, vertex), cost) in found.into_iter().zip(costs) {
        let Some(cost) = cost else { continue };
        let proposal = (cost, Split { ends: lines[line], vertex });
        match best.last_mut().filter(|(_, last)| last.ends == lines[line]) {
            Some(last) if cost < last.0 => *last = proposal,
            Some(_) => {}
            None => best.push(proposal),
        }
    }
    (best.into_iter().map(|(_, split)| split).collect(), region)
}

/// The place of a vertex and the normals of its faces.
fn end<'a>(around: &Around<Stitched<'a>>, of: VertexRef) -> End<'a> {
    let brick = around[of.brick()].expect("suspects have both ends");
    let vertex = &brick.vertices[of.number()];
    let normals = match vertex.kind {
        VertexKind::Smooth => std::slice::from_ref(&vertex.normal),
        _ => brick.surface.normals_at(of.number()),
    };
    End { position: vertex.position, normals }
}

/// How far from the surface the pieces of both triangles of a line would be with each of these vertices on it,
/// in sum; `None` where a piece would not be sound.
fn costs(
    sampler: &mut dyn Sampler,
    faces: &[Face],
    lines: &[[VertexRef; 2]],
    found: &[(usize, Vertex)],
    spacing: f32,
    batch: &mut Batch,
) -> Vec<Option<f32>> {
    let mut sides: Vec<(usize, &Face, usize)> = Vec::new();
    for face in faces {
        for (side, line) in face.lines.iter().enumerate() {
            sides.extend(lines.binary_search(line).ok().map(|number| (number, face, side)));
        }
    }
    sides.sort_by_key(|(number, ..)| *number);
    batch.points.clear();
    let mut starts = Vec::with_capacity(found.len() + 1);
    let mut is_sound = Vec::with_capacity(found.len());
    for &(line, vertex) in found {
        starts.push(batch.points.len());
        let first = sides.partition_point(|(number, ..)| *number < line);
        let own = sides[first..].iter().take_while(|(number, ..)| *number == line);
        is_sound.push(own.clone().all(|(_, face, side)| {
            let mut middles = [None; 3];
            middles[*side] = Some(vertex);
            may_be_cut(face.corners, middles, spacing)
        }));
        for (_, face, side) in own {
            let [a, b, c] = [0, 1, 2].map(|k| face.corners[(side + k) % 3].position);
            batch.points.extend([a, b].map(|end| (end + vertex.position + c) / 3.0));
        }
    }
    starts.push(batch.points.len());
    let samples = batch.sample(sampler);
    let off = |range: &[usize]| -> f32 {
        let far = |sample| newton_step(sample).map_or(spacing, |step| step.length().min(spacing));
        samples[range[0]..range[1]].iter().map(far).sum()
    };
    starts.windows(2).zip(is_sound).map(|(range, is_sound)| is_sound.then(|| off(range))).collect()
}

/// Those of the middle brick's proposals that both triangles along the line allow, whichever proposals for their
/// other lines are taken.
pub(crate) fn accept(around: &Around<Stitched>, proposals: &Around<&[Split]>, spacing: f32) -> Vec<Split> {
    let Some(own) = proposals[OWN].filter(|own| !own.is_empty()) else { return Vec::new() };
    let (faces, _) = own_suspects(around, spacing);
    let mut refused = vec![false; own.len()];
    for face in faces {
        let middles = face.lines.map(|line| split_of(proposals, line).map(|(_, split)| split.vertex));
        if !may_be_cut(face.corners, middles, spacing) {
            for line in face.lines.into_iter().filter(|line| line[0].brick() == OWN) {
                own.binary_search_by_key(&line, |split| split.ends)
                    .into_iter()
                    .for_each(|n| refused[n] = true);
            }
        }
    }
    // Vertex numbers have 16 bits, which is many times what bricks have.
    let room = (1 << 16) - around[OWN].map_or(0, |own| own.vertices.len());
    own.iter().zip(refused).filter(|(_, refused)| !refused).map(|(split, _)| *split).take(room).collect()
}

/// The number of the split of a line within its brick, and the split.
fn split_of<'a>(splits: &Around<&'a [Split]>, line: [VertexRef; 2]) -> Option<(usize, &'a Split)> {
    let owner = line[0].brick();
    let ends = line.map(|v| v.seen_from(owner));
    let found = splits[owner]?.binary_search_by_key(&ends, |split| split.ends).ok()?;
    Some((found, &splits[owner]?[found]))
}

/// Whether a triangle's pieces are sound with any of these vertices on its lines.
fn may_be_cut(corners: [Vertex; 3], middles: [Option<Vertex>; 3], spacing: f32) -> bool {
    let unused = corners[0];
    let all: [Vertex; 6] =
        std::array::from_fn(|i| if i < 3 { corners[i] } else { middles[i - 3].unwrap_or(unused) });
    let is_corner = |i: usize| all[i].kind == VertexKind::Corner;
    let is_sound = |piece: [usize; 3]| {
        let [a, b, c] = piece.map(|i| all[i].position);
        let normal = (b - a).cross(c - a);
        let twice = normal.length();
        let longest2 = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        twice > LEAST_HEIGHT * longest2
            && twice > 2.0 * LEAST_AREA * spacing * spacing
            && piece.iter().all(|&i| is_corner(i) || all[i].normal.dot(normal) > AGREEMENT * twice)
    };
    let present = middles.map(|m| m.is_some());
    (1..8).all(|some: usize| {
        let split = [0, 1, 2].map(|i| some >> i & 1 == 1);
        let is_possible = (0..3).all(|i| present[i] || !split[i]);
        !is_possible || pieces(all.map(|v| v.position), split).iter().all(|&piece| is_sound(piece))
    })
}

/// The pieces of the triangle of the first three points, whose line from point `i` to the next has point `3 + i`
/// on it if it is split.
fn pieces(points: [Vec3; 6], split: [bool; 3]) -> Vec<[usize; 3]> {
    let from = |i: usize| [0, 1, 2].map(|k| (i + k) % 3);
    match split.iter().filter(|split| **split).count() {
        0 => vec![[0, 1, 2]],
        1 => {
            let [a, b, c] = from(split.iter().position(|split| *split).unwrap_or(0));
            vec![[a, 3 + a, c], [3 + a, b, c]]
        }
        2 => {
            let [a, b, c] = from(split.iter().position(|split| !split).unwrap_or(0));
            let (first, second) = (3 + b, 3 + c);
            let tip = [first, c, second];
            let length = |i: usize, k: usize| points[i].distance_squared(points[k]);
            if length(a, first) < length(b, second) {
                vec![tip, [a, b, first], [a, first, second]]
            } else {
                vec![tip, [a, b, second], [b, first, second]]
            }
        }
        _ => vec![[0, 3, 5], [3, 1, 4], [4, 2, 5], [3, 4, 5]],
    }
}

/// The triangles of the middle brick, cut where their lines are split. `splits` are those of all bricks before,
/// whose vertices follow those of their cells.
pub(crate) fn cut(around: &Around<Stitched>, splits: &Around<&[Split]>) -> Vec<[VertexRef; 3]> {
    let Some(own) = around[OWN] else { return Vec::new() };
    let mut triangles = Vec::with_capacity(own.triangles.len() + own.suspects.len());
    let mut suspects = own.suspects.iter().peekable();
    for (&triangle, number) in own.triangles.iter().zip(0..) {
        if suspects.next_if(|next| **next == number).is_none() {
            triangles.push(triangle);
            continue;
        }
        let middles = lines_of(triangle).map(|line| {
            let (found, split) = split_of(splits, line)?;
            let owner = line[0].brick();
            let vertex = VertexRef::new(owner, (around[owner]?.vertices.len() + found) as u16);
            Some((vertex, split.vertex.position))
        });
        let refs: [VertexRef; 6] = std::array::from_fn(|i| match i {
            0..3 => triangle[i],
            _ => middles[i - 3].map_or(triangle[0], |(vertex, _)| vertex),
        });
        let points = std::array::from_fn(|i| match i {
            0..3 => vertex(around, triangle[i]).map_or(Vec3::ZERO, |vertex| vertex.position),
            _ => middles[i - 3].map_or(Vec3::ZERO, |(_, position)| position),
        });
        let pieces = pieces(points, middles.map(|m| m.is_some()));
        triangles.extend(pieces.into_iter().map(|piece| piece.map(|i| refs[i])));
    }
    triangles
}
