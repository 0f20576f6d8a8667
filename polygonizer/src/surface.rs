//! The surface of a field, brick by brick: made whole, brought up to date, and handed out as a mesh.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use blobtree::{Aabb, Dirty, Field};
use glam::Vec3;
use mesh::Mesh;
use rayon::prelude::*;

use crate::brick_surface::{Bold, BrickSurface, Worker};
use crate::lattice::{BRICKS_PER_BLOCK, BrickKey, BrickRange, Lattice};
use crate::place::{Vertex, VertexKind};
use crate::ring::{Around, OWN, VertexRef};
use crate::split::Split;
use crate::workers::run_tasks;
use crate::{CellSize, Options, PolygonizeError};

/// Most blocks of 60³ cells in a field's box.
const MAX_BLOCKS: u64 = 1 << 20;

/// Bricks that a thread takes at a time: neighbours, so that it seldom changes blocks.
pub(crate) const GRAIN: usize = 8;

/// Offsets of the bricks that a brick's triangles reach into.
pub(crate) const PREVIOUS: RangeInclusive<i32> = -1..=0;

/// A surface in bricks of 15³ cells, which can follow its field.
///
/// Cloning is cheap: bricks are shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    cell: CellSize,
    /// Those with vertices, in the order of their keys.
    pub(crate) bricks: Vec<Entry>,
}

/// A brick that the surface passes, from phase to phase.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub key: BrickKey,
    pub surface: Arc<BrickSurface>,
    /// Those of its bold vertices that may leave their cells if no other does.
    pub bold: Arc<Vec<Bold>>,
    /// Its cells' vertices where they ended up, and what they are stitched to.
    pub settled: Arc<Vec<Vertex>>,
    pub stitched: Arc<Vec<[VertexRef; 3]>>,
    /// Those of these triangles that may cut off an edge, vertices that may make up for it, and those that do.
    pub suspects: Arc<Vec<u32>>,
    pub proposals: Arc<Vec<Split>>,
    /// The box in which the field was looked at for the proposals.
    pub seen: Aabb,
    pub splits: Arc<Vec<Split>>,
    /// All its vertices, those of cells first, and its triangles.
    pub vertices: Arc<Vec<Vertex>>,
    pub triangles: Arc<Vec<[VertexRef; 3]>>,
}

/// A test whether boxes have anything in common with what changed.
type Touch<'a> = Box<dyn FnMut(&Aabb) -> bool + 'a>;

/// What [`Surface::update`] did, as keys of bricks, each list in ascending order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Bricks that are new or whose [`Surface::chunk`] is different now.
    pub changed: Vec<BrickKey>,
    /// Bricks that the surface no longer passes.
    pub removed: Vec<BrickKey>,
}

/// The part of a surface that belongs to one brick, complete in itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Its triangles, and all vertices they need: at the rim also those of neighbouring bricks.
    pub mesh: Mesh,
    /// Unit normals of the vertices, pointing outwards; zero where the field has no gradient.
    pub normals: Vec<Vec3>,
    /// What the vertices mark.
    pub kinds: Vec<VertexKind>,
}

impl Surface {
    /// The surface of `field` in cells of this size.
    ///
    /// - **Promises:** closed, edge-manifold, oriented outwards; no triangle is flat or turned over; every
    ///   vertex is on the surface to 1 % of a cell; every part that holds a lattice point is found. The same
    ///   bytes for any number of threads.
    /// - **Errors:** [`PolygonizeError`], all but `CellSize`.
    /// - **Cost:** proportional to the bricks that the surface passes; runs on the current rayon pool.
    pub fn build(field: &dyn Field, cell: CellSize, options: &Options) -> Result<Self, PolygonizeError> {
        let mut surface = Self { cell, bricks: Vec::new() };
        if let Some(range) = bricks_of(field, cell)? {
            let made = surface.make_bricks(field, range, None, options)?;
            surface.bricks = made.into_iter().map(|(key, brick)| Entry::new(key, brick)).collect();
            surface.finish_all(field);
        }
        options.report(1.0);
        Ok(surface)
    }

    /// Follows `field` after an edit that it can be felt in `dirty` only: then the surface equals a fresh
    /// one, bit for bit.
    ///
    /// - **In:** `dirty` must hold every point where values *or* bounds changed: [`blobtree::ChangedPlaces`], a
    ///   box around what was edited, before and after, or several boxes.
    /// - **Errors:** as [`Self::build`]; the surface is unchanged then.
    /// - **Cost:** proportional to the bricks that `dirty` touches.
    pub fn update(
        &mut self,
        field: &dyn Field,
        dirty: &dyn Dirty,
        options: &Options,
    ) -> Result<Changes, PolygonizeError> {
        let lattice = self.lattice();
        let made = match bricks_of(field, self.cell)? {
            Some(all) => {
                let within = dirty.bounds().intersection(&lattice.region_of(all));
                if within.is_empty() {
                    Vec::new()
                } else {
                    let range = all.intersection(lattice.bricks_near(within));
                    self.make_bricks(field, range, Some(dirty), options)?
                }
            }
            None => Vec::new(),
        };
        let changes = self.replace(field, made, dirty);
        options.report(1.0);
        Ok(changes)
    }

    /// Cell size.
    pub fn cell(&self) -> CellSize {
        self.cell
    }

    /// The whole surface as one mesh: bricks in the order of [`Self::bricks`], welded.
    pub fn mesh(&self) -> Mesh {
        let (vertex_starts, vertex_count) = starts(self.bricks.iter().map(|b| b.vertices.len()));
        let (_, triangle_count) = starts(self.bricks.iter().map(|b| b.triangles.len()));
        let mut mesh =
            Mesh { positions: vec![Vec3::ZERO; vertex_count], triangles: vec![[0; 3]; triangle_count] };
        let (mut positions, mut triangles) = (&mut mesh.positions[..], &mut mesh.triangles[..]);
        let mut jobs = Vec::with_capacity(self.bricks.len());
        for entry in &self.bricks {
            let (own_positions, own_triangles);
            (own_positions, positions) = positions.split_at_mut(entry.vertices.len());
            (own_triangles, triangles) = triangles.split_at_mut(entry.triangles.len());
            jobs.push((entry, own_positions, own_triangles));
        }
        jobs.into_par_iter().with_min_len(16).for_each(|(entry, positions, triangles)| {
            for (to, vertex) in positions.iter_mut().zip(entry.vertices.iter()) {
                *to = vertex.position;
            }
            let around = self.indices_around(entry.key, PREVIOUS);
            let first = around.map(|index| index.map_or(0, |i| vertex_starts[i] as u32));
            for (to, triangle) in triangles.iter_mut().zip(entry.triangles.iter()) {
                *to = triangle.map(|v| first[v.brick()] + v.number() as u32);
            }
        });
        mesh
    }

    /// Unit normals that point outwards, one for every position of [`Self::mesh`]; zero where the field has
    /// no gradient. On sharp edges they are means.
    pub fn normals(&self) -> Vec<Vec3> {
        self.bricks.iter().flat_map(|b| b.vertices.iter().map(|v| v.normal)).collect()
    }

    /// What the vertices mark, one for every position of [`Self::mesh`].
    pub fn kinds(&self) -> Vec<VertexKind> {
        self.bricks.iter().flat_map(|b| b.vertices.iter().map(|v| v.kind)).collect()
    }

    /// How many triangles [`Self::mesh`] has.
    pub fn triangle_count(&self) -> usize {
        self.bricks.iter().map(|b| b.triangles.len()).sum()
    }

    /// The keys of all bricks that the surface passes, ascending.
    pub fn bricks(&self) -> impl ExactSizeIterator<Item = BrickKey> {
        self.bricks.iter().map(|b| b.key)
    }

    /// The part that belongs to a brick; empty for keys not in [`Self::bricks`]. All chunks together are the
    /// surface, each triangle once.
    pub fn chunk(&self, key: BrickKey) -> Chunk {
        let Some(index) = self.find(key) else { return Chunk::default() };
        let triangles = &self.bricks[index].triangles;
        let mut used: Vec<VertexRef> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let around = self.indices_around(key, PREVIOUS);
        let vertices = used.iter().map(|v| {
            let brick = around[v.brick()].expect("triangles only name bricks that exist");
            self.bricks[brick].vertices[v.number()]
        });
        let mut chunk = Chunk::default();
        for vertex in vertices {
            chunk.mesh.positions.push(vertex.position);
            chunk.normals.push(vertex.normal);
            chunk.kinds.push(vertex.kind);
        }
        let number = |v: &VertexRef| used.binary_search(v).expect("all are listed") as u32;
        chunk.mesh.triangles = triangles.iter().map(|t| t.each_ref().map(number)).collect();
        chunk
    }

    pub(crate) fn lattice(&self) -> Lattice {
        Lattice { spacing: self.cell.mm() }
    }

    /// Phase one for all bricks in `range`, or those of them that `dirty` touches.
    fn make_bricks(
        &self,
        field: &dyn Field,
        range: BrickRange,
        dirty: Option<&dyn Dirty>,
        options: &Options,
    ) -> Result<Vec<(BrickKey, BrickSurface)>, PolygonizeError> {
        let lattice = self.lattice();
        let blocks: Vec<[i32; 3]> = range.blocks().iter().collect();
        let tasks = blocks.len() * BRICKS_PER_BLOCK;
        let triangles = AtomicUsize::new(0);
        let done = AtomicUsize::new(0);
        let make = |(worker, touch): &mut (Worker, Option<Touch>), task: usize| {
            if options.is_cancelled() {
                return Err(PolygonizeError::Cancelled);
            }
            let number = done.fetch_add(1, Ordering::Relaxed);
            if number.is_multiple_of(BRICKS_PER_BLOCK) {
                options.report(number as f32 / tasks as f32);
            }
            let Some(key) = range.in_block(blocks[task / BRICKS_PER_BLOCK], task % BRICKS_PER_BLOCK) else {
                return Ok(None);
            };
            if touch.as_mut().is_some_and(|touch| !touch(&lattice.apron(key))) {
                return Ok(None);
            }
            let Some(brick) = worker.make(key) else { return Ok(None) };
            // Every vertex has about one quadrilateral.
            let made = 2 * brick.vertices.len();
            if triangles.fetch_add(made, Ordering::Relaxed) + made > options.max_triangles {
                return Err(PolygonizeError::TooManyTriangles {
                    limit: options.max_triangles,
                    cell_mm: self.cell.mm(),
                });
            }
            Ok(Some((key, brick)))
        };
        let worker = || (Worker::new(field.sampler(), lattice), dirty.map(Dirty::touch));
        let mut made = run_tasks(tasks, GRAIN, worker, make)?;
        made.par_sort_unstable_by_key(|(key, _)| *key);
        Ok(made)
    }

    /// Puts `made` in the place of all bricks that `dirty` touches, then the other phases where it matters.
    fn replace(
        &mut self,
        field: &dyn Field,
        made: Vec<(BrickKey, BrickSurface)>,
        dirty: &dyn Dirty,
    ) -> Changes {
        let lattice = self.lattice();
        let mut touch = dirty.touch();
        let mut made: BTreeMap<_, _> = made.into_iter().collect();
        let mut changes = Changes::default();
        let mut touched = Vec::new();
        self.bricks.retain_mut(|entry| {
            if !touch(&lattice.apron(entry.key)) {
                return true;
            }
            match made.remove(&entry.key) {
                Some(brick) if *entry.surface == brick => {}
                Some(brick) => {
                    entry.surface = Arc::new(brick);
                    touched.push(entry.key);
                }
                None => {
                    changes.removed.push(entry.key);
                    return false;
                }
            }
            true
        });
        touched.extend(made.keys());
        self.bricks.extend(made.into_iter().map(|(key, brick)| Entry::new(key, brick)));
        self.bricks.sort_unstable_by_key(|entry| entry.key);
        touched.extend(&changes.removed);
        changes.changed = self.finish_around(field, &touched, &mut *touch);
        changes
    }

    pub(crate) fn find(&self, key: BrickKey) -> Option<usize> {
        self.bricks.binary_search_by_key(&key, |b| b.key).ok()
    }

    /// Where the bricks around `key` are that are `offsets` from it along each axis.
    pub(crate) fn indices_around(&self, key: BrickKey, offsets: RangeInclusive<i32>) -> Around<usize> {
        let mut around = [None; 27];
        for dx in offsets.clone() {
            for dy in offsets.clone() {
                // Keys that differ in the last number only are neighbours in the list.
                let first = [key[0] + dx, key[1] + dy, key[2] + offsets.start()];
                let start = self.bricks.partition_point(|b| b.key < first);
                for (i, entry) in self.bricks.iter().enumerate().skip(start).take(3) {
                    let dz = entry.key[2] - key[2];
                    if entry.key[..2] == first[..2] && offsets.contains(&dz) {
                        let index = OWN as i32 + dx + 3 * dy + 9 * dz;
                        around[index as usize] = Some(i);
                    }
                }
            }
        }
        around
    }
}

impl Entry {
    pub fn new(key: BrickKey, surface: BrickSurface) -> Self {
        Self {
            key,
            bold: Arc::default(),
            settled: Arc::clone(&surface.vertices),
            stitched: Arc::default(),
            suspects: Arc::default(),
            proposals: Arc::default(),
            seen: Aabb::EMPTY,
            splits: Arc::default(),
            vertices: Arc::clone(&surface.vertices),
            triangles: Arc::default(),
            surface: Arc::new(surface),
        }
    }
}

/// The bricks that the surface of `field` can pass; `None` if it is empty.
fn bricks_of(field: &dyn Field, cell: CellSize) -> Result<Option<BrickRange>, PolygonizeError> {
    let support = field.support();
    if support.is_empty() && !support.min.is_nan() && !support.max.is_nan() {
        return Ok(None);
    }
    if !(support.min.is_finite() && support.max.is_finite()) {
        let (min, max) = (support.min.to_array(), support.max.to_array());
        return Err(PolygonizeError::Support { min, max });
    }
    let fitting = |mm: f32| {
        Lattice { spacing: mm }.bricks_within_reach(support).filter(|r| r.blocks().count() <= MAX_BLOCKS)
    };
    match fitting(cell.mm()) {
        Some(range) => Ok(Some(range)),
        None => {
            let coarser = std::iter::successors(Some(cell.mm()), |mm| Some(2.0 * mm));
            let fits = coarser.take_while(|mm| mm.is_finite()).find(|&mm| fitting(mm).is_some());
            Err(PolygonizeError::TooFine { cell_mm: cell.mm(), fits_mm: fits.unwrap_or(f32::MAX) })
        }
    }
}

/// Where each of a row of lists starts when they are joined, and how long they are together.
fn starts(lengths: impl Iterator<Item = usize>) -> (Vec<usize>, usize) {
    let mut total = 0;
    let mut starts = Vec::new();
    for length in lengths {
        starts.push(total);
        total += length;
    }
    (starts, total)
}
