//! Places vertices on smooth surfaces: from the mean of a patch's crossings along the gradient.

use blobtree::{ISO, Sample, Sampler};
use glam::Vec3;

use crate::grid::{Grid, Site, corner, is_inside};
use crate::patches::edge_start;

/// What a vertex of a surface marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum VertexKind {
    /// A point of a smooth part.
    Smooth,
    /// A point of a sharp edge, where two faces meet.
    Edge,
    /// A sharp corner, where three or more faces meet, or the tip of a cone.
    Corner,
}

/// A placed vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vertex {
    /// mm.
    pub position: Vec3,
    /// Unit, pointing outwards; zero where the field has no gradient.
    pub normal: Vec3,
    pub kind: VertexKind,
}

/// Newton steps this short (in cells) need no check: the error left is about the square of it, times half
/// the field's second derivative per first, in cells, which would have to exceed 20 to leave 1 %.
const SAFE_STEP: f32 = 0.03;

/// Newton rounds before bisection takes over. Smooth blobs need one or two.
const NEWTON_ROUNDS: usize = 4;

/// Bisections of a path of at most √3 cells: down to a 1000th of a cell.
const BISECTIONS: usize = 11;

/// How far a vertex's normal may lean from the way that its patch's edges lead outwards, as a dot product, before it is
/// taken to be on another sheet. The normal of a plane through the edges has 0.5 and more; where edges are sharp, that of
/// a face may have 0.3.
const ASTRAY: f32 = 0.1;

/// Points on their way to a sampler and what comes back. Reused.
#[derive(Default)]
pub(crate) struct Batch {
    pub points: Vec<Vec3>,
    pub samples: Vec<Sample>,
    values: Vec<f32>,
}

impl Batch {
    /// Fills `samples` for `points`.
    pub fn sample(&mut self, sampler: &mut dyn Sampler) -> &[Sample] {
        self.samples.clear();
        self.samples.resize(self.points.len(), Sample::default());
        sampler.samples(&self.points, &mut self.samples);
        &self.samples
    }

    /// The values at `points`.
    pub fn evaluate(&mut self, sampler: &mut dyn Sampler) -> &[f32] {
        self.values.clear();
        self.values.resize(self.points.len(), 0.0);
        sampler.values(&self.points, &mut self.values);
        &self.values
    }
}

/// The step from a sample's point to the surface, if the field is linear; `None` where it is level.
pub(crate) fn newton_step(sample: &Sample) -> Option<Vec3> {
    let step = sample.gradient * ((ISO - sample.value) / sample.gradient.length_squared());
    step.is_finite().then_some(step)
}

/// The unit normal that points out of the solid; zero where the field is level.
pub(crate) fn outward(sample: &Sample) -> Vec3 {
    -sample.gradient.normalize_or_zero()
}

/// Places the vertices of those `sites` whose numbers are `pending`, each inside its own cell and at most
/// 1 % of a cell from the surface. Empties `pending`.
pub(crate) fn place_smooth(
    sampler: &mut dyn Sampler,
    grid: &Grid,
    sites: &[Site],
    pending: &mut Vec<u32>,
    vertices: &mut [Vertex],
    batch: &mut Batch,
) {
    for &i in pending.iter() {
        let site = sites[i as usize];
        let own = grid.own_box(site.cell);
        vertices[i as usize].position = grid.mean_crossing(site).clamp(own.min, own.max);
    }
    let spacing = grid.brick.spacing;
    for _ in 0..NEWTON_ROUNDS {
        if pending.is_empty() {
            return;
        }
        batch.points.clear();
        batch.points.extend(pending.iter().map(|&i| vertices[i as usize].position));
        let mut samples = batch.sample(sampler).iter();
        pending.retain(|&i| {
            let sample = samples.next().expect("one sample per pending vertex");
            let Some(step) = newton_step(sample) else { return true };
            let own = grid.own_box(sites[i as usize].cell);
            let vertex = &mut vertices[i as usize];
            let target = vertex.position + step;
            let reached = target.clamp(own.min, own.max);
            vertex.position = reached;
            vertex.normal = outward(sample);
            let missed = (target - reached).length_squared();
            step.length_squared() > (SAFE_STEP * spacing).powi(2) || missed > (0.002 * spacing).powi(2)
        });
    }
    bisect(sampler, grid, sites, pending, vertices, batch);
}

/// Finds the surface between where a vertex is and a corner of its cell on the other side.
fn bisect(
    sampler: &mut dyn Sampler,
    grid: &Grid,
    sites: &[Site],
    pending: &mut Vec<u32>,
    vertices: &mut [Vertex],
    batch: &mut Batch,
) {
    if pending.is_empty() {
        return;
    }
    batch.points.clear();
    batch.points.extend(pending.iter().map(|&i| vertices[i as usize].position));
    let mut brackets: Vec<Bracket> = batch
        .evaluate(sampler)
        .iter()
        .zip(pending.iter())
        .map(|(&value, &i)| {
            let start = vertices[i as usize].position;
            let other = nearest_corner(grid, sites[i as usize], start, !is_inside(value));
            if is_inside(value) {
                Bracket { inside: start, outside: other }
            } else {
                Bracket { inside: other, outside: start }
            }
        })
        .collect();
    narrow(sampler, &mut brackets, batch);
    batch.points.clear();
    batch.points.extend(brackets.iter().zip(pending.iter()).map(|(bracket, &i)| {
        let own = grid.own_box(sites[i as usize].cell);
        bracket.middle().clamp(own.min, own.max)
    }));
    batch.sample(sampler);
    for (n, i) in pending.drain(..).enumerate() {
        vertices[i as usize].position = batch.points[n];
        vertices[i as usize].normal = outward(&batch.samples[n]);
    }
}

/// Brings vertices back that the field led to the sheet of another patch of their cell: to where the surface crosses
/// one of their own patch's edges.
pub(crate) fn bring_back(
    sampler: &mut dyn Sampler,
    grid: &Grid,
    sites: &[Site],
    vertices: &mut [Vertex],
    batch: &mut Batch,
) {
    let is_astray = |site: &Site, vertex: &Vertex| {
        let is_smooth = vertex.kind == VertexKind::Smooth;
        is_smooth && site.outward().normalize_or_zero().dot(vertex.normal) < ASTRAY
    };
    let numbered = sites.iter().zip(&*vertices).enumerate().filter(|(_, (site, _))| site.shares_cell);
    let astray: Vec<usize> =
        numbered.filter(|(_, (site, vertex))| is_astray(site, vertex)).map(|(number, _)| number).collect();
    if astray.is_empty() {
        return;
    }
    let mut brackets: Vec<Bracket> = astray.iter().map(|&i| nearest_edge(grid, sites[i])).collect();
    narrow(sampler, &mut brackets, batch);
    batch.points.clear();
    batch.points.extend(brackets.iter().zip(&astray).map(|(bracket, &i)| {
        let own = grid.own_box(sites[i].cell);
        bracket.middle().clamp(own.min, own.max)
    }));
    batch.sample(sampler);
    for (n, i) in astray.into_iter().enumerate() {
        vertices[i].position = batch.points[n];
        vertices[i].normal = outward(&batch.samples[n]);
    }
}

/// The crossed edge of a patch that is crossed nearest to the mean of all crossings.
fn nearest_edge(grid: &Grid, site: Site) -> Bracket {
    let mean = grid.mean_crossing(site);
    let ends = |edge: usize| {
        let start = edge_start(edge);
        let [from, to] = [start, start | 1 << (edge / 4)].map(|c| grid.point(corner(site.cell, c)));
        let t = grid.linear_crossing(corner(site.cell, start), edge / 4);
        let bracket = if site.config >> start & 1 == 1 {
            Bracket { inside: from, outside: to }
        } else {
            Bracket { inside: to, outside: from }
        };
        (from.lerp(to, t).distance_squared(mean), bracket)
    };
    let nearest = site.crossed_edges().map(ends).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.expect("a patch has at least three crossed edges").1
}

/// Halves the paths until their ends meet on the surface.
fn narrow(sampler: &mut dyn Sampler, brackets: &mut [Bracket], batch: &mut Batch) {
    for _ in 0..BISECTIONS {
        batch.points.clear();
        batch.points.extend(brackets.iter().map(Bracket::middle));
        for (&value, bracket) in batch.evaluate(sampler).iter().zip(&mut *brackets) {
            let middle = bracket.middle();
            *(if is_inside(value) { &mut bracket.inside } else { &mut bracket.outside }) = middle;
        }
    }
}

/// A path with its ends on different sides of the surface.
struct Bracket {
    inside: Vec3,
    outside: Vec3,
}

impl Bracket {
    fn middle(&self) -> Vec3 {
        self.inside.midpoint(self.outside)
    }
}

/// The nearest end of the site's crossed edges that is inside, or outside. Every site has both.
fn nearest_corner(grid: &Grid, site: Site, to: Vec3, inside: bool) -> Vec3 {
    site.crossed_edges()
        .map(|edge| {
            let start = edge_start(edge);
            let start_is_inside = site.config >> start & 1 == 1;
            let number = if start_is_inside == inside { start } else { start | 1 << (edge / 4) };
            grid.point(corner(site.cell, number))
        })
        .min_by(|a, b| a.distance_squared(to).total_cmp(&b.distance_squared(to)))
        .expect("a patch has at least three crossed edges")
}
