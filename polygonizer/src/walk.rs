//! Follows edges as far as their vertices may go, to corners with faces that no crossing of the cell lies on.

use blobtree::{ISO, Sample};
use glam::Vec3;

use crate::feature::{Candidate, Finder, ON_SURFACE};
use crate::grid::MARGIN;
use crate::guess::{Guess, SLACK, clip};
use crate::place::{newton_step, outward};
use crate::qef::Plane;

/// Rounds of the search for the end of an edge: the first may be too far out to tell, the second find the
/// face, the others come closer quadratically.
const WALK_ROUNDS: usize = 5;

/// A search along an edge for the face that ends it.
struct Walk {
    candidate: usize,
    found: Guess,
    /// How far the edge is known to go, and where the face at its end is known to be what counts.
    on_edge: f32,
    beyond: f32,
    /// Where to look next.
    t: f32,
    /// Where that face seems to meet the edge.
    corner: Option<f32>,
    /// Nothing ends the edge before the far end.
    is_vain: bool,
}

impl Walk {
    fn new(candidate: usize, found: Guess, end: f32) -> Self {
        Self { candidate, found, on_edge: 0.0, beyond: end, t: end, corner: None, is_vain: false }
    }

    fn take(&mut self, sample: &Sample, known: &[Plane], on_surface: f32) {
        let normal = outward(sample);
        let slope = normal.dot(self.found.free);
        let step = newton_step(sample).map_or(f32::INFINITY, Vec3::length);
        let is_new = slope.abs() > 0.1 && known.iter().all(|p| p.normal.dot(normal) < 0.9);
        if is_new {
            self.beyond = self.t;
            let corner = self.t + (ISO - sample.value) / sample.gradient.dot(self.found.free);
            self.corner = Some(corner);
            self.t = corner;
        } else if step <= on_surface {
            self.on_edge = self.t;
            self.is_vain = self.corner.is_none();
        } else {
            // Too far out to tell by which face.
            self.beyond = self.t;
        }
        let [low, high] = [self.on_edge.min(self.beyond), self.on_edge.max(self.beyond)];
        if !(low < self.t && self.t < high) {
            self.t = low.midpoint(high);
        }
    }
}

impl Finder<'_> {
    /// Looks for corners with faces that no crossing lies on: along edges, as far as their vertices may go.
    pub fn follow_edges(&mut self) {
        let on_surface = ON_SURFACE * self.spacing;
        // A corner in the margin of the box can still be marked, and all the margin is in the sampled region.
        let beyond = 0.9 * MARGIN * self.spacing;
        let mut walks = Vec::new();
        for (number, candidate) in self.scratch.candidates.iter().enumerate() {
            let edge = candidate.found.filter(|f| !candidate.bold && f.rank == 2 && f.off <= on_surface);
            let reach = edge.and_then(|found| {
                Some((found, clip(found.point, found.free, &candidate.allowed.grown(beyond))?))
            });
            if let Some((found, ends)) = reach {
                walks.extend(ends.map(|t| Walk::new(number, found, t)));
            }
        }
        for _ in 0..WALK_ROUNDS {
            self.batch.points.clear();
            self.batch.points.extend(walks.iter().map(|w| {
                let reach = self.scratch.candidates[w.candidate].allowed.grown(beyond);
                (w.found.point + w.found.free * w.t).clamp(reach.min, reach.max)
            }));
            let samples = self.batch.sample(self.sampler);
            for (walk, sample) in walks.iter_mut().zip(samples) {
                let Candidate { planes: [first, end], .. } = self.scratch.candidates[walk.candidate];
                walk.take(sample, &self.scratch.planes[first..end], on_surface);
            }
            walks.retain(|walk| !walk.is_vain);
        }
        self.scratch.guesses.clear();
        for walk in walks {
            let point = walk.corner.map(|t| walk.found.point + walk.found.free * t);
            let candidate = &self.scratch.candidates[walk.candidate];
            let reached = point.map(|p| (p, candidate.clamp(p)));
            let slack = SLACK * self.spacing;
            if let Some((meeting, point)) = reached.filter(|(p, reached)| p.distance(*reached) <= slack) {
                let guess = Guess { candidate: walk.candidate, point, meeting, rank: 3, ..walk.found };
                self.scratch.guesses.push(guess);
            }
        }
        self.measure_guesses();
        for guess in self.scratch.guesses.iter().filter(|g| g.off <= on_surface) {
            self.scratch.candidates[guess.candidate].found = Some(*guess);
        }
    }
}
