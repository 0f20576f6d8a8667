//! The solid as it is drawn, made in the background: coarse at once, fine when nothing else is to do.
//!
//! A coarse solid is made to its end and shown even if the hand has moved on meanwhile: a drag whose every place stops
//! the work on the one before would show nothing until the hand rests.

use crate::desk::Bake;
use crate::newest::{Answering, Newest};
use crate::seams::{Ground, seams};
use crate::stage::Line;
use blobtree::{Aabb, BakeStore, ChangedPlaces, Field, NodeRef, Owners, Palette, Tree, solid_box};
use glam::Vec3;
use polygonizer::{Cancel, CellSize, Options, Surface, VertexKind};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Cells along the longest side: of what is shown at once, and of what is shown when there is time.
const CELLS: [f32; 2] = [64.0, 192.0];

/// How much larger or smaller cells may be than those are before all is made anew, so that a drag which changes the
/// size a little follows the change alone.
const SLACK: f32 = 1.5;

/// How long nothing new must be asked before the fine surface is begun.
const REST: Duration = Duration::from_millis(150);

/// Points that are coloured together.
const TOGETHER: usize = 256;

/// A corner of a triangle, as the graphics card takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Corner {
    /// mm.
    pub position: [f32; 3],
    /// Unit, outwards; that of the triangle where it meets a sharp edge.
    pub normal: [f32; 3],
    /// sRGB, and the level: 0 for the coarse surface, 1 for the fine one.
    pub color: [u8; 4],
}

/// Why a solid is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asking {
    /// The user has chosen what a sketch becomes.
    Choice,
    /// The user is dragging something.
    Drag,
    /// Anything else.
    Other,
}

/// A solid ready to be drawn.
#[derive(Debug)]
pub struct Solid {
    /// Which of the solids asked for it is.
    pub version: u64,
    /// Three for each triangle, counter-clockwise seen from outside.
    pub corners: Vec<Corner>,
    /// Around it, mm; empty without any.
    pub bounds: Aabb,
    /// The size of its cells, mm.
    pub cell: f32,
    /// Whether it is the finest that is made.
    pub is_fine: bool,
    /// How many of its support-free nodes are shown as drawn.
    pub unconstrained: usize,
    /// Why it was asked for.
    pub asking: Asking,
    /// When the frame began that asked for it.
    pub asked: Instant,
    /// How long the work on it took.
    pub took: Duration,
}

/// Where one part of a solid ends and another begins.
#[derive(Debug)]
struct Seams {
    version: u64,
    is_fine: bool,
    lines: Vec<Line>,
}

/// What comes of a question: a solid first, then its seams, for which nobody waits.
#[derive(Debug)]
enum Made {
    Solid(Solid),
    Seams(Seams),
}

/// A tree to be drawn.
#[derive(Clone, Debug)]
struct Question {
    version: u64,
    root: NodeRef,
    has_seams: bool,
    asking: Asking,
    asked: Instant,
}

/// Makes solids of trees.
#[derive(Debug)]
pub struct SolidMaker {
    worker: Newest<Question, Made>,
    asked: u64,
    /// Whether what was asked last is to have seams.
    has_seams: bool,
    seams: Option<Seams>,
    /// Solids before this one are of a document that is gone.
    first: u64,
}

impl SolidMaker {
    /// Starts the thread; `wake` is called when a solid is ready. Fine solids have their support-free nodes baked by
    /// `bake`, if there is one.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(wake: Arc<dyn Fn() + Send + Sync>, bake: Option<Bake>) -> std::io::Result<Self> {
        let mut maker = Maker {
            levels: CELLS.map(|cells| Level { cells, surface: None }),
            extent: Aabb::EMPTY,
            reach: 0.0,
            bakes: BakeStore::new(),
            bake,
        };
        let worker = Newest::start("solid", wake, move |question: Question, answering| {
            maker.make(&question, answering);
        })?;
        Ok(Self { worker, asked: 0, has_seams: false, seams: None, first: 0 })
    }

    /// Asks for the solid of a tree, with its seams or without, in a frame that began `now`; returns its version.
    pub fn ask(&mut self, root: &NodeRef, has_seams: bool, asking: Asking, now: Instant) -> u64 {
        self.asked += 1;
        self.has_seams = has_seams;
        let root = root.clone();
        self.worker.ask(Question { version: self.asked, root, has_seams, asking, asked: now });
        self.asked
    }

    /// The newest solid since the last look.
    pub fn ready(&mut self) -> Option<Solid> {
        let mut newest = None;
        for made in self.worker.answers() {
            match made {
                Made::Solid(solid) => newest = Some(solid),
                Made::Seams(seams) => self.seams = Some(seams),
            }
        }
        newest.filter(|solid| solid.version >= self.first)
    }

    /// The seams of a solid, as far as they are known.
    pub fn seams(&self, solid: &Solid) -> &[Line] {
        self.seams.as_ref().filter(|seams| seams.version == solid.version).map_or(&[], |seams| &seams.lines)
    }

    /// Nothing that was asked for so far is wanted any more.
    pub fn forget(&mut self) {
        self.first = self.asked + 1;
    }

    /// Whether everything asked for so far is there in `shown` as fine as it gets.
    pub fn is_done(&self, shown: Option<&Solid>) -> bool {
        let is_newest = |seams: &Seams| seams.version == self.asked && seams.is_fine;
        let has_seams = !self.has_seams || self.seams.as_ref().is_some_and(is_newest);
        has_seams && shown.is_some_and(|solid| solid.version == self.asked && solid.is_fine)
    }
}

/// A surface kept from one question to the next.
struct Level {
    cells: f32,
    surface: Option<(NodeRef, Surface)>,
}

/// What makes solids.
struct Maker {
    levels: [Level; 2],
    /// Around the last solid, by which cells are chosen.
    extent: Aabb,
    /// How far the influence of what was last drawn reached, along its longest side, mm.
    reach: f32,
    bakes: BakeStore,
    bake: Option<Bake>,
}

impl Maker {
    /// Makes one level after the other.
    fn make(&mut self, question: &Question, answering: &Answering<Made>) {
        let mut began = Instant::now();
        let tree = Tree::new(&question.root);
        let palette = Palette::new(&question.root, &BakeStore::new());
        self.choose_extent(&tree);
        let [coarse, fine] = &mut self.levels;
        let Some(surface) = coarse.follow(&question.root, &tree, self.extent, &answering.closed) else {
            return;
        };
        let drawn = draw(surface, &palette, question, false);
        self.extent = drawn.bounds;
        let unconstrained = tree.unconstrained();
        answering.give_late(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }));
        sew(surface, &BakeStore::new(), question, false, answering);
        if !rests(&answering.cancel) {
            return;
        }
        began = Instant::now();
        if let Some(bake) = self.bake.as_mut().filter(|_| unconstrained > 0)
            && bake(&question.root, &mut self.bakes, &answering.cancel)
        {
            // A change below such a node may change all of it, so its surface is made anew.
            fine.surface = None;
            let tree = self.bakes.compile(&question.root);
            let palette = Palette::new(&question.root, &self.bakes);
            let Some(cell) = fine.cell(self.extent) else { return };
            let options = Options { cancel: Some(&answering.cancel), ..Options::default() };
            let Ok(surface) = Surface::build(&tree, cell, &options) else { return };
            let drawn = draw(&surface, &palette, question, true);
            let unconstrained = tree.unconstrained();
            answering.give(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }));
            sew(&surface, &self.bakes, question, true, answering);
            return;
        }
        let Some(surface) = fine.follow(&question.root, &tree, self.extent, &answering.cancel) else {
            return;
        };
        let drawn = draw(surface, &palette, question, true);
        self.extent = drawn.bounds;
        answering.give(Made::Solid(Solid { unconstrained, took: began.elapsed(), ..drawn }));
        sew(surface, &BakeStore::new(), question, true, answering);
    }
}

impl Maker {
    /// Measures the solid anew if its size may be quite another one than that of the last: cells chosen for a ball of
    /// 5 mm would make millions of triangles of one of 50 mm.
    fn choose_extent(&mut self, tree: &Tree) {
        let reach = tree.support().size().max_element();
        let is_alike = (1.0 / SLACK..=SLACK).contains(&(reach / self.reach));
        if self.extent.is_empty() || !is_alike {
            let solid = solid_box(tree);
            self.extent = if solid.is_empty() { tree.support() } else { solid };
        }
        self.reach = reach;
    }
}

/// Waits a little; whether nothing new was asked.
fn rests(cancel: &Cancel) -> bool {
    let until = Instant::now() + REST;
    while Instant::now() < until && !cancel.is_cancelled() {
        std::thread::sleep(Duration::from_millis(5));
    }
    !cancel.is_cancelled()
}

impl Level {
    /// The size of cells for a solid this large.
    fn cell(&self, solid: Aabb) -> Option<CellSize> {
        let longest = if solid.is_empty() { 1.0 } else { solid.size().max_element() };
        CellSize::from_mm((longest / self.cells).max(1e-3)).ok()
    }

    /// The surface of the tree, in cells of about the right size for a solid this large: what was there, changed where
    /// the trees differ, or a new one. `None` if it was cancelled.
    fn follow(&mut self, root: &NodeRef, tree: &Tree, solid: Aabb, cancel: &Cancel) -> Option<&Surface> {
        let options = Options { cancel: Some(cancel), ..Options::default() };
        let wanted = self.cell(solid)?;
        let kept = self.surface.take().filter(|(_, surface)| {
            let ratio = surface.cell().mm() / wanted.mm();
            (1.0 / SLACK..=SLACK).contains(&ratio)
        });
        let surface = match kept {
            Some((before, mut surface)) => {
                let dirty = ChangedPlaces::between(&before, root);
                match surface.update(tree, &dirty, &options) {
                    Ok(_) => surface,
                    Err(_) => {
                        // An update that was stopped changes nothing, so the next one starts from here again.
                        self.surface = Some((before, surface));
                        return None;
                    }
                }
            }
            None => Surface::build(tree, wanted, &options).ok()?,
        };
        self.surface = Some((root.clone(), surface));
        self.surface.as_ref().map(|(_, surface)| surface)
    }
}

/// Makes the seams, if they are wanted, for as long as nothing newer is asked.
fn sew(
    surface: &Surface,
    bakes: &BakeStore,
    question: &Question,
    is_fine: bool,
    answering: &Answering<Made>,
) {
    if !question.has_seams || answering.cancel.is_cancelled() {
        return;
    }
    let (mesh, normals) = (surface.mesh(), surface.normals());
    let ground = Ground {
        positions: &mesh.positions,
        normals: &normals,
        triangles: &mesh.triangles,
        cell: surface.cell().mm(),
    };
    let owners = Owners::new(&question.root, bakes);
    if let Some(lines) = seams(&question.root, &owners, ground, &answering.cancel) {
        answering.give(Made::Seams(Seams { version: question.version, is_fine, lines }));
    }
}

fn draw(surface: &Surface, palette: &Palette, question: &Question, is_fine: bool) -> Solid {
    let (mesh, normals, kinds) = (surface.mesh(), surface.normals(), surface.kinds());
    let colors: Vec<[u8; 3]> = mesh
        .positions
        .par_chunks(TOGETHER)
        .map_init(|| palette.painter(), |painter, points| painter.colors(points))
        .flatten_iter()
        .collect();
    let level = u8::from(is_fine);
    let corners = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        triangle.map(|v| {
            let v = v as usize;
            let normal =
                if kinds[v] == VertexKind::Smooth && normals[v] != Vec3::ZERO { normals[v] } else { flat };
            let [r, g, b] = colors[v];
            Corner {
                position: mesh.positions[v].to_array(),
                normal: normal.to_array(),
                color: [r, g, b, level],
            }
        })
    };
    Solid {
        version: question.version,
        corners: mesh.triangles.par_iter().flat_map_iter(corners).collect(),
        bounds: Aabb::of_points(mesh.positions.iter().copied()),
        cell: surface.cell().mm(),
        is_fine,
        unconstrained: 0,
        asking: question.asking,
        asked: question.asked,
        took: Duration::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blobtree::build::{point, union};

    /// Waits for the fine solid of this version.
    fn fine(maker: &mut SolidMaker, version: u64) -> Solid {
        let until = Instant::now() + Duration::from_secs(60);
        loop {
            match maker.ready() {
                Some(solid) if solid.version == version && solid.is_fine => return solid,
                _ => assert!(Instant::now() < until, "it never came"),
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_solid_that_follows_a_drag_is_the_one_that_is_made_anew() {
        let two = |x: f32| -> NodeRef { union([point([0., 0., 10.], 10.), point([x, 0., 10.], 8.)]).into() };
        let mut following = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let first = following.ask(&two(12.0), true, Asking::Other, Instant::now());
        fine(&mut following, first);
        let after = two(13.0);
        let version = following.ask(&after, true, Asking::Drag, Instant::now());
        let followed = fine(&mut following, version);
        let mut anew = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = anew.ask(&after, true, Asking::Other, Instant::now());
        let made = fine(&mut anew, version);
        // The cells were chosen for the solid before the drag.
        let ends = |solid: &Solid| [solid.bounds.min, solid.bounds.max];
        for (a, b) in ends(&followed).into_iter().zip(ends(&made)) {
            assert!(a.distance(b) < 0.05, "{a} {b}");
        }
    }

    #[test]
    fn a_drag_that_never_rests_is_followed() {
        let at = |x: f32| -> NodeRef { union([point([x, 0., 10.], 10.), point([0., 0., 30.], 8.)]).into() };
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let until = Instant::now() + Duration::from_secs(60);
        let mut shown = 0;
        // A new place every millisecond, which is less than any solid takes.
        for step in 0_u16.. {
            assert!(Instant::now() < until, "{shown} solids in {step} steps");
            maker.ask(&at(0.01 * f32::from(step)), true, Asking::Drag, Instant::now());
            shown += usize::from(maker.ready().is_some());
            if shown == 5 {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_solid_that_grows_at_once_to_a_hundred_times_its_size_has_no_more_triangles() {
        let ball = |radius: f32| -> NodeRef { union([point([0., 0., radius], radius)]).into() };
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version = maker.ask(&ball(5.0), false, Asking::Other, Instant::now());
        let small = fine(&mut maker, version).corners.len();
        for radius in [500.0, 2.0] {
            let version = maker.ask(&ball(radius), false, Asking::Other, Instant::now());
            let ratio = fine(&mut maker, version).corners.len() as f32 / small as f32;
            assert!((0.4..2.5).contains(&ratio), "{ratio} times as many for {radius} mm");
        }
    }

    #[test]
    fn nothing_is_drawn_of_an_empty_page() {
        let mut maker = SolidMaker::start(Arc::new(|| ()), None).expect("a thread");
        let version =
            maker.ask(&crate::workbench::Workbench::empty_page().root, true, Asking::Other, Instant::now());
        let solid = fine(&mut maker, version);
        assert!(solid.corners.is_empty() && solid.bounds.is_empty());
    }
}
