//! Places vertices on sharp edges and corners, where faces of different direction meet in a cell.
//!
//! A patch whose normals at its crossings disagree is a candidate. Its faces' planes are met in a point, then
//! the faces are looked at again close to that point: there the normals of a merely curved surface
//! agree, those of a crease do not, and the planes of curved faces fit. Edges are followed to corners
//! ([`crate::walk`]); where the feature is out of reach, a bold place is noted ([`crate::bold`]). Whatever does
//! not end on the surface is placed as smooth.
//!
//! **Source:** Kobbelt et al. 2001, *Feature sensitive surface extraction*. **Departs:** planes are taken
//! near the feature, the vertex may leave its cell (see [`Grid::feature_box`]), and the result is checked.

use blobtree::{Aabb, Sampler};
use glam::Vec3;

use crate::brick_surface::{Bold, Facets};
use crate::crossings::Crossings;
use crate::grid::{Grid, Site};
use crate::guess::{Guess, SAME_FACE, faces_of, turn};
use crate::place::{Batch, Vertex, VertexKind, newton_step, outward};
use crate::qef::{Plane, meet};

/// Linear crossings further off than this (in cells) may lie on the wrong face.
const TRUSTED_MISS: f32 = 0.03;

/// Crossings of candidates are found this well, in cells.
const CROSSING_TOLERANCE: f32 = 0.001;

/// How close to the feature its faces are looked at, as a share of the way to their crossings.
const CLOSE: f32 = 0.2;

/// A smooth surface turns [`CLOSE`] times as much close by, a crease as much as before. What still
/// turns this share is a crease.
const STILL_TURNS: f32 = 0.4;

/// How far from the surface a feature vertex may be, in cells.
pub(crate) const ON_SURFACE: f32 = 0.008;

/// How far from the surface a first guess may be, in cells, if other guesses are to be ignored.
const NEAR_SURFACE: f32 = 0.05;

/// Rounds of looking at the faces close to the feature.
const ROUNDS: usize = 2;

/// Most features outside its safe box that are tried for a vertex.
const MAX_PLACES: usize = 3;

/// Reused memory.
#[derive(Default)]
pub(crate) struct FeatureScratch {
    crossings: Crossings,
    pub candidates: Vec<Candidate>,
    /// The crossings' planes of all candidates.
    pub planes: Vec<Plane>,
    near: Vec<Plane>,
    pub guesses: Vec<Guess>,
}

/// A patch that may hold a feature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub site: u32,
    /// Its crossings' planes, a range of the scratch planes.
    pub planes: [usize; 2],
    pub allowed: Aabb,
    /// Whether `allowed` is the bold box.
    pub bold: bool,
    /// For a bold one: whether an edge passes the safe box.
    pub has_edge: bool,
    pub found: Option<Guess>,
    /// The last answer is final.
    settled: bool,
}

/// Where placed vertices go.
pub(crate) struct Placement<'a> {
    /// One for every site.
    pub vertices: &'a mut [Vertex],
    /// Places outside the safe boxes, ascending by vertex.
    pub bold: &'a mut Vec<Bold>,
    /// The faces at candidates, ascending by vertex.
    pub facets: &'a mut Vec<Facets>,
    /// Sites without features, still to be placed.
    pub smooth: &'a mut Vec<u32>,
}

impl FeatureScratch {
    /// Places the sites of creased regions that have features, and lists all others as smooth.
    pub fn place(
        &mut self,
        sampler: &mut dyn Sampler,
        grid: &Grid,
        sites: &[Site],
        out: &mut Placement,
        batch: &mut Batch,
    ) {
        let spacing = grid.brick.spacing;
        let mut finder = Finder { sampler, grid, sites, spacing, batch, scratch: self };
        finder.find_candidates(out.smooth);
        finder.guess_and_add_bold();
        for _ in 0..ROUNDS {
            finder.look_close();
        }
        finder.follow_edges();
        for number in 0..finder.scratch.candidates.len() {
            let candidate = finder.scratch.candidates[number];
            if !candidate.bold {
                out.facets.push(finder.facets(&candidate));
            }
            let found = candidate.found.filter(|found| found.off <= ON_SURFACE * spacing);
            match found {
                Some(found) if !candidate.bold => {
                    out.vertices[candidate.site as usize] = finder.vertex(&candidate, found);
                }
                Some(found) => {
                    if let Some((place, leap)) = finder.bold_place(&candidate, found) {
                        match out.bold.last_mut() {
                            Some(last) if u32::from(last.number) == candidate.site => last.places.push(place),
                            _ => out.bold.push(finder.bold(&candidate, place, leap)),
                        }
                    }
                }
                None if !candidate.bold => out.smooth.push(candidate.site),
                _ => {}
            }
        }
    }
}

/// The work on one brick.
pub(crate) struct Finder<'a> {
    pub sampler: &'a mut dyn Sampler,
    pub grid: &'a Grid,
    pub sites: &'a [Site],
    pub spacing: f32,
    pub batch: &'a mut Batch,
    pub scratch: &'a mut FeatureScratch,
}

impl Candidate {
    /// The nearest place it may be at.
    pub fn clamp(&self, point: Vec3) -> Vec3 {
        point.clamp(self.allowed.min, self.allowed.max)
    }
}

impl Finder<'_> {
    /// Sorts the sites into candidates and smooth ones, first by linear, then by exact crossings.
    fn find_candidates(&mut self, smooth: &mut Vec<u32>) {
        let Self { sampler, grid, sites, spacing, batch, scratch } = self;
        let FeatureScratch { crossings, candidates, planes, near, .. } = &mut **scratch;
        crossings.find(&mut **sampler, grid, batch);
        candidates.clear();
        planes.clear();
        for (number, &site) in sites.iter().enumerate() {
            let may_turn = !crossings.are_one_piece(site) && {
                near.clear();
                near.extend(crossings.of(site).map(|c| c.plane));
                turn(near) < SAME_FACE
            };
            if may_turn || crossings.of(site).any(|c| c.is_off(TRUSTED_MISS)) {
                candidates.push(Candidate {
                    site: number as u32,
                    planes: [0; 2],
                    allowed: grid.feature_box(site.cell, site.config),
                    bold: false,
                    has_edge: false,
                    found: None,
                    settled: false,
                });
            } else {
                smooth.push(number as u32);
            }
        }
        let wanted = candidates.iter().map(|c| sites[c.site as usize]);
        crossings.refine(&mut **sampler, wanted, *spacing, CROSSING_TOLERANCE, batch);
        candidates.retain_mut(|candidate| {
            let first = planes.len();
            let site = sites[candidate.site as usize];
            planes.extend(crossings.of(site).map(|c| c.plane));
            candidate.planes = [first, planes.len()];
            let sharp = !crossings.are_one_piece(site) && turn(&planes[first..]) < SAME_FACE;
            if !sharp {
                planes.truncate(first);
                smooth.push(candidate.site);
            }
            sharp
        });
    }

    /// Guesses for all candidates, then for those that have no good one in their safe boxes in bold ones.
    fn guess_and_add_bold(&mut self) {
        let safe = self.scratch.candidates.len();
        self.scratch.guesses.clear();
        for number in 0..safe {
            let candidate = self.scratch.candidates[number];
            self.guess(number, &candidate);
        }
        self.measure_guesses();
        for guess in &self.scratch.guesses {
            let best = &mut self.scratch.candidates[guess.candidate].found;
            let better = |old: &Guess| old.off > NEAR_SURFACE * self.spacing && guess.off < old.off;
            if best.as_ref().is_none_or(better) {
                *best = Some(*guess);
            }
        }
        self.scratch.guesses.clear();
        for number in 0..safe {
            let candidate = self.scratch.candidates[number];
            let good = candidate.found.filter(|f| f.off <= NEAR_SURFACE * self.spacing);
            if good.is_none_or(|good| good.is_part) {
                let allowed = self.grid.bold_box(self.sites[candidate.site as usize].cell);
                let has_edge = good.is_some();
                let bold = Candidate { allowed, bold: true, has_edge, found: None, ..candidate };
                self.guess(number, &bold);
                let guesses = std::mem::take(&mut self.scratch.guesses);
                let ranked = self.bold_guesses(&bold, guesses);
                let found = ranked.into_iter().take(MAX_PLACES).map(|g| Candidate { found: Some(g), ..bold });
                self.scratch.candidates.extend(found);
            }
        }
    }

    /// Meets the crossings' planes. Where three or more faces meet elsewhere, their pairs are tried as well:
    /// their corner may lie in another cell while one of their edges passes this one.
    fn guess(&mut self, number: usize, candidate: &Candidate) {
        let planes = &self.scratch.planes[candidate.planes[0]..candidate.planes[1]];
        let whole = meet(planes);
        let guesses = &mut self.scratch.guesses;
        guesses.extend(whole.and_then(|m| Guess::new(number, m, &candidate.allowed, turn(planes))));
        if whole.is_none_or(|m| m.rank == 3) {
            let faces = faces_of(planes);
            for (i, &a) in faces.iter().enumerate() {
                guesses.extend(faces[i + 1..].iter().filter_map(|&b| {
                    let meeting = meet(&[a, b]).filter(|m| m.rank == 2)?;
                    let turn = a.normal.dot(b.normal);
                    let guess = Guess::new(number, meeting, &candidate.allowed, turn)?;
                    Some(Guess { is_part: true, ..guess })
                }));
            }
        }
    }

    fn facets(&self, candidate: &Candidate) -> Facets {
        let faces = faces_of(&self.scratch.planes[candidate.planes[0]..candidate.planes[1]]);
        Facets { number: candidate.site as u16, normals: faces.into_iter().map(|face| face.normal).collect() }
    }

    pub fn vertex(&self, candidate: &Candidate, found: Guess) -> Vertex {
        let planes = &self.scratch.planes[candidate.planes[0]..candidate.planes[1]];
        Vertex {
            position: found.point,
            normal: planes.iter().map(|p| p.normal).sum::<Vec3>().normalize_or_zero(),
            kind: if found.rank == 3 { VertexKind::Corner } else { VertexKind::Edge },
        }
    }

    /// Estimates how far all guesses are from the surface.
    pub fn measure_guesses(&mut self) {
        self.batch.points.clear();
        self.batch.points.extend(self.scratch.guesses.iter().map(|g| g.point));
        let samples = self.batch.sample(self.sampler);
        for (guess, sample) in self.scratch.guesses.iter_mut().zip(samples) {
            guess.off = newton_step(sample).map_or(f32::INFINITY, Vec3::length);
        }
    }

    /// Meets the planes that the faces have close to what was found. Takes the result if it is on the surface.
    fn look_close(&mut self) {
        let Self { sampler, spacing, batch, .. } = self;
        let FeatureScratch { candidates, planes, near, guesses, .. } = &mut *self.scratch;
        let open = |c: &&mut Candidate| !c.settled;
        batch.points.clear();
        for candidate in candidates.iter_mut().filter(open) {
            let Some(found) = candidate.found else {
                candidate.settled = true;
                continue;
            };
            let seen = &planes[candidate.planes[0]..candidate.planes[1]];
            batch.points.extend(seen.iter().map(|p| found.meeting.lerp(p.point, CLOSE)));
            batch.points.push(found.point);
        }
        batch.sample(&mut **sampler);
        guesses.clear();
        let mut next = 0;
        for (number, candidate) in candidates.iter_mut().enumerate().filter(|(_, c)| !c.settled) {
            let found = candidate.found.expect("candidates without are settled");
            let first = next;
            next += candidate.planes[1] - candidate.planes[0] + 1;
            near.clear();
            for (point, sample) in batch.points[first..next].iter().zip(&batch.samples[first..next]) {
                let step = newton_step(sample).filter(|s| s.length() < *spacing);
                near.extend(step.map(|step| Plane { point: *point + step, normal: outward(sample) }));
            }
            let turn = turn(near);
            if turn > SAME_FACE || turn.acos() < STILL_TURNS * found.turn.clamp(-1.0, 1.0).acos() {
                (candidate.found, candidate.settled) = (None, true);
                continue;
            }
            match meet(near).and_then(|m| Guess::new(number, m, &candidate.allowed, turn)) {
                Some(mut guess) => {
                    guess.keep_along_edge(found.point, &candidate.allowed);
                    guesses.push(guess);
                }
                _ => candidate.settled = true,
            }
        }
        self.measure_guesses();
        for guess in &self.scratch.guesses {
            let candidate = &mut self.scratch.candidates[guess.candidate];
            let on_surface = ON_SURFACE * self.spacing;
            if candidate.found.is_none_or(|old| guess.off <= on_surface || guess.off < old.off) {
                candidate.found = Some(*guess);
            }
            candidate.settled = guess.off <= 0.2 * on_surface;
        }
    }
}
