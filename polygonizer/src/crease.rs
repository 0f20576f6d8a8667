//! Where sharp edges pass between two joined vertices that lie on different faces.
//!
//! The straight line between such vertices cuts the edge off. The planes of the faces at both ends are met, then
//! those that the faces have close to the edge, as in [`crate::feature`].

use blobtree::{Aabb, Sample, Sampler};
use glam::Vec3;

use crate::feature::ON_SURFACE;
use crate::guess::SAME_FACE;
use crate::place::{Batch, Vertex, VertexKind, newton_step, outward};
use crate::qef::Plane;

/// What a line may cut off, in cells.
const LEAST_CUT: f32 = 0.02;

/// How far from its ends a line is first looked at, as a share of it: close enough to the faces they lie on, and
/// beyond what an end that marks another edge is off.
const END: f32 = 0.2;

/// How close to the edge its faces are looked at, as a share of the way to the line's ends.
const CLOSE: f32 = 0.2;

/// Rounds of looking close: curved faces come 25 times closer with each.
const ROUNDS: usize = 2;

/// How far from the surface the faces may be close to the edge, in cells; farther, there is more between.
const FACES_OFF: f32 = 0.03;

/// Ends this close to the edge (in cells) mark it well enough.
const AT_END: f32 = 0.02;

/// Whether an edge may pass between two joined vertices, by their normals alone.
pub(crate) fn may_cut_off(a: &Vertex, b: &Vertex, spacing: f32) -> bool {
    let chord = b.position - a.position;
    let least = LEAST_CUT * spacing;
    let (rise_a, rise_b) = (a.normal.dot(chord).abs(), b.normal.dot(chord).abs());
    match [a.kind, b.kind].map(|kind| kind == VertexKind::Smooth) {
        [true, true] => {
            let cos = a.normal.dot(b.normal);
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            cos < SAME_FACE && rise_a * rise_b > least * sin * chord.length()
        }
        [true, false] => rise_a > least,
        [false, true] => rise_b > least,
        [false, false] => a.normal.dot(b.normal) < SAME_FACE,
    }
}

/// An end of a line: where it is, and the normals of the faces known to meet there.
pub(crate) struct End<'a> {
    pub position: Vec3,
    pub normals: &'a [Vec3],
}

/// A line and an edge that it may cut off.
struct Chord {
    line: usize,
    ends: [Vec3; 2],
    /// A place on the edge.
    at: Vec3,
    normal: Vec3,
}

/// The places on sharp edges that these lines may cut off, with their lines' numbers, ascending. The sampler must
/// be in `region`.
pub(crate) fn cut_off(
    sampler: &mut dyn Sampler,
    region: &Aabb,
    lines: &[[End; 2]],
    spacing: f32,
    batch: &mut Batch,
) -> Vec<(usize, Vertex)> {
    let mut chords = first_look(sampler, lines, spacing, batch);
    for round in 0..=ROUNDS {
        chords.retain(|c| region.contains(c.at));
        batch.points.clear();
        let close = |c: &Chord| [c.at.lerp(c.ends[0], CLOSE), c.at, c.at.lerp(c.ends[1], CLOSE)];
        batch.points.extend(chords.iter().flat_map(close));
        batch.sample(sampler);
        let mut places = batch.points.chunks_exact(3).zip(batch.samples.chunks_exact(3));
        chords.retain_mut(|chord| {
            let (points, samples) = places.next().expect("three for each chord");
            chord.improve(points, samples, round == ROUNDS, spacing)
        });
    }
    chords.dedup_by(|b, a| a.line == b.line && a.at.distance(b.at) < AT_END * spacing);
    let vertex = |c: &Chord| Vertex { position: c.at, normal: c.normal, kind: VertexKind::Edge };
    chords.iter().map(|chord| (chord.line, vertex(chord))).collect()
}

/// The edges that the faces at the ends have, for lines that leave the surface and do not pass over a single smooth
/// piece of the field.
fn first_look(sampler: &mut dyn Sampler, lines: &[[End; 2]], spacing: f32, batch: &mut Batch) -> Vec<Chord> {
    batch.points.clear();
    for [a, b] in lines {
        batch.points.extend([END, 0.5, 1.0 - END].map(|t| a.position.lerp(b.position, t)));
    }
    batch.sample(sampler);
    let places = batch.points.chunks_exact(3).zip(batch.samples.chunks_exact(3));
    let mut chords = Vec::new();
    for ((line, ends), (points, samples)) in lines.iter().enumerate().zip(places) {
        let leaves = newton_step(&samples[1]).is_some_and(|step| step.length() > 0.5 * LEAST_CUT * spacing);
        let is_one_piece = samples[1].piece != 0 && samples.iter().all(|s| s.piece == samples[1].piece);
        if !leaves || is_one_piece {
            continue;
        }
        let seen = [0, 1].map(|i| face(points[2 * i], &samples[2 * i], spacing));
        let faces = [0, 1].map(|i| {
            let known = ends[i].normals.iter().map(|&normal| Plane { point: ends[i].position, normal });
            seen[i].into_iter().chain(known).collect::<Vec<Plane>>()
        });
        let both = [ends[0].position, ends[1].position];
        for &a in &faces[0] {
            for &b in &faces[1] {
                let mut chord = Chord { line, ends: both, at: Vec3::ZERO, normal: Vec3::ZERO };
                if chord.meet([a, b], spacing) {
                    chords.push(chord);
                }
            }
        }
    }
    chords
}

/// The plane of the surface near `point`.
fn face(point: Vec3, sample: &Sample, spacing: f32) -> Option<Plane> {
    let step = newton_step(sample).filter(|step| step.length() < spacing)?;
    Some(Plane { point: point + step, normal: outward(sample) })
}

impl Chord {
    /// Takes the place where the line would cross the edge if the faces were folded flat, so that lines that do
    /// not cross there do not on the edge either. Returns whether the edge is one, and not at an end.
    fn meet(&mut self, [a, b]: [Plane; 2], spacing: f32) -> bool {
        let cos = a.normal.dot(b.normal);
        let Some(along) = a.normal.cross(b.normal).try_normalize() else { return false };
        if cos > SAME_FACE {
            return false;
        }
        let middle = self.ends[0].midpoint(self.ends[1]);
        let (to_a, to_b) = (a.normal.dot(a.point - middle), b.normal.dot(b.point - middle));
        let foot =
            middle + (a.normal * (to_a - cos * to_b) + b.normal * (to_b - cos * to_a)) / (1.0 - cos * cos);
        let place = |end: Vec3| {
            let t = (end - foot).dot(along);
            (t, (end - foot - along * t).length())
        };
        let [(t_a, off_a), (t_b, off_b)] = self.ends.map(place);
        self.at = foot + along * (t_a + (t_b - t_a) * (off_a / (off_a + off_b)));
        self.normal = (a.normal + b.normal).normalize_or_zero();
        self.at.is_finite() && off_a.min(off_b) > AT_END * spacing
    }

    /// Looks at the faces from samples close to the edge; returns whether they are still two. The last time, the
    /// place stays and must be on the surface.
    fn improve(&mut self, points: &[Vec3], samples: &[Sample], last: bool, spacing: f32) -> bool {
        let faces = [face(points[0], &samples[0], spacing), face(points[2], &samples[2], spacing)];
        let [Some(a), Some(b)] = faces else { return false };
        if !last {
            return self.meet([a, b], spacing);
        }
        let off = newton_step(&samples[1]).map_or(f32::INFINITY, Vec3::length);
        let faces_off = a.point.distance(points[0]).max(b.point.distance(points[2]));
        off <= ON_SURFACE * spacing && faces_off <= FACES_OFF * spacing && a.normal.dot(b.normal) <= SAME_FACE
    }
}
