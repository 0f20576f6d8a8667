//! Places vertices on sharp edges and corners, where faces of different direction meet in a cell.
//!
//! A patch whose normals at its crossings disagree is a candidate. Its faces' planes are met in a point, then
//! the faces are looked at again close to that point: there the normals of a merely curved surface
//! agree, those of a crease do not, and the planes of curved faces fit. An edge is followed as far as its
//! vertex may go, to find corners with faces that no crossing of the cell lies on. Whatever does not end on
//! the surface is placed as smooth.
//!
//! **Source:** Kobbelt et al. 2001, *Feature sensitive surface extraction*. **Departs:** planes are taken
//! near the feature, the vertex may leave its cell (see [`Grid::feature_box`]), and the result is checked.

use blobtree::{Aabb, Brick, ISO, Sample, Sampler};
use glam::Vec3;

use crate::crossings::Crossings;
use crate::brick_surface::Bold;
use crate::grid::{Grid, Site, is_inside};
use crate::lattice::CELLS;
use crate::place::{Batch, Vertex, VertexKind, newton_step, outward};
use crate::qef::{Meeting, Plane, meet};

/// Normals with a smaller dot product belong to different faces: 11.5° apart. Rounding off an edge that
/// turns less moves the surface by less than half a cell times the tangent of half the turn, 0.05 cell.
const SAME_FACE: f32 = 0.98;

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
const ON_SURFACE: f32 = 0.008;

/// How far from the surface a first guess may be, in cells, if other guesses are to be ignored.
const NEAR_SURFACE: f32 = 0.05;

/// How far outside its box a feature may be, in cells, to be moved to the box instead of left out.
const SLACK: f32 = 0.006;

/// Rounds of looking at the faces close to the feature.
const ROUNDS: usize = 2;

/// Most features outside its safe box that are tried for a vertex.
const MAX_PLACES: usize = 3;

/// Rounds of the search for the end of an edge.
const WALK_ROUNDS: usize = 5;

/// Reused memory.
#[derive(Default)]
pub(crate) struct FeatureScratch {
    crossings: Crossings,
    candidates: Vec<Candidate>,
    planes: Vec<Plane>,
    near: Vec<Plane>,
    guesses: Vec<Guess>,
}

/// A patch that may hold a feature.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    site: u32,
    /// Its crossings' planes, a range of the scratch planes.
    planes: [usize; 2],
    allowed: Aabb,
    /// Whether `allowed` is the bold box.
    bold: bool,
    /// For a bold one: whether an edge passes the safe box.
    has_edge: bool,
    found: Option<Guess>,
    /// The last answer is final.
    settled: bool,
}

/// Where a feature might be.
#[derive(Clone, Copy, Debug)]
struct Guess {
    candidate: usize,
    point: Vec3,
    rank: u8,
    /// Direction of the edge, for rank 2.
    free: Vec3,
    /// Smallest dot product of the normals that meet.
    turn: f32,
    /// Estimated distance from the surface, mm.
    off: f32,
    /// Whether it is the edge of two faces where the cell sees more.
    is_part: bool,
}

/// Where placed vertices go.
pub(crate) struct Placement<'a> {
    /// One for every site.
    pub vertices: &'a mut [Vertex],
    /// Places outside the safe boxes, ascending by vertex.
    pub bold: &'a mut Vec<Bold>,
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

struct Finder<'a> {
    sampler: &'a mut dyn Sampler,
    grid: &'a Grid,
    sites: &'a [Site],
    spacing: f32,
    batch: &'a mut Batch,
    scratch: &'a mut FeatureScratch,
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
            near.clear();
            near.extend(crossings.of(site).map(|c| c.plane));
            if turn(near) < SAME_FACE || crossings.of(site).any(|c| c.is_off(TRUSTED_MISS)) {
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
            planes.extend(crossings.of(sites[candidate.site as usize]).map(|c| c.plane));
            candidate.planes = [first, planes.len()];
            let sharp = turn(&planes[first..]) < SAME_FACE;
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

    /// Those of a candidate's guesses outside its safe box that are its to mark, best first: what lies in cells
    /// that the surface does not seem to pass, corners before edges; other edges only if none passes its safe box.
    fn bold_guesses(&mut self, candidate: &Candidate, guesses: Vec<Guess>) -> Vec<Guess> {
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
        Some(Guess { point, ..guess })
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

    fn vertex(&self, candidate: &Candidate, found: Guess) -> Vertex {
        let planes = &self.scratch.planes[candidate.planes[0]..candidate.planes[1]];
        Vertex {
            position: found.point,
            normal: planes.iter().map(|p| p.normal).sum::<Vec3>().normalize_or_zero(),
            kind: if found.rank == 3 { VertexKind::Corner } else { VertexKind::Edge },
        }
    }

    /// What a bold candidate has found, and how far outside its cell, if it is its to mark.
    fn bold_place(&mut self, candidate: &Candidate, found: Guess) -> Option<(Vertex, f32)> {
        let unseen = self.is_unseen(candidate, found.point);
        if !unseen && (candidate.has_edge || found.rank == 3) {
            return None;
        }
        let own = self.grid.own_box(self.sites[candidate.site as usize].cell);
        let leap = found.point.distance(found.point.clamp(own.min, own.max));
        Some((self.vertex(candidate, found), leap))
    }

    fn bold(&self, candidate: &Candidate, place: Vertex, leap: f32) -> Bold {
        let cell = self.sites[candidate.site as usize].cell;
        Bold {
            number: candidate.site as u16,
            places: vec![place],
            leap,
            index: std::array::from_fn(|a| self.grid.brick.origin[a] + i32::from(cell[a])),
        }
    }

    /// Estimates how far all guesses are from the surface.
    fn measure_guesses(&mut self) {
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
            batch.points.extend(seen.iter().map(|p| found.point.lerp(p.point, CLOSE)));
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

    /// Looks for corners with faces that no crossing lies on: along edges, as far as their vertices may go.
    fn follow_edges(&mut self) {
        let on_surface = ON_SURFACE * self.spacing;
        let mut walks = Vec::new();
        for (number, candidate) in self.scratch.candidates.iter().enumerate() {
            let edge = candidate.found.filter(|f| !candidate.bold && f.rank == 2 && f.off <= on_surface);
            let reach = edge.and_then(|found| Some((found, clip(found.point, found.free, &candidate.allowed)?)));
            if let Some((found, ends)) = reach {
                walks.extend(ends.map(|t| Walk { candidate: number, found, on_edge: 0.0, beyond: t, t, corner: None }));
            }
        }
        for _ in 0..WALK_ROUNDS {
            self.batch.points.clear();
            self.batch.points.extend(walks.iter().map(|w| {
                self.scratch.candidates[w.candidate].clamp(w.found.point + w.found.free * w.t)
            }));
            let samples = self.batch.sample(self.sampler);
            for (walk, sample) in walks.iter_mut().zip(samples) {
                let Candidate { planes: [first, end], .. } = self.scratch.candidates[walk.candidate];
                walk.take(sample, &self.scratch.planes[first..end]);
            }
            // Whoever is on a known face at the far end already has nothing to find.
            walks.retain(|walk| walk.corner.is_some());
        }
        self.scratch.guesses.clear();
        for walk in walks {
            let point = walk.corner.map(|t| walk.found.point + walk.found.free * t);
            let candidate = &self.scratch.candidates[walk.candidate];
            let reached = point.map(|p| (p, candidate.clamp(p)));
            let slack = SLACK * self.spacing;
            if let Some((_, point)) = reached.filter(|(p, reached)| p.distance(*reached) <= slack) {
                self.scratch.guesses.push(Guess { candidate: walk.candidate, point, rank: 3, ..walk.found });
            }
        }
        self.measure_guesses();
        for guess in self.scratch.guesses.iter().filter(|g| g.off <= on_surface) {
            self.scratch.candidates[guess.candidate].found = Some(*guess);
        }
    }
}

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
}

impl Walk {
    fn take(&mut self, sample: &Sample, known: &[Plane]) {
        let normal = outward(sample);
        let slope = sample.gradient.dot(self.found.free);
        let is_new = known.iter().all(|p| p.normal.dot(normal) < 0.9) && normal.dot(self.found.free).abs() > 0.1;
        if is_new {
            self.beyond = self.t;
            let corner = self.t + (ISO - sample.value) / slope;
            self.corner = Some(corner);
            self.t = corner;
        } else {
            self.on_edge = self.t;
        }
        let between = (self.on_edge.min(self.beyond)..self.on_edge.max(self.beyond)).contains(&self.t);
        if !between || self.t == self.on_edge {
            self.t = self.on_edge.midpoint(self.beyond);
        }
    }
}

impl Candidate {
    fn clamp(&self, point: Vec3) -> Vec3 {
        point.clamp(self.allowed.min, self.allowed.max)
    }
}

impl Guess {
    /// The meeting if it is a feature inside `allowed`, an edge moved along itself to get there.
    fn new(candidate: usize, meeting: Meeting, allowed: &Aabb, turn: f32) -> Option<Self> {
        let Meeting { mut point, rank, free, .. } = meeting;
        if rank < 2 {
            return None;
        }
        let slack = SLACK * allowed.size().min_element();
        if point.distance(point.clamp(allowed.min, allowed.max)) <= slack {
            point = point.clamp(allowed.min, allowed.max);
        } else {
            if rank == 3 {
                return None;
            }
            let [low, high] = clip(point, free, allowed)?;
            point = (point + free * 0.0_f32.clamp(low, high)).clamp(allowed.min, allowed.max);
        }
        Some(Self { candidate, point, rank, free, turn, off: f32::INFINITY, is_part: false })
    }
}

impl Guess {
    /// Moves an edge's point along the edge to where that is nearest to `old`.
    fn keep_along_edge(&mut self, old: Vec3, allowed: &Aabb) {
        let along = (old - self.point).dot(self.free);
        let reach = clip(self.point, self.free, allowed).filter(|_| self.rank == 2);
        if let Some([low, high]) = reach {
            let point = self.point + self.free * along.clamp(low, high);
            self.point = point.clamp(allowed.min, allowed.max);
        }
    }
}

/// The smallest dot product of any two of the planes' normals.
fn turn(planes: &[Plane]) -> f32 {
    let mut least = 1.0_f32;
    for (i, a) in planes.iter().enumerate() {
        for b in &planes[i + 1..] {
            least = least.min(a.normal.dot(b.normal));
        }
    }
    least
}

/// The planes joined to one for each direction, at most six.
fn faces_of(planes: &[Plane]) -> Vec<Plane> {
    let mut faces: Vec<(Plane, Plane, f32)> = Vec::new();
    for plane in planes {
        match faces.iter().position(|(first, ..)| first.normal.dot(plane.normal) > SAME_FACE) {
            Some(i) => {
                let (_, sum, count) = &mut faces[i];
                sum.point += plane.point;
                sum.normal += plane.normal;
                *count += 1.0;
            }
            None if faces.len() < 6 => faces.push((*plane, *plane, 1.0)),
            None => {}
        }
    }
    faces
        .into_iter()
        .map(|(_, sum, count)| Plane { point: sum.point / count, normal: sum.normal.normalize_or_zero() })
        .collect()
}

/// The range of `t` in which `point + t · direction` is in `allowed`; `None` if it never is.
fn clip(point: Vec3, direction: Vec3, allowed: &Aabb) -> Option<[f32; 2]> {
    let mut range = [f32::NEG_INFINITY, f32::INFINITY];
    for axis in 0..3 {
        if direction[axis].abs() < 1e-6 {
            if !(allowed.min[axis]..=allowed.max[axis]).contains(&point[axis]) {
                return None;
            }
            continue;
        }
        let a = (allowed.min[axis] - point[axis]) / direction[axis];
        let b = (allowed.max[axis] - point[axis]) / direction[axis];
        range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    }
    (range[0] <= range[1] && range[0].is_finite() && range[1].is_finite()).then_some(range)
}
