//! Phase one: the vertices of one brick's cells, from nothing but the field in the brick and one cell around.

use std::sync::Arc;

use blobtree::{Brick, ISO, Interval, Sampler};
use glam::Vec3;

use crate::feature::{FeatureScratch, Placement};
use crate::grid::{Grid, Site, bits, is_inside};
use crate::lattice::{BrickKey, CELLS, Lattice, block_of};
use crate::patches::{FLIPPED, NONE, PATCHES, face_corners};
use crate::place::{Batch, Vertex, VertexKind, bring_back, place_smooth};

/// Rows of cells in a brick.
const ROWS: usize = CELLS * CELLS;

/// A cell that the surface passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MixedCell {
    /// Number of the vertex of its first patch; the others follow.
    pub first_vertex: u16,
    /// Key of its patches in [`PATCHES`].
    pub key: u16,
}

/// The vertices of a brick and where to find them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BrickSurface {
    /// Bit x of word `z · 15 + y` is set where cell `[x, y, z]` is mixed.
    rows: [u16; ROWS],
    /// Mixed cells before each row.
    before: [u16; ROWS],
    /// All mixed cells, x fastest.
    cells: Vec<MixedCell>,
    /// The vertices, in the order of cells and patches. Each in its [`Grid::feature_box`].
    pub vertices: Arc<Vec<Vertex>>,
    /// Better places for some of them, ascending, if those around allow it.
    pub bold: Vec<Bold>,
    /// What meets at those of the vertices that may mark edges or corners, ascending.
    pub facets: Vec<Facets>,
}

/// The faces that a cell with a sharp edge sees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Facets {
    /// Number of the vertex.
    pub number: u16,
    /// The faces' unit normals.
    pub normals: Vec<Vec3>,
}

/// A feature further from its cell than is safe.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bold {
    /// Number of the vertex.
    pub number: u16,
    /// What it could be, best first.
    pub places: Vec<Vertex>,
    /// How far the best one is outside the cell, mm.
    pub leap: f32,
    /// Its cell's lattice index.
    pub index: [i32; 3],
}

impl Bold {
    /// Which of several goes first: no two of one ring are equal.
    pub fn rank(&self) -> (u32, [i32; 3]) {
        (self.leap.to_bits(), self.index)
    }
}

impl BrickSurface {
    /// The normals of the faces that meet at a vertex, as far as they are known.
    pub fn normals_at(&self, number: usize) -> &[Vec3] {
        let found = self.facets.binary_search_by_key(&number, |facets| usize::from(facets.number));
        found.map_or(&[], |n| &self.facets[n].normals)
    }

    /// Whether the crossings of a vertex's patch lie on faces of different direction.
    pub fn sees_faces(&self, number: usize) -> bool {
        self.facets.binary_search_by_key(&number, |facets| usize::from(facets.number)).is_ok()
    }

    /// The mixed cell at `[x, y, z]`, if it is one.
    pub fn cell(&self, [x, y, z]: [usize; 3]) -> Option<MixedCell> {
        let row = z * CELLS + y;
        let bits = self.rows[row];
        let before = self.before[row] as usize + (bits & ((1 << x) - 1)).count_ones() as usize;
        (bits >> x & 1 == 1).then(|| self.cells[before])
    }

    /// The cell, its configuration and the edge for every edge that crosses the patch of a vertex.
    pub fn edges_of(&self, bold: &Bold) -> impl Iterator<Item = ([usize; 3], u8, usize)> {
        let n = self.cells.partition_point(|cell| cell.first_vertex <= bold.number) - 1;
        let MixedCell { first_vertex, key } = self.cells[n];
        let place = self.place_of(n);
        let patches = &PATCHES[usize::from(key)];
        let edges = patches.edges[usize::from(bold.number - first_vertex)];
        bits(edges).map(move |edge| (place, key as u8, edge))
    }

    /// All mixed cells with their places, x fastest.
    pub fn cells(&self) -> impl Iterator<Item = ([usize; 3], MixedCell)> {
        let places = self
            .rows
            .iter()
            .enumerate()
            .flat_map(|(row, &word)| bits(word).map(move |x| [x, row % CELLS, row / CELLS]));
        places.zip(self.cells.iter().copied())
    }
}

/// What a thread keeps while it makes bricks: a sampler and scratch memory.
pub(crate) struct Worker<'f> {
    sampler: Box<dyn Sampler + 'f>,
    lattice: Lattice,
    /// The block that the sampler is in, and whether the surface may pass it.
    block: Option<([i32; 3], bool)>,
    grid: Grid,
    keys: Vec<u16>,
    sites: Vec<Site>,
    pending: Vec<u32>,
    vertices: Vec<Vertex>,
    bold: Vec<Bold>,
    facets: Vec<Facets>,
    batch: Batch,
    feature: FeatureScratch,
}

/// Whether a surface may pass where the field has these bounds; bounds that are no numbers prove nothing.
pub(crate) fn may_cross(bounds: Interval) -> bool {
    !(bounds.lo > ISO || bounds.hi < ISO)
}

impl<'f> Worker<'f> {
    pub fn new(sampler: Box<dyn Sampler + 'f>, lattice: Lattice) -> Self {
        Self {
            sampler,
            lattice,
            block: None,
            grid: Grid::new(),
            keys: Vec::new(),
            sites: Vec::new(),
            pending: Vec::new(),
            vertices: Vec::new(),
            bold: Vec::new(),
            facets: Vec::new(),
            batch: Batch::default(),
            feature: FeatureScratch::default(),
        }
    }

    /// Whether the surface may pass `block`. The sampler stays in there.
    pub fn enter_block(&mut self, block: [i32; 3]) -> bool {
        if let Some((entered, crosses)) = self.block {
            if entered == block {
                return crosses;
            }
            self.sampler.leave();
        }
        let crosses = may_cross(self.sampler.enter(self.lattice.block_region(block)));
        self.block = Some((block, crosses));
        crosses
    }

    /// The vertices of the brick at `key`; `None` if the surface does not pass it.
    pub fn make(&mut self, key: BrickKey) -> Option<BrickSurface> {
        if !self.enter_block(block_of(key)) {
            return None;
        }
        self.grid.move_to(self.lattice.brick(key));
        let region = self.grid.brick.region();
        let bounds = self.sampler.enter(region);
        if !may_cross(bounds) {
            self.sampler.leave();
            return None;
        }
        self.sampler.fill(&self.grid.brick, &mut self.grid.values);
        let creased = self.sampler.creased();
        if !self.grid.read_signs() {
            self.sampler.leave();
            return None;
        }
        let mut surface = self.collect_cells();
        let looks_out = self.finish_keys(&mut surface, false);
        if looks_out || creased {
            self.sampler.leave();
            if looks_out {
                self.finish_keys(&mut surface, true);
            }
            self.sampler.enter(if creased { self.lattice.apron(key) } else { region });
        }
        self.collect_sites(&mut surface);
        self.place(creased);
        self.sampler.leave();
        surface.vertices = Arc::new(self.vertices.clone());
        surface.bold.clone_from(&self.bold);
        surface.facets.clone_from(&self.facets);
        Some(surface)
    }

    /// Finds the mixed cells and their configurations.
    fn collect_cells(&mut self) -> BrickSurface {
        let mut rows = [0; ROWS];
        let mut before = [0; ROWS];
        self.keys.clear();
        for z in 0..CELLS {
            for y in 0..CELLS {
                let row = z * CELLS + y;
                rows[row] = self.grid.mixed_cells(y, z);
                before[row] = self.keys.len() as u16;
                self.keys.extend(bits(rows[row]).map(|x| u16::from(self.grid.config([x, y, z]))));
            }
        }
        let cells = self.keys.iter().map(|&key| MixedCell { first_vertex: 0, key }).collect();
        BrickSurface { rows, before, cells, vertices: Arc::default(), bold: Vec::new(), facets: Vec::new() }
    }

    /// Marks cells whose ambivalent face meets that of their neighbour. Neighbours in other bricks cost
    /// samples outside this one: they are only looked at with `outside`. Returns whether there are any.
    fn finish_keys(&mut self, surface: &mut BrickSurface, outside: bool) -> bool {
        let table = &*PATCHES;
        let mut looks_out = false;
        for n in 0..self.keys.len() {
            let config = self.keys[n];
            let face = table[usize::from(config)].ambivalent_face;
            if face == NONE {
                continue;
            }
            let (axis, high) = (usize::from(face / 2), face % 2 == 1);
            let mut cell = surface.place_of(n);
            let last = if high { CELLS - 1 } else { 0 };
            let neighbour = if cell[axis] != last {
                cell[axis] = if high { cell[axis] + 1 } else { cell[axis] - 1 };
                self.grid.config(cell)
            } else if outside {
                self.config_beyond(cell, usize::from(face), config as u8)
            } else {
                looks_out = true;
                continue;
            };
            if table[usize::from(neighbour)].ambivalent_face == face ^ 1 {
                surface.cells[n].key = config | FLIPPED;
            }
        }
        looks_out
    }

    /// The configuration of the cell behind `face` of `cell`, in another brick.
    fn config_beyond(&mut self, cell: [usize; 3], face: usize, config: u8) -> u8 {
        let (axis, side) = (face / 2, face % 2);
        let far_face = face_corners(face);
        self.batch.points.clear();
        let far_corners = || (0..8).filter(|c| far_face >> c & 1 == 1);
        for c in far_corners() {
            let mut index: [i32; 3] =
                std::array::from_fn(|a| self.grid.brick.origin[a] + (cell[a] + (c >> a & 1)) as i32);
            index[axis] += 2 * side as i32 - 1;
            self.batch.points.push(Brick::lattice_point(index, self.grid.brick.spacing));
        }
        let values = self.batch.evaluate(&mut *self.sampler);
        let beyond = far_corners().zip(values).fold(0, |bits, (c, &v)| bits | u8::from(is_inside(v)) << c);
        // The shared face's corners are on the neighbour's other side.
        let shift = 1 << axis;
        let shared = config & far_face;
        beyond | if side == 1 { shared >> shift } else { shared << shift }
    }

    /// Lists the patches of all mixed cells and numbers their vertices.
    fn collect_sites(&mut self, surface: &mut BrickSurface) {
        let table = &*PATCHES;
        self.sites.clear();
        let mut n = 0;
        for row in 0..ROWS {
            for x in bits(surface.rows[row]) {
                let mixed = &mut surface.cells[n];
                n += 1;
                let patches = &table[usize::from(mixed.key)];
                mixed.first_vertex = self.sites.len() as u16;
                let cell = [x as u8, (row % CELLS) as u8, (row / CELLS) as u8];
                for &edges in &patches.edges[..usize::from(patches.count)] {
                    let shares_cell = patches.count > 1;
                    self.sites.push(Site { cell, config: mixed.key as u8, edges, shares_cell });
                }
            }
        }
    }

    fn place(&mut self, creased: bool) {
        let unplaced = Vertex { position: Vec3::ZERO, normal: Vec3::ZERO, kind: VertexKind::Smooth };
        self.vertices.clear();
        self.vertices.resize(self.sites.len(), unplaced);
        self.pending.clear();
        self.bold.clear();
        self.facets.clear();
        let Self { sampler, grid, sites, pending, vertices, bold, facets, batch, feature, .. } = self;
        if creased {
            let mut out = Placement { vertices, bold, facets, smooth: pending };
            feature.place(&mut **sampler, grid, sites, &mut out, batch);
        } else {
            pending.extend(0..sites.len() as u32);
        }
        place_smooth(&mut **sampler, grid, sites, pending, vertices, batch);
        bring_back(&mut **sampler, grid, sites, vertices, batch);
    }
}

impl BrickSurface {
    /// The place of mixed cell number `n`.
    fn place_of(&self, n: usize) -> [usize; 3] {
        let row = self.before.partition_point(|&before| usize::from(before) <= n) - 1;
        let mut word = self.rows[row];
        for _ in 0..n - usize::from(self.before[row]) {
            word &= word - 1;
        }
        [word.trailing_zeros() as usize, row % CELLS, row / CELLS]
    }
}
