//! Features that no cell could mark if vertices had to stay where they are safe.
//!
//! An edge can cut across a lattice edge between two of its points, which then seems not to be crossed. The cell
//! behind sees both faces but not the edge; those beside it, which have its neighbouring pieces, are
//! joined through this cell only. So its vertex should be on the edge too, out of its box. Whether it can, the
//! vertices around decide (see [`crate::settle`]).

use blobtree::{Aabb, Brick};
use glam::Vec3;

use crate::brick_surface::Bold;
use crate::feature::{Candidate, Finder};
use crate::grid::is_inside;
use crate::guess::{Guess, clip};
use crate::lattice::CELLS;
use crate::place::Vertex;

impl Finder<'_> {
    /// Those of a candidate's guesses outside its safe box that are its to mark, best first: what lies in cells
    /// that the surface does not seem to pass, corners before edges; other edges only if none passes its safe box.
    pub fn bold_guesses(&mut self, candidate: &Candidate, guesses: Vec<Guess>) -> Vec<Guess> {
        let own = self.grid.own_box(self.sites[candidate.site as usize].cell);
        let mut ranked = Vec::new();
        for guess in guesses {
            let leap = |g: &Guess| g.point.distance_squared(g.point.clamp(own.min, own.max));
            if let Some(unseen) = self.move_out_of_sight(candidate, guess) {
                ranked.push((3 - unseen.rank, leap(&unseen), unseen));
            } else if guess.rank == 2 && !candidate.has_edge {
                ranked.push((2, leap(&guess), guess));
            }
        }
        ranked.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        ranked.into_iter().map(|(.., guess)| guess).collect()
    }

    /// The guess moved, if it is an edge along itself, to the nearest place in an unseen cell; `None` if there is
    /// none.
    fn move_out_of_sight(&mut self, candidate: &Candidate, guess: Guess) -> Option<Guess> {
        if self.is_unseen(candidate, guess.point) {
            return Some(guess);
        }
        if guess.rank == 3 {
            return None;
        }
        let own = self.grid.own_box(self.sites[candidate.site as usize].cell);
        let mut places: Vec<f32> = (0..27)
            .filter_map(|n| {
                let step = Vec3::new((n % 3) as f32, (n / 3 % 3) as f32, (n / 9) as f32) - 1.0;
                let shift = step * self.spacing;
                let cell = Aabb { min: own.min + shift, max: own.max + shift };
                let [low, high] = clip(guess.point, guess.free, &cell)?;
                Some(0.0_f32.clamp(low, high))
            })
            .collect();
        places.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let points = places.into_iter().map(|t| candidate.clamp(guess.point + guess.free * t));
        let point = points.into_iter().find(|&point| self.is_unseen(candidate, point))?;
        Some(Guess { point, meeting: point, ..guess })
    }

    /// Whether `point` lies in a cell whose corners are all on one side of the surface.
    fn is_unseen(&mut self, candidate: &Candidate, point: Vec3) -> bool {
        let cell = self.sites[candidate.site as usize].cell;
        let step = self.grid.step_to(cell, point);
        let at: [i32; 3] = std::array::from_fn(|a| i32::from(cell[a]) + step[a]);
        if at.iter().all(|i| (0..CELLS as i32).contains(i)) {
            return matches!(self.grid.config(at.map(|i| i as usize)), 0 | 255);
        }
        let Brick { origin, spacing } = self.grid.brick;
        self.batch.points.clear();
        self.batch.points.extend((0..8).map(|c| {
            Brick::lattice_point(std::array::from_fn(|a| origin[a] + at[a] + (c >> a & 1)), spacing)
        }));
        let values = self.batch.evaluate(self.sampler);
        values.iter().all(|&v| is_inside(v) == is_inside(values[0]))
    }

    /// What a bold candidate has found, and how far outside its cell, if it is its to mark.
    pub fn bold_place(&mut self, candidate: &Candidate, found: Guess) -> Option<(Vertex, f32)> {
        let unseen = self.is_unseen(candidate, found.point);
        if !unseen && (candidate.has_edge || found.rank == 3) {
            return None;
        }
        let own = self.grid.own_box(self.sites[candidate.site as usize].cell);
        let leap = found.point.distance(found.point.clamp(own.min, own.max));
        Some((self.vertex(candidate, found), leap))
    }

    /// A bold vertex with one place.
    pub fn bold(&self, candidate: &Candidate, place: Vertex, leap: f32) -> Bold {
        let cell = self.sites[candidate.site as usize].cell;
        Bold {
            number: candidate.site as u16,
            places: vec![place],
            leap,
            index: std::array::from_fn(|a| self.grid.brick.origin[a] + i32::from(cell[a])),
        }
    }
}
