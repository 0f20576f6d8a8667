//! A surface that follows a tree from one question to the next, in cells that suit its size.

use blobtree::{Aabb, ChangedPlaces, NodeRef, Tree, solid_box};
use polygonizer::{Cancel, CellSize, Options, PolygonizeError, Surface};

/// Cells along the longest side: of what is shown at once, and of what is shown when there is time.
const CELLS: [f32; 2] = [64.0, 192.0];

/// Most triangles of either: what a processor that plays a graphics card draws within 50 ms, and what takes 100 MB. Of
/// the examples, the coarse ones have up to 70,000, the fine ones up to 635,000.
pub const MOST_TRIANGLES: [usize; 2] = [300_000, 1_200_000];

/// How much larger cells become in one go where there are more triangles than that: more than [`SLACK`], so that none are
/// kept.
const COARSER: f32 = 1.6;

/// How much larger or smaller cells may be than those are before all is made anew, so that a drag which changes the
/// size a little follows the change alone.
pub const SLACK: f32 = 1.5;

/// A surface kept from one question to the next.
pub struct Level {
    cells: f32,
    /// Most triangles.
    most: usize,
    /// How much larger its cells are than usual, because of that.
    coarser: f32,
    /// What was made last, and of which tree.
    pub surface: Option<(NodeRef, Surface)>,
}

impl Level {
    /// The coarse one, 0, or the fine one, 1, with no surface yet.
    pub fn new(level: usize) -> Self {
        Self { cells: CELLS[level], most: MOST_TRIANGLES[level], coarser: 1.0, surface: None }
    }

    /// The usual size of cells for a solid this large, mm.
    fn usual(&self, solid: Aabb) -> f32 {
        let longest = if solid.is_empty() { 1.0 } else { solid.size().max_element() };
        longest / self.cells
    }

    /// The size of cells for a solid this large.
    fn cell(&self, solid: Aabb) -> Option<CellSize> {
        CellSize::from_mm((self.coarser * self.usual(solid)).max(1e-3)).ok()
    }

    /// Whether the cells of a surface are larger than they would be without too many triangles.
    pub fn is_coarsened(&self, surface: &Surface, solid: Aabb) -> bool {
        surface.cell().mm() > SLACK * self.usual(solid)
    }

    /// Makes the surface that of the tree, in cells of about the right size for a solid this large: what was there, changed
    /// where the trees differ, or a new one. `None` if it was cancelled.
    pub fn follow(&mut self, root: &NodeRef, tree: &Tree, solid: Aabb, cancel: &Cancel) -> Option<()> {
        let wanted = self.cell(solid)?;
        let kept = self.surface.take().filter(|(_, surface)| {
            let ratio = surface.cell().mm() / wanted.mm();
            (1.0 / SLACK..=SLACK).contains(&ratio)
        });
        let surface = match kept {
            Some((before, mut surface)) => {
                let dirty = ChangedPlaces::between(&before, root);
                match surface.update(tree, &dirty, &self.options(cancel)) {
                    // Only what has changed is counted on the way.
                    Ok(_) if surface.triangle_count() <= self.most => surface,
                    Err(PolygonizeError::Cancelled) => {
                        // An update that was stopped changes nothing, so the next one starts from here again.
                        self.surface = Some((before, surface));
                        return None;
                    }
                    _ => self.build(tree, solid, cancel)?,
                }
            }
            None => self.build(tree, solid, cancel)?,
        };
        // The next one may be finer again; of what is wiggly, finer cells find more than in proportion.
        let mut expected = surface.triangle_count() as f32 * COARSER.powi(3);
        while self.coarser > 1.0 && expected < self.most as f32 {
            self.coarser = (self.coarser / COARSER).max(1.0);
            expected *= COARSER.powi(3);
        }
        self.surface = Some((root.clone(), surface));
        Some(())
    }

    /// A new surface of the tree, in cells as small as they can be without too many triangles. `None` if it was cancelled.
    pub fn build(&mut self, tree: &Tree, mut solid: Aabb, cancel: &Cancel) -> Option<Surface> {
        loop {
            match Surface::build(tree, self.cell(solid)?, &self.options(cancel)) {
                Ok(surface) if surface.triangle_count() <= self.most => return Some(surface),
                Ok(_) => self.coarser *= COARSER,
                Err(PolygonizeError::TooManyTriangles { .. }) => {
                    // It may only be larger than the one before.
                    let measured = solid_box(tree);
                    if measured.size().max_element() > SLACK * solid.size().max_element() {
                        solid = measured;
                    } else {
                        self.coarser *= COARSER;
                    }
                }
                Err(_) => return None,
            }
        }
    }

    fn options<'a>(&self, cancel: &'a Cancel) -> Options<'a> {
        Options { cancel: Some(cancel), max_triangles: self.most, ..Options::default() }
    }
}
